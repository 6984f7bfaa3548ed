// A courtyard with a stair: its coloured walls light each other, and the sun comes over the edge.

import { Model } from "./model.mjs";
import { arc, ball, box, cylinder, joined, lathe, placed, polygon } from "./shapes.mjs";

/** Half the width, half the depth, the height. */
const [W, D, H] = [3, 3, 4.6];

export function courtyard() {
  const model = new Model("Courtyard");
  const pink = model.material("Pink wall", "#d9487a");
  const white = model.material("White wall", "#efe9de");
  const blue = model.material("Blue wall", "#3d74cc");
  const ochre = model.material("Ochre wall", "#dd9a3a");
  const sand = model.material("Sandstone", "#e2b98c");
  const stone = model.material("Stone floor", "#cdb79a");
  model.add("Floor", [stone, polygon([-W, 0, D], [W, 0, D], [W, 0, -D], [-W, 0, -D])]);
  model.add("Pink wall", [pink, polygon([-W, 0, D], [-W, 0, -D], [-W, H, -D], [-W, H, D])]);
  model.add("Blue wall", [blue, polygon([W, 0, -D], [W, 0, D], [W, H, D], [W, H, -D])]);
  model.add("Ochre wall", [ochre, polygon([W, 0, D], [-W, 0, D], [-W, H, D], [W, H, D])]);

  // The wall at the back has an arch, high up, with a blue room behind it.
  const [x, radius, from, spring, deep] = [1.55, 0.55, 2.0, 3.1, 0.9];
  const arch = arc([x, spring], radius, 180, 0, 24);
  const above = arch.slice(1).map((b, i) => polygon([arch[i][0], arch[i][1], -D], [b[0], b[1], -D], [b[0], H, -D], [arch[i][0], H, -D]));
  model.add("White wall", [
    white,
    joined(
      polygon([-W, 0, -D], [x - radius, 0, -D], [x - radius, H, -D], [-W, H, -D]),
      polygon([x + radius, 0, -D], [W, 0, -D], [W, H, -D], [x + radius, H, -D]),
      polygon([x - radius, 0, -D], [x + radius, 0, -D], [x + radius, from, -D], [x - radius, from, -D]),
      above,
    ),
  ]);
  const [left, right, back] = [x - radius, x + radius, -D - deep];
  const vault = arch.slice(1).map((b, i) => polygon([arch[i][0], arch[i][1], back], [b[0], b[1], back], [b[0], b[1], -D], [arch[i][0], arch[i][1], -D]));
  model.add("Doorway", [
    ochre,
    joined(
      polygon([left, from, -D], [left, from, back], [left, spring, back], [left, spring, -D]),
      polygon([right, from, back], [right, from, -D], [right, spring, -D], [right, spring, back]),
      polygon([left, from, -D], [right, from, -D], [right, from, back], [left, from, back]),
      vault,
      polygon([left, from, back], [right, from, back], ...arc([x, spring], radius, 0, 180, 24).map(([px, py]) => [px, py, back])),
    ),
  ]);

  // Steps along the back, up to the arch.
  const [steps, rise, run, first] = [11, 2.0 / 11, 0.29, -2.2];
  const flight = Array.from({ length: steps }, (_, i) => {
    const end = i === steps - 1 ? W : first + run * (i + 1);
    return box([first + run * i, 0, -D], [end, rise * (i + 1), -D + 1.15], i === steps - 1 ? "-y -z +x" : "-y -z +x");
  });
  model.add("Stair", [sand, joined(flight)]);
  model.add("Bench", [ochre, box([-W, 0, -0.9], [-W + 0.55, 0.42, 2.1], "-x -y")]);

  const clay = model.material("Clay", "#b5623c");
  const leaf = model.material("Leaves", "#7da85a");
  const bark = model.material("Bark", "#7a5c45");
  const [px, pz] = [2.3, -0.75];
  const crown = [[0, 2.05, 0, 0.46], [0.32, 1.85, 0.12, 0.33], [-0.3, 1.9, 0.1, 0.34], [0.05, 1.8, -0.3, 0.32], [0.02, 1.75, 0.32, 0.32]];
  model.add("Tree",
    [clay, placed(lathe([[0, 0], [0.26, 0], [0.38, 0.5], [0.41, 0.5], [0.41, 0.56], [0.35, 0.56], [0.33, 0.5], [0, 0.5]], { steps: 32, sharp: true }), { at: [px, 0, pz] })],
    [bark, placed(cylinder(0.045, 1.3, 12), { at: [px, 0.45, pz] })],
    [leaf, joined(crown.map(([x, y, z, radius]) => placed(ball(radius, 20), { at: [px + x, y, pz + z] })))],
  );
  model.add("Ball", [white, placed(ball(0.3, 56), { at: [-0.95, 0.3, -0.45] })]);
  model.light("Sun", "directional", { at: [4, 8, 4], to: [4 - 0.55, 8 - 0.8, 4 - 0.36], intensity: 34, colour: "#fff2dc" });
  model.sky({ nits: 2.6, zenith: "#4c86d8", horizon: "#cfe0f2", ground: "#b7a98f", sun: [0.55, 0.8, 0.36] });
  model.light("Lantern", "point", { at: [1.55, 3.05, -3.35], intensity: 3, colour: "#ffc98a" });
  model.camera("From the gate", { at: [0.9, 1.5, 2.85], to: [-0.15, 1.72, -2], yfov_deg: 66 });
  return model;
}
