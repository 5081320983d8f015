//! A file that is written while the next bytes are being made, and seen to the disk as it grows.

use std::fs::File;
use std::io::{self, Write};
use std::mem;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};

/// Pieces that may wait to be written: enough that neither side waits for a hiccup of the other.
const AHEAD: usize = 32;

/// Bytes after which the disk is asked to take what there is: what is left at the end is soon done.
const STEP: usize = 32 << 20;

/// Bytes that [`Write`] gathers.
const GATHERED: usize = 1 << 20;

/// Bytes on their way to the file: those of `text` from `start` on.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub text: Vec<u8>,
    pub start: usize,
}

/// The file. What goes wrong is told by a later call, at the latest by [`Output::finish`].
pub(super) struct Output {
    /// To the thread that writes; none after the last piece.
    pieces: Option<SyncSender<Message>>,
    /// Pieces that are written: room for the next.
    written: Receiver<Piece>,
    thread: Option<JoinHandle<io::Result<()>>>,
    /// What [`Write`] has gathered.
    gathered: Piece,
}

enum Message {
    Write(Piece),
    /// That was all: see it to the disk.
    Finish,
}

impl Output {
    /// Writes to `file` from its start.
    pub fn new(file: File) -> Self {
        let (pieces, received) = sync_channel(AHEAD);
        let (done, written) = channel();
        let thread = thread::spawn(move || write_behind(file, &received, &done));
        Self { pieces: Some(pieces), written, thread: Some(thread), gathered: Piece::default() }
    }

    /// Room for a piece; what is in it may be anything.
    pub fn room(&self) -> Piece {
        self.written.try_recv().unwrap_or_default()
    }

    /// Adds a piece.
    pub fn send(&mut self, piece: Piece) -> io::Result<()> {
        self.tell(Message::Write(piece))
    }

    /// Ends the file, all of it on the disk.
    pub fn finish(mut self) -> io::Result<()> {
        self.flush()?;
        self.tell(Message::Finish)?;
        self.end()
    }

    fn tell(&mut self, message: Message) -> io::Result<()> {
        match self.pieces.as_ref().map(|pieces| pieces.send(message)) {
            Some(Ok(())) => Ok(()),
            // Who no longer listens has failed.
            _ => self.end(),
        }
    }

    /// Waits for what is under way and tells how it went.
    fn end(&mut self) -> io::Result<()> {
        self.pieces = None;
        let ended =
            self.thread.take().map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        ended.unwrap_or_else(|| Err(io::Error::other("the file has been given up")))
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.gathered.text.extend_from_slice(bytes);
        if self.gathered.text.len() >= GATHERED {
            self.flush()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.gathered.text.is_empty() {
            return Ok(());
        }
        let mut room = self.room();
        room.start = 0;
        room.text.clear();
        let gathered = mem::replace(&mut self.gathered, room);
        self.send(gathered)
    }
}

impl Drop for Output {
    /// Nobody writes any more afterwards.
    fn drop(&mut self) {
        if self.thread.is_some() {
            // Of a file that is given up nobody wants to know what went wrong last.
            let _ = self.end();
        }
    }
}

/// Writes pieces until no more come.
fn write_behind(mut file: File, pieces: &Receiver<Message>, written: &Sender<Piece>) -> io::Result<()> {
    let (ask, asked) = sync_channel(1);
    let same = file.try_clone()?;
    let syncing = thread::spawn(move || asked.iter().try_for_each(|()| same.sync_data()));
    let mut since = 0;
    let mut is_whole = false;
    for message in pieces {
        match message {
            Message::Write(piece) => {
                file.write_all(&piece.text[piece.start..])?;
                since += piece.text.len() - piece.start;
                // Nobody may have use for the room, and the disk may still be busy with the last time.
                let _ = written.send(piece);
                if since >= STEP && ask.try_send(()).is_ok() {
                    since = 0;
                }
            }
            Message::Finish => is_whole = true,
        }
    }
    drop(ask);
    syncing.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
    if is_whole { file.sync_all() } else { Ok(()) }
}
