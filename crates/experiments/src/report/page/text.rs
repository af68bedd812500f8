//! Text in HTML and in scripts: whatever names specs give, they stay text.

use serde::Serialize;

/// A text as HTML shows it, within elements and within quoted attributes.
pub(super) fn escaped(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            '\'' => html.push_str("&#39;"),
            _ => html.push(c),
        }
    }
    html
}

/// A value as JSON within a script element, which no string in it can end.
pub(super) fn in_script(value: &impl Serialize) -> String {
    let json = serde_json::to_string(value).expect("maps with string keys and numbers always have a JSON form");
    // These three stand in strings only.
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

/// A template with each `{{name}}` replaced; what is put in is not looked at again.
pub(super) fn fill(template: &str, parts: &[(&str, String)]) -> String {
    let mut pieces = template.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").expect("every place in the template is closed");
        let part = parts.iter().find(|(known, _)| *known == name);
        page.push_str(&part.expect("every place in the template has a part").1);
        page.push_str(rest);
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_becomes_markup() {
        assert_eq!(escaped("<b a=\"x\" b='y'>&"), "&lt;b a=&quot;x&quot; b=&#39;y&#39;&gt;&amp;");
        let json = in_script(&["</script><!--", "&amp;"]);
        assert!(!json.contains(['<', '>', '&']));
        assert_eq!(serde_json::from_str::<Vec<String>>(&json).unwrap(), ["</script><!--", "&amp;"]);
    }

    #[test]
    fn parts_are_not_templates() {
        let parts = [("a", "{{b}}".to_owned()), ("b", "2".to_owned())];
        assert_eq!(fill("x {{a}} y {{b}} z", &parts), "x {{b}} y 2 z");
    }
}
