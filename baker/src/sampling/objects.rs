//! Points on objects that may move, after Schäfer et al. 2011, *Meshless Radiosity on the GPU*: candidates spread evenly over
//! all of an object's surface.
//!
//! Importance particles find the surfaces that light can reach where things stand now; the foot of a statue is on none of
//! their ways, and is seen as soon as the statue is lifted. Large groups, such as the walls of a room, keep the particles:
//! most of what their nodes hold is never seen.

use super::SurfacePoint;
use super::patience::{Patience, SHARES};
use super::place_settings::PlaceSettings;
use super::poisson_disk::DartBoard;
use crate::geometry::{Hit, Primitives, SurfaceCoordinates, Surfaces};
use crate::random::Stream;
use crate::scene::union;
use glam::{Vec2, Vec3};

/// Greatest diagonal of an object, as a share of the scene's main part.
const OBJECT: f32 = 0.5;

/// Primitives of a group that may move.
#[derive(Debug, Default)]
pub(super) struct Object {
    /// Reconstruction group.
    pub group: u32,
    /// Numbers of the primitives, and the sum of their areas up to and with each; both sides count.
    primitives: Vec<(u32, f32)>,
}

/// Objects of a scene.
#[derive(Debug, Default)]
pub(super) struct Objects {
    /// Objects, by group.
    pub all: Vec<Object>,
    /// Whether there are surfaces of no object.
    pub has_others: bool,
}

/// The corners of a primitive's front, at its [coordinates](SurfaceCoordinates::at).
fn corners(primitives: &dyn Primitives, primitive: u32) -> [Vec3; 3] {
    [Vec2::ZERO, Vec2::X, Vec2::Y]
        .map(|at| primitives.spot(SurfaceCoordinates { primitive, at, is_back: false }, 0.0).position)
}

impl Objects {
    /// Finds the objects: groups that may move and are small beside the scene.
    pub fn new<S: Surfaces + ?Sized>(surfaces: &S, settings: &PlaceSettings) -> Self {
        let groups = &settings.groups;
        let primitives = surfaces.primitives().filter(|_| groups.iter().any(|group| group.moves));
        let Some(primitives) = primitives else { return Self { all: Vec::new(), has_others: true } };
        let mut all: Vec<(Object, Option<(Vec3, Vec3)>)> =
            groups.iter().map(|_| Default::default()).collect();
        for primitive in 0..primitives.count() as u32 {
            let middle = SurfaceCoordinates { primitive, at: Vec2::splat(1.0 / 3.0), is_back: false };
            let group = primitives.spot(middle, 0.0).group;
            let Some((object, bounds)) = all.get_mut(group as usize) else { continue };
            let [a, b, c] = corners(primitives, primitive);
            let area = (b - a).cross(c - a).length()
                * if primitives.primitive(primitive).has_back { 2.0 } else { 1.0 };
            let before = object.primitives.last().map_or(0.0, |(_, sum)| *sum);
            object.group = group;
            object.primitives.push((primitive, before + area));
            let own = (a.min(b).min(c), a.max(b).max(c));
            *bounds = Some(bounds.map_or(own, |bounds| union(bounds, own)));
        }
        let (low, high) = surfaces.main_part();
        let largest = OBJECT * (high - low).length();
        let is_object = |(object, bounds): &(Object, Option<(Vec3, Vec3)>)| {
            groups[object.group as usize].moves
                && bounds.is_some_and(|(low, high)| (high - low).length() <= largest)
        };
        let (objects, others): (Vec<_>, Vec<_>) =
            all.into_iter().filter(|(object, _)| !object.primitives.is_empty()).partition(is_object);
        Self { all: objects.into_iter().map(|(object, _)| object).collect(), has_others: !others.is_empty() }
    }
}

impl Object {
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
        let whole = self.primitives.last()?.1;
        let wanted = stream.unit() * whole;
        let place = self.primitives.partition_point(|(_, sum)| *sum <= wanted).min(self.primitives.len() - 1);
        let primitive = self.primitives[place].0;
        let square = stream.square();
        let at = if square.element_sum() > 1.0 { 1.0 - square } else { square };
        let is_back = primitives.primitive(primitive).has_back && stream.unit() < 0.5;
        let spot = primitives.spot(SurfaceCoordinates { primitive, at, is_back }, 0.0);
        if stream.unit() >= spot.opacity {
            return None;
        }
        let [a, b, c] = corners(primitives, primitive);
        let across = (b - a).cross(c - a).normalize_or_zero();
        let geometric_normal = if across.dot(spot.normal) < 0.0 { -across } else { across };
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
        };
        Some(SurfacePoint::at(&hit, surfaces))
    }
}
