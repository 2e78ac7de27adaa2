//! Text of others in Markdown and YAML.

use serde_json::Value;

/// Text that Markdown shows as it is, on one line and in any cell. What begins markup has a backslash before it
/// (CommonMark 0.31, 2.4), so that names from elsewhere bring neither links nor HTML.
pub(super) fn plain(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.trim().chars() {
        match c {
            c if c.is_control() => shown.push(' '),
            '\\' | '`' | '*' | '[' | ']' | '<' | '>' | '&' | '|' | '~' | '!' | '$' => {
                shown.extend(['\\', c])
            }
            c => shown.push(c),
        }
    }
    shown
}

/// Text as code within a cell of a table: a character that would end the code or the cell becomes `?`.
pub(super) fn code(text: &str) -> String {
    let shown = |c: char| if c.is_control() || c == '`' { '?' } else { c };
    let text: String = text.chars().map(shown).collect();
    format!("`{}`", text.replace('|', "\\|"))
}

/// Text in the quotation marks of YAML 1.2 (7.3.1): as in JSON, but what is not printable in YAML is written out.
pub(super) fn yaml(text: &str) -> String {
    let mut shown = String::new();
    for c in Value::from(text).to_string().chars() {
        match c {
            '\u{7f}'..='\u{9f}'
            | '\u{2028}'
            | '\u{2029}'
            | '\u{feff}'
            | '\u{fffe}'
            | '\u{ffff}' => {
                shown += &format!("\\u{:04x}", u32::from(c));
            }
            c => shown.push(c),
        }
    }
    shown
}
