// A sky around a scene, EXT_lights_image_based: six small pictures of the sides of a cube.

import { Extension } from "@gltf-transform/core";
import { deflateSync } from "node:zlib";
import { unit } from "./shapes.mjs";

const NAME = "EXT_lights_image_based";
/** Pixels along a side: the colours change slowly. */
const SIZE = 64;
/** By the side, the direction at a place from -1 to 1 across and down, as seen from within. */
const SIDES = [
  (u, v) => [1, -v, u],
  (u, v) => [-1, -v, -u],
  (u, v) => [-u, 1, v],
  (u, v) => [-u, -1, -v],
  (u, v) => [-u, -v, 1],
  (u, v) => [u, -v, -1],
];

/** The extension; `textures` are its sides. */
export class Sky extends Extension {
  static EXTENSION_NAME = NAME;
  extensionName = NAME;
  textures = [];
  nits = 1;

  read() {
    return this;
  }

  write({ jsonDoc: { json }, imageIndexMap }) {
    const specularImages = [this.textures.map((texture) => imageIndexMap.get(texture))];
    const light = { name: "Sky", intensity: this.nits, specularImageSize: SIZE, specularImages };
    json.extensions = { ...json.extensions, [NAME]: { lights: [light] } };
    for (const scene of json.scenes) scene.extensions = { ...scene.extensions, [NAME]: { light: 0 } };
    return this;
  }
}

/** The sides as PNG files: from the zenith's colour to the horizon's, paler around the sun, the ground below. */
export function sides({ zenith, horizon, ground, sun }) {
  const to = unit(sun);
  const mixed = (a, b, share) => a.map((x, i) => x + (b[i] - x) * share);
  const colour = (direction) => {
    const [x, y, z] = unit(direction);
    if (y < 0) return mixed(horizon, ground, Math.min(-y * 12, 1));
    const glow = 0.55 * Math.max(x * to[0] + y * to[1] + z * to[2], 0) ** 6;
    return mixed(mixed(horizon, zenith, 1 - (1 - y) ** 3), [255, 250, 238], glow);
  };
  return SIDES.map((direction) => {
    const place = (i) => (2 * (i + 0.5)) / SIZE - 1;
    return png(Array.from({ length: SIZE }, (_, i) => Array.from({ length: SIZE }, (_, j) => colour(direction(place(j), place(i))))));
  });
}

/** The checksum of PNG's chunks; Node 18 has none of its own. */
function crc32(bytes) {
  let sum = ~0;
  for (const byte of bytes) {
    sum ^= byte;
    for (let bit = 0; bit < 8; bit += 1) sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0);
  }
  return ~sum >>> 0;
}

/** A PNG file of rows of pixels, red, green, blue from 0 to 255. */
function png(rows) {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]);
    const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(data.length);
    check.writeUInt32BE(crc32(body));
    return Buffer.concat([length, body, check]);
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(rows[0].length, 0);
  head.writeUInt32BE(rows.length, 4);
  head.set([8, 2], 8);
  const bytes = rows.flatMap((row) => [0, ...row.flat().map(Math.round)]);
  return Buffer.concat([
    Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]),
    chunk("IHDR", head),
    chunk("IDAT", deflateSync(Buffer.from(bytes), { level: 9 })),
    chunk("IEND", Buffer.alloc(0)),
  ]);
}
