//! Shadow map layers and projections of lights, computed on the CPU.

use crate::scene::extent::Extent;
use bytemuck::NoUninit;
use glam::{Mat4, Vec3};
use rebounce_shared::light::LightSource;

/// Cascades of a directional light.
pub const CASCADES: u32 = 3;
/// Lights with a half angle wider than this (cosine) use a cube of six maps.
const WIDEST_COS: f32 = 0.5;
/// Maximum bytes of all shadow maps.
const BUDGET: u64 = 64 << 20;
/// Widest shadow map, texels.
pub const LARGEST: u32 = 2048;
/// Border around a map for the filter's taps, texels.
pub(crate) const BORDER: f32 = 3.0;
/// Half the width of an area light's map at distance 1. Maps overlap, for the wide filters of their penumbrae.
const AREA_BORDER: f32 = 1.4;

/// `Light` in lights.wgsl: how its shadow maps are read, and the light.
#[derive(Clone, Copy, Debug, PartialEq, NoUninit)]
#[repr(C)]
pub struct LightRecord {
    layer: u32,
    layers: u32,
    texel: f32,
    depth_scale: f32,
    source: LightSource,
}

impl LightRecord {
    /// Direction in which a light travels that is infinitely far.
    pub fn sun(&self) -> Option<Vec3> {
        self.source.is_far().then_some(self.source.direction)
    }

    /// A record that no light has.
    #[cfg(feature = "radiosity")]
    pub fn of_none(&self) -> Self {
        Self { layers: u32::MAX, ..*self }
    }

    /// Whether the light is on.
    pub fn shines(&self) -> bool {
        self.source.intensity != Vec3::ZERO
    }
}

/// The lights' records and one `clip_from_local` per layer of the shadow maps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fit {
    /// Width and height of a layer, texels.
    pub size: u32,
    /// Lights.
    pub lights: Vec<LightRecord>,
    /// Projections, reversed depth.
    pub matrices: Vec<Mat4>,
}

impl Extent {
    /// Number of layers that a light needs.
    pub fn layers(&self, light: &LightSource) -> u32 {
        if light.is_far() { 1 + self.detail.is_some() as u32 } else { most_layers(light) }
    }
}

/// Maximum number of layers of a light in any scene, cascades included.
pub fn most_layers(light: &LightSource) -> u32 {
    if light.is_far() {
        2 + CASCADES
    } else if light.cos_outer < WIDEST_COS {
        6
    } else {
        1
    }
}

/// Side of a shadow map for this number of layers, in a scene with or without `glass`: the largest within the
/// budget.
pub fn size(layers: u32, glass: bool) -> u32 {
    // The colours behind glass need eight bytes for four texels.
    let texel = if glass { 6 } else { 4 };
    let mut size = LARGEST;
    while size > 256 && size as u64 * size as u64 * texel * layers as u64 > BUDGET {
        size /= 2;
    }
    size
}

/// Fits all lights to a scene of this extent. `near` is the smallest distance of an occluder from a point or spot
/// light.
pub fn fit(lights: &[LightSource], extent: &Extent, near: f32, size: u32) -> Fit {
    let mut out = Fit { size, ..Default::default() };
    let first = lights.iter().map(|light| extent.layers(light)).sum::<u32>() as f32;
    let mut cascades = first;
    for light in lights {
        let layer = out.matrices.len() as u32;
        let border = if light.kind.is_area() { AREA_BORDER } else { 1.0 + 2.0 * BORDER / size as f32 };
        let (texel, depth_scale);
        let mut source = *light;
        if light.is_far() {
            let sun = Parallel::new(light.direction, extent.all);
            if let Some(detail) = extent.detail {
                out.matrices.push(sun.around(detail, border));
            }
            out.matrices.push(sun.around(extent.all, border));
            // A directional light has no position: the field holds layer indices.
            source.position = Vec3::new(cascades, first, 0.0);
            cascades += CASCADES as f32;
            (texel, depth_scale) = (0.0, 1.0 / sun.depth);
        } else if extent.layers(light) == 1 {
            let tan = ((1.0 - light.cos_outer * light.cos_outer).sqrt() / light.cos_outer).max(1e-3) * border;
            out.matrices.push(perspective(
                light.position,
                light.direction,
                any_up(light.direction),
                tan,
                near,
            ));
            (texel, depth_scale) = (2.0 * tan / size as f32, 0.0);
        } else {
            for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
                out.matrices.push(perspective(light.position, axis, any_up(axis), border, near));
            }
            (texel, depth_scale) = (2.0 * border / size as f32, 0.0);
        }
        let layers = out.matrices.len() as u32 - layer;
        out.lights.push(LightRecord { layer, layers, texel, depth_scale, source });
    }
    out
}

