//! The procedural medium of a student's renderer, from its XML scenes.

use super::format::{Key, Kind, Range as Domain, Table};
use super::reader::{Document, Reader, Reading};
use super::{SceneError, SceneResult};
use crate::optics::{Asymmetry, Coefficients};
use crate::volume::{FractalDensity, FractalParameters, MOST_OCTAVES};
use roxmltree::{Attribute, Node, ParsingOptions};
use std::cell::RefCell;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A medium of fractal noise: the density multiplies both coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct ProceduralMedium {
    /// Absorption and scattering of density 1, per world length.
    pub coefficients: Coefficients,
    /// The density.
    pub density: FractalDensity,
    /// Mean cosine of Henyey and Greenstein's phase function, if the block has one; else scattering
    /// is isotropic.
    pub asymmetry: Option<Asymmetry>,
    /// Every parameter with its value, and whether the block gives it.
    pub readings: Vec<Reading>,
}

/// Reads the one `<medium type="procedural">` of an XML text: the whole of it, or somewhere in a
/// larger scene, of which nothing else is looked at. `path` is the name shown in messages. Its parameters are put into
/// a TOML table, with their places in the text, which is read as others are.
///
/// Parameters are elements with a `name` and a `value`, in any order, each at most once:
///
/// | parameter | element | left out |
/// |---|---|---|
/// | `sigma_a`, `sigma_s` | `color` | 0, but one of the two is there |
/// | `nrOctaves` | `integer` | 4 |
/// | `lacunarity`, `gain` | `float` | 2, 0.5 |
/// | `maxDensity`, `threshold` | `float` | 1, 0 |
/// | `scale`, `offset` | `vector` | 1 1 1, 0 0 0 |
/// | `g` | `float` | isotropic scattering |
///
/// A `color` and a `vector` are three numbers with blanks or commas between; a `color` may be
/// one number for all three. The element means nothing but how many numbers there are. Other attributes are
/// ignored; an element that is no parameter is a mistake, for it would mean something that is not done.
///
/// There are no document types, hence no entities of one's own and nothing is ever fetched.
///
/// # Errors
///
/// [`SceneError`], with the place in the text.
pub fn read_procedural(path: &str, text: &str) -> SceneResult<ProceduralMedium> {
    let document = Document { path, text };
    if text.len() > MOST_BYTES {
        let message = format!("{} bytes are too many for a scene", text.len());
        let help = format!("at most {MOST_BYTES} are read; put the medium into a file of its own");
        return Err(document.error(None, message, Some(help)));
    }
    let options = ParsingOptions {
        allow_dtd: false,
        ..ParsingOptions::default()
    };
    let xml = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
        let at = offset_of(text, error.pos());
        let help =
            "give well-formed XML without document types: these and their entities are not read";
        document.error(Some(at..at), error.to_string(), Some(help.into()))
    })?;
    let is_procedural =
        |node: &Node| node.has_tag_name("medium") && node.attribute("type") == Some("procedural");
    let mut media = xml.descendants().filter(is_procedural);
    let medium = match (media.next(), media.next()) {
        (Some(medium), None) => medium,
        (_, other) => {
            let other = other.unwrap_or(xml.root_element());
            let message = "there is not exactly one procedural medium";
            return Err(wrong(&document, other, message));
        }
    };
    let mut parameters: Vec<Parameter> = Vec::new();
    for child in contents(medium) {
        let parameter = parameter(&document, child)?;
        let name = parameter.0.value();
        if parameters.iter().any(|(other, ..)| other.value() == name) {
            let message = "this parameter is given a second time";
            return Err(wrong(&document, child, message));
        }
        parameters.push(parameter);
    }
    let rows = parameters.iter().map(|(name, value, numbers)| {
        let numbers = DeValue::parse(numbers).expect("written as TOML");
        (
            Spanned::new(name.range_value(), name.value().into()),
            Spanned::new(value.range_value(), numbers.into_inner()),
        )
    });
    let table = Spanned::new(place(text, medium), DeTable::from_iter(rows));
    let log = RefCell::default();
    let reader = Reader::new(&document, &PARAMETERS, &table, &log)?;
    // Each is finite by declaration, their sum need not be.
    let coefficients = Coefficients::new(reader.get("sigma_a")?, reader.get("sigma_s")?);
    let coefficients = reader.accepted_at("sigma_a", coefficients)?;
    let parameters = FractalParameters {
        octaves: reader.get("nrOctaves")?,
        lacunarity: reader.get("lacunarity")?,
        gain: reader.get("gain")?,
        max_density: reader.get("maxDensity")?,
        threshold: reader.get("threshold")?,
        scale: reader.get("scale")?,
        offset: reader.get("offset")?,
    };
    let density = reader.accepted(FractalDensity::new(parameters))?;
    let sigma_t = coefficients.sigma_t().max_element();
    if !(sigma_t * parameters.max_density).is_finite() {
        let message = format!(
            "a density of up to {:e} times coefficients of up to {sigma_t:e} overflows",
            parameters.max_density
        );
        return Err(reader.error("maxDensity", message));
    }
    let g = reader.optional("g")?.map(Asymmetry::new);
    Ok(ProceduralMedium {
        coefficients,
        density,
        asymmetry: g.map(|g| reader.accepted(g)).transpose()?,
        readings: log.take(),
    })
}

