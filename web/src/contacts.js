// The contacts of a run: between whom, how strong, and where their lines end. No drawing.
import { stored } from "./decode.js";

const per_placed = 6;   // numbers of a contact whose ends are not both at centres: from i to one end, from j to the other

export class Contacts {
  /** `frames` of the sequence: those that were written with contacts say how many. */
  constructor({ i, j, force, shift }, frames, block) {
    this.frames = frames;
    this.i = stored(block, i);
    this.j = stored(block, j);
    this.q = stored(block, force);
    this.shift = stored(block, shift);
    this.scale = shift;
    let first = 0, placed = 0;
    this.begin = frames.map(({ contacts: c }) => {
      const begin = { first, placed };
      first += c?.count ?? 0;
      placed += c?.placed ?? 0;
      return begin;
    });
  }

  /** Whether the frame tells of contacts. */
  written(frame) { return !!this.frames[frame].contacts; }

  count(frame) { return this.frames[frame].contacts?.count ?? 0; }

  /** The most that a frame has. */
  get most() { return this.frames.reduce((most, _, frame) => Math.max(most, this.count(frame)), 0); }

  /** The two particles of contact k; of a wall twice the same. */
  between(frame, k) { const n = this.begin[frame].first + k; return [this.i[n], this.j[n]]; }

  /** Normal force of contact k; repulsion is positive. */
  force(frame, k) {
    const { low, step } = this.frames[frame].contacts;
    return low + step * this.q[this.begin[frame].first + k];
  }

  /** The largest size of a force in the frame. */
  largest(frame) {
    let most = 0;
    for (let k = 0, n = this.count(frame); k < n; ++k) most = Math.max(most, Math.abs(this.force(frame, k)));
    return most;
  }

  /** From the centre of i to one end of its line, then from that of j to the other: six numbers; null if these are its ends. */
  ends(frame, k) {
    const { count, placed } = this.frames[frame].contacts, n = k - (count - placed);
    if (n < 0) return null;
    const at = per_placed * (this.begin[frame].placed + n), { low, step } = this.scale;
    return Array.from({ length: per_placed }, (_, c) => low + step * this.shift[at + c]);
  }
}
