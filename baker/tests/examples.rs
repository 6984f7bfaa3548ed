//! The examples run, and what they show is right.

#[path = "../examples/bake_and_save.rs"]
mod bake_and_save;
#[path = "../examples/implicit.rs"]
mod implicit;
#[path = "../examples/one_bounce.rs"]
mod one_bounce;
#[path = "../examples/relight.rs"]
mod relight;

use rebounce::prelude::*;

fn small() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (3, 800);
    settings
}

#[test]
fn a_build_script_bakes_and_saves() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("room.rbn");
    bake_and_save::run("builtin:cornell-box", &output, &small()).unwrap();
    let baked = BakedScene::from_bytes(&std::fs::read(&output).unwrap()).unwrap();
    assert!(baked.link_count() > 0);
}

#[test]
fn a_solver_outside_the_crate_gives_the_light_of_ours() {
    one_bounce::run(None).unwrap();
}

#[test]
fn a_surface_outside_the_crate_is_lit_as_a_path_tracer_lights_it() {
    let error = implicit::run(None).unwrap();
    assert!(error <= 0.05, "{error}");
}

#[test]
fn light_follows_a_lamp_without_a_new_bake() {
    let means = relight::run(None, 3, [48, 48]).unwrap();
    assert!(means.iter().all(|mean| *mean > 0.0), "{means:?}");
    assert!(means[0] != means[1] && means[1] != means[2], "{means:?}");
}
