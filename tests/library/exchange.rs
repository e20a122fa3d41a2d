//! Scenes for other renderers: what is written, and what is refused by name.

use crate::common::suite::scene_files;
use std::collections::BTreeSet;
use std::path::Path;
use volref::exchange::{Export, Format, Refusal, export};
use volref::scene::Scene;

/// A scene of 4 × 3 pixels before a camera on the -z side.
fn scene(body: &str) -> Scene {
    let text = format!(
        "[film]\nwidth = 4\nheight = 3\n\n[camera]\neye = [0, 1, -6]\ntarget = [0, 1, 0]\n\
         vertical_fov = 40\n\n[radiative]\n{body}"
    );
    Scene::parse(&text, Path::new("scene.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn write(body: &str, format: Format) -> Result<Export, Refusal> {
    export(&scene(body), format, "scene", None)
}

fn text_of(export: &Export, name: &str) -> String {
    let (_, bytes) = (export.files.iter())
        .find(|(other, _)| other == name)
        .unwrap_or_else(|| panic!("no {name}"));
    String::from_utf8(bytes.clone()).unwrap()
}

fn mitsuba(body: &str) -> String {
    let export = write(body, Format::Mitsuba).unwrap();
    check_xml(&export);
    text_of(&export, &export.main)
}

fn pbrt(body: &str) -> String {
    let export = write(body, Format::Pbrt).unwrap();
    check_pbrt(&export);
    text_of(&export, &export.main)
}

/// What is refused, each fault on a line.
fn faults(body: &str, format: Format) -> String {
    let refusal = write(body, format).unwrap_err();
    assert_eq!(refusal.format, format);
    refusal.faults.join("\n")
}

/// The part of a text from the line that holds `from` to the line that is `to`.
fn part<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    let start = text
        .find(from)
        .unwrap_or_else(|| panic!("{from:?} is not in {text}"));
    let start = text[..start].rfind('\n').map_or(0, |end| end + 1);
    let end = text[start..].find(to).unwrap() + start;
    &text[start..end]
}

// --- What is well formed ------------------------------------------------------------------------

/// That every file is XML or something it names, every parameter is declared, and every
/// reference leads somewhere.
fn check_xml(export: &Export) {
    let names: BTreeSet<&str> = export.files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names.len(), export.files.len(), "names are unique");
    assert!(names.contains(export.main.as_str()));
    let texts = names.iter().filter(|name| name.ends_with(".xml"));
    let texts: Vec<(&str, String)> = texts.map(|name| (*name, text_of(export, name))).collect();
    let documents: Vec<_> = texts
        .iter()
        .map(|(name, text)| (*name, roxmltree::Document::parse(text).unwrap()))
        .collect();
    let attribute = |node: &roxmltree::Node, name: &str| node.attribute(name).unwrap().to_owned();
    let (_, main) = documents
        .iter()
        .find(|(name, _)| *name == export.main)
        .unwrap();
    let parameters: BTreeSet<String> = main
        .descendants()
        .filter(|node| node.has_tag_name("default"))
        .map(|node| attribute(&node, "name"))
        .collect();
    let mut ids = Vec::new();
    let mut references = Vec::new();
    let mut files = Vec::new();
    for (name, document) in &documents {
        let is_channel = *name != export.main;
        for node in document.descendants().filter(roxmltree::Node::is_element) {
            if let Some(id) = node.attribute("id") {
                match node.has_tag_name("ref") {
                    true => references.push(id.to_owned()),
                    false if is_channel && !name.contains(".red.") => {}
                    false => ids.push(id.to_owned()),
                }
            }
            match node.tag_name().name() {
                "string" if node.attribute("name") == Some("filename") => {
                    files.push(attribute(&node, "value"));
                }
                "include" => {
                    let file = attribute(&node, "filename");
                    let channels = ["red", "green", "blue"];
                    files.extend(channels.map(|channel| file.replace("$channel", channel)));
                }
                _ => {}
            }
            for attribute in node.attributes() {
                let mut used = attribute.value().split('$').skip(1);
                assert!(
                    used.all(|rest| {
                        parameters
                            .iter()
                            .any(|name| rest.starts_with(name.as_str()))
                    }),
                    "{} is declared",
                    attribute.value()
                );
            }
        }
    }
    let unique: BTreeSet<&String> = ids.iter().collect();
    assert_eq!(unique.len(), ids.len(), "ids are unique");
    for reference in references {
        assert!(ids.contains(&reference), "{reference} is no id");
    }
    for file in &files {
        assert!(names.contains(file.as_str()), "{file} was not written");
    }
    for name in names {
        let is_used = name == export.main || files.iter().any(|file| file == name);
        assert!(is_used, "{name} is used");
    }
}

/// A word of a pbrt scene.
#[derive(Debug, PartialEq)]
enum Token {
    Word(String),
    Text(String),
    Number(f64),
    Open,
    Close,
}

fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    for line in text.lines() {
        let mut rest = line.trim_start();
        while !rest.is_empty() && !rest.starts_with('#') {
            if let Some(quoted) = rest.strip_prefix('"') {
                let end = quoted.find('"').expect("a string ends on its line");
                tokens.push(Token::Text(quoted[..end].to_owned()));
                rest = quoted[end + 1..].trim_start();
                continue;
            }
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            let word = &rest[..end];
            // At 63 characters pbrt's parser ends the program; whole numbers have 63 bits.
            assert!(word.len() < 63, "{word}");
            if word.bytes().all(|byte| byte.is_ascii_digit()) {
                assert!(word.parse::<i64>().is_ok(), "{word}");
            }
            tokens.push(match word {
                "[" => Token::Open,
                "]" => Token::Close,
                _ => match word.parse::<f64>() {
                    Ok(number) => {
                        assert!(number.is_finite(), "{word}");
                        Token::Number(number)
                    }
                    Err(_) => Token::Word(word.to_owned()),
                },
            });
            rest = rest[end..].trim_start();
        }
    }
    tokens
}

