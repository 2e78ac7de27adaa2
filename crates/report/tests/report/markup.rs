//! A page without what its script brings.

/// The page without its own script and the data for it, which come last or are JSON.
pub fn markup(html: &str) -> String {
    let mut parts = html.split("<script");
    let mut markup = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (script, rest) = part.split_once("</script>").expect("a script that ends");
        let is_ours = [">\n(() => {", " type=\"application/json\""]
            .iter()
            .any(|ours| script.starts_with(ours));
        assert!(
            is_ours,
            "a script of the data: {}",
            script.get(..80).unwrap_or(script)
        );
        markup += rest;
    }
    markup
}
