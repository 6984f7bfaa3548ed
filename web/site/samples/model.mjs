// A glTF scene: things with shapes and materials, lights, a camera.

import { Document, NodeIO } from "@gltf-transform/core";
import { KHRLightsPunctual, KHRMaterialsEmissiveStrength } from "@gltf-transform/extensions";
import { cross, minus, radians, unit } from "./shapes.mjs";
import { Sky, sides } from "./sky.mjs";

/** A scene that is written as a .glb file. */
export class Model {
  #document = new Document();
  #scene;
  #buffer;
  #materials = new Map();

  constructor(name) {
    this.#buffer = this.#document.createBuffer();
    this.#scene = this.#document.createScene(name);
    this.#document.getRoot().setDefaultScene(this.#scene);
  }

  /** A material by a colour as in a style sheet, "#rrggbb"; one that shines in nits of that colour. */
  material(name, colour, { roughness = 0.9, nits = 0 } = {}) {
    const material = this.#document.createMaterial(name).setRoughnessFactor(roughness).setMetallicFactor(0);
    material.setBaseColorFactor([...linearOf(colour), 1]);
    if (nits) {
      const strength = this.#document.createExtension(KHRMaterialsEmissiveStrength).createEmissiveStrength();
      material.setEmissiveFactor(linearOf(colour)).setExtension("KHR_materials_emissive_strength", strength.setEmissiveStrength(nits));
    }
    this.#materials.set(name, material);
    return name;
  }

  /** A thing of pairs of a material's name and a shape. */
  add(name, ...parts) {
    const mesh = this.#document.createMesh(name);
    for (const [material, { positions, normals, indices }] of parts) {
      const accessor = (type, array) => this.#document.createAccessor().setType(type).setArray(array).setBuffer(this.#buffer);
      const primitive = this.#document
        .createPrimitive()
        .setMaterial(this.#materials.get(material))
        .setAttribute("POSITION", accessor("VEC3", new Float32Array(positions.flat())))
        .setAttribute("NORMAL", accessor("VEC3", new Float32Array(normals.flat())))
        .setIndices(accessor("SCALAR", new Uint16Array(indices)));
      if (positions.length > 65_535) throw new Error(`${name} has ${positions.length} corners`);
      mesh.addPrimitive(primitive);
    }
    this.#scene.addChild(this.#document.createNode(name).setMesh(mesh));
  }

  /** A light: "point" and "spot" in candela, "directional" in lux. */
  light(name, type, { at = [0, 0, 0], to, intensity, colour = "#ffffff", cone_deg = [30, 45] }) {
    const light = this.#document.createExtension(KHRLightsPunctual).createLight(name).setType(type);
    light.setIntensity(intensity).setColor(linearOf(colour));
    if (type === "spot") light.setInnerConeAngle(radians(cone_deg[0])).setOuterConeAngle(radians(cone_deg[1]));
    const node = this.#document.createNode(name).setTranslation(at).setExtension("KHR_lights_punctual", light);
    if (to) node.setRotation(towards(at, to));
    this.#scene.addChild(node);
  }

  /** A sky of so many nits where it is white; `sun` is where the sun is. */
  sky({ nits, zenith, horizon, ground, sun }) {
    const sky = this.#document.createExtension(Sky);
    sky.nits = nits;
    const colours = Object.fromEntries(Object.entries({ zenith, horizon, ground }).map(([name, colour]) => [name, bytesOf(colour)]));
    sky.textures = sides({ ...colours, sun }).map((image, i) => this.#document.createTexture(`Sky ${i + 1}`).setImage(image).setMimeType("image/png"));
  }

  /** A camera at a place that looks at another one. */
  camera(name, { at, to, yfov_deg }) {
    const camera = this.#document.createCamera(name).setType("perspective").setYFov(radians(yfov_deg)).setZNear(0.05);
    this.#scene.addChild(this.#document.createNode(name).setTranslation(at).setRotation(towards(at, to)).setCamera(camera));
  }

  /** The bytes of the .glb file. */
  glb() {
    const io = new NodeIO().registerExtensions([KHRLightsPunctual, KHRMaterialsEmissiveStrength, Sky]);
    return io.writeBinary(this.#document);
  }
}

const bytesOf = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** Linear red, green, blue of "#rrggbb". */
function linearOf(colour) {
  return bytesOf(colour).map((byte) => {
    const value = byte / 255;
    return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  });
}

/** The rotation of what looks from a place at another one: -z ahead, y up. */
function towards(at, to) {
  const z = unit(minus(at, to));
  const x = unit(cross(Math.abs(z[1]) > 0.999 ? [0, 0, 1] : [0, 1, 0], z));
  const y = cross(z, x);
  // Of the largest of the four, as the others are divided by it.
  const squares = [1 + x[0] - y[1] - z[2], 1 - x[0] + y[1] - z[2], 1 - x[0] - y[1] + z[2], 1 + x[0] + y[1] + z[2]];
  const most = squares.indexOf(Math.max(...squares));
  const twice = 2 * Math.sqrt(squares[most]);
  const [xy, xz, yz] = [x[1] + y[0], x[2] + z[0], y[2] + z[1]].map((sum) => sum / twice);
  const [wx, wy, wz] = [y[2] - z[1], z[0] - x[2], x[1] - y[0]].map((difference) => difference / twice);
  return [[twice / 4, xy, xz, wx], [xy, twice / 4, yz, wy], [xz, yz, twice / 4, wz], [wx, wy, wz, twice / 4]][most];
}
