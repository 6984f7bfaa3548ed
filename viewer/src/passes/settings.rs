//! Settings of the picture: visible light, overlay, tone mapping, display method.

use crate::error::ViewerError;

/// Method from functions to pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Way {
    /// Pixels look functions up.
    #[default]
    Lookup,
    /// Functions are splatted.
    Splat,
}

impl Way {
    /// Name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lookup => "lookup",
            Self::Splat => "splat",
        }
    }
}

/// Index of `given` in `names`.
fn index(what: &str, names: &[&str], given: &str) -> Result<usize, ViewerError> {
    names.iter().position(|name| *name == given).ok_or_else(|| {
        // Less code for the page than with `join`.
        let mut list = String::new();
        for (i, name) in names.iter().enumerate() {
            list += if i > 0 { "\", \"" } else { "" };
            list += name;
        }
        ViewerError::BadArgument(format!("{what} \"{given}\": it must be one of \"{list}\""))
    })
}

/// Defines an enum with named values.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident, $what:literal: $($(#[$value_doc:meta])* $value:ident $name:literal),+) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $type { $($(#[$value_doc])* $value),+ }

        impl $type {
            const NAMES: &[&str] = &[$($name),+];

            /// Parses a name.
            ///
            /// # Errors
            /// [`ViewerError::BadArgument`] for an unknown name.
            pub fn parse(name: &str) -> Result<Self, ViewerError> {
                index($what, Self::NAMES, name).map(|i| [$(Self::$value),+][i])
            }

            /// Name of the value.
            pub fn name(self) -> &'static str {
                Self::NAMES[self as usize]
            }
        }
    };
}

named! {
    /// Displayed part of the light.
    Mode, "mode":
    /// Direct and bounced light.
    #[default]
    All "all",
    /// Direct light alone.
    Direct "direct",
    /// Bounced light alone.
    Indirect "indirect"
}

named! {
    /// Overlay on the picture.
    Overlay, "overlay":
    /// No overlay.
    #[default]
    None "none",
    /// The points of the finest level.
    Points "points",
    /// The points of all levels, each level in its colour.
    Levels "levels"
}

named! {
    /// Tone mapping from radiance to display values.
    ToneMapping, "tone mapping":
    /// AgX: softer; dark colours keep their shades and bright colours fade to white.
    #[default]
    Agx "agx",
    /// Khronos PBR Neutral: preserves colours.
    Neutral "neutral"
}

named! {
    /// Display method from functions to pixels: see [`crate::passes::display`].
    Display, "display":
    /// The faster method, by measurement.
    #[default]
    Auto "auto",
    /// Pixels look functions up.
    Lookup "lookup",
    /// Functions are splatted.
    Splat "splat"
}

#[cfg(feature = "radiosity")]
named! {
    /// What computes bounced light.
    SolverChoice, "solver":
    /// The operator, and radiosity where something has moved or the file has no links.
    #[default]
    Auto "auto",
    /// The operator, wherever things are.
    Operator "operator",
    /// Radiosity.
    Radiosity "radiosity",
    /// Antiradiance; the operator in a build without it.
    Antiradiance "antiradiance"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_names_and_others_are_refused_with_those_that_there_are() {
        for name in ["auto", "lookup", "splat"] {
            assert_eq!(Display::parse(name).unwrap().name(), name);
        }
        assert_eq!(Mode::parse("all").unwrap(), Mode::default());
        let error = ToneMapping::parse("filmic").unwrap_err().to_string();
        assert!(
            error.contains("tone mapping \"filmic\"") && error.contains("\"agx\", \"neutral\""),
            "{error}"
        );
    }
}
