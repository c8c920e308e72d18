// Bonds that break: when, by what, and where their faces are. No elements.

export class Broken {
  /** `causes` of [frame][bond], 0 while whole; undefined where nothing breaks. */
  constructor(sequence, causes) {
    this.sequence = sequence;
    this.causes = causes;
    this.list = causes ? this.in_order() : [];
  }

  /** By what the bond is broken in the frame, 0 if it is whole. */
  cause(frame, bond) { return this.causes ? this.causes[frame * this.sequence.bonds + bond] : 0; }

  /** {bond, cause, frame: the first without it} in the order of frames. */
  in_order() {
    const list = [], { frames, bonds } = this.sequence, seen = new Uint8Array(bonds);
    for (let frame = 0; frame < frames.length; ++frame) {
      for (let bond = 0; bond < frames[frame].bonds; ++bond) {
        const cause = this.cause(frame, bond);
        if (cause && !seen[bond]) list.push({ bond, cause, frame });
        seen[bond] ||= cause;
      }
    }
    return list;
  }

  /** How many are broken in the frame, which is how many of the list. */
  count(frame) {
    let low = 0, high = this.list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.list[middle].frame <= frame) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  until(frame) { return this.list.slice(0, this.count(frame)); }

  /** Half the distance of a bond's particles when it was last seen whole: faces stay so far from them. */
  half_length({ bond, frame }) {
    const { sequence } = this, [i, j] = [sequence.ends[2 * bond], sequence.ends[2 * bond + 1]], at = Math.max(0, frame - 1);
    const to_image = sequence.to_image(bond, sequence.cell?.at(at, 1));
    const apart = [0, 1, 2].map((c) => to_image[c] + sequence.reference[3 * j + c] - sequence.reference[3 * i + c]
                                       + sequence.displacement(at, j, c) - sequence.displacement(at, i, c));
    return 0.5 * Math.hypot(...apart);
  }
}
