//! `rebounce solve`: files whose lights stay in place, and pictures of them.

use crate::common::program::{done, rebounce, said};

const SHOT: &str = r#"{"size":[32,18],"camera":{"position":[0,0,0.8],"target":[0,0,-1],"yfov_deg":70},
    "lights":[{"type":"point","name":"Blue","position":[0.2,0.4,0.1],"intensity":4,"color":[0.2,0.4,1]}]}"#;

#[test]
fn a_solved_file_is_listed_mixed_and_refuses_a_lamp_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let write = |name: &str, text: String| std::fs::write(at.join(name), text).unwrap();
    write("shot.json", SHOT.into());
    write("dim.json", SHOT.replace("\"intensity\":4", "\"intensity\":2"));
    write("moved.json", SHOT.replace("0.2,0.4,0.1", "0.2,0.3,0.1"));
    let solve = ["solve", "builtin:furnace", "-o", "f.rbn", "--shot", "shot.json"];
    let told =
        done(at, &[&solve[..], &["--preset", "draft", "--functions", "2K", "--report", "f.json"]].concat());
    assert!(told.contains("gathered to") && told.contains("1 of light"), "{told}");
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(at.join("f.json")).unwrap()).unwrap();
    assert!(report["samples_gathered"].as_u64() <= report["samples_generated"].as_u64());
    assert!(report["visibility_rays"].as_u64() > Some(0) && report["file_bytes"].as_u64() > Some(0));
    assert!(done(at, &["info", "f.rbn"]).contains("1, in their places: point \"Blue\""));
    let picture = |shot: &str, out: &str| {
        done(at, &["render", "f.rbn", "--shot", shot, "--only", "indirect", "--spp", "4", "-o", out]);
        rebounce::io::picture::exr::read(&at.join(out)).unwrap()
    };
    let (full, dim) = (picture("shot.json", "full.exr"), picture("dim.json", "dim.exr"));
    let mut brightest = 0f32;
    for (full, dim) in full.pixels.iter().zip(&dim.pixels) {
        brightest = brightest.max(full.z);
        assert!((*full - 2.0 * *dim).abs().max_element() <= 2e-3 * full.max_element(), "{full}, {dim}");
    }
    assert!(brightest > 0.0);
    let moved = rebounce(at, &["render", "f.rbn", "--shot", "moved.json", "-o", "moved.png"]);
    assert_eq!(moved.status.code(), Some(1));
    for word in ["f.rbn", "light 0", "rebounce bake"] {
        assert!(said(&moved).contains(word), "no {word}: {}", said(&moved));
    }
    assert!(!at.join("moved.png").exists());
}
