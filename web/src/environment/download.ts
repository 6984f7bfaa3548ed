/** Downloads pictures of all directions and reads them. Loaded when an `environment` is first wanted. */

import { Failure } from "../wire/failure.js";
import { readHdr } from "./hdr.js";
import type { Picture } from "./picture.js";

export { PictureLights } from "./lights.js";

/** Downloads a picture and reads it. Rejects with a `Failure`, or the signal's AbortError. */
export async function picture(url: string, signal: AbortSignal): Promise<Picture> {
  const wrong = (code: string, reason: string, cause?: unknown) =>
    new Failure(code, `The environment ${url} could not be loaded: ${reason}; the light stays as it is.`, { cause });
  let response: Response;
  let bytes: Uint8Array;
  try {
    response = await fetch(url, { signal });
    if (!response.ok) throw wrong("http", `the server answered ${response.status}`);
    bytes = new Uint8Array(await response.arrayBuffer());
  } catch (error) {
    signal.throwIfAborted();
    throw error instanceof Failure ? error : wrong("network", "the download broke off, or never began", error);
  }
  try {
    const begins = (...first: number[]) => first.every((byte, i) => bytes[i] === byte);
    if (begins(0x23, 0x3f)) return readHdr(bytes);
    if (!begins(0x76, 0x2f, 0x31, 0x01)) throw new Error("it is neither Radiance (.hdr) nor OpenEXR (.exr), the formats that the page reads");
    const { readExr } = await import("./exr.js").catch((cause: unknown) => {
      throw wrong("network", "the reader of .exr could not be loaded", cause);
    });
    signal.throwIfAborted();
    return readExr(bytes);
  } catch (error) {
    signal.throwIfAborted();
    if (error instanceof Failure) throw error;
    throw wrong("bad-environment", (error as Error).message, error);
  }
}
