//! Pages by templates, and images within them.

use crate::files::visible::{visible, xml_text};
use crate::film::Film;
use minijinja::{Environment, Value, context};

/// A kind of page: blocks of the skeleton, a style and a script beside the common ones.
pub(super) struct Template {
    pub blocks: &'static str,
    pub style: &'static str,
    /// Empty for a page without one.
    pub script: &'static str,
}

/// The page of a template and what it asks for, a complete HTML file. Text is escaped, and [`visible`].
pub(super) fn rendered(template: &Template, context: Value) -> String {
    let mut environment = Environment::new();
    let page = environment.add_template("skeleton.html", include_str!("template/skeleton.html"));
    let context = context! {
        common => include_str!("template/common.css"),
        style => template.style,
        script => template.script,
        version => env!("CARGO_PKG_VERSION"),
        ..context
    };
    // Escaped because the name ends like this.
    let page =
        page.and_then(|()| environment.render_named_str("page.html", template.blocks, context));
    let page = page.expect("the template is well-formed and asks only for what it is given");
    // A checkout may have given the template other ends of lines.
    visible(&page.replace("\r\n", "\n"))
}

/// The text of a template of XML and what it asks for; its filter `xml` escapes text.
pub(super) fn xml(template: &str, context: Value) -> String {
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_keep_trailing_newline(true);
    environment.add_filter("xml", |text: String| xml_text(&text));
    // A checkout may have given the template other ends of lines.
    let text = environment.render_str(&template.replace("\r\n", "\n"), context);
    text.expect("the template is well-formed and asks only for what it is given")
}

/// The address of a PNG image of 8-bit codes, row by row from the top.
pub(super) fn image_address(codes: &[[u8; 3]], columns: usize, rows: usize) -> String {
    let png = data_encoding::BASE64.encode(&Film::codes_to_png(codes, columns, rows));
    format!("data:image/png;base64,{png}")
}

/// The colour of a share, cut off at −1 and 1: by the root of its size, so that small ones are seen beside large ones.
pub(crate) fn signed_colour(share: f64) -> [u8; 3] {
    let share = share.clamp(-1.0, 1.0);
    blue_to_red(share.abs().sqrt().copysign(share))
}

/// The colour of a share from −1, blue, to 1, red.
pub(super) fn blue_to_red(share: f64) -> [u8; 3] {
    let from_red = 0.5 - 0.5 * share;
    colorous::RED_BLUE.eval_continuous(from_red).into_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_seen() {
        let template = Template {
            blocks: "{% extends 'skeleton.html' %}{% block body %}<p>{{ text }}\r\n</p>{% endblock %}",
            style: "",
            script: "",
        };
        let page = rendered(&template, context! { text => "\x1b[31m\0<b>\u{202e}" });
        assert!(page.contains("<p>␛[31m␀&lt;b&gt;�\n</p>"), "{page}");
    }
}
