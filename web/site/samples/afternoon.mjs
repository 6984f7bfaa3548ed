// The corner of a living room in the afternoon: the sun comes through the window onto a red rug.

import { Model } from "./model.mjs";
import { arc, ball, box, cushion, cylinder, joined, lathe, placed, polygon } from "./shapes.mjs";

/** Half the width, the height and half the depth of the room. */
const [W, H, D] = [2.6, 2.7, 2.2];
/** The window in the left wall: from and to along z, and in height. */
const [FROM, TO, SILL, TOP] = [-1.35, 0.85, 0.45, 2.35];
const WALL = 0.22;

export function afternoon() {
  const model = new Model("Afternoon");
  shell(model);
  sofa(model);
  shelf(model);
  things(model);
  model.light("Sun", "directional", { at: [-5, 5, 1], to: [-5 + 0.78, 5 - 0.62, 1 - 0.22], intensity: 30, colour: "#fff0d6" });
  model.sky({ nits: 3, zenith: "#4f88d8", horizon: "#bfd8f4", ground: "#8d9a6c", sun: [-0.78, 0.62, 0.22] });
  model.light("Floor lamp", "spot", { at: [1.97, 1.49, -1.5], to: [1.8, 0, -1.4], cone_deg: [20, 62], intensity: 6, colour: "#ffd08c" });
  model.camera("The corner", { at: [1.55, 1.45, 3.15], to: [-0.35, 0.95, -1.1], yfov_deg: 48 });
  return model;
}

function shell(model) {
  const wall = model.material("Wall", "#ece6da");
  const far = model.material("Blue-green wall", "#6f9a95");
  const white = model.material("Window frame", "#f0ede6", { roughness: 0.6 });
  // Boards of three tints.
  const tints = ["#b98a58", "#ad7c4b", "#c39663"].map((colour, i) => model.material(`Oak ${i + 1}`, colour, { roughness: 0.55 }));
  const boards = tints.map(() => []);
  const count = 15;
  for (let i = 0; i < count; i += 1) {
    const [x0, x1] = [i, i + 1].map((at) => -W + (2 * W * at) / count);
    const joint = -D + ((i * 1.7) % 3) + 0.6;
    [[-D, joint], [joint, 2 * D]].forEach(([z0, z1], j) =>
      boards[(2 * i + j + (i % 2)) % 3].push(polygon([x0, 0, z1], [x1, 0, z1], [x1, 0, z0], [x0, 0, z0])),
    );
  }
  model.add("Floor", ...boards.map((some, i) => [tints[i], joined(some)]));
  const end = 2 * D;
  // Walls reach beyond their corners, so that no light comes in between.
  const [w, h, d, e] = [W + 0.3, H + 0.3, D + 0.3, end + 0.3];
  model.add("Walls", [
    wall,
    joined(
      polygon([W, -0.3, -d], [W, -0.3, e], [W, h, e], [W, h, -d]),
      polygon([w, -0.3, end], [-w, -0.3, end], [-w, h, end], [w, h, end]),
      polygon([-w, H, -d], [w, H, -d], [w, H, e], [-w, H, e]),
      // Around the window, as thick as the wall.
      box([-W - WALL, 0, TO], [-W, H, end], "-x -y +y +z"),
      box([-W - WALL, 0, -D], [-W, H, FROM], "-x -y +y -z"),
      box([-W - WALL, 0, FROM], [-W, SILL, TO], "-x -y -z +z"),
      box([-W - WALL, TOP, FROM], [-W, H, TO], "-x +y -z +z"),
    ),
  ], [far, polygon([-w, -0.3, -D], [w, -0.3, -D], [w, h, -D], [-w, h, -D])]);
  const bar = (y0, y1, z0, z1, deep = 0.06) => box([-W - 0.13 - deep / 2, y0, z0], [-W - 0.13 + deep / 2, y1, z1]);
  const middle = (FROM + TO) / 2;
  model.add("Window frame", [
    white,
    joined(
      bar(SILL, SILL + 0.06, FROM, TO), bar(TOP - 0.06, TOP, FROM, TO), bar(SILL, TOP, FROM, FROM + 0.06), bar(SILL, TOP, TO - 0.06, TO),
      bar(SILL, TOP, middle - 0.03, middle + 0.03, 0.05), bar(1.62, 1.66, FROM, TO, 0.04),
      box([-W - WALL, SILL, FROM - 0.04], [-W + 0.12, SILL + 0.035, TO + 0.04]),
      box([-W, 0, -D], [W, 0.1, -D + 0.018], "-y -z"),
    ),
  ]);
}

