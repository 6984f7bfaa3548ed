/** Kinds of files, by their names. */

/** A STEP file, which has a baker of its own. */
export const STEP = /\.(step|stp|p21)$/i;
