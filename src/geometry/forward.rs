//! Methods of an enum, or of a wrapper, that are those of what is within.

/// Methods by those of the value within: of the listed variants of an enum, `(Kind: One | Another)`, behind
/// a pointer, `(*)`, or in the one field, `(.0)`.
macro_rules! forward {
    ($within:tt $($(#[$attribute:meta])* $visible:vis fn $method:ident($($argument:ident: $type:ty),*) $(-> $result:ty)?;)+) => {$(
        $(#[$attribute])*
        $visible fn $method(&self, $($argument: $type),*) $(-> $result)? {
            $crate::geometry::within!(self, $within, inner => inner.$method($($argument),*))
        }
    )+};
}

/// An expression of the value within.
macro_rules! within {
    ($self:expr, ($kind:ident: $($variant:ident)|+), $inner:ident => $call:expr) => {
        match $self { $($kind::$variant($inner) => $call,)+ }
    };
    ($self:expr, (*), $inner:ident => $call:expr) => {{
        let $inner = &**$self;
        $call
    }};
    ($self:expr, (.0), $inner:ident => $call:expr) => {{
        let $inner = &$self.0;
        $call
    }};
}

pub(crate) use {forward, within};