/// The parser compares each attribute of an element with all others of it: more text than this,
/// were it all attributes, would take seconds.
const MOST_BYTES: usize = 1 << 18;

/// The parameters of the medium.
const PARAMETERS: Table = Table::new("A procedural medium.").keys(&[
    Key::or("sigma_a", Kind::Colour(Domain::NOT_NEGATIVE), "0.0")
        .doc("absorption of density 1, per world length: three numbers, or one for all three, at least 0"),
    Key::or("sigma_s", Kind::Colour(Domain::NOT_NEGATIVE), "0.0")
        .doc("scattering of density 1, per world length: three numbers, or one for all three, at least 0"),
    Key::or("nrOctaves", Kind::Count(1, MOST_OCTAVES as u64), "4")
        .doc("how many layers of noise are added, a whole number from 1 to 32"),
    Key::or("lacunarity", Kind::Number(Domain::POSITIVE), "2.0")
        .doc("factor on the frequency from one octave to the next, above 0"),
    Key::or("gain", Kind::Number(Domain::POSITIVE), "0.5")
        .doc("factor on the amplitude from one octave to the next, above 0"),
    Key::or("maxDensity", Kind::Number(Domain::NOT_NEGATIVE), "1.0")
        .doc("the largest density, at least 0"),
    Key::or("threshold", Kind::Number(Domain::FINITE), "0.0")
        .doc("densities up to this one count as 0"),
    Key::or("scale", Kind::Vector, "[1.0, 1.0, 1.0]")
        .doc("cells of the first octave per world length along x, y and z: three numbers"),
    Key::or("offset", Kind::Vector, "[0.0, 0.0, 0.0]")
        .doc("position of the world's origin in the lattice of the first octave: three numbers"),
    Key::optional("g", Kind::Number(Domain::open(-1.0, 1.0)))
        .doc("mean cosine of Henyey and Greenstein's phase function, between -1 and 1, positive forward"),
]);

/// Byte of a place that counts rows and characters from 1.
fn offset_of(text: &str, position: roxmltree::TextPos) -> usize {
    let row = (position.row as usize).saturating_sub(1);
    let start: usize = text.split_inclusive('\n').take(row).map(str::len).sum();
    let column = (position.col as usize).saturating_sub(1);
    let within = text[start..].char_indices().nth(column);
    within.map_or(text.len(), |(at, _)| start + at)
}

/// A parameter: its name, its value, and the numbers of that as a value of TOML.
type Parameter<'a, 'i> = (Attribute<'a, 'i>, Attribute<'a, 'i>, String);

