/** What can go wrong: a code for programs and a sentence for people. */

/** An error with a short, stable code. */
export class Failure extends Error {
  constructor(
    /** A short, stable code. */
    readonly code: string,
    message: string,
    options?: ErrorOptions,
  ) {
    super(message, options);
    this.name = "RebounceError";
  }
}

/** A module that is fetched when first wanted. Rejects with a `Failure`. */
export async function wanted<T>(module: Promise<T>, what: string): Promise<T> {
  try {
    return await module;
  } catch (cause) {
    throw new Failure("network", `The ${what} could not be loaded; check the connection and reload.`, { cause });
  }
}

/** Anything thrown, as a failure: the viewer's own errors carry a code, all else is a fault of ours. */
export function failureOf(thrown: unknown): Failure {
  if (thrown instanceof Failure) return thrown;
  const code = (thrown as { code?: unknown } | null)?.code;
  const message = thrown instanceof Error ? thrown.message : String(thrown);
  if (typeof code === "string") return new Failure(code, message, { cause: thrown });
  return new Failure("internal", `The viewer stopped because of a fault in it (${message}). Reload the page.`, {
    cause: thrown,
  });
}

/** Whether the viewer that gave this failure is of no further use. */
export function isFatal(code: string): boolean {
  return ["internal", "device-lost", "out-of-memory", "no-webgpu", "no-adapter", "no-device"].includes(code);
}

/** What visitors read where there is no WebGPU, and trying again cannot help; nothing for other failures. */
export function unsupported(code: string): string | undefined {
  if (code !== "no-webgpu" && code !== "no-adapter") return undefined;
  return isSecureContext
    ? "This 3D view needs WebGPU, which is missing here. Try a current Chrome, Edge, Firefox or Safari (26 or newer), with graphics acceleration on."
    : "This 3D view needs WebGPU, which browsers offer to secure pages only: open this page over https.";
}

/** A file may give things names of any length. */
const LONGEST = 1000;

/** A message as a sentence: a capital first, a full stop last. */
export function sentence(message: string): string {
  const text = message.trim().slice(0, LONGEST);
  const first = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}
