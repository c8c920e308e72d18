// What the colours mean, with numbers and units; and the three axes.
import { Vector3 } from "three";
import { css_colour, css_gradient } from "./colours.js";
import { cause_colours, causes, class_colours, fragment_colours } from "./palette.js";
import { mark_colours } from "./marks.js";
import { capital, element, number, with_unit } from "./text.js";

const meaning = {
  small: "small", strained: "strained: moments no longer grow", snapped: "snapped: pulls towards a wrong shape",
  heaviest: "the heaviest", others: "the others: colours repeat",
};

function swatch(rgb) { return element("span", { class: "swatch", style: { background: css_colour(rgb) } }); }

function swatches(title, items) { return element("div", { class: "legend classes" }, title, element("ul", {}, ...items)); }

export function legend(quantity, scale) {
  const title = element("p", { class: "legend-title" }, capital(quantity.unit ? `${quantity.label} [${quantity.unit}]` : quantity.label));
  if (scale.classes) {
    const colours = quantity.on === "bonds" ? class_colours.map((rgb) => [rgb]) : [fragment_colours.slice(0, 1), fragment_colours.slice(1)];
    return swatches(title, scale.classes.map((name, k) => element("li", {}, ...colours[k].map(swatch), meaning[name])));
  }
  const [low, high] = scale.ends;
  const bar = element("div", { class: "bar", style: { background: css_gradient(scale.table) } });
  const marks = low === high ? [low] : [low, (low + high) / 2, high];
  return element("div", { class: "legend" }, title, element("div", { class: "scale" }, bar,
    element("div", { class: "marks" }, ...marks.map((v) => element("span", {}, number(v, 3))))),
    scale.wanted ? element("span", {}, "chosen; what is beyond has the colour of the end") : null);
}

/** What the faces of broken bonds mean, of those that there are. */
export function faces_legend({ list }) {
  const there = [...new Set(list.map(({ cause }) => cause))].sort();
  const words = there.map((cause) => element("li", {}, swatch(cause_colours[cause]), causes[cause]));
  return there.length ? swatches(element("p", { class: "legend-title" }, "Faces of bonds that broke by"), words) : "";
}

/** What the lines of contacts mean in the frame; `widest`: the force of the widest, which the reader may have chosen. */
export function contacts_legend({ contacts, json }, frame, widest, is_chosen) {
  const force = with_unit(widest, json.contacts.unit, 3);
  const words = !contacts.written(frame) ? "This frame was written without contacts."
    : contacts.count(frame) === 0 ? "Nothing touches in this frame."
      : `Lines are as wide as the normal force of their contact: widest at ${force}, ${is_chosen ? "as chosen, and beyond" : "the largest of this frame"}.`;
  return element("p", { class: "legend" }, words);
}

/** What squares and arrows mean, of those that there are. */
export function marks_legend(kinds) {
  const words = { fixed: "held in x, y and z", held: "held in some direction", force: "forces", moment: "moments, by the right hand" };
  return kinds.length ? swatches(element("p", { class: "legend-title" }, "Marks"), kinds.map((kind) => element("li", {}, swatch(mark_colours[kind]), words[kind]))) : "";
}

const svg = "http://www.w3.org/2000/svg";
const axes = [{ name: "x", way: new Vector3(1, 0, 0) }, { name: "y", way: new Vector3(0, 1, 0) }, { name: "z", way: new Vector3(0, 0, 1) }];

function drawn(name, attributes, text) {
  const made = document.createElementNS(svg, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text) made.textContent = text;
  return made;
}

/** Draws the directions of x, y, z as the camera sees them into an SVG of 80 by 80. */
export function draw_axes(into, camera) {
  const turn = camera.quaternion.clone().invert();
  const seen = axes.map(({ name, way }) => ({ name, v: way.clone().applyQuaternion(turn) })).sort((a, b) => a.v.z - b.v.z);
  into.replaceChildren(...seen.flatMap(({ name, v }) => {
    const flat = Math.hypot(v.x, v.y) < 0.15;
    const line = drawn("line", { x1: 40, y1: 40, x2: 40 + 25 * v.x, y2: 40 - 25 * v.y, class: `axis-${name}` });
    if (flat) return [line];
    return [line, drawn("text", { x: 40 + 34 * v.x, y: 40 - 34 * v.y, class: `axis-${name}` }, name)];
  }));
}
