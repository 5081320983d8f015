//! Rows of a table on their way from a parser to whoever asked for them.

use crate::column::Field;

/// Rows in a block: long enough that the cost of a block vanishes, short enough for the cache.
pub(crate) const BLOCK: usize = 16 * 1024;

/// Rows per byte of a packed file: the noise of a sensor takes a bit a row and more, however it is packed.
const ROWS_PER_BYTE: u64 = 8;

/// Rows that may be packed into nothing: 32 MB of four columns.
const ROWS_OF_NOTHING: u64 = 1_000_000;

/// Rows of a table: the values of each field, in slices of equal length.
pub type Block = Vec<Vec<f64>>;

/// Who is given the rows, several blocks at a time so that he may work on them in parallel, and told how many bytes of
/// the file they took.
pub struct Visitor<'a> {
    /// Given the blocks.
    pub visit: &'a mut dyn FnMut(&mut [Block]),
    /// Told of bytes.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// Blocks that are gathered for the visitor.
const BATCH: usize = 8;

/// Rows on their way from a parser to the visitor.
pub(crate) struct Rows<'a> {
    pub fields: &'a [Field],
    /// The block in the making, and those that are made.
    pub block: Block,
    gathered: Vec<Block>,
    /// Blocks that are done with: room for the next.
    spare: Vec<Block>,
    /// Last value of every field, to see that time does not run backwards.
    pub last: Vec<f64>,
    pub count: u64,
    /// Rows that the file can hold.
    pub most: u64,
    visit: &'a mut dyn FnMut(&mut [Block]),
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// A value that runs backwards: which field, and what was found.
pub(crate) struct Backwards {
    pub field: usize,
    pub found: String,
}

impl<'a> Rows<'a> {
    pub fn new(fields: &'a [Field], bytes: u64, visitor: &'a mut Visitor) -> Self {
        Self {
            fields,
            block: vec![Vec::with_capacity(BLOCK); fields.len()],
            gathered: Vec::new(),
            spare: Vec::new(),
            last: vec![f64::NEG_INFINITY; fields.len()],
            count: 0,
            most: ROWS_OF_NOTHING + ROWS_PER_BYTE * bytes,
            visit: visitor.visit,
            progress: visitor.progress,
        }
    }

    /// Counts the next rows, in which time does not run backwards, and sees that it did not before them.
    pub fn next(&mut self, block: &Block) -> Option<Backwards> {
        for (field, column) in block.iter().enumerate() {
            let (first, last) = (column.first()?, column.last()?);
            if *first < self.last[field] && self.fields[field].rule.ascends() {
                return Some(Backwards { field, found: format!("{first} after {}", self.last[field]) });
            }
            self.last[field] = *last;
        }
        self.count += block[0].len() as u64;
        None
    }

    /// Whether more rows came than the file can hold: a packed file can claim any number of them.
    pub fn is_too_long(&self) -> bool {
        self.count > self.most
    }

    /// Ends the block in the making.
    pub fn flush(&mut self) {
        if !self.block[0].is_empty() {
            self.count += self.block[0].len() as u64;
            let next = self.spare.pop().unwrap_or_else(|| vec![Vec::with_capacity(BLOCK); self.fields.len()]);
            self.gathered.push(std::mem::replace(&mut self.block, next));
            if self.gathered.len() == BATCH {
                self.deliver_gathered();
            }
        }
    }

    pub fn deliver_gathered(&mut self) {
        let mut gathered = std::mem::take(&mut self.gathered);
        self.deliver(&mut gathered);
        for mut block in gathered {
            block.iter_mut().for_each(Vec::clear);
            self.spare.push(block);
        }
    }

    /// Hands blocks to the visitor.
    pub fn deliver(&mut self, blocks: &mut [Block]) {
        if blocks.iter().any(|block| !block[0].is_empty()) {
            (self.visit)(blocks);
        }
    }
}

/// Whether any value is below the one before. All are looked at, several at a time.
pub(crate) fn runs_backwards(values: &[f64]) -> bool {
    values.windows(2).map(|pair| usize::from(pair[1] < pair[0])).sum::<usize>() > 0
}

/// What an ascending column should be.
pub(crate) const ASCENDING: &str = "a time that does not run backwards";
