//! Walking and flying with keys (W A S D, Q E, arrows; shift for faster) and with the on-screen stick.

use super::collide::{self, Motion};
use super::{Stage, orbit};

/// Scene diagonals a second.
const SPEED: f64 = 0.12;
/// Radians a second.
const TURN: f64 = 1.5;
/// Maximum time step, seconds: no jump after a pause.
const LONGEST: f64 = 0.1;

/// Key codes; the index of a key is its bit number.
const KEYS: [&str; 12] = [
    "KeyW",
    "KeyA",
    "KeyS",
    "KeyD",
    "KeyQ",
    "KeyE",
    "ArrowUp",
    "ArrowDown",
    "ArrowLeft",
    "ArrowRight",
    "ShiftLeft",
    "ShiftRight",
];
const W: u32 = 0;
const A: u32 = 1;
const S: u32 = 2;
const D: u32 = 3;
const Q: u32 = 4;
const E: u32 = 5;
const UP: u32 = 6;
const DOWN: u32 = 7;
const LEFT: u32 = 8;
const RIGHT: u32 = 9;
/// The bits of both shift keys.
const SHIFT: u32 = 0b11 << 10;

/// State of keys and stick, and the time of the last move.
#[derive(Debug, Default)]
pub struct Fly {
    /// Bit mask of the keys that are down.
    down: u32,
    /// To the right and ahead, -1 to 1.
    stick: [f64; 2],
    last_ms: Option<f64>,
}

impl Fly {
    /// A key (`KeyboardEvent.code`) goes down or up; true if the key moves the camera.
    pub fn key(&mut self, code: &str, down: bool) -> bool {
        let Some(key) = KEYS.iter().position(|&k| k == code) else { return false };
        let bit = 1 << key;
        self.down = if down { self.down | bit } else { self.down & !bit };
        bit & SHIFT == 0
    }

    /// Releases all keys and the stick.
    pub fn release(&mut self) {
        self.down = 0;
        self.stick = [0.0; 2];
    }

    /// Sets the stick: right and ahead, -1 to 1; zeros when released.
    pub fn stick(&mut self, to: [f64; 2]) {
        self.stick = to.map(|x| x.clamp(-1.0, 1.0));
    }

    /// True while a key or the stick moves the camera.
    pub fn moving(&self) -> bool {
        self.stick != [0.0; 2] || self.down & !SHIFT != 0
    }

    /// Moves the camera to time `now_ms`. Walking moves over the ground, and straight up and down; flying moves
    /// along the view.
    pub fn advance(&mut self, now_ms: f64, stage: &mut Stage, walks: bool) {
        if !self.moving() {
            self.last_ms = None;
            return;
        }
        let seconds = self.last_ms.map_or(1.0 / 60.0, |last| (now_ms - last) * 1e-3).clamp(0.0, LONGEST);
        self.last_ms = Some(now_ms);
        let is_down = |key: u32| (self.down >> key & 1) as f64;
        let held = |plus: u32, minus: u32| is_down(plus) - is_down(minus);
        let fast = if self.down & SHIFT != 0 { 3.0 } else { 1.0 };
        let step = SPEED * stage.extent * seconds * fast;
        let forward = (held(W, S) + held(UP, DOWN) + self.stick[1]).clamp(-1.0, 1.0);
        let right = (held(D, A) + self.stick[0]).clamp(-1.0, 1.0);
        travel(stage, [right * step, held(E, Q) * step, forward * step], walks);
        let turn = held(LEFT, RIGHT) * TURN * seconds;
        if turn != 0.0 {
            orbit::look(&mut stage.camera, turn, 0.0);
        }
    }
}

/// Moves the camera to the right, up and ahead, world units, as far as surfaces allow. Walking moves over the
/// ground, then straight up.
pub fn travel(stage: &mut Stage, [right, up, ahead]: [f64; 3], walks: bool) {
    let steps = if walks {
        [([right, 0.0, ahead], Motion::Walk), ([0.0, up, 0.0], Motion::Fly)]
    } else {
        [([right, up, ahead], Motion::Fly), ([0.0; 3], Motion::Fly)]
    };
    for (by, motion) in steps.into_iter().filter(|(by, _)| *by != [0.0; 3]) {
        let mut wanted = stage.camera.clone();
        orbit::travel(&mut wanted, by, walks);
        collide::advance(stage, wanted, motion);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::stage;
    use super::*;
    use glam::DVec3;

    /// Displacement of the camera by a key in a second, in steps of `step_ms` milliseconds.
    fn run(key: &str, target: [f64; 3], walks: bool, step_ms: f64) -> DVec3 {
        let (mut fly, mut s) = (Fly::default(), stage());
        s.camera.target = target;
        assert!(fly.key(key, true));
        fly.advance(0.0, &mut s, walks);
        let first = DVec3::from(s.camera.position);
        let mut now = 0.0;
        while now < 1000.0 - 1e-9 {
            now += step_ms;
            fly.advance(now, &mut s, walks);
        }
        DVec3::from(s.camera.position) - first
    }

    #[test]
    fn speed_does_not_depend_on_the_frame_rate() {
        let moved = |step| run("KeyW", [0.0; 3], false, step);
        assert!(moved(10.0).distance(moved(50.0)) < 1e-9);
        assert!(moved(10.0).distance(DVec3::new(0.0, 0.0, -10.0 * SPEED)) < 1e-9);
    }

    #[test]
    fn who_walks_keeps_the_height_and_the_pace_wherever_one_looks() {
        let level = DVec3::new(0.0, 0.0, -10.0 * SPEED);
        for target in [[0.0, 3.0, 0.0], [0.0, -4.0, 0.0], [0.0, -1000.0, 4.9]] {
            assert!(run("KeyW", target, true, 10.0).distance(level) < 1e-6);
            assert!(run("KeyE", target, true, 10.0).distance(DVec3::Y * 10.0 * SPEED) < 1e-6);
        }
        assert!(run("KeyW", [0.0, -4.0, 0.0], false, 10.0).y < -0.1, "who flies goes where one looks");
    }

    #[test]
    fn a_stick_held_half_way_goes_half_as_fast() {
        let (mut fly, mut s) = (Fly::default(), stage());
        let start = s.camera.position;
        let mut go = |to| {
            fly.stick(to);
            for i in 0..11 {
                fly.advance(100.0 * i as f64, &mut s, true);
            }
            fly.stick([0.0; 2]);
            fly.advance(0.0, &mut s, true);
            let gone = DVec3::from(s.camera.position) - DVec3::from(start);
            s.camera = stage().camera;
            gone
        };
        let (half, whole) = (go([0.0, 0.5]), go([0.0, 7.0]));
        assert!((whole - 2.0 * half).length() < 1e-9 && half.z < -0.1 && half.x == 0.0, "{half} {whole}");
        assert!(go([1.0, 0.0]).x > 0.1);
        assert!(!fly.moving());
    }

    #[test]
    fn released_keys_stop() {
        let mut fly = Fly::default();
        assert!(!fly.key("KeyZ", true) && !fly.moving());
        fly.key("KeyA", true);
        assert!(fly.moving());
        fly.key("KeyA", false);
        assert!(!fly.moving());
    }
}
