//! What follows from the table of the kinds: the type [`Light`](super::Light) and its numbers.

/// A description; empty in the page's module, which shows none.
macro_rules! described {
    ($($doc:expr),*) => {
        if cfg!(target_arch = "wasm32") { "" } else { concat!($($doc),*) }
    };
}

/// Makes the types and functions of the table in kinds.rs. An entry: the kind's name in Rust, in files, as new lights
/// are called and as the page's list says; the units of its intensity, the first that of files; its fields in the
/// order of files, with their serde attributes and descriptions.
macro_rules! kinds {
    ($(
        $(#[doc = $doc:expr])*
        $kind:ident $name:tt called $called:literal listed $listed:literal in [$($unit:literal),+] {
            $(
                $(#[doc = $field_doc:expr])*
                $(#[serde $serde:tt])*
                $field:ident: $type:ty = $description:expr,
            )+
        }
    )+) => {
        /// Light in world space. Colours are linear RGB; 1 cd counts as 1 W/sr per channel, 1 nit as 1 W/(sr m²). A .rbn
        /// file does not store the size of a point, spot or directional light.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "type")]
        pub enum Light {
            $(
                $(#[doc = $doc])*
                #[serde(rename = $name)]
                $kind {
                    $(
                        $(#[doc = $field_doc])*
                        $(#[serde $serde])*
                        $field: $type,
                    )+
                },
            )+
        }

        /// Kind of a light. The numbers are those of .rbn files, of the page and of the shaders.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::NoUninit)]
        #[repr(u32)]
        pub enum LightKind {
            $(
                $(#[doc = $doc])*
                $kind,
            )+
        }

        /// The kinds, in the order of their numbers.
        pub static KINDS: [LightDescription; MEMBERS.len()] = [$(
            LightDescription {
                variant: stringify!($kind),
                name: $name,
                doc: described!($($doc),*),
                called: $called,
                listed: $listed,
                units: &[$($unit),+],
                fields: &[$((&$description, described!($($field_doc),*))),+],
            },
        )+];

        /// Names of the kinds and of the members that their lights may have in SHOT.json.
        pub const MEMBERS: [(&str, &[&str]); [$($name),+].len()] =
            [$(($name, &["type", "name", $(stringify!($field)),+])),+];

        impl Light {
            /// Returns the kind.
            pub fn kind(&self) -> LightKind {
                match self {
                    $(Self::$kind { .. } => LightKind::$kind,)+
                }
            }

            /// Returns whether lights of this kind have the field at [`Field::at`].
            pub fn has(&self, at: usize) -> bool {
                KINDS[self.kind() as usize].fields.iter().any(|(field, _)| field.width > 0 && field.at == at)
            }

            /// Returns the light as numbers: see [`Field::at`].
            pub fn numbers(&self) -> [f64; NUMBERS] {
                let mut out = [0.0; NUMBERS];
                out[0] = f64::from(self.kind() as u32);
                match self {
                    $(Self::$kind { $($field),+ } => {
                        $($field.put(&mut out[$description.at..]);)+
                    })+
                }
                out
            }

            /// Returns the light of a list of [`NUMBERS`] numbers; `None` for an unknown kind or another length.
            pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
                if numbers.len() != NUMBERS {
                    return None;
                }
                let kind = numbers[0] as u32;
                $(if kind == LightKind::$kind as u32 {
                    return Some(Self::$kind { $($field: Value::take(&numbers[$description.at..])),+ });
                })+
                None
            }
        }
    };
}

pub(super) use {described, kinds};
