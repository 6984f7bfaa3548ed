// What TypeScript makes of the package's types.
/// <reference types="rebounce-cli/client" />

import { bake, type BakeOptions, type BakeReport } from "rebounce-cli";
import rebounce from "rebounce-cli/vite";
import { defineConfig } from "vite";
import room from "./room.glb?rebounce";
import hall from "./room.glb?preset=fine&rebounce";

const options: BakeOptions = {
  preset: "draft",
  functions: 2000,
  maxBytes: "4M",
  viewpoint: [[0, 1, 0], "1,1,1"],
  rays: [64, 32],
  noSources: true,
  onReport: ({ functions, links }: BakeReport) => console.log(functions + links),
};
export const file: Promise<Uint8Array> = bake("room.glb", options);
export const addresses: string[] = [room, hall];
export default defineConfig({ plugins: [rebounce({ preset: "fine" })] });

// @ts-expect-error: there is no such preset
export const wrongPreset: BakeOptions = { preset: "best" };
// @ts-expect-error: there is no such option
export const wrongOption: BakeOptions = { speed: 1 };
