// A round hall under a coffered dome: the sun falls through its eye.

import { Model } from "./model.mjs";
import { box, cushion, cylinder, inward, joined, lathe, placed, polygon, radians } from "./shapes.mjs";

/** Radius of the hall, height of its wall, and the height of the eye in the dome in degrees. */
const [R, WALL, EYE] = [4, 3.2, 66];
/** Coffers around the dome. */
const SIDES = 20;

export function rotunda() {
  const model = new Model("Rotunda");
  const plaster = model.material("Plaster", "#e4dac8");
  const coffer = model.material("Coffers", "#d9cdb8");
  const niche = ["#b8402f", "#2f6d8c", "#c98f2e", "#4f7d4a"].map((colour, i) => model.material(`Niche ${i + 1}`, colour));
  const tiles = ["#c9a27e", "#8e4a34", "#e2d3b8"].map((colour, i) => model.material(`Floor ${i + 1}`, colour, { roughness: 0.5 }));
  const marble = model.material("Columns", "#ece4d6", { roughness: 0.6 });
  const disc = (inner, outer, y) => lathe([[outer, y], [inner, y]], { steps: 48, sharp: true });
  model.add("Floor",
    [tiles[0], joined(disc(2.9, R + 1.2, 0), disc(0.75, 2.1, 0))],
    [tiles[1], joined(disc(2.6, 2.9, 0), disc(2.1, 2.25, 0), disc(0.0001, 0.55, 0))],
    [tiles[2], joined(disc(2.25, 2.6, 0), disc(0.55, 0.75, 0))],
  );
  const at = (angle, radius, y) => [radius * Math.cos(radians(angle)), y, radius * Math.sin(radians(angle))];

  // Eight niches, between piers of wall.
  const [half, top, deep] = [13, 2.35, 0.95];
  const wall = [];
  const niches = niche.map(() => []);
  for (let i = 0; i < 8; i += 1) {
    const middle = 45 * i + 22.5;
    const strip = (from, to, y0, y1) => {
      const steps = 6;
      return Array.from({ length: steps }, (_, k) => {
        const [a, b] = [k, k + 1].map((j) => from + ((to - from) * j) / steps);
        return polygon(at(a, R, y0), at(b, R, y0), at(b, R, y1), at(a, R, y1));
      });
    };
    wall.push(...strip(middle + half, middle + 45 - half, 0, WALL), ...strip(middle - half, middle + half, top, WALL));
    // A niche is half a cylinder with a flat top.
    const width = R * Math.sin(radians(half));
    const back = placed(inward(lathe([[1, 0], [1, top]], { steps: 16, from: 0, to: 180 })), { scale: [width, 1, deep] });
    const steps = Array.from({ length: 17 }, (_, k) => [width * Math.cos(radians(180 * (k / 16))), top, deep * Math.sin(radians(180 * (k / 16)))]);
    const into = (shape) => placed(placed(shape, { at: [0, 0, R * Math.cos(radians(half)) - 0.001] }), { turn: 90 - middle });
    niches[i % 4].push(into(back), into(polygon(...steps)));
  }
  model.add("Wall", [plaster, joined(wall)]);
  model.add("Niches", ...niches.map((some, i) => [niche[i], joined(some)]));

  // A ring of stone under the dome, and columns below it.
  const cornice = [[R, WALL - 0.28], [R - 0.1, WALL - 0.25], [R - 0.1, WALL - 0.12], [R - 0.22, WALL - 0.02], [R - 0.22, WALL + 0.06], [R, WALL + 0.06]];
  model.add("Cornice", [marble, inward(lathe(cornice, { steps: 60, sharp: true }))]);
  const column = joined(
    placed(box([-0.2, 0, -0.2], [0.2, 0.12, 0.2], "-y"), {}),
    lathe([[0.18, 0.12], [0.145, 0.22], [0.14, 1.2], [0.12, 2.62], [0.16, 2.7], [0.19, 2.8]], { steps: 12 }),
    placed(box([-0.2, 2.8, -0.2], [0.2, 2.94, 0.2]), {}),
  );
  model.add("Columns", [marble, joined(Array.from({ length: 8 }, (_, i) => placed(column, { at: at(45 * i, R - 0.24, 0), turn: -45 * i })))]);

  // The dome: rows of coffers, smaller towards the eye.
  const rows = [4, 17, 29, 40, 50];
  const shell = (longitude, latitude, radius) => at(longitude, radius * Math.cos(radians(latitude)), WALL + radius * Math.sin(radians(latitude)));
  const ribs = [];
  const fields = [];
  const patch = (a0, a1, l0, l1, radius = R) => polygon(shell(a0, l0, radius), shell(a1, l0, radius), shell(a1, l1, radius), shell(a0, l1, radius));
  for (let side = 0; side < SIDES; side += 1) {
    const [a0, a1] = [side, side + 1].map((k) => (360 * k) / SIDES + 9);
    const rib = 360 / SIDES / 7;
    // Cut alike in each row, so that no light comes through between them.
    const cuts = [a0, a0 + rib, a1 - rib, a1];
    const band = (low, high) => ribs.push(...cuts.slice(1).map((b, k) => patch(cuts[k], b, low, high)));
    band(0, rows[0]);
    band(rows.at(-1) + 8, EYE);
    rows.forEach((low, i) => {
      const high = rows[i + 1] ?? low + 8;
      const edge = 1.4;
      const [b0, b1, m0, m1] = [a0 + rib, a1 - rib, low + edge, high - edge];
      band(low, m0);
      band(m1, high);
      ribs.push(patch(a0, b0, m0, m1), patch(b1, a1, m0, m1));
      const outer = R + 0.2;
      const inner = [b0 + 1, b1 - 1, m0 + 0.8, m1 - 0.8];
      fields.push(patch(...inner, outer));
      const [near, far] = [[[b0, m0], [b1, m0], [b1, m1], [b0, m1]], [[inner[0], inner[2]], [inner[1], inner[2]], [inner[1], inner[3]], [inner[0], inner[3]]]];
      near.forEach((point, k) => {
        const next = (k + 1) % 4;
        fields.push(polygon(shell(...point, R), shell(...near[next], R), shell(...far[next], outer), shell(...far[k], outer)));
      });
    });
  }
  model.add("Dome", [plaster, joined(ribs)], [coffer, joined(fields)]);
  const [eye, up] = [R * Math.cos(radians(EYE)), WALL + R * Math.sin(radians(EYE))];
  model.add("Eye", [marble, lathe([[eye - 0.03, up + 0.25], [eye - 0.03, up - 0.03], [eye + 0.12, up - 0.03]], { steps: 48, sharp: true })]);
  // A second shell, unseen, keeps the sun from shining in where the coffers' edges meet.
  const around = Array.from({ length: 6 }, (_, i) => radians((EYE * (i + 0.5)) / 6));
  const outside = [[R + 1.3, -0.05], [R + 1.3, WALL + 0.1], ...around.map((a) => [(R + 0.45) * Math.cos(a), WALL + (R + 0.45) * Math.sin(a)]), [(eye - 0.03) / Math.cos(radians(180 / 24)), up + 0.25]];
  model.add("Outer shell", [plaster, inward(lathe(outside, { steps: 24 }))]);
  model.add("Bench", [marble, joined([0, 180].map((turn) => placed(placed(cushion([1.4, 0.42, 0.5], 0.04), { at: [0, 0, 1.5] }), { turn: turn + 55 })))]);
  model.light("Sun", "directional", { at: [2, 12, 2], to: [2 + 0.42, 12 - 0.83, 2 - 0.36], intensity: 36, colour: "#fff0d8" });
  model.sky({ nits: 3, zenith: "#4c86d8", horizon: "#cfe0f2", ground: "#b7a98f", sun: [-0.42, 0.83, 0.36] });
  model.light("Lamp", "point", { at: [0, 2.6, 0], intensity: 2, colour: "#ffd6a0" });
  model.camera("From the entrance", { at: [-1.2, 1.5, 3.6], to: [0.35, 2.75, -2.2], yfov_deg: 74 });
  return model;
}
