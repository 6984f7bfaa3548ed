//! Why a scene could not be loaded.

/// Why a scene could not be loaded. Every sentence names the file and says what to do.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file could not be read.
    #[error("cannot read {path}: {source}; check the path and the permissions")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file that the scene refers to could not be read.
    #[error("{file} refers to {path}, which cannot be read: {source}; keep them together or export one .glb")]
    Beside {
        /// The scene's file.
        file: String,
        /// The file referred to.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not glTF 2.0.
    #[error("{file} is not a glTF 2.0 file: {problem}; export the scene as .glb or .gltf (glTF 2.0)")]
    NotGltf {
        /// The file.
        file: String,
        /// What was found instead.
        problem: String,
    },
    /// The file is of an older glTF.
    #[error(
        "{file} is glTF {version}, and what is read is glTF 2.0: convert it, as `npx gltf-pipeline -i OLD.gltf -o NEW.glb` \
         does, or export the scene again"
    )]
    Old {
        /// The file.
        file: String,
        /// Its version.
        version: String,
    },
    /// The file is what a bake made.
    #[error(
        "{file} is a baked file, not a scene: `rebounce view {file}` shows it; to bake again, give the .glb or .gltf that it was baked from"
    )]
    Baked {
        /// The file.
        file: String,
    },
    /// The file is of another format.
    #[error("{file} is {format}, and what is read is glTF 2.0 (.glb or .gltf): {advice}")]
    OtherFormat {
        /// The file.
        file: String,
        /// What it is.
        format: &'static str,
        /// How it becomes glTF.
        advice: &'static str,
    },
    /// The file breaks a rule of glTF.
    #[error("{file}: {problem}; the file is damaged or was written wrongly: export it again")]
    Malformed {
        /// The file.
        file: String,
        /// What is wrong and where.
        problem: String,
    },
    /// The file has no such scene.
    #[error("{file} has no scene `{wanted}`: {advice}")]
    NoScene {
        /// The file.
        file: String,
        /// The scene asked for.
        wanted: String,
        /// What to give instead.
        advice: String,
    },
    /// The default scene is empty and several others are not.
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
    /// The file needs extensions that this program does not know.
    #[error("{file} requires glTF extensions that are not supported; {advice}")]
    Extension {
        /// The file.
        file: String,
        /// The extensions' names.
        extensions: Vec<String>,
        /// What to do instead, each by its name.
        advice: String,
    },
    /// A texture cannot be used.
    #[error("{file}: texture {texture}: {problem}")]
    Texture {
        /// The file.
        file: String,
        /// Name or number of the texture.
        texture: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// There is nothing to light.
    #[error("{file} has no triangles in its scene; export the meshes too, as triangles")]
    Empty {
        /// The file.
        file: String,
    },
    /// More than any machine could bake.
    #[error("{file} has too many {what} ({count}); the limit is {limit}: simplify the scene")]
    TooLarge {
        /// The file.
        file: String,
        /// Vertices, triangles or copies.
        what: &'static str,
        /// How many were found.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// More materials than pictures tell apart.
    #[error(
        "{file} has {count} different materials; the limit is {limit} (the first one beyond is {name:?}): give objects \
         that look alike one material, or put their colours into a texture"
    )]
    TooManyMaterials {
        /// The file.
        file: String,
        /// How many there are, equal ones counted once.
        count: usize,
        /// How many there may be.
        limit: usize,
        /// The name of the first one beyond the limit.
        name: String,
    },
    /// No such built-in scene.
    #[error("there is no built-in scene `{name}`; the built-in scenes are {known}")]
    UnknownBuiltin {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
}
