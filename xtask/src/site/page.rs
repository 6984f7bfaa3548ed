//! Pages: contents of web/site, in the layout, with values filled in.

use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;

/// Values by their names.
pub type Values = BTreeMap<String, String>;

/// Puts a page into the layout. The page begins with lines `<!-- NAME: VALUE -->`: title, description and optional
/// scripts. `{{NAME}}` in the page is replaced by the value.
///
/// # Errors
/// If the page has no title or description, or names an unknown value.
pub fn page(layout: &str, name: &str, text: &str, values: &Values) -> Result<String> {
    let mut head: BTreeMap<&str, &str> = BTreeMap::new();
    let mut rest = text;
    while let Some((line, after)) = rest.split_once('\n') {
        let Some(comment) = line.strip_prefix("<!-- ").and_then(|line| line.strip_suffix(" -->")) else {
            break;
        };
        let (key, value) = comment.split_once(": ").context("a head line needs a name and a value")?;
        head.insert(key, value);
        rest = after;
    }
    let get = |key: &str| head.get(key).with_context(|| format!("the page has no {key}"));
    let scripts: String = head
        .get("scripts")
        .into_iter()
        .flat_map(|list| list.split_whitespace())
        .map(|script| format!("    <script type=\"module\" src=\"{script}\"></script>\n"))
        .collect();
    let link = format!("<li><a href=\"{name}\"");
    let mut whole = layout
        .replace(&link, &format!("{link} aria-current=\"page\""))
        .replace("{{title}}", get("title")?)
        .replace("{{description}}", get("description")?)
        .replace("{{scripts}}\n", &scripts)
        .replace("{{main}}", rest.trim_end());
    for (key, value) in values {
        whole = whole.replace(&format!("{{{{{key}}}}}"), value);
    }
    if whole.contains("{{") {
        bail!("something between {{{{ and }}}} has no value");
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_put_into_the_layout() {
        let layout =
            "<title>{{title}}</title>{{description}}\n{{scripts}}\n<li><a href=\"a.html\">A</a>\n{{main}}\n";
        let text = "<!-- title: A -->\n<!-- description: b -->\n<!-- scripts: a.js -->\n<p>{{n}}</p>\n";
        let whole = page(layout, "a.html", text, &Values::from([("n".to_owned(), "7".to_owned())])).unwrap();
        let expected = "<title>A</title>b\n    <script type=\"module\" src=\"a.js\"></script>\n\
                        <li><a href=\"a.html\" aria-current=\"page\">A</a>\n<p>7</p>\n";
        assert_eq!(whole, expected);
        assert!(page(layout, "a.html", "<!-- title: A -->\n<p></p>", &Values::new()).is_err());
        assert!(page(layout, "a.html", text, &Values::new()).is_err());
    }
}
