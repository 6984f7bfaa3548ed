// A room between a red wall and a green one: two blocks, a ball, a lamp.

import { Model } from "./model.mjs";
import { ball, box, cylinder, joined, lathe, placed, polygon } from "./shapes.mjs";

/** Half the width, the height, half the depth. */
const [W, H, D] = [2.3, 3, 2];
/** The lamp's middle: nearer to the red wall, which colours more of the room than the green one. */
const [X, Y, Z] = [-0.55, 2.56, 0.35];

export function red_and_green() {
  const model = new Model("Red and green");
  const white = model.material("White plaster", "#e6e2da");
  const red = model.material("Red wall", "#c8281c");
  const green = model.material("Green wall", "#3a9a3c");
  const floor = model.material("Floor", "#d6d0c4");
  const block = model.material("Blocks", "#ece8e0");
  const brass = model.material("Lamp shade", "#d8a846", { roughness: 0.5 });
  const glow = model.material("Lamp glass", "#fff0dc", { nits: 3 });
  model.add("Floor", [floor, polygon([-W, 0, D], [W, 0, D], [W, 0, -D], [-W, 0, -D])]);
  model.add("Red wall", [red, polygon([-W, 0, D], [-W, 0, -D], [-W, H, -D], [-W, H, D])]);
  model.add("Green wall", [green, polygon([W, 0, -D], [W, 0, D], [W, H, D], [W, H, -D])]);
  // From outside one looks through the wall in front, and the light stays in.
  model.add("White walls", [
    white,
    joined(
      polygon([-W, 0, -D], [W, 0, -D], [W, H, -D], [-W, H, -D]),
      polygon([W, 0, D], [-W, 0, D], [-W, H, D], [W, H, D]),
      polygon([-W, H, -D], [W, H, -D], [W, H, D], [-W, H, D]),
    ),
  ]);
  model.add("Tall block", [block, placed(box([-0.5, 0, -0.5], [0.5, 1.75, 0.5], "-y"), { at: [-0.75, 0, -0.75], turn: 20 })]);
  model.add("Low block", [block, placed(box([-0.5, 0, -0.5], [0.5, 0.75, 0.5], "-y"), { at: [0.8, 0, 0.25], turn: -18 })]);
  model.add("Ball", [block, placed(ball(0.38, 64), { at: [0.8, 1.13, 0.25] })]);
  const shade = [[0.34, 0], [0.3, 0.1], [0.16, 0.19], [0.03, 0.22]];
  const inner = [...shade].reverse().map(([r, y]) => [0.97 * r, y - 0.005]);
  model.add(
    "Lamp",
    [brass, placed(joined(lathe(shade), lathe(inner)), { at: [X, Y, Z] })],
    [glow, placed(lathe([[0, 0], [0.31, 0]], { sharp: true }), { at: [X, Y + 0.01, Z] })],
    [white, placed(cylinder(0.012, H - Y - 0.19, 8), { at: [X, Y + 0.19, Z] })],
  );
  // A cone that leaves the shade dark: light that begins so near a surface would bounce off that above all.
  model.light("Lamp", "spot", { at: [X, Y - 0.02, Z], to: [X, 0, Z], cone_deg: [35, 82], intensity: 16, colour: "#fff0dc" });
  model.camera("Front", { at: [0, 1.5, 7], to: [0, 1.47, 0], yfov_deg: 36 });
  return model;
}