/// A directive: its name, its words and numbers, its parameters with how many values each has.
struct Directive {
    name: String,
    texts: Vec<String>,
    parameters: Vec<(String, usize, Vec<String>)>,
}

/// Reads a pbrt scene by the grammar of the format: directive, strings and numbers that it is
/// followed by, then parameters of `"type name" [ values ]`.
fn directives(text: &str) -> Vec<Directive> {
    // As many strings and numbers as each takes.
    let arity = |name: &str| match name {
        "Scale" | "Translate" => (0, 3),
        "LookAt" => (0, 9),
        "ConcatTransform" => (0, 16),
        "Identity" | "WorldBegin" | "AttributeBegin" | "AttributeEnd" => (0, 0),
        "MediumInterface" => (2, 0),
        "Camera" | "Film" | "PixelFilter" | "Sampler" | "Integrator" | "LightSource"
        | "AreaLightSource" | "Material" | "MakeNamedMaterial" | "MakeNamedMedium" | "Shape" => {
            (1, 0)
        }
        _ => panic!("{name} is no directive of pbrt's"),
    };
    let types = [
        "float", "integer", "bool", "string", "rgb", "spectrum", "point3",
    ];
    let mut tokens = tokens(text).into_iter().peekable();
    let mut directives: Vec<Directive> = Vec::new();
    while let Some(token) = tokens.next() {
        let Token::Word(name) = token else {
            panic!("{token:?} begins no directive");
        };
        let (texts, numbers) = arity(&name);
        let mut directive = Directive {
            name,
            texts: Vec::new(),

            parameters: Vec::new(),
        };
        for _ in 0..texts {
            let Some(Token::Text(text)) = tokens.next() else {
                panic!("{} lacks a string", directive.name);
            };
            directive.texts.push(text);
        }
        let bracketed = tokens.next_if_eq(&Token::Open).is_some();
        for _ in 0..numbers {
            assert!(matches!(tokens.next(), Some(Token::Number(_))));
        }
        assert_eq!(tokens.next_if_eq(&Token::Close).is_some(), bracketed);
        while let Some(Token::Text(declared)) = tokens.next_if(|t| matches!(t, Token::Text(_))) {
            let (kind, name) = declared.split_once(' ').expect("type and name");
            assert!(types.contains(&kind), "{kind} is a type");
            assert_eq!(tokens.next(), Some(Token::Open));
            let (mut count, mut texts) = (0, Vec::new());
            loop {
                match tokens.next().expect("a bracket is closed") {
                    Token::Close => break,
                    Token::Number(number) => {
                        assert!(kind != "string" && kind != "bool", "{declared}");
                        assert!(kind != "integer" || number.fract() == 0.0, "{declared}");
                    }
                    Token::Text(text) => {
                        assert_eq!(kind, "string");
                        texts.push(text);
                    }
                    Token::Word(word) => {
                        assert!(
                            kind == "bool" && (word == "true" || word == "false"),
                            "{word}"
                        );
                    }
                    Token::Open => panic!("brackets in brackets"),
                }
                count += 1;
            }
            let whole = match kind {
                "rgb" | "point3" => count % 3 == 0,
                "spectrum" => count % 2 == 0,
                _ => count > 0,
            };
            assert!(whole, "{declared} has {count} values");
            directive.parameters.push((name.to_owned(), count, texts));
        }
        directives.push(directive);
    }
    directives
}

/// That every pbrt file is read by the grammar, opens and closes what it should, and names only
/// what there is.
fn check_pbrt(export: &Export) {
    let names: BTreeSet<&str> = export.files.iter().map(|(name, _)| name.as_str()).collect();
    let scenes = names.iter().filter(|name| name.ends_with(".pbrt"));
    for name in scenes {
        let directives = directives(&text_of(export, name));
        let count = |name: &str| directives.iter().filter(|d| d.name == name).count();
        for once in [
            "Camera",
            "Film",
            "PixelFilter",
            "Sampler",
            "Integrator",
            "WorldBegin",
            "LookAt",
        ] {
            assert_eq!(count(once), 1, "{once} in {name}");
        }
        let place = |name: &str| directives.iter().position(|d| d.name == name).unwrap();
        let world = place("WorldBegin");
        let mut media = BTreeSet::from([String::new()]);
        let mut materials = BTreeSet::new();
        let mut depth = 0;
        for (at, directive) in directives.iter().enumerate() {
            let in_world = at > world;
            let first = directive.texts.first().cloned().unwrap_or_default();
            match directive.name.as_str() {
                "AttributeBegin" => depth += 1,
                "AttributeEnd" => depth -= 1,
                "MakeNamedMedium" => {
                    // Where it is after the camera, and the eye may be in it.
                    assert!(at > place("Camera") && !in_world);
                    assert!(media.insert(first), "a medium is named once");
                }
                "MakeNamedMaterial" => {
                    assert!(materials.insert(first), "a material is named once");
                }
                "Shape" | "Material" | "AreaLightSource" => assert!(in_world && depth == 1),
                "LightSource" => assert!(in_world && depth == 0),
                _ => {}
            }
            for (name, _, texts) in &directive.parameters {
                match name.as_str() {
                    "filename" if directive.name == "Shape" => {
                        assert!(names.contains(texts[0].as_str()), "{texts:?} was written");
                    }
                    "materials" => {
                        assert!(texts.iter().all(|text| materials.contains(text)));
                    }
                    _ => {}
                }
            }
            if let Some((_, values, _)) = directive.parameters.iter().find(|p| p.0 == "density") {
                let axis = |name: &str| directive.parameters.iter().any(|p| p.0 == name);
                assert!(axis("nx") && axis("ny") && axis("nz") && *values >= 27);
            }
            assert!(depth == 0 || depth == 1);
        }
        assert_eq!(depth, 0);
        for directive in directives.iter().filter(|d| d.name == "MediumInterface") {
            for medium in &directive.texts {
                assert!(media.contains(medium), "{medium} is a medium");
            }
        }
    }
}

