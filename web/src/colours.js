// Colour maps as tables of 256 colours. All three can be told apart with common colour blindness.
import { interpolateCividis, interpolateRdBu, interpolateViridis } from "d3-scale-chromatic";
import { channels } from "./palette.js";

function table(map) {
  const rgb = new Uint8Array(3 * 256);
  for (let k = 0; k < 256; ++k) rgb.set(channels(map(k / 255)), 3 * k);
  return rgb;
}

export const maps = {
  viridis: table(interpolateViridis),
  cividis: table(interpolateCividis),
  diverging: table((t) => interpolateRdBu(1 - t)),   // blue below zero, red above
};

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
