/**
 * `<rebounce-viewer src="room.rbn">`: a baked scene, lit anew in every frame.
 *
 * The README of the npm package lists attributes, properties, methods and events.
 */

import { download } from "./download.js";
import { Failure, failureOf, isFatal, sentence } from "./failure.js";
import { listen } from "./input.js";
import { createViewer, type Viewer } from "./module.js";
import { OnScreen } from "./onscreen.js";
import { Panel, type Stats } from "./panel.js";
import type { Camera, Light, Shot } from "./shot.js";
import { style } from "./style.js";

export type { Camera, DirectionalLight, Light, PointLight, Shot, SpotLight, Triple } from "./shot.js";
export type { Stats } from "./panel.js";

/** Which light is shown. */
export type Mode = "all" | "direct" | "indirect";
/** What is drawn over the picture. */
export type Overlay = "none" | "points" | "levels";

/** Details of the events, by name. */
export interface RebounceEventMap {
  /** The file is loaded and its first frame drawn. */
  load: CustomEvent<{ url: string }>;
  /** More of the file has come; `total` and `ratio` are 0 while the length is not known. */
  progress: CustomEvent<{ loaded: number; total: number; ratio: number }>;
  /** Something failed; the message is shown in the element too. */
  error: CustomEvent<{ code: string; message: string }>;
  /** The camera has changed, by hand or by script. */
  "camera-change": CustomEvent<{ camera: Camera }>;
  /** The lights have changed, by hand or by script. */
  "light-change": CustomEvent<{ lights: Light[] }>;
}

const MODES: readonly string[] = ["all", "direct", "indirect"];
const OVERLAYS: readonly string[] = ["none", "points", "levels"];
/** More device pixels per CSS pixel than this cost time and show little. */
const MAX_PIXEL_RATIO = 2;

/** The custom element. */
export class RebounceViewer extends HTMLElement {
  static readonly observedAttributes = ["src", "alt", "poster", "exposure", "mode", "overlay", "controls", "loading"];

  #canvas = document.createElement("canvas");
  #poster = document.createElement("img");
  #bar = document.createElement("div");
  #message = document.createElement("div");
  #panel = new Panel(this);

  #viewer: Viewer | undefined;
  /** Ends what belongs to the present canvas and viewer. */
  #session: AbortController | undefined;
  /** Ends the present download; each load has its own. */
  #loading: AbortController | undefined;
  #loaded = false;
  /** The file is not loaded before the element comes into view. */
  #waits = false;
  #frame = 0;
  #pending: { shot?: Shot; camera?: Camera; lights?: Light[] } = {};
  #cameraJson = "";
  #lightsJson = "";
  #onScreen = new OnScreen(this, () => this.#appear());
  #resizing = new ResizeObserver((entries) => this.#resize(entries[entries.length - 1]));

