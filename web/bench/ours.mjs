// The baked scene in <rebounce-viewer>. `bench` on the window is what run.mjs calls.

// The device, as the page asks for it: to wait for the end of its work.
let device;
const request = GPUAdapter.prototype.requestDevice;
GPUAdapter.prototype.requestDevice = async function (...parameters) {
  device = await request.apply(this, parameters);
  return device;
};
await import("/dist/rebounce-viewer.js");

const viewer = document.querySelector("rebounce-viewer");
const shot = await (await fetch("/shot.json")).json();
const { camera, lights } = shot;
viewer.shot = { camera, lights };
while (!viewer.loaded) {
  const message = viewer.shadowRoot.querySelector("[role=alert]").textContent;
  if (message) throw new Error(message);
  await new Promise((later) => setTimeout(later, 20));
}
const loadedAt = performance.now();
await device.queue.onSubmittedWorkDone();
const litAt = performance.now();

/** Milliseconds from a change to the end of the GPU's work on the frame that shows it. */
async function timed(change) {
  const before = viewer.stats().frames;
  const start = performance.now();
  change();
  while (viewer.stats().frames === before) await new Promise(requestAnimationFrame);
  await device.queue.onSubmittedWorkDone();
  return performance.now() - start;
}

const moved = (shift) => {
  const [x, y, z] = lights[0].position;
  return [{ ...lights[0], position: [x + shift, y, z] }, ...lights.slice(1)];
};

/** Waits for the whole picture: a sketch is followed by the picture that it stands for; then nothing is drawn. */
async function rest() {
  let frames;
  do {
    frames = viewer.stats().frames;
    for (let i = 0; i < 3; i += 1) await new Promise(requestAnimationFrame);
    await device.queue.onSubmittedWorkDone();
  } while (viewer.stats().frames !== frames);
}

window.bench = {
  loadedAt,
  litAt,
  /** A frame with the light moved. */
  frame: (shift) => timed(() => (viewer.lights = moved(shift))),
  /** A frame with the camera moved and the light as it is. */
  turn(shift) {
    const [x, y, z] = camera.position;
    return timed(() => (viewer.camera = { ...camera, position: [x, y + shift, z] }));
  },
  async indirect(width, height, way = "auto") {
    viewer.display = way;
    viewer.shot = { camera, lights };
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    return Array.from(await viewer.readIndirect(width, height));
  },
  /** The whole picture, once the view stands still: what the GPU counted for it, and bytes that it holds. */
  async still() {
    viewer.shot = { camera, lights };
    await rest();
    const counts = await viewer.counts();
    return { counts, bytes: Object.values(viewer.stats().bytes).reduce((sum, some) => sum + some, 0) };
  },
  /** What it took to fill the pixels' slots in this way, in the whole picture of a new view: milliseconds by pass; and a
   * frame with the light moved. */
  async way(name, shift) {
    viewer.display = name;
    const [x, y, z] = camera.position;
    viewer.shot = { camera: { ...camera, position: [x, y + shift, z] }, lights };
    await rest();
    const light = await timed(() => (viewer.lights = moved(-shift)));
    await rest();
    const { adapter, display, milliseconds } = viewer.stats();
    return { adapter, display, find: milliseconds.find, gather: milliseconds.gather, light };
  },
  /** Frames under an environment, in turns: with that turned, and with the lamp moved. The first of each is for pipelines
   * and buffers. */
  async sky(rounds) {
    viewer.shot = { camera, lights };
    viewer.environment = "/sky.hdr";
    const sky = () => viewer.lights.filter(({ type }) => type === "environment");
    while (sky().length === 0) await new Promise((later) => setTimeout(later, 20));
    const times = { sky: [], lamp: [] };
    for (let round = 0; round <= rounds; round += 1) {
      await rest();
      const turned = await timed(() => (viewer.environmentRotation = 37 * (round + 1)));
      await rest();
      const lamp = await timed(() => (viewer.lights = [...moved(0.05 * (round + 1)), ...sky()]));
      if (round > 0) [turned, lamp].forEach((time, i) => times[["sky", "lamp"][i]].push(time));
    }
    return times;
  },
  /** Frames of an animation that goes on, a few by the operator alone and a few with what antiradiance adds, in turns:
   * milliseconds. The first after each turn is left out. */
  async walk(rounds) {
    viewer.shot = shot;
    viewer.solver = "antiradiance";
    while (viewer.stats().solver !== "antiradiance") await new Promise(requestAnimationFrame);
    const times = { operator: [], antiradiance: [] };
    let time = shot.time;
    for (let round = 0; round < rounds; round += 1) {
      for (const solver of Object.keys(times)) {
        viewer.solver = solver;
        for (let frame = 0; frame <= 4; frame += 1) {
          time += 1 / 30;
          const took = await timed(() => (viewer.currentTime = time));
          if (frame > 0) times[solver].push(took);
        }
      }
    }
    return { times, stats: viewer.stats() };
  },
  /** Steps of antiradiance: seconds until its links are there, and of some frames the steps and the milliseconds of their
   * passes. */
  async solve(rounds) {
    await rest();
    const start = performance.now();
    viewer.solver = "antiradiance";
    while (viewer.stats().solver !== "antiradiance") await new Promise(requestAnimationFrame);
    const linked = (performance.now() - start) / 1000;
    // The first frame after a change has a slice of a step; twenty steps follow.
    await timed(() => (viewer.lights = viewer.lights.map((light) => ({ ...light, intensity: light.intensity * 1.1 }))));
    const frames = [];
    for (let round = 0; round < rounds; round += 1) {
      const before = viewer.stats().antiradiance.iterations;
      await timed(() => {});
      const { antiradiance, milliseconds } = viewer.stats();
      frames.push({ steps: antiradiance.iterations - before, milliseconds: milliseconds.antiradiance });
    }
    return { linked, frames, stats: viewer.stats() };
  },
  stats: () => viewer.stats(),
};
