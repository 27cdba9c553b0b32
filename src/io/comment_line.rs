//! The second line of extended XYZ: `key=value` pairs, with values quoted if they contain blanks.
//!
//! Parsed as in ASE: quotes are `"` or `'` with `\` before a quote inside, lists are in `[ ]` or `{ }`, blanks on both
//! sides of `=` are allowed, a key alone is a flag. Keys are case-insensitive, so that `PBC` is recognised.

/// The pairs of a comment line.
pub(super) struct CommentLine {
    pairs: Vec<(String, String)>,
}

/// Why a comment line cannot be read: the key concerned and the reason.
#[derive(Debug, PartialEq)]
pub(super) enum Problem {
    /// A quote or bracket is not closed.
    Unclosed { key: String, value: String },
    /// A key occurs twice.
    Repeated { key: String },
}

impl CommentLine {
    pub fn parse(text: &str) -> Result<Self, Problem> {
        let mut pairs: Vec<(String, String)> = Vec::new();
        // Which keys have no value.
        let mut flags: Vec<bool> = Vec::new();
        let mut rest = text.trim_start();
        while !rest.is_empty() {
            let (key, after) = word(rest, true).map_err(|value| Problem::Unclosed { key: value.clone(), value })?;
            let spaced = after.starts_with(char::is_whitespace);
            rest = after.trim_start();
            let earlier = pairs.iter().position(|(earlier, _)| earlier.eq_ignore_ascii_case(&key));
            let Some(after) = rest.strip_prefix('=') else {
                match earlier {
                    None => {
                        pairs.push((key, "T".into()));
                        flags.push(true);
                    }
                    // Free text is a sequence of flags, in which words may repeat.
                    Some(place) if flags[place] => {}
                    Some(_) => return Err(Problem::Repeated { key }),
                }
                continue;
            };
            // `key = value` has blanks on both sides; ASE writes an empty value with a blank on the right only.
            let after = if spaced { after.trim_start() } else { after };
            let value;
            (value, rest) = word(after, false).map_err(|value| Problem::Unclosed { key: key.clone(), value })?;
            rest = rest.trim_start();
            if earlier.is_some() {
                return Err(Problem::Repeated { key });
            }
            pairs.push((key, value));
            flags.push(false);
        }
        Ok(CommentLine { pairs })
    }

    pub fn value(&self, key: &str) -> Option<&str> {
        self.pairs.iter().find(|(name, _)| name.eq_ignore_ascii_case(key)).map(|(_, value)| value.as_str())
    }

    /// All pairs, in the order of the line.
    pub fn into_pairs(self) -> Vec<(String, String)> {
        self.pairs
    }

    /// All keys, for messages.
    pub fn keys(&self) -> String {
        let keys: Vec<&str> = self.pairs.iter().map(|(key, _)| key.as_str()).collect();
        if keys.is_empty() { "no key".into() } else { keys.join(" ") }
    }
}

/// The elements of a list: numbers or flags separated by blanks, commas or brackets.
pub(super) fn list(value: &str) -> Vec<&str> {
    value
        .split(|c: char| c.is_whitespace() || matches!(c, ',' | '[' | ']' | '{' | '}'))
        .filter(|part| !part.is_empty())
        .collect()
}

/// The next key or value and the rest of the text; the error is the unclosed text.
fn word(text: &str, is_key: bool) -> Result<(String, &str), String> {
    match text.chars().next() {
        Some(quote @ ('"' | '\'')) => quoted(&text[1..], quote).ok_or_else(|| text.to_owned()),
        Some('[' | '{') if !is_key => bracketed(text).ok_or_else(|| text.to_owned()),
        _ => {
            let end = text.find(|c: char| c.is_whitespace() || (is_key && c == '=')).unwrap_or(text.len());
            // A stray `=` counts as a key, so that every call consumes at least one character.
            let end = if end == 0 && !text.is_empty() && is_key { 1 } else { end };
            Ok((text[..end].to_owned(), &text[end..]))
        }
    }
}

fn quoted(text: &str, quote: char) -> Option<(String, &str)> {
    let mut value = String::new();
    let mut characters = text.char_indices();
    while let Some((at, character)) = characters.next() {
        match character {
            '\\' => value.push(characters.next()?.1),
            _ if character == quote => return Some((value, &text[at + 1..])),
            _ => value.push(character),
        }
    }
    None
}

fn bracketed(text: &str) -> Option<(String, &str)> {
    let mut depth = 0usize;
    for (at, character) in text.char_indices() {
        match character {
            '[' | '{' => depth += 1,
            ']' | '}' => depth = depth.checked_sub(1)?,
            _ => {}
        }
        if depth == 0 {
            return Some((text[..=at].to_owned(), &text[at + 1..]));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_ase_reads_them() {
        let line =
            CommentLine::parse(r#"Lattice="1 0 0" a='b "c"' say="\"hi\" \\" list=[1, 2] flag k = v none= end=1"#);
        let Ok(line) = line else { panic!("valid line") };
        assert_eq!(line.value("lattice"), Some("1 0 0"));
        assert_eq!(line.value("a"), Some("b \"c\""));
        assert_eq!(line.value("say"), Some("\"hi\" \\"));
        assert_eq!(line.value("list").map(list), Some(vec!["1", "2"]));
        assert_eq!(line.value("flag"), Some("T"));
        assert_eq!(line.value("k"), Some("v"));
        assert_eq!((line.value("none"), line.value("end")), (Some(""), Some("1")));
    }

    #[test]
    fn what_is_never_closed_or_stands_twice_is_refused() {
        assert!(matches!(CommentLine::parse("a=\"b c"), Err(Problem::Unclosed { key, .. }) if key == "a"));
        assert!(matches!(CommentLine::parse("a=[1 2"), Err(Problem::Unclosed { .. })));
        assert!(matches!(CommentLine::parse("pbc=T PBC=F"), Err(Problem::Repeated { key }) if key == "PBC"));
        assert!(matches!(CommentLine::parse("pbc=T pbc"), Err(Problem::Repeated { key }) if key == "pbc"));
        assert!(CommentLine::parse("to be or not to be").is_ok());
    }
}
