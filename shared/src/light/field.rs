//! Description of a light's fields: name, place among the numbers, unit, range, default.

/// Description of a kind of light.
#[derive(Clone, Copy, Debug)]
pub struct LightDescription {
    /// Name of the Rust type's variant.
    pub variant: &'static str,
    /// Name in SHOT.json and the page.
    pub name: &'static str,
    /// What its lights do, in a sentence.
    pub doc: &'static str,
    /// Name of the page for lights without a name.
    pub called: &'static str,
    /// Name of the kind in the page's list of lights.
    pub listed: &'static str,
    /// Units of the intensity; the first is that of the field.
    pub units: &'static [&'static str],
    /// The fields in the order of files and links, each with a sentence about it.
    pub fields: &'static [(&'static Field, &'static str)],
}

/// A field of lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Name in Rust, SHOT.json and the page.
    pub name: &'static str,
    /// Name of the field's row in the page's panel.
    pub row: &'static str,
    /// Index of the field's first number in a light's list of numbers. Fields that no kind has together may share a
    /// place; other numbers than a kind's own are zero.
    pub at: usize,
    /// Number of numbers: 1, 3 of a vector or colour, or 0 of a text.
    pub width: usize,
    /// Meaning of an absent field.
    pub absent: Absent,
    /// Value of a new light in the page; `None` where the page knows a better one, or the default is right.
    pub fresh: Option<&'static [f64]>,
    /// Values that SHOT.json may have.
    pub range: Range,
    /// Magnitude below which pictures are finite.
    pub largest: f64,
    /// Form in a .rbn file.
    pub stored: Stored,
}

/// Form of a field in a .rbn file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stored {
    /// Not stored; zero in a light of a file.
    No,
    /// [`Field::width`] numbers.
    Numbers,
    /// A number, or none.
    Optional,
    /// A whole number from 0.
    Whole,
    /// A text, or none.
    Text,
}

/// Meaning of an absent field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Absent {
    /// The field must be there.
    Refused,
    /// The light is without; NaN in a list of numbers.
    Nothing,
    /// A number; a light with this number is written without the field.
    Number(f64),
    /// A vector or colour.
    Vector([f64; 3]),
}

/// Values that a field may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// All.
    Any,
    /// Vectors of any length but zero.
    Direction,
    /// 0 to 1, each channel.
    Color,
    /// 0 or more.
    NotNegative,
    /// Above 0.
    Positive,
    /// 0 to a number.
    UpTo(f64),
    /// Half angles in degrees, above 0 and at most a right angle.
    HalfAngle,
    /// 0 to the value of another number: its name, and its place in the list of numbers.
    UpToField(&'static str, usize),
}

impl Range {
    /// The greatest number, if the range has one of its own.
    pub fn most(self) -> Option<f64> {
        match self {
            Range::UpTo(most) => Some(most),
            Range::HalfAngle | Range::UpToField(..) => Some(90.0),
            Range::Color => Some(1.0),
            Range::Any | Range::Direction | Range::NotNegative | Range::Positive => None,
        }
    }
}

impl Field {
    /// Returns whether the field in a light's `numbers` is within its range.
    pub fn holds(&self, numbers: &[f64]) -> bool {
        let own = &numbers[self.at..self.at + self.width];
        if self.absent == Absent::Nothing && own.iter().all(|number| number.is_nan()) {
            return true;
        }
        let all = |holds: &dyn Fn(f64) -> bool| own.iter().all(|number| holds(*number));
        match self.range {
            Range::Any => true,
            Range::Direction => !all(&|x| x == 0.0),
            Range::Color => all(&|x| (0.0..=1.0).contains(&x)),
            Range::NotNegative => all(&|x| x >= 0.0),
            Range::Positive => all(&|x| x > 0.0),
            Range::UpTo(most) => all(&|x| (0.0..=most).contains(&x)),
            Range::HalfAngle => all(&|x| x > 0.0 && x <= 90.0),
            Range::UpToField(_, at) => all(&|x| (0.0..=numbers[at]).contains(&x)),
        }
    }

    /// Returns whether the field in a light's `numbers` is finite and below [`Self::largest`], or absent where it may be.
    pub fn is_finite(&self, numbers: &[f64]) -> bool {
        let may_lack = self.absent == Absent::Nothing;
        let own = &numbers[self.at..self.at + self.width];
        own.iter().all(|number| number.abs() < self.largest || may_lack && number.is_nan())
    }

    /// Returns what is wrong with the field in a light's `numbers`, in words; `None` if the field is within its range.
    /// Formats numbers, which the viewer has no code for: it asks [`Self::holds`].
    pub fn problem(&self, numbers: &[f64]) -> Option<String> {
        let rule = match self.range {
            Range::Any => return None,
            Range::Direction => "must point somewhere, and not be zero".to_owned(),
            Range::Color => "is linear RGB, each from 0 to 1; how bright it is, intensity says".to_owned(),
            Range::NotNegative => "is 0 or more, not negative".to_owned(),
            Range::Positive => "is above 0".to_owned(),
            Range::UpTo(most) => format!("lies between 0 and {most}"),
            Range::HalfAngle => "is a half angle between 0 and 90".to_owned(),
            Range::UpToField(name, _) => format!("lies between 0 and {name}"),
        };
        (!self.holds(numbers)).then(|| format!("{} {rule}", self.name))
    }
}

/// A type of fields, as numbers.
pub(super) trait Value: Default {
    /// Writes the value's numbers to the front of a list.
    fn put(&self, out: &mut [f64]);
    /// Reads a value from the front of a list.
    fn take(numbers: &[f64]) -> Self;
}

impl Value for f64 {
    fn put(&self, out: &mut [f64]) {
        out[0] = *self;
    }

    fn take(numbers: &[f64]) -> Self {
        numbers[0]
    }
}

impl Value for Option<f64> {
    fn put(&self, out: &mut [f64]) {
        out[0] = self.unwrap_or(f64::NAN);
    }

    fn take(numbers: &[f64]) -> Self {
        Some(numbers[0]).filter(|number| !number.is_nan())
    }
}

impl Value for u32 {
    fn put(&self, out: &mut [f64]) {
        out[0] = f64::from(*self);
    }

    fn take(numbers: &[f64]) -> Self {
        numbers[0] as u32
    }
}

/// A text, which numbers do not carry.
impl Value for Option<String> {
    fn put(&self, _out: &mut [f64]) {}

    fn take(_numbers: &[f64]) -> Self {
        None
    }
}

impl Value for [f64; 3] {
    fn put(&self, out: &mut [f64]) {
        out[..3].copy_from_slice(self);
    }

    fn take(numbers: &[f64]) -> Self {
        [numbers[0], numbers[1], numbers[2]]
    }
}
