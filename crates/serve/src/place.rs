//! Which page a path asks for, and the folder that it is of.

use std::path::{Path, PathBuf};

/// What a path asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// What is in the folder that is served.
    Index,
    /// The same for programs.
    IndexJson,
    /// A folder, without a page of it.
    Folder,
    /// The progress of a sweep.
    Progress,
    /// The same for programs.
    ProgressJson,
    /// A page called so.
    Page(String),
    /// A figure of a page.
    Figure(String),
    /// A case, simulated again.
    Case(String),
}

/// A path that was taken apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// The names of the folders on the way.
    pub(crate) folders: Vec<String>,
    /// What is asked for there.
    pub(crate) wanted: Wanted,
}

impl Place {
    /// Takes the path of a request apart; none of one that leads nowhere. Names that are hidden, empty, or lead elsewhere
    /// (`..`, a slash or a backslash that is encoded, a NUL) lead nowhere.
    pub(crate) fn parse(path: &str) -> Option<Self> {
        let rest = path.strip_prefix('/')?;
        let (rest, is_folder) = match rest.strip_suffix('/') {
            Some(folder) => (folder, true),
            None => (rest, false),
        };
        let mut folders = match rest {
            "" if is_folder => return None,
            "" => Vec::new(),
            rest => rest.split('/').map(name).collect::<Option<Vec<String>>>()?,
        };
        let last = folders.pop();
        let wanted = match (last, folders.len()) {
            (None, _) => Wanted::Index,
            (Some(name), _) if is_folder => {
                folders.push(name);
                Wanted::Folder
            }
            (Some(name), 0) if name == "index.json" => Wanted::IndexJson,
            (Some(name), _) => match (name.as_str(), folders.last().map(String::as_str)) {
                ("progress.html", _) => Wanted::Progress,
                ("progress.json", _) => Wanted::ProgressJson,
                (page, Some("figures")) if page.ends_with(".svg") => {
                    folders.pop();
                    Wanted::Figure(name)
                }
                (page, Some("cases")) if page.ends_with(".html") => {
                    folders.pop();
                    Wanted::Case(page.trim_end_matches(".html").to_owned())
                }
                (page, _) if page.ends_with(".html") => Wanted::Page(name),
                (_, _) => {
                    folders.push(name);
                    Wanted::Folder
                }
            },
        };
        Some(Self { folders, wanted })
    }

    /// The folder below `root`, which is canonical; none of one that is not there, or that links lead out of `root`.
    pub(crate) fn folder(&self, root: &Path) -> Option<PathBuf> {
        let folder = root.join(self.folders.iter().collect::<PathBuf>());
        let folder = folder.canonicalize().ok()?;
        (folder.starts_with(root) && folder.is_dir()).then_some(folder)
    }

    /// The address of `page` in the folder.
    pub(crate) fn address(&self, page: &str) -> String {
        let folders = self
            .folders
            .iter()
            .map(|name| format!("/{}", encoded(name)));
        format!("{}/{page}", folders.collect::<String>())
    }
}

/// The name that a part of a path means.
fn name(part: &str) -> Option<String> {
    let name = decoded(part)?;
    let is_hidden = name.is_empty() || name.starts_with('.');
    let leads_elsewhere = name.contains(['/', '\\', '\0']);
    (!is_hidden && !leads_elsewhere).then_some(name)
}

/// The text with each `%` and its two digits as the byte that they mean; none if that is no text.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let mut digit = || char::from(rest.next()?).to_digit(16);
                (digit()? * 16 + digit()?) as u8
            }
            byte => byte,
        });
    }
    String::from_utf8(bytes).ok()
}

/// The text with each byte that is more than a letter, a digit, `-`, `.`, `_` or `~` as `%` and two digits.
pub(crate) fn encoded(text: &str) -> String {
    let bytes = text.bytes().map(|byte| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => {
            char::from(byte).to_string()
        }
        byte => format!("%{byte:02X}"),
    });
    bytes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(path: &str) -> Option<(String, Wanted)> {
        Place::parse(path).map(|place| (place.folders.join("/"), place.wanted))
    }

    #[test]
    fn paths_lead_to_pages() {
        let page = |name: &str| Wanted::Page(name.to_owned());
        for (path, folder, wanted) in [
            ("/", "", Wanted::Index),
            ("/index.json", "", Wanted::IndexJson),
            ("/report.html", "", page("report.html")),
            ("/a", "a", Wanted::Folder),
            ("/a/", "a", Wanted::Folder),
            ("/a/index.json", "a/index.json", Wanted::Folder),
            ("/a/b/chaos.html", "a/b", page("chaos.html")),
            ("/a%20b/progress.html", "a b", Wanted::Progress),
            ("/a/progress.json", "a", Wanted::ProgressJson),
            ("/a/figures/x.svg", "a", Wanted::Figure("x.svg".to_owned())),
            (
                "/a/cases/case-000001.html",
                "a",
                Wanted::Case("case-000001".to_owned()),
            ),
            ("/%C3%A4/report.html", "ä", page("report.html")),
        ] {
            assert_eq!(place(path), Some((folder.to_owned(), wanted)), "{path}");
        }
    }

    #[test]
    fn hostile_paths_lead_nowhere() {
        for path in [
            "",
            "a",
            "*",
            "//",
            "/..",
            "/../x",
            "/a/../b",
            "/%2e%2e/x",
            "/a/%2E%2e",
            "/.git",
            "/a/.hidden/report.html",
            "/a%2fb",
            "/a%2F..%2fb",
            "/a%5cb",
            "/a\\b",
            "/a%00",
            "/a//b",
            "/./a",
            "/%",
            "/%4",
            "/%zz",
            "/%ff",
            "/%+1",
        ] {
            assert_eq!(place(path), None, "{path}");
        }
    }

    #[test]
    fn an_address_leads_back() {
        let at = Place::parse("/a%20b/%C3%A4%3F").unwrap();
        assert_eq!(at.address("report.html"), "/a%20b/%C3%A4%3F/report.html");
        assert_eq!(
            Place::parse("/").unwrap().address("report.html"),
            "/report.html"
        );
    }
}
