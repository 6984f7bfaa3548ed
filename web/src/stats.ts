/** Figures of the viewer. */

/** What the viewer knows without asking the GPU. */
export interface Stats {
  /** The graphics adapter's name. */
  adapter: string;
  /** The scene's name. */
  scene: string;
  /** Milliseconds of each pass when it last ran; absent where the device cannot time. */
  milliseconds: Record<string, number | null>;
  /** Pictures drawn so far. */
  frames: number;
  /** Times that light was computed anew. */
  relights: number;
  /** Triangles of the scene. */
  triangles: number;
  /** Basis functions per level, coarsest first. */
  functions: number[];
  /** Transport links. */
  links: number;
  /** Lights. */
  lights: number;
  /** Bytes on the GPU, by what they are for. */
  bytes: Record<string, number>;
  [figure: string]: unknown;
}

/** What the GPU counted for the present picture: numbers by name, in groups. */
export type Counts = { [name: string]: number | Counts };
