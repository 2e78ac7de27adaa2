//! The script of a page runs in a real browser, where there is one; `tests/browser` works with all pages.

use crate::synthetic;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Where Debian and its like put Chromium.
const PROGRAMS: [&str; 2] = ["/usr/bin/chromium", "/usr/bin/chromium-browser"];

#[test]
fn figures_of_a_page_get_their_tools_in_a_browser() {
    let Some(program) = PROGRAMS.iter().find(|path| Path::new(path).is_file()) else {
        eprintln!("no Chromium: not tested");
        return;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser");
    fs::create_dir_all(&folder).unwrap();
    let page = folder.join("page.html");
    fs::write(&page, synthetic::datasets::grid().render().unwrap().html).unwrap();
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let asked = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--virtual-time-budget=3000",
        "--dump-dom",
    ];
    // One that hangs is ended, and not waited for.
    let output = Command::new("timeout")
        .args(["-k", "5", "60", program])
        .args(asked)
        .arg(profile)
        .arg(&page)
        .output();
    // What keeps it from starting or from drawing is the machine's.
    let shown = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let shown = shown.unwrap_or_default();
    if !shown.contains("</html>") {
        eprintln!("Chromium does not show the page: not tested");
        return;
    }
    assert!(
        shown.contains("class=\"theme\""),
        "the script did not run to its end"
    );
    assert!(
        shown.contains("aria-label=\"Figures: class\""),
        "no choice of figures"
    );
}
