// Makes the files of this folder; README.md says how to run it.
import { Document, NodeIO } from "@gltf-transform/core";
import { ALL_EXTENSIONS } from "@gltf-transform/extensions";
import { draco, instance, meshopt, quantize, sparse, textureCompress } from "@gltf-transform/functions";
import draco3d from "draco3dgltf";
import { pack } from "gltfpack";
import { encodeToKTX2 } from "ktx2-encoder";
import { MeshoptDecoder, MeshoptEncoder } from "meshoptimizer";
import { readFileSync, writeFileSync } from "node:fs";
import sharp from "sharp";

await MeshoptEncoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
  "draco3d.encoder": await draco3d.createEncoderModule(),
  "meshopt.encoder": MeshoptEncoder,
  "meshopt.decoder": MeshoptDecoder,
});

/** A picture of 32 x 32: a smooth gradient, its right half under half transparent. */
const texels = new Uint8Array(32 * 32 * 4);
for (let y = 0; y < 32; y++) {
  for (let x = 0; x < 32; x++) {
    texels.set([40 + 6 * x, 220 - 5 * y, 90 + 2 * (x + y), x < 16 ? 255 : 100], 4 * (32 * y + x));
  }
}
const raw = { raw: { width: 32, height: 32, channels: 4 } };
const picture = new Uint8Array(await sharp(texels, raw).png().toBuffer());

/** A floor with the picture, and five coloured balls on it that share a mesh. */
function scene() {
  const doc = new Document();
  const buffer = doc.createBuffer();
  const floats = (type, numbers) =>
    doc.createAccessor().setType(type).setArray(new Float32Array(numbers)).setBuffer(buffer);
  const indices = (numbers) =>
    doc.createAccessor().setType("SCALAR").setArray(new Uint16Array(numbers)).setBuffer(buffer);
  const root = doc.createScene();

  const texture = doc.createTexture("gradient").setImage(picture).setMimeType("image/png");
  const floorMaterial = doc.createMaterial("floor").setBaseColorTexture(texture).setRoughnessFactor(0.9);
  const floor = doc
    .createPrimitive()
    .setAttribute("POSITION", floats("VEC3", [-4, 0, -3, 4, 0, -3, 4, 0, 3, -4, 0, 3]))
    .setAttribute("NORMAL", floats("VEC3", [0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0]))
    .setAttribute("TEXCOORD_0", floats("VEC2", [0, 0, 1, 0, 1, 1, 0, 1]))
    .setIndices(indices([0, 2, 1, 0, 3, 2]))
    .setMaterial(floorMaterial);
  root.addChild(doc.createNode("floor").setMesh(doc.createMesh("floor").addPrimitive(floor)));

  const [position, normal, color, index] = [[], [], [], []];
  const [rings, sides] = [10, 16];
  for (let r = 0; r <= rings; r++) {
    for (let s = 0; s <= sides; s++) {
      const [theta, phi] = [(Math.PI * r) / rings, (2 * Math.PI * s) / sides];
      const n = [Math.sin(theta) * Math.cos(phi), Math.cos(theta), -Math.sin(theta) * Math.sin(phi)];
      normal.push(...n);
      position.push(...n.map((c) => 0.5 * c));
      color.push(0.5 + 0.5 * n[0], 0.5 + 0.5 * n[1], 0.5 - 0.5 * n[0], 1);
      const at = r * (sides + 1) + s;
      if (r < rings && s < sides) {
        if (r > 0) index.push(at, at + sides + 1, at + 1);
        if (r < rings - 1) index.push(at + 1, at + sides + 1, at + sides + 2);
      }
    }
  }
  const ball = doc
    .createPrimitive()
    .setAttribute("POSITION", floats("VEC3", position))
    .setAttribute("NORMAL", floats("VEC3", normal))
    .setAttribute("COLOR_0", floats("VEC4", color))
    .setIndices(indices(index))
    .setMaterial(doc.createMaterial("ball").setBaseColorFactor([0.8, 0.8, 0.8, 1]));
  const mesh = doc.createMesh("ball").addPrimitive(ball);
  for (let i = 0; i < 5; i++) {
    const node = doc.createNode(`ball ${i}`).setMesh(mesh);
    const angle = 0.3 * i;
    node.setTranslation([1.5 * i - 3, 0.75 + 0.1 * i, i % 2 ? 1 : -1]);
    node.setRotation([0, Math.sin(angle), 0, Math.cos(angle)]);
    node.setScale([1, 1 + 0.1 * i, 1]);
    root.addChild(node);
  }
  return doc;
}

async function write(name, ...transforms) {
  const doc = scene();
  doc.setLogger({ debug() {}, info() {}, warn: console.warn, error: console.error });
  await doc.transform(...transforms);
  writeFileSync(name, await io.writeBinary(doc));
}

/** Pictures as KTX2 of Basis Universal. */
function basis(isUASTC) {
  return async (doc) => {
    doc.createExtension(ALL_EXTENSIONS.find((e) => e.EXTENSION_NAME === "KHR_texture_basisu")).setRequired(true);
    for (const texture of doc.getRoot().listTextures()) {
      const imageDecoder = async (bytes) => {
        const { data, info } = await sharp(bytes).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
        return { data: new Uint8Array(data), width: info.width, height: info.height };
      };
      const quality = { qualityLevel: 255, needSupercompression: isUASTC };
      const options = { isUASTC, generateMipmap: false, imageDecoder, ...quality };
      texture.setImage(await encodeToKTX2(texture.getImage(), options)).setMimeType("image/ktx2");
    }
  };
}

/** Colours of the balls that are zero but for one in forty: what accessors may say by sparse values. */
function flattened(doc) {
  for (const mesh of doc.getRoot().listMeshes().filter((m) => m.getName() === "ball")) {
    const color = mesh.listPrimitives()[0].getAttribute("COLOR_0");
    for (let i = 0; i < color.getCount(); i++) color.setElement(i, i % 40 ? [0, 0, 0, 0] : [1, 0.5, 0.25, 1]);
  }
}

await write("plain.glb");
await write("quantized.glb", quantize({ quantizePosition: 14, quantizeColor: 8 }));
await write("meshopt.glb", meshopt({ encoder: MeshoptEncoder, level: "high" }));
await write("meshopt-medium.glb", meshopt({ encoder: MeshoptEncoder, level: "medium" }));
await write("draco.glb", draco({ method: "edgebreaker" }));
await write("draco-sequential.glb", draco({ method: "sequential", encodeSpeed: 10, decodeSpeed: 10 }));
await write("instanced.glb", instance({ min: 2 }));
await write("instanced-meshopt.glb", instance({ min: 2 }), meshopt({ encoder: MeshoptEncoder, level: "high" }));
await write("sparse.glb", flattened, sparse());
await write("sparse-plain.glb", flattened);
await write("webp.glb", textureCompress({ encoder: sharp, targetFormat: "webp", lossless: true }));
await write("etc1s.glb", basis(false));
await write("uastc.glb", basis(true));

/** gltfpack knows the Khronos version of meshopt's extension, and floats packed by exponents. */
const files = { read: (name) => readFileSync(name), write: (name, bytes) => writeFileSync(name, bytes) };
const packed = (name, ...options) => pack(["-i", "plain.glb", "-o", name, "-kn", "-km", ...options], files);
await packed("gltfpack.glb", "-cc");
await packed("gltfpack-khr.glb", "-cz", "-ce", "khr", "-vpf", "-vtf", "-mi");
await packed("gltfpack-fallback.glb", "-cf");
