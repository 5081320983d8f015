//! Literals of Python, as many of them as headers of NumPy use.

/// A literal.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Literal {
    Text(String),
    Number(u64),
    Truth(bool),
    /// A list or a tuple.
    List(Vec<Literal>),
    Dictionary(Vec<(String, Literal)>),
}

/// Headers nest lists three deep.
const DEEPEST: usize = 8;

impl Literal {
    /// Reads a literal; nothing where the text is anything else.
    pub fn parse(text: &[u8]) -> Option<Self> {
        let mut rest = text.trim_ascii();
        let literal = literal(&mut rest, DEEPEST)?;
        rest.is_empty().then_some(literal)
    }

    /// The value of a key of a dictionary.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Self::Dictionary(entries) = self else { return None };
        entries.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    pub fn list(&self) -> Option<&[Self]> {
        if let Self::List(list) = self { Some(list) } else { None }
    }

    pub fn number(&self) -> Option<u64> {
        if let Self::Number(number) = self { Some(*number) } else { None }
    }

    pub fn truth(&self) -> Option<bool> {
        if let Self::Truth(truth) = self { Some(*truth) } else { None }
    }
}

/// Takes a literal, and the blanks after it, from the front of the text.
fn literal(rest: &mut &[u8], depth: usize) -> Option<Literal> {
    let depth = depth.checked_sub(1)?;
    match *rest.first()? {
        quote @ (b'\'' | b'"') => text(rest, quote).map(Literal::Text),
        b'(' => list(rest, b')', depth).map(Literal::List),
        b'[' => list(rest, b']', depth).map(Literal::List),
        b'{' => dictionary(rest, depth).map(Literal::Dictionary),
        _ => {
            let length = rest.iter().take_while(|byte| byte.is_ascii_alphanumeric()).count();
            let word = std::str::from_utf8(take(rest, length)?).ok()?;
            match word {
                "True" => Some(Literal::Truth(true)),
                "False" => Some(Literal::Truth(false)),
                // Python 2 wrote long integers with an L.
                number => number.trim_end_matches('L').parse().ok().map(Literal::Number),
            }
        }
    }
}

fn text(rest: &mut &[u8], quote: u8) -> Option<String> {
    let length = rest[1..].iter().position(|byte| *byte == quote)?;
    let text = take(rest, length + 2)?;
    String::from_utf8(text[1..=length].to_vec()).ok()
}

fn list(rest: &mut &[u8], end: u8, depth: usize) -> Option<Vec<Literal>> {
    let mut list = Vec::new();
    take(rest, 1)?;
    while *rest.first()? != end {
        list.push(literal(rest, depth)?);
        separator(rest, end)?;
    }
    take(rest, 1)?;
    Some(list)
}

fn dictionary(rest: &mut &[u8], depth: usize) -> Option<Vec<(String, Literal)>> {
    let mut entries = Vec::new();
    take(rest, 1)?;
    while *rest.first()? != b'}' {
        let Literal::Text(key) = literal(rest, depth)? else { return None };
        (*rest.first()? == b':').then_some(())?;
        take(rest, 1)?;
        entries.push((key, literal(rest, depth)?));
        separator(rest, b'}')?;
    }
    take(rest, 1)?;
    Some(entries)
}

/// Takes a comma, which only the end may stand in for.
fn separator(rest: &mut &[u8], end: u8) -> Option<()> {
    match *rest.first()? {
        b',' => take(rest, 1).map(|_| ()),
        byte => (byte == end).then_some(()),
    }
}

/// Takes some bytes and the blanks after them.
fn take<'a>(rest: &mut &'a [u8], length: usize) -> Option<&'a [u8]> {
    let (taken, after) = rest.split_at_checked(length)?;
    *rest = after.trim_ascii_start();
    Some(taken)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_numpy() {
        let header =
            Literal::parse(b"{'descr': [('t', '<f8'), ('n', '|u1')], 'fortran_order': False, 'shape': (3L,), }\n");
        let header = header.unwrap();
        assert_eq!(header.get("shape").unwrap().list(), Some(&[Literal::Number(3)][..]));
        assert_eq!(header.get("fortran_order").unwrap().truth(), Some(false));
        assert_eq!(header.get("descr").unwrap().list().unwrap().len(), 2);
    }

    #[test]
    fn what_is_no_header() {
        let deep = [b"[".repeat(100_000), b"]".repeat(100_000)].concat();
        for text in [&b""[..], b"{", b"{'a'}", b"{'a': }", b"(1 2)", b"1 2", b"'a", b"-1", b"None", &deep] {
            assert_eq!(Literal::parse(text), None);
        }
    }
}
