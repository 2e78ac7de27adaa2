//! What a page may do: its content security policy (W3C, *Content Security Policy Level 3*).

use base64::prelude::{BASE64_STANDARD, Engine};
use sha2::{Digest, Sha256};

/// The content security policy of what runs and loads nothing.
pub(crate) const NOTHING: &str = "default-src 'none'; frame-ancestors 'none'";

/// The policy of a page: the scripts and styles that stand in it run, and it may ask this server.
pub(crate) fn policy_of(html: &str) -> String {
    let (scripts, styles) = (hashes(html, "script"), hashes(html, "style"));
    format!(
        "default-src 'none'; script-src{scripts}; style-src{styles}; img-src 'self' data: blob:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

/// The checksums of all elements called `name` without attributes; `'none'` without such elements.
fn hashes(html: &str, name: &str) -> String {
    let (begin, end) = (format!("<{name}>"), format!("</{name}>"));
    let elements = html.split(&begin).skip(1);
    let contents = elements.filter_map(|rest| rest.split(&end).next());
    let hashes = contents.map(|content| {
        let sum = BASE64_STANDARD.encode(Sha256::digest(content.as_bytes()));
        format!(" 'sha256-{sum}'")
    });
    let hashes: String = hashes.collect();
    match hashes.is_empty() {
        true => " 'none'".to_owned(),
        false => hashes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_policy_has_the_sums_of_the_page() {
        // printf 'a' | openssl dgst -sha256 -binary | base64
        let policy = policy_of("<style>a</style><script>a</script><p>&lt;script&gt;</p>");
        let sum = "'sha256-ypeBEsobvcr6wjGzmiPcTaeG7/gUfE5yuYB3ha/uSLs='";
        assert!(policy.contains(&format!("script-src {sum};")), "{policy}");
        assert!(policy.contains(&format!("style-src {sum};")), "{policy}");
        assert!(policy_of("").contains("script-src 'none'"));
    }
}
