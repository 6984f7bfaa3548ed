use super::*;
use crate::scene::triangles::tests::two_sided;

const MIDDLE: [f64; 2] = [320.0, 240.0];
const ASIDE: [f64; 2] = [100.0, 100.0];

/// A light at the middle of the picture, and no triangles.
pub fn stage() -> Stage {
    Stage {
        camera: Camera { position: [0.0, 0.0, 5.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 },
        lights: vec![Light::Point { position: [0.0; 3], intensity: 1.0, color: [1.0; 3], radius: 0.0 }],
        #[cfg(feature = "radiosity")]
        nodes: Vec::new(),
        handles: true,
        size: [640, 480],
        extent: 10.0,
        origin: [0.0; 3],
        clearance: 0.2,
        triangles: Rc::default(),
    }
}

/// Controls of a stage between four walls, 12 wide.
fn room() -> Stage {
    let corners = [(-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0), (-6.0, -6.0)];
    let walls: Vec<_> = corners
        .windows(2)
        .flat_map(|pair| {
            let [a, b] = [pair[0], pair[1]].map(|(x, z)| Vec3::new(x, -1.5, z));
            let [c, d] = [a, b].map(|p| p + Vec3::Y * 3.0);
            [[a, b, c], [b, d, c]]
        })
        .collect();
    Stage { triangles: two_sided(&walls).into(), ..stage() }
}

/// Presses the pointer at `at` and moves it to the right by `by`; returns the controls.
fn press(s: &mut Stage, at: [f64; 2], button: PointerButton, by: f64) -> Controls {
    let mut controls = Controls::default();
    controls.pointer_down(1, at, button, 0.0, s);
    controls.pointer_move(1, [at[0] + by, at[1]], false, false, s);
    controls
}

fn height_and_place(s: &Stage) -> (f64, DVec3) {
    (s.camera.position[1], DVec3::from(s.camera.position))
}

#[test]
fn a_press_on_a_handle_moves_the_light_and_not_the_camera() {
    let mut s = stage();
    let mut controls = press(&mut s, MIDDLE, PointerButton::Turn, 30.0);
    assert_eq!(s.camera, stage().camera);
    assert_ne!(s.lights, stage().lights);
    controls.pointer_up(1, true);
    controls.pointer_move(1, [450.0, 240.0], false, false, &mut s);
    assert_eq!(s.camera, stage().camera);
}

#[test]
fn a_press_elsewhere_or_with_hidden_handles_orbits() {
    for (at, handles) in [(ASIDE, true), (MIDDLE, false)] {
        let mut s = Stage { handles, ..stage() };
        press(&mut s, at, PointerButton::Turn, 30.0);
        assert_eq!(s.lights, stage().lights);
        assert_ne!(s.camera.position, stage().camera.position);
        assert_eq!(s.camera.target, stage().camera.target);
    }
}

#[test]
fn inside_a_drag_looks_around_and_a_page_may_have_it_otherwise() {
    let mut s = room();
    press(&mut s, ASIDE, PointerButton::Turn, 30.0);
    assert_eq!(s.camera.position, stage().camera.position);
    // The picture is grabbed: its middle moves to the right.
    assert!(s.camera.target[0] < -0.1, "{:?}", s.camera.target);
    for (looks, mut s) in [(false, room()), (true, stage())] {
        let mut controls = Controls { looks: Some(looks), ..Controls::default() };
        controls.pointer_down(1, ASIDE, PointerButton::Turn, 0.0, &s);
        controls.pointer_move(1, [200.0, 100.0], false, false, &mut s);
        assert_eq!(s.camera.position == stage().camera.position, looks);
    }
}

#[test]
fn what_is_under_the_pointer_stays_there_while_one_looks_around() {
    for (by, yfov_deg) in
        [([90.0, 0.0], 60.0), ([0.0, -70.0], 60.0), ([200.0, 0.0], 25.0), ([60.0, 50.0], 90.0)]
    {
        let mut s = room();
        s.camera.yfov_deg = yfov_deg;
        let at = [0, 1].map(|i| MIDDLE[i] - 0.4 * by[i]);
        let place = DVec3::from(s.surface_at(at).unwrap());
        let mut controls = Controls::default();
        controls.pointer_down(1, at, PointerButton::Look, 0.0, &s);
        let to = [0, 1].map(|i| at[i] + by[i]);
        controls.pointer_move(1, to, false, false, &mut s);
        let there = DVec3::from(s.surface_at(to).unwrap());
        assert!(place.distance(there) < 0.3, "{by:?}: {place} and {there}");
    }
}

#[test]
fn a_held_pointer_keeps_what_it_does_and_the_next_one_looks_anew() {
    let mut s = room();
    let mut controls = press(&mut s, ASIDE, PointerButton::Turn, 30.0);
    s.camera.position[2] = 40.0;
    controls.advance(0.0, &mut s);
    assert!(controls.is_inside());
    controls.pointer_up(1, true);
    controls.advance(0.0, &mut s);
    assert!(!controls.is_inside());
}

#[test]
fn inside_wheel_pinch_and_keys_walk_and_walls_stop_them() {
    let mut s = room();
    s.camera.target[1] = -3.0;
    let mut controls = Controls::default();
    controls.advance(0.0, &mut s);
    controls.wheel(-400.0, &mut s);
    let (height, wheeled) = height_and_place(&s);
    assert!(height == 0.0 && (wheeled.z - (5.0 - 400.0 * WHEEL * 10.0)).abs() < 1e-5, "{wheeled}");
    controls.pointer_down(1, ASIDE, PointerButton::Turn, 0.0, &s);
    controls.pointer_down(2, [200.0, 100.0], PointerButton::Turn, 0.0, &s);
    controls.pointer_move(2, [300.0, 100.0], false, false, &mut s);
    let (height, pinched) = height_and_place(&s);
    assert!(height == 0.0 && (wheeled.z - pinched.z - PINCH * 10.0 * 2f64.ln()).abs() < 1e-5, "{pinched}");
    controls.reset();
    controls.key("KeyW", true, &mut s);
    for i in 0..300 {
        controls.advance(100.0 * i as f64, &mut s);
    }
    let (height, walked) = height_and_place(&s);
    assert!(height == 0.0 && (walked.z + 5.8).abs() < 0.01, "{walked}");
}

#[test]
fn two_pointers_pinch() {
    let (mut controls, mut s) = (Controls::default(), stage());
    controls.pointer_down(1, ASIDE, PointerButton::Turn, 0.0, &s);
    controls.pointer_down(2, [200.0, 100.0], PointerButton::Turn, 0.0, &s);
    controls.pointer_move(2, [300.0, 100.0], false, false, &mut s);
    assert!((s.camera.position[2] - 2.5).abs() < 1e-9, "twice the distance: half as far");
}

#[test]
fn outside_nothing_brings_the_camera_into_an_object() {
    let at = |x: f32, y: f32| Vec3::new(x, y, 1.0);
    let front = two_sided(&[[at(-3.0, -3.0), at(9.0, -3.0), at(-3.0, 9.0)]]);
    let mut s = Stage { triangles: front.into(), ..stage() };
    let mut controls = Controls::default();
    for _ in 0..100 {
        controls.wheel(-300.0, &mut s);
    }
    assert!((s.camera.position[2] - 1.2).abs() < 0.01, "{:?}", s.camera);
    // Orbiting around the object's corner, the camera stays in front, too.
    controls.pointer_down(1, ASIDE, PointerButton::Turn, 0.0, &s);
    for i in 0..60 {
        controls.pointer_move(1, [100.0 + 5.0 * i as f64, 100.0], false, false, &mut s);
        assert!(s.camera.position[2] > 1.19, "{:?}", s.camera);
    }
}

#[test]
fn escape_puts_back_what_was_dragged_and_nothing_else() {
    for (at, button) in
        [(MIDDLE, PointerButton::Turn), (ASIDE, PointerButton::Turn), (ASIDE, PointerButton::Pan)]
    {
        for mut s in [stage(), room()] {
            let mut controls = press(&mut s, at, button, 50.0);
            assert!(s.lights != stage().lights || s.camera != stage().camera);
            assert!(controls.key("Escape", true, &mut s));
            assert!(s.lights == stage().lights && s.camera == stage().camera);
            controls.pointer_move(1, [10.0, 10.0], false, false, &mut s);
            assert!(s.lights == stage().lights && s.camera == stage().camera, "the pointer is let go");
            assert!(!controls.key("Escape", true, &mut s), "nothing is held: the key is the page's");
        }
    }
}

#[test]
fn a_click_chooses_and_one_beside_does_not_but_a_drag_leaves_it() {
    let mut s = stage();
    let mut controls = press(&mut s, MIDDLE, PointerButton::Turn, 0.0);
    controls.pointer_up(1, true);
    assert_eq!(controls.marks().selected, Some(0));
    let mut at_aside = |by: f64, button, click| {
        controls.pointer_down(1, ASIDE, button, 0.0, &s);
        controls.pointer_move(1, [100.0 + by, 100.0], false, false, &mut s);
        controls.pointer_up(1, click);
        controls.marks().selected
    };
    assert_eq!(at_aside(40.0, PointerButton::Turn, true), Some(0), "a drag");
    assert_eq!(at_aside(0.0, PointerButton::Look, true), Some(0), "another button");
    assert_eq!(at_aside(0.0, PointerButton::Turn, false), Some(0), "taken away by the browser");
    assert_eq!(at_aside(1.0, PointerButton::Turn, true), None, "a click");
}

#[test]
fn a_pointer_marks_the_handle_that_it_is_over() {
    let (mut controls, mut s) = (Controls::default(), stage());
    controls.pointer_move(1, MIDDLE, false, false, &mut s);
    assert_eq!(controls.marks().hovered, Some(Handle { light: 0, aim: false }));
    controls.pointer_move(1, ASIDE, false, false, &mut s);
    assert_eq!(controls.marks().hovered, None);
    controls.hover(Some(0));
    assert_eq!(controls.marks().hovered, Some(Handle { light: 0, aim: false }));
    s.handles = false;
    controls.pointer_move(1, MIDDLE, false, false, &mut s);
    assert_eq!(controls.marks().hovered, None);
}

#[test]
fn the_wheel_takes_a_held_light_farther_and_leaves_the_camera() {
    let mut s = stage();
    let mut controls = press(&mut s, MIDDLE, PointerButton::Turn, 0.0);
    controls.wheel(-300.0, &mut s);
    let Light::Point { position, .. } = s.lights[0] else { panic!() };
    assert!((position[2] - (5.0 - 5.0 * 0.3f64.exp())).abs() < 1e-4, "{position:?}");
    assert_eq!(s.camera, stage().camera);
}

#[test]
fn wheel_survives_nonsense() {
    let (mut controls, mut s) = (Controls::default(), stage());
    controls.wheel(f64::NAN, &mut s);
    assert_eq!(s.camera, stage().camera);
    controls.wheel(1e300, &mut s);
    assert!(s.camera.position.iter().all(|x| x.is_finite()));
}
