// Pictures of the ball: what makes them in a page and what reads them in Node agree on this.

/** Size of the pictures. */
export const SIZE = [160, 90];

/** Alpha of pixels that show the ball. */
export const IS_BALL = 7;
