/** Whether an element is in the visible part of the page or near it. */

/** How near counts, CSS pixels. */
const MARGIN = "200px";

/** Watches one element. Before the browser has told, it is neither known to be visible nor hidden. */
export class OnScreen {
  #state: boolean | undefined;
  #element: Element;
  #observer: IntersectionObserver;

  /** `appears` is called whenever the element comes into view. */
  constructor(element: Element, appears: () => void) {
    this.#element = element;
    this.#observer = new IntersectionObserver(
      (entries) => {
        const before = this.#state;
        this.#state = entries[entries.length - 1]?.isIntersecting;
        if (this.#state && !before) appears();
      },
      { rootMargin: MARGIN },
    );
  }

  /** Known to be in view. */
  get visible(): boolean {
    return this.#state === true;
  }

  /** Known to be out of view. */
  get hidden(): boolean {
    return this.#state === false;
  }

  /** Begins to watch. */
  watch(): void {
    this.#observer.observe(this.#element);
  }

  /** Stops, and forgets. */
  stop(): void {
    this.#observer.disconnect();
    this.#observer.takeRecords();
    this.#state = undefined;
  }
}
