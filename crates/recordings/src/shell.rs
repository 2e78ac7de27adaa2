//! Words of the shell, for commands to paste and for scripts.

/// `text` as one word. It stands unquoted where the shell takes every character for itself, else in single
/// quotation marks (POSIX.1-2024, *Shell Command Language*, 2.2.2), in which only a quotation mark ends the word.
pub fn word(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,+@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.to_owned();
    }
    format!("'{}'", text.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::word;
    use std::process::Command;

    /// A shell hands every word on as it was.
    #[test]
    fn a_word_is_one_word_to_the_shell() {
        for text in [
            "a/b-c.yaml",
            "",
            "a b",
            "it's",
            "$(id)",
            "`id`\n;id",
            "*",
            "~",
            "-x",
            "\\",
            "\"",
            "ä!#&|<>",
        ] {
            let script = format!("printf '[%s]' {}", word(text));
            let output = Command::new("sh").args(["-c", &script]).output().unwrap();
            assert_eq!(
                String::from_utf8(output.stdout).unwrap(),
                format!("[{text}]")
            );
        }
        assert_eq!(word("s3://bucket/a/sweep.yaml"), "s3://bucket/a/sweep.yaml");
        assert_eq!(word("it's"), r"'it'\''s'");
    }
}
