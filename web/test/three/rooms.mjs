// Scenes for probes: a ball that the bake does not know, in a room and behind a wall of 5 cm.

import { Model } from "../../site/samples/model.mjs";
import { ball, box, inward, joined, placed } from "../../site/samples/shapes.mjs";

/** The ball: where it is in each scene, and its radius. */
export const BALL = { room: [0.6, 1.1, -0.3], dark: [0.5, 1.2, 0], radius: 0.4 };

/** Where the ball is looked at: from the scene's camera, and on both sides of the wall, from between the wall and the ball. */
export const VIEWS = {
  room: { at: BALL.room },
  dark: { at: BALL.dark, eye: [0.45, 1.3, 1.3] },
  lit: { at: [-0.5, 1.2, 0], eye: [-0.5, 1.3, 1.3] },
};

/** A room of 5 × 3 × 4 m with coloured sides and a block; with `withBall`, what a path tracer is to see. */
export function room(withBall) {
  const model = new Model("Room");
  const white = model.material("White", "#d8d8d8");
  const red = model.material("Red", "#c83020");
  const green = model.material("Green", "#30a040");
  const shell = (low, high, without) => inward(box(low, high, without));
  model.add("Floor, ceiling, ends", [white, shell([-2.5, 0, -2], [2.5, 3, 2], "-x+x")]);
  model.add("Left", [red, shell([-2.5, 0, -2], [2.5, 3, 2], "+x-y+y-z+z")]);
  model.add("Right", [green, shell([-2.5, 0, -2], [2.5, 3, 2], "-x-y+y-z+z")]);
  model.add("Block", [white, box([-1.6, 0, -1.2], [-0.6, 1.2, -0.2], "-y")]);
  if (withBall) model.add("Ball", [white, placed(ball(BALL.radius, 64), { at: BALL.room })]);
  model.light("Lamp", "spot", { at: [-0.4, 2.8, 0.8], to: [-0.8, 0, 0.6], cone_deg: [49.9, 50], intensity: 40 });
  model.camera("Camera", { at: [0.8, 1.4, 1.8], to: BALL.room, yfov_deg: 50 });
  return model;
}

/** Two closed rooms with a wall of 5 cm between them; the lamp is in the left one, the ball in the right one. */
export function twoRooms(withBall) {
  const model = new Model("Two rooms");
  const white = model.material("White", "#d8d8d8");
  model.add("Lit", [white, inward(box([-3, 0, -1.5], [0, 2.5, 1.5]))]);
  model.add("Dark", [white, inward(box([0.05, 0, -1.5], [3, 2.5, 1.5]))]);
  if (withBall) model.add("Ball", [white, placed(ball(BALL.radius, 64), { at: BALL.dark })]);
  model.light("Lamp", "point", { at: [-1.2, 1.8, 0.3], intensity: 30 });
  model.camera("Camera", { at: [2.4, 1.3, 0.6], to: BALL.dark, yfov_deg: 60 });
  model.camera("Lit", { at: [-2.4, 1.3, 0.6], to: [0, 1, 0], yfov_deg: 60 });
  return model;
}

/** A closed room without lamps, under a panel that shines. */
export function glowing() {
  const model = new Model("Glow");
  const white = model.material("White", "#d8d8d8");
  const glow = model.material("Glow", "#fff0d8", { nits: 8 });
  model.add("Room", [white, inward(box([-2, 0, -2], [2, 2.6, 2]))]);
  model.add("Panel", [glow, box([-0.6, 2.5, -0.4], [0.6, 2.55, 0.4])]);
  model.camera("Camera", { at: [1.6, 1.3, 1.6], to: [-0.4, 1, -0.4], yfov_deg: 70 });
  return model;
}

/** A court without a roof, under a sky. */
export function court() {
  const model = new Model("Court");
  const white = model.material("White", "#d8d8d8");
  model.add("Court", [white, inward(box([-2, 0, -2], [2, 2.6, 2], "+y"))]);
  model.sky({ nits: 3, zenith: "#4f88d8", horizon: "#bfd8f4", ground: "#8d9a6c", sun: [-0.5, 0.8, 0.3] });
  model.camera("Camera", { at: [1.6, 1.3, 1.6], to: [-0.4, 1, -0.4], yfov_deg: 70 });
  return model;
}