/// What stands in an element beside blanks and comments.
fn contents<'a, 'i>(element: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    let is_blank = |node: &Node| node.is_text() && node.text().unwrap_or("").trim().is_empty();
    let children = element.children();
    children.filter(move |it| !(it.is_comment() || it.is_pi() || is_blank(it)))
}

fn parameter<'a, 'i>(document: &Document, element: Node<'a, 'i>) -> SceneResult<Parameter<'a, 'i>> {
    let [name, value] = ["name", "value"].map(|name| {
        let attribute = element.attribute_node(name);
        let message = "this is no parameter, with a `name` and a `value`";
        attribute.ok_or_else(|| wrong(document, element, message))
    });
    let (name, value) = (name?, value?);
    let numbers = match &numbers(value.value())[..] {
        [one] if element.tag_name().name() != "vector" => one.clone(),
        several => format!("[{}]", several.join(", ")),
    };
    Ok((name, value, numbers))
}

/// The words of a text, as numbers of TOML where they are some, else as texts.
fn numbers(text: &str) -> Vec<String> {
    let number = |word: &str| match word.parse::<f64>() {
        Ok(number) if number.fract() == 0.0 && number.abs() < 1e15 => number.to_string(),
        Ok(number) if number.is_finite() => format!("{number:?}"),
        _ => toml::Value::from(word).to_string(),
    };
    let words = text.split(|c: char| c == ',' || c.is_whitespace());
    words.filter(|word| !word.is_empty()).map(number).collect()
}

/// A mistake in an element, or in a text.
fn wrong(document: &Document, element: Node, message: &str) -> Box<SceneError> {
    let help = "give one <medium type=\"procedural\"> of parameters, such as <float name=\"g\" value=\"0.5\"/> for the mean \
                cosine of Henyey and Greenstein's phase function";
    let place = place(document.text, element);
    document.error(Some(place), message, Some(help.into()))
}

