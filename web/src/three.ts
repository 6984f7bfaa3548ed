/** Bounced light for scenes of three.js: of a .rbn file, relit as the scene's own lights move. */

export { Rebounce, type LoadOptions, type Memory } from "./three/rebounce.js";
export { type DeviceOptions } from "./three/gpu.js";
export { type BakeOptions } from "./three/bake.js";
export { irradianceAt, type ProbeData, type ProbeOptions } from "./three/probe-grid.js";
export { type FollowedLights } from "./three/lights.js";
export { type RebounceLight } from "./three/light.js";
