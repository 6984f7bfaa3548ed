//! Glossy links in files and in pictures: sections, rules, and what arrives.

use crate::rules::scene;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::gloss::GlossyField;
use rebounce_shared::harmonics::COUNT;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rbn::gloss::{Gloss, NO_MATRIX};
use rebounce_shared::rbn::gloss_links::GlossLink;
use rebounce_shared::rbn::sources::{EmissiveGroup, Sources};
use rebounce_shared::rbn::{GLOSS_LINK_SECTIONS, GLOSS_SECTIONS, LinkMatrix, container};
use std::f32::consts::{PI, TAU};

/// A link over the first point.
pub fn link(sender: u32, amount: f32) -> GlossLink {
    GlossLink::pack(sender, Vec3::new(0.3, -0.2, 0.9), amount, 0.9)
}

/// The scene with an emissive group and a row of links at its coarse point.
pub fn glossy(row: Vec<GlossLink>) -> BakedScene {
    let mut scene = scene();
    let group = EmissiveGroup { name: "lamp".into(), materials: vec![0], step: [1.0; 3], is_coloured: false };
    scene.sources = Sources { groups: vec![group], ..Sources::default() };
    scene.source_links = LinkMatrix::from_rows(&[vec![], vec![]]);
    scene.gloss = Gloss {
        points: vec![0, 1],
        clusters: vec![NO_MATRIX; 2],
        links: LinkMatrix::from_rows(&[row]),
        ..Gloss::default()
    };
    scene.gloss.layout.emission = vec![[4.0, 2.0, 1.0]];
    scene
}

fn lit(emission: f32) -> Lighting {
    Lighting { emission: vec![Vec3::splat(emission)], ..Lighting::default() }
}

#[test]
fn glossy_links_have_sections_of_their_own() {
    let scene = glossy(vec![link(0, 0.5), link(2, 0.25), link(2, 0.125)]);
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
    let sections = container::read(&bytes).unwrap();
    let named: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
    for name in GLOSS_LINK_SECTIONS.into_iter().chain(GLOSS_SECTIONS) {
        assert!(named.iter().any(|part| part.0 == name));
        let rest: Vec<_> = named.iter().filter(|part| part.0 != name).copied().collect();
        let error = BakedScene::from_bytes(&container::write(scene.version(), &rest)).expect_err("refused");
        assert!(error.to_string().contains(&*String::from_utf8_lossy(&name)), "{error}");
    }
    let mut without = scene.clone();
    without.gloss.links = LinkMatrix::default();
    without.gloss.layout.emission.clear();
    let without = without.to_bytes().unwrap();
    let sections = container::read(&without).unwrap();
    assert!(sections.iter().all(|s| !GLOSS_LINK_SECTIONS.contains(&s.name)));
}

#[test]
fn glossy_links_that_do_not_fit_are_refused() {
    type Break = fn(&mut BakedScene);
    let breaks: [(&str, Break); 12] = [
        // A point that sends nothing, and a group that is not there.
        ("GLLK", |s| s.gloss.links.links[0].sender = 1),
        ("GLLK", |s| s.gloss.links.links[1].sender = 3),
        ("GLLK", |s| s.gloss.links.links[0].sender = u32::MAX),
        ("GLLK", |s| s.gloss.links.links.swap(0, 1)),
        ("GLLO", |s| s.gloss.links.offsets.clear()),
        ("GLLO", |s| s.gloss.links.offsets[0] = 1),
        ("GLLO", |s| s.gloss.links.offsets[1] = 3),
        ("GLLO", |s| s.gloss.links.offsets = vec![0, 2, 1, 2]),
        ("GLLO", |s| s.gloss.links.offsets = vec![0, 1, 1, 2]),
        ("GLSY", |s| s.gloss.layout.emission.push([1.0; 3])),
        ("GLSY", |s| s.gloss.layout.emission[0][1] = -1.0),
        ("GLSY", |s| s.gloss.layout.emission[0][1] = f32::NAN),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = glossy(vec![link(0, 0.5), link(2, 0.25)]);
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}

#[test]
fn arriving_light_is_linear_in_what_senders_send_and_in_emission() {
    let scene = glossy(vec![link(0, 0.5), link(2, 0.25)]);
    let (red, blue) = ([Vec3::new(3.0, 1.0, 0.5)], [Vec3::new(0.1, 0.2, 4.0)]);
    let sum = [2.0 * red[0] + 3.0 * blue[0]];
    let field = |emission, sent: &[Vec3]| *GlossyField::new(&scene, &lit(emission), sent).at(0).unwrap();
    let (a, b, both) = (field(1.0, &red), field(0.5, &blue), field(3.5, &sum));
    for i in 0..COUNT {
        let expected = 2.0 * a[i] + 3.0 * b[i];
        assert!((both[i] - expected).abs().max_element() < 1e-4, "{i}: {} is not {expected}", both[i]);
        assert_eq!(both[i].w, 0.0, "no environment is seen");
    }
    // Senders beyond the end are dark.
    assert_eq!(field(0.0, &[]), rebounce_shared::gloss::DARK);
}

#[test]
fn a_hemisphere_of_links_from_even_senders_is_even_light() {
    const N: u32 = 4096;
    let all = (0..N).map(|k| {
        let z = 1.0 - (k as f32 + 0.5) / N as f32;
        let angle = TAU * (f64::from(k) * 0.618_033_988_749_895).fract() as f32;
        let r = (1.0 - z * z).sqrt();
        GlossLink::pack(0, Vec3::new(r * angle.cos(), r * angle.sin(), z), TAU / N as f32, 1.0)
    });
    let row: Vec<_> = all.collect();
    let amount = row[0].amount() * N as f32 / TAU;
    let scene = glossy(row);
    let field = GlossyField::new(&scene, &lit(0.0), &[Vec3::splat(1.0 / amount)]);
    // The second point has no links: it has what its parent has.
    for point in [0, 1] {
        let arriving = field.at(point).unwrap();
        for (i, c) in arriving.iter().enumerate() {
            let expected = if i == 0 { (4.0 * PI).sqrt() } else { 0.0 };
            assert!((c.x - expected).abs() < 0.02, "{i}: {c}");
        }
    }
}
