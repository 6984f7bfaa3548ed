/** Camera and lights as plain objects, in the form of SHOT.json. World space, metres or whatever
 * unit the scene was modelled in; colours are linear RGB. */

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
interface Named {
  /** What to call it; the page's lists show it. */
  name?: string;
}

/** Shines all around. */
export interface PointLight extends Named {
  type: "point";
  position: Triple;
  /** Candela. */
  intensity: number;
  color?: Triple;
  /** Of the sphere that shines, scene units; a point when absent. */
  radius?: number;
}

/** Shines within a cone. */
export interface SpotLight extends Named {
  type: "spot";
  position: Triple;
  /** The way the light travels; any length. */
  direction: Triple;
  /** Half angle of the cone, degrees. */
  outer_cone_deg: number;
  /** Half angle within which the light is full, degrees; a hard edge when absent. */
  inner_cone_deg?: number;
  /** Candela. */
  intensity: number;
  color?: Triple;
  /** Of the sphere that shines, scene units; a point when absent. */
  radius?: number;
}

/** Shines from infinitely far. */
export interface DirectionalLight extends Named {
  type: "directional";
  /** The way the light travels; any length. */
  direction: Triple;
  /** Lux on a surface that faces the light. */
  intensity: number;
  color?: Triple;
  /** Half the angle that its disc spans, degrees; the sun 0.27, a point when absent. */
  radius_deg?: number;
}

/** Any light. */
export type Light = PointLight | SpotLight | DirectionalLight;

/** Camera and lights together: what SHOT.json holds. */
export interface Shot {
  camera: Camera;
  lights: Light[];
  /** Width and height of the picture, pixels; the element keeps its own size. */
  size?: [number, number];
}
