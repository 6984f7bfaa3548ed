//! Errors of the viewer, with short codes for programs.

use rebounce_shared::light_group::MovedLight;
use rebounce_shared::rbn::RbnError;

/// An error of the viewer. The page's `error` event carries [`ViewerError::code`].
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// The browser has no WebGPU.
    #[error(
        "this browser has no WebGPU; use a current Chrome, Edge, Safari or Firefox, and open the page over https or from localhost"
    )]
    NoWebGpu,
    /// WebGPU is present, but without a usable GPU.
    #[error(
        "no graphics adapter can be used ({0}); switch on hardware acceleration, or update the graphics driver"
    )]
    NoAdapter(String),
    /// The adapter returned no device, or the canvas no surface.
    #[error("the graphics adapter gave no device ({0}); close other pages that use the GPU and load again")]
    NoDevice(String),
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] RbnError),
    /// A section exceeds the buffer limit.
    #[error(
        "section {section} takes {bytes} bytes, a buffer of this graphics adapter holds {limit}: bake a smaller scene, or fewer levels"
    )]
    TooLarge {
        /// The section's four-letter name.
        section: &'static str,
        /// Length of the section, bytes.
        bytes: u64,
        /// The limit, bytes.
        limit: u64,
    },
    /// A scene's elements and links for antiradiance are larger than a buffer.
    #[cfg(feature = "antiradiance")]
    #[error(
        "the elements and links of antiradiance take {bytes} bytes, a buffer of this graphics adapter holds {limit}: take fewer elements, or fewer bins"
    )]
    TooManyElements {
        /// Bytes of the largest table.
        bytes: u64,
        /// The limit, bytes.
        limit: u64,
    },
    /// The GPU has no memory left.
    #[error("the graphics memory is full; close other pages that use it, or show fewer scenes at once")]
    OutOfMemory,
    /// A texture cannot be decoded.
    #[error(
        "texture \"{name}\" cannot be decoded ({problem}); convert it to a plain PNG or JPEG and bake again"
    )]
    Texture {
        /// Name of the texture, or its index if unnamed.
        name: String,
        /// The decoder's message.
        problem: String,
    },
    /// The device was lost.
    #[error("the graphics device was lost ({0}); reload the page")]
    DeviceLost(String),
    /// No scene is loaded.
    #[error("no scene is loaded; call load() first")]
    NoScene,
    /// A JSON text does not have the expected form.
    #[error("{what}: {problem}")]
    BadJson {
        /// Kind of the JSON text: shot, camera or lights.
        what: &'static str,
        /// The problem.
        problem: String,
    },
    /// A light of a fixed solution is elsewhere.
    #[error(transparent)]
    Moved(#[from] MovedLight),
    /// An argument is out of range.
    #[error("{0}")]
    BadArgument(String),
    /// The GPU refused a request of the viewer.
    #[error("internal error: {0}; please report it")]
    Internal(String),
}

impl ViewerError {
    /// A short, stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoWebGpu => "no-webgpu",
            Self::NoAdapter(_) => "no-adapter",
            Self::NoDevice(_) => "no-device",
            Self::File(error) => error.code(),
            Self::TooLarge { .. } => "too-large",
            #[cfg(feature = "antiradiance")]
            Self::TooManyElements { .. } => "too-large",
            Self::OutOfMemory => "out-of-memory",
            Self::Texture { .. } => "texture",
            Self::DeviceLost(_) => "device-lost",
            Self::NoScene => "no-scene",
            Self::BadJson { .. } => "bad-json",
            Self::Moved(_) | Self::BadArgument(_) => "bad-argument",
            Self::Internal(_) => "internal",
        }
    }
}