fn any_up(direction: Vec3) -> Vec3 {
    if direction.y.abs() < 0.9 { Vec3::Y } else { Vec3::X }
}

/// Builds a matrix from rows: x, y, z and w of clip space are the dot products of the rows with (position, 1).
fn from_rows(x: glam::Vec4, y: glam::Vec4, z: glam::Vec4, w: glam::Vec4) -> Mat4 {
    Mat4::from_cols(x, y, z, w).transpose()
}

/// A square perspective projection; depth is near / distance.
fn perspective(eye: Vec3, forward: Vec3, up: Vec3, tan: f32, near: f32) -> Mat4 {
    let right = forward.cross(up).normalize_or(Vec3::X);
    let up = right.cross(forward);
    let plane = |v: Vec3| v.extend(-v.dot(eye));
    from_rows(plane(right / tan), plane(up / tan), Vec3::ZERO.extend(near), plane(forward))
}

/// Square parallel projections along a direction. Depth is 1 towards the light, 0 at the far end of the scene.
pub(crate) struct Parallel {
    /// Unit vector of the projections' x axis.
    pub right: Vec3,
    /// Unit vector of the y axis, perpendicular to `right`.
    pub up: Vec3,
    /// Scene units from depth 1 to depth 0.
    depth: f32,
    plane: glam::Vec4,
}

impl Parallel {
    /// Views along `forward` in a scene with these bounds.
    pub fn new(forward: Vec3, all: [Vec3; 2]) -> Self {
        let right = forward.cross(any_up(forward)).normalize_or(Vec3::X);
        let depth = 2.0 * reach(forward, all) * 1.01;
        let plane = (-forward / depth).extend(0.5 + forward.dot(middle(all)) / depth);
        Self { right, up: right.cross(forward), depth, plane }
    }

    /// Half the width of the square around a box.
    pub fn half_width(&self, shown: [Vec3; 2]) -> f32 {
        reach(self.right, shown).max(reach(self.up, shown))
    }

    /// Projection of a box, enlarged by the factor `border`.
    fn around(&self, shown: [Vec3; 2], border: f32) -> Mat4 {
        let at = middle(shown);
        self.view(self.right.dot(at), self.up.dot(at), self.half_width(shown) * border)
    }

    /// Projection around a position along `right` and `up`.
    pub fn view(&self, x: f32, y: f32, half_width: f32) -> Mat4 {
        let axis = |axis: Vec3, at: f32| (axis / half_width).extend(-at / half_width);
        from_rows(axis(self.right, x), axis(self.up, y), self.plane, Vec3::ZERO.extend(1.0))
    }
}

/// Middle of a box.
pub(crate) fn middle([low, high]: [Vec3; 2]) -> Vec3 {
    0.5 * (low + high)
}

