// What a stage holds and loads: squares on particles that supports hold, arrows for forces and moments. Drawn over the
// body, or they would be hidden in the spheres.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, LineBasicMaterial, LineSegments, Points, PointsMaterial, Vector3 } from "three";

export const mark_colours = { fixed: [214, 86, 0], held: [255, 167, 38], force: [194, 24, 91], moment: [94, 53, 177] };
const translations = 0b111;              // of Holds.how
const longest = 0.2, shortest = 0.05;    // arrows, of the half size of the body
const strokes = 5;                       // of an arrow: its shaft and four of its head

const hex = ([r, g, b]) => (r << 16) | (g << 8) | b;

function overlay(object) {
  object.frustumCulled = false;
  return object;
}

function buffer(points) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * points), 3).setUsage(DynamicDrawUsage));
  return geometry;
}

/** Half the size of the box about the undeformed body. */
function half_size(reference) {
  let most = 0;
  for (const x of reference) most = Math.max(most, Math.abs(x));
  return most || 1;
}

/** Writes an arrow that ends at `tip`, from `at` of the array on. */
function put_arrow(array, at, tip, way, length) {
  const side = (Math.abs(way.x) < 0.7 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0)).cross(way).normalize(), other = side.clone().cross(way);
  const start = tip.clone().addScaledVector(way, -length), neck = tip.clone().addScaledVector(way, -0.3 * length);
  const ends = [start, ...[side, other].flatMap((v) => [1, -1].map((sign) => neck.clone().addScaledVector(v, 0.12 * sign * length)))];
  ends.forEach((end, k) => array.set([end.x, end.y, end.z, tip.x, tip.y, tip.z], at + 6 * k));
}

export class Marks {
  /** `holds` of a stage: run.js, Holds. */
  constructor(holds, reference) {
    this.holds = holds;
    this.size = half_size(reference);
    const look = { depthTest: false, transparent: true };
    const squares = (kind, size, is_one) => {
      const entries = [...holds.held.keys()].filter(is_one), material = new PointsMaterial({ ...look, color: hex(mark_colours[kind]), size, sizeAttenuation: false });
      return { kind, entries, object: overlay(new Points(buffer(entries.length), material)) };
    };
    const is_fixed = (n) => (holds.how[n] & translations) === translations;
    this.points = [squares("fixed", 9, is_fixed), squares("held", 5, (n) => !is_fixed(n))];
    this.arrows = ["force", "moment"].map((kind) => {
      const entries = [...holds.loaded.keys()].filter((k) => holds.size(k, kind) > 0);
      return { kind, entries, most: Math.max(0, ...entries.map((k) => holds.size(k, kind))),
               object: overlay(new LineSegments(buffer(2 * strokes * entries.length), new LineBasicMaterial({ ...look, color: hex(mark_colours[kind]) }))) };
    });
    this.all = [...this.points, ...this.arrows];
    this.objects = this.all.map(({ object }) => object);
  }

  /** `place(k)`: where particle k is. */
  put(place) {
    for (const { entries, object } of this.points) {
      const { position } = object.geometry.attributes;
      entries.forEach((n, at) => position.array.set(place(this.holds.held[n]).toArray(), 3 * at));
      position.needsUpdate = true;
    }
    for (const { kind, entries, most, object } of this.arrows) {
      const { position } = object.geometry.attributes;
      entries.forEach((k, n) => {
        const load = new Vector3().fromArray(this.holds.load(k, kind)), size = load.length();
        put_arrow(position.array, 6 * strokes * n, place(this.holds.loaded[k]), load.divideScalar(size), this.size * Math.max(shortest, (longest * size) / most));
      });
      position.needsUpdate = true;
    }
  }

  /** Kinds of marks that there are. */
  get kinds() { return this.all.filter(({ entries }) => entries.length).map(({ kind }) => kind); }

  close() {
    for (const object of this.objects) {
      object.removeFromParent();
      object.geometry.dispose();
      /** @type {any} */ (object.material).dispose();
    }
  }
}
