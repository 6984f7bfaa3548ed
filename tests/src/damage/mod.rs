//! Generator of damaged .rbn files, as from a hostile or broken source; deterministic by seed and file number.
//!
//! * `container` – damage to bytes, lengths, counts and sections, with original or repaired checksums;
//! * `contents` – wrong values under valid checksums.

mod container;
mod contents;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::random::Stream;

/// Expected outcome of reading a damaged file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Rejection: a checksum or a length is wrong.
    Error,
    /// Rejection or an arbitrary picture: checksums are valid.
    Any,
}

/// Damaged file.
pub struct Damaged {
    /// Description of the damage.
    pub what: String,
    /// Expected outcome.
    pub outcome: Outcome,
    /// The file.
    pub bytes: Vec<u8>,
}

/// Names and bytes of a file's sections.
pub type Sections = Vec<([u8; 4], Vec<u8>)>;

/// Creates damaged file number `index`; `file` is the packed `scene`, with points, materials and draw calls.
pub fn damage(file: &[u8], scene: &BakedScene, seed: u64, index: u64) -> Damaged {
    let mut random = Random(Stream::new(seed, index));
    loop {
        let made = match random.below(12) {
            0 => Some(container::flip(file, &mut random)),
            1 => Some(container::cut(file, &mut random)),
            2 => Some(container::flip_sealed(file, &mut random)),
            3 => container::swap(file, &mut random),
            4 => container::resize(file, &mut random),
            5 | 6 => Some(container::lie(file, &mut random)),
            _ => contents::lie(scene, &mut random),
        };
        // Damage may be ineffective, for instance a swap of two equal sections.
        if let Some(made) = made.filter(|made| made.bytes != file) {
            return made;
        }
    }
}

/// Random choices.
pub struct Random(Stream);

impl Random {
    /// Returns a uniform number below `end`, at least 1.
    pub fn below(&mut self, end: usize) -> usize {
        (self.0.bits() % end.max(1) as u64) as usize
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.bits()
    }

    /// Returns a random element.
    pub fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// Returns a hostile length, count or index near or far from the true value.
    pub fn number(&mut self, truth: u64) -> u64 {
        let bits = self.bits();
        let near = 1 + bits % 4;
        self.one(&[
            0,
            truth.wrapping_add(near),
            truth.wrapping_sub(near),
            truth / 2,
            truth.wrapping_mul(2),
            u32::MAX as u64,
            1 << 31,
            u64::MAX,
            u64::MAX - 255,
            bits,
            bits & 0xffff,
        ])
    }

    /// Returns an unusual float.
    pub fn float(&mut self) -> f32 {
        let bits = self.bits() as u32;
        self.one(&[
            0.0,
            -0.0,
            -1.0,
            1e-38,
            -1e-45,
            1e9,
            -3e14,
            1e30,
            f32::MAX,
            f32::MIN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
            f32::from_bits(bits),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::camera::Camera;
    use rebounce_shared::rbn::bulk::{Point, Vertex};
    use rebounce_shared::rbn::meta::{Draw, Level, Material, Meta};
    use rebounce_shared::rbn::{LinkMatrix, container};

    fn scene() -> BakedScene {
        let camera =
            Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 50.0 };
        let point = Point { radius: 1.0, ..Point::default() };
        let mut scene = BakedScene {
            meta: Meta {
                levels: vec![Level { first: 0, count: 1, disk_radius: 0.5, support_radius: 1.0 }],
                sender_levels: 1,
                direct_levels: 1,
                materials: vec![Material::default()],
                draws: vec![Draw { first_index: 0, index_count: 3, material: 0 }],
                cameras: vec![camera],
                ..Meta::default()
            },
            vertices: vec![Vertex::default(); 3],
            indices: vec![0, 1, 2],
            texture_bytes: vec![0; 8],
            points: vec![point],
            links: LinkMatrix::from_rows(&[Vec::new()]),
            ..BakedScene::default()
        };
        scene.relate().unwrap();
        scene
    }

    #[test]
    fn a_file_follows_from_its_seed_and_number_and_is_never_whole() {
        let scene = scene();
        let file = scene.to_bytes().unwrap();
        let (mut sealed, mut refused) = (0, 0);
        for index in 0..400 {
            let made = damage(&file, &scene, 7, index);
            let again = damage(&file, &scene, 7, index);
            assert_eq!((&made.bytes, &made.what), (&again.bytes, &again.what));
            assert_ne!(made.bytes, file, "{}", made.what);
            match made.outcome {
                Outcome::Error => {
                    assert!(container::read(&made.bytes).is_err(), "{index}: {}", made.what);
                    refused += 1;
                }
                // Repaired: the container is valid.
                Outcome::Any => sealed += container::read(&made.bytes).is_ok() as u32,
            }
        }
        assert!(sealed > 200 && refused > 50, "{sealed} sealed, {refused} to be refused");
    }
}
