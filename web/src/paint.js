// Values of a quantity to colours of particles and bonds.
import { maps, scale_ends, shade } from "./colours.js";
import { channels, class_colours, fragment_colours, picked_colour } from "./palette.js";
import { widest_bond } from "./scene.js";

export const small_spheres = 0.45;   // of the true radius, when bonds carry the colour
const tiny_spheres = 0.25;           // when contacts are shown
const thin_bonds = 0.3;              // of the usual width, likewise; none where contacts carry the colour
const neutral = { particles: channels("#8b929c"), bonds: channels("#9aa1ab"), contacts: channels("#6f7682") };
const class_widths = [1, 1.3, widest_bond];

function fill(colours, count, [r, g, b], width = 1) {
  const alpha = (255 * width) / widest_bond;
  for (let k = 0; k < 4 * count; k += 4) {
    colours[k] = r; colours[k + 1] = g; colours[k + 2] = b; colours[k + 3] = alpha;
  }
}

/** How a quantity is shown: its table of colours and the ends of its scale, the same in all frames; `wanted` are those of the reader. */
export function scale_of(quantity, map, wanted) {
  if (quantity.classes) return { classes: quantity.classes };
  if (quantity.ends) return { table: maps[map], ends: wanted ?? quantity.ends, wanted };
  const extremes = quantity.extremes();
  const signed = quantity.signed && extremes[0] < 0;
  return { table: maps[signed ? "diverging" : map], ends: wanted ?? scale_ends(extremes, signed), signed, wanted };
}

function paint_classes(quantity, frame, colours, count) {
  const table = quantity.on === "bonds" ? class_colours : fragment_colours;
  for (let k = 0; k < count; ++k) {
    const c = quantity.class_of(frame, k);
    colours.set(table[c], 4 * k);
    if (quantity.on === "bonds") colours[4 * k + 3] = (255 * class_widths[c]) / widest_bond;
  }
}

/** Of a broken bond its two particles show where it was. */
function paint_picked(scene, sequence, frame, { kind, number }) {
  const broken = kind === "bond" && sequence.broken.cause(frame, number);
  if (kind === "bond" && !broken) scene.bond_colours.array.set([...picked_colour, 255], 4 * number);
  for (const k of kind === "particle" ? [number] : broken ? scene.run.ends_of(number) : []) scene.sphere_colours.array.set(picked_colour, 4 * k);
}

function paint_values(quantity, frame, colours, count, { table, ends }) {
  for (let k = 0; k < count; ++k) {
    const t = 3 * shade(quantity.value(frame, k), ends);
    colours[4 * k] = table[t]; colours[4 * k + 1] = table[t + 1]; colours[4 * k + 2] = table[t + 2];
    colours[4 * k + 3] = 255 / widest_bond;
  }
}

/** What carries the colour: its table and how many there are. */
function painted(scene, sequence, frame, on) {
  if (on === "contacts") return [scene.contact_colours.array, sequence.contacts.count(frame)];
  return on === "bonds" ? [scene.bond_colours.array, sequence.bonds_at(frame)] : [scene.sphere_colours.array, sequence.particles];
}

/** Of spheres: contacts lie within them, and bonds are better seen between small ones. */
function automatic_size(quantity, contacts) { return contacts ? tiny_spheres : quantity.on === "bonds" ? small_spheres : 1; }

/** Writes the colours of a frame into the scene; `size` 0 lets the quantity choose the size of the spheres. `contacts`: they are shown. */
export function paint(scene, sequence, frame, quantity, scale, size, picked, contacts) {
  fill(scene.sphere_colours.array, sequence.particles, neutral.particles);
  fill(scene.bond_colours.array, sequence.bonds_at(frame), neutral.bonds, quantity.on === "contacts" ? 0 : contacts ? thin_bonds : 1);
  if (contacts) fill(scene.contact_colours.array, sequence.contacts.count(frame), neutral.contacts);
  const [colours, count] = painted(scene, sequence, frame, quantity.on);
  if (quantity.classes) paint_classes(quantity, frame, colours, count);
  else paint_values(quantity, frame, colours, count, scale);
  for (const { bond } of sequence.broken.until(frame)) scene.bond_colours.array[4 * bond + 3] = 0;   // no width
  if (picked) paint_picked(scene, sequence, frame, picked);
  scene.colours_changed(size || automatic_size(quantity, contacts));
}
