/** The element's attributes as properties. */

import { ElementBase } from "./element.js";

/** Which light is shown. */
export type Mode = "all" | "direct" | "indirect";
/** What is drawn over the picture. */
export type Overlay = "none" | "points" | "levels";
/** What computes bounced light: what suits the scene as it stands, the file's operator, radiosity, or antiradiance. */
export type SolverChoice = "auto" | "operator" | "radiosity" | "antiradiance";
/** What is behind an object: a grey and the object's shadow on the ground, or black. */
export type Backdrop = "auto" | "none";
/** What pointers and keys do: all once the element has the focus, all, leave scrolling to the page, or nothing. */
export type Interaction = "auto" | "all" | "page" | "none";
/** What a drag does to the camera: what suits the place, look around, or orbit. */
export type CameraControls = "auto" | "look" | "orbit";
/** How radiance becomes colours of the screen. */
export type ToneMapping = "agx" | "neutral";
/** How light gets from functions to pixels: pixels look functions up, functions are splatted, or whichever is faster. */
export type Display = "auto" | "lookup" | "splat";

/** The values of attributes that have a few, the default first. */
const ALLOWED = {
  mode: ["all", "direct", "indirect"],
  overlay: ["none", "points", "levels"],
  interaction: ["auto", "all", "page", "none"],
  "tone-mapping": ["agx", "neutral"],
  display: ["auto", "lookup", "splat"],
  solver: ["auto", "operator", "radiosity", "antiradiance"],
  backdrop: ["auto", "none"],
  detail: ["on", "off"],
  "camera-controls": ["auto", "look", "orbit"],
  loading: ["eager", "lazy"],
  "auto-exposure": ["on", "off"],
  handles: ["on", "off"],
  preset: ["draft", "standard", "fine"],
} as const;
type Allowed = typeof ALLOWED;

/** What the console was told. */
const told = new Set<string>();

/** An element that has them; what they do is its heir's. */
export class AttributeElement extends ElementBase {
  static readonly observedAttributes: readonly string[] = [
    "src",
    "preset",
    "drop",
    "alt",
    "poster",
    "width",
    "height",
    "exposure",
    "auto-exposure",
    "tone-mapping",
    "mode",
    "overlay",
    "display",
    "solver",
    "environment",
    "environment-rotation",
    "environment-intensity",
    "sky",
    "background-blur",
    "backdrop",
    "detail",
    "handles",
    "interaction",
    "camera-controls",
    "controls",
    "loading",
    "autoplay",
    "animation-name",
    "state-in-link",
  ];

  /** The address of a .rbn file, relative to the page; or of a .glb, .gltf or .step file, which is baked in the page. */
  get src(): string {
    const src = this.getAttribute("src");
    return src ? new URL(src, this.baseURI).href : "";
  }
  set src(value: string) {
    this.setAttribute("src", value);
  }

  /** How good and how costly a bake in the page is. */
  get preset(): "draft" | "standard" | "fine" {
    return among(this, "preset");
  }
  set preset(name: "draft" | "standard" | "fine") {
    this.setAttribute("preset", name);
  }

