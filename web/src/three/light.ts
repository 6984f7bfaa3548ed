/** The light that a scene of three.js holds: adds bounced irradiance to every material that is lit. */

import { AnalyticLightNode, Light, NodeUpdateType, type Node, type NodeBuilder, type NodeFrame } from "three/webgpu";

/** Where the light comes from. */
export interface LightSource {
  /** Irradiance of the surface that is shaded. */
  readonly irradiance: Node<"vec3">;
  /** A picture is about to be drawn. */
  prepare(frame: NodeFrame): void;
}

/** Bounced light; its colour and intensity scale it, and 1 is right. */
export class RebounceLight extends Light {
  readonly isRebounceLight = true;
  override readonly type = "RebounceLight";

  constructor(readonly source: LightSource) {
    super(0xffffff, 1);
    this.name = "bounced light";
  }
}

/** What materials make of it. */
class RebounceLightNode extends AnalyticLightNode<RebounceLight> {
  static get type(): string {
    return "RebounceLightNode";
  }

  constructor(light: RebounceLight) {
    super(light);
    this.updateBeforeType = NodeUpdateType.RENDER;
  }

  override updateBefore(frame: NodeFrame): undefined {
    this.light?.source.prepare(frame);
  }

  override setup(builder: NodeBuilder): undefined {
    const { irradiance } = builder.context as { irradiance: Node<"vec3"> & { addAssign(other: unknown): void } };
    const own = this.light?.source.irradiance as (Node<"vec3"> & { mul(other: unknown): unknown }) | undefined;
    if (own) irradiance.addAssign(own.mul((this as unknown as { colorNode: Node }).colorNode));
    return undefined;
  }
}

(RebounceLight as unknown as { registerNode(node: unknown): void }).registerNode(RebounceLightNode);