// --- Every case ---------------------------------------------------------------------------------

/// Every radiative scene of the suite: in how many files it is written, or what stands in the
/// way.
#[test]
fn the_suite() {
    let mut table = String::new();
    let files = scene_files();
    for family in ["fog/", "smoke/", "procedural/"] {
        for (name, path) in files.iter().filter(|(name, _)| name.starts_with(family)) {
            let scene = Scene::load(path).unwrap();
            let name = &name[family.len()..];
            for format in [Format::Mitsuba, Format::Pbrt] {
                let outcome = match export(&scene, format, name, None) {
                    Ok(export) => {
                        match format {
                            Format::Mitsuba => check_xml(&export),
                            _ => check_pbrt(&export),
                        }
                        let names = export.files.iter().map(|(name, _)| name.as_str());
                        names.collect::<Vec<_>>().join(", ")
                    }
                    Err(refusal) => refusal.to_string(),
                };
                table.push_str(&format!("{family}{name} {format}: {outcome}\n"));
            }
        }
    }
    insta::assert_snapshot!("suite", table);
}

// --- Words --------------------------------------------------------------------------------------

const ROOM: &str = r#"
environment = [0.1, 0.2, 0.3]
max_bounces = 5

[[radiative.surface]]
rectangle = { corner = [-5, 0, -5], edge_u = [0, 0, 10], edge_v = [10, 0, 0] }
diffuse = { reflectance = 0.5 }

[[radiative.surface]]
rectangle = { corner = [-1, 3, -1], edge_u = [2, 0, 0], edge_v = [0, 0, 2] }
emitter = { radiance = 5, sides = "both" }

[[radiative.surface]]
sphere = { centre = [2, 1, 0], radius = 0.5 }
scale = [2, 2, 2]
glass = { index = 1.5 }

[[radiative.surface]]
box = { min = [-4, 1, 3], max = [-3, 2, 4] }
emitter = { radiance = [1, 2, 3] }

[[radiative.medium]]
box = { min = [-2, 0, -2], max = [2, 2, 2] }
sigma_a = 0.5
sigma_s = [1, 2, 1.5]
g = 0.25
"#;

#[test]
fn a_room_for_mitsuba() {
    insta::assert_snapshot!("room_for_mitsuba", mitsuba(ROOM));
}

#[test]
fn a_room_for_pbrt() {
    insta::assert_snapshot!("room_for_pbrt", pbrt(ROOM));
}

#[test]
fn grey_scenes_need_one_file_of_pbrt_and_coloured_ones_three() {
    let grey = ROOM
        .replace("[0.1, 0.2, 0.3]", "0.1")
        .replace("[1, 2, 3]", "2")
        .replace("[1, 2, 1.5]", "1");
    let names = |body: &str| {
        let export = write(body, Format::Pbrt).unwrap();
        check_pbrt(&export);
        let names = export.files.iter().map(|(name, _)| name.clone());
        names.collect::<Vec<_>>()
    };
    assert_eq!(names(&grey), ["scene.pbrt", "scene.mesh0.ply"]);
    let coloured = names(ROOM);
    let expected = ["scene.red.pbrt", "scene.green.pbrt", "scene.blue.pbrt"];
    assert_eq!(coloured[..3], expected);
    let export = write(ROOM, Format::Pbrt).unwrap();
    for (file, sigma_s) in expected.iter().zip(["1", "2", "1.5"]) {
        let line = format!("\"rgb sigma_s\" [ {sigma_s} {sigma_s} {sigma_s} ]");
        assert!(text_of(&export, file).contains(&line), "{file}");
    }
}

#[test]
fn a_mirror_of_pbrt_is_mixed_with_black() {
    let body = "[[radiative.surface]]\nsphere = { centre = [0, 1, 0], radius = 1 }\n\
                mirror = { reflectance = 0.9 }\n\
                [[radiative.surface]]\nsphere = { centre = [3, 1, 0], radius = 1 }\n\
                mirror = { reflectance = 0.8 }\n";
    let text = pbrt(body);
    assert_eq!(text.matches("MakeNamedMaterial \"mirror\"").count(), 1);
    for amount in ["0.9", "0.8"] {
        let mix = format!("[ \"black\" \"mirror\" ] \"float amount\" [ {amount} ]");
        assert!(text.contains(&mix), "{text}");
    }
}

// --- Media in media -----------------------------------------------------------------------------

/// A ball in a box, both in a wide box that the eye is in.
fn nested(ball: &str) -> String {
    format!(
        "[[radiative.medium]]\nsphere = {{ centre = [0, 1, 0], radius = 0.5 }}\n{ball}\n\
         [[radiative.medium]]\nbox = {{ min = [-2, 0, -2], max = [2, 2, 2] }}\nsigma_s = 2\n\
         g = -0.5\n\
         [[radiative.medium]]\nbox = {{ min = [-9, -9, -9], max = [9, 9, 9] }}\nsigma_a = 1\n"
    )
}

