//! The shape of volref's TOML files, declared once.
//!
//! A [`Table`] lists its keys with kind, range, default and meaning. The [reader](super::reader)
//! takes ranges, defaults, error texts and help from here, and [`json_schema`] gives the same
//! to editors.

use serde_json::{Value, json};

/// A table of a TOML file.
#[derive(Debug)]
pub struct Table {
    /// What the table describes, one sentence.
    pub doc: &'static str,
    /// What it may hold beside the keys that it has in common with others.
    pub keys: &'static [Key],
    /// Keys that several tables have in common.
    pub(super) common: &'static [&'static [Key]],
    /// Rules on keys that exclude or need each other.
    pub rules: &'static [Rule],
}

impl Table {
    /// A table without keys, described in one sentence.
    pub const fn new(doc: &'static str) -> Table {
        Table {
            doc,
            keys: &[],
            common: &[],
            rules: &[],
        }
    }

    /// The table with these keys.
    pub const fn keys(self, keys: &'static [Key]) -> Table {
        Table { keys, ..self }
    }

    /// The table with these keys, too, which others have in common with it.
    pub(crate) const fn with(self, common: &'static [&'static [Key]]) -> Table {
        Table { common, ..self }
    }

    /// All keys that it may hold, the common ones first.
    pub(super) fn all(&self) -> impl Iterator<Item = &'static Key> + use<> {
        self.common.iter().copied().flatten().chain(self.keys)
    }

    /// The table with these rules.
    pub const fn rules(self, rules: &'static [Rule]) -> Table {
        Table { rules, ..self }
    }
}

