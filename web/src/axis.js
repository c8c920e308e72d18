// Values of columns to the numbers that uPlot draws, and its ticks back to words. It is given numbers about one, or
// exponents, on a linear scale: its logarithmic ticks never end near 1e-20, its linear ones are missing below 1e-16.
import { extent } from "./history.js";
import { number } from "./text.js";

const decades = 12;       // of a logarithmic axis at most, below the largest value
const most_ticks = 7;
const smallest = 1e-300;  // 1 / smallest is a number

/** `values` to draw, the `ends` of the axis, `words` for ticks. With `zero`, zero is on the axis. */
export function linear_axis(columns, zero = false) {
  const found = extent(columns), ends = found && zero ? [Math.min(0, found[0]), Math.max(0, found[1])] : found;
  const size = ends ? Math.max(Math.abs(ends[0]), Math.abs(ends[1])) : 0;
  const power = size ? Math.max(smallest, 10 ** Math.floor(Math.log10(size))) : 1;
  return {
    values: columns.map((values) => values.map((v) => (v == null ? null : v / power))),
    ends: linear_ends(ends?.map((v) => v / power)),
    splits: undefined,   // as uPlot likes
    words: (marks) => {
      const apart = marks.length > 1 ? Math.abs(marks[1] - marks[0]) : 1;
      return marks.map((v) => number(Math.abs(v) < 1e-6 * apart ? 0 : Number((v * power).toPrecision(6))));
    },
  };
}

function linear_ends(ends) {
  if (!ends) return [0, 1];
  const [low, high] = ends;
  if (low === high) return [low - (0.1 * Math.abs(low) || 1), high + (0.1 * Math.abs(high) || 1)];
  const room = 0.04 * (high - low);
  return [low === 0 ? 0 : low - room, high === 0 ? 0 : high + room];
}

/** The same with logarithms of sizes; zeros are gaps. `cut` is a sentence if some lie below the axis, else empty. */
export function log_axis(columns) {
  const values = columns.map((column) => column.map((v) => (v ? Math.log10(Math.abs(v)) : null)));
  const found = extent(values) ?? [0, 1], cut = found[1] - found[0] > decades;
  const ends = [cut ? Math.floor(found[1] - decades) : log_digit(found[0], Math.floor), log_digit(found[1], Math.ceil)];
  if (ends[0] === ends[1]) { --ends[0]; ++ends[1]; }
  return { values, ends, splits: (u, axis, from, to) => log_ticks(from, to), words: (marks) => marks.map((v) => number(10 ** v)),
           cut: cut ? `Sizes below ${number(10 ** ends[0])} are not shown.` : "" };
}

const slack = 1e-9;   // logarithms of 1, 2, ... are not exact

/** The logarithm of the nearest number with one digit, down or up. */
function log_digit(logarithm, round) {
  const exponent = Math.floor(logarithm + slack), digit = 10 ** (logarithm - exponent);
  return exponent + Math.log10(round(round === Math.floor ? digit + slack : digit - slack));
}

/** Exponents for ticks: of all numbers with one digit, of 1, 2, 5, or of powers of ten, so that they are few. */
export function log_ticks(low, high) {
  for (const digits of [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1]]) {
    const ticks = [];
    for (let exponent = Math.floor(low); exponent <= high + slack; ++exponent) ticks.push(...digits.map((d) => exponent + Math.log10(d)));
    const within = ticks.filter((v) => v >= low - slack && v <= high + slack);
    if (within.length <= most_ticks) return within;
    if (digits.length === 1) return within.filter((_, k) => (within.length - 1 - k) % Math.ceil(within.length / most_ticks) === 0);
  }
}
