// The walls of a run: where the corners of their triangles are in a frame. No drawing.
import { stored } from "./decode.js";

const per_wall = 12;   // numbers of a motion: a rotation row by row, and a shift

export class Walls {
  constructor({ corners, triangles, wall, motion }, block, frames) {
    this.corners = stored(block, corners);
    this.triangles = stored(block, triangles);
    this.wall = stored(block, wall);
    this.motion = stored(block, motion);
    this.count = this.motion.length / frames / per_wall;
  }

  /** x, y, z of all corners in the frame, into `out`. */
  positions(frame, out) {
    const { corners, motion, wall } = this;
    for (let k = 0; k < wall.length; ++k) {
      const m = per_wall * (frame * this.count + wall[k]), x = corners[3 * k], y = corners[3 * k + 1], z = corners[3 * k + 2];
      for (let c = 0; c < 3; ++c) {
        out[3 * k + c] = motion[m + 3 * c] * x + motion[m + 3 * c + 1] * y + motion[m + 3 * c + 2] * z + motion[m + 9 + c];
      }
    }
    return out;
  }
}