function sofa(model) {
  const cloth = model.material("Sofa", "#ded5c6");
  const ochre = model.material("Ochre cushion", "#d39a2c");
  const blue = model.material("Blue cushion", "#4d6f9e");
  const wood = model.material("Walnut", "#6b4429", { roughness: 0.5 });
  const [x, z] = [-0.62, -1.62];
  const part = (size, at, radius = 0.07) => placed(cushion(size, radius), { at: [x + at[0], at[1], z + at[2]] });
  model.add("Sofa", [
    cloth,
    joined(
      part([2.1, 0.24, 0.86], [0, 0.14, 0]),
      part([2.1, 0.62, 0.24], [0, 0.2, -0.34], 0.1),
      part([0.2, 0.46, 0.86], [-1.05, 0.14, 0], 0.09),
      part([0.2, 0.46, 0.86], [1.05, 0.14, 0], 0.09),
      part([0.93, 0.17, 0.68], [-0.475, 0.36, 0.09]),
      part([0.93, 0.17, 0.68], [0.475, 0.36, 0.09]),
    ),
  ], [wood, joined([[-0.98, -0.35], [0.98, -0.35], [-0.98, 0.35], [0.98, 0.35]].map(([dx, dz]) => placed(cylinder(0.025, 0.15, 12), { at: [x + dx, 0, z + dz] })))]);
  model.add("Cushions",
    [ochre, placed(cushion([0.44, 0.44, 0.15], 0.07), { at: [x - 0.66, 0.53, z - 0.1], tilt: -18, turn: 14 })],
    [blue, placed(cushion([0.4, 0.4, 0.14], 0.065), { at: [x + 0.72, 0.53, z - 0.1], tilt: -18, turn: -12 })],
  );
}

function shelf(model) {
  const wood = "Walnut";
  const colours = ["#b5452f", "#e0c9a0", "#35597a", "#7d8f55", "#d7842f", "#efe8da", "#4a3550"].map((colour, i) => model.material(`Book ${i + 1}`, colour));
  const books = colours.map(() => []);
  const [x0, x1, depth] = [0.95, 1.95, 0.26];
  const boards = [1.22, 1.58, 1.94].map((y) => box([x0, y, -D], [x1, y + 0.03, -D + depth]));
  // The same books in each bake: no chance, but a row of numbers that looks like it.
  let number = 7;
  const next = () => (number = (number * 16807) % 2147483647) / 2147483647;
  [1.25, 1.61, 1.97].forEach((y, row) => {
    let x = x0 + 0.03 + 0.16 * (row === 1);
    const end = x1 - [0.26, 0.05, 0.42][row];
    while (x < end) {
      const width = 0.024 + 0.03 * next();
      books[Math.floor(next() * 7)].push(box([x, y, -D + 0.03], [x + width, y + 0.19 + 0.1 * next(), -D + 0.16 + 0.06 * next()], "-y"));
      x += width + 0.003;
    }
  });
  model.add("Shelf", [wood, joined(boards)]);
  model.add("Books", ...books.map((some, i) => [colours[i], joined(some)]).filter(([, { indices }]) => indices.length > 0));
  const pot = model.material("Clay", "#b86a45");
  const vase = [[0, 0], [0.06, 0.005], [0.085, 0.07], [0.06, 0.15], [0.028, 0.2], [0.04, 0.23]];
  model.add("Vase", [pot, placed(lathe(vase, { steps: 24 }), { at: [1.78, 1.97, -D + 0.14] })]);
}

