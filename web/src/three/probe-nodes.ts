/** Irradiance from probes in a shader: probe-grid.ts as nodes. */

import { Vector3, Vector4, type Node } from "three/webgpu";
import { dot, exp, float, Fn, If, int, ivec2, ivec3, Loop, normalize, renderGroup, select, texture, uniform, vec2, vec3 } from "three/tsl";
import { BEHIND, FADE, LEAST, LOBES, TOLERANCE } from "./probe-grid.js";
import { octahedralEncode } from "./octahedral.js";
import { PER_ROW, PLANES, type Probes } from "./probes.js";
import { nothing } from "./textures.js";

type Vector = Node<"vec3">;

/** What a material reads of probes. */
export class ProbeNodes {
  // Each its own: three.js takes nodes of one texture for one node.
  readonly #empty = [nothing(), nothing(), nothing()] as const;
  readonly #radiance = texture(this.#empty[0]);
  readonly #planes = texture(this.#empty[1]);
  readonly #moved = texture(this.#empty[2]);
  // Of the render group: three.js does not look at others of things that rest.
  /** First place, and the spacing; 0 without probes. */
  readonly #first = uniform(new Vector4()).setGroup(renderGroup);
  readonly #counts = uniform(new Vector3(1, 1, 1)).setGroup(renderGroup);

  /** Reads from these probes from now on; for things that were drawn before, there must have been some. */
  set(probes: Probes | undefined): void {
    const { grid, textures } = probes ?? {};
    for (const [k, node] of [this.#radiance, this.#planes, this.#moved].entries()) node.value = textures?.[k] ?? (this.#empty[k] as ReturnType<typeof nothing>);
    if (!grid) return void this.#first.value.set(0, 0, 0, 0);
    this.#first.value.set(...grid.first.toArray(), grid.spacing);
    this.#counts.value.set(...grid.counts);
  }

  /** Irradiance at a place with a unit normal, local space; nothing without probes, or where `wanted` is 0. */
  irradiance(place: Vector, normal: Vector, wanted: Node<"float">): Vector {
    return Fn(() => {
      const out = vec3(0).toVar();
      const spacing = this.#first.w;
      const counts = this.#counts;
      const at = place.sub(this.#first.xyz).div(spacing.max(1e-20)).clamp(vec3(0), counts.sub(1)).toVar();
      const corners = select(wanted.mul(spacing).greaterThan(0), int(8), int(0));
      const base = at.floor().min(counts.sub(2).max(0)).toVar();
      const share = at.sub(base).toVar();
      const { x, y, z } = normal;
      const basis = [float(1), y, z, x, x.mul(y), y.mul(z), z.mul(z).mul(3).sub(1), x.mul(z), x.mul(x).sub(y.mul(y))];
      const lobes = basis.map((part, i) => part.mul(LOBES[i] as number).toVar());
      const total = float(0).toVar();
      Loop({ start: int(0), end: corners, type: "int", condition: "<" }, ({ i }) => {
        const corner = int(i);
        const offset = vec3(ivec3(corner.bitAnd(int(1)), corner.shiftRight(int(1)).bitAnd(int(1)), corner.shiftRight(int(2))));
        const cell = base.add(offset).min(counts.sub(1)).toVar();
        const probe = int(cell.x.add(counts.x.mul(cell.y.add(counts.y.mul(cell.z)))).add(0.5)).toVar();
        const column = probe.mod(int(PER_ROW)).toVar();
        const row = probe.div(int(PER_ROW)).toVar();
        const moved = this.#moved.load(ivec2(column, row)).toVar();
        If(moved.w.greaterThan(0), () => {
          const near = vec3(1).sub(offset.sub(share).abs()).max(1e-3).toVar();
          const from = place.sub(this.#first.xyz.add(cell.mul(spacing)).add(moved.xyz)).toVar();
          const facing = float(0.5).sub(dot(normal, normalize(from)).mul(0.5)).toVar();
          const visible = this.#visible(column as never, row as never, from as unknown as Vector, spacing);
          const weight = near.x.mul(near.y).mul(near.z).mul(facing.mul(facing).mul(1 - BEHIND).add(BEHIND)).mul(visible).toVar();
          total.addAssign(weight);
          lobes.forEach((lobe, k) => {
            const texel = this.#radiance.load(ivec2(column.mul(9).add(k), row));
            out.addAssign(texel.xyz.mul(lobe.mul(weight)));
          });
        });
      });
      out.assign(out.div(total.max(1e-37)).max(vec3(0)));
      return out;
    })() as unknown as Vector;
  }

  /** Frees its textures. */
  dispose(): void {
    for (const empty of this.#empty) empty.dispose();
  }

  /** Weight of a probe at this column and row by how far the place is behind what it sees. */
  #visible(column: Node<"int">, row: Node<"int">, from: Vector, spacing: Node<"float">): Node<"float"> {
    return Fn(() => {
      const at = octahedralEncode(from).mul(0.5).add(0.5).mul(PLANES).sub(0.5).toVar();
      const visible = float(0).toVar();
      const last = int(PLANES - 1);
      Loop(4, ({ i }) => {
        const corner = int(i);
        const cell = at.floor().add(vec2(ivec2(corner.bitAnd(int(1)), corner.shiftRight(int(1))))).toVar();
        const near = vec2(1).sub(cell.sub(at).abs()).toVar();
        const u = int(cell.x).toVar();
        const v = int(cell.y).toVar();
        If(u.lessThan(int(0)).or(u.greaterThan(last)), () => {
          u.assign(select(u.lessThan(int(0)), int(0), last));
          v.assign(last.sub(v));
        });
        If(v.lessThan(int(0)).or(v.greaterThan(last)), () => {
          u.assign(last.sub(u));
          v.assign(select(v.lessThan(int(0)), int(0), last));
        });
        const plane = this.#planes.load(ivec2(column.mul(int(PLANES)).add(u), row.mul(int(PLANES)).add(v))).toVar();
        const behind = dot(plane.xyz, from).add(plane.w).negate().div(spacing).sub(TOLERANCE).max(0).div(FADE);
        visible.addAssign(near.x.mul(near.y).mul(exp(behind.negate())));
      });
      return visible.max(LEAST);
    })() as unknown as Node<"float">;
  }
}
