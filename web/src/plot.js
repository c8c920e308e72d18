// One plot: any columns against any other, so x need not ascend (force against shortening goes
// back and forth). uPlot's own lines and cursor want ascending x; its scatter mode with lines drawn here does not.
import uPlot from "uplot";
import { linear_axis, log_axis } from "./axis.js";
import { stack } from "./history.js";
import { colour_of, framed, save } from "./picture.js";
import { download, element, file_name, number } from "./text.js";

const height = 230;
const most_moved = 4;   // pixels, of a pointer that clicks
const closer = 0.5;     // of the axes, by the button

const marker = 3;       // pixels, radius of a circle at each point

/** Lines, and circles at the points with `markers`; without `lines` these alone. */
const polyline = (markers, lines = true) => (u, index, first, last) => {
  const radius = marker * devicePixelRatio;
  const [xs, ys] = u.data[index];
  const line = new Path2D(), fill = new Path2D();
  const base = u.valToPos(Math.max(0, u.scales.y.min), "y", true);
  let pen_down = false, from = 0, at = 0;
  const close = () => { if (pen_down) { fill.lineTo(at, base); fill.lineTo(from, base); fill.closePath(); } };
  for (let row = first; row <= last; ++row) {
    if (xs[row] == null || ys[row] == null) { close(); pen_down = false; continue; }
    const x = u.valToPos(xs[row], "x", true), y = u.valToPos(ys[row], "y", true);
    if (pen_down && lines) { line.lineTo(x, y); fill.lineTo(x, y); }
    else { line.moveTo(x, y); fill.moveTo(x, y); from = x; }
    if (markers) { line.moveTo(x + radius, y); line.arc(x, y, radius, 0, 2 * Math.PI); line.moveTo(x, y); }
    pen_down = true;
    at = x;
  }
  close();
  return { stroke: line, fill };
};

export class Plot {
  /** `picked(row)` is called when a point is clicked. */
  constructor(history, preset, picked) {
    this.history = history;
    this.preset = preset;
    this.picked = picked;
    this.log = { x: false, y: !!preset.log_y };
    this.hidden = new Set();
    this.row = null;
    this.zoom = null;
    this.place = element("div", { class: "canvas" });
    this.keys = element("div", { class: "keys" });
    this.note = element("p", { class: "note" });
    this.heading = element("h3", {}, preset.title);
    this.root = element("article", { class: "plot" },
      element("header", {}, this.heading, element("div", { class: "buttons" }, ...this.axis_buttons(),
        element("button", { type: "button", onclick: () => this.save_csv() }, "CSV"),
        element("button", { type: "button", onclick: () => this.save_png() }, "PNG"))),
      this.place, this.keys, this.note);
  }

  axis_buttons() { return [this.switch_log("x"), this.switch_log("y"), this.closer_button(), this.whole_button()]; }

  get canvas() { return this.plot.ctx.canvas; }

  switch_log(axis) {
    const button = element("button", { type: "button", "aria-pressed": String(this.log[axis]), onclick: () => {
      this.log[axis] = !this.log[axis];
      button.setAttribute("aria-pressed", String(this.log[axis]));
      this.build();
    } }, `log ${axis}`);
    return button;
  }

  /** For those without a pointer that drags: half of each axis, about the time cursor or the middle. */
  closer_button() {
    return element("button", { type: "button", "aria-label": "Closer, about the time cursor", onclick: () => {
      const { x, ys } = this.drawn, y = ys[0]?.[this.row];
      const about = (at, [low, high]) => {
        const middle = at >= low && at <= high ? at : (low + high) / 2, half = 0.5 * closer * (high - low);
        return [middle - half, middle + half];
      };
      const [x_ends, y_ends] = this.ends();
      this.zoom_to([about(x[this.row], x_ends), about(y, y_ends)]);
    } }, "+");
  }

  whole_button() {
    return this.whole = element("button", { type: "button", hidden: true, onclick: () => this.zoom_to(null) }, "whole");
  }

  /** The ends of the axes x and y in numbers that are drawn, or null for all. */
  zoom_to(ends) {
    this.zoom = ends;
    this.whole.hidden = !ends;
    const [x, y] = this.ends();
    this.plot.batch(() => {
      this.plot.setScale("x", { min: x[0], max: x[1] });
      this.plot.setScale("y", { min: y[0], max: y[1] });
    });
    this.mark(this.row);
  }

  ends() { return this.zoom ?? [this.drawn.x_axis.ends, this.drawn.y_axis.ends]; }

  show(preset) {
    this.preset = preset;
    this.hidden.clear();
    this.build();
  }

  /** A value, and the name of its column, as they are drawn: History.turned says where the sign is the other one. */
  turned(value, axis) { return value && this.preset.turned?.[axis] ? -value : value; }

  words(name, axis) { return this.preset.turned?.[axis] ? `−${name}` : name; }

  /** Names of the curves that the reader has not hidden. */
  shown() { return this.preset.y.filter((name) => !this.hidden.has(name)); }