  constructor() {
    super();
    const shadow = this.attachShadow({ mode: "open", delegatesFocus: true });
    shadow.adoptedStyleSheets = [style()];
    this.#poster.className = "poster";
    this.#poster.alt = "";
    this.#bar.className = "bar";
    this.#bar.setAttribute("role", "progressbar");
    this.#bar.setAttribute("aria-label", "Loading");
    this.#bar.append(document.createElement("div"));
    this.#message.className = "message";
    this.#message.setAttribute("role", "alert");
    this.#poster.hidden = this.#bar.hidden = this.#message.hidden = this.#panel.element.hidden = true;
    shadow.append(this.#canvas, this.#poster, this.#bar, this.#panel.element, this.#message);
    this.#dressCanvas();
  }

  // ---- attributes as properties

  /** The .rbn file's address, relative to the page. */
  get src(): string {
    const src = this.getAttribute("src");
    return src ? new URL(src, this.baseURI).href : "";
  }
  set src(value: string) {
    this.setAttribute("src", value);
  }

  /** What the picture shows, for those who do not see it. */
  get alt(): string {
    return this.getAttribute("alt") ?? "";
  }
  set alt(value: string) {
    this.setAttribute("alt", value);
  }

  /** A picture that is shown until the scene is there. */
  get poster(): string {
    return this.getAttribute("poster") ?? "";
  }
  set poster(value: string) {
    this.setAttribute("poster", value);
  }

  /** Stops on top of the automatic exposure. */
  get exposure(): number {
    const stops = Number(this.getAttribute("exposure") ?? 0);
    return Number.isFinite(stops) ? Math.min(Math.max(stops, -20), 20) : 0;
  }
  set exposure(stops: number) {
    this.setAttribute("exposure", String(stops));
  }

  /** Which light is shown. */
  get mode(): Mode {
    return among(MODES, this.getAttribute("mode")) as Mode;
  }
  set mode(mode: Mode) {
    this.setAttribute("mode", mode);
  }

  /** What is drawn over the picture. */
  get overlay(): Overlay {
    return among(OVERLAYS, this.getAttribute("overlay")) as Overlay;
  }
  set overlay(overlay: Overlay) {
    this.setAttribute("overlay", overlay);
  }

  /** Whether the file is loaded at once, or only when the element comes near the visible part of the page. */
  get loading(): "eager" | "lazy" {
    return this.getAttribute("loading") === "lazy" ? "lazy" : "eager";
  }
  set loading(when: "eager" | "lazy") {
    this.setAttribute("loading", when);
  }

  /** Whether the small panel is offered. */
  get controls(): boolean {
    return this.hasAttribute("controls");
  }
  set controls(on: boolean) {
    this.toggleAttribute("controls", on);
  }

  // ---- the scene

  /** Whether a scene is loaded. */
  get loaded(): boolean {
    return this.#loaded;
  }

  /** The camera; set before the file is loaded, it takes effect then. */
  get camera(): Camera | undefined {
    if (!this.#ready()) return this.#pending.camera ?? this.#pending.shot?.camera;
    return JSON.parse(this.#use((viewer) => viewer.cameraJson())) as Camera;
  }
  set camera(camera: Camera) {
    if (this.#ready()) this.#use((viewer) => viewer.setCameraJson(JSON.stringify(camera)));
    else this.#pending.camera = camera;
  }

  /** The lights; set before the file is loaded, they take effect then. */
  get lights(): Light[] {
    if (!this.#ready()) return this.#pending.lights ?? this.#pending.shot?.lights ?? [];
    return JSON.parse(this.#use((viewer) => viewer.lightsJson())) as Light[];
  }
  set lights(lights: Light[]) {
    if (this.#ready()) this.#use((viewer) => viewer.setLightsJson(JSON.stringify(lights)));
    else this.#pending.lights = lights;
  }

  /** Camera and lights together, as SHOT.json holds them. */
  get shot(): Shot | undefined {
    if (!this.#ready()) return this.#pending.shot;
    return JSON.parse(this.#use((viewer) => viewer.shotJson())) as Shot;
  }
  set shot(shot: Shot) {
    if (this.#ready()) this.#use((viewer) => viewer.setShotJson(JSON.stringify(shot)));
    else this.#pending = { shot };
  }

  /** Times, counts, bytes and the adapter; nothing while no scene is loaded. */
  stats(): Stats | undefined {
    if (!this.#ready()) return undefined;
    return JSON.parse(this.#use((viewer) => viewer.statsJson())) as Stats;
  }

  /**
   * The indirect light of the present camera and lights: linear radiance, RGBA floats, rows from the
   * top; alpha is 1 where there is a surface. Rejects with a `code` where no scene is loaded.
   */
  async readIndirect(width: number, height: number): Promise<Float32Array> {
    return await this.#read((viewer) => viewer.readIndirect(width, height));
  }

  /** The tone-mapped picture: RGBA bytes, rows from the top. */
  async readPixels(width: number, height: number): Promise<Uint8Array> {
    return await this.#read((viewer) => viewer.readPixels(width, height));
  }

  /** The picture as an image file of the element's size in device pixels. */
  async toBlob(type = "image/png", quality?: number): Promise<Blob> {
    const { width, height } = this.#canvas;
    const pixels = await this.readPixels(width, height);
    const canvas = new OffscreenCanvas(width, height);
    const image = new ImageData(new Uint8ClampedArray(pixels), width, height);
    canvas.getContext("2d")?.putImageData(image, 0, 0);
    return canvas.convertToBlob(quality === undefined ? { type } : { type, quality });
  }

  /** Loads the file of `src` once more, after a failure for instance. */
  reload(): void {
    void this.#load();
  }

  /** Frees the GPU's memory. The element stays empty until `src` is set or `reload()` is called. */
  dispose(): void {
    this.#waits = false;
    this.#stopLoading();
    this.#bar.hidden = true;
    this.#end();
  }

  // ---- life

  /** @internal */
  connectedCallback(): void {
    this.#resizing.observe(this);
    this.#onScreen.watch();
    if (!this.#loaded && !this.#loading) this.#loadInTime();
    else this.#wantFrame();
  }

  /** @internal */
  disconnectedCallback(): void {
    // An element that is only moved is back before the next microtask.
    queueMicrotask(() => {
      if (this.isConnected) return;
      this.#resizing.disconnect();
      this.#onScreen.stop();
      this.dispose();
    });
  }

  /** @internal */
  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (before === value && name !== "src") return;
    switch (name) {
      case "src":
        this.#stopLoading();
        this.#bar.hidden = true;
        if (this.isConnected) this.#loadInTime();
        break;
      case "loading":
        if (this.isConnected && this.#waits) this.#loadInTime();
        break;
      case "alt":
        this.#canvas.setAttribute("aria-label", this.#label());
        break;
      case "poster":
        if (value) this.#poster.src = value;
        this.#poster.hidden = !value || this.#loaded;
        break;
      case "controls":
        this.#panel.element.hidden = value === null || !this.#loaded;
        break;
      default:
        this.#applySettings();
    }
  }

  #stopLoading(): void {
    this.#loading?.abort();
    this.#loading = undefined;
  }

  /** Loads now, or, with `loading="lazy"`, when the element comes into view. */
  #loadInTime(): void {
    this.#waits = this.hasAttribute("src") && this.loading === "lazy" && !this.#onScreen.visible;
    if (this.hasAttribute("src") && !this.#waits) void this.#load();
  }

  /** The element comes into view: loads what it waited with, or draws what has changed meanwhile. */
  #appear(): void {
    if (this.#waits) this.#loadInTime();
    this.#wantFrame();
  }

  /** Gets a viewer and the file, one beside the other, and shows the scene. Never rejects. */
  async #load(): Promise<void> {
    this.#stopLoading();
    this.#waits = false;
    this.#message.hidden = true;
    this.#message.replaceChildren();
    if (!this.getAttribute("src")) return;
    const loading = new AbortController();
    this.#loading = loading;
    try {
      const url = this.src;
      this.#setProgress(0, 0);
      const bytes = download(url, loading.signal, (loaded, total) => this.#setProgress(loaded, total));
      // If the viewer fails first, nobody waits for the file any more.
      bytes.catch(() => undefined);
      const viewer = await this.#getViewer();
      const file = await bytes;
      loading.signal.throwIfAborted();
      await viewer.load(file);
      loading.signal.throwIfAborted();
      this.#show(url, file.length);
    } catch (error) {
      if (this.#loading === loading) this.#fail(failureOf(error));
    } finally {
      loading.abort();
      if (this.#loading === loading) this.#loading = undefined;
    }
  }

  #show(url: string, size: number): void {
    this.#loaded = true;
    const pending = this.#pending;
    this.#pending = {};
    this.#use((viewer) => {
      if (pending.shot) viewer.setShotJson(JSON.stringify(pending.shot));
      if (pending.camera) viewer.setCameraJson(JSON.stringify(pending.camera));
      if (pending.lights) viewer.setLightsJson(JSON.stringify(pending.lights));
    });
    this.#applySettings();
    this.#bar.hidden = true;
    this.#poster.hidden = true;
    this.#canvas.classList.add("shown");
    this.#panel.element.hidden = !this.controls;
    this.#resize();
    this.#draw(performance.now());
    if (!this.#loaded) return; // The first frame failed, and said so.
    this.#tell("progress", { loaded: size, total: size, ratio: 1 });
    this.#tell("load", { url });
  }

  /** The present viewer, or a new one on a new canvas. */
  async #getViewer(): Promise<Viewer> {
    if (this.#viewer) return this.#viewer;
    this.#end();
    const session = new AbortController();
    this.#session = session;
    const viewer = await createViewer(this.#canvas);
    if (session.signal.aborted) {
      viewer.dispose();
      throw new DOMException("the element was removed", "AbortError");
    }
    this.#viewer = viewer;
    viewer.onchange = () => this.#wantFrame();
    viewer.ondevicelost = (message: string) => {
      if (this.#viewer === viewer) this.#fail(new Failure("device-lost", message));
    };
    listen(this.#canvas, (use) => this.#loaded && this.#try(() => this.#use(use)), session.signal);
    // A fault inside the wasm that no call of ours is waiting for.
    const stray = (event: Event, error: unknown) => {
      if ((error as { code?: unknown } | null)?.code !== "internal" && !(error instanceof WebAssembly.RuntimeError)) return;
      event.preventDefault();
      this.#fail(failureOf(error));
    };
    const { signal } = session;
    window.addEventListener("error", (event) => stray(event, event.error), { signal });
    window.addEventListener("unhandledrejection", (event) => stray(event, event.reason), { signal });
    return viewer;
  }

  /** Lets go of the viewer, and puts a fresh canvas in place of the one it drew on. */
  #end(): void {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    this.#loaded = false;
    this.#session?.abort();
    this.#session = undefined;
    const viewer = this.#viewer;
    this.#viewer = undefined;
    this.#cameraJson = this.#lightsJson = "";
    this.#panel.element.hidden = true;
    this.#poster.hidden = !this.poster;
    if (!viewer) return;
    try {
      viewer.onchange = undefined;
      viewer.ondevicelost = undefined;
      viewer.dispose();
      viewer.free();
    } catch {
      // After a fault in the wasm there is nothing left to free.
    }
    const canvas = document.createElement("canvas");
    this.#canvas.replaceWith(canvas);
    this.#canvas = canvas;
    this.#dressCanvas();
  }

  #fail(failure: Failure): void {
    const message = sentence(failure.message);
    this.#stopLoading();
    if (isFatal(failure.code)) this.#end();
    this.#loaded = false;
    this.#bar.hidden = true;
    this.#poster.hidden = true;
    this.#panel.element.hidden = true;
    this.#canvas.classList.remove("shown");
    const text = document.createElement("p");
    text.textContent = message;
    const again = document.createElement("button");
    again.type = "button";
    again.textContent = "Try again";
    again.addEventListener("click", () => this.reload());
    this.#message.hidden = false;
    this.#message.replaceChildren(text, again);
    this.#tell("error", { code: failure.code, message });
  }

  // ---- drawing

  #wantFrame(): void {
    if (this.#frame || !this.#ready() || !this.isConnected || this.#onScreen.hidden) return;
    this.#frame = requestAnimationFrame((now) => {
      this.#frame = 0;
      if (!this.#onScreen.hidden) this.#draw(now);
    });
  }

  #draw(now: number): void {
    this.#try(() => {
      const more = this.#use((viewer) => viewer.frame(now));
      this.#announce();
      if (more) this.#wantFrame();
    });
  }

  /** Tells of a camera or lights that are no longer what they were. */
  #announce(): void {
    const { camera, lights } = this.#use((viewer) => ({ camera: viewer.cameraJson(), lights: viewer.lightsJson() }));
    const cameraMoved = this.#cameraJson !== "" && this.#cameraJson !== camera;
    const lightsMoved = this.#lightsJson !== "" && this.#lightsJson !== lights;
    this.#cameraJson = camera;
    this.#lightsJson = lights;
    if (cameraMoved) this.#tell("camera-change", { camera: JSON.parse(camera) as Camera });
    if (lightsMoved) this.#tell("light-change", { lights: JSON.parse(lights) as Light[] });
    if (this.controls) this.#panel.update();
  }

  #applySettings(): void {
    if (!this.#ready()) return;
    const { exposure, mode, overlay } = this;
    this.#try(() =>
      this.#use((viewer) => {
        viewer.exposure = exposure;
        viewer.mode = mode;
        viewer.overlay = overlay;
      }),
    );
    this.#panel.update();
  }

  #resize(entry?: ResizeObserverEntry): void {
    const ratio = Math.min(window.devicePixelRatio || 1, MAX_PIXEL_RATIO);
    const box = entry?.contentRect ?? this.getBoundingClientRect();
    const width = Math.max(1, Math.round(box.width * ratio));
    const height = Math.max(1, Math.round(box.height * ratio));
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
    if (!this.#ready()) return;
    this.#try(() => this.#use((viewer) => viewer.resize(width, height)));
    this.#wantFrame();
  }

  // ---- small things

  #ready(): boolean {
    return this.#loaded && this.#viewer !== undefined;
  }

  #use<T>(work: (viewer: Viewer) => T): T {
    if (!this.#viewer) throw new Failure("no-scene", "No scene is loaded.");
    return work(this.#viewer);
  }

  /** For work that no caller waits for: what it throws is shown and told. */
  #try(work: () => void): void {
    try {
      work();
    } catch (error) {
      this.#fail(failureOf(error));
    }
  }

  async #read<T>(work: (viewer: Viewer) => Promise<T>): Promise<T> {
    if (!this.#ready()) throw new Failure("no-scene", "No scene is loaded; wait for the load event.");
    try {
      return await this.#use(work);
    } catch (error) {
      throw failureOf(error);
    }
  }

  #setProgress(loaded: number, total: number): void {
    const ratio = total ? Math.min(loaded / total, 1) : 0;
    this.#bar.hidden = false;
    this.#bar.setAttribute("aria-valuenow", String(Math.round(ratio * 100)));
    (this.#bar.firstElementChild as HTMLElement).style.width = `${ratio * 100}%`;
    this.#tell("progress", { loaded, total, ratio });
  }

  #label(): string {
    return `${this.alt || "3D scene"}. Drag to look around; W, A, S, D and the arrow keys move.`;
  }

  #dressCanvas(): void {
    this.#canvas.tabIndex = 0;
    this.#canvas.setAttribute("role", "img");
    this.#canvas.setAttribute("aria-label", this.#label());
    this.#canvas.setAttribute("part", "canvas");
  }

  #tell<K extends keyof RebounceEventMap>(type: K, detail: RebounceEventMap[K]["detail"]): void {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}

function among(values: readonly string[], value: string | null): string {
  return value !== null && values.includes(value) ? value : (values[0] ?? "");
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

if (!customElements.get("rebounce-viewer")) customElements.define("rebounce-viewer", RebounceViewer);
