//! Words in lines.

/// The words in lines of `width` characters: the first begins after `first` characters, others after `further`. Blanks at
/// the beginning stay. A word that is longer than a line has a line of its own.
pub(super) fn wrapped(words: &str, width: usize, first: usize, further: usize) -> Vec<String> {
    let leading = words.chars().take_while(|c| *c == ' ').count();
    let mut lines = vec![" ".repeat(leading)];
    let (mut used, mut is_empty) = (first + leading, true);
    for word in unbroken(words.trim()) {
        let length = word.chars().count();
        if !is_empty && used + 1 + length > width {
            lines.push(String::new());
            (used, is_empty) = (further, true);
        }
        if let Some(line) = lines.last_mut() {
            if !is_empty {
                line.push(' ');
            }
            line.push_str(&word);
        }
        used += length + usize::from(!is_empty);
        is_empty = false;
    }
    lines
}

/// The words; a value stays with its uncertainty, and a name with what is set.
fn unbroken(words: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut is_open = false;
    for word in words.split_whitespace() {
        match found.last_mut() {
            Some(last) if is_open || matches!(word, "±" | "=") => {
                last.push(' ');
                last.push_str(word);
            }
            _ => found.push(word.to_owned()),
        }
        is_open = matches!(word, "±" | "=");
    }
    found
}