  /** These names and the axes with their values; sums in a stack. */
  curves() {
    const of = (axis) => (name) => this.history.column(name).values.map((v) => this.turned(v, axis));
    const names = this.shown();
    this.stacks = !!this.preset.stacked && !this.log.y;
    const x_axis = (this.log.x ? log_axis : linear_axis)([this.preset.x].map(of("x"))), ys = names.map(of("y"));
    const y_axis = this.log.y ? log_axis(ys) : linear_axis(this.stacks ? stack(ys) : ys, this.stacks);
    return { names, x_axis, y_axis, x: x_axis.values[0], ys: y_axis.values };
  }

  axis_words(names, axis) {
    const units = new Set(names.map((name) => this.history.column(name).unit));
    const unit = units.size === 1 && [...units][0] ? ` [${[...units][0]}]` : "";
    const name = names.length === 1 ? names[0] : this.preset.stacked ? "energy" : "";
    return `${this.log[axis] && name ? `|${name}|` : this.words(name, axis)}${unit}`;
  }

  /** Draws the same curves once more, after a change of theme or width: what the reader has zoomed to stays. */
  redraw() {
    const { zoom } = this;
    this.build();
    if (zoom) this.zoom_to(zoom);
  }

  choose_colours() {
    const palette = colour_of("--series").split(/\s+/);
    this.colours = new Map(this.preset.y.map((name, k) => [name, palette[k % palette.length]]));
  }

  /** Draws everything from the beginning, after a change of axes or curves. */
  build() {
    this.plot?.destroy();
    this.marks = this.zoom = null;
    this.whole.hidden = true;
    this.drawn = this.curves();
    const { names, x_axis, y_axis, x, ys } = this.drawn;
    this.note.textContent = [x_axis.cut, y_axis.cut].filter(Boolean).join(" ");
    this.choose_colours();
    const order = ys.map((_, k) => k);
    if (this.stacks) order.reverse();   // the highest sum first, so that the lower ones lie on it
    const axis = (scale, { splits, words }, label) => ({ scale, label, labelSize: 20, labelGap: 0, size: scale === "x" ? 32 : 60,
      splits, values: (_, marks) => words(marks),
      font: "11px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", stroke: colour_of("--ink"),
      grid: { stroke: colour_of("--line"), width: 1 }, ticks: { stroke: colour_of("--line"), width: 1, size: 4 } });
    const curve = (name) => ({ stroke: this.colours.get(name), width: this.stacks ? 0.5 : 1.6, paths: this.preset.points?.includes(name) ? polyline(true, false) : polyline(this.preset.markers),
      fill: this.stacks ? this.colours.get(name) : undefined, points: { show: false },
      facets: [{ scale: "x", auto: true }, { scale: "y", auto: true }] });
    const series = order.map((k) => curve(names[k])), data = order.map((k) => [x, ys[k]]);
    if (!series.length) { series.push(curve()); data.push([[], []]); }   // uPlot wants one
    this.plot = new uPlot({
      mode: 2, width: this.place.clientWidth || 400, height, padding: [8, 22, 0, 0],
      cursor: { show: false }, legend: { show: false }, hooks: { ready: [(made) => { if (made === this.plot) this.ready(); }] },
      scales: { x: { time: false, auto: false, range: () => this.ends()[0] }, y: { auto: false, range: () => this.ends()[1] } },
      axes: [axis("x", x_axis, this.axis_words([this.preset.x], "x")),
             axis("y", y_axis, this.axis_words(this.preset.y, "y"))],
      series: [{}, ...series],
    }, [null, ...data], this.place);
  }

  /** uPlot calls it once scales are known, a moment after it is made. */
  ready() {
    this.marks = element("div", { class: "mark" });
    this.box = element("div", { class: "zoom", hidden: true });
    this.plot.over.append(this.box, this.marks, ...this.drawn.names.map(() => element("div", { class: "dot" })));
    this.plot.over.addEventListener("pointermove", (event) => this.list(this.row_at(event) ?? this.row));
    this.plot.over.addEventListener("pointerleave", () => this.list(this.row));
    this.plot.over.addEventListener("click", (event) => { const row = this.dragged ? null : this.row_at(event); if (row != null) this.picked(row); });
    this.plot.over.addEventListener("dblclick", () => this.zoom_to(null));
    this.plot.over.addEventListener("pointerdown", (event) => this.drag(event));
    this.mark(this.row);
  }

