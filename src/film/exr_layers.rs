//! The colour channels of an EXR file, chosen among its layers.
//!
//! Channels are grouped into layers by the prefix of their names, such as `diffuse.R`, by the part
//! of the file, or by both.

use super::FilmError;
use exr::prelude::{AnyChannels, FlatSamples, Image, Layer, Layers};

/// A file that was read, with all its parts.
pub(super) type ExrParts = Image<Layers<AnyChannels<FlatSamples>>>;

/// A part of a file: channels of one size, at one place.
pub(super) type ExrPart = Layer<AnyChannels<FlatSamples>>;

/// Names of the main layer, if several layers have colours.
const MAIN: [&str; 4] = ["", "rgba", "beauty", "combined"];

/// Layers with colours that are not the image.
const NOISE: [&str; 2] = ["variance", "samples"];

/// The channels of an image.
pub(super) struct Colours<'f> {
    pub part: &'f ExrPart,
    /// The same channel three times for a grey image.
    pub rgb: [&'f FlatSamples; 3],
    pub opacity: Option<&'f FlatSamples>,
    pub depth: Option<&'f FlatSamples>,
    pub is_grey: bool,
    /// The name of a layer that is chosen as the only one, though it has no name of a main layer.
    pub unusual_layer: Option<String>,
}

pub(super) fn name_of(part: &ExrPart) -> String {
    let name = part.attributes.layer_name.as_ref();
    name.map_or(String::new(), |name| name.to_string())
}

/// The values of the channel that has exactly this name.
pub(super) fn samples_of<'p>(part: &'p ExrPart, name: &str) -> Option<&'p FlatSamples> {
    let mut channels = part.channel_data.list.iter();
    channels
        .find(|channel| channel.name == *name)
        .map(|channel| &channel.sample_data)
}

/// The channels of a layer.
struct Group<'f> {
    part: &'f ExrPart,
    /// Prefix of the names of its channels, before the last dot.
    prefix: String,
    /// For people, and to find the main one: the name of the part and the prefix.
    name: String,
}

impl<'f> Group<'f> {
    /// The channel `letter`, in capitals or not.
    fn channel(&self, letter: &str) -> Option<&'f FlatSamples> {
        let full_name = |letter: &str| match self.prefix.as_str() {
            "" => letter.to_owned(),
            prefix => format!("{prefix}.{letter}"),
        };
        [letter.to_owned(), letter.to_ascii_lowercase()]
            .iter()
            .find_map(|letter| samples_of(self.part, &full_name(letter)))
    }

    fn rgb(&self) -> Option<[&'f FlatSamples; 3]> {
        let [r, g, b] = ["R", "G", "B"].map(|letter| self.channel(letter));
        Some([r?, g?, b?])
    }

    /// Beside X, Y is a coordinate.
    fn grey(&self) -> Option<[&'f FlatSamples; 3]> {
        let luminance = self.channel("Y").filter(|_| self.channel("X").is_none());
        luminance.map(|y| [y; 3])
    }

    /// The last part of its name, in small letters.
    fn last_name(&self) -> String {
        let last = self.name.rsplit('.').next().unwrap_or("");
        last.to_ascii_lowercase()
    }
}

/// The groups of all parts, in their order.
fn groups(file: &ExrParts) -> Vec<Group<'_>> {
    let mut groups: Vec<Group> = Vec::new();
    for part in &file.layer_data {
        let part_name = name_of(part);
        let first = groups.len();
        for channel in &part.channel_data.list {
            let full_name = channel.name.to_string();
            let prefix = full_name.rsplit_once('.').map_or("", |(prefix, _)| prefix);
            if groups[first..].iter().any(|group| group.prefix == prefix) {
                continue;
            }
            let name = match (part_name.as_str(), prefix) {
                (name, "") | ("", name) => name.to_owned(),
                // Some programs write the name of the part into those of its channels too.
                (part, prefix) if prefix.starts_with(part) => prefix.to_owned(),
                (part, prefix) => format!("{part}.{prefix}"),
            };
            groups.push(Group {
                part,
                prefix: prefix.to_owned(),
                name,
            });
        }
    }
    groups
}

/// The layer of the image.
pub(super) fn main_layer(file: &ExrParts) -> Result<Colours<'_>, FilmError> {
    let mut groups = groups(file);
    groups.retain(|group| !NOISE.contains(&group.name.as_str()));
    if let Some(colours) = the_one(&groups, Group::rgb)? {
        return Ok(colours);
    }
    let has = |name| groups.iter().any(|group| group.channel(name).is_some());
    if has("RY") || has("BY") {
        return Err(FilmError::unsuited(
            "this EXR holds luminance and chroma (Y, RY, BY)",
            "write R, G and B",
        ));
    }
    the_one(&groups, Group::grey)?.ok_or_else(|| {
        let channels = file.layer_data.iter().flat_map(|part| &part.channel_data.list);
        let names: Vec<String> = channels.map(|channel| channel.name.to_string()).collect();
        FilmError::unsuited(
            format!("no layer of the image has the channels R, G and B; there are: {}", names.join(", ")),
            "name those of linear RGB R, G and B (in a layer beauty.R, beauty.G and beauty.B), or the one of a grey \
             image Y",
        )
    })
}

/// Among the layers with `colours`, the only one, else the one without a name, else the only one
/// with the name of a main layer; `None` if there are none.
fn the_one<'f>(
    groups: &[Group<'f>],
    colours: impl Fn(&Group<'f>) -> Option<[&'f FlatSamples; 3]>,
) -> Result<Option<Colours<'f>>, FilmError> {
    let with_colours: Vec<_> = groups
        .iter()
        .filter_map(|group| Some((group, colours(group)?)))
        .collect();
    // A part with a name and nothing else is the image.
    let is_among_several = groups.len() > 1 || groups.iter().any(|group| !group.prefix.is_empty());
    let called = |names: &[&str]| -> Vec<_> {
        let all = with_colours.iter().copied();
        all.filter(|(group, _)| names.contains(&group.last_name().as_str()))
            .collect()
    };
    for choice in [with_colours.clone(), called(&MAIN[..1]), called(&MAIN)] {
        if let [(group, rgb)] = choice[..] {
            return Ok(Some(Colours {
                part: group.part,
                rgb,
                opacity: group.channel("A"),
                depth: group.channel("Z"),
                is_grey: group.rgb().is_none(),
                unusual_layer: (is_among_several && !MAIN.contains(&group.last_name().as_str()))
                    .then(|| group.name.clone()),
            }));
        }
    }
    if with_colours.is_empty() {
        return Ok(None);
    }
    let name = |(group, _): &(&Group, _)| match group.name.as_str() {
        "" => "one without a name".to_owned(),
        name => name.to_owned(),
    };
    let names = with_colours.iter().map(name).collect::<Vec<_>>().join(", ");
    Err(FilmError::unsuited(
        format!("several layers have colours, and none is the main one: {names}"),
        "write one of them without a name, or call it rgba, beauty or combined",
    ))
}
