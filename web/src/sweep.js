// The overview of a sweep: results over the swept keys, and what became of each point.
import { History } from "./history.js";
import { Plot } from "./plot.js";
import { element } from "./text.js";

const shown_at_first = 4;
// Names of results, those that sweeps are made for first; and of what tells about the computation alone.
const telling = [/critical_force/, /critical_load_factor/, /peak_load|limit_points|bifurcations/, /frequenc/, /first_break|broken|largest_(force|avalanche)|[.]force[.]/];
const internal = /[.](steps|time|dt|points|iterations|solver_iterations|searched_to|jumped|left_saddle|(factors|linear_estimates|critical_gaps)[.].*)$|balance_error|^(bonds|particles)$/;

/** The number in a value such as "2 T0" or "1e9"; NaN if it is none. */
export function number_in(text) { return parseFloat(text); }

/** What distinguishes the curves: the values of all keys but the one on the x axis, and those that go together with it. */
function label(keys, values, x) {
  const first = (k) => keys[k].with ?? keys[k].name;
  const words = keys.map(({ name }, k) => (first(k) === first(x) ? null : `${name.split(".").at(-1)} ${values[k]}`)).filter(Boolean);
  return words.join(", ") || "all points";
}

/** Keys that take more than one value, all of them numbers, by their places; one of them is the x axis. */
export function axes_of(keys, points) {
  return keys.map((_, k) => k).filter((k) => new Set(points.map(({ values }) => values[k])).size > 1 && points.every(({ values }) => !Number.isNaN(number_in(values[k]))));
}

/** One result over one key as the rows of a history: a curve for each combination of the other keys. */
export function curves_of({ keys, points }, x, results) {
  const at = (point) => (x == null ? point : number_in(points[point].values[x]));
  const places = [...new Set(points.map((_, point) => at(point)))].sort((a, b) => a - b), row = new Map(places.map((place, k) => [place, k]));
  const curves = new Map();
  points.forEach(({ values }, point) => {
    const name = x == null ? "all points" : label(keys, values, x);
    if (!curves.has(name)) curves.set(name, places.map(() => null));
    curves.get(name)[row.get(at(point))] = results[point];
  });
  for (const [name, values] of curves) if (values.every((v) => v == null)) curves.delete(name);   // all of them failed
  const x_name = x == null ? "point" : keys[x].name;
  return { x: x_name, names: [...curves.keys()],
           history: new History({ columns: [{ name: x_name }, ...[...curves.keys()].map((name) => ({ name }))], values: [places, ...curves.values()] }, x_name) };
}

/** Results that differ from point to point, those that sweeps are made for first. */
export function results_worth_showing({ names, values }) {
  const differ = names.filter((_, k) => new Set(values[k].filter((v) => v != null)).size > 1);
  const rank = (name) => {
    const place = telling.findIndex((words) => words.test(name));
    return internal.test(name) ? telling.length + 1 : place < 0 ? telling.length : place;
  };
  return differ.map((name, k) => [rank(name), k, name]).sort(([a, i], [b, j]) => a - b || i - j).map(([, , name]) => name);
}

function select(words, options, chosen, changed) {
  const made = element("select", { onchange: () => changed(made.value) },
    ...options.map(([value, text]) => element("option", { value, selected: String(value) === String(chosen) }, text)));
  return element("label", { class: "control" }, element("span", {}, words), made);
}

class Overview {
  constructor(sweep) {
    this.sweep = sweep;
    this.axes = axes_of(sweep.keys, sweep.points);
    this.x = this.axes.at(-1) ?? null;
    this.names = results_worth_showing(sweep.results);
    this.shown = this.names.slice(0, shown_at_first);
    this.place = element("div", { class: "plots" });
    const controls = element("div", { class: "settings" },
      this.axes.length > 1 ? select("Over", this.axes.map((k) => [k, sweep.keys[k].name]), this.x, (k) => { this.x = Number(k); this.draw(); }) : null,
      this.names.length > this.shown.length ? select("Show also", [["", "…"], ...this.names.map((name) => [name, name])], "", (name) => {
        if (name && !this.shown.includes(name)) this.shown.push(name);
        this.draw();
      }) : null);
    this.root = element("section", { "aria-label": "Results" }, controls, this.place);
  }

  /** Call when `root` is in the document. */
  draw() {
    const { names, values } = this.sweep.results;
    this.plots = this.shown.map((name) => {
      const { x, names: curves, history } = curves_of(this.sweep, this.x, values[names.indexOf(name)]);
      return new Plot(history, { title: name, x, y: curves, markers: true }, () => {});
    });
    this.place.replaceChildren(...this.plots.map((plot) => plot.root));
    this.plots.forEach((plot) => plot.build());
  }
}

function table({ keys, points }) {
  const heading = (name) => element("th", { scope: "col" }, name);
  return element("section", { class: "breaks", "aria-label": "Points" }, element("h2", {}, "Points"),
    element("div", { class: "rows", tabindex: 0, role: "region", "aria-label": "List of the points" }, element("table", {},
      element("thead", {}, element("tr", {}, heading("Folder"), ...keys.map(({ name }) => heading(name)), heading("Ended"), heading("Reason"))),
      element("tbody", {}, ...points.map(({ folder, values, ended, reason }) => element("tr", {},
        element("td", {}, folder), ...values.map((value) => element("td", {}, value)), element("td", {}, ended), element("td", {}, reason)))))));
}

/** Fills the page with a sweep. `theme_button` as in theme.js. */
export function show_sweep(sweep, place, theme_button) {
  const failed = sweep.points.filter(({ ended }) => ended === "failed").length;
  const overview = new Overview(sweep), name = `Sweep: ${sweep.title || "case without a title"}`;
  document.title = name;
  place("head").replaceChildren(
    element("div", { class: "top" }, element("h1", {}, name), theme_button(() => overview.plots.forEach((plot) => plot.redraw()))),
    element("p", { class: "made" }, `${sweep.points.length} points over ${sweep.keys.map((key) => key.name).join(", ")} · ${sweep.program}`));
  if (failed) place("messages").append(element("div", { class: "message warning" }, element("p", {}, element("strong", {}, "Warning"), ` ${failed} of ${sweep.points.length} points failed: see the list.`)));
  place("figures").replaceChildren(overview.root);
  place("foot").replaceChildren(table(sweep));
  overview.draw();
  new ResizeObserver(() => overview.plots.forEach((plot) => plot.redraw())).observe(place("figures"));
  document.documentElement.dataset.ready = "drawn";
}