  /** A rectangle drawn by the mouse becomes the plot; a finger scrolls the page. */
  drag(down) {
    this.dragged = false;
    if (down.pointerType === "touch" || down.button !== 0) return;
    const { over } = this.plot, frame = over.getBoundingClientRect();
    const at = (event) => [Math.max(0, Math.min(frame.width, event.clientX - frame.left)), Math.max(0, Math.min(frame.height, event.clientY - frame.top))];
    const from = at(down);
    const corners = (event) => { const to = at(event); return [0, 1].map((c) => [Math.min(from[c], to[c]), Math.max(from[c], to[c])]); };
    over.setPointerCapture(down.pointerId);
    const moved = (event) => {
      const [x, y] = corners(event);
      this.dragged ||= Math.hypot(x[1] - x[0], y[1] - y[0]) > most_moved;
      this.box.hidden = !this.dragged;
      Object.assign(this.box.style, { left: `${x[0]}px`, top: `${y[0]}px`, width: `${x[1] - x[0]}px`, height: `${y[1] - y[0]}px` });
    };
    const ended = (event) => {
      over.removeEventListener("pointermove", moved);
      this.box.hidden = true;
      const [x, y] = corners(event);
      if (!this.dragged || event.type === "pointercancel" || Math.min(x[1] - x[0], y[1] - y[0]) <= most_moved) return;
      this.zoom_to([x.map((px) => this.plot.posToVal(px, "x")), y.map((px) => this.plot.posToVal(px, "y")).reverse()]);
    };
    over.addEventListener("pointermove", moved);
    for (const end of ["pointerup", "pointercancel"]) over.addEventListener(end, ended, { once: true });
  }

  /** The row drawn nearest to the pointer; along x alone where x ascends with time. */
  row_at(event) {
    const box = this.plot.over.getBoundingClientRect();
    const px = event.clientX - box.left, py = event.clientY - box.top;
    const { x, ys } = this.drawn, by_clock = [this.history.clock, this.history.over, "step"].includes(this.preset.x);
    let best = null, least = Infinity;
    for (let row = 0; row < x.length; ++row) {
      if (x[row] == null) continue;
      const dx = this.plot.valToPos(x[row], "x") - px;
      for (const y of by_clock ? [null] : ys) {
        if (y && y[row] == null) continue;
        const far = dx * dx + (y ? (this.plot.valToPos(y[row], "y") - py) ** 2 : 0);
        if (far < least) { least = far; best = row; }
      }
    }
    return best;
  }

  /** Puts the time cursor on a row; null takes it away. */
  mark(row) {
    this.row = row;
    if (!this.marks) return;
    const { x, ys } = this.drawn, [x_ends, y_ends] = this.ends(), is_in = (v, [low, high]) => v != null && v >= low && v <= high;
    const left = row == null || !is_in(x[row], x_ends) ? null : this.plot.valToPos(x[row], "x");
    this.marks.hidden = left == null;
    if (left != null) this.marks.style.transform = `translateX(${left}px)`;
    this.plot.over.querySelectorAll(".dot").forEach((dot, k) => {
      dot.hidden = left == null || !is_in(ys[k][row], y_ends);
      if (!dot.hidden) dot.style.transform = `translate(${left}px, ${this.plot.valToPos(ys[k][row], "y")}px)`;
    });
    this.list(row);
  }

  /** The curves with their values in that row; a click hides or shows one. */
  list(row) {
    if (!this.keys.childElementCount || this.keys.dataset.names !== this.preset.y.join()) this.make_keys();
    const value = (name) => (row == null ? "" : number(this.turned(this.history.column(name).values[row], "y")));
    [...this.keys.children].forEach((key, k) => {
      key.lastChild.textContent = value(this.preset.y[k]);
      key.firstChild.style.background = this.colours.get(this.preset.y[k]);
    });
  }

  make_keys() {
    this.keys.dataset.names = this.preset.y.join();
    this.keys.replaceChildren(...this.preset.y.map((name) => {
      const key = element("button", { type: "button", class: "key", "aria-pressed": "true", onclick: () => {
        this.hidden.has(name) ? this.hidden.delete(name) : this.hidden.add(name);
        key.setAttribute("aria-pressed", String(!this.hidden.has(name)));
        this.build();
      } }, element("span", { class: "swatch" }), element("span", {}, this.words(name, "y")), element("output", {}));
      return key;
    }));
  }

  save_csv() {
    const text = this.history.csv([...new Set([this.preset.x, ...this.preset.y])]);
    download(new Blob([text], { type: "text/csv" }), file_name(this.preset.title, "csv"));
  }

  save_png() {
    const line = Math.round(24 * devicePixelRatio), names = this.shown();
    const { canvas, pen } = framed(this.canvas, line, line);
    pen.font = `600 ${0.6 * line}px system-ui, sans-serif`;
    pen.fillText(this.preset.title, line, 0.5 * line);
    pen.font = `${0.5 * line}px system-ui, sans-serif`;
    const room = canvas.width - 2 * line, shown = names.map((name) => this.words(name, "y")), words = shown.join("  "), wide = pen.measureText(words).width + names.length * 0.4 * line;
    if (wide > room) pen.font = `${(0.5 * line * room) / wide}px system-ui, sans-serif`;
    let x = line;
    names.forEach((name, k) => {
      pen.fillStyle = this.colours.get(name);
      pen.fillText(shown[k], x, canvas.height - 0.5 * line);
      x += pen.measureText(shown[k]).width + 0.6 * line;
    });
    save(canvas, this.preset.title);
  }
}
