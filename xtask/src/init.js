/** Starts the wasm module from the response that holds it, where it does not run yet; its exports. */
export default async function init({ module_or_path } = {}) {
  if (wasm) return wasm;
  const response = await module_or_path;
  if (!response.ok) throw new Error(`${response.status} ${response.url}`);
  // A server that gives it another type keeps it from being compiled while it comes.
  const streams = response.headers.get("Content-Type") === "application/wasm";
  const imports = __wbg_get_imports();
  const { instance, module } = await (streams
    ? WebAssembly.instantiateStreaming(response, imports)
    : WebAssembly.instantiate(await response.arrayBuffer(), imports));
  return __wbg_finalize_init(instance, module);
}
