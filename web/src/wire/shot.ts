/** Camera and lights as plain objects, in the form of SHOT.json. World space, metres or whatever
 * unit the scene was modelled in; colours are linear RGB. */

import type { Light } from "./light-kinds.js";

export type {
  DirectionalLight,
  DiskLight,
  EmissiveLight,
  EnvironmentLight,
  Light,
  PointLight,
  RectangleLight,
  SphereLight,
  SpotLight,
} from "./light-kinds.js";

/** Three numbers: a position, a direction or a colour. */
export type Triple = [number, number, number];

/** A pinhole camera. */
export interface Camera {
  /** The eye. */
  position: Triple;
  /** A point looked at. */
  target: Triple;
  /** The direction that is up in the picture; (0, 1, 0) when absent. */
  up?: Triple;
  /** Vertical field of view, degrees; 60 when absent. */
  yfov_deg?: number;
}

/** A camera of the file, and what it is called. */
export interface NamedCamera {
  name: string;
  camera: Camera;
}

/** What every light may have. */
export interface Named {
  /** What to call it; the page's lists show it. */
  name?: string;
}

/** A channel of the light mixer: what is done to one light. */
export interface Channel {
  /** Strength relative to the light's own, stops; 0 when absent. */
  stops?: number;
  /** Whether the light is off. */
  mute?: boolean;
  /** Whether the light is on alone, with others that are solo. */
  solo?: boolean;
  /** Linear RGB in place of the light's colour; the light's own when absent. */
  color?: Triple;
}

/** A rotation: x, y, z, w. */
export type Quaternion = [number, number, number, number];

/** A node that may move: how it has been moved from where the file has it, about its own origin, world space. */
export interface SceneNode {
  /** Shift. */
  translation: Triple;
  /** Turn, before the shift. */
  rotation: Quaternion;
}

/** Nodes by their names. */
export type Nodes = Record<string, SceneNode>;

/** Motion of a node, as SHOT.json has it. */
export interface NodeMove extends Partial<SceneNode> {
  /** Turn about the world's y axis, degrees, after `rotation`; counterclockwise seen from above. */
  rotation_y_deg?: number;
}

/** Camera and lights together: what SHOT.json holds. */
export interface Shot {
  camera: Camera;
  lights: Light[];
  /** Channels of the light mixer, by the lights' places. */
  mix?: Channel[];
  /** Factor of the emission of all surfaces that shine; 1 when absent. */
  emission?: number;
  /** Whether metals are GGX conductors whose reflectance is their base colour at every angle, and nothing else shines; glTF's model when absent. */
  gloss?: boolean;
  /** Motions of nodes by their names; other nodes are where the file has them. */
  move?: Record<string, NodeMove>;
  /** Name or number of the animation whose pose skins and morph targets have, at `time`; the file's first when absent. */
  animation?: string;
  /** Seconds from the animation's begin; at rest when there is neither this nor an animation. */
  time?: number;
  /** Width and height of the picture, pixels; the element keeps its own size. */
  size?: [number, number];
}
