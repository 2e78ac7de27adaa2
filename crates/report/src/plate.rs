//! Figures on their way into a page, and as files beside it.

use figure::Figure;
use std::cell::OnceCell;

/// A figure with its heading and caption.
#[derive(Default)]
pub(crate) struct Plate {
    pub(crate) heading: String,
    pub(crate) caption: String,
    pub(crate) figure: Figure,
    pub(crate) about: About,
    /// What the script of the page shows beside the figure, as JSON; empty for nothing.
    pub(crate) sections: String,
    /// The figure as the page has it, once that was asked for.
    pub(crate) live: OnceCell<String>,
}

impl Plate {
    /// The figure as the page has it.
    pub(crate) fn live_svg(&self) -> &str {
        self.live.get_or_init(|| self.figure.live_svg())
    }
}

/// What a figure shows alone; empty where it shows several, or there is one alone. A page offers its figures by these.
#[derive(Clone, Debug, Default)]
pub(crate) struct About {
    /// The class, in words.
    pub(crate) class: String,
    /// The sensor, in words.
    pub(crate) sensor: String,
    /// Speed and load.
    pub(crate) operating_point: String,
}

/// A page and the figures on it.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The page as one HTML file.
    pub html: String,
    /// Its figures, in the order of the page.
    pub figures: Vec<FigureFile>,
}

/// A figure as a file.
#[derive(Clone, Debug)]
pub struct FigureFile {
    /// Name of the file: `chaos-01-phase-portraits.svg`.
    pub name: String,
    /// Its content, the same that the page has.
    pub svg: String,
}

/// Data for the script of a page, in a form that cannot end its element; empty for a list of nothing.
pub(crate) fn json<T: serde::Serialize>(content: &[T]) -> String {
    match content {
        [] => String::new(),
        // Numbers and texts always have a form.
        content => in_script(serde_json::to_string(content).unwrap_or_default()),
    }
}

/// JSON that may stand in a `<script>` element.
pub(crate) fn in_script(json: String) -> String {
    json.replace('<', "\\u003c")
}

/// Numbers of a page's figures: each has the one after that of the figure before it.
#[derive(Default)]
pub(crate) struct Numbers(usize);

impl Numbers {
    /// The next figures with their numbers.
    pub(crate) fn give(&mut self, plates: Vec<Plate>) -> Vec<(usize, Plate)> {
        let numbered = plates.into_iter().map(|plate| {
            self.0 += 1;
            (self.0, plate)
        });
        numbered.collect()
    }
}

/// The figures of a page as files.
pub(crate) fn numbered_files(
    page: &str,
    plates: impl Iterator<Item = (usize, Plate)>,
) -> Vec<FigureFile> {
    let files = plates.map(|(number, plate)| FigureFile {
        name: file_name(page, number, &plate.heading),
        svg: plate.figure.svg(),
    });
    files.collect()
}

/// The name of the file of a page's figure of this number and heading.
pub(crate) fn file_name(page: &str, number: usize, heading: &str) -> String {
    let letters = heading.chars().map(|c| match c {
        c if c.is_ascii_alphanumeric() => c.to_ascii_lowercase(),
        _ => ' ',
    });
    let words = letters.collect::<String>();
    let words = words.split_whitespace().collect::<Vec<_>>().join("-");
    let short = text::shortened(&words, 60);
    format!(
        "{page}-{number:02}-{}.svg",
        short.trim_end_matches(['-', '…'])
    )
}

#[cfg(test)]
mod tests {
    use super::file_name;

    #[test]
    fn names_of_files_are_plain() {
        assert_eq!(
            file_name("dataset", 3, "Big end + small end, 0.1\u{a0}mm"),
            "dataset-03-big-end-small-end-0-1-mm.svg"
        );
        let hostile = file_name("chaos", 12, &"../<b>&".repeat(40));
        assert!(hostile.len() < 80 && hostile.ends_with(".svg"));
        assert!(!hostile.contains("..") && !hostile.contains('/'));
    }
}