/// Half the extent of a box along an axis.
pub(crate) fn reach(axis: Vec3, [low, high]: [Vec3; 2]) -> f32 {
    axis.abs().dot(0.5 * (high - low)).max(1e-20)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::MAX_LAYERS;
    use rebounce_shared::light::Light;

    fn plain(low: Vec3, high: Vec3) -> Extent {
        Extent { all: [low, high], detail: None }
    }

    fn inside(clip: glam::Vec4) -> bool {
        let p = clip / clip.w;
        clip.w > 0.0 && p.x.abs() <= 1.0 && p.y.abs() <= 1.0 && (0.0..=1.0).contains(&p.z)
    }

    #[test]
    fn a_directional_light_sees_all_of_the_bounds() {
        let sun = Light::Directional {
            direction: [0.3, -1.0, 0.2],
            intensity: 1.0,
            color: [1.0; 3],
            radius_deg: 0.0,
        };
        let bounds = [Vec3::new(-3.0, 0.0, -20.0), Vec3::new(5.0, 9.0, 2.0)];
        let fit = fit(&[sun.source([0.0; 3])], &plain(bounds[0], bounds[1]), 1e-3, 1024);
        for corner in 0..8 {
            let at = |axis: usize| bounds[(corner >> axis) & 1][axis];
            assert!(inside(fit.matrices[0] * Vec3::new(at(0), at(1), at(2)).extend(1.0)));
        }
    }

    #[test]
    fn a_house_on_a_plain_has_a_cascade_of_its_own() {
        let sun = Light::Directional {
            direction: [0.3, -1.0, 0.2],
            intensity: 1.0,
            color: [1.0; 3],
            radius_deg: 0.0,
        };
        let sun = sun.source([0.0; 3]);
        let all = [Vec3::new(-5000.0, -1.0, -5000.0), Vec3::new(5000.0, 9.0, 5000.0)];
        let house = [Vec3::new(90.0, 0.0, -8.0), Vec3::new(110.0, 5.0, 8.0)];
        let extent = Extent::new(all, house);
        assert_eq!(extent.layers(&sun), 2);
        let fit = fit(&[sun], &extent, 1e-3, 1024);
        let [light] = &fit.lights[..] else { panic!("{:?}", fit.lights) };
        assert!(light.layers == 2 && fit.matrices.len() == 2);
        let widths = [0, 1].map(|i| 2.0 / fit.matrices[i].row(0).truncate().length());
        assert!(widths[0] < 40.0 && widths[1] > 10_000.0, "{widths:?}");
        for corner in 0..8 {
            let at =
                |of: [Vec3; 2]| Vec3::from_array(std::array::from_fn(|axis| of[(corner >> axis) & 1][axis]));
            // Geometry far above or below the house may stand between the house and the sun.
            for (matrix, place) in [(0, at(house)), (1, at(house)), (1, at(all))] {
                assert!(inside(fit.matrices[matrix] * place.extend(1.0)), "{matrix}: {place}");
            }
            let depths = [0, 1].map(|i| (fit.matrices[i] * at(all).extend(1.0)).z);
            assert!((depths[0] - depths[1]).abs() < 1e-5 && (0.0..=1.0).contains(&depths[0]), "{depths:?}");
        }
        assert_eq!(Extent::new(all, all).detail, None);
    }

    #[test]
    fn the_shaders_light_has_the_layout_of_the_record() {
        use std::mem::offset_of;
        let module = naga::front::wgsl::parse_str(include_str!("../../shaders/lights.wgsl")).unwrap();
        let (_, light) = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some("Light")).unwrap();
        let naga::TypeInner::Struct { members, span } = &light.inner else { panic!("{light:?}") };
        let found: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize)).collect();
        let source = |offset: usize| offset_of!(LightRecord, source) + offset;
        let expected = [
            ("layer", offset_of!(LightRecord, layer)),
            ("layers", offset_of!(LightRecord, layers)),
            ("texel", offset_of!(LightRecord, texel)),
            ("depth_scale", offset_of!(LightRecord, depth_scale)),
            ("position", source(offset_of!(LightSource, position))),
            ("kind", source(offset_of!(LightSource, kind))),
            ("direction", source(offset_of!(LightSource, direction))),
            ("cone_scale", source(offset_of!(LightSource, cone_scale))),
            ("intensity", source(offset_of!(LightSource, intensity))),
            ("cone_offset", source(offset_of!(LightSource, cone_offset))),
            ("cos_outer", source(offset_of!(LightSource, cos_outer))),
            ("size", source(offset_of!(LightSource, size))),
            ("extent", source(offset_of!(LightSource, extent))),
            ("up", source(offset_of!(LightSource, up))),
        ];
        assert_eq!(found, expected);
        assert_eq!(*span as usize, size_of::<LightRecord>());
    }

    #[test]
    fn a_long_rectangle_has_a_cube_for_each_of_its_parts() {
        let (position, direction, up, color) = ([1.0, 2.0, 3.0], [0.0, -1.0, 0.0], [0.0; 3], [1.0; 3]);
        let rectangle =
            Light::Rectangle { position, direction, up, width: 0.5, height: 1.5, intensity: 1.0, color };
        let lights: Vec<LightSource> = rectangle.source([0.0; 3]).parts().collect();
        let fit = fit(&lights, &plain(Vec3::ZERO, Vec3::ONE), 1e-3, 512);
        assert_eq!((fit.lights.len(), fit.matrices.len()), (3, 18));
    }

    #[test]
    fn every_direction_of_a_point_light_falls_into_the_layer_that_the_shader_picks() {
        let light = Light::Point { position: [1.0, 2.0, 3.0], intensity: 1.0, color: [1.0; 3], radius: 0.0 };
        let fit = fit(&[light.source([0.0; 3])], &plain(Vec3::ZERO, Vec3::ONE), 1e-3, 512);
        assert_eq!(fit.matrices.len(), 6);
        for i in 0..500 {
            let t = i as f32 * 0.37;
            let v = Vec3::new(t.sin() * (t * 1.7).cos(), (t * 0.9).sin(), (t * 2.3).cos()).normalize();
            let a = v.abs();
            // As cube_face() in visibility.wgsl.
            let face = if a.x >= a.y && a.x >= a.z {
                if v.x > 0.0 { 0 } else { 1 }
            } else if a.y >= a.z {
                if v.y > 0.0 { 2 } else { 3 }
            } else if v.z > 0.0 {
                4
            } else {
                5
            };
            assert!(inside(fit.matrices[face] * (Vec3::new(1.0, 2.0, 3.0) + 4.0 * v).extend(1.0)), "{v}");
        }
    }

    #[test]
    fn a_cone_lies_within_its_map() {
        let spot = |outer_cone_deg| {
            Light::Spot {
                position: [0.0; 3],
                direction: [0.0, -1.0, 0.0],
                outer_cone_deg,
                inner_cone_deg: None,
                intensity: 1.0,
                color: [1.0; 3],
                radius: 0.0,
            }
            .source([0.0; 3])
        };
        let narrow = fit(&[spot(50.0)], &plain(Vec3::ZERO, Vec3::ONE), 1e-3, 512);
        assert_eq!(narrow.matrices.len(), 1);
        for k in 0..16 {
            let around = k as f32 * 0.4;
            let (s, c) = 50f32.to_radians().sin_cos();
            let v = Vec3::new(s * around.cos(), -c, s * around.sin());
            assert!(inside(narrow.matrices[0] * (2.0 * v).extend(1.0)));
        }
        assert_eq!(plain(Vec3::ZERO, Vec3::ONE).layers(&spot(80.0)), 6);
    }

    #[test]
    fn maps_stay_within_their_budget() {
        for layers in 1..=MAX_LAYERS {
            for (glass, texel) in [(false, 4), (true, 6)] {
                let size = u64::from(size(layers, glass));
                assert!(size == 256 || size.pow(2) * texel * u64::from(layers) <= BUDGET);
            }
        }
    }
}
