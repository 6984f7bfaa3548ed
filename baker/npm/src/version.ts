/** The version of the package: the build writes it here. */
export const VERSION = "version-of-the-package";
