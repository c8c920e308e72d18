// From where to look.
import { Vector3 } from "three";

const frames_looked_at = 40;

/** Box {centre, half} that holds the body in (a sample of) all frames. */
export function bounds(run, sequence, factor) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const every = Math.max(1, Math.floor(sequence.frames.length / frames_looked_at));
  const xyz = new Float32Array(3 * run.particles);
  for (let f = sequence.last; f >= 0; f -= every) {
    sequence.positions(f, factor, xyz, 3);
    for (let k = 0; k < xyz.length; ++k) {
      const c = k % 3, r = run.radius[(k - c) / 3];
      if (xyz[k] - r < low[c]) low[c] = xyz[k] - r;
      if (xyz[k] + r > high[c]) high[c] = xyz[k] + r;
    }
  }
  const vector = (of) => new Vector3(of(0), of(1), of(2));
  return { centre: vector((c) => (low[c] + high[c]) / 2), half: vector((c) => (high[c] - low[c]) / 2) };
}

const axis = { x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1) };

/** View along an axis: "+x" is seen from the side of positive x. */
export function along(name) {
  const direction = axis[name[1]].clone().multiplyScalar(name[0] === "-" ? -1 : 1);
  return { direction, up: name[1] === "z" ? axis.y : axis.z };
}

/** A rod is seen across the plane in which it bends, other bodies from a corner. */
export function first_view({ half }) {
  const [thin, middle, long] = ["x", "y", "z"].sort((a, b) => half[a] - half[b]);
  if (half[middle] > 0.6 * half[long]) return { direction: new Vector3(0.55, -1, 0.5), up: axis.z };
  const direction = axis[thin].clone().multiplyScalar(thin === "y" ? -1 : 1);
  return { direction, up: thin === "z" ? axis.y : axis.z };
}
