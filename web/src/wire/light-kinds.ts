/** The kinds of light and their fields. `cargo xtask light-kinds` writes this file from shared/src/light/kinds.rs. */

import type { Named, Triple } from "./shot.js";

/** Shines all around. */
export interface PointLight extends Named {
  type: "point";
  /** World space. */
  position: Triple;
  /** Candela. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
  /** Radius of the sphere that shines, scene units; 0, a point, when absent. */
  radius?: number;
}

/** Shines within a cone. */
export interface SpotLight extends Named {
  type: "spot";
  /** World space. */
  position: Triple;
  /** The cone's axis, the way the light travels; any length. */
  direction: Triple;
  /** Half angle of the cone, degrees. */
  outer_cone_deg: number;
  /** Half angle within which the light is full, degrees; a hard edge when absent. */
  inner_cone_deg?: number;
  /** Candela. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
  /** Radius of the sphere that shines, scene units; 0, a point, when absent. */
  radius?: number;
}

/** Shines from infinitely far. */
export interface DirectionalLight extends Named {
  type: "directional";
  /** The way the light travels; any length. */
  direction: Triple;
  /** Lux on a surface that faces the light. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
  /** Angular radius of the disc, degrees (the sun 0.27); 0, a point, when absent. */
  radius_deg?: number;
}

/** Shines from the front of a rectangle, equally bright from everywhere. */
export interface RectangleLight extends Named {
  type: "rectangle";
  /** The middle, world space. */
  position: Triple;
  /** The normal, the way the light travels; any length. */
  direction: Triple;
  /** Along the height, any length; y, or x where the direction is nearly vertical, when absent or zero. */
  up?: Triple;
  /** Scene units. */
  width: number;
  /** Scene units. */
  height: number;
  /** Radiance, nits. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
}

/** Shines from the front of a disk, equally bright from everywhere. */
export interface DiskLight extends Named {
  type: "disk";
  /** The middle, world space. */
  position: Triple;
  /** The normal, the way the light travels; any length. */
  direction: Triple;
  /** Scene units. */
  radius: number;
  /** Radiance, nits. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
}

/** Shines from a sphere, equally bright from everywhere. */
export interface SphereLight extends Named {
  type: "sphere";
  /** The middle, world space. */
  position: Triple;
  /** Scene units. */
  radius: number;
  /** Radiance, nits. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
}

/** Shines from all directions, infinitely far: as a picture says, or equally. */
export interface EnvironmentLight extends Named {
  type: "environment";
  /** Picture of the directions, relative to the file that names it; equal in all directions when absent. */
  file?: string;
  /** Turn about the y axis, counterclockwise seen from above, degrees; 0 when absent. */
  rotation_deg?: number;
  /** Factor of the picture's radiance, or the radiance, nits; 1 when absent. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
}

/** Shines as a group of the scene's surfaces does. */
export interface EmissiveLight extends Named {
  type: "emissive";
  /** Number of the group; 0 when absent. */
  group?: number;
  /** Factor of the surfaces' emission; 1 when absent. */
  intensity: number;
  /** Linear RGB; white when absent. */
  color?: Triple;
}

/** Any light. */
export type Light = PointLight | SpotLight | DirectionalLight | RectangleLight | DiskLight | SphereLight | EnvironmentLight | EmissiveLight;

/** A field of lights. */
export interface Field {
  name: string;
  /** What the panel calls it. */
  row: string;
  /** Where its first number is in a light's list of numbers. */
  at: number;
  /** How many numbers it has; none of a text. */
  width: 0 | 1 | 3;
  /** What it is when absent, NaN where a light may be without; it must be there when this is absent. */
  absent?: number | Triple;
  /** Of a new light; what is absent follows from where it stands, or is the default. */
  fresh?: number | Triple;
  /** The greatest number; none when absent. */
  max?: number;
}

/** A kind of light. */
export interface Kind {
  /** What lights without a name are called. */
  called: string;
  /** What the list calls the kind. */
  listed: string;
  /** Units of the intensity; the first is that of the member. */
  units: readonly string[];
  /** Whether a new one can stand anywhere in a scene. */
  lamp: boolean;
  /** In the order of links. */
  fields: readonly Field[];
}

/** Numbers of a light: its kind's place in the table, then its fields. */
export const LIGHT = 17;
/** Where the size is among them, whatever the kind calls it. */
export const SIZE = 13;

const position: Field = { name: "position", row: "Position", at: 1, width: 3 };
const intensity: Field = { name: "intensity", row: "Intensity", at: 9, width: 1 };
const color: Field = { name: "color", row: "Colour", at: 10, width: 3, absent: [1, 1, 1] };
const radius: Field = { name: "radius", row: "Size: radius", at: 13, width: 1, absent: 0 };
const direction: Field = { name: "direction", row: "Direction", at: 4, width: 3, fresh: [0, -1, 0] };
const outer_cone_deg: Field = { name: "outer_cone_deg", row: "Outer angle, degrees", at: 7, width: 1, fresh: 40, max: 90 };
const inner_cone_deg: Field = { name: "inner_cone_deg", row: "Inner angle, degrees", at: 8, width: 1, absent: NaN, fresh: 30, max: 90 };
const radius_deg: Field = { name: "radius_deg", row: "Size: radius, degrees", at: 13, width: 1, absent: 0, max: 30 };
const up: Field = { name: "up", row: "Up", at: 14, width: 3, absent: [0, 0, 0] };
const width: Field = { name: "width", row: "Width", at: 7, width: 1, fresh: 1 };
const height: Field = { name: "height", row: "Height", at: 8, width: 1, fresh: 1 };
const disk_radius: Field = { name: "radius", row: "Radius", at: 13, width: 1, fresh: 0.2 };
const file: Field = { name: "file", row: "File", at: 0, width: 0, absent: NaN };
const rotation_deg: Field = { name: "rotation_deg", row: "Rotation, degrees", at: 7, width: 1, absent: 0 };
const environment_intensity: Field = { name: "intensity", row: "Factor", at: 9, width: 1, absent: 1 };
const group: Field = { name: "group", row: "Group", at: 7, width: 1, absent: 0 };

/** The kinds in the order of their numbers. */
export const KINDS: Record<Light["type"], Kind> = {
  point: {
    called: "Lamp",
    listed: "point",
    units: ["candela", "lumen"],
    lamp: true,
    fields: [position, intensity, color, radius],
  },
  spot: {
    called: "Spot",
    listed: "spot",
    units: ["candela", "lumen"],
    lamp: true,
    fields: [position, direction, outer_cone_deg, inner_cone_deg, intensity, color, radius],
  },
  directional: {
    called: "Sun",
    listed: "sun",
    units: ["lux"],
    lamp: true,
    fields: [direction, intensity, color, radius_deg],
  },
  rectangle: {
    called: "Rectangle",
    listed: "rectangle",
    units: ["nit"],
    lamp: true,
    fields: [position, direction, up, width, height, intensity, color],
  },
  disk: {
    called: "Disk",
    listed: "disk",
    units: ["nit"],
    lamp: true,
    fields: [position, direction, disk_radius, intensity, color],
  },
  sphere: {
    called: "Sphere",
    listed: "sphere",
    units: ["nit"],
    lamp: true,
    fields: [position, disk_radius, intensity, color],
  },
  environment: {
    called: "Environment",
    listed: "environment",
    units: ["factor"],
    lamp: false,
    fields: [file, rotation_deg, environment_intensity, color],
  },
  emissive: {
    called: "Surfaces",
    listed: "surfaces",
    units: ["factor"],
    lamp: false,
    fields: [group, environment_intensity, color],
  },
};
