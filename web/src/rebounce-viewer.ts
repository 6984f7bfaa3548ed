/**
 * `<rebounce-viewer src="room.rbn">`: a baked scene, lit anew in every frame.
 *
 * The README of the npm package lists attributes, properties, methods and events.
 */

import { checkedAnimations, shifted, type LightAnimation } from "./animation/animation.js";
import { AttributeElement, warnOf } from "./element/attributes.js";
import { Engine } from "./engine/engine.js";
import type { RebounceEventMap } from "./element/events.js";
import { Failure } from "./wire/failure.js";
import type { PlayOptions } from "./animation/player.js";
import { mixIn, setMix } from "./wire/mix.js";
import type { Camera, Channel, Light, NamedCamera, Nodes, Shot } from "./wire/shot.js";
import { restoreState, stateLink } from "./element/state.js";
import type { Counts, Stats } from "./wire/stats.js";
import { cameraIn, cameraNumbers, camerasIn, countsIn, lightsIn, setLights, setShot, shotIn, statsIn } from "./wire/wire.js";

export type { AnimatedProperty, LightAnimation, LightTrack, NodeTrack, PoseTrack } from "./animation/animation.js";
export type { Backdrop, CameraControls, Display, Interaction, Mode, Overlay, SolverChoice, ToneMapping } from "./element/attributes.js";
export type { RebounceEventMap } from "./element/events.js";
export type { PlayOptions } from "./animation/player.js";
export type {
  Camera,
  Channel,
  DirectionalLight,
  DiskLight,
  EmissiveLight,
  EnvironmentLight,
  Light,
  NamedCamera,
  NodeMove,
  Nodes,
  PointLight,
  Quaternion,
  RectangleLight,
  SceneNode,
  Shot,
  SphereLight,
  SpotLight,
  Triple,
} from "./wire/shot.js";
export type { AntiradianceStats, Counts, Solver, Stats } from "./wire/stats.js";

/** How a picture is saved. */
export interface PictureOptions {
  /** Pixels; the element's in device pixels when absent. */
  width?: number;
  height?: number;
  /** Whether alpha is 0 where there is no surface. */
  transparent?: boolean;
}

/** The custom element. */
export class RebounceViewer extends AttributeElement {
  #engine = new Engine(this);

  // ---- the scene

  /** Whether a scene is loaded. */
  get loaded(): boolean {
    return this.#engine.ready;
  }

  /** The camera; set before the file is loaded, it takes effect then. */
  get camera(): Camera | undefined {
    const { ready, pending } = this.#engine;
    if (!ready) return pending.camera ?? pending.shot?.camera;
    return this.#engine.use(cameraIn);
  }
  set camera(camera: Camera) {
    if (this.loaded) this.#engine.use((viewer) => viewer.setCamera(cameraNumbers(camera)));
    else this.#engine.pending.camera = camera;
  }

  /** The file's own cameras. */
  get cameras(): NamedCamera[] {
    return this.loaded ? this.#engine.use(camerasIn) : [];
  }

  /** Brings the view back that the scene, or the last `shot`, began with. */
  resetView(): void {
    const engine = this.#engine;
    if (!this.loaded || !engine.first) return;
    engine.history.by(() => (this.camera = engine.first as Camera));
  }

  /** The lights; set before the file is loaded, they take effect then. */
  get lights(): Light[] {
    const { ready, pending } = this.#engine;
    if (!ready) return pending.lights ?? pending.shot?.lights ?? [];
    return this.#engine.use(lightsIn);
  }
  set lights(lights: Light[]) {
    if (this.loaded) this.#engine.use((viewer) => setLights(viewer, lights));
    else this.#engine.pending.lights = lights;
  }

  /**
   * The light mixer: a channel a light, in the lights' order, that makes it stronger, weaker, silent or alone. Lights
   * without a channel are as they are. Set before the file is loaded, it takes effect then.
   */
  get mix(): Channel[] {
    const { ready, pending } = this.#engine;
    if (!ready) return pending.mix ?? pending.shot?.mix ?? [];
    return this.#engine.use(mixIn);
  }
  set mix(mix: Channel[]) {
    if (this.loaded) this.#engine.use((viewer) => setMix(viewer, mix));
    else this.#engine.pending.mix = mix;
  }

  /** The nodes that may move, by their names; what is set of one moves it, and light follows. Nothing where none may. */
  get nodes(): Nodes {
    return this.loaded ? this.#engine.use((viewer) => viewer.moving?.nodes ?? {}) : {};
  }
  set nodes(nodes: Nodes) {
    const own = this.nodes;
    for (const name in nodes) Object.assign(own[name] ?? {}, nodes[name]);
  }

