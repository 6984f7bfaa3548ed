/** The header of an OpenEXR file: what is read further, and what is refused with a reason. */

/** Compressions by their numbers, and the rows of a block. */
const COMPRESSIONS = [
  ["none", 1],
  ["RLE", 1],
  ["ZIPS", 1],
  ["ZIP", 16],
  ["PIZ", 32],
  ["PXR24", 16],
  ["B44", 0],
  ["B44A", 0],
  ["DWAA", 32],
  ["DWAB", 256],
] as const;

/** What the pixels need. */
export interface ExrHeader {
  wide: number;
  tall: number;
  /** Numbers of 16 bits; otherwise of 32. */
  isHalf: boolean;
}

/** Reads the header of a file, and follows its blocks to their end. Throws an error that says what is wrong with it. */
export function exrHeader(bytes: Uint8Array): ExrHeader {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  let at = 8;
  const need = (count: number, where = "its header") => {
    if (!(at + count <= bytes.length)) throw new Error(`it ends within ${where}: download it again`);
  };
  const text = () => {
    const end = bytes.indexOf(0, at);
    if (end < 0) throw new Error("it ends within its header: download it again");
    const found = String.fromCharCode(...bytes.subarray(at, Math.min(end, at + 255)));
    at = end + 1;
    return found;
  };
  need(0);
  // Tiles, deep pixels, several parts.
  const odd = [[0x200, "tiles"], [0x800, "deep pixels"], [0x1000, "several parts"]] as const;
  for (const [flag, what] of odd) {
    if (view.getUint32(4, true) & flag) throw new Error(`it has ${what}, which are not read: save it as plain rows of pixels`);
  }
  const places = new Map<string, number>();
  for (let name = text(); name; name = text()) {
    text();
    need(4);
    const size = view.getUint32(at, true);
    at += 4;
    need(size);
    places.set(name, at);
    at += size;
  }
  const end = at;
  const place = (name: string, size: number) => {
    at = places.get(name) ?? Infinity;
    if (at + size > end) throw new Error(`its header has no ${name}: save it again`);
    return at;
  };
  const box = (name: string) => Array.from({ length: 4 }, (_, i) => view.getInt32(place(name, 16) + 4 * i, true)) as [number, number, number, number];

  const [left, top, right, bottom] = box("dataWindow");
  const [wide, tall] = [Math.max(right - left + 1, 0), Math.max(bottom - top + 1, 0)];
  if (String(box("displayWindow")) !== String(box("dataWindow"))) throw new Error("its data window is not the whole picture: save it without a crop");
  const [compression, rows] = COMPRESSIONS[bytes[place("compression", 1)] as number] ?? ["a compression of its own", 0];
  if (!rows) {
    const read = COMPRESSIONS.flatMap(([name, count]) => (count ? [name] : [])).join(", ");
    throw new Error(`it is compressed by ${compression}, and the page reads ${read}: save it with ZIP`);
  }
  if (bytes[place("lineOrder", 1)] !== 0) throw new Error("its rows are not stored from the top: save it with increasing y");

  place("channels", 1);
  const types = new Map<string, number>();
  for (let name = text(); name; name = text()) {
    need(16);
    types.set(name, view.getInt32(at, true));
    if (view.getInt32(at + 8, true) !== 1 || view.getInt32(at + 12, true) !== 1) throw new Error(`its channel ${name} has fewer pixels than the picture`);
    at += 16;
  }
  const type = types.get("R");
  if (!["G", "B"].every((name) => types.has(name)) || type === undefined) {
    throw new Error(`it has no channels R, G and B, but ${[...types.keys()].join(", ").slice(0, 99)}: save it as one layer of colours`);
  }
  if ((type !== 1 && type !== 2) || [...types.values()].some((other) => other !== type)) {
    throw new Error("its channels are not all of 16-bit or all of 32-bit floats: save it with one kind");
  }

  at = end;
  const blocks = Math.ceil(tall / rows);
  need(8 * blocks, "its table of blocks");
  at += 8 * blocks;
  for (let block = 0; block < blocks; block += 1) {
    need(8, "its pixels");
    const [row, size] = [view.getInt32(at, true), view.getUint32(at + 4, true)];
    if (row !== top + block * rows) throw new Error("its blocks are not in order, or damaged: download it again");
    at += 8;
    need(size, "its pixels");
    at += size;
  }
  return { wide, tall, isHalf: type === 1 };
}
