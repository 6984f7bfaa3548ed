//! What the subcommands that read a scene print about it.

use rebounce::scene::Scene;
use rebounce_args::escape::escape_controls;
use rebounce_args::load::warnings;

/// Prints a sentence about what is worth knowing.
pub fn note(sentence: &str) {
    eprintln!("note: {}", escape_controls(sentence));
}

/// Prints warnings about omissions and changes made while loading a scene's file.
pub fn warn(scene: &Scene) {
    for sentence in warnings(scene) {
        eprintln!("warning: {}", escape_controls(&sentence));
    }
}
