// A run as the page uses it: decoded when asked for, and only then.
import { stored } from "./decode.js";
import { Broken } from "./broken.js";
import { Cell, in_edges } from "./cell.js";
import { Contacts } from "./contacts.js";
import { fragment_colour_count } from "./palette.js";
import { nearest } from "./history.js";
import { number } from "./text.js";
import { Walls } from "./walls.js";

const energy_keys = ["U_L", "U_B", "U_T"];
export const contact_key = "contact_force";

function once(make) {
  let made;
  return () => (made ??= make());
}

/** Smallest and largest of what `value` gives for each frame and index; [0, 0] if there is none. */
function extremes(frames, count, value) {
  let low = Infinity, high = -Infinity;
  for (let f = 0; f < frames; ++f) {
    for (let k = 0, n = count(f); k < n; ++k) {
      const v = value(f, k);
      if (v < low) low = v;
      if (v > high) high = v;
    }
  }
  return low <= high ? [low, high] : [0, 0];
}

/** A mode has a shape and no size, so its values have none: parts of the largest instead of metres or joules. */
function relative(quantity) {
  const most = once(() => Math.max(...quantity.extremes().map(Math.abs)) || 1);
  return { ...quantity, label: `${quantity.label}, relative to the largest`, unit: "",
           value: (f, k) => quantity.value(f, k) / most(), extremes: once(() => quantity.extremes().map((v) => v / most())) };
}

/**
 * 0 for particles of the heaviest fragment, else one of the other colours: by the lowest particle of the fragment, since
 * numbers of fragments change from frame to frame.
 */
export function fragment_classes(fragment) {
  const of_fragment = new Map([[0, 0]]);
  return Uint8Array.from(fragment, (which, k) => {
    if (!of_fragment.has(which)) of_fragment.set(which, 1 + ((Math.imul(k + 1, 0x9e3779b1) >>> 16) % (fragment_colour_count - 1)));
    return of_fragment.get(which);
  });
}

/** One animation: the run, or the swing of a mode. Positions in the unit of length of the run. */
export class Sequence {
  constructor(json, block, particles, ends, length_unit, images) {
    this.json = json;
    this.block = block;
    this.particles = particles;
    this.ends = ends;
    this.bonds = ends.length / 2;
    this.images = images;
    this.length_unit = length_unit;
    this.frames = json.frames;
    this.reference = stored(block, json.reference);
    this.displaced = once(() => stored(block, json.displacement));
    this.there = json.there && stored(block, json.there);
    this.broken = new Broken(this, json.bond_broken && stored(block, json.bond_broken));
    this.walls = json.walls && new Walls(json.walls, block, json.frames.length);
    this.cell = json.cell && new Cell(json.cell, block);
    this.contacts = json.contacts && new Contacts(json.contacts, json.frames, block);
    this.quantities = this.list_quantities();
  }

  get last() { return this.frames.length - 1; }

  /** The frame whose step is nearest to `step`. */
  nearest_frame(step) { return nearest(this.frames.map((f) => f.step), step); }

  bonds_at(frame) { return this.frames[frame].bonds; }

  /** Displacement of particle k in the frame, component c. */
  displacement(frame, k, c) {
    const { low, step } = this.json.displacement;
    return low[c] + step[c] * this.displaced()[(3 * frame + c) * this.particles + k];
  }

  /** Whether particle k has come in by this frame, and is not gone. */
  is_there(frame, k) { return !this.there || this.there[frame * this.particles + k] !== 0; }

  /**
   * x, y, z of all particles into `out`, `stride` apart, displacements times `factor`. Those that are not there stand where
   * the first one that is there does: nothing looks for room for them.
   */
  positions(frame, factor, out, stride) {
    for (let c = 0; c < 3; ++c) {
      for (let k = 0; k < this.particles; ++k) {
        out[stride * k + c] = this.reference[3 * k + c] + factor * this.displacement(frame, k, c);
      }
    }
    if (this.there) {
      let first = 0;
      while (first < this.particles && !this.is_there(frame, first)) ++first;
      for (let k = 0; first < this.particles && k < this.particles; ++k) {
        if (this.is_there(frame, k)) continue;
        for (let c = 0; c < 3; ++c) out[stride * k + c] = out[stride * first + c];
      }
    }
    return out;
  }

  /** From particle j of a bond to the image of it that the bond joins; `cell` is that of the frame. */
  to_image(bond, cell) { return this.images && cell ? in_edges(cell, this.images.subarray(3 * bond, 3 * bond + 3)) : [0, 0, 0]; }

  list_quantities() {
    const fields = this.json.bond_fields.map((field) => this.bond_quantity(field));
    const parts = energy_keys.map((key) => fields.find((f) => f.key === key)).filter(Boolean);
    const list = [this.displacement_quantity(), ...this.json.particle_fields.map((field) => this.particle_quantity(field))];
    list.push(...fields.filter((f) => !parts.includes(f)));
    if (parts.length === energy_keys.length) list.push(this.total_energy(parts));
    list.push(...parts);
    const shown = this.json.kind === "mode" ? list.map(relative) : list;
    if (this.json.bond_range) shown.push(this.range_quantity());
    if (this.json.fragment) shown.push(this.fragment_quantity());
    if (this.contacts) shown.push(this.contact_quantity());
    return shown;
  }

