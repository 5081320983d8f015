//! The delimiters and the ends of lines of a text, found 64 bytes at a time.

#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;

/// Bytes that are looked through together.
const STEP: usize = 64;

/// The delimiters and the ends of lines of a text.
#[derive(Default)]
pub(super) struct Separators {
    /// All of them; of 64 bytes at most ten as a rule.
    all: Places<10>,
    /// The ends of lines.
    ends: Places<3>,
}

/// Places in a text, in ascending order. `OFTEN` of them are written in every step, as most steps have no more; later ones
/// overwrite the superfluous ones. A loop over the exact number would end where the processor does not expect it.
#[derive(Default)]
struct Places<const OFTEN: usize> {
    /// The places, and room for more.
    places: Vec<u32>,
    count: usize,
}

impl Separators {
    /// Finds those of a text of less than 4 GB.
    pub fn find(&mut self, text: &[u8], delimiter: u8) {
        (self.all.count, self.ends.count) = (0, 0);
        let (steps, rest) = text.as_chunks::<STEP>();
        self.find_in_steps(steps, delimiter);
        let mut last = [0; STEP];
        last[..rest.len()].copy_from_slice(rest);
        // A delimiter may be the byte that stands for nothing here.
        let there = (1_u64 << rest.len()) - 1;
        self.all.take(marks(&last, |byte| byte == delimiter || byte == b'\n') & there, steps.len() * STEP);
        self.ends.take(marks(&last, |byte| byte == b'\n') & there, steps.len() * STEP);
    }

    /// All of them, and the ends of lines among them.
    pub fn places(&self) -> [&[u32]; 2] {
        [self.all.get(), self.ends.get()]
    }

    fn find_in_steps(&mut self, steps: &[[u8; STEP]], delimiter: u8) {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = V3::try_new() {
            simd.vectorize(Wide { simd, steps, delimiter, found: self });
            return;
        }
        for (k, step) in steps.iter().enumerate() {
            self.all.take(marks(step, |byte| byte == delimiter || byte == b'\n'), k * STEP);
            self.ends.take(marks(step, |byte| byte == b'\n'), k * STEP);
        }
    }
}

impl<const OFTEN: usize> Places<OFTEN> {
    fn get(&self) -> &[u32] {
        &self.places[..self.count]
    }

    /// Adds the marked ones of a step.
    #[expect(
        clippy::inline_always,
        reason = "what is not inlined is compiled without the instructions that count bits"
    )]
    #[inline(always)]
    fn take(&mut self, mut marks: u64, step: usize) {
        if self.places.len() < self.count + STEP {
            self.places.resize(2 * self.count + STEP, 0);
        }
        let Some(room) = self.places[self.count..].first_chunk_mut::<STEP>() else { return };
        let count = marks.count_ones() as usize;
        #[expect(clippy::cast_possible_truncation, reason = "the text is shorter than 4 GB")]
        let step = step as u32;
        let mut next = || {
            let place = step + marks.trailing_zeros();
            marks &= marks.wrapping_sub(1);
            place
        };
        for place in &mut room[..OFTEN] {
            *place = next();
        }
        if count > OFTEN {
            for place in &mut room[OFTEN..count] {
                *place = next();
            }
        }
        self.count += count;
    }
}

/// What is asked for among some bytes, a bit each.
fn marks(step: &[u8; STEP], is_asked: impl Fn(u8) -> bool) -> u64 {
    step.iter().enumerate().map(|(k, byte)| u64::from(is_asked(*byte)) << k).sum()
}

/// Steps to be looked through by a processor with AVX2, 32 bytes at once.
#[cfg(target_arch = "x86_64")]
struct Wide<'a> {
    simd: V3,
    steps: &'a [[u8; STEP]],
    delimiter: u8,
    found: &'a mut Separators,
}

#[cfg(target_arch = "x86_64")]
impl pulp::NullaryFnOnce for Wide<'_> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "what is not inlined is compiled for narrower vectors")]
    #[inline(always)]
    fn call(self) {
        let Self { simd: V3 { avx, avx2, .. }, steps, delimiter, found } = self;
        let delimiters = avx._mm256_set1_epi8(delimiter.cast_signed());
        let ends = avx._mm256_set1_epi8(b'\n'.cast_signed());
        for (k, step) in steps.iter().enumerate() {
            let [mut all_marks, mut end_marks] = [0; 2];
            for half in step.as_chunks::<32>().0.iter().rev() {
                let half = pulp::cast(*half);
                let (delimiters, ends) = (avx2._mm256_cmpeq_epi8(half, delimiters), avx2._mm256_cmpeq_epi8(half, ends));
                let delimiters = avx2._mm256_movemask_epi8(delimiters).cast_unsigned();
                let ends = avx2._mm256_movemask_epi8(ends).cast_unsigned();
                all_marks = all_marks << 32 | u64::from(delimiters | ends);
                end_marks = end_marks << 32 | u64::from(ends);
            }
            found.all.take(all_marks, k * STEP);
            found.ends.take(end_marks, k * STEP);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{STEP, Separators, marks};

    #[test]
    fn every_separator_is_found() {
        let texts: [&[u8; 8]; 2] = [b"01;\n,.5-", b";;\n;;\n;1"];
        for bytes in texts {
            let text: Vec<u8> = (0..1000_u32).map(|i| bytes[(i * i / 7 % 8) as usize]).collect();
            let mut separators = Separators::default();
            for length in [1000, 3, 640, 999, 0] {
                separators.find(&text[..length], b';');
                let expected: Vec<u32> = (0..)
                    .zip(&text[..length])
                    .filter(|(_, byte)| matches!(byte, b';' | b'\n'))
                    .map(|(i, _)| i)
                    .collect();
                let [all, ends] = separators.places();
                assert_eq!(all, expected);
                assert_eq!(ends, expected.into_iter().filter(|i| text[*i as usize] == b'\n').collect::<Vec<u32>>());
            }
            separators.find(&text, b';');
            for (k, step) in text.as_chunks::<STEP>().0.iter().enumerate() {
                let count = |places: &[u32]| places.iter().filter(|place| **place as usize / STEP == k).count();
                let expected = [marks(step, |byte| matches!(byte, b';' | b'\n')), marks(step, |byte| byte == b'\n')];
                assert_eq!(separators.places().map(count), expected.map(|marks| marks.count_ones() as usize));
            }
        }
    }
}
