//! Sources without comments, literals and tests.

/// Returns a source without comments, without the contents of its literals and without its tests.
pub(crate) fn read_code(text: &str) -> String {
    remove_tests(&blank_literals(text))
}

/// Removes comments, and the contents of strings and characters.
fn blank_literals(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let skipped = comment_length(rest)
            .or_else(|| raw_string_length(&kept, rest))
            .or_else(|| quoted_length(rest));
        if let Some(skipped) = skipped {
            kept.push(' ');
            rest = &rest[skipped..];
        } else {
            kept.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    kept
}

fn comment_length(text: &str) -> Option<usize> {
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    text.starts_with("/*")
        .then(|| text.find("*/").map_or(text.len(), |end| end + 2))
}

fn raw_string_length(before: &str, text: &str) -> Option<usize> {
    if before.ends_with(is_word_character) {
        return None;
    }
    let hashes = text.strip_prefix('b').unwrap_or(text).strip_prefix('r')?;
    let quote = hashes.find(|c| c != '#')?;
    let end = format!("\"{}", &hashes[..quote]);
    let body = hashes[quote..].strip_prefix('"')?;
    let start = text.len() - body.len();
    Some(start + body.find(&end)? + end.len())
}

/// The length of a string, or of a character; `None` for a lifetime.
fn quoted_length(text: &str) -> Option<usize> {
    let quote = text.chars().next().filter(|c| ['"', '\''].contains(c))?;
    let mut is_escaped = false;
    for (index, c) in text.char_indices().skip(1) {
        if quote == '\'' && index > 1 && !is_escaped && c != '\'' && !text[1..].starts_with('\\') {
            return None;
        }
        if c == quote && !is_escaped {
            return Some(index + 1);
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    None
}

/// Removes the items that are compiled for tests only.
fn remove_tests(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut parts = code.split(MARK);
    let mut kept = parts.next().unwrap_or_default().to_owned();
    let mut rest = &code[kept.len()..];
    while let Some(item) = rest.strip_prefix(MARK) {
        rest = &item[item_length(item)..];
        let next = rest.find(MARK).unwrap_or(rest.len());
        kept.push_str(&rest[..next]);
        rest = &rest[next..];
    }
    kept
}

/// The length of an item: to its `;`, or to the end of its block.
fn item_length(item: &str) -> usize {
    let is_import = item
        .trim_start()
        .trim_start_matches("pub(crate) ")
        .starts_with("use ");
    let semicolon = item.find(';').map_or(item.len(), |end| end + 1);
    match item.find('{') {
        Some(open) if open < semicolon && !is_import => block_end(item, open),
        _ => semicolon,
    }
}

/// The end of the block that opens at a byte.
pub(super) fn block_end(code: &str, open: usize) -> usize {
    let mut depth = 0;
    for (index, c) in code[open..].char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return open + index + 1;
        }
    }
    code.len()
}

/// Whether a character belongs to an identifier.
pub(super) fn is_word_character(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The identifiers of a source, each with the byte after it.
pub(super) fn words(code: &str) -> impl Iterator<Item = (&str, usize)> {
    code.split(|c| !is_word_character(c))
        .filter(|word| !word.is_empty())
        .map(|word| {
            let start = word.as_ptr().addr() - code.as_ptr().addr();
            (word, start + word.len())
        })
}