  /** Puts a light into the list, last or at a place; its place. Throws where no scene is loaded. */
  addLight(light: Light, index = Infinity): number {
    const lights = this.#sceneLights();
    const at = Math.min(Math.max(Math.trunc(index) || 0, 0), lights.length);
    const { mix } = this;
    if (at < mix.length) mix.splice(at, 0, {});
    lights.splice(at, 0, light);
    Object.assign(this, { lights, mix });
    if (this.selectedLight >= at) this.selectedLight += 1;
    this.#engine.player.animations = shifted(this.animations, at, 1);
    return at;
  }

  /** Takes a light out of the list, and its tracks out of the animations. */
  removeLight(index: number): Light {
    const lights = this.#sceneLights();
    const [light] = index >= 0 ? lights.splice(index, 1) : [];
    if (!light) throw new Failure("bad-argument", `There is no light ${index}; there are ${lights.length}, counted from 0.`);
    const { mix, selectedLight } = this;
    mix.splice(index, 1);
    Object.assign(this, { lights, mix });
    if (selectedLight >= index) this.selectedLight = selectedLight > index ? selectedLight - 1 : -1;
    this.#engine.player.animations = shifted(this.animations, index, -1);
    return light;
  }

  /** The light whose handle is under the pointer, or marked as if it were; -1 for none. */
  get hoveredLight(): number {
    return this.loaded ? this.#engine.use((viewer) => viewer.hoveredLight) : -1;
  }
  set hoveredLight(index: number) {
    if (this.loaded) this.#engine.use((viewer) => (viewer.hoveredLight = index));
  }

  /** The chosen light, which has a ring; -1 for none. */
  get selectedLight(): number {
    return this.loaded ? this.#engine.use((viewer) => viewer.selectedLight) : -1;
  }
  set selectedLight(index: number) {
    if (this.loaded) this.#engine.use((viewer) => (viewer.selectedLight = index));
  }

