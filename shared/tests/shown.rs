//! Section SHOW: names of lights and cameras, and the ground under an object.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::Meta;
use rebounce_shared::rbn::shown::{Ground, SIDE, Shown};
use rebounce_shared::rbn::{SHOWN_SECTION, container};

/// Nothing but two cameras and a lamp.
fn scene(shown: Shown) -> BakedScene {
    let camera = Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 50.0 };
    let lights = vec![Light::Point { position: [0.0; 3], intensity: 1.0, color: [1.0; 3], radius: 0.0 }];
    BakedScene {
        meta: Meta { cameras: vec![camera; 2], lights, shown, ..Meta::default() },
        ..BakedScene::default()
    }
}

fn ground() -> Ground {
    let shade = (0..SIDE * SIDE).map(|i| i as u8).collect();
    Ground { height: -1.5, low: [-2.0, -3.0], high: [4.0, 5.0], shade }
}

fn some() -> Shown {
    Shown::new(["Stehlampe, groß", "", "Do\0or"].into_iter(), Some(&ground()))
}

#[test]
fn names_and_ground_come_back_and_ask_for_no_newer_version() {
    let (without, with) = (scene(Shown::default()), scene(some()));
    let (before, now) = (without.to_bytes().unwrap(), with.to_bytes().unwrap());
    assert_eq!(container::version(&before), container::version(&now));
    let read = BakedScene::from_bytes(&now).unwrap();
    assert_eq!(read.meta.shown, some());
    assert_eq!(read.meta.shown.names().collect::<Vec<_>>(), ["Stehlampe, groß", "", "Door"]);
    assert_eq!(read.meta.shown.ground(), Some(ground()));
    assert_eq!(read.to_bytes().unwrap(), now);
    // Files without names and ground have no such section.
    let has = |bytes: &[u8]| container::read(bytes).unwrap().iter().any(|s| s.name == SHOWN_SECTION);
    assert!(!has(&before) && has(&now));
    assert_eq!(BakedScene::from_bytes(&before).unwrap().meta, without.meta);
}

#[test]
fn unnamed_lights_and_cameras_have_no_names_at_all() {
    let shown = Shown::new(["", "", ""].into_iter(), None);
    assert_eq!((shown.names().count(), shown.ground()), (0, None));
    assert_eq!(shown, Shown::default());
}

#[test]
fn what_cannot_be_is_refused() {
    type Break = fn(&mut Shown);
    fn change(shown: &mut Shown, change: fn(&mut Ground)) {
        let mut ground = shown.ground().unwrap();
        change(&mut ground);
        shown.ground = ground.to_bytes();
    }
    let breaks: [Break; 7] = [
        |s| s.names.push('\0'),
        |s| s.names.truncate(s.names.len() - 1),
        |s| s.names.push('x'),
        |s| change(s, |ground| ground.height = f32::NAN),
        |s| change(s, |ground| ground.high[0] = -2.0),
        |s| change(s, |ground| ground.low[1] = 1e20),
        |s| change(s, |ground| ground.shade.truncate(9)),
    ];
    for (i, damage) in breaks.into_iter().enumerate() {
        let mut shown = some();
        damage(&mut shown);
        let error = scene(shown).to_bytes().expect_err("refused").to_string();
        assert!(error.contains("SHOW"), "{i}: {error}");
    }
    // Wrong lengths.
    let bytes = scene(some()).to_bytes().unwrap();
    let sections = container::read(&bytes).unwrap();
    for change in [-1isize, 1] {
        let parts: Vec<([u8; 4], Vec<u8>)> = sections
            .iter()
            .map(|s| {
                let mut part = bytes[s.offset..s.offset + s.len].to_vec();
                if s.name == SHOWN_SECTION {
                    part.resize((s.len as isize + change) as usize, 0);
                }
                (s.name, part)
            })
            .collect();
        let parts: Vec<_> = parts.iter().map(|(name, part)| (*name, part.as_slice())).collect();
        let error = BakedScene::from_bytes(&container::write(container::VERSION, &parts)).unwrap_err();
        assert!(error.to_string().contains("SHOW"), "{error}");
    }
}
