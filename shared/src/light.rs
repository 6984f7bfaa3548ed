//! Lights as in SHOT.json: those of KHR_lights_punctual, with a size; lights with a surface; environments; groups of
//! shining surfaces.
//!
//! [`KINDS`] describes the kinds and their fields; [`Light`] and its forms in files, SHOT.json and the page follow from
//! it. [`LightSource`] is a light prepared for evaluation; `area` has the irradiance of those with a surface.

mod area;
mod field;
mod kinds;
mod source;
mod stored;
mod table;

pub use area::{MOST_CORNERS, polygon_projected_solid_angle};
pub use field::{Absent, Field, LightDescription, Range, Stored};
pub use kinds::{
    COLOR, DIRECTION, INTENSITY, KINDS, Light, LightKind, MEMBERS, NUMBERS, POSITION, ROTATION, SIZE,
    WIDEST_DEG,
};
pub use source::{Incident, LightSource};

use glam::{DVec3, Vec3};

impl Light {
    /// Returns the position, world space; `None` for lights that are infinitely far.
    pub fn position(&self) -> Option<[f64; 3]> {
        self.vector(POSITION.at)
    }

    /// Returns the way the light travels, of any length; `None` for lights that shine all around.
    pub fn direction(&self) -> Option<[f64; 3]> {
        self.vector(DIRECTION.at)
    }

    /// Returns the intensity: candela, lux of a directional light, nits of a light with a surface, or a factor.
    pub fn intensity(&self) -> f64 {
        self.numbers()[INTENSITY.at]
    }

    /// Returns the colour, linear RGB.
    pub fn color(&self) -> [f64; 3] {
        self.vector(COLOR.at).unwrap_or([1.0; 3])
    }

    /// Returns intensity times colour, linear RGB.
    pub fn strength(&self) -> Vec3 {
        (DVec3::from(self.color()) * self.intensity()).as_vec3()
    }

    /// Returns the radius in scene units; for a directional light, degrees; 0 for lights without.
    pub fn size(&self) -> f64 {
        self.numbers()[SIZE.at]
    }

    /// Returns the light with another value of the field at [`Field::at`]; unchanged without this field.
    pub fn with(&self, at: usize, value: &[f64]) -> Self {
        let mut numbers = self.numbers();
        numbers[at..at + value.len()].copy_from_slice(value);
        let mut out = Self::from_numbers(&numbers).unwrap_or_else(|| self.clone());
        if let (Self::Environment { file, .. }, Self::Environment { file: own, .. }) = (&mut out, self) {
            file.clone_from(own);
        }
        out
    }

    /// Returns true if the light's numbers are finite and small enough for finite pictures: positions under 1e15 units,
    /// intensities and colours under 1e18.
    pub fn is_usable(&self) -> bool {
        let numbers = self.numbers();
        KINDS[self.kind() as usize].fields.iter().all(|(field, _)| field.is_finite(&numbers))
    }

    /// Returns whether all fields are within their ranges.
    pub fn is_within_ranges(&self) -> bool {
        let numbers = self.numbers();
        KINDS[self.kind() as usize].fields.iter().all(|(field, _)| field.holds(&numbers))
    }

    /// Returns the first field outside its range, in words; `None` for a light that SHOT.json may have.
    pub fn problem(&self) -> Option<String> {
        let numbers = self.numbers();
        KINDS[self.kind() as usize].fields.iter().find_map(|(field, _)| field.problem(&numbers))
    }

    fn vector(&self, at: usize) -> Option<[f64; 3]> {
        let numbers = self.numbers();
        self.has(at).then(|| [numbers[at], numbers[at + 1], numbers[at + 2]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_have_the_names_and_places_that_the_table_says() {
        let mut end = 1;
        for (kind, (name, members)) in KINDS.iter().zip(MEMBERS) {
            assert_eq!((kind.name, &["type", "name"][..]), (name, &members[..2]));
            let fields: Vec<&Field> = kind.fields.iter().map(|(field, _)| *field).collect();
            assert_eq!(fields.iter().map(|field| field.name).collect::<Vec<_>>(), members[2..]);
            for (i, field) in fields.iter().enumerate() {
                let apart =
                    |other: &&Field| other.at + other.width <= field.at || field.at + field.width <= other.at;
                let is_text = field.width == 0;
                assert!(is_text || field.at > 0, "{name}: {}", field.name);
                assert!(is_text || fields[..i].iter().all(apart), "{name}: {} and another", field.name);
                end = end.max(field.at + field.width);
            }
        }
        assert_eq!(end, NUMBERS);
    }

    #[test]
    fn numbers_of_every_kind_come_back_and_an_absent_field_is_left_out() {
        for (number, kind) in KINDS.iter().enumerate() {
            let mut numbers = [0.0; NUMBERS];
            numbers[0] = number as f64;
            for (field, _) in kind.fields {
                match field.absent {
                    Absent::Nothing => numbers[field.at..field.at + field.width].fill(f64::NAN),
                    Absent::Vector(all) => numbers[field.at..field.at + 3].copy_from_slice(&all),
                    Absent::Number(all) => numbers[field.at] = all,
                    Absent::Refused => numbers[field.at..field.at + field.width].fill(0.5),
                }
            }
            let light = Light::from_numbers(&numbers).unwrap();
            assert_eq!(light.numbers().map(f64::to_bits), numbers.map(f64::to_bits));
            assert_eq!((light.problem(), light.is_usable()), (None, true));
            for (field, _) in kind.fields.iter().filter(|(field, _)| field.width > 0) {
                let mut wrong = numbers;
                wrong[field.at..field.at + field.width].fill(f64::INFINITY);
                assert!(!Light::from_numbers(&wrong).unwrap().is_usable(), "{}: {}", kind.name, field.name);
            }
        }
    }
}
