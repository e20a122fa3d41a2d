//! Choices of other renderers, as a search for conventions tries them.

use super::Conventions;

/// Choice of another renderer in place of volref's convention.
#[derive(Clone, Copy, Debug)]
pub struct Alternative {
    /// In a sentence about the renderer: "it …".
    pub words: &'static str,
    /// The key whose choice it is, too: no two of one choice apply together.
    pub instead_of: Option<&'static str>,
    /// It is claimed by itself; one that is also a mistake of the catalogue is not.
    pub stands_alone: bool,
    /// It is tried in scenes with the shadow of a volume alone.
    pub in_shadow: bool,
    /// It is tried in scenes with shading alone.
    pub shaded: bool,
    /// Makes it the convention.
    pub set: fn(&mut Conventions),
}

/// A choice that is claimed by itself, of whatever scene.
pub(super) const fn other(words: &'static str, set: fn(&mut Conventions)) -> Alternative {
    Alternative {
        words,
        instead_of: None,
        stands_alone: true,
        in_shadow: false,
        shaded: false,
        set,
    }
}

impl Alternative {
    pub(super) const fn instead_of(mut self, key: &'static str) -> Alternative {
        self.instead_of = Some(key);
        self
    }

    pub(super) const fn beside_others(mut self) -> Alternative {
        self.stands_alone = false;
        self
    }

    pub(super) const fn in_shadow(mut self) -> Alternative {
        self.in_shadow = true;
        self
    }

    pub(super) const fn shaded(mut self) -> Alternative {
        self.shaded = true;
        self
    }
}
