//! The transcripts in tests/cli: what the programs print, word for word. They are the manual, too.
//!
//! After a wanted change: `TRYCMD=overwrite cargo test -p crosshead-cli --test all transcripts`, and read the diff.

#[test]
fn transcripts() {
    trycmd::TestCases::new().case("../../tests/cli/*.md").run();
}
