//! A file that is written while what comes next is being made, and seen to the disk as it grows.

use std::fs::File;
use std::io::{self, Write};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};

/// Bytes after which the disk is asked to take the file so far, so that little remains at the end.
const STEP: usize = 32 << 20;

/// What takes pieces of a table and has them in a file.
pub(super) trait Sink<P>: Send + 'static {
    /// Writes the next piece.
    fn write(&mut self, piece: &mut P) -> io::Result<()>;

    /// Ends the file, all of it on the disk.
    fn finish(self) -> io::Result<()>;
}

/// A sink on a thread of its own. An error is returned by a later call, at the latest by [`Output::finish`].
pub(super) struct Output<P> {
    /// To the thread that writes; none after the last piece.
    pieces: Option<SyncSender<Message<P>>>,
    /// Pieces that are written: room for the next.
    written: Receiver<P>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

enum Message<P> {
    Write(P),
    /// That was all.
    Finish,
}

impl<P: Default + Send + 'static> Output<P> {
    /// Begins; `ahead` pieces may wait to be written, enough for either side to ride out a hiccup of the other.
    ///
    /// # Errors
    /// If the system gives no thread for it.
    pub fn new(sink: impl Sink<P>, ahead: usize) -> io::Result<Self> {
        let (pieces, received) = sync_channel(ahead);
        let (done, written) = channel();
        let thread = thread::Builder::new().spawn(move || write_behind(sink, &received, &done))?;
        Ok(Self { pieces: Some(pieces), written, thread: Some(thread) })
    }

    /// Room for a piece; what is in it may be anything.
    pub fn room(&self) -> P {
        self.written.try_recv().unwrap_or_default()
    }

    /// Adds a piece.
    pub fn send(&mut self, piece: P) -> io::Result<()> {
        self.tell(Message::Write(piece))
    }

    /// Ends the file, all of it on the disk.
    pub fn finish(mut self) -> io::Result<()> {
        self.tell(Message::Finish)?;
        self.end()
    }

    fn tell(&mut self, message: Message<P>) -> io::Result<()> {
        match self.pieces.as_ref().map(|pieces| pieces.send(message)) {
            Some(Ok(())) => Ok(()),
            // Who no longer listens has failed.
            _ => self.end(),
        }
    }
}

impl<P> Output<P> {
    /// Waits for the thread and returns its outcome.
    fn end(&mut self) -> io::Result<()> {
        self.pieces = None;
        let ended =
            self.thread.take().map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        ended.unwrap_or_else(|| Err(io::Error::other("the file has been given up")))
    }
}

impl<P> Drop for Output<P> {
    /// Nobody writes any more afterwards.
    fn drop(&mut self) {
        if self.thread.is_some() {
            // Of a file that is given up nobody wants to know what went wrong last.
            let _ = self.end();
        }
    }
}

/// Writes pieces until the last one.
fn write_behind<P>(mut sink: impl Sink<P>, pieces: &Receiver<Message<P>>, written: &Sender<P>) -> io::Result<()> {
    for message in pieces {
        match message {
            Message::Write(mut piece) => {
                sink.write(&mut piece)?;
                // Nobody may have use for the room.
                let _ = written.send(piece);
            }
            Message::Finish => return sink.finish(),
        }
    }
    Ok(())
}

/// A file that the disk is asked to take while it grows.
pub(super) struct SteadyFile {
    file: File,
    /// Bytes since the disk was last asked.
    since: usize,
    /// To the thread that asks it.
    ask: SyncSender<()>,
    asking: JoinHandle<io::Result<()>>,
}

impl SteadyFile {
    /// Writes to `file` from its start.
    pub fn new(file: File) -> io::Result<Self> {
        let same = file.try_clone()?;
        let (ask, asked) = sync_channel(1);
        let asking = thread::Builder::new().spawn(move || asked.iter().try_for_each(|()| same.sync_data()))?;
        Ok(Self { file, since: 0, ask, asking })
    }

    /// Ends the file, all of it on the disk.
    pub fn finish(self) -> io::Result<()> {
        drop(self.ask);
        self.asking.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        self.file.sync_all()
    }
}

impl Write for SteadyFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.since += written;
        // The disk may still be busy with the last time.
        if self.since >= STEP && self.ask.try_send(()).is_ok() {
            self.since = 0;
        }
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
