//! Points on objects that may move, after Schäfer et al. 2011, *Meshless Radiosity on the GPU*: candidates spread evenly over
//! all of an object's surface, but for its [interior](super::interior).
//!
//! Importance particles find the surfaces that light can reach where things stand now; the foot of a statue is on none of
//! their ways, and is seen as soon as the statue is lifted. Large groups, such as the walls of a room, keep the particles:
//! most of what their nodes hold is never seen.

use super::SurfacePoint;
use super::interior::Interior;
use super::object_side::{ObjectSide, corners, place};
use super::patience::{Patience, SHARES};
use super::place_settings::PlaceSettings;
use super::poisson_disk::DartBoard;
use crate::geometry::{Gloss, Hit, Primitives, SurfaceCoordinates, Surfaces};
use crate::random::Stream;
use crate::scene::union;
use glam::{Vec2, Vec3};

/// Greatest diagonal of an object, as a share of the scene's main part.
const OBJECT: f32 = 0.5;

/// Surface of a group that may move.
#[derive(Debug, Default)]
pub(super) struct Object {
    /// Reconstruction group.
    pub group: u32,
    /// Sides of its primitives that can be seen from elsewhere, and the sum of the areas up to and with each.
    sides: Vec<(ObjectSide, f32)>,
}

/// Objects of a scene.
#[derive(Debug, Default)]
pub(super) struct Objects {
    /// Objects, by group.
    pub all: Vec<Object>,
    /// Whether there are surfaces of no object.
    pub has_others: bool,
}

impl Objects {
    /// Finds the objects: groups that may move and are small beside the scene. `finest` is the disk radius of the finest
    /// level.
    pub fn new<S: Surfaces + ?Sized>(
        surfaces: &S,
        viewpoints: &[Vec3],
        settings: &PlaceSettings,
        finest: f32,
    ) -> Self {
        let groups = &settings.groups;
        let primitives = surfaces.primitives().filter(|_| groups.iter().any(|group| group.moves));
        let Some(primitives) = primitives else { return Self { all: Vec::new(), has_others: true } };
        let mut sides: Vec<Vec<ObjectSide>> = vec![Vec::new(); groups.len()];
        let mut bounds: Vec<Option<(Vec3, Vec3)>> = vec![None; groups.len()];
        for primitive in 0..primitives.count() as u32 {
            let middle = SurfaceCoordinates { primitive, at: Vec2::splat(1.0 / 3.0), is_back: false };
            let group = primitives.spot(middle, 0.0).group;
            let (Some(sides), Some(bounds)) = (sides.get_mut(group as usize), bounds.get_mut(group as usize))
            else {
                continue;
            };
            let [a, b, c] = corners(primitives, primitive);
            let area = (b - a).cross(c - a).length();
            let has_back = primitives.primitive(primitive).has_back;
            let both = [false, true].into_iter().take(1 + usize::from(has_back));
            sides.extend(both.map(|is_back| ObjectSide { primitive, is_back, area }));
            let own = (a.min(b).min(c), a.max(b).max(c));
            *bounds = Some(bounds.map_or(own, |bounds| union(bounds, own)));
        }
        let (low, high) = surfaces.main_part();
        let largest = OBJECT * (high - low).length();
        let (mut out, scales) = (Self::default(), settings.scales());
        for (group, (sides, bounds)) in sides.into_iter().zip(bounds).enumerate() {
            let Some((low, high)) = bounds else { continue };
            let reach = (high - low).length();
            if !groups[group].moves || reach > largest {
                out.has_others = true;
                continue;
            }
            let (disk, group) = (finest * scales[group], group as u32);
            let interior = Interior { surfaces, primitives, group, reach, disk, seed: settings.seed };
            out.all.push(Object::new(group, interior.without(sides, viewpoints)));
        }
        out
    }
}

impl Object {
    fn new(group: u32, sides: Vec<ObjectSide>) -> Self {
        let sum = |sum: &mut f32, side: ObjectSide| {
            *sum += side.area;
            Some((side, *sum))
        };
        Self { group, sides: sides.into_iter().scan(0.0, sum).collect() }
    }

    /// Throws candidates on all of the surface, where they are `needed`, until no more fit.
    pub fn thrown<S: Surfaces + ?Sized>(
        &self,
        surfaces: &S,
        mut board: DartBoard,
        (level, settings): (usize, &PlaceSettings),
        needed: impl Fn(&SurfacePoint) -> bool,
    ) -> Vec<SurfacePoint> {
        let Some(primitives) = surfaces.primitives() else { return Vec::new() };
        let mut stream =
            Stream::new(settings.seed ^ 0x6f62_6a65, (level as u64) << 32 | u64::from(self.group));
        let mut patience = Patience::new(settings.patience);
        // Without a point so far, the same number of tries.
        let most = SHARES * settings.patience * 16;
        loop {
            patience.tried += SHARES;
            if let Some(candidate) = self.candidate(surfaces, primitives, &mut stream)
                && board.is_free(&candidate)
                && needed(&candidate)
            {
                patience.inserted(board.len());
                board.insert(candidate);
            } else if patience.is_over(board.len()) || (board.is_empty() && patience.tried > most) {
                return board.into_points();
            }
        }
    }

    /// A candidate; `None` where the surface lets rays through.
    fn candidate<S: Surfaces + ?Sized>(
        &self,
        surfaces: &S,
        primitives: &dyn Primitives,
        stream: &mut Stream,
    ) -> Option<SurfacePoint> {
        let wanted = stream.unit() * self.sides.last()?.1;
        let at = self.sides.partition_point(|(_, sum)| *sum <= wanted).min(self.sides.len() - 1);
        let (spot, geometric_normal) = place(primitives, &self.sides[at].0, stream);
        if stream.unit() >= spot.opacity {
            return None;
        }
        let hit = Hit {
            distance: 0.0,
            position: spot.position,
            geometric_normal,
            normal: spot.normal,
            albedo: spot.albedo,
            emission: Vec3::ZERO,
            emitter: None,
            is_unlit: false,
            group: spot.group,
            lightmap: None,
            gloss: Gloss::MATT,
        };
        Some(SurfacePoint::at(&hit, surfaces))
    }
}