#[test]
fn media_in_media_add_up() {
    let text = mitsuba(&nested("sigma_s = 1\nsigma_a = 2\ng = 0.3"));
    // 1 and 2 of scattering, 2 and 1 of absorption.
    insta::assert_snapshot!(part(&text, "id=\"medium0\"", "    <medium type=\"homogeneous\" id=\"medium1\""), @r##"
    <medium type="homogeneous" id="medium0">
        <float name="sigma_t" value="6"/>
        <rgb name="albedo" value="0.5, 0.5, 0.5"/>
        <boolean name="has_spectral_extinction" value="false"/>
        <phase type="blendphase">
            <float name="weight" value="0.6666666666666666"/>
            <phase type="hg">
                <float name="g" value="0.3"/>
            </phase>
            <phase type="hg">
                <float name="g" value="-0.5"/>
            </phase>
        </phase>
    </medium>
    "##);
    insta::assert_snapshot!(part(&text, "<!-- radiative.medium[0] -->", "    <!-- radiative.medium[2]"), @r##"
    <!-- radiative.medium[0] -->
    <shape type="sphere">
        <point name="center" x="0" y="1" z="0"/>
        <float name="radius" value="0.5"/>
        <bsdf type="null"/>
        <ref name="interior" id="medium0"/>
        <ref name="exterior" id="medium1"/>
    </shape>
    <!-- radiative.medium[1] -->
    <shape type="cube">
        <transform name="to_world"><matrix value="2 0 0 0 0 1 0 1 0 0 2 0 0 0 0 1"/></transform>
        <bsdf type="null"/>
        <ref name="interior" id="medium1"/>
        <ref name="exterior" id="medium2"/>
    </shape>
    "##);
    let sensor = part(&text, "<sensor", "</sensor>");
    assert!(
        sensor.contains("<ref name=\"medium\" id=\"medium2\"/>"),
        "{sensor}"
    );
}

#[test]
fn one_phase_function_needs_no_blend() {
    let text = mitsuba(&nested("sigma_s = 3\ng = -0.5"));
    assert!(!text.contains("blendphase") && !text.contains("channel"));
    let text = pbrt(&nested("sigma_s = 1\ng = -0.5"));
    insta::assert_snapshot!(part(&text, "MediumInterface \"\" \"medium2\"", "\nWorldBegin"), @r##"
    MediumInterface "" "medium2"
    Camera "perspective" "float fov" [ 40 ]
    Film "rgb" "integer xresolution" [ 4 ] "integer yresolution" [ 3 ] "string filename" [ "scene.exr" ] "bool savefp16" [ false ]
    PixelFilter "box" "float xradius" [ 0.5 ] "float yradius" [ 0.5 ]
    Sampler "independent" "integer pixelsamples" [ 64 ]
    Integrator "volpath" "integer maxdepth" [ 1000000 ]

    Identity
    MakeNamedMedium "medium0" "string type" [ "homogeneous" ]
        "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 3 3 3 ] "float g" [ -0.5 ]

    Identity
    MakeNamedMedium "medium1" "string type" [ "homogeneous" ]
        "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 2 2 2 ] "float g" [ -0.5 ]

    Identity
    MakeNamedMedium "medium2" "string type" [ "homogeneous" ]
        "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 0 0 0 ] "float g" [ 0 ]
    "##);
}

#[test]
fn what_differs_by_channel_has_files_of_its_own() {
    let export = write(&nested("sigma_s = [1, 2, 6]\ng = 0.3"), Format::Mitsuba).unwrap();
    check_xml(&export);
    let main = text_of(&export, &export.main);
    assert!(main.contains("<default name=\"channel\" value=\"red\"/>"));
    assert!(main.contains("<include filename=\"scene.$channel.xml\"/>"));
    // The second of the two is the box, with 2 of 3, 4 and 8.
    for (channel, weight) in [("red", 2.0 / 3.0), ("green", 0.5), ("blue", 0.25)] {
        let text = text_of(&export, &format!("scene.{channel}.xml"));
        let weight = format!("<float name=\"weight\" value=\"{weight}\"/>");
        assert!(text.contains(&weight), "{channel}: {text}");
    }
}

// --- Boundaries and surfaces --------------------------------------------------------------------

fn fog_on_floor(floor: &str, bottom: f64) -> String {
    format!(
        "[[radiative.surface]]\n{floor}\n\
         [[radiative.medium]]\nbox = {{ min = [-2, {bottom}, -2], max = [2, 2, 2] }}\nsigma_s = 1\n"
    )
}

const FLOOR_TABLE: &str = "[[radiative.surface]]\nrectangle = { corner = [-5, -1, -5], \
                           edge_u = [10, 0, 0], edge_v = [0, 0, 10] }\n\
                           diffuse = { reflectance = 0.5 }";

const FLOOR: &str = "rectangle = { corner = [-5, 0, -5], edge_u = [10, 0, 0], edge_v = [0, 0, 10] }\n\
                     diffuse = { reflectance = 0.5 }";

#[test]
fn faces_in_surfaces_are_moved_behind_them_and_others_are_not() {
    // The largest coordinate is that of the eye, 6: 5e-4 times 7.
    let moved = mitsuba(&fog_on_floor(FLOOR, 0.0));
    assert!(moved.contains("stand 3.500e-3 behind them"), "{moved}");
    let cube = |text: &str| part(text, "<shape type=\"cube\">", "<bsdf").to_owned();
    insta::assert_snapshot!(cube(&moved), @r##"
    <shape type="cube">
        <transform name="to_world"><matrix value="2 0 0 0 0 1.00175 0 0.99825 0 0 2 0 0 0 0 1"/></transform>
    "##);
    // As deep behind the floor as it was given, and well above it.
    for bottom in [-0.5, 0.5] {
        let text = mitsuba(&fog_on_floor(FLOOR, bottom));
        assert!(!text.contains("behind them"));
    }
    // Another face of the same box, edge on, is not moved.
    assert_eq!(cube(&moved).matches("1.00175").count(), 1);
}

#[test]
fn faces_partly_in_surfaces_or_hardly_off_them_are_refused() {
    let small = FLOOR.replace("[10, 0, 0]", "[6, 0, 0]");
    for format in [Format::Mitsuba, Format::Pbrt] {
        for (floor, bottom) in [(small.as_str(), 0.0), (FLOOR, 1e-4)] {
            let faults = faults(&fog_on_floor(floor, bottom), format);
            assert!(
                faults.starts_with("radiative.medium[0]: a face that lies in"),
                "{faults}"
            );
            assert!(faults.contains("radiative.surface[0]"), "{faults}");
        }
    }
    let glass = "box = { min = [-5, -1, -5], max = [5, 0, 5] }\nglass = { index = 1.5 }";
    assert!(faults(&fog_on_floor(glass, 0.0), Format::Mitsuba).contains("a face that lies in"));
}

#[test]
fn a_medium_of_the_shape_of_a_surface_is_its_inside() {
    let body = "[[radiative.surface]]\nsphere = { centre = [0, 1, 0], radius = 1 }\n\
                glass = { index = 1.5 }\n\
                [[radiative.medium]]\nsphere = { centre = [0, 1, 0], radius = 1 }\nsigma_a = 1\n";
    let text = mitsuba(body);
    assert_eq!(text.matches("<shape").count(), 1);
    assert!(
        part(&text, "<shape", "</shape>").contains("interior"),
        "{text}"
    );
    let text = pbrt(body);
    assert_eq!(text.matches("Shape").count(), 1);
    assert!(text.contains("MediumInterface \"medium0\" \"\""), "{text}");
}

/// An eye in the face of a box is inside if it looks in: the direction decides, not the face.
#[test]
fn an_eye_in_a_face_is_where_it_looks() {
    let boxed = |low: f64, high: f64| {
        format!(
            "[[radiative.medium]]\nbox = {{ min = [-2, -1, {low}], max = [2, 3, {high}] }}\n\
             sigma_a = 1\n"
        )
    };
    // The eye stands at z = -6 and looks along +z.
    for (body, inside) in [
        (boxed(-6.0, -2.0), true),
        (boxed(-9.0, -6.0), false),
        (boxed(-9.0, -2.0), true),
    ] {
        let text = mitsuba(&body);
        let sensor = part(&text, "<sensor", "</sensor>");
        assert_eq!(sensor.contains("id=\"medium0\""), inside, "{sensor}");
        let text = pbrt(&body);
        let before_camera = part(&text, "LookAt", "Camera");
        assert_eq!(before_camera.contains("medium0"), inside, "{text}");
    }
    // A ball that the eye touches, before and behind it.
    for (z, inside) in [(-5.0, true), (-7.0, false)] {
        let ball = format!(
            "[[radiative.medium]]\nsphere = {{ centre = [0, 1, {z}], radius = 1 }}\nsigma_a = 1\n"
        );
        let text = mitsuba(&ball);
        let sensor = part(&text, "<sensor", "</sensor>");
        assert_eq!(sensor.contains("id=\"medium0\""), inside, "{sensor}");
    }
    // Along a face some rays go in.
    let along = "[[radiative.medium]]\nbox = { min = [-2, 1, -9], max = [2, 3, 0] }\nsigma_a = 1\n";
    for format in [Format::Mitsuba, Format::Pbrt] {
        let faults = faults(along, format);
        assert!(
            faults.starts_with("radiative.medium[0]: the eye lies in its boundary"),
            "{faults}"
        );
    }
}

// --- Grids --------------------------------------------------------------------------------------

/// Exports a scene with a grid of 2 × 1 × 2 nodes, 1 to 4, written beside it.
fn with_grid(more: &str, format: Format) -> Result<Export, Refusal> {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = Vec::new();
    for count in [2_i32, 2, 2] {
        bytes.extend(count.to_le_bytes());
    }
    for size in [1_f32, 1.0, 1.0] {
        bytes.extend(size.to_le_bytes());
    }
    for value in 1..=8 {
        bytes.extend((value as f32).to_le_bytes());
    }
    std::fs::write(folder.path().join("grid.bin"), bytes).unwrap();
    let text = format!(
        "[film]\nwidth = 4\nheight = 3\n[camera]\neye = [0, 1, -6]\ntarget = [0, 1, 0]\n\
         [radiative]\n[[radiative.medium]]\n{more}"
    );
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = Scene::load(&path).unwrap_or_else(|error| panic!("{error}"));
    export(&scene, format, "scene", None)
}

#[test]
fn grids_lie_where_their_nodes_are() {
    let nodes = "grid = { file = \"grid.bin\" }\nsigma_s = 3\ntranslate = [10, 0, 0]\n";
    let export = with_grid(nodes, Format::Mitsuba).unwrap();
    check_xml(&export);
    let text = text_of(&export, &export.main);
    // Two voxels of size 1 around the nodes 10 and 11; the medium is the box from 10 to 11.
    insta::assert_snapshot!(part(&text, "<medium", "    <!-- radiative.medium[0]"), @r##"
    <medium type="heterogeneous" id="medium0">
        <volume type="gridvolume" name="sigma_t">
            <string name="filename" value="scene.medium0.vol"/>
            <boolean name="raw" value="true"/>
            <string name="filter_type" value="trilinear"/>
            <string name="wrap_mode" value="clamp"/>
            <transform name="to_world"><matrix value="2 0 0 9.5 0 2 0 -0.5 0 0 2 -0.5 0 0 0 1"/></transform>
        </volume>
        <float name="scale" value="3"/>
        <rgb name="albedo" value="1, 1, 1"/>
        <boolean name="has_spectral_extinction" value="false"/>
        <phase type="isotropic"/>
    </medium>
    "##);
    insta::assert_snapshot!(part(&text, "<shape", "</shape>"), @r##"
    <shape type="cube">
        <transform name="to_world"><matrix value="0.5 0 0 10.5 0 0.5 0 0.5 0 0 0.5 0.5 0 0 0 1"/></transform>
        <bsdf type="null"/>
        <ref name="interior" id="medium0"/>
    "##);
    let (_, vol) = export
        .files
        .iter()
        .find(|(name, _)| name.ends_with(".vol"))
        .unwrap();
    assert_eq!(vol.len(), 48 + 8 * 4);
    assert_eq!(vol[vol.len() - 4..], 8_f32.to_le_bytes());

    let export = with_grid(nodes, Format::Pbrt).unwrap();
    check_pbrt(&export);
    let text = text_of(&export, &export.main);
    insta::assert_snapshot!(part(&text, "Identity", "\nWorldBegin"), @r##"
    Identity
    ConcatTransform [ 1 0 0 0  0 1 0 0  0 0 1 0  10 0 0 1 ]
    MakeNamedMedium "medium0" "string type" [ "uniformgrid" ]
        "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 3 3 3 ] "float g" [ 0 ]
        "point3 p0" [ -1.5 -1.5 -1.5 ] "point3 p1" [ 2.5 2.5 2.5 ]
        "integer nx" [ 4 ] "integer ny" [ 4 ] "integer nz" [ 4 ]
        "float density" [
    1 1 2 2
    1 1 2 2
    3 3 4 4
    3 3 4 4
    1 1 2 2
    1 1 2 2
    3 3 4 4
    3 3 4 4
    5 5 6 6
    5 5 6 6
    7 7 8 8
    7 7 8 8
    5 5 6 6
    5 5 6 6
    7 7 8 8
    7 7 8 8
        ]
    "##);
}

#[test]
fn a_grid_is_cut_off_by_its_box_and_not_by_a_ball() {
    let cut = "grid = { file = \"grid.bin\" }\nbox = { min = [0.5, -1, 0], max = [3, 1, 1] }\n\
               sigma_s = 3\n";
    let text = with_grid(cut, Format::Mitsuba).unwrap();
    let text = text_of(&text, "scene.xml");
    // From (0.5, 0, 0) to (1, 1, 1).
    let shape = part(&text, "<shape", "</shape>");
    assert!(
        shape.contains("\"0.25 0 0 0.75 0 0.5 0 0.5 0 0 0.5 0.5 0 0 0 1\""),
        "{shape}"
    );
    let ball = "grid = { file = \"grid.bin\" }\nsphere = { centre = [0.5, 0.5, 0.5], radius = 0.6 }\n\
                sigma_s = 3\n";
    let refusal = with_grid(ball, Format::Mitsuba).unwrap_err();
    assert!(refusal.to_string().contains("reaches beyond its grid"));
    let nearest = "grid = { file = \"grid.bin\" }\ninterpolation = \"nearest\"\nsigma_s = 3\n";
    let text = text_of(&with_grid(nearest, Format::Mitsuba).unwrap(), "scene.xml");
    assert!(text.contains("name=\"filter_type\" value=\"nearest\""));
    let refusal = with_grid(nearest, Format::Pbrt).unwrap_err();
    assert!(refusal.to_string().contains("nearest node"));
}

// --- Light, turns and numbers of pbrt ------------------------------------------------------------

/// pbrt's default sampler of lights never chooses a spotlight with a hard edge.
#[test]
fn spotlights_of_pbrt_are_chosen_by_their_power() {
    let spot = "[[radiative.light]]\nspot = { position = [0, 3, 0], target = [0, 0, 0], \
                intensity = 1, inner_angle = 20, outer_angle = 20 }\n";
    let text = pbrt(spot);
    insta::assert_snapshot!(part(&text, "Integrator", "\nWorldBegin"), @r##"Integrator "volpath" "integer maxdepth" [ 1000000 ] "string lightsampler" [ "power" ]"##);
    insta::assert_snapshot!(part(&text, "LightSource", "\"float coneangle"), @r##"LightSource "spot" "point3 from" [ 0 3 0 ] "point3 to" [ 0 0 0 ] "rgb I" [ 1 1 1 ] "##);
    assert!(text.contains("# Light scattered more than 1000000 times is left out."));
    let point = "[[radiative.light]]\npoint = { position = [0, 3, 0], intensity = 1 }\n";
    assert!(!pbrt(point).contains("lightsampler"));
}

/// A seed in the file would win over `--seed`, and all replicates be one picture.
#[test]
fn no_file_of_pbrt_has_a_seed() {
    assert!(!pbrt(ROOM).contains("seed"));
}

#[test]
fn numbers_of_pbrt_are_short() {
    let body = format!(
        "environment = [1e34, 1e34, 1e34]\n{}",
        medium("sigma_a = 1e-300")
    );
    let text = pbrt(&body);
    assert!(text.contains("\"rgb L\" [ 1e34 1e34 1e34 ]"), "{text}");
    assert!(
        text.contains("\"rgb sigma_a\" [ 1e-300 1e-300 1e-300 ]"),
        "{text}"
    );
}

/// pbrt multiplies `Le` by `sigma_a`.
#[test]
fn media_of_pbrt_shine_by_what_they_absorb() {
    let text = pbrt(&medium("sigma_a = 4\nsigma_s = 1\nemission = 2"));
    insta::assert_snapshot!(part(&text, "MakeNamedMedium", "\nWorldBegin"), @r##"
    MakeNamedMedium "medium0" "string type" [ "homogeneous" ]
        "rgb sigma_a" [ 4 4 4 ] "rgb sigma_s" [ 1 1 1 ] "float g" [ 0 ]
        "rgb Le" [ 0.5 0.5 0.5 ]
    "##);
    // Of media in one another both sums count: 2 + 1 of 4 + 2.
    let nested = medium("sigma_a = 4\nemission = 2")
        + "[[radiative.medium]]\nbox = { min = [-2, -1, -2], max = [2, 3, 2] }\n\
           sigma_a = 2\nemission = 1\n";
    assert!(pbrt(&nested).contains("[ 6 6 6 ]"));
    assert_eq!(
        pbrt(&nested).matches("\"rgb Le\" [ 0.5 0.5 0.5 ]").count(),
        2
    );
    // A grid says that its emission fades nowhere: pbrt's default does.
    let grid = "grid = { file = \"grid.bin\" }\nsigma_a = 4\nemission = 2\n";
    let export = with_grid(grid, Format::Pbrt).unwrap();
    check_pbrt(&export);
    let text = text_of(&export, &export.main);
    assert!(text.contains("\"rgb Le\" [ 0.5 0.5 0.5 ]"), "{text}");
    let ones = part(&text, "\"float Lescale\"", "\nWorldBegin");
    let row = "1 1 1 1\n".repeat(16);
    assert_eq!(ones, format!("    \"float Lescale\" [\n{row}    ]\n"));
    // A channel without emission says none.
    let export = write(&medium("sigma_a = 4\nemission = [2, 0, 4]"), Format::Pbrt).unwrap();
    let le = ["red", "green", "blue"]
        .map(|channel| text_of(&export, &format!("scene.{channel}.pbrt")))
        .map(|text| text.contains("\"rgb Le\""));
    assert_eq!(le, [true, false, true]);
    for body in [
        "emission = 1",
        "sigma_a = [1, 0, 1]\nemission = 1",
        "sigma_a = 1e-39\nemission = 1",
    ] {
        let faults = faults(&medium(body), Format::Pbrt);
        assert!(
            faults.starts_with("radiative.medium[0]: emission where nothing, or next to nothing"),
            "{faults}"
        );
    }
}

/// pbrt adds what media emit only before the last bounce.
#[test]
fn turns_of_emission_are_counted_as_pbrt_counts_them() {
    let glow = medium("sigma_a = 4\nsigma_s = 1\nemission = 2");
    let depth = |text: &str| {
        let text = part(text, "Integrator", "\n").to_owned();
        text.replace("Integrator \"volpath\" \"integer maxdepth\"", "")
    };
    let lit = |head: &str| format!("{head}\nenvironment = 1\n{FLOOR_TABLE}\n{glow}");
    // Nothing is turned: whatever would turn light only takes it away.
    let text = pbrt(&lit("scattering = \"none\""));
    assert_eq!(depth(&text), " [ 1 ]");
    assert!(
        text.contains("\"rgb sigma_a\" [ 5 5 5 ] \"rgb sigma_s\" [ 0 0 0 ]"),
        "{text}"
    );
    assert!(text.contains("\"rgb Le\" [ 0.4 0.4 0.4 ]"), "{text}");
    assert!(text.contains("\"rgb reflectance\" [ 0 0 0 ]"), "{text}");
    // Without emission it is as it was.
    let dark = lit("scattering = \"none\"").replace("emission = 2", "");
    assert_eq!(depth(&pbrt(&dark)), " [ 0 ]");
    assert!(pbrt(&dark).contains("\"rgb reflectance\" [ 0.5 0.5 0.5 ]"));
    // No other light, or nothing that turns it.
    let alone = format!("max_bounces = 5\n{FLOOR_TABLE}\n{glow}");
    assert_eq!(depth(&pbrt(&alone)), " [ 6 ]");
    let absorbing = glow.replace("sigma_s = 1", "");
    let text = pbrt(&format!("max_bounces = 5\nenvironment = 1\n{absorbing}"));
    assert_eq!(depth(&text), " [ 6 ]");
    assert_eq!(depth(&pbrt(&lit(""))), " [ 1000000 ]");
    for (head, key) in [
        ("max_bounces = 5", "radiative.max_bounces"),
        ("scattering = \"single\"", "radiative.scattering"),
    ] {
        let faults = faults(&lit(head), Format::Pbrt);
        assert!(
            faults.starts_with(&format!("{key}: light that media emit beside other light")),
            "{faults}"
        );
    }
}

/// pbrt clamps g.
#[test]
fn what_pbrt_clamps_is_refused() {
    let sharp = medium("sigma_s = 1\ng = 0.999");
    assert_eq!(
        faults(&sharp, Format::Pbrt),
        "radiative.medium[0]: g = 0.999: pbrt takes any beyond 0.99 as 0.99"
    );
    mitsuba(&sharp);
    pbrt(&sharp.replace("0.999", "0.99"));
    // What does not scatter has no phase function to clamp.
    pbrt(&sharp.replace("sigma_s", "sigma_a"));
}

// --- Refusals -----------------------------------------------------------------------------------

fn medium(more: &str) -> String {
    format!("[[radiative.medium]]\nbox = {{ min = [-1, 0, -1], max = [1, 2, 1] }}\n{more}\n")
}

#[test]
fn what_neither_can_say_is_refused_by_name() {
    let ball = "[[radiative.medium]]\nsphere = { centre = [0, 1, 0], radius = 1.1 }\nsigma_a = 1\n";
    let two = medium("sigma_s = 1") + ball;
    let unbounded = "[[radiative.medium]]\nsigma_a = 1\n".to_owned();
    let open = "[[radiative.surface]]\n\
                rectangle = { corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }\n\
                glass = { index = 1.5 }\n";
    let around = "[[radiative.surface]]\nsphere = { centre = [0, 1, -6], radius = 1 }\n\
                  glass = { index = 1.5 }\n";
    let cases = [
        (
            medium("sigma_a = 1\nnoise = {}"),
            "medium[0]: fractal noise",
        ),
        (
            medium("sigma_a = 1\nexponential = { scale_height = 1 }"),
            "medium[0]: an exponential layer",
        ),
        (
            medium("sigma_a = 1\nlinear = { gradient = [0, 1, 0] }"),
            "medium[0]: a linear ramp",
        ),
        (
            medium("sigma_a = 1\nblob = { centre = [0, 1, 0], width = 1 }"),
            "medium[0]: a Gaussian ball",
        ),
        (
            medium("sigma_s = 1\ndraine = { g = 0.5 }"),
            "medium[0]: the phase function Draine, g = 0.5, alpha = 1",
        ),
        (
            medium("sigma_s = 1\ndroplets = { diameter = 9 }"),
            "medium[0]: the phase function droplets of 9 micrometres",
        ),
        (unbounded, "medium[0]: a medium that fills all space"),
        (two, "medium[1]: it and radiative.medium[0] overlap"),
        (open.to_owned(), "surface[0]: glass without an inside"),
        (
            around.to_owned(),
            "surface[0]: glass with the eye or a light in it",
        ),
    ];
    for (body, expected) in cases {
        for format in [Format::Mitsuba, Format::Pbrt] {
            let faults = faults(&body, format);
            assert!(
                faults.starts_with(&format!("radiative.{expected}")),
                "{faults}"
            );
            assert_eq!(faults.lines().count(), 1, "{faults}");
        }
    }
}

#[test]
fn what_one_of_them_can_say_is_refused_by_the_other() {
    let ellipsoid = "[[radiative.surface]]\nsphere = { centre = [0, 1, 0], radius = 1 }\n\
                     scale = [1, 2, 1]\ndiffuse = { reflectance = 0.5 }\n";
    let box_lamp = "[[radiative.surface]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n\
                    emitter = { radiance = 1, sides = \"both\" }\n";
    let glow = medium("sigma_a = 1\nemission = 1");
    for (body, expected) in [
        (glow.as_str(), "radiative.medium[0]: an emissive medium"),
        (ellipsoid, "radiative.surface[0]: an ellipsoid"),
        (
            box_lamp,
            "radiative.surface[0]: a box or mesh that emits light on both sides",
        ),
    ] {
        assert!(faults(body, Format::Mitsuba).starts_with(expected));
        pbrt(body);
    }
    let spot = "[[radiative.light]]\nspot = { position = [0, 3, 0], target = [0, 0, 0], \
                intensity = 1, inner_angle = 10, outer_angle = 20 }\n";
    let blended = nested("sigma_s = 1\ng = 0.3");
    let rayleigh = medium("sigma_s = 1\ndraine = {}");
    assert!(mitsuba(&rayleigh).contains("<phase type=\"rayleigh\"/>"));
    for (body, expected) in [
        (spot, "radiative.light[0]: a spotlight whose edge"),
        (
            &rayleigh,
            "radiative.medium[0]: the phase function Rayleigh",
        ),
        (
            &blended,
            "radiative.medium[0]: a medium within another of a different g",
        ),
    ] {
        assert!(faults(body, Format::Pbrt).starts_with(expected));
        mitsuba(body);
    }
    pbrt(&spot.replace("inner_angle = 10", "inner_angle = 20"));
}

#[test]
fn all_faults_are_named_at_once_and_nothing_that_does_nothing_is() {
    let both = medium("sigma_a = 1\nnoise = {}") + &medium("sigma_a = 1\nemission = 1");
    assert_eq!(faults(&both, Format::Mitsuba).lines().count(), 2);
    // No extinction, no emission: nothing to say.
    let text = mitsuba(&medium("sigma_a = 0"));
    assert!(!text.contains("<medium"));
}

#[test]
fn scenes_too_small_for_rays_of_mitsubas_are_refused() {
    let text = "[camera]\neye = [0, 0, -0.01]\ntarget = [0, 0, 0]\n[radiative]\nenvironment = 1\n";
    let scene = Scene::parse(text, Path::new("scene.toml")).unwrap();
    let refusal = export(&scene, Format::Mitsuba, "scene", None).unwrap_err();
    assert!(refusal.to_string().contains("too small"), "{refusal}");
    check_pbrt(&export(&scene, Format::Pbrt, "scene", None).unwrap());
}

#[test]
fn titles_and_names_break_nothing() {
    let text = "title = \"a --> b -- c\\nd \\u0001 <\\\"&\"\n[camera]\neye = [0, 0, -1]\n\
                target = [0, 0, 0]\n[radiative]\nenvironment = 1\n\
                [[radiative.medium]]\nsphere = { centre = [0, 0, 0], radius = 0.5 }\n\
                sigma_a = [1, 2, 3]\n";
    let scene = Scene::parse(text, Path::new("scene.toml")).unwrap();
    for format in [Format::Mitsuba, Format::Pbrt] {
        let export = export(&scene, format, "../a--b <\"&'.c", None).unwrap();
        assert!(export.main.starts_with("a--b"), "{}", export.main);
        match format {
            Format::Mitsuba => check_xml(&export),
            _ => check_pbrt(&export),
        }
    }
}

/// A room seen by parallel rays, 3 high and 4 wide.
fn parallel(body: &str, format: Format) -> Result<Export, Refusal> {
    let text = format!(
        "[film]\nwidth = 4\nheight = 3\n\n[camera]\neye = [0, 1, -6]\ntarget = [0, 1, 0]\n\
         orthographic_height = 3\n\n[radiative]\n{body}"
    );
    export(
        &Scene::parse(&text, Path::new("scene.toml")).unwrap(),
        format,
        "scene",
        None,
    )
}

#[test]
fn parallel_rays() {
    let body = "environment = 1\n[[radiative.medium]]\nsigma_a = 1\n\
                sphere = { centre = [0, 1, 0], radius = 1 }\n";
    let export = parallel(body, Format::Mitsuba).unwrap();
    check_xml(&export);
    let text = text_of(&export, &export.main);
    let sensor = part(&text, "<sensor", "<sampler");
    assert!(sensor.contains("type=\"orthographic\""), "{sensor}");
    assert!(!sensor.contains("fov"), "{sensor}");
    // An image 4 wide is twice the 2 that Mitsuba takes unscaled.
    assert!(
        sensor.contains("<scale x=\"2\" y=\"2\"/><lookat"),
        "{sensor}"
    );
    let export = parallel(body, Format::Pbrt).unwrap();
    check_pbrt(&export);
    let text = text_of(&export, &export.main);
    let camera = "Camera \"orthographic\" \"float screenwindow\" [ -2 2 -1.5 1.5 ]";
    assert!(text.contains(camera), "{text}");

    // A ball in the plane of the eye, between the rays of the corners and the middle.
    let cut = "environment = 1\n[[radiative.medium]]\nsigma_a = 1\n\
               sphere = { centre = [1, 1, -6], radius = 0.25 }\n";
    for format in [Format::Mitsuba, Format::Pbrt] {
        let refusal = parallel(cut, format).unwrap_err();
        let text = refusal.faults[0].clone();
        assert!(text.contains("begin on either side of it"), "{text}");
    }
}

#[test]
fn other_models_are_refused() {
    let curve = Scene::parse("[curve]\n", Path::new("curve.toml")).unwrap();
    let refusal = export(&curve, Format::Mitsuba, "curve", None).unwrap_err();
    assert_eq!(
        refusal.to_string(),
        "mitsuba cannot represent curve: a plot of a curve; export it to `bundle`"
    );
}