  displacement_quantity() {
    const size = (x, y, z) => Math.sqrt(x * x + y * y + z * z);   // Math.hypot is many times slower
    return this.on_particles("displacement", "Displacement", this.length_unit, false, (f, k) =>
      size(this.displacement(f, k, 0), this.displacement(f, k, 1), this.displacement(f, k, 2)));
  }

  on_particles(key, label, unit, signed, value) {
    const count = () => this.particles;
    return { key, label, unit, signed, on: "particles", value, extremes: once(() => extremes(this.frames.length, count, value)) };
  }

  on_bonds(key, label, unit, signed, value) {
    const count = (f) => this.bonds_at(f);
    return { key, label, unit, signed, on: "bonds", value, extremes: once(() => extremes(this.frames.length, count, value)) };
  }

  particle_quantity({ key, label, unit, signed, array }) {
    const q = once(() => stored(this.block, array));
    return this.on_particles(key, label, unit, !!signed, (f, k) => array.low + array.step * q()[f * this.particles + k]);
  }

  bond_quantity({ key, label, unit, signed, array }) {
    const q = once(() => stored(this.block, array));
    const degrees = unit === "rad";
    const factor = degrees ? 180 / Math.PI : 1;
    const value = (f, k) => factor * (array.low + array.step * q()[f * this.bonds + k]);
    const quantity = this.on_bonds(key, label, degrees ? "°" : unit, signed, value);
    return key === "utilisation" ? { ...quantity, ends: [0, 1] } : quantity;   // of 1, where bonds break
  }

  total_energy(parts) {
    const value = (f, k) => parts[0].value(f, k) + parts[1].value(f, k) + parts[2].value(f, k);
    return this.on_bonds("U", "Energy of the bond, total", parts[0].unit, false, value);
  }

  range_quantity() {
    const q = once(() => stored(this.block, this.json.bond_range));
    const quantity = this.on_bonds("range", "Range of the bond", "", false, (f, k) => q()[f * this.bonds + k]);
    return { ...quantity, classes: ["small", "strained", "snapped"], class_of: quantity.value };
  }

  contact_quantity() {
    const { contacts } = this, value = (f, k) => contacts.force(f, k);
    return { key: contact_key, label: "normal force of contacts", unit: this.json.contacts.unit, signed: true, on: "contacts", value,
             extremes: once(() => extremes(this.frames.length, (f) => contacts.count(f), value)) };
  }

  fragment_quantity() {
    const q = once(() => stored(this.block, this.json.fragment));
    const quantity = this.on_particles("fragment", "Fragment", "", false, (f, k) => q()[f * this.particles + k]);
    let known = { frame: -1 };
    const classes_in = (frame) => {
      if (known.frame !== frame) known = { frame, classes: fragment_classes(q().subarray(frame * this.particles, (frame + 1) * this.particles)) };
      return known.classes;
    };
    return { ...quantity, classes: ["heaviest", "others"], class_of: (f, k) => classes_in(f)[k] };
  }
}

const degrees_of_freedom = ["x", "y", "z", "rx", "ry", "rz"];

/** What a stage holds and loads. */
export class Holds {
  constructor(json, block) {
    this.name = json.name;
    this.held = stored(block, json.held);
    this.how = stored(block, json.how);
    this.loaded = stored(block, json.loaded);
    this.loads = stored(block, json.loads);
  }

  /** "force" or "moment" of entry k of `loaded`, three numbers; and its size. */
  load(k, kind) { const from = 6 * k + (kind === "moment" ? 3 : 0); return [...this.loads.subarray(from, from + 3)]; }
  size(k, kind) { return Math.hypot(...this.load(k, kind)); }

  /** Of particle k in words: [label, text] each. */
  words(k) {
    const n = this.held.indexOf(k), m = this.loaded.indexOf(k), all = [];
    if (n >= 0) all.push(["Held in", degrees_of_freedom.filter((_, dof) => (this.how[n] >> dof) & 1).join(", ")]);
    for (const kind of ["force", "moment"]) {
      if (m >= 0 && this.size(m, kind)) all.push([`Given ${kind}`, this.load(m, kind).map((x) => number(x)).join(", ")]);
    }
    return all;
  }
}

export class Run {
  constructor(json, block, time_unit = "") {
    if (json.format !== 1) throw new Error(`The page reads format 1, the data are of format ${json.format}.`);
    this.json = json;
    this.ends = stored(block, json.bonds);
    const reference = json.sequences[0]?.reference;
    this.particles = reference ? reference.count / 3 : 0;
    this.radius = typeof json.radius === "number" ? new Float32Array(this.particles).fill(json.radius) : stored(block, json.radius);
    this.bond_radius = json.bond_radius && stored(block, json.bond_radius);
    this.bond_image = json.bond_image && stored(block, json.bond_image);
    const length_unit = json.units === "SI" ? "m" : "";
    this.length_unit = length_unit;
    this.time_unit = time_unit;
    this.stages = new Map((json.stages ?? []).map((stage) => [stage.name, new Holds(stage, block)]));
    this.sequences = json.sequences.map((s) => new Sequence(s, block, this.particles, this.ends, length_unit, this.bond_image));
  }

  /** What the stage of a frame holds and loads, or undefined. */
  holds_in(sequence, frame) { return this.stages.get(sequence.frames[frame].stage); }

  /** The two particles of a bond. */
  ends_of(bond) { return [this.ends[2 * bond], this.ends[2 * bond + 1]]; }
}
