//! Flying with the keyboard: W A S D, Q E, arrows; shift is faster.

use super::orbit;
use rebounce_shared::camera::Camera;
use std::collections::BTreeSet;

/// Scene diagonals a second.
const SPEED: f64 = 0.12;
/// Radians a second.
const TURN: f64 = 1.5;
/// Longest step of time that is believed, seconds: after a pause nothing jumps.
const LONGEST: f64 = 0.1;

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

/// Keys that are down, and when the camera last moved.
#[derive(Debug, Default)]
pub struct Fly {
    down: BTreeSet<&'static str>,
    last_ms: Option<f64>,
}

impl Fly {
    /// A key (`KeyboardEvent.code`) goes down or up; true when it is one of the keys here.
    pub fn key(&mut self, code: &str, down: bool) -> bool {
        let Some(key) = KEYS.into_iter().find(|&k| k == code) else { return false };
        if down {
            self.down.insert(key);
        } else {
            self.down.remove(key);
        }
        !key.starts_with("Shift")
    }

    /// Lets go of all keys.
    pub fn release(&mut self) {
        self.down.clear();
    }

    /// True while a key moves the camera.
    pub fn moving(&self) -> bool {
        self.down.iter().any(|key| !key.starts_with("Shift"))
    }

    /// Moves the camera to `now_ms`; `extent` is the scene's diagonal.
    pub fn advance(&mut self, now_ms: f64, camera: &mut Camera, extent: f64) {
        if !self.moving() {
            self.last_ms = None;
            return;
        }
        let seconds = self.last_ms.map_or(1.0 / 60.0, |last| (now_ms - last) * 1e-3).clamp(0.0, LONGEST);
        self.last_ms = Some(now_ms);
        let held = |plus: &str, minus: &str| {
            self.down.contains(plus) as i32 as f64 - self.down.contains(minus) as i32 as f64
        };
        let fast =
            if self.down.contains("ShiftLeft") || self.down.contains("ShiftRight") { 3.0 } else { 1.0 };
        let step = SPEED * extent * seconds * fast;
        let forward = (held("KeyW", "KeyS") + held("ArrowUp", "ArrowDown")).clamp(-1.0, 1.0);
        orbit::travel(camera, held("KeyD", "KeyA") * step, held("KeyE", "KeyQ") * step, forward * step);
        let turn = held("ArrowLeft", "ArrowRight") * TURN * seconds;
        if turn != 0.0 {
            orbit::look(camera, turn, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn speed_does_not_depend_on_the_frame_rate() {
        let start =
            Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
        let run = |step_ms: f64| {
            let (mut fly, mut camera) = (Fly::default(), start.clone());
            assert!(fly.key("KeyW", true));
            fly.advance(0.0, &mut camera, 10.0);
            let first = DVec3::from(camera.position);
            let mut now = 0.0;
            while now < 1000.0 - 1e-9 {
                now += step_ms;
                fly.advance(now, &mut camera, 10.0);
            }
            DVec3::from(camera.position) - first
        };
        assert!(run(10.0).distance(run(50.0)) < 1e-9);
        assert!(run(10.0).distance(DVec3::new(0.0, 0.0, -10.0 * SPEED)) < 1e-9);
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
