// Shapes as triangles: positions, normals, indices. Metres; y is up; what is seen from outside turns counterclockwise.

/** Degrees to radians. */
export const radians = (degrees) => (degrees * Math.PI) / 180;

/** One shape of several. */
export function joined(...shapes) {
  const all = { positions: [], normals: [], indices: [] };
  for (const { positions, normals, indices } of shapes.flat()) {
    const first = all.positions.length;
    all.positions.push(...positions);
    all.normals.push(...normals);
    all.indices.push(...indices.map((index) => index + first));
  }
  return all;
}

/** A shape that is scaled, tilted about x, turned about y (degrees, counterclockwise seen from above), and moved. */
export function placed(shape, { at = [0, 0, 0], turn = 0, tilt = 0, scale = [1, 1, 1] }) {
  const [[s, c], [u, v]] = [turn, tilt].map((angle) => [Math.sin(radians(angle)), Math.cos(radians(angle))]);
  const turned = ([x, y, z]) => {
    const [up, ahead] = [v * y - u * z, u * y + v * z];
    return [c * x + s * ahead, up, c * ahead - s * x];
  };
  return {
    positions: shape.positions.map((point) => turned(point.map((x, i) => x * scale[i])).map((x, i) => x + at[i])),
    normals: shape.normals.map((normal) => unit(turned(normal.map((x, i) => x / scale[i])))),
    indices: shape.indices,
  };
}

/** A shape that is seen from inside. */
export function inward({ positions, normals, indices }) {
  const turned = indices.map((_, i) => indices[3 * Math.floor(i / 3) + [0, 2, 1][i % 3]]);
  return { positions, normals: normals.map((normal) => normal.map((x) => -x)), indices: turned };
}

/** A flat polygon that is convex. */
export function polygon(...corners) {
  const [a, b, c] = corners;
  const normal = unit(cross(minus(b, a), minus(c, a)));
  const indices = corners.slice(2).flatMap((_, i) => [0, i + 1, i + 2]);
  return { positions: corners, normals: corners.map(() => normal), indices };
}

/** A box between two corners; `without` names faces that are left out, as "+y -z". */
export function box([x0, y0, z0], [x1, y1, z1], without = "") {
  const faces = {
    "-x": [[x0, y0, z0], [x0, y0, z1], [x0, y1, z1], [x0, y1, z0]],
    "+x": [[x1, y0, z1], [x1, y0, z0], [x1, y1, z0], [x1, y1, z1]],
    "-y": [[x0, y0, z0], [x1, y0, z0], [x1, y0, z1], [x0, y0, z1]],
    "+y": [[x0, y1, z1], [x1, y1, z1], [x1, y1, z0], [x0, y1, z0]],
    "-z": [[x1, y0, z0], [x0, y0, z0], [x0, y1, z0], [x1, y1, z0]],
    "+z": [[x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1]],
  };
  return joined(Object.entries(faces).flatMap(([name, corners]) => (without.includes(name) ? [] : [polygon(...corners)])));
}

/** A box of a size, rounded by a radius, whose base is centred at 0. */
export function cushion([width, height, depth], radius, steps = 4) {
  const [hx, hz] = [width / 2 - radius, depth / 2 - radius];
  const rings = [];
  for (const top of [false, true]) {
    for (let i = 0; i <= steps; i += 1) {
      const latitude = radians((90 * i) / steps - (top ? 0 : 90));
      const ring = [];
      for (let quarter = 0; quarter < 4; quarter += 1) {
        const [sx, sz] = [[1, 1], [-1, 1], [-1, -1], [1, -1]][quarter];
        for (let j = 0; j <= steps; j += 1) {
          const longitude = radians(90 * (quarter + j / steps));
          const normal = [Math.cos(latitude) * Math.cos(longitude), Math.sin(latitude), Math.cos(latitude) * Math.sin(longitude)];
          const middle = [sx * hx, top ? height - radius : radius, sz * hz];
          ring.push({ position: middle.map((x, k) => x + radius * normal[k]), normal });
        }
      }
      rings.push(ring);
    }
  }
  const y = [0, height];
  const caps = y.map((y, top) => {
    const corners = [[hx, y, hz], [-hx, y, hz], [-hx, y, -hz], [hx, y, -hz]];
    return polygon(...(top ? corners.reverse() : corners));
  });
  return joined(grid(rings, true), caps);
}

/** What a profile of points [radius, y], from below, sweeps around the y axis; `sharp` has an edge at each point. */
export function lathe(profile, { steps = 32, sharp = false, from = 0, to = 360 } = {}) {
  const around = (part, normals) =>
    part.map(([radius, y], i) =>
      Array.from({ length: steps + 1 }, (_, j) => {
        const angle = radians(from + ((to - from) * j) / steps);
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        const [out, up] = normals[i];
        return { position: [radius * c, y, radius * s], normal: [out * c, up, out * s] };
      }),
    );
  const slope = ([r0, y0], [r1, y1]) => {
    const length = Math.hypot(r1 - r0, y1 - y0) || 1;
    return [(y1 - y0) / length, (r0 - r1) / length];
  };
  const slopes = profile.slice(1).map((point, i) => slope(profile[i], point));
  if (sharp) return joined(slopes.map((normal, i) => grid(around(profile.slice(i, i + 2), [normal, normal]), false)));
  const normals = profile.map((_, i) => {
    const [a, b] = [slopes[Math.max(i - 1, 0)], slopes[Math.min(i, slopes.length - 1)]];
    const length = Math.hypot(a[0] + b[0], a[1] + b[1]) || 1;
    return [(a[0] + b[0]) / length, (a[1] + b[1]) / length];
  });
  return grid(around(profile, normals), false);
}

/** A ball whose middle is at 0. */
export function ball(radius, steps = 24) {
  const rings = steps / 2;
  const profile = Array.from({ length: rings + 1 }, (_, i) => {
    const latitude = radians((180 * i) / rings - 90);
    return [i % rings ? radius * Math.cos(latitude) : 0, radius * Math.sin(latitude)];
  });
  return lathe(profile, { steps });
}

/** An upright cylinder with its ends, standing at 0. */
export const cylinder = (radius, height, steps = 32) => lathe([[0, 0], [radius, 0], [radius, height], [0, height]], { steps, sharp: true });

/** Points from a to b on a circle around a middle, in the plane of two axes; degrees. */
export function arc([x, y], radius, from, to, steps) {
  return Array.from({ length: steps + 1 }, (_, i) => {
    const angle = radians(from + ((to - from) * i) / steps);
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

/** Rows of points as triangles, each row above the one before; `isClosed` joins a row's end to its beginning. */
function grid(rows, isClosed) {
  const width = rows[0].length;
  const indices = [];
  for (let i = 0; i + 1 < rows.length; i += 1) {
    for (let j = 0; j < (isClosed ? width : width - 1); j += 1) {
      const [a, b] = [i * width + j, i * width + ((j + 1) % width)];
      for (const triangle of [[a, a + width, b], [b, a + width, b + width]]) {
        if (!isFlat(triangle.map((k) => rows[Math.floor(k / width)][k % width].position))) indices.push(...triangle);
      }
    }
  }
  const points = rows.flat();
  return { positions: points.map(({ position }) => position), normals: points.map(({ normal }) => normal), indices };
}

const isFlat = ([a, b, c]) => Math.hypot(...cross(minus(b, a), minus(c, a))) < 1e-9;
export const minus = (a, b) => a.map((x, i) => x - b[i]);
export const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
export const unit = (vector) => vector.map((x) => x / (Math.hypot(...vector) || 1));
