// The plots beside the body: which are shown, one of free choice, one time cursor for all.
import { Plot } from "./plot.js";
import { element } from "./text.js";

const shown_at_first = 2;

export class Plots {
  /** `picked(row)` is called when a point of a plot is clicked; `kept` of plots before these. */
  constructor(history, presets, picked, kept = {}) {
    this.history = history;
    this.row = null;
    const free = kept.free ?? { title: "Any columns", x: history.over, y: [history.has("total") ? "total" : history.names.at(-1)] };
    this.all = [...history.presets(presets), free].map((preset) => new Plot(history, preset, picked));
    this.all.at(-1).heading.after(this.chooser(this.all.at(-1)));
    const at_first = ({ preset }, k) => history.rows > 1 && preset !== free && (k < shown_at_first || preset.added);
    this.shown = new Set(this.all.filter((plot, k) => kept.shown?.includes(plot.preset.title) ?? at_first(plot, k)));
    this.root = element("section", { class: "plots", "aria-label": "Plots" }, element("h2", { class: "unseen" }, "Plots"),
      element("div", { class: "chips", role: "group", "aria-label": "Plots that are shown" }, ...this.all.map((plot) => this.chip(plot))),
      ...this.all.map((plot) => plot.root));
    this.all.forEach((plot) => { plot.root.hidden = !this.shown.has(plot); });
  }

  /** Call when `root` is in the document. */
  start() {
    let width = 0;
    new ResizeObserver(() => {
      if (this.root.clientWidth === width) return;
      width = this.root.clientWidth;
      this.draw();
    }).observe(this.root);
    width = this.root.clientWidth;
    this.draw();
  }

  /** What the reader has chosen, for plots of newer data. */
  kept() { return { shown: [...this.shown].map(({ preset }) => preset.title), free: this.all.at(-1).preset }; }

  draw() { this.shown.forEach((plot) => plot.redraw()); }

  mark(row) {
    if (row === this.row) return;
    this.row = row;
    this.shown.forEach((plot) => plot.mark(row));
  }

  chip(plot) {
    const chip = element("button", { type: "button", "aria-pressed": String(this.shown.has(plot)), onclick: () => {
      const show = !this.shown.delete(plot);
      if (show) this.shown.add(plot);
      plot.root.hidden = !show;
      chip.setAttribute("aria-pressed", String(show));
      plot.row = this.row;
      if (show) plot.build();
    } }, plot.preset.title);
    return chip;
  }

  chooser(plot) {
    const options = (chosen) => this.history.names.map((name) => element("option", { value: name, selected: chosen.includes(name) }, name));
    const changed = () => {
      const y = [...ys.selectedOptions].map((option) => option.value);
      if (y.length) plot.show({ ...plot.preset, x: x.value, y });
    };
    const x = element("select", { onchange: changed }, ...options([plot.preset.x]));
    const ys = element("select", { multiple: true, size: 5, onchange: changed }, ...options(plot.preset.y));
    return element("div", { class: "chooser" },
      element("label", { class: "control" }, element("span", {}, "x"), x),
      element("label", { class: "control" }, element("span", {}, "y (one or several)"), ys));
  }
}
