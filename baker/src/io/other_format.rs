//! Files of other formats, with advice for conversion to glTF.

use crate::scene::SceneError;
use std::path::Path;

/// Advice for formats that Blender opens.
const OPEN: &str = "open it in Blender and choose File > Export > glTF 2.0";
/// Advice for formats that Blender imports.
const IMPORT: &str = "in Blender choose File > Import, then File > Export > glTF 2.0";
/// Advice for all other formats.
const EXPORT: &str =
    "export it as glTF 2.0 from the program that made it, or as FBX or OBJ, which Blender makes into glTF";

/// Advice for CAD files that have solids.
const STEP: &str = "export it as STEP (AP214 or AP242) from the program that made it";

/// File extensions, description of the format, and advice for conversion to glTF.
const FORMATS: [(&[&str], &str, &str); 14] = [
    (&["blend"], "a Blender file", OPEN),
    (&["obj"], "a Wavefront OBJ file", IMPORT),
    (&["fbx"], "an FBX file", IMPORT),
    (&["dae"], "a COLLADA file", EXPORT),
    (&["stl"], "an STL file", IMPORT),
    (&["ply"], "a PLY file", IMPORT),
    (&["usd", "usda", "usdc", "usdz"], "a USD file", IMPORT),
    (&["abc"], "an Alembic file", IMPORT),
    (&["skp"], "a SketchUp file", EXPORT),
    (&["max", "3ds"], "a 3ds Max file", EXPORT),
    (&["ma", "mb", "c4d", "3dm"], "a file of a modelling program", EXPORT),
    (&["ifc", "rvt", "dwg", "dxf"], "a CAD file", EXPORT),
    (
        &["igs", "iges", "sat", "x_t", "x_b", "sldprt", "sldasm", "ipt", "iam", "catpart", "fcstd"],
        "a CAD file",
        STEP,
    ),
    (&["x3d", "wrl", "3mf"], "a file of another 3D format", EXPORT),
];

impl SceneError {
    /// Error for a file with the extension of another format; `None` for other extensions.
    pub fn other_format(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        let (_, format, advice) =
            FORMATS.into_iter().find(|(endings, ..)| endings.contains(&ending.as_str()))?;
        Some(Self::OtherFormat { file: path.display().to_string(), format, advice })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_with_a_way_to_gltf() {
        let said = |name: &str| SceneError::other_format(Path::new(name)).map(|error| error.to_string());
        let obj = said("a/Chair.OBJ").unwrap();
        assert!(obj.starts_with("a/Chair.OBJ is a Wavefront OBJ file") && obj.contains("Blender"), "{obj}");
        assert!(said("house.skp").unwrap().contains("export it as glTF 2.0"));
        for name in ["room.glb", "room.gltf", "room.rbn", "room", ".obj"] {
            assert_eq!(said(name), None, "{name}");
        }
    }
}
