// Types of imports that `rebounce-cli/vite` answers. In a declaration file of the app:
// /// <reference types="rebounce-cli/client" />

declare module "*?rebounce" {
  /** Address of the baked scene. */
  const src: string;
  export default src;
}

declare module "*&rebounce" {
  /** Address of the baked scene. */
  const src: string;
  export default src;
}
