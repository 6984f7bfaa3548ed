/** Starts the compiled module; its exports. */
export default async function init(module) {
  const instance = await WebAssembly.instantiate(module, __wbg_get_imports());
  return __wbg_finalize_init(instance, module);
}
