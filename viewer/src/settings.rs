//! What of the picture is shown, and how it is made.

use crate::error::ViewerError;

/// How light gets from functions to pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Way {
    /// Pixels look functions up.
    #[default]
    Lookup,
    /// Functions are splatted.
    Splat,
}

impl Way {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lookup => "lookup",
            Self::Splat => "splat",
        }
    }
}

/// Which of these names it is.
fn index(what: &str, names: &[&str], given: &str) -> Result<usize, ViewerError> {
    names.iter().position(|name| *name == given).ok_or_else(|| {
        let names = names.join("\", \"");
        ViewerError::BadArgument(format!("{what} \"{given}\": it must be one of \"{names}\""))
    })
}

/// An enum whose values have names.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident, $what:literal: $($(#[$value_doc:meta])* $value:ident $name:literal),+) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $type { $($(#[$value_doc])* $value),+ }

        impl $type {
            const NAMES: &[&str] = &[$($name),+];

            /// From its name.
            ///
            /// # Errors
            /// [`ViewerError::BadArgument`].
            pub fn parse(name: &str) -> Result<Self, ViewerError> {
                index($what, Self::NAMES, name).map(|i| [$(Self::$value),+][i])
            }

            /// Its name.
            pub fn name(self) -> &'static str {
                Self::NAMES[self as usize]
            }
        }
    };
}

named! {
    /// Which light the picture shows.
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
    /// What is drawn over the picture.
    Overlay, "overlay":
    /// Nothing.
    #[default]
    None "none",
    /// The points of the finest level.
    Points "points",
    /// The points of all levels, each level in its colour.
    Levels "levels"
}

named! {
    /// How radiance becomes display values.
    ToneMapping, "tone mapping":
    /// AgX: softer, dark colours keep their shades and bright ones fade to white.
    #[default]
    Agx "agx",
    /// Khronos PBR Neutral: colours stay what they are.
    Neutral "neutral"
}

named! {
    /// How light gets from functions to pixels: see [`crate::display`].
    Display, "display":
    /// In the way that is faster, which is measured.
    #[default]
    Auto "auto",
    /// Pixels look functions up.
    Lookup "lookup",
    /// Functions are splatted.
    Splat "splat"
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
