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

#[test]
fn antiradiance_has_the_same_file_at_any_number_of_threads_and_takes_its_options() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let solve = |out: &str, more: &[&str]| {
        let few = ["--solver", "antiradiance", "--bins", "64", "--elements", "400", "--functions", "600"];
        let report = format!("{out}.json");
        done(
            at,
            &[&["solve", "builtin:cornell-box", "-o", out, "--report", &report], &few[..], more].concat(),
        );
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(at.join(report)).unwrap()).unwrap();
        (std::fs::read(at.join(out)).unwrap(), report["antiradiance"].clone())
    };
    let (one, figures) = solve("one.rbn", &["--threads", "1"]);
    let (two, _) = solve("two.rbn", &["--threads", "2"]);
    assert!(one == two, "the file depends on the number of threads");
    let [bins, patches, elements, links] =
        ["bins", "patches", "elements", "links"].map(|name| figures[name].as_u64().unwrap());
    assert!(bins == 64 && patches > 200 && elements > patches && links > elements, "{figures}");
    // Other ways to the light: each differs from all, and takes the steps that it is given.
    let steps = ["--iterations", "3", "--change", "0"];
    let mut found = Vec::new();
    for more in [
        &["--iteration", "ordered"][..],
        &["--iteration", "symmetric"],
        &["--iteration", "symmetric", "--spreading", "gaussian"],
        &["--iteration", "asymmetric", "--antiradiance-steps", "2"],
        &["--link-width", "1"],
    ] {
        let (other, figures) = solve("other.rbn", &[&steps[..], more].concat());
        assert_eq!(figures["iterations"].as_u64(), Some(3), "{more:?}");
        assert!(!found.contains(&other), "{more:?} changes nothing");
        found.push(other);
    }
    let refused = rebounce(
        at,
        &[
            "solve",
            "builtin:cornell-box",
            "-o",
            "no.rbn",
            "--solver",
            "antiradiance",
            "--spreading",
            "gaussian",
        ],
    );
    assert_eq!(refused.status.code(), Some(1));
    assert!(said(&refused).contains("--iteration symmetric") && !at.join("no.rbn").exists());
}
