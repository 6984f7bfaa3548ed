//! Coordinates of a texture in which every triangle has texels of its own: charts, flattened and packed by `uvunwrap`.

use super::PADDING;
use super::meshes::ExportMesh;
use std::collections::HashMap;
use uvunwrap::{MeshInput, Options, Packing};

/// Texels along a scene unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// As many; an error if they do not fit.
    Exactly(f32),
    /// As many, or as fit.
    AtMost(f32),
}

/// Number of triangles from which charts are packed in rows: less dense, and tens of times faster with thousands of
/// charts.
const MANY: u64 = 100_000;
/// Share of a texture that charts fill at most: a greater area surely does not fit.
const FULL: f64 = 0.98;
/// Share of the greatest density of which a message says that it fits.
const SURELY: f32 = 0.98;

/// Cosine of the angle between the normals on the two sides of an edge, under which the edge is a crease: 30 degrees.
const CREASE: f32 = 0.866;

/// Why there are no coordinates.
#[derive(Debug, thiserror::Error)]
pub enum UnwrapError {
    /// The wanted density does not fit.
    #[error(
        "{wanted} texels a metre do not fit a texture of {most} x {most}: give --texels-per-metre {fitting:.3}, or a \
         greater --max-size"
    )]
    TooLarge {
        /// Texels along a scene unit.
        wanted: f32,
        /// The limit, texels along a side.
        most: u32,
        /// A density that fits, texels along a scene unit.
        fitting: f32,
    },
    /// The charts do not fit at any density.
    #[error(
        "the scene's {triangles} triangles do not fit a texture of {most} x {most}: give a greater --max-size"
    )]
    TooMany {
        /// Number of triangles, each copy counted.
        triangles: u64,
        /// The limit, texels along a side.
        most: u32,
    },
    /// There is nothing to unwrap.
    #[error("there is no surface that light falls on: bake a scene with materials that are not unlit")]
    Empty,
    /// A mesh cannot be unwrapped.
    #[error("the scene cannot be unwrapped: {0}; use --vertex-colours")]
    Mesh(String),
}

/// Rectangle of a texture, coordinates from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvRect {
    /// Least coordinates.
    pub min: [f32; 2],
    /// Greatest coordinates.
    pub max: [f32; 2],
}

impl UvRect {
    /// The whole texture.
    pub const WHOLE: Self = Self { min: [0.0; 2], max: [1.0; 2] };

    /// Returns the coordinates in the texture of coordinates in the rectangle.
    pub fn place(&self, uv: [f32; 2]) -> [f32; 2] {
        std::array::from_fn(|i| self.min[i] + uv[i] * (self.max[i] - self.min[i]))
    }
}

/// A vertex after unwrapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnwrappedVertex {
    /// The vertex of the mesh that it was.
    pub source: u32,
    /// Coordinates in the rectangle of the mesh's copy; the texture's top left is zero.
    pub uv: [f32; 2],
    /// The chart; `None` for a triangle without texels.
    pub chart: Option<u32>,
}

/// A mesh after unwrapping: the same triangles in the same order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnwrappedMesh {
    /// Vertices, those at seams several times.
    pub vertices: Vec<UnwrappedVertex>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Rectangle of each copy.
    pub rects: Vec<UvRect>,
}

/// Coordinates of all meshes in one texture.
#[derive(Clone, Debug, PartialEq)]
pub struct UvAtlas {
    /// Width, texels.
    pub width: u32,
    /// Height, texels.
    pub height: u32,
    /// Texels along a scene unit.
    pub texels_per_unit: f32,
    /// Texels along a scene unit that were wanted, if they did not fit.
    pub wanted: Option<f32>,
    /// Number of charts; those of a model count once.
    pub chart_count: u32,
    /// Share of the texels that show a surface, 0 to 1.
    pub used: f32,
    /// The meshes, in their order.
    pub meshes: Vec<UnwrappedMesh>,
}