function things(model) {
  const rug = model.material("Red rug", "#b3352a");
  const edge = model.material("Rug's edge", "#e5d2b4");
  const [leaf, clay, metal] = [model.material("Leaves", "#4f7a3a"), "Clay", model.material("Black metal", "#2b2a2a", { roughness: 0.5 })];
  const shade = model.material("Linen shade", "#ffd9a0", { nits: 1.2 });
  const rugAt = (margin, y) => polygon([-1.75 + margin, y, 1.15 - margin], [0.75 - margin, y, 1.15 - margin], [0.75 - margin, y, -0.95 + margin], [-1.75 + margin, y, -0.95 + margin]);
  model.add("Rug", [edge, rugAt(0, 0.008)], [rug, rugAt(0.09, 0.012)]);
  model.add("Coffee table", [
    "Walnut",
    joined(
      placed(lathe([[0, 0], [0.4, 0], [0.43, 0.015], [0.43, 0.03], [0.41, 0.042], [0, 0.042]], { steps: 40, sharp: true }), { at: [-0.35, 0.36, 0.05] }),
      [0, 120, 240].map((turn) => placed(placed(cylinder(0.02, 0.37, 12), { at: [0, 0, 0.3] }), { at: [-0.35, 0, 0.05], turn })),
    ),
  ]);
  model.add("Bowl", [edge, placed(joined(
    lathe([[0.05, 0], [0.1, 0.02], [0.15, 0.07]], { steps: 28 }), lathe([[0.145, 0.07], [0.095, 0.028], [0, 0.012]], { steps: 28 }),
  ), { at: [-0.42, 0.402, 0.0] })]);
  model.add("Oranges", ["Ochre cushion", joined([[-0.46, 0.01], [-0.38, 0.03], [-0.42, -0.05]].map(([x, z]) => placed(ball(0.042, 16), { at: [x, 0.46, z] })))]);
  // A plant by the window: leaves on a spiral.
  const leaves = Array.from({ length: 22 }, (_, i) => {
    const up = i / 21;
    const out = 0.1 + 0.2 * Math.sin(Math.PI * (0.2 + 0.75 * up));
    return placed(placed(ball(1, 10), { scale: [0.055, 0.014, 0.16], at: [0, 0, out], tilt: 0 }), { at: [-2.2, 0.55 + 0.85 * up, -1.8], turn: 137.5 * i, tilt: 0 });
  });
  model.add("Plant",
    [leaf, joined(leaves, placed(cylinder(0.016, 1.1, 8), { at: [-2.2, 0.35, -1.8] }))],
    [clay, placed(lathe([[0, 0], [0.13, 0], [0.19, 0.36], [0.17, 0.36], [0.15, 0.3], [0, 0.3]], { steps: 28, sharp: true }), { at: [-2.2, 0, -1.8] })],
  );
  const rim = [[0.2, 0], [0.13, 0.26]];
  model.add("Floor lamp",
    [metal, joined(placed(cylinder(0.14, 0.02), { at: [2.05, 0, -1.6] }), placed(cylinder(0.011, 1.5, 10), { at: [2.05, 0.02, -1.6] }))],
    [shade, placed(joined(lathe(rim), lathe([...rim].reverse().map(([r, y]) => [r - 0.006, y]))), { at: [2.05, 1.5, -1.6] })],
  );
  const art = model.material("Painting", "#dfd3bd");
  const sun = model.material("Painted sun", "#cf5a2e");
  const disc = arc([-0.6, 1.66], 0.17, 0, 360, 36).slice(0, -1);
  model.add("Painting",
    ["Walnut", box([-1.1, 1.25, -D], [-0.1, 1.97, -D + 0.03], "-z")],
    [art, polygon([-1.07, 1.28, -D + 0.032], [-0.13, 1.28, -D + 0.032], [-0.13, 1.94, -D + 0.032], [-1.07, 1.94, -D + 0.032])],
    [sun, polygon(...disc.map(([x, y]) => [x, y, -D + 0.034]))],
  );
}
