/** Irradiance from probes on the CPU: probes/sample.rs line by line, for those who write another renderer's shader. */

import { Vector3 } from "three/webgpu";

/** Where probes are, and what surfaces they see. */
export interface ProbeGrid {
  /** World-space place of the file's local origin. */
  origin: readonly [number, number, number];
  /** Place of the first probe, local space. */
  first: Vector3;
  /** Distance of neighbours. */
  spacing: number;
  /** Probes along x, y and z; x varies fastest. */
  counts: readonly [number, number, number];
  /** Unit normal and distance of the plane in each texel of a 16 × 16 octahedral map, by probe. */
  planes: Float32Array;
  /** How a probe is moved off its place in the grid, and 1; 0 within something solid, where it does not count. */
  moves: Float32Array;
}

/** How probes are made. */
export interface ProbeOptions {
  /** Distance between probes, in the file's unit; as far as suits the scene when absent. */
  spacing?: number;
}

/** What is read of probes: for other renderers. */
export interface ProbeData extends ProbeGrid {
  /** Radiance: nine coefficients by probe, RGB and a zero each, in the order of three.js' `SphericalHarmonics3`. */
  radiance: Float32Array;
}

/** As probes/sample.rs. */
export const TOLERANCE = 0.02;
export const FADE = 0.004;
export const BEHIND = 0.1;
export const LEAST = 1e-26;

const SIDE = 16;

/** The factors of the basis, and of each band's cosine. */
const Y = [0.2820948, 0.4886025, 0.4886025, 0.4886025, 1.0925484, 1.0925484, 0.31539157, 1.0925484, 0.5462742];
const BANDS = [Math.PI, (2 * Math.PI) / 3, (2 * Math.PI) / 3, (2 * Math.PI) / 3, ...Array<number>(5).fill(Math.PI / 4)];
/** Both together. */
export const LOBES = Y.map((y, i) => y * (BANDS[i] as number));

const clamp = (x: number, low: number, high: number) => Math.min(Math.max(x, low), high);

/** Irradiance at a place with a unit normal, local space. */
export function irradianceAt({ first, spacing, counts, planes, moves, radiance }: ProbeData, place: Vector3, normal: Vector3): Vector3 {
  const axes = [0, 1, 2] as const;
  const at = axes.map((k) => clamp((place.getComponent(k) - first.getComponent(k)) / spacing, 0, counts[k] - 1));
  const base = axes.map((k) => Math.min(Math.floor(at[k] as number), Math.max(counts[k] - 2, 0)));
  const sums = Array.from({ length: 9 }, () => new Vector3());
  let total = 0;
  for (let corner = 0; corner < 8; corner += 1) {
    const offset = [corner & 1, (corner >> 1) & 1, corner >> 2];
    const cell = axes.map((k) => Math.min((base[k] as number) + (offset[k] as number), counts[k] - 1)) as [number, number, number];
    const probe = cell[0] + counts[0] * (cell[1] + counts[1] * cell[2]);
    if (moves[4 * probe + 3] === 0) continue;
    const near = axes.reduce<number>((product, k) => product * Math.max(1 - Math.abs((offset[k] as number) - (at[k] as number) + (base[k] as number)), 1e-3), 1);
    const from = new Vector3(...axes.map((k) => place.getComponent(k) - first.getComponent(k) - cell[k] * spacing - (moves[4 * probe + k] as number)));
    const facing = 0.5 - 0.5 * normal.dot(from.clone().normalize());
    const weight = near * (BEHIND + (1 - BEHIND) * facing * facing) * visibility(planes, probe, from, spacing);
    total += weight;
    sums.forEach((sum, i) => sum.addScaledVector(new Vector3().fromArray(radiance, 4 * (9 * probe + i)), weight));
  }
  const { x, y, z } = normal;
  const lobes = [1, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y].map((part, i) => part * (LOBES[i] as number));
  const out = new Vector3();
  if (total > 0) sums.forEach((sum, i) => out.addScaledVector(sum, (lobes[i] as number) / total));
  return out.max(new Vector3());
}

/** Weight of a probe by how far a place is behind the surfaces that it sees. */
function visibility(planes: Float32Array, probe: number, from: Vector3, spacing: number): number {
  const [u, v] = octahedral(from);
  const x = (u * 0.5 + 0.5) * SIDE - 0.5;
  const y = (v * 0.5 + 0.5) * SIDE - 0.5;
  let visible = 0;
  for (let corner = 0; corner < 4; corner += 1) {
    const [cx, cy] = [Math.floor(x) + (corner & 1), Math.floor(y) + (corner >> 1)];
    const near = (1 - Math.abs(cx - x)) * (1 - Math.abs(cy - y));
    const texel = 4 * (SIDE * SIDE * probe + wrapped(cx, cy));
    const [a = 0, b = 0, c = 0, distance = 0] = planes.subarray(texel, texel + 4);
    const behind = -(a * from.x + b * from.y + c * from.z + distance) / spacing - TOLERANCE;
    visible += near * Math.exp(-Math.max(behind, 0) / FADE);
  }
  return Math.max(visible, LEAST);
}

/** The octahedral map of a direction, -1 to 1. */
function octahedral({ x, y, z }: Vector3): [number, number] {
  const size = Math.abs(x) + Math.abs(y) + Math.abs(z) || 1;
  const [u, v] = [x / size, y / size];
  const sign = (t: number) => (t < 0 ? -1 : 1);
  return z < 0 ? [(1 - Math.abs(v)) * sign(u), (1 - Math.abs(u)) * sign(v)] : [u, v];
}

/** Number of a texel, wrapped around the map's border. */
function wrapped(x: number, y: number): number {
  let [u, v] = [x, y];
  if (u < 0 || u >= SIDE) [u, v] = [clamp(u, 0, SIDE - 1), SIDE - 1 - v];
  if (v < 0 || v >= SIDE) [u, v] = [SIDE - 1 - u, clamp(v, 0, SIDE - 1)];
  return v * SIDE + u;
}
