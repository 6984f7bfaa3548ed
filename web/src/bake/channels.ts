/** Channels between the workers of a bake. */

/** Returns the ports of each worker to every other, by rank; `null` to itself. */
export function channels(size: number): (MessagePort | null)[][] {
  const ports: (MessagePort | null)[][] = Array.from({ length: size }, () => new Array<null>(size).fill(null));
  for (let a = 0; a < size; a += 1) {
    for (let b = 0; b < a; b += 1) {
      const { port1, port2 } = new MessageChannel();
      ports[a]![b] = port1;
      ports[b]![a] = port2;
    }
  }
  return ports;
}