  #sceneLights(): Light[] {
    return this.#engine.use(lightsIn);
  }

  /** Camera and lights together, as SHOT.json holds them. */
  get shot(): Shot | undefined {
    if (!this.loaded) return this.#engine.pending.shot;
    const { width, height } = this.#engine.tree.canvas;
    return this.#engine.use((viewer) => ({ size: [width, height], ...shotIn(viewer) }));
  }
  set shot(shot: Shot) {
    const { animations, repetitions } = this.#engine.pending;
    if (this.loaded) {
      this.#engine.use((viewer) => setShot(viewer, shot));
      this.#engine.first = this.camera;
    } else this.#engine.pending = { shot, ...(animations && { animations }), ...(repetitions && { repetitions }) };
  }

  /** The page's address with camera, lights and settings in its hash. */
  stateLink(): string {
    return stateLink(this);
  }

  /** Takes over the state of a link, of the page's own where none is given; whether it held one. */
  restoreState(link = this.ownerDocument.URL): boolean {
    return restoreState(this, link);
  }

  /** Takes back what a hand has changed last, of lights, camera or settings; whether there was something. */
  undo(): boolean {
    return this.#engine.history.undo();
  }

  /** Does once more what `undo()` has taken back; whether there was something. */
  redo(): boolean {
    return this.#engine.history.redo();
  }

  // ---- animations

  /** Keyframes of lights: the file's own, or a script's. */
  get animations(): LightAnimation[] {
    const { ready, pending, player } = this.#engine;
    return ready ? player.animations : (pending.animations ?? []);
  }
  set animations(animations: LightAnimation[]) {
    const checked = checkedAnimations(animations);
    if (!this.loaded) {
      this.#engine.pending.animations = checked;
      return;
    }
    this.#engine.player.set(checked);
    this.#engine.autoplay();
  }

  /** Plays an animation from where it stands, or from the start once it is over. */
  play({ name, repetitions = Infinity }: PlayOptions = {}): void {
    if (name !== undefined) this.animationName = name;
    if (this.loaded) this.#engine.player.play(repetitions);
    else this.#engine.pending.repetitions = repetitions;
  }

  /** Stops the animation where it stands. */
  pause(): void {
    delete this.#engine.pending.repetitions;
    this.#engine.player.pause();
  }

  /** Whether no animation is playing. */
  get paused(): boolean {
    return this.#engine.player.paused;
  }

  /** Where the animation stands, seconds. */
  get currentTime(): number {
    return this.#engine.player.time;
  }
  set currentTime(seconds: number) {
    this.#engine.player.time = seconds;
  }

  /** How long the animation is, seconds; 0 where there is none. */
  get duration(): number {
    return this.#engine.player.duration;
  }

  // ---- reading

  /** Times, counts, bytes and the adapter; nothing while no scene is loaded. */
  stats(): Stats | undefined {
    if (!this.loaded) return undefined;
    return this.#engine.use(statsIn);
  }

  /** What the GPU counted for the present picture. Rejects where no scene is loaded. */
  async counts(): Promise<Counts> {
    return await this.#engine.read(countsIn);
  }

  /**
   * The indirect light of the present camera and lights: linear radiance, RGBA floats, rows from the
   * top; alpha is 1 where there is a surface. Rejects with a `code` where no scene is loaded.
   */
  async readIndirect(width: number, height: number): Promise<Float32Array> {
    return await this.#engine.read((viewer) => viewer.readIndirect(width, height));
  }

  /** The tone-mapped picture: RGBA bytes, rows from the top. */
  async readPixels(width: number, height: number): Promise<Uint8Array> {
    return await this.#engine.read((viewer) => viewer.readPixels(width, height));
  }

  /** The picture as an image file, of the element's size in device pixels where the options name no other. */
  async toBlob(type = "image/png", quality?: number, options: PictureOptions = {}): Promise<Blob> {
    const { canvas } = this.#engine.tree;
    const { width = canvas.width, height = canvas.height, transparent } = options;
    // Both begin at once: of one moment.
    const surfaces = transparent ? this.readIndirect(width, height) : undefined;
    const [pixels, light] = await Promise.all([this.readPixels(width, height), surfaces]);
    light?.forEach((share, i) => i % 4 === 3 && (pixels[i] = 255 * Math.min(share, 1)));
    const file = new OffscreenCanvas(width, height);
    const image = new ImageData(new Uint8ClampedArray(pixels), width, height);
    file.getContext("2d")?.putImageData(image, 0, 0);
    return file.convertToBlob(quality === undefined ? { type } : { type, quality });
  }

  // ---- life

  /** Opens files in place of `src`'s: a .rbn, or a .glb or a .gltf with its files, which is baked in the page. */
  open(...files: File[]): void {
    this.#engine.open(files);
  }

  /** Ends a bake in the page; the last preview stays. */
  cancel(): void {
    this.#engine.stopLoading();
  }

  /** The .rbn file that was baked in the page, to be saved; nothing before the bake is done. */
  toRbn(): Uint8Array | undefined {
    return this.#engine.baked;
  }

  /** Loads the file of `src` once more, after a failure for instance. */
  reload(): void {
    this.#engine.reload();
  }

  /** Frees the GPU's memory. The element stays empty until `src` is set or `reload()` is called. */
  dispose(): void {
    this.#engine.dispose();
  }

  /** @internal */
  connectedCallback(): void {
    this.#engine.begin();
  }

  /** @internal */
  disconnectedCallback(): void {
    // An element that is only moved is back before the next microtask.
    queueMicrotask(() => {
      if (!this.isConnected) this.#engine.rest();
    });
  }

  /** @internal */
  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (before === value && name !== "src") return;
    warnOf(name, value);
    const engine = this.#engine;
    switch (name) {
      case "src":
        engine.changeSource();
        break;
      case "drop":
        engine.acceptDrops();
        break;
      case "loading":
        if (this.isConnected) engine.reconsider();
        break;
      case "alt":
        engine.relabel();
        break;
      case "interaction":
        engine.relabel();
        engine.applySettings();
        break;
      case "environment":
      case "sky":
        void engine.environment.change();
        break;
      case "environment-rotation":
        engine.withScene((viewer) => engine.environment.turn(viewer));
        break;
      case "environment-intensity":
        engine.withScene((viewer) => engine.environment.dim(viewer));
        break;
      case "poster":
        engine.tree.setPoster(this.poster);
        break;
      case "width":
      case "height":
        engine.tree.setSize(this.width, this.height);
        break;
      case "controls":
        engine.showPanel();
        break;
      case "autoplay":
        if (value !== null) engine.autoplay();
        break;
      case "animation-name":
        engine.player.rewind();
        break;
      case "state-in-link":
        engine.followLink();
        break;
      default:
        engine.applySettings();
    }
  }
}

export interface RebounceViewer {
  addEventListener<K extends keyof RebounceEventMap>(
    type: K,
    listener: (this: RebounceViewer, event: RebounceEventMap[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener(
    type: string,
    listener: EventListenerOrEventListenerObject | null,
    options?: boolean | AddEventListenerOptions,
  ): void;
}

declare global {
  interface HTMLElementTagNameMap {
    "rebounce-viewer": RebounceViewer;
  }
}

// On a server there is nothing to define it in.
if (globalThis.customElements && !customElements.get("rebounce-viewer")) {
  customElements.define("rebounce-viewer", RebounceViewer);
}
