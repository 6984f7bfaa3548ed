/** Fetches a file in pieces, and tells how far it has come. */

import { Failure } from "../wire/failure.js";

/** Bytes so far and in all; `total` is 0 while the file has not said. */
export type OnProgress = (loaded: number, total: number) => void;

/** A connection that gives nothing for so long has stalled, milliseconds. */
const PATIENCE = 60_000;
/** Where a .rbn file says how long it is, bytes from its start (docs/format/rbn.md). */
const LENGTH_AT = 16;
const MAGIC = "REBOUNCE";

/**
 * Downloads a file whole; of what is no .rbn file, or goes on where it should end, no more than shows that.
 *
 * Throws a `Failure` with the code `network` (nothing came), `http` (the server said no), `not-rbn` (a web page),
 * `stalled` (nothing came for a minute) or `truncated` (the connection broke on the way), or the signal's AbortError.
 */
export async function download(url: string, signal: AbortSignal, onProgress: OnProgress): Promise<Uint8Array> {
  const name = fileName(url);
  const stalled = new AbortController();
  let timer = 0;
  const wait = () => {
    clearTimeout(timer);
    timer = setTimeout(() => stalled.abort(), PATIENCE);
  };
  const pieces: Uint8Array[] = [];
  let loaded = 0;
  // What the file's first bytes say; 0 before they are there.
  let total = 0;
  let began = false;
  try {
    wait();
    const response = await fetch(url, { signal: AbortSignal.any([signal, stalled.signal]) });
    const refuse = (code: string, reason: string) => {
      void response.body?.cancel().catch(() => undefined);
      return new Failure(code, `The file ${name} could not be loaded: ${reason}. Check the src attribute.`);
    };
    if (response.status === 404) throw refuse("http", "it is not there (404)");
    if (!response.ok) throw refuse("http", `the server answered ${response.status}`);
    if (/^text\/html/.test(response.headers.get("content-type") ?? "")) throw refuse("not-rbn", "a web page came in its place");
    began = true;
    onProgress(0, 0);
    const reader = response.body?.getReader();
    for (;;) {
      const piece = await reader?.read();
      if (!piece || piece.done) break;
      wait();
      pieces.push(piece.value);
      loaded += piece.value.length;
      total ||= loaded < LENGTH_AT + 8 ? 0 : lengthIn(joined(pieces, loaded));
      if (total && loaded > total) {
        void reader?.cancel().catch(() => undefined);
        break;
      }
      onProgress(loaded, total);
    }
  } catch (error) {
    signal.throwIfAborted();
    if (error instanceof Failure) throw error;
    const share = total ? `${loaded} of ${total} bytes` : `${loaded} bytes`;
    const hasStalled = stalled.signal.aborted;
    throw hasStalled || began
      ? new Failure(
          hasStalled ? "stalled" : "truncated",
          `The download of ${name} ${hasStalled ? "stalled" : "broke off"} after ${share}; load it again.`,
          { cause: error },
        )
      : new Failure("network", `The file ${name} could not be fetched; check the address and the connection.`, { cause: error });
  } finally {
    clearTimeout(timer);
  }
  return joined(pieces, loaded);
}

/** The length that a file says it has, bytes; 1 for what is no .rbn file. */
function lengthIn(start: Uint8Array): number {
  const isRbn = String.fromCharCode(...start.subarray(0, 8)) === MAGIC;
  return isRbn ? Number(new DataView(start.buffer).getBigUint64(LENGTH_AT, true)) || 1 : 1;
}

function joined(pieces: readonly Uint8Array[], length: number): Uint8Array {
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const piece of pieces) {
    bytes.set(piece, at);
    at += piece.length;
  }
  return bytes;
}

function fileName(url: string): string {
  try {
    const parts = new URL(url).pathname.split("/");
    return decodeURIComponent(parts[parts.length - 1] || url);
  } catch {
    return url;
  }
}
