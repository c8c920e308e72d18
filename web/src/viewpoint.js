// From where to look.
import { Vector3 } from "three";

const frames_looked_at = 20;

/** The frames looked at, the last one first: places of particles, then the corners of the cell. */
function* sample(run, sequence, factor, wrapped) {
  const every = Math.max(1, Math.floor(sequence.frames.length / frames_looked_at));
  const count = 3 * run.particles, xyz = new Float32Array(count + (sequence.cell?.lines(sequence.cell.at(0, 1)).length ?? 0));
  for (let f = sequence.last; f >= 0; f -= every) {
    sequence.positions(f, factor, xyz, 3);
    if (sequence.cell) {
      const cell = sequence.cell.at(f, factor);
      if (wrapped) sequence.cell.bring(cell, sequence.cell.images(cell, xyz, run.particles, 3), xyz, 3);
      xyz.set(sequence.cell.lines(cell), count);
    }
    yield xyz;
  }
}

/**
 * Box {centre, half} that holds the body and its cell in (a sample of) all frames, and the radius of a sphere about its
 * centre that does. `wrapped`: particles are shown in the cell.
 */
export function bounds(run, sequence, factor, wrapped = false) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const xyz of sample(run, sequence, factor, wrapped)) {
    for (let k = 0; k < xyz.length; ++k) {
      const c = k % 3, r = run.radius[(k - c) / 3] ?? 0;
      if (xyz[k] - r < low[c]) low[c] = xyz[k] - r;
      if (xyz[k] + r > high[c]) high[c] = xyz[k] + r;
    }
  }
  const [x, y, z] = low.map((l, c) => (l + high[c]) / 2);
  let radius = 0;
  for (const xyz of sample(run, sequence, factor, wrapped)) {
    for (let k = 0; 3 * k < xyz.length; ++k) {
      const dx = xyz[3 * k] - x, dy = xyz[3 * k + 1] - y, dz = xyz[3 * k + 2] - z;
      radius = Math.max(radius, Math.sqrt(dx * dx + dy * dy + dz * dz) + (run.radius[k] ?? 0));
    }
  }
  return { centre: new Vector3(x, y, z), half: new Vector3(...high.map((h, c) => (h - low[c]) / 2)), radius };
}

const axis = { x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1) };

/** View along an axis: "+x" is seen from the side of positive x. */
export function along(name) {
  const direction = axis[name[1]].clone().multiplyScalar(name[0] === "-" ? -1 : 1);
  return { direction, up: name[1] === "z" ? axis.y : axis.z };
}

const flat_below = 0.2;   // thickness over the second length: a body so thin is seen across its plane

/** What is flat is seen across its plane, a rod across the plane in which it bends most, other bodies from a corner. */
export function first_view({ half }, thickest_particle) {
  const [thin, middle, long] = ["x", "y", "z"].sort((a, b) => half[a] - half[b]);
  const flat = half[thin] <= Math.max(1.001 * thickest_particle, flat_below * half[middle]);
  if (!flat && (half[middle] > 0.6 * half[long] || half[thin] > 0.25 * half[long])) return { direction: new Vector3(0.55, -1, 0.5), up: axis.z };
  const direction = axis[thin].clone().multiplyScalar(thin === "y" ? -1 : 1);
  return { direction, up: thin === "z" ? axis.y : axis.z };
}
