//! Statistics of the viewer.

use crate::passes::timing::Milliseconds;
#[cfg(feature = "antiradiance")]
use crate::scene::antiradiance::AntiradianceCounts;

/// Counts, bytes and times.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Stats {
    /// Name of the graphics adapter.
    pub adapter: String,
    /// The scene's name.
    pub scene: String,
    /// Way from functions to pixels of the last picture: `lookup` or `splat`.
    pub display: &'static str,
    /// Milliseconds of the last run of every pass; absent if the device has no timestamp queries.
    pub milliseconds: Milliseconds,
    /// Pictures drawn so far.
    pub frames: u64,
    /// Number of relightings so far.
    pub relights: u64,
    /// Lights whose direct light at the points was evaluated, summed over all relightings: only changed lights
    /// count.
    pub lights_evaluated: u64,
    /// Shadow-map layers drawn so far.
    pub shadow_layers: u64,
    /// Width of a shadow map, texels.
    pub shadow_size: u32,
    /// Layers of blended surfaces drawn so far: the scene's number of layers in every picture, zero without blended
    /// surfaces.
    pub blended_layers: u64,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Basis functions per level, coarsest first.
    pub functions: Vec<u32>,
    /// Transport links.
    pub links: usize,
    /// Lights.
    pub lights: usize,
    /// Bytes on the GPU.
    pub bytes: Bytes,
    /// What antiradiance takes, where it computes bounced light.
    #[cfg(feature = "antiradiance")]
    #[serde(skip)]
    pub antiradiance: Option<AntiradianceCounts>,
}

impl Stats {
    /// All numbers as JSON, rounded to integers: milliseconds as microseconds. Names are omitted.
    pub fn json(&self) -> String {
        use std::fmt::Write;
        let mut json = String::from("{\"functions\":[");
        for (i, count) in self.functions.iter().enumerate() {
            let _ = write!(json, "{}{count}", if i > 0 { "," } else { "" });
        }
        json.push(']');
        let mut group = |name: &str, members: &[(&str, Option<u64>)]| {
            let _ = write!(json, ",\"{name}\":{{");
            let mut comma = "";
            for (name, value) in members.iter().filter_map(|(name, value)| Some((name, (*value)?))) {
                let _ = write!(json, "{comma}\"{name}\":{value}");
                comma = ",";
            }
            json.push('}');
        };
        let (m, b) = (&self.milliseconds, &self.bytes);
        let micros = |ms: Option<f64>| ms.map(|ms| (ms * 1e3) as u64);
        group(
            "microseconds",
            &[
                ("shadows", micros(m.shadows)),
                ("relight", micros(m.relight)),
                ("gBuffer", micros(m.g_buffer)),
                ("find", micros(m.find)),
                ("gather", micros(m.gather)),
                ("blended", micros(m.blended)),
                ("composite", micros(m.composite)),
                #[cfg(feature = "antiradiance")]
                ("antiradiance", micros(m.antiradiance)),
            ],
        );
        group(
            "bytes",
            &[
                ("scene", Some(b.scene)),
                ("textures", Some(b.textures)),
                ("relight", Some(b.relight)),
                ("shadows", Some(b.shadows)),
                ("picture", Some(b.picture)),
            ],
        );
        #[cfg(feature = "antiradiance")]
        if let Some(own) = &self.antiradiance {
            let members = [
                ("elements", Some(own.elements as u64)),
                ("links", Some(own.links as u64)),
                ("bins", Some(own.bins as u64)),
                ("iterations", Some(u64::from(own.iterations))),
            ];
            group("antiradiance", &members);
        }
        group(
            "counts",
            &[
                ("frames", Some(self.frames)),
                ("relights", Some(self.relights)),
                ("lightsEvaluated", Some(self.lights_evaluated)),
                ("shadowLayers", Some(self.shadow_layers)),
                ("shadowSize", Some(self.shadow_size as u64)),
                ("blendedLayers", Some(self.blended_layers)),
                ("triangles", Some(self.triangles as u64)),
                ("links", Some(self.links as u64)),
                ("lights", Some(self.lights as u64)),
            ],
        );
        json.push('}');
        json
    }
}

/// Work counts of lookup or splatting in a picture's bounced light.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Counts {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Pixels with slots; other pixels are interpolated.
    pub rows: u64,
    /// Functions whose sphere was tested; for splatting, quads of the finest level.
    pub looked_at: u64,
    /// Kernels evaluated; unknown for splatting.
    pub evaluated: u64,
}

impl Counts {
    /// From the size of the picture and the bytes of
    /// [`Renderer::read_counts`](crate::renderer::Renderer::read_counts).
    pub fn new([width, height]: [u32; 2], counts: &[u8]) -> Self {
        let count = |i: usize| bytemuck::pod_read_unaligned::<u32>(&counts[4 * i..4 * i + 4]) as u64;
        let blocks = width.div_ceil(2) as u64 * height.div_ceil(2) as u64;
        Self {
            pixels: width as u64 * height as u64,
            rows: blocks + count(0),
            looked_at: count(1),
            evaluated: count(2),
        }
    }
}

/// Bytes on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Bytes {
    /// The file's bulk sections.
    pub scene: u64,
    /// Textures.
    pub textures: u64,
    /// Buffers of the relighting.
    pub relight: u64,
    /// Shadow maps.
    pub shadows: u64,
    /// Targets of the picture's size.
    pub picture: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_holds_every_number_and_leaves_out_what_is_not_known() {
        let stats = Stats {
            functions: vec![3, 40],
            links: 7,
            milliseconds: Milliseconds { find: Some(1.5), ..Milliseconds::default() },
            bytes: Bytes { picture: 5, ..Bytes::default() },
            ..Stats::default()
        };
        let json: serde_json::Value = serde_json::from_str(&stats.json()).unwrap();
        assert_eq!(json["functions"], serde_json::json!([3, 40]));
        assert_eq!(json["microseconds"], serde_json::json!({ "find": 1500 }));
        assert_eq!((&json["bytes"]["picture"], &json["counts"]["links"]), (&5.into(), &7.into()));
    }
}
