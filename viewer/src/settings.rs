//! What of the picture is shown.

use crate::error::ViewerError;

/// Which light the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Direct and bounced light.
    #[default]
    All,
    /// Direct light alone.
    Direct,
    /// Bounced light alone.
    Indirect,
}

impl Mode {
    /// From its name: `all`, `direct` or `indirect`.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`].
    pub fn parse(name: &str) -> Result<Self, ViewerError> {
        [Self::All, Self::Direct, Self::Indirect].into_iter().find(|m| m.name() == name).ok_or_else(|| {
            ViewerError::BadArgument(format!(
                "mode \"{name}\": it must be \"all\", \"direct\" or \"indirect\""
            ))
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
        }
    }
}

/// What is drawn over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The points of the finest level.
    Points,
    /// The points of all levels, each level in its colour.
    Levels,
}

impl Overlay {
    /// From its name: `none`, `points` or `levels`.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`].
    pub fn parse(name: &str) -> Result<Self, ViewerError> {
        [Self::None, Self::Points, Self::Levels].into_iter().find(|m| m.name() == name).ok_or_else(|| {
            ViewerError::BadArgument(format!(
                "overlay \"{name}\": it must be \"none\", \"points\" or \"levels\""
            ))
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Points => "points",
            Self::Levels => "levels",
        }
    }
}

/// How radiance becomes display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneMapping {
    /// Khronos PBR Neutral: colours stay what they are.
    #[default]
    Neutral,
    /// AgX: softer, bright colours fade to white.
    Agx,
}

impl ToneMapping {
    /// From its name: `neutral` or `agx`.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`].
    pub fn parse(name: &str) -> Result<Self, ViewerError> {
        [Self::Neutral, Self::Agx].into_iter().find(|t| t.name() == name).ok_or_else(|| {
            ViewerError::BadArgument(format!("tone mapping \"{name}\": it must be \"neutral\" or \"agx\""))
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Neutral => "neutral",
            Self::Agx => "agx",
        }
    }
}
