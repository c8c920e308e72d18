// Colour maps as tables of 256 colours. All three can be told apart with common colour blindness.
import { interpolateCividis, interpolateRdBu, interpolateViridis } from "d3-scale-chromatic";

function table(map) {
  const rgb = new Uint8Array(3 * 256);
  for (let k = 0; k < 256; ++k) rgb.set(channels(map(k / 255)), 3 * k);
  return rgb;
}

/** "#rrggbb" or "rgb(r, g, b)" as three numbers. */
export function channels(text) {
  if (text.startsWith("#")) return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
  return text.match(/\d+/g).map(Number);
}

export const maps = {
  viridis: table(interpolateViridis),
  cividis: table(interpolateCividis),
  diverging: table((t) => interpolateRdBu(1 - t)),   // blue below zero, red above
};

/** Small, strained, snapped: different in hue and in lightness. */
export const class_colours = ["#7fa6c9", "#eda100", "#a3003f"].map(channels);

/** By what a bond broke: numbers of `bond_broken`, 0 is whole. To be told from one another with common colour blindness. */
export const causes = ["", "tension", "shear", "bending", "torsion", "compression", "its own law"];
export const cause_colours = ["#000000", "#d55e00", "#0072b2", "#e69f00", "#b5488e", "#009e73", "#5a6472"].map(channels);

/** The heaviest fragment, then the others. */
export const fragment_colours = ["#9aa9ba", "#66c2a5", "#fc8d62", "#8da0cb", "#e78ac3", "#a6d854", "#ffd92f", "#c9a27e", "#6fc7e8"].map(channels);
export const fragment_colour_count = fragment_colours.length;

export const picked_colour = channels("#ff2bd6");   // in none of the maps

export function css_colour(rgb) { return `rgb(${rgb.join(" ")})`; }

const rounding = 1e-6;   // of the scale: what is below zero by less is zero, rounded

/** The ends of the scale: from zero, or about zero if signed, so that zero has the colour of the middle. */
export function scale_ends([low, high], signed) {
  if (!signed) return [low < -rounding * high ? low : 0, high];
  const size = Math.max(Math.abs(low), Math.abs(high));
  return [-size, size];
}

/** Index of a value in a table of 256; a scale without extent has its first colour, values past an end the end's. */
export function shade(value, [low, high]) {
  if (!(high > low)) return 0;
  return Math.max(0, Math.min(255, Math.round((255 * (value - low)) / (high - low))));
}

export function css_gradient(rgb) {
  const stops = Array.from({ length: 17 }, (_, k) => `rgb(${rgb.slice(3 * Math.round(k * 15.9375), 3 * Math.round(k * 15.9375) + 3).join(" ")})`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
