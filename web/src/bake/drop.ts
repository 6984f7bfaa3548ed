/** Files and folders that are dropped on an element with the attribute `drop`. */

import { Failure } from "../wire/failure.js";
import type { SceneFiles } from "./scene.js";

/** Most files of a folder that are looked at. */
const MOST = 10_000;

/** Elements that listen. */
const listening = new WeakSet<HTMLElement>();

/** Listens for drops. `open` gets the files by path, `failed` what went wrong. */
export function acceptDrops(element: HTMLElement, open: (files: SceneFiles) => void, failed: (failure: Failure) => void): void {
  if (listening.has(element)) return;
  listening.add(element);
  const wanted = (event: DragEvent) => element.hasAttribute("drop") && (event.dataTransfer?.types.includes("Files") ?? false);
  element.addEventListener("dragover", (event) => {
    if (!wanted(event)) return;
    event.preventDefault();
    if (event.dataTransfer) event.dataTransfer.dropEffect = "copy";
  });
  element.addEventListener("drop", (event) => {
    if (!wanted(event) || !event.dataTransfer) return;
    event.preventDefault();
    // Both are there only until the event is over.
    const entries = [...event.dataTransfer.items].flatMap((item) => item.webkitGetAsEntry?.() ?? []);
    const plain = [...event.dataTransfer.files];
    dropped(entries, plain).then(open, (cause: unknown) =>
      failed(new Failure("not-a-scene", "What was dropped could not be read: drop it again, or choose a smaller folder.", { cause })),
    );
  });
}

async function dropped(entries: readonly FileSystemEntry[], plain: readonly File[]): Promise<SceneFiles> {
  const files: [string, File][] = [];
  for (const entry of entries) await collect(entry, files);
  return files.length > 0 ? files : plain;
}

async function collect(entry: FileSystemEntry, files: [string, File][]): Promise<void> {
  if (files.length > MOST) throw new Error(`more than ${MOST} files`);
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    files.push([entry.fullPath.replace(/^\//, ""), file]);
    return;
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  for (;;) {
    // A folder's entries come by the hundred.
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return;
    for (const one of some) await collect(one, files);
  }
}
