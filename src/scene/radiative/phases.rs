//! Phase functions.

use crate::optics::{Asymmetry, Draine, Droplets, Phase};
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Range, Table};
use crate::scene::reader::Reader;

/// The keys that give a medium its phase function.
pub(super) const KEYS: [&str; 3] = ["g", "draine", "droplets"];

/// The same, and the block that may hold a `g` of its own, last.
pub(super) const KEYS_AND_BLOCK: [&str; 4] = ["g", "draine", "droplets", "procedural"];

/// Henyey & Greenstein's.
pub(super) const G: Key = Key::or("g", Kind::Number(Range::open(-1.0, 1.0)), "0.0")
    .doc("Mean cosine of the scattering angle (Henyey–Greenstein), between -1 and 1: positive is forward, 0 is isotropic.");

/// Draine's.
pub(super) const DRAINE: Key = Key::optional("draine", Kind::Table(&DRAINE_TABLE))
    .doc("Phase function of dust or of molecules, in place of `g`.");

const DRAINE_TABLE: Table = Table::new("The phase function of Draine 2003: that of Henyey and Greenstein times 1 + alpha cos², normalized to an integral of 1. By default, `{}`, it is Rayleigh's; alpha = 1 that of Cornette and Shanks.").keys(&[
    Key::or("g", Kind::Number(Range::open(-1.0, 1.0)), "0.0")
        .doc("Parameter of the Henyey–Greenstein factor, between -1 and 1; not the mean cosine."),
    Key::or("alpha", Kind::Number(Range::at_least(0.0)), "1.0")
        .doc("Weight of cos²; 0 is Henyey–Greenstein."),
]);

/// The phase function of fog and clouds.
pub(super) const DROPLETS: Key = Key::optional("droplets", Kind::Table(&DROPLETS_TABLE))
    .doc("Phase function of fog and clouds, in place of `g`.");

const DROPLETS_TABLE: Table = Table::new("The phase function of droplets of water, by the fit of Jendersie and d'Eon 2023 to Mie's theory.").keys(&[
    Key::required("diameter", Kind::Number(Range::closed(5.0, 50.0)))
        .doc("Diameter of the droplets, micrometres, in [5, 50]."),
]);

/// Reads the phase function of a medium; `procedural` is that of its procedural block.
pub(super) fn read(reader: &Reader, procedural: Option<Asymmetry>) -> SceneResult<Phase> {
    if let Some(g) = procedural {
        // Its default is read all the same: the keys read are part of what goldens know.
        reader.number("g")?;
        if let Some(key) = KEYS.into_iter().find(|key| reader.has(key)) {
            let message = format!(
                "the phase function is given twice: by `{key}`, and by the procedural block"
            );
            return Err(reader.mistake(key, message, "keep one of the two"));
        }
        return Ok(Phase::henyey_greenstein(g));
    }
    if let Some(draine) = reader.table("draine")? {
        let g = asymmetry(&draine)?;
        let phase = Draine::new(g, draine.number("alpha")?);
        return Ok(Phase::Draine(draine.accepted(phase)?));
    }
    if let Some(droplets) = reader.table("droplets")? {
        let phase = Droplets::new(droplets.number("diameter")?);
        return Ok(Phase::Droplets(droplets.accepted(phase)?));
    }
    asymmetry(reader).map(Phase::henyey_greenstein)
}

fn asymmetry(reader: &Reader) -> SceneResult<Asymmetry> {
    reader.accepted(Asymmetry::new(reader.number("g")?))
}
