/** The life of the viewer behind the element: it is made, given a file, drawn with, and let go. */

import { checkedAnimations, type LightAnimation } from "../animation/animation.js";
import type { SceneFiles } from "../bake/scene.js";
import { Changes } from "./changes.js";
import { download } from "./download.js";
import { Environment } from "./environment.js";
import { calm } from "../element/element.js";
import { tell } from "../element/events.js";
import { Failure, failureOf, isFatal, sentence, unsupported, wanted } from "../wire/failure.js";
import { History } from "./history.js";
import { Losses } from "./losses.js";
import { wantsRadiosity, type Viewer } from "./module.js";
import { gestures } from "../input/gesture.js";
import { OnScreen } from "../element/onscreen.js";
import { PanelSlot } from "../panel/slot.js";
import { applyAttributes, handOver, type Pending } from "./pending.js";
import { Player } from "../animation/player.js";
import type { RebounceViewer } from "../rebounce-viewer.js";
import { closeViewer, openViewer, surfaceIn, type SessionHost } from "./session.js";
import { Size } from "../element/size.js";
import { restoreState } from "../element/state.js";
import { Tree } from "../element/tree.js";
import { begin, lightsIn, setLights, shotIn } from "../wire/wire.js";

/** One element's engine. */
export class Engine {
  readonly tree: Tree;
  readonly player: Player;
  readonly history: History;
  readonly environment: Environment;
  /** The file that was baked in the page. */
  baked: Uint8Array | undefined;
  /** The files in place of `src`'s, by path. */
  #files: SceneFiles | undefined;
  /** The view that a scene or shot began with. */
  first: Pending["camera"];
  pending: Pending = {};
  #element: RebounceViewer;
  #viewer: Viewer | undefined;
  /** Whether it shows files whose bounced light comes not from links alone, too. */
  #radiosity = false;
  #panel: PanelSlot;
  #changes = new Changes();
  /** Ends what belongs to the present canvas and viewer. */
  #session: AbortController | undefined;
  /** Ends the present download; each load has its own. */
  #loading: AbortController | undefined;
  #loaded = false;
  /** The file is not loaded before the element comes into view. */
  #waits = false;
  /** The device was lost, and what was shown is to come back as it was, without a word. */
  #returning = false;
  #kept: Pending | undefined; // What of it waits in `pending`.
  #losses = new Losses();
  #frame = 0;
  #onScreen: OnScreen;
  #size: Size;

