// The cell of a periodic body: where it is in a frame, which image of a particle stands in it. No drawing.
import { stored } from "./decode.js";

const per_frame = 12;   // numbers: the edges a, b and c, and the corner where they begin

const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export class Cell {
  constructor({ edges, periodic }, block) {
    this.numbers = stored(block, edges);
    this.periodic = periodic;
  }

  /** {edges, corner} of the frame, what has changed since the first one times `factor`. */
  at(frame, factor) {
    const { numbers } = this;
    const now = Array.from({ length: per_frame }, (_, k) => numbers[k] + factor * (numbers[per_frame * frame + k] - numbers[k]));
    return { edges: [now.slice(0, 3), now.slice(3, 6), now.slice(6, 9)], corner: now.slice(9) };
  }

  /** The ends of the lines that show it, x, y, z of each; along an edge that is open there are none. */
  lines({ edges, corner }) {
    const all = [], axes = [0, 1, 2].filter((k) => this.periodic[k]);
    for (const k of axes) {
      for (let n = 0; n < 8; ++n) {
        if ((n >> k) & 1 || [0, 1, 2].some((axis) => (n >> axis) & 1 && !this.periodic[axis])) continue;
        for (const m of [n, n | (1 << k)]) all.push(...[0, 1, 2].map((c) => corner[c] + edges.reduce((sum, edge, axis) => sum + ((m >> axis) & 1) * edge[c], 0)));
      }
    }
    return all;
  }

  /** Which image of each of `count` particles stands in the cell, three numbers each; `places` are x, y, z, `stride` apart. */
  images({ edges, corner }, places, count, stride) {
    const [a, b, c] = edges, normals = [cross(b, c), cross(c, a), cross(a, b)], volume = dot(a, normals[0]);
    const images = new Int32Array(3 * count);
    for (let p = 0; p < count; ++p) {
      const from = [0, 1, 2].map((k) => places[stride * p + k] - corner[k]);
      for (let k = 0; k < 3; ++k) if (this.periodic[k]) images[3 * p + k] = -Math.floor(dot(from, normals[k]) / volume);
    }
    return images;
  }

  /** Puts these images in place of the particles. */
  bring({ edges }, images, places, stride) {
    for (let p = 0; 3 * p < images.length; ++p) {
      for (let k = 0; k < 3; ++k) for (let c = 0; c < 3; ++c) places[stride * p + c] += images[3 * p + k] * edges[k][c];
    }
  }
}

/** So many of each edge. */
export function in_edges({ edges: [a, b, c] }, n) { return [0, 1, 2].map((k) => n[0] * a[k] + n[1] * b[k] + n[2] * c[k]); }
