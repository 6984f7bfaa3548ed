// Parts of .gltf files that tests make.

const WIDTHS = { SCALAR: 1, VEC3: 3, VEC4: 4, MAT4: 16 };
const COMPONENTS = [[Float32Array, 5126], [Uint32Array, 5125], [Uint16Array, 5123]];

/** Numbers of a .gltf. `add(data, type, more)` takes a typed array, and gives the number of its accessor; `members()` are the members of the file. */
export function binary() {
  const parts = [];
  const bufferViews = [];
  const accessors = [];
  let byteOffset = 0;
  const add = (data, type, more = {}) => {
    const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
    bufferViews.push({ buffer: 0, byteOffset, byteLength: bytes.length });
    byteOffset += bytes.length;
    parts.push(bytes);
    const [, componentType] = COMPONENTS.find(([array]) => data instanceof array);
    accessors.push({ bufferView: bufferViews.length - 1, componentType, count: data.length / WIDTHS[type], type, ...more });
    return accessors.length - 1;
  };
  const members = () => {
    const buffer = Buffer.concat(parts);
    const uri = `data:application/octet-stream;base64,${buffer.toString("base64")}`;
    return { accessors, bufferViews, buffers: [{ byteLength: buffer.length, uri }] };
  };
  return { add, members };
}
