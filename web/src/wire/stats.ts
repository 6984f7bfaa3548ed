/** Figures of the viewer. */

/** What computes bounced light. */
export type Solver = "operator" | "radiosity" | "antiradiance";

/** Size of antiradiance's problem, and its steps. */
export interface AntiradianceStats {
  /** Patches and clusters. */
  elements: number;
  /** Links between them. */
  links: number;
  /** Bins of directions. */
  bins: number;
  /** Steps so far. */
  iterations: number;
}

/** What the viewer knows without asking the GPU. */
export interface Stats {
  /** The graphics adapter's name. */
  adapter: string;
  /** The scene's name. */
  scene: string;
  /** What computes bounced light: the file's operator, radiosity, or antiradiance. */
  solver: Solver;
  /** Whether radiosity or antiradiance is on its way to what lights and nodes are now. */
  solving: boolean;
  /** How the last picture's light got from functions to pixels. */
  display: "lookup" | "splat";
  /** Milliseconds of each pass when it last ran; absent where the device cannot time. */
  milliseconds: Record<string, number>;
  /** Pictures drawn so far. */
  frames: number;
  /** Times that light was computed anew. */
  relights: number;
  /** Lights whose direct light at the points was computed, in all of these times: those that changed. */
  lightsEvaluated: number;
  /** Shadow-map layers drawn so far. */
  shadowLayers: number;
  /** Width of a shadow map, texels. */
  shadowSize: number;
  /** Layers of transparent surfaces drawn so far. */
  blendedLayers: number;
  /** Triangles of the scene. */
  triangles: number;
  /** Basis functions per level, coarsest first. */
  functions: number[];
  /** Transport links. */
  links: number;
  /** Lights. */
  lights: number;
  /** What antiradiance takes, where it computes bounced light. */
  antiradiance?: AntiradianceStats;
  /** Bytes on the GPU, by what they are for. */
  bytes: Record<string, number>;
}

/** What the GPU counted for the present picture. */
export interface Counts {
  /** Pixels of the picture. */
  pixels: number;
  /** Pixels that looked functions up, or were splatted to; the others are interpolated. */
  pixelsLookedUp: number;
  /** Functions of which a pixel tested whether they reach it, on average over all pixels; of splatting, quads of the finest level. */
  functionsLookedAtPerPixel: number;
  /** Kernels evaluated for a pixel, on average over all pixels; of splatting 0: not counted. */
  kernelEvaluationsPerPixel: number;
}