/// A relation between the keys of a table. A word in the singular says what alternatives are, as in
/// "no shape".
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// One of the keys, and no more, is there.
    ExactlyOne(&'static str, &'static [&'static str]),
    /// At most one of the keys is there.
    AtMostOne(&'static str, &'static [&'static str]),
    /// Keys of the first list do not stand beside keys of the second.
    Apart([&'static [&'static str]; 2]),
    /// All of the keys are there, or none.
    Together(&'static [&'static str]),
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As written in the file.
    pub name: &'static str,
    /// Kind of its value.
    pub kind: Kind,
    /// Meaning of its absence.
    pub absent: Absent,
    /// Quantity and unit, one sentence.
    pub doc: &'static str,
}

impl Key {
    /// A key without which the file is incomplete.
    pub const fn required(name: &'static str, kind: Kind) -> Key {
        Key::new(name, kind, Absent::Error)
    }

    /// A key whose absence means that nothing is asked for.
    pub(crate) const fn optional(name: &'static str, kind: Kind) -> Key {
        Key::new(name, kind, Absent::Nothing)
    }

    /// A key with a default value, written as in the file.
    pub const fn or(name: &'static str, kind: Kind, default: &'static str) -> Key {
        Key::new(name, kind, Absent::Default(default))
    }

    /// A key whose default follows from other parts of the file by `rule`.
    pub const fn derived(name: &'static str, kind: Kind, rule: &'static str) -> Key {
        Key::new(name, kind, Absent::Derived(rule))
    }

    const fn new(name: &'static str, kind: Kind, absent: Absent) -> Key {
        Key {
            name,
            kind,
            absent,
            doc: "",
        }
    }

    /// The key with its description: quantity and unit, one sentence.
    pub const fn doc(self, doc: &'static str) -> Key {
        Key { doc, ..self }
    }
}

/// Kind of a key's value.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A whole number from `.0` to `.1`.
    Count(u64, u64),
    /// Three whole numbers x, y, z, each from `.0` to `.1`.
    Counts(u64, u64),
    /// A finite number in a range.
    Number(Range),
    /// Two numbers in a range, the second above the first.
    Interval(Range),
    /// Three finite numbers x, y, z.
    Vector,
    /// An affine map: three or four rows of four finite numbers.
    Matrix(usize),
    /// Three finite numbers red, green, blue, each in a range; one number means all three, and `"#rrggbb"` a
    /// colour of sRGB.
    Colour(Range),
    /// A positive length: world units, or voxels as in `"0.5 voxels"`.
    Length,
    /// Any text.
    Text,
    /// Any number of texts, `["one", "another"]`.
    Words,
    /// Yes or no.
    Flag,
    /// One of a few words.
    Choice(&'static [&'static str]),
    /// A table.
    Table(&'static Table),
    /// Several tables of one form, `[[…]]`.
    Tables(&'static Table),
    /// A table, or several of one form.
    OneOrMore(&'static Table),
    /// Several tables, at most so many, that may hold any key of the whole file but this one.
    Overrides(usize),
}

/// The whole number `text`, in base `radix`, as the value of `name`; fails outside of
/// `[low, high]`.
pub(crate) fn whole_number(
    name: &str,
    text: &str,
    radix: u32,
    [low, high]: [u64; 2],
) -> Result<u64, String> {
    let count = u64::from_str_radix(text, radix).ok();
    count
        .filter(|count| (low..=high).contains(count))
        .ok_or_else(|| format!("`{name}` must lie in [{low}, {high}], got {text}"))
}

/// Meaning of a key's absence.
#[derive(Clone, Copy, Debug)]
pub enum Absent {
    /// Required: the file is incomplete without it.
    Error,
    /// This value, in TOML.
    Default(&'static str),
    /// A value that follows from other parts of the file, as the text says.
    Derived(&'static str),
    /// Optional: the feature is not requested.
    Nothing,
}

/// An interval of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    low: f64,
    high: f64,
    low_open: bool,
    high_open: bool,
}

impl Range {
    /// `[0, ∞)`
    pub const NOT_NEGATIVE: Range = Range::half_open(0.0, f64::INFINITY);
    /// `(0, ∞)`
    pub const POSITIVE: Range = Range::open(0.0, f64::INFINITY);
    /// `[0, 1]`
    pub const UNIT: Range = Range::closed(0.0, 1.0);
    /// Any finite number.
    pub(crate) const FINITE: Range = Range::open(f64::NEG_INFINITY, f64::INFINITY);
    /// Finite numbers that a grid can hold.
    pub(crate) const STORED: Range = Range::closed(f32::MIN as f64, f32::MAX as f64);

    const fn new(low: f64, low_open: bool, high: f64, high_open: bool) -> Range {
        Range {
            low,
            high,
            low_open,
            high_open,
        }
    }

    /// `[low, high]`
    pub const fn closed(low: f64, high: f64) -> Range {
        Range::new(low, false, high, false)
    }

    /// `(low, high)`
    pub const fn open(low: f64, high: f64) -> Range {
        Range::new(low, true, high, true)
    }

    /// `[low, high)`
    pub(crate) const fn half_open(low: f64, high: f64) -> Range {
        Range::new(low, false, high, true)
    }

    /// `[low, ∞)`
    pub const fn at_least(low: f64) -> Range {
        Range::half_open(low, f64::INFINITY)
    }

    /// Whether `x` lies in the range. NaN lies in none.
    pub fn contains(&self, x: f64) -> bool {
        (x > self.low || (x == self.low && !self.low_open))
            && (x < self.high || (x == self.high && !self.high_open))
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.low.is_finite(), self.high.is_finite()) {
            (false, false) => write!(f, "be finite"),
            (true, false) if self.low_open => write!(f, "be finite and above {}", self.low),
            (true, false) => write!(f, "be finite and at least {}", self.low),
            _ => {
                let left = ['[', '('][usize::from(self.low_open)];
                let right = [']', ')'][usize::from(self.high_open)];
                write!(f, "lie in {left}{}, {}{right}", self.low, self.high)
            }
        }
    }
}

impl Kind {
    /// Name of the kind in an error: "expected …".
    pub fn expected(&self) -> String {
        match self {
            Kind::Count(low, high) => format!("a whole number from {low} to {high}"),
            Kind::Counts(low, high) => {
                format!("three whole numbers from {low} to {high}, such as [64, 64, 32]")
            }
            Kind::Number(_) => "a number".into(),
            Kind::Interval(_) => "two numbers, the smaller first, such as [0, 1000]".into(),
            Kind::Vector => "three numbers, such as [0, 1, 0]".into(),
            Kind::Matrix(rows) => {
                format!("{rows} rows of four numbers, such as [[1, 0, 0, 0], [0, 1, 0, 0], …]")
            }
            Kind::Colour(_) => {
                "a colour: three numbers red, green, blue, such as [1, 0.5, 0], one for all three, or sRGB such as '#ff8000'"
                    .into()
            }
            Kind::Length => {
                "a length: a number in world units, or text such as \"0.5 voxels\"".into()
            }
            Kind::Text => "text in quotes".into(),
            Kind::Words => "texts in square brackets, such as [\"one\", \"another\"]".into(),
            Kind::Flag => "true or false".into(),
            Kind::Choice(words) => {
                let quoted: Vec<_> = words.iter().map(|word| format!("{word:?}")).collect();
                format!("one of {}", quoted.join(", "))
            }
            Kind::Table(_) => "a table".into(),
            Kind::Tables(_) | Kind::Overrides(_) => "tables in double brackets, [[…]]".into(),
            Kind::OneOrMore(_) => "a table, or tables in double brackets, [[…]]".into(),
        }
    }
}

/// The JSON Schema (draft 2020-12) of files whose root is `root`, for completion and checking
/// in editors.
pub fn json_schema(title: &str, root: &'static Table) -> Value {
    let mut schema = table_schema(root, root, true);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!(title);
    schema
}

fn table_schema(root: &'static Table, table: &'static Table, complete: bool) -> Value {
    let properties: serde_json::Map<String, Value> = table
        .all()
        .filter(|key| complete || !matches!(key.kind, Kind::Overrides(_)))
        .map(|key| (key.name.to_owned(), key_schema(root, key, complete)))
        .collect();
    let mut schema = json!({
        "type": "object",
        "description": table.doc,
        "properties": properties,
        "additionalProperties": false,
    });
    let required: Vec<_> = table
        .all()
        .filter(|key| matches!(key.absent, Absent::Error))
        .map(|key| key.name)
        .collect();
    if complete && !required.is_empty() {
        schema["required"] = json!(required);
    }
    let overrides = |key: &&Key| matches!(key.kind, Kind::Overrides(_));
    let schemas = |complete| {
        let rules = table.rules.iter();
        rules.flat_map(move |it| rule_schemas(it, complete))
    };
    let rules: Vec<Value> = match table.all().find(overrides) {
        // What the file itself lacks, the tables that override it may bring.
        Some(key) if complete => {
            let demands: Vec<Value> = schemas(true).collect();
            let either = json!({ "anyOf": [{ "required": [key.name] }, { "allOf": demands }] });
            schemas(false).chain([either]).collect()
        }
        _ => schemas(complete).collect(),
    };
    if !rules.is_empty() {
        schema["allOf"] = json!(rules);
    }
    schema
}

/// What a rule says about a table, or about one whose keys stand beside those of another, which is not complete:
/// schemas that must all hold.
fn rule_schemas(rule: &Rule, complete: bool) -> Vec<Value> {
    let not_both = |a: &str, b: &str| json!({ "not": { "required": [a, b] } });
    match rule {
        Rule::ExactlyOne(_, keys) if complete => {
            let one = keys.iter().map(|key| json!({ "required": [key] }));
            vec![json!({ "oneOf": one.collect::<Vec<_>>() })]
        }
        Rule::ExactlyOne(_, keys) | Rule::AtMostOne(_, keys) => {
            let pairs = keys.iter().enumerate();
            pairs
                .flat_map(|(index, a)| keys[index + 1..].iter().map(|b| not_both(a, b)))
                .collect()
        }
        Rule::Apart([left, right]) => {
            let pairs = left.iter().flat_map(|a| right.iter().map(move |b| (a, b)));
            pairs.map(|(a, b)| not_both(a, b)).collect()
        }
        Rule::Together(keys) if complete => {
            let needs = keys.iter().map(|key| {
                let others: Vec<_> = keys.iter().filter(|other| *other != key).collect();
                ((*key).to_owned(), json!(others))
            });
            let needs: serde_json::Map<String, Value> = needs.collect();
            vec![json!({ "dependentRequired": needs })]
        }
        Rule::Together(_) => vec![],
    }
}

fn number_schema(range: Range) -> Value {
    let mut schema = json!({ "type": "number" });
    let low = (range.low, ["minimum", "exclusiveMinimum"], range.low_open);
    let high = (range.high, ["maximum", "exclusiveMaximum"], range.high_open);
    for (end, names, is_open) in [low, high] {
        if end.is_finite() {
            schema[names[usize::from(is_open)]] = json!(end);
        }
    }
    schema
}

/// The place, in the schema of `at`, of that of a table of which there may be several.
fn pointer(at: &'static Table, table: &Table, path: &str) -> Option<String> {
    at.all().find_map(|key| {
        let path = format!("{path}/properties/{}", key.name);
        match key.kind {
            Kind::Table(inner) => pointer(inner, table, &path),
            Kind::OneOrMore(inner) => std::ptr::eq(inner, table).then(|| format!("{path}/anyOf/0")),
            _ => None,
        }
    })
}

fn key_schema(root: &'static Table, key: &Key, complete: bool) -> Value {
    let several = |count: usize, item: Value| json!({ "type": "array", "items": item, "minItems": count, "maxItems": count });
    let three = |item: Value| several(3, item);
    let mut schema = match key.kind {
        Kind::Count(low, high) => json!({ "type": "integer", "minimum": low, "maximum": high }),
        Kind::Counts(low, high) => {
            three(json!({ "type": "integer", "minimum": low, "maximum": high }))
        }
        Kind::Number(range) => number_schema(range),
        Kind::Interval(range) => several(2, number_schema(range)),
        Kind::Vector => three(json!({ "type": "number" })),
        Kind::Matrix(rows) => several(rows, several(4, json!({ "type": "number" }))),
        Kind::Colour(range) => {
            let one = number_schema(range);
            let srgb = json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" });
            json!({ "anyOf": [one, three(one.clone()), srgb] })
        }
        Kind::Length => json!({ "anyOf": [
            { "type": "number", "exclusiveMinimum": 0 },
            { "type": "string", "pattern": "^[0-9.eE+-]+ *voxels?$" },
        ]}),
        Kind::Text => json!({ "type": "string" }),
        Kind::Words => json!({ "type": "array", "items": { "type": "string" } }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Table(table) => table_schema(root, table, complete),
        Kind::Tables(table) => {
            // A list in a panel stands in the place of the scene's: each entry is complete.
            json!({ "type": "array", "items": table_schema(root, table, true) })
        }
        Kind::OneOrMore(table) => {
            let whole = pointer(root, table, "#").expect("a key of the file");
            json!({ "anyOf": [
                table_schema(root, table, complete),
                { "type": "array", "minItems": 1, "items": { "$ref": whole } },
            ]})
        }
        Kind::Overrides(most) => {
            let items = table_schema(root, root, false);
            json!({ "type": "array", "maxItems": most, "items": items })
        }
    };
    schema["description"] = match key.absent {
        Absent::Derived(rule) => json!(format!("{} Default: {rule}.", key.doc)),
        _ => json!(key.doc),
    };
    if let Absent::Default(text) = key.absent {
        let value: toml::Value = text.parse().expect("defaults are TOML");
        schema["default"] = json!(value);
    }
    schema
}
