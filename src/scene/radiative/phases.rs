//! Phase functions.

use crate::optics::{Asymmetry, Draine, Droplets, Phase};
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Range};
use crate::scene::reader::Reader;
use crate::scene::record::Record;

/// The keys that give a medium its phase function.
pub(super) const KEYS: [&str; 3] = ["g", "draine", "droplets"];

/// The same, and the block that may hold a `g` of its own, last.
pub(super) const KEYS_AND_BLOCK: [&str; 4] = ["g", "draine", "droplets", "procedural"];

/// The keys that give a phase function, declared.
pub(super) const PHASES: [Key; 3] = [
    Key::or("g", Kind::Number(COSINES), "0.0")
        .doc("Mean cosine of the scattering angle (Henyey–Greenstein), between -1 and 1: positive is forward, 0 is isotropic."),
    Key::optional("draine", Kind::Table(&DraineTable::TABLE))
        .doc("Phase function of dust or of molecules, in place of `g`."),
    Key::optional("droplets", Kind::Table(&DropletsTable::TABLE))
        .doc("Phase function of fog and clouds, in place of `g`."),
];

const COSINES: Range = Range::open(-1.0, 1.0);

record! {
    struct DraineTable in "The phase function of Draine 2003: that of Henyey and Greenstein times 1 + alpha cos², normalized to an integral of 1. By default, `{}`, it is Rayleigh's; alpha = 1 that of Cornette and Shanks." {
        g: f64 = or("0.0") Number(COSINES),
            "Parameter of the Henyey–Greenstein factor, between -1 and 1; not the mean cosine.";
        alpha: f64 = or("1.0") Number(Range::NOT_NEGATIVE), "Weight of cos²; 0 is Henyey–Greenstein.";
    }
}

record! {
    struct DropletsTable in "The phase function of droplets of water, by the fit of Jendersie and d'Eon 2023 to Mie's theory." {
        diameter: f64 = required Number(Range::closed(5.0, 50.0)), "Diameter of the droplets, micrometres, in [5, 50].";
    }
}

/// Reads the phase function of a medium; `procedural` is that of its procedural block.
pub(super) fn read(reader: &Reader, procedural: Option<Asymmetry>) -> SceneResult<Phase> {
    if let Some(g) = procedural {
        // Its default is read all the same: the keys read are part of what goldens know.
        reader.get::<f64>("g")?;
        if let Some(key) = reader.first_of(&KEYS) {
            let message = format!(
                "the phase function is given twice: by `{key}`, and by the procedural block"
            );
            return Err(reader.mistake(key, message, "keep one of the two"));
        }
        return Ok(Phase::henyey_greenstein(g));
    }
    if let Some(table) = reader.table("draine")? {
        let draine = DraineTable::read(&table)?;
        let phase = Draine::new(table.accepted(Asymmetry::new(draine.g))?, draine.alpha);
        return Ok(Phase::Draine(table.accepted(phase)?));
    }
    if let Some(table) = reader.table("droplets")? {
        let phase = Droplets::new(DropletsTable::read(&table)?.diameter);
        return Ok(Phase::Droplets(table.accepted(phase)?));
    }
    let g = Asymmetry::new(reader.get("g")?);
    reader.accepted(g).map(Phase::henyey_greenstein)
}
