//! EXR files with broken attributes, and everything behind the header where it says.

use super::mutation::Mutator;

/// Names that mean something to a reader, and some that are none.
const NAMES: [&str; 22] = [
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowWidth",
    "screenWindowCenter",
    "chromaticities",
    "colorInteropID",
    "adoptedNeutral",
    "whiteLuminance",
    "view",
    "multiView",
    "name",
    "type",
    "chunkCount",
    "tiles",
    "comments",
    "",
    "a name of more than thirty-one bytes, as long ones are",
    "\u{e9}",
];

const TYPES: [&str; 16] = [
    "chromaticities",
    "string",
    "stringvector",
    "float",
    "double",
    "int",
    "box2i",
    "v2f",
    "v3i",
    "chlist",
    "compression",
    "lineOrder",
    "tiledesc",
    "preview",
    "envmap",
    "none of these",
];

struct Attribute {
    name: Vec<u8>,
    kind: Vec<u8>,
    /// Bytes it says it has.
    size: i32,
    value: Vec<u8>,
}

/// One of `seeds` with one to three attributes broken, added or taken away; with any damage where it has
/// several parts.
pub fn mutant(seeds: &[Vec<u8>], mutator: &mut Mutator) -> Vec<u8> {
    let seed = mutator.one_of(seeds).clone();
    let Some((mut attributes, end)) = header(&seed) else {
        return mutator.mutant(seeds);
    };
    for _ in 0..=mutator.below(3) {
        change(&mut attributes, mutator);
    }
    let mut bytes = seed[..8].to_vec();
    if mutator.below(8) == 0 {
        bytes[4 + mutator.below(4)] ^= 1 << mutator.below(8);
    }
    for attribute in &attributes {
        for word in [&attribute.name, &attribute.kind] {
            bytes.extend_from_slice(word);
            bytes.push(0);
        }
        bytes.extend(attribute.size.to_le_bytes());
        bytes.extend_from_slice(&attribute.value);
    }
    bytes.push(0);
    let moved = (bytes.len() as u64).wrapping_sub(end as u64);
    // Places of the chunks, up to the first of them.
    let first = seed[end..].first_chunk().map(|&it| u64::from_le_bytes(it));
    let chunks = first.map_or(end, |first| (first as usize).clamp(end, seed.len()));
    for place in seed[end..chunks].chunks_exact(8) {
        let place = u64::from_le_bytes(place.try_into().unwrap());
        bytes.extend(place.wrapping_add(moved).to_le_bytes());
    }
    bytes.extend_from_slice(&seed[chunks..]);
    bytes
}

/// The attributes of a file of one part, and the byte behind them.
fn header(bytes: &[u8]) -> Option<(Vec<Attribute>, usize)> {
    const PARTS: u8 = 0x10;
    if bytes.get(5)? & PARTS != 0 {
        return None;
    }
    let mut at = 8;
    let mut attributes = Vec::new();
    loop {
        let name = word(bytes, &mut at)?;
        if name.is_empty() {
            return Some((attributes, at));
        }
        let kind = word(bytes, &mut at)?;
        let size = i32::from_le_bytes(*bytes.get(at..)?.first_chunk()?);
        at += 4;
        let value = bytes.get(at..at.checked_add(size.try_into().ok()?)?)?;
        at += value.len();
        attributes.push(Attribute {
            name,
            kind,
            size,
            value: value.to_vec(),
        });
    }
}

fn word(bytes: &[u8], at: &mut usize) -> Option<Vec<u8>> {
    let rest = bytes.get(*at..)?;
    let length = rest.iter().position(|&byte| byte == 0)?;
    *at += length + 1;
    Some(rest[..length].to_vec())
}

fn change(attributes: &mut Vec<Attribute>, mutator: &mut Mutator) {
    let at = mutator.below(attributes.len());
    let name = mutator.one_of(&NAMES).as_bytes().to_vec();
    let kind = mutator.one_of(&TYPES).as_bytes().to_vec();
    match mutator.below(8) {
        0..=2 if !attributes.is_empty() => {
            let value = mutator.mutant(&[attributes[at].value.clone()]);
            attributes[at].size = value.len() as i32;
            attributes[at].value = value;
        }
        3 if !attributes.is_empty() => drop(attributes.remove(at)),
        4 if !attributes.is_empty() => attributes[at].name = name,
        5 if !attributes.is_empty() => attributes[at].kind = kind,
        6 if !attributes.is_empty() => {
            attributes[at].size = *mutator.one_of(&[-1, 0, 1, 4, 1 << 30])
        }
        _ => {
            // The primaries of AP1, which any other length of numbers breaks.
            let ap1 = [
                0.713_f32, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767,
            ];
            let ap1 = ap1.iter().flat_map(|it| it.to_le_bytes()).collect();
            let value = match mutator.below(4) {
                0 => ap1,
                1 => mutator.mutant(&[ap1]),
                2 => b"lin_ap1_scene".to_vec(),
                _ => mutator.mutant(&[b"\x04\0\0\0left\x05\0\0\0right".to_vec()]),
            };
            attributes.insert(
                at,
                Attribute {
                    name,
                    kind,
                    size: value.len() as i32,
                    value,
                },
            );
        }
    }
}
