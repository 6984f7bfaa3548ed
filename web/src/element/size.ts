/** The canvas's size in device pixels: follows the element's box and the page's zoom. */

/** More device pixels per CSS pixel than this cost time and show little. */
const MAX_PIXEL_RATIO = 2;

/** Watches the size of one element. */
export class Size {
  #element: Element;
  #apply: (width: number, height: number) => void;
  #observer: ResizeObserver;
  #watching: AbortController | undefined;

  /** `apply` is called with width and height whenever they may have changed. */
  constructor(element: Element, apply: (width: number, height: number) => void) {
    this.#element = element;
    this.#apply = apply;
    this.#observer = new ResizeObserver((entries) => this.measure(entries[entries.length - 1]?.contentRect));
  }

  /** Begins to watch. */
  watch(): void {
    this.#observer.observe(this.#element);
    this.#watchRatio();
  }

  /** Stops. */
  stop(): void {
    this.#observer.disconnect();
    this.#watching?.abort();
  }

  /** Tells the present size. */
  measure(box: DOMRectReadOnly = this.#element.getBoundingClientRect()): void {
    const ratio = Math.min(devicePixelRatio || 1, MAX_PIXEL_RATIO);
    this.#apply(Math.max(1, Math.round(box.width * ratio)), Math.max(1, Math.round(box.height * ratio)));
  }

  /** The page is zoomed, or moved to another screen: no box changes, but the pixels do. */
  #watchRatio(): void {
    this.#watching?.abort();
    this.#watching = new AbortController();
    const changed = () => {
      this.measure();
      this.#watchRatio();
    };
    const { signal } = this.#watching;
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener("change", changed, { once: true, signal });
  }
}
