//! Errors of loading a scene.

/// Reason for a failure to load a scene. Every message has the file's name and advice.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file could not be read.
    #[error("cannot read {path}: {source}; check the path and the permissions")]
    Read {
        /// The file.
        path: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A file that the scene refers to could not be read.
    #[error("{file} refers to {path}, which cannot be read: {source}; keep them together or export one .glb")]
    Beside {
        /// The scene's file.
        file: String,
        /// The file referred to.
        path: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not glTF 2.0.
    #[error("{file} is not a glTF 2.0 file: {problem}; export the scene as .glb or .gltf (glTF 2.0)")]
    NotGltf {
        /// The file.
        file: String,
        /// Contents found instead of glTF 2.0.
        problem: String,
    },
    /// The file is of an older version of glTF.
    #[error(
        "{file} is glTF {version}, and what is read is glTF 2.0: convert it, as `npx gltf-pipeline -i OLD.gltf -o NEW.glb` \
         does, or export the scene again"
    )]
    Old {
        /// The file.
        file: String,
        /// glTF version of the file.
        version: String,
    },
    /// The file is a baked file.
    #[error(
        "{file} is a baked file, not a scene: `rebounce view {file}` shows it; to bake again, give the .glb or .gltf that it was baked from"
    )]
    Baked {
        /// The file.
        file: String,
    },
    /// The STEP file cannot be read.
    #[error("{file}: {problem}")]
    Step {
        /// The file.
        file: String,
        /// Problem and advice.
        problem: String,
    },
    /// The file has no looks of materials.
    #[error("{file} has no looks of materials: {problem}; see docs/guide/step.md for the format")]
    Looks {
        /// The file.
        file: String,
        /// The problem.
        problem: String,
    },
    /// The file is of another format.
    #[error(
        "{file} is {format}, and what is read is glTF 2.0 (.glb or .gltf) and STEP (.step or .stp): {advice}"
    )]
    OtherFormat {
        /// The file.
        file: String,
        /// Description of the format.
        format: &'static str,
        /// Advice for conversion to glTF.
        advice: &'static str,
    },
    /// The file breaks a rule of glTF.
    #[error("{file}: {problem}; the file is damaged or was written wrongly: export it again")]
    Malformed {
        /// The file.
        file: String,
        /// Problem and place in the file.
        problem: String,
    },
    /// The scene asked for is not in the file.
    #[error("{file} has no scene `{wanted}`: {advice}")]
    NoScene {
        /// The file.
        file: String,
        /// The scene asked for.
        wanted: String,
        /// Advice for the choice of a scene.
        advice: String,
    },
    /// The animation asked for is not in the file.
    #[error("{file} has no animation `{wanted}`: {advice}")]
    NoAnimation {
        /// The file.
        file: String,
        /// The animation asked for, empty for any.
        wanted: String,
        /// Advice for the choice of an animation.
        advice: String,
    },
    /// The default scene is empty and several other scenes are not.
    #[error(
        "{file}: {scene}, its default, has no mesh, and others have: give --scene one of them; they are {known}"
    )]
    EmptyScene {
        /// The file.
        file: String,
        /// The default scene.
        scene: String,
        /// The scenes with meshes.
        known: String,
    },
    /// The file requires extensions that are unknown to this program.
    #[error("{file} requires glTF extensions that are not supported; {advice}")]
    Extension {
        /// The file.
        file: String,
        /// The extensions' names.
        extensions: Vec<String>,
        /// Advice for each extension, by name.
        advice: String,
    },
    /// A texture cannot be used.
    #[error("{file}: texture {texture}: {problem}")]
    Texture {
        /// The file.
        file: String,
        /// Name or number of the texture.
        texture: String,
        /// Problem and advice.
        problem: String,
    },
    /// The scene has no triangles.
    #[error("{file} has no triangles in its scene; export the meshes too, as triangles")]
    Empty {
        /// The file.
        file: String,
    },
    /// The scene exceeds the limits of a bake.
    #[error("{file} has too many {what} ({count}); the limit is {limit}: simplify the scene")]
    TooLarge {
        /// The file.
        file: String,
        /// Vertices, triangles or copies.
        what: &'static str,
        /// Number found.
        count: usize,
        /// Maximum number.
        limit: usize,
    },
    /// The scene has more materials than pictures can distinguish.
    #[error(
        "{file} has {count} different materials; the limit is {limit} (the first one beyond is {name:?}): give objects \
         that look alike one material, or put their colours into a texture"
    )]
    TooManyMaterials {
        /// The file.
        file: String,
        /// Number of different materials.
        count: usize,
        /// Maximum number.
        limit: usize,
        /// Name of the first material beyond the limit.
        name: String,
    },
    /// This build of the library has no loader for the scene.
    #[error("{what} cannot be loaded: the crate is built without its feature `{feature}`; add the feature")]
    WithoutFeature {
        /// The scene asked for.
        what: String,
        /// Name of the missing feature.
        feature: &'static str,
    },
    /// The built-in scene does not exist.
    #[error("there is no built-in scene `{name}`; the built-in scenes are {known}")]
    UnknownBuiltin {
        /// The name asked for.
        name: String,
        /// Names of the built-in scenes.
        known: String,
    },
}