/// Place of the first line of an element, or of a text.
fn place(text: &str, element: Node) -> Range<usize> {
    let range = element.range();
    let part = text[range.clone()].trim_start();
    let start = range.end - part.len();
    start..start + part.lines().next().unwrap_or("").len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::tests::failures_in;
    use crate::scene::Origin;
    use crate::volume::DensityField;
    use glam::DVec3;
    use proptest::prelude::*;

    const SOURCE: &str = include_str!("../../fixtures/scenes/procedural/source-block.xml");

    fn read(text: &str) -> SceneResult<ProceduralMedium> {
        read_procedural("medium.xml", text)
    }

    /// A block of these lines, the first of them line 2.
    fn block(lines: &str) -> String {
        format!("<medium type=\"procedural\">\n{lines}\n</medium>\n")
    }

    fn fault(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    const SIGMA: &str = "<color name='sigma_s' value='1 1 1'/>\n";

    #[test]
    fn the_block_of_the_source_loads_as_it_stands() {
        let medium = read(SOURCE).unwrap();
        assert_eq!(medium.coefficients.sigma_a(), DVec3::ONE);
        assert_eq!(medium.coefficients.sigma_s(), DVec3::splat(4.0));
        assert_eq!(medium.asymmetry, None);
        let parameters = FractalParameters {
            octaves: 10,
            lacunarity: 4.0,
            gain: 0.5,
            scale: DVec3::new(0.5, 1.0, 1.0),
            offset: DVec3::ZERO,
            max_density: 4.0,
            threshold: 1.25,
        };
        assert_eq!(*medium.density.parameters(), parameters);
        // All noise is 0 at the origin: the middle of the densities.
        assert_eq!(medium.density.density(DVec3::ZERO), 2.0);
        assert!(medium.readings.iter().all(|r| r.origin == Origin::Given));
    }

    #[test]
    fn other_ways_to_write_the_same() {
        let plain = read(SOURCE).unwrap();
        let commas = SOURCE
            .replace("0.5 1 1", "0.5,1,1")
            .replace("4 4 4", " 4, 4 ,4 ");
        let one_for_three = SOURCE.replace("1 1 1", "1");
        let mixed = SOURCE
            .replace("0 0 0", "0 0, 0e5")
            .replace("0.5 1 1", "0.5\t1\n+1.");
        let kinds = SOURCE
            .replace("<integer", "<float")
            .replace("<float name=\"gain\"", "<integer name=\"gain\"");
        let scene = format!(
            "\u{feff}<?xml version='1.0'?>\n<!-- <!DOCTYPE --><scene><mesh type='obj'>{SOURCE}</mesh>\n\
             <medium type='homogeneous'/></scene>"
        );
        let labelled = SOURCE
            .replace("type=", "id='fog' name='fog' type=")
            .replace("<integer", "<!-- many --><?editor fold?><integer id='n'");
        let explicit = SOURCE.replace(
            "<integer name=\"nrOctaves\" value=\"10\" />",
            "<integer name=\"nrOctaves\" value=\"10\"> <!-- many --> </integer>",
        );
        for (text, what) in [
            (commas, "commas"),
            (one_for_three, "one for three"),
            (mixed, "mixed"),
            (kinds, "kinds"),
            (scene, "scene"),
            (labelled, "labelled"),
            (explicit, "explicit"),
        ] {
            let medium = read(&text).unwrap_or_else(|error| panic!("{what}: {error}"));
            assert_eq!(medium, plain, "{what}");
        }
    }

    #[test]
    fn what_is_left_out_has_defaults() {
        let medium = read(&block(SIGMA)).unwrap();
        assert_eq!(*medium.density.parameters(), FractalParameters::default());
        assert_eq!(medium.coefficients.sigma_a(), DVec3::ZERO);
        let given = medium.readings.iter().filter(|r| r.origin == Origin::Given);
        assert_eq!(
            given.map(|r| r.key.as_str()).collect::<Vec<_>>(),
            ["sigma_s"]
        );
        let octaves = medium
            .readings
            .iter()
            .find(|r| r.key == "nrOctaves")
            .unwrap();
        assert_eq!(octaves.value, "4");
    }

    #[test]
    fn a_phase_function_may_be_given() {
        let text = block(&format!("{SIGMA}<float name='g' value='0.6'/>"));
        let g = read(&text).unwrap().asymmetry.map(Asymmetry::g);
        assert_eq!(g, Some(0.6));
        let text = block(&format!("{SIGMA}<float name='g' value='1'/>"));
        assert!(
            fault(&text).starts_with("medium.xml:3:24: "),
            "{}",
            fault(&text)
        );
        let text = block(&format!("{SIGMA}<phase type='hg'/>"));
        let error = read(&text).unwrap_err();
        assert_eq!(
            error.to_string(),
            "medium.xml:3:1: this is no parameter, with a `name` and a `value`"
        );
        assert!(error.help_text().unwrap().contains("<float name=\"g\""));
    }

    #[test]
    fn mistakes_in_a_parameter_name_their_place() {
        for (line, message) in [
            (
                "<float name='gian' value='1'/>",
                "3:14: unknown key `gian` in the file",
            ),
            (
                "<float name='' value='1'/>",
                "3:14: unknown key `` in the file",
            ),
            ("<float value='1'/>", "3:1: this is no parameter"),
            (
                "<float name='gain' valeu='1'/>",
                "3:1: this is no parameter",
            ),
            (
                "<vector name='gain' value='1'/>",
                "3:28: `gain` must be a number, not an array",
            ),
            (
                "<float name='scale' value='1'/>",
                "3:28: `scale` must be three numbers, such as [0, 1, 0], not an integer",
            ),
            (
                "<float name='gain' value=''/>",
                "3:27: `gain` must be a number, not an array",
            ),
            (
                "<float name='gain' value='1 2'/>",
                "3:27: `gain` must be a number, not an array",
            ),
            (
                "<vector name='scale' value='1'/>",
                "3:29: `scale` must be three numbers, such as [0, 1, 0]",
            ),
            (
                "<color name='sigma_a' value='1,2'/>",
                "3:30: `sigma_a` must be a colour: three numbers red, green, blue, such as [1, 0.5, 0], one for all three, or sRGB such as '#ff8000'",
            ),
            (
                "<float name='gain' value='0.5f'/>",
                "3:27: `gain` must be a number, not a string",
            ),
            (
                "<float name='gain' value='NaN'/>",
                "3:27: `gain` must be a number, not a string",
            ),
            (
                "<float name='gain' value='-inf'/>",
                "3:27: `gain` must be a number, not a string",
            ),
            (
                "<float name='gain' value='1e999'/>",
                "3:27: `gain` must be a number, not a string",
            ),
            (
                "<float name='gain' value='0'/>",
                "3:27: `gain` must be finite and above 0, got 0",
            ),
            (
                "<float name='gain' value='1e200'/>",
                "3:27: gain 1e200 makes the amplitudes of 4 octaves overflow",
            ),
            (
                "<float name='lacunarity' value='1e200'/>",
                "3:33: lacunarity 1e200 makes the frequency of octave 4 overflow",
            ),
            (
                "<float name='maxDensity' value='-1'/>",
                "3:33: `maxDensity` must be finite and at least 0, got -1",
            ),
            (
                "<integer name='nrOctaves' value='2.5'/>",
                "3:34: `nrOctaves` must be a whole number from 1 to 32, not a float",
            ),
            (
                "<integer name='nrOctaves' value='0'/>",
                "3:34: `nrOctaves` must lie in [1, 32], got 0",
            ),
            (
                "<integer name='nrOctaves' value='1e300'/>",
                "3:34: `nrOctaves` must be a whole number from 1 to 32, not a float",
            ),
            (
                "<color name='sigma_a' value='0 -1 0'/>",
                "3:30: `sigma_a` must be finite and at least 0 in every channel",
            ),
            (
                "<color name='sigma_s' value='2'/>",
                "3:1: this parameter is given a second time",
            ),
            ("  0.5", "3:3: this is no parameter"),
        ] {
            let fault = fault(&block(&format!("{SIGMA}{line}")));
            assert!(
                fault.starts_with(&format!("medium.xml:{message}")),
                "{line}: {fault}"
            );
        }
    }

    #[test]
    fn misspellings_are_recognised() {
        let help = |line: &str| {
            let error = read(&block(&format!("{SIGMA}{line}"))).unwrap_err();
            error.help_text().unwrap().to_owned()
        };
        assert_eq!(
            help("<float name='gian' value='1'/>"),
            "did you mean `gain`?"
        );
        assert_eq!(
            help("<float name='maxdensity' value='1'/>"),
            "did you mean `maxDensity`?"
        );
        let all = help("<float name='colour of the sky' value='1'/>");
        assert!(
            all.contains("sigma_a, sigma_s, nrOctaves, lacunarity, gain"),
            "{all}"
        );
    }

    #[test]
    fn there_is_one_medium_and_it_does_something() {
        for (text, message) in [
            (
                "<scene/>",
                "1:1: there is not exactly one procedural medium",
            ),
            (
                "<medium/>",
                "1:1: there is not exactly one procedural medium",
            ),
        ] {
            assert_eq!(fault(text), format!("medium.xml:{message}"));
        }
        let two = format!("<scene>\n{}\n{}</scene>", SOURCE, SOURCE);
        assert_eq!(
            fault(&two),
            "medium.xml:10:1: there is not exactly one procedural medium"
        );
        let overflow = SOURCE.replace("\"4 4 4\"", "\"1e308\"");
        assert!(fault(&overflow).starts_with("medium.xml:4:35: a density of up to 4e0"));
        let overflow = overflow.replace("\"1 1 1\" /> <c", "\"1e308\" /> <c");
        assert!(
            fault(&overflow).contains(": sigma_t must be finite"),
            "{}",
            fault(&overflow)
        );
    }

    #[test]
    fn document_types_and_entities_are_refused() {
        let with_dtd = |dtd: &str, value: &str| {
            let medium = block(&format!("<float name='gain' value='{value}'/>"));
            format!("<?xml version='1.0'?>\n  <!DOCTYPE medium {dtd}>\n{medium}")
        };
        let bomb = "[<!ENTITY a '1111111111'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>\
                    <!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;'>]";
        for text in [
            with_dtd("", "1"),
            with_dtd(bomb, "&c;"),
            with_dtd("[<!ENTITY a SYSTEM 'file:///etc/hostname'>]", "&a;"),
            with_dtd("SYSTEM 'http://example.org/medium.dtd'", "1"),
        ] {
            assert!(fault(&text).contains("DTD"), "{}", fault(&text));
        }
        let text = block("<float name='gain' value='&amp;&a;'/>");
        assert!(
            fault(&text).starts_with("medium.xml:2:"),
            "{}",
            fault(&text)
        );
        assert!(fault(&text).contains("unknown entity reference 'a'"));
        // Characters by number are no entities of anybody's.
        let text = block(&format!("{SIGMA}<float name='gain' value='&#48;.5'/>"));
        assert_eq!(read(&text).unwrap().density.parameters().gain, 0.5);
    }

    #[test]
    fn malformed_text_names_its_place() {
        for (text, position) in [
            ("", "1:1: "),
            ("gain = 0.5", "1:1: "),
            ("<medium type='procedural'>\n", "1:1: "),
            ("<medium type='proce", "1:1: "),
            ("<medium>\n<a></b></medium>", "2:4: "),
            ("<medium type='procedural' type='x'/>", "1:27: "),
            ("<a/>\n<b/>", "2:1: "),
        ] {
            let fault = fault(text);
            assert!(
                fault.starts_with(&format!("medium.xml:{position}")),
                "{text:?}: {fault}"
            );
        }
        let long = "<!-- -->".repeat(MOST_BYTES / 8 + 1);
        assert!(fault(&long).contains("bytes are too many"));
    }

    #[test]
    fn deep_nesting_takes_no_stack() {
        // Threads of tests have 2 MB of it.
        let levels = MOST_BYTES / 8;
        let deep = format!("{}{}", "<a>".repeat(levels), "</a>".repeat(levels));
        assert!(fault(&deep).contains("there is not exactly one procedural medium"));
        let deep = block(&format!(
            "<float name='gain' value='1'>{}",
            &deep[8192..deep.len() - 10_924]
        ));
        assert!(fault(&deep).starts_with("medium.xml:"));
        let open = "<a>".repeat(levels);
        assert!(fault(&open).starts_with("medium.xml:1:1: "));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..failures_in("fixtures/proptest-regressions/procedural_xml.txt") })]

        /// No text makes the reader panic, and every complaint has words.
        #[test]
        fn any_text_is_read_or_refused(
            text in prop_oneof![
                any::<String>(),
                "(<|</|/>|>|medium|type|procedural|float|name|value|gain|=|'|\"| |\n|&|;|#|!--|-->|0|,|é)*",
            ],
        ) {
            if let Err(error) = read(&text) {
                prop_assert!(!error.to_string().is_empty());
            }
        }

        /// Nor does the source's block with pieces cut out, doubled or put in.
        #[test]
        fn broken_blocks_are_read_or_refused(
            edits in prop::collection::vec((any::<prop::sample::Index>(), 0..12_usize, "\\PC{0,4}"), 1..4),
        ) {
            let mut text: Vec<char> = SOURCE.chars().collect();
            for (at, cut, put) in edits {
                let at = at.index(text.len());
                let end = (at + cut).min(text.len());
                text.splice(at..end, put.chars());
            }
            let text: String = text.into_iter().collect();
            if let Err(error) = read(&text) {
                prop_assert!(error.to_string().starts_with("medium.xml"));
                prop_assert!(error.position().is_some());
            }
        }
    }
}
