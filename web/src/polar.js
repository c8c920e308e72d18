// A plot around: values by direction in a plane, the farther out the larger.
import { extent } from "./history.js";
import { colour_of } from "./picture.js";
import { Plot } from "./plot.js";
import { element, number, with_unit } from "./text.js";

const widest = 340;      // pixels
const room = 22;         // for the names of directions
const rings_wanted = 5;
const spokes = 12;

/** Where the circles lie that show values from 0, or less, to the largest of `columns`, which is `least` or more: the value of the centre, `rim`, and how far they are `apart`. */
export function rings_of(columns, least = 0) {
  const [low, high] = extent(columns) ?? [0, 0], from = Math.min(0, low), to = Math.max(0, high);
  const size = Math.max(to - from, least) || 1, power = 10 ** Math.floor(Math.log10(size / rings_wanted));
  const apart = power * [1, 2, 5, 10].find((digit) => size / (digit * power) <= rings_wanted + 1e-9);
  return { centre: apart * Math.floor(from / apart + 1e-9), rim: apart * Math.max(1, Math.ceil(Math.max(to, from + size) / apart - 1e-9)), apart };
}

/** A direction in words: so many degrees from the first axis to the second one. */
export function direction_words(degrees, [first, second]) {
  const at = { 0: first, 90: second, 180: `−${first}`, 270: `−${second}` }[degrees];
  return at ? `Along ${at}` : `${number(degrees)}° from ${first} to ${second}`;
}

export class PolarPlot extends Plot {
  /**
   * The column `x` of the preset holds degrees, evenly spaced once around; `axes` are the names of the directions at 0 and 90;
   * `rings` as rings_of() finds them; curves of `dashed` are; `unit` is that of the rings.
   */
  constructor(history, preset) {
    super(history, preset, () => {});
    this.pen = element("canvas", { role: "img", "aria-label": preset.title }).getContext("2d");
    this.dots = preset.y.map(() => element("div", { class: "dot", hidden: true }));
    this.place.classList.add("polar");
    this.place.append(this.canvas, ...this.dots);
    this.canvas.addEventListener("pointermove", (event) => this.mark(this.row_at(event)));
    this.canvas.addEventListener("pointerdown", (event) => this.mark(this.row_at(event)));   // of a finger
    this.canvas.addEventListener("pointerleave", () => this.mark(null));
  }

  axis_buttons() { return []; }

  /** Curves that are dashed stand behind the others. */
  choose_colours() {
    super.choose_colours();
    for (const name of this.preset.dashed) this.colours.set(name, colour_of("--faint"));
  }

  get canvas() { return this.pen.canvas; }

  degrees(row) { return this.history.column(this.preset.x).values[row]; }

  /** Pixels from the left and from above, of a value in a direction. */
  point(value, degrees) {
    const { centre, rim } = this.preset.rings, far = (this.radius * (value - centre)) / (rim - centre), t = (degrees * Math.PI) / 180;
    return [this.side / 2 + far * Math.cos(t), this.side / 2 - far * Math.sin(t)];
  }

  row_at(event) {
    const box = this.canvas.getBoundingClientRect(), x = event.clientX - box.left - this.side / 2, y = this.side / 2 - (event.clientY - box.top);
    const turn = Math.atan2(y, x) / (2 * Math.PI);
    return Math.round((turn < 0 ? turn + 1 : turn) * this.history.rows) % this.history.rows;
  }

  mark(row) {
    this.row = row;
    this.dots.forEach((dot, k) => {
      const name = this.preset.y[k], value = row == null ? null : this.history.column(name).values[row];
      dot.hidden = value == null || this.hidden.has(name);
      if (dot.hidden) return;
      const [x, y] = this.point(value, this.degrees(row));
      dot.style.transform = `translate(${x + (this.place.clientWidth - this.side) / 2}px, ${y}px)`;
    });
    const { apart, centre } = this.preset.rings;
    this.note.textContent = row != null ? direction_words(this.degrees(row), this.preset.axes)
      : `Circles are ${with_unit(apart, this.preset.unit)} apart${centre ? `; the centre is ${number(centre)}` : ""}`;
    this.list(row);
  }

  build() {
    this.choose_colours();
    this.side = Math.min(this.place.clientWidth || widest, widest);
    this.radius = this.side / 2 - room;
    const { pen, canvas, side } = this, dense = devicePixelRatio;
    canvas.width = canvas.height = Math.round(side * dense);
    Object.assign(canvas.style, { width: `${side}px`, height: `${side}px` });
    pen.setTransform(dense, 0, 0, dense, 0, 0);
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    this.draw_rings();
    for (const name of this.shown()) this.draw_curve(name);
    this.draw_words();
    this.mark(this.row);
  }

  /** The values of the circles, from the innermost to the rim. */
  ring_values() {
    const { centre, rim, apart } = this.preset.rings;
    return Array.from({ length: Math.round((rim - centre) / apart) }, (_, k) => centre + (k + 1) * apart);
  }

  draw_rings() {
    const { pen } = this, { rim, apart } = this.preset.rings, line = (colour, draw) => {
      pen.strokeStyle = colour_of(colour);
      pen.beginPath();
      draw();
      pen.stroke();
    };
    pen.lineWidth = 1;
    for (const value of this.ring_values()) {
      const far = this.point(value, 0)[0] - this.side / 2, is_zero = Math.abs(value) < 0.5 * apart;
      line(is_zero ? "--ink" : "--line", () => pen.arc(this.side / 2, this.side / 2, far, 0, 2 * Math.PI));
    }
    for (let k = 0; k < spokes; ++k) line("--line", () => { pen.moveTo(this.side / 2, this.side / 2); pen.lineTo(...this.point(rim, (360 * k) / spokes)); });
  }

  draw_curve(name) {
    const { pen } = this, { values } = this.history.column(name);
    pen.strokeStyle = this.colours.get(name);
    pen.lineWidth = 1.6;
    pen.setLineDash(this.preset.dashed.includes(name) ? [5, 4] : []);
    pen.beginPath();
    let pen_down = false;
    for (let k = 0; k <= values.length; ++k) {
      const row = k % values.length;
      if (values[row] == null) { pen_down = false; continue; }
      const at = this.point(values[row], this.degrees(row));
      pen_down ? pen.lineTo(...at) : pen.moveTo(...at);
      pen_down = true;
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  /** Names of the axes, and values of the circles on the ground of the page, so that curves leave them legible. */
  draw_words() {
    const { pen, side, preset: { axes: [first, second], rings: { apart } } } = this, middle = side / 2, out = side / 2 - room / 2;
    pen.fillStyle = colour_of("--ink");
    for (const [text, x, y] of [[first, middle + out, middle], [second, middle, middle - out], [`−${first}`, middle - out, middle], [`−${second}`, middle, middle + out]])
      pen.fillText(text, x, y);
    pen.strokeStyle = colour_of("--ground");
    pen.lineWidth = 3;
    for (const value of this.ring_values()) {
      const [x, y] = this.point(value, 75), text = number(Math.abs(value) < 1e-6 * apart ? 0 : Number(value.toPrecision(6)));
      pen.strokeText(text, x, y);
      pen.fillText(text, x, y);
    }
  }
}