/// Unwraps meshes into a texture of at most `max_size` × `max_size` texels. Triangles of materials without `is_used` get no
/// texels.
///
/// # Errors
/// [`UnwrapError`].
pub fn unwrap(
    meshes: &[ExportMesh],
    density: Density,
    max_size: u32,
    is_used: impl Fn(u32) -> bool,
) -> Result<UvAtlas, UnwrapError> {
    let ignored: Vec<Vec<bool>> =
        meshes.iter().map(|mesh| mesh.materials.iter().map(|m| !is_used(*m)).collect()).collect();
    let scales: Vec<Vec<f32>> =
        meshes.iter().map(|mesh| if mesh.is_model { mesh.scales() } else { Vec::new() }).collect();
    let creases: Vec<Vec<[bool; 3]>> = meshes.iter().map(creases).collect();
    let inputs: Vec<MeshInput> = meshes
        .iter()
        .zip(ignored.iter().zip(&scales).zip(&creases))
        .map(|(mesh, ((ignored, scales), creases))| MeshInput {
            face_materials: Some(&mesh.materials),
            ignored_faces: Some(ignored),
            instance_scales: scales,
            seams: Some(creases),
            ..MeshInput::new(&mesh.positions, mesh.triangles.as_flattened())
        })
        .collect();
    let area = area(meshes, &is_used);
    if area <= 0.0 {
        return Err(UnwrapError::Empty);
    }
    let triangles = meshes.iter().map(ExportMesh::triangles_placed).sum();
    let packing = if triangles < MANY { Packing::Shape } else { Packing::Fast };
    let run = |density: uvunwrap::Density| {
        let options = Options { density, padding: PADDING, packing, ..Options::default() };
        uvunwrap::generate(&inputs, &options)
    };
    let (Density::Exactly(wanted) | Density::AtMost(wanted)) = density;
    let fits = |atlas: &uvunwrap::Atlas| atlas.width.max(atlas.height) <= max_size && atlas.page_count <= 1;
    let too_many = |error: uvunwrap::Error| match is_of_size(&error) {
        true => UnwrapError::TooMany { triangles, most: max_size },
        false => UnwrapError::Mesh(error.to_string()),
    };
    let needed = area.sqrt() * f64::from(wanted);
    // Nothing far too large is tried: it would take long, and much memory.
    let is_hopeless = needed * needed > FULL * f64::from(max_size).powi(2);
    let mut fitting = None;
    // As large as need be; then, of another shape, the greatest.
    for page_size in [None, Some(max_size)].into_iter().filter(|_| !is_hopeless) {
        match run(uvunwrap::Density::Fixed { texels_per_unit: wanted, page_size }) {
            Ok(atlas) if fits(&atlas) => fitting = Some(atlas),
            Err(error) if !is_of_size(&error) => return Err(UnwrapError::Mesh(error.to_string())),
            _ => {}
        }
        if fitting.is_some() {
            break;
        }
    }
    let (atlas, was_wanted) = match fitting {
        Some(atlas) => (atlas, None),
        None => {
            let atlas = run(uvunwrap::Density::Auto { page_size: max_size }).map_err(too_many)?;
            if !fits(&atlas) {
                return Err(UnwrapError::TooMany { triangles, most: max_size });
            }
            if let Density::Exactly(_) = density {
                let fitting = SURELY * atlas.texels_per_unit;
                return Err(UnwrapError::TooLarge { wanted, most: max_size, fitting });
            }
            (atlas, Some(wanted))
        }
    };
    Ok(UvAtlas {
        width: atlas.width,
        height: atlas.height,
        texels_per_unit: atlas.texels_per_unit,
        wanted: was_wanted,
        chart_count: atlas.chart_count,
        used: atlas.utilization,
        meshes: atlas.meshes.into_iter().map(unwrapped).collect(),
    })
}

/// Returns whether each edge of each triangle is a crease: the light on its two sides has nothing in common, and is not to
/// be filtered together.
fn creases(mesh: &ExportMesh) -> Vec<[bool; 3]> {
    let at = |vertex: u32| mesh.positions[vertex as usize].map(f32::to_bits);
    let mut first: HashMap<([u32; 3], [u32; 3]), [u32; 2]> = HashMap::new();
    let mut out = vec![[false; 3]; mesh.triangles.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]];
            // The other triangle goes along the edge the other way.
            match first.get(&(at(b), at(a))) {
                Some([other_b, other_a]) => {
                    let turn = |v: u32, w: u32| mesh.normals[v as usize].dot(mesh.normals[w as usize]);
                    out[t][k] = turn(a, *other_a).min(turn(b, *other_b)) < CREASE;
                }
                None => drop(first.insert((at(a), at(b)), [a, b])),
            }
        }
    }
    out
}

/// Returns whether an error is of the texture's size alone.
fn is_of_size(error: &uvunwrap::Error) -> bool {
    matches!(error, uvunwrap::Error::AtlasTooLarge { .. } | uvunwrap::Error::ChartTooLarge { .. })
}

/// Returns the area that needs texels, square scene units.
fn area(meshes: &[ExportMesh], is_used: impl Fn(u32) -> bool) -> f64 {
    let mut total = 0.0;
    for mesh in meshes {
        let used = (0..mesh.triangles.len()).filter(|t| is_used(mesh.materials[*t]));
        let own: f64 = used.map(|t| f64::from(mesh.triangle(0, t).area())).sum();
        let scales = mesh.scales();
        let first = scales.first().copied().unwrap_or(1.0).max(f32::MIN_POSITIVE);
        total += own * scales.iter().map(|scale| f64::from(scale / first).powi(2)).sum::<f64>();
    }
    total
}

fn unwrapped(mesh: uvunwrap::OutputMesh) -> UnwrappedMesh {
    let rects: Vec<UvRect> =
        mesh.instances.iter().map(|rect| UvRect { min: rect.min, max: rect.max }).collect();
    let vertex = |v: &uvunwrap::OutputVertex| UnwrappedVertex { source: v.xref, uv: v.uv, chart: v.chart };
    UnwrappedMesh {
        vertices: mesh.vertices.iter().map(vertex).collect(),
        triangles: mesh.indices.as_chunks::<3>().0.to_vec(),
        rects: if rects.is_empty() { vec![UvRect::WHOLE] } else { rects },
    }
}
