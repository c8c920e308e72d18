// Single colours. This file, like all that decodes a page, works without npm's packages.

/** "#rrggbb" or "rgb(r, g, b)" as three numbers. */
export function channels(text) {
  if (text.startsWith("#")) return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
  return text.match(/\d+/g).map(Number);
}

/** Small, strained, snapped: different in hue and in lightness. */
export const class_colours = ["#7fa6c9", "#eda100", "#a3003f"].map(channels);

/**
 * By what a bond broke: numbers of `bond_broken`, 0 is whole; the last one is that of laws which do not say by what, and of
 * bonds of particles that were dropped or that a sink took out. To be told from one another with common colour
 * blindness.
 */
export const causes = ["", "tension", "shear", "bending", "torsion", "compression", "another cause"];
export const cause_colours = ["#000000", "#d55e00", "#0072b2", "#e69f00", "#b5488e", "#009e73", "#5a6472"].map(channels);

/** The heaviest fragment, then the others. */
export const fragment_colours = ["#9aa9ba", "#66c2a5", "#fc8d62", "#8da0cb", "#e78ac3", "#a6d854", "#ffd92f", "#c9a27e", "#6fc7e8"].map(channels);
export const fragment_colour_count = fragment_colours.length;

export const picked_colour = channels("#ff2bd6");   // in none of the maps