  constructor(element: RebounceViewer) {
    this.#element = element;
    this.tree = new Tree(element);
    this.tree.renewCanvas();
    this.relabel();
    // A click on what is only a picture is nobody's: it does not give the panel the focus.
    element.addEventListener("mousedown", (event) => {
      if (element.interaction === "none" && event.composedPath()[0] === element) event.preventDefault();
    });
    this.#onScreen = new OnScreen(element, () => this.#appear());
    this.#size = new Size(element, (width, height) => this.#resize(width, height));
    this.player = new Player({
      readLights: () => (this.ready ? this.use(lightsIn) : undefined),
      writeLights: (lights) => this.use((viewer) => setLights(viewer, lights)),
      moving: () => (this.ready ? this.use(({ moving }) => moving) : undefined),
      animationName: () => element.animationName,
      tell: (type, detail) => tell(element, type, detail),
      wantFrame: () => this.wantFrame(),
    });
    this.environment = new Environment({
      element,
      withViewer: (work) => this.withScene(work),
      warn: (failure) => this.#warn(failure),
      changed: () => this.#panel.update(),
    });
    const history = (this.history = new History(element, this.tree.root, this.player, () => this.#panel.update()));
    const surfaceAt = (x: number, y: number) => this.use((viewer) => surfaceIn(viewer, this.tree.canvas, x, y));
    const sunlight = () => this.use((viewer) => viewer.sunlight());
    this.#panel = new PanelSlot({ host: element, root: this.tree.root, history, surfaceAt, sunlight }, this.tree);
  }

  /** Whether there is a scene. */
  get ready(): boolean {
    return this.#loaded && this.#viewer !== undefined;
  }

  // ---- life

  /** The element is in a page. */
  begin(): void {
    this.#size.watch();
    this.#onScreen.watch();
    if (!this.#loaded && !this.#loading) this.loadInTime();
    else this.wantFrame();
  }

  /** The element is in none. */
  rest(): void {
    this.#size.stop();
    this.#onScreen.stop();
    this.dispose();
  }

  /** Frees the GPU's memory. */
  dispose(): void {
    this.#waits = false;
    this.stopLoading();
    this.#forgetReturn();
    this.#end();
  }

  /** `src` has changed. */
  changeSource(): void {
    this.#files = undefined;
    this.stopLoading();
    this.#forgetReturn();
    if (this.#element.isConnected) this.loadInTime();
  }

  /** Shows other files than `src`'s. */
  open(files: SceneFiles): void {
    this.#files = files;
    this.reload();
  }

  /** Takes files that are dropped, where the element says so. */
  acceptDrops(): void {
    const warn = (failure: Failure) => this.#warn(failure);
    wanted(import("../bake/drop.js"), "baker").then(({ acceptDrops }) => acceptDrops(this.#element, (files) => this.open(files), warn), warn);
  }

  /** Loads the file once more. */
  reload(): void {
    this.#forgetReturn();
    void this.load();
  }

  /** What was kept of a lost scene does not come back. */
  #forgetReturn(): void {
    if (this.pending === this.#kept) this.pending = {};
    this.#kept = undefined;
    this.#returning = false;
  }

  /** Ends a download or a bake; what a bake has shown stays. */
  stopLoading(): void {
    this.#loading?.abort();
    this.#loading = undefined;
    this.tree.setProgress();
  }

  /** Loads now, or, with `loading="lazy"`, when the element comes into view. */
  loadInTime(): void {
    this.#waits = this.#element.loading === "lazy" && !this.#onScreen.visible;
    if (!this.#waits) void this.load();
  }

  /** `loading` has changed. */
  reconsider(): void {
    if (this.#waits) this.loadInTime();
  }

  /** The element comes into view: loads what it waited with, or draws what has changed meanwhile. */
  #appear(): void {
    this.reconsider();
    this.wantFrame();
  }

  /** Gets a viewer and the file, one beside the other, and shows the scene. Never rejects. */
  async load(): Promise<void> {
    this.stopLoading();
    this.#waits = false;
    this.tree.setMessage();
    const [element, files] = [this.#element, this.#files];
    if (!element.getAttribute("src") && !files) return;
    const loading = new AbortController();
    const { signal } = (this.#loading = loading);
    const url = element.src;
    let shown = false;
    // It is made beside the download or the bake.
    let viewerMade = this.#getViewer();
    // If the file fails first, nobody waits for the viewer any more.
    viewerMade.catch(() => undefined);
    const show = async (bytes: Uint8Array | Promise<Uint8Array>) => {
      const file = await bytes;
      signal.throwIfAborted();
      if (!this.#radiosity && wantsRadiosity(file)) {
        this.#radiosity = true;
        this.#end();
        viewerMade = this.#getViewer();
      }
      const viewer = await viewerMade;
      signal.throwIfAborted();
      // The view of a preview stays.
      if (shown) this.#keep();
      await viewer.load(file);
      begin(viewer);
      signal.throwIfAborted();
      this.#show(url, file.length);
      shown = true;
    };
    try {
      this.#setProgress(0, 0);
      const kept = (this.baked = this.#returning ? this.baked : undefined);
      if (kept) await show(kept);
      else if (!files && !/\.gl(b|tf)$/i.test(new URL(url).pathname)) {
        await show(download(url, signal, (loaded, total) => this.#setProgress(loaded, total)));
      } else {
        const { bakeInto } = await wanted(import("../bake/element.js"), "baker");
        await bakeInto({ element, files, signal, show, setProgress: (ratio) => this.tree.setProgress(ratio), keep: (file) => (this.baked = file) });
      }
    } catch (error) {
      const failure = failureOf(error);
      if (this.#loading !== loading) return;
      if (shown && !isFatal(failure.code)) {
        this.tree.setProgress();
        this.#warn(failure);
      } else this.#failOrReturn(failure);
    } finally {
      loading.abort();
      if (this.#loading === loading) this.#loading = undefined;
    }
  }

  #show(url: string, size: number): void {
    this.#loaded = true;
    const { pending } = this;
    const returns = this.#returning;
    this.pending = {};
    this.#kept = undefined;
    this.#returning = false;
    if (!returns) this.history.clear();
    if (!returns) this.followLink();
    this.withScene((viewer) => handOver(viewer, pending));
    this.withScene((viewer) => this.environment.show(viewer, !returns));
    if (!this.#loaded) return; // A fault, which was told.
    this.use((viewer) => {
      const animations = pending.animations ?? this.#ownAnimations(viewer);
      // Those that come back with the scene go on.
      if (animations !== this.player.animations) this.player.set(animations);
    });
    if (!returns) this.first = this.#element.camera;
    this.applySettings();
    this.tree.setProgress();
    this.tree.showPoster(false);
    this.tree.showPicture(true);
    this.showPanel();
    this.#size.measure();
    this.#draw(performance.now());
    if (!this.#loaded) return; // The first frame failed, and said so.
    if (!returns) {
      tell(this.#element, "progress", { loaded: size, total: size, ratio: 1 });
      tell(this.#element, "load", { url });
    }
    if (pending.repetitions !== undefined) this.player.play(pending.repetitions);
    else if (!returns) this.autoplay();
  }

  /** The file's; what cannot be used is told of. */
  #ownAnimations(viewer: Viewer): LightAnimation[] {
    try {
      return checkedAnimations(viewer.animations());
    } catch (error) {
      this.#warn(failureOf(error));
      return [];
    }
  }

  /** Begins to play where the element asks for it and the user does not mind. */
  autoplay(): void {
    if (this.#element.autoplay && this.player.paused && !calm()) this.player.play();
  }

  /** The present viewer, or a new one on a new canvas. */
  async #getViewer(): Promise<Viewer> {
    if (this.#viewer) return this.#viewer;
    this.#end();
    const { signal } = (this.#session = new AbortController());
    const host: SessionHost = {
      changed: () => this.wantFrame(),
      failed: (failure) => this.#failOrReturn(failure),
      linked: () => this.followLink(),
      withViewer: (use) => this.withScene(use),
      interaction: () => this.#element.interaction,
      gesture: gestures((began) => this.ready && this.history.gesture(began)),
      reset: () => this.#element.resetView(),
    };
    const viewer = await openViewer(this.tree.canvas, host, signal, this.#radiosity);
    if (signal.aborted) {
      closeViewer(viewer);
      throw new DOMException("the element was removed", "AbortError");
    }
    return (this.#viewer = viewer);
  }

  /** Lets go of the viewer, and puts a fresh canvas in place of the one it drew on. */
  #end(): void {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    if (!this.#returning) this.player.pause();
    this.#loaded = false;
    this.#session?.abort();
    const viewer = this.#viewer;
    this.#viewer = this.#session = undefined;
    this.#changes.forget();
    this.showPanel();
    this.tree.showPoster(true);
    if (!viewer) return;
    closeViewer(viewer);
    this.tree.renewCanvas();
    this.relabel();
  }

  /** A lost device is no failure as long as another one takes its place. */
  #failOrReturn(failure: Failure): void {
    if (failure.code === "device-lost" && this.#losses.next()) this.#return();
    else this.#fail(failure);
  }

  /** Loads the file onto a new device and shows what was shown. */
  #return(): void {
    // While another file is on its way, that one is wanted.
    if (this.ready && !this.#loading) this.#keep();
    this.stopLoading();
    this.#end();
    this.#waits = this.#onScreen.hidden;
    if (!this.#waits) void this.load();
  }

  /** What is shown is to come back with the next file. */
  #keep(): void {
    const viewer = this.#viewer as Viewer;
    const { camera, lights, mix = [] } = shotIn(viewer);
    this.pending = this.#kept = { camera, lights, mix, animations: this.player.animations, measured: viewer.measured, moved: viewer.moving?.shot };
    this.#returning = true;
  }

  /** A failure that leaves no picture: it is shown and told. */
  #fail(failure: Failure): void {
    this.stopLoading();
    this.#returning = false;
    if (isFatal(failure.code)) this.#end();
    this.player.pause();
    this.#loaded = false;
    const words = unsupported(failure.code);
    this.tree.showPoster(!!words);
    this.tree.showPicture(false);
    this.showPanel();
    if (words) console.warn(`<rebounce-viewer>: ${sentence(failure.message)}`);
    this.tree.setMessage(words ?? sentence(failure.message), words ? undefined : () => void this.load());
    this.#warn(failure);
  }

  /** A failure that leaves the picture as it is: it is told. */
  #warn({ code, message }: Failure): void {
    tell(this.#element, "error", { code, message: sentence(message) });
  }

  // ---- drawing

  /** Asks for a frame, unless nobody would see it. */
  wantFrame(): void {
    if (this.#frame || !this.ready || !this.#element.isConnected || this.#onScreen.hidden) return;
    this.#frame = requestAnimationFrame((now) => {
      this.#frame = 0;
      // The scene may be gone by now: another file was asked for, and failed.
      if (this.ready && !this.#onScreen.hidden) this.#draw(now);
    });
  }

  #draw(now: number): void {
    try {
      this.player.advance(now);
    } catch (error) {
      this.player.pause();
      this.#warn(failureOf(error));
    }
    this.#try(() => {
      const more = this.use((viewer) => viewer.frame(now));
      this.use((viewer) => this.#changes.look(viewer, this.#element));
      this.tree.canvas.classList.toggle("inside", this.use((viewer) => viewer.inside));
      this.#panel.update();
      if (more || !this.player.paused) this.wantFrame();
    });
  }

  /** An attribute has changed. */
  applySettings(): void {
    if (!this.ready) return;
    this.#try(() => this.use((viewer) => applyAttributes(viewer, this.#element)));
    this.#panel.update();
  }

  #resize(width: number, height: number): void {
    const { canvas } = this.tree;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    if (!this.ready) return;
    this.#try(() => this.use((viewer) => viewer.resize(width, height)));
    this.wantFrame();
  }

  /** Takes over the state in the page's address where the element asks for it. */
  followLink(): void {
    if (!this.ready || !this.#element.stateInLink) return;
    try {
      restoreState(this.#element, location.href);
    } catch (error) {
      this.#warn(failureOf(error));
    }
  }

  /** Shows the panel where it is wanted, and hides it elsewhere. */
  showPanel(): void {
    this.#panel.show().catch((error: unknown) => this.#warn(failureOf(error)));
  }

  /** `alt` or `interaction` has changed. */
  relabel(): void {
    this.tree.setLabel(this.#element.alt, this.#element.interaction !== "none");
  }

  #setProgress(loaded: number, total: number): void {
    const ratio = total ? Math.min(loaded / total, 1) : 0;
    this.tree.setProgress(ratio);
    if (!this.#returning) tell(this.#element, "progress", { loaded, total, ratio });
  }

  /** Throws `no-scene` where there is none. */
  use<T>(work: (viewer: Viewer) => T): T {
    if (!this.#loaded || !this.#viewer) throw new Failure("no-scene", "No scene is loaded; wait for the load event.");
    const result = work(this.#viewer);
    // What changes while a finer file is on its way comes back with that.
    if (this.#kept) this.#keep();
    return result;
  }

  /** For work where there is a scene, that no caller waits for: what it throws is told, and the picture stays if it can. */
  withScene(work: (viewer: Viewer) => void): void {
    if (this.ready) this.#try(() => this.use(work), true);
  }

  /** For work that no caller waits for: what it throws is told, and shown unless the picture `stays`. */
  #try(work: () => void, stays = false): void {
    try {
      work();
    } catch (error) {
      const failure = failureOf(error);
      if (stays && !isFatal(failure.code)) this.#warn(failure);
      else this.#fail(failure);
    }
  }

  /** For work whose caller waits; rejects with a `Failure`. */
  async read<T>(work: (viewer: Viewer) => T | Promise<T>): Promise<T> {
    try {
      return await this.use(work);
    } catch (error) {
      throw failureOf(error);
    }
  }
}
