/** Fetches a file in pieces, and tells how far it has come. */

import { Failure } from "./failure.js";

/** Bytes so far and in all; `total` is 0 where the server does not say. */
export type OnProgress = (loaded: number, total: number) => void;

/**
 * Downloads a file whole.
 *
 * Throws a `Failure` with the code `network` (nothing came), `http` (the server said no) or
 * `truncated` (the connection broke on the way), or the signal's AbortError.
 */
export async function download(url: string, signal: AbortSignal, onProgress: OnProgress): Promise<Uint8Array> {
  const name = fileName(url);
  let response: Response;
  try {
    response = await fetch(url, { signal });
  } catch (error) {
    signal.throwIfAborted();
    throw new Failure("network", `The file ${name} could not be fetched; check the address and the connection.`, {
      cause: error,
    });
  }
  if (!response.ok) {
    void response.body?.cancel().catch(() => undefined);
    const reason = response.status === 404 ? "it is not there (404)" : `the server answered ${response.status}`;
    throw new Failure("http", `The file ${name} could not be loaded: ${reason}. Check the src attribute.`);
  }
  // Under a content encoding the header counts other bytes than those that arrive.
  const encoded = response.headers.has("content-encoding");
  const total = encoded ? 0 : Number(response.headers.get("content-length") ?? 0) || 0;
  const pieces: Uint8Array[] = [];
  let loaded = 0;
  onProgress(0, total);
  try {
    const reader = response.body?.getReader();
    for (;;) {
      const piece = await reader?.read();
      if (!piece || piece.done) break;
      pieces.push(piece.value);
      loaded += piece.value.length;
      onProgress(loaded, Math.max(total, total && loaded));
    }
  } catch (error) {
    signal.throwIfAborted();
    const share = total ? `${loaded} of ${total} bytes` : `${loaded} bytes`;
    throw new Failure("truncated", `The download of ${name} broke off after ${share}; load it again.`, {
      cause: error,
    });
  }
  const bytes = new Uint8Array(loaded);
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
