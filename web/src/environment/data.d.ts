/** The bundler puts binary files into modules, as base64. */
declare module "*.bin" {
  const base64: string;
  export default base64;
}