  /** Whether files may be dropped on the element. */
  get drop(): boolean {
    return this.hasAttribute("drop");
  }
  set drop(on: boolean) {
    this.toggleAttribute("drop", on);
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

  /** Width, CSS pixels; 0 where none is set. */
  get width(): number {
    return pixels(this.getAttribute("width"));
  }
  set width(value: number) {
    this.setAttribute("width", `${value}`);
  }

  /** Height, CSS pixels; 0 where none is set. */
  get height(): number {
    return pixels(this.getAttribute("height"));
  }
  set height(value: number) {
    this.setAttribute("height", `${value}`);
  }

  /** Stops on top of the automatic exposure, or relative to radiance 1 where that is off. */
  get exposure(): number {
    return figure(this, "exposure", 0, -20, 20);
  }
  set exposure(stops: number) {
    this.setAttribute("exposure", `${stops}`);
  }

  /** Whether the exposure is measured, and follows light and view where they would leave the picture without texture. */
  get autoExposure(): boolean {
    return among(this, "auto-exposure") === "on";
  }
  set autoExposure(on: boolean) {
    this.setAttribute("auto-exposure", on ? "on" : "off");
  }

  /** How radiance becomes colours of the screen. */
  get toneMapping(): ToneMapping {
    return among(this, "tone-mapping");
  }
  set toneMapping(name: ToneMapping) {
    this.setAttribute("tone-mapping", name);
  }

  /** Which light is shown. */
  get mode(): Mode {
    return among(this, "mode");
  }
  set mode(mode: Mode) {
    this.setAttribute("mode", mode);
  }

  /** What is drawn over the picture. */
  get overlay(): Overlay {
    return among(this, "overlay");
  }
  set overlay(overlay: Overlay) {
    this.setAttribute("overlay", overlay);
  }

  /** How light gets from functions to pixels; the picture is the same. */
  get display(): Display {
    return among(this, "display");
  }
  set display(way: Display) {
    this.setAttribute("display", way);
  }

  /** What computes bounced light; files have what it takes for one or for both. */
  get solver(): SolverChoice {
    return among(this, "solver");
  }
  set solver(name: SolverChoice) {
    this.setAttribute("solver", name);
  }

  /** Address of a picture of all directions (.hdr or .exr), which lights the scene and is seen behind it; empty for the file's own. */
  get environment(): string {
    const environment = this.getAttribute("environment");
    return environment ? new URL(environment, this.baseURI).href : "";
  }
  set environment(value: string) {
    this.setAttribute("environment", value);
  }

  /** How far the environment is turned, degrees, counterclockwise seen from above. */
  get environmentRotation(): number {
    return figure(this, "environment-rotation", 0, -36_000, 36_000);
  }
  set environmentRotation(degrees: number) {
    this.setAttribute("environment-rotation", `${degrees}`);
  }

  /** Factor of the environment's light. */
  get environmentIntensity(): number {
    return figure(this, "environment-intensity", 1, 0, 1e6);
  }
  set environmentIntensity(factor: number) {
    this.setAttribute("environment-intensity", `${factor}`);
  }

  /** A clear sky with its sun, in place of an `environment`: latitude in degrees, day of the year, solar hour, as in `48,172,15.5`. */
  get sky(): string {
    return this.getAttribute("sky") ?? "";
  }
  set sky(value: string) {
    this.setAttribute("sky", value);
  }

  /** How blurred the environment is behind the scene, 0 to 1. */
  get backgroundBlur(): number {
    return figure(this, "background-blur", 0, 0, 1);
  }
  set backgroundBlur(blur: number) {
    this.setAttribute("background-blur", `${blur}`);
  }

  /** What is behind an object; rooms and landscapes have none. */
  get backdrop(): Backdrop {
    return among(this, "backdrop");
  }
  set backdrop(what: Backdrop) {
    this.setAttribute("backdrop", what);
  }

  /** Whether folds and contacts finer than the bake's points darken bounced light. */
  get detail(): boolean {
    return among(this, "detail") === "on";
  }
  set detail(on: boolean) {
    this.setAttribute("detail", on ? "on" : "off");
  }

  /** Whether lights have handles in the picture. */
  get handles(): boolean {
    return among(this, "handles") === "on";
  }
  set handles(on: boolean) {
    this.setAttribute("handles", on ? "on" : "off");
  }

  /** What pointers and keys do. */
  get interaction(): Interaction {
    return among(this, "interaction");
  }
  set interaction(what: Interaction) {
    this.setAttribute("interaction", what);
  }

  /** What a drag does to the camera. */
  get cameraControls(): CameraControls {
    return among(this, "camera-controls");
  }
  set cameraControls(what: CameraControls) {
    this.setAttribute("camera-controls", what);
  }

  /** Whether the file is loaded at once, or only when the element comes near the visible part of the page. */
  get loading(): "eager" | "lazy" {
    return among(this, "loading");
  }
  set loading(when: "eager" | "lazy") {
    this.setAttribute("loading", when);
  }

  /** Whether the panel is offered. */
  get controls(): boolean {
    return this.hasAttribute("controls");
  }
  set controls(on: boolean) {
    this.toggleAttribute("controls", on);
  }

  /** Whether an animation begins by itself; it does not for those who want less motion. */
  get autoplay(): boolean {
    return this.hasAttribute("autoplay");
  }
  set autoplay(on: boolean) {
    this.toggleAttribute("autoplay", on);
  }

  /** Which animation is played; empty for the first. */
  get animationName(): string {
    return this.getAttribute("animation-name") ?? "";
  }
  set animationName(name: string) {
    this.setAttribute("animation-name", name);
  }

  /** Whether the state in the page's address, as `stateLink()` makes it, is taken over. */
  get stateInLink(): boolean {
    return this.hasAttribute("state-in-link");
  }
  set stateInLink(on: boolean) {
    this.toggleAttribute("state-in-link", on);
  }
}

function among<K extends keyof Allowed>(element: Element, name: K): Allowed[K][number] {
  const values: readonly Allowed[K][number][] = ALLOWED[name];
  const value = element.getAttribute(name);
  return values.find((one) => one === value) ?? (values[0] as Allowed[K][number]);
}

/** Warns once of an attribute's value that means nothing. */
export function warnOf(name: string, value: string | null): void {
  const values: readonly string[] | undefined = ALLOWED[name as keyof Allowed];
  const text = `<rebounce-viewer ${name}="${value}">: the value is unknown; there are ${values?.join(", ")}.`;
  if (!value || !values || values.includes(value) || told.has(text)) return;
  told.add(text);
  console.warn(text);
}

/** The number of an attribute within limits. */
function figure(element: Element, name: string, absent: number, least: number, most: number): number {
  const value = Number(element.getAttribute(name) ?? absent);
  return Number.isFinite(value) ? Math.min(Math.max(value, least), most) : absent;
}

/** As HTML reads a width: the number that the text begins with. */
function pixels(text: string | null): number {
  return Math.max(Number.parseInt(text ?? "", 10) || 0, 0);
}
