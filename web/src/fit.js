// The page of a fit: measured points and curves, residuals, how the search went, values with their errors.
import { History } from "./history.js";
import { Plot } from "./plot.js";
import { table } from "./table.js";
import { element, number, with_unit } from "./text.js";

/** Of each column and stage the points in the order of x, and as the rows of a history. */
export function curves_of({ points, columns, units, x, x_unit, stages, residual_deviation }) {
  const groups = new Map();
  for (const point of points) {
    const name = `${columns[point.curve]}${point.stage == null ? "" : ` in stage ${stages[point.stage]}`}`;
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(point);
  }
  return [...groups].map(([name, unsorted]) => {
    const sorted = [...unsorted].sort((a, b) => a.x - b.x), of = (what) => sorted.map(what);
    const size = (point) => point.sigma ?? residual_deviation, by = sorted.some(({ sigma }) => sigma == null) ? "deviation" : "sigma";
    const residual = (point) => (size(point) ? (point.fitted - point.measured) / size(point) : null);
    const rows = { [x]: of((p) => p.x), measured: of((p) => p.measured), start: of((p) => p.start), fitted: of((p) => p.fitted),
                   [`residual / ${by}`]: of(residual), "no residual": of(() => 0) };
    const unit = units[sorted[0].curve], unit_of = { [x]: x_unit, measured: unit, start: unit, fitted: unit };
    return { name, by, history: new History({ columns: Object.keys(rows).map((key) => ({ name: key, unit: unit_of[key] })), values: Object.values(rows) }, x) };
  });
}

/** The search, iteration by iteration: steps that were no better keep the values. */
export function search_of({ iterations, values }) {
  const over_start = (k) => iterations.map((i) => (values[k].start ? i.values[k] / values[k].start : i.values[k]));
  const columns = ["iteration", "sum of squares", ...values.map(({ key, start }) => (start ? `${key} / start` : key))];
  return new History({ columns: columns.map((name) => ({ name })),
                       values: [iterations.map((i) => i.number), iterations.map((i) => (i.accepted ? i.sum_of_squares : null)), ...values.map((_, k) => over_start(k))] }, "iteration");
}

/** Why a value has no interval. */
export function without_interval(value, { no_effect, not_told_apart, degrees_of_freedom }) {
  if (value.at_bound) return `at its ${value.at_bound} bound: held there`;
  if (value.held_by_failed_runs) return "held by runs that fail";
  if (no_effect.includes(value.key)) return "no effect on the points";
  if (not_told_apart.some((keys) => keys.includes(value.key))) return "not told apart from others";
  return degrees_of_freedom > 0 ? "none" : "as many values as points";
}

/** How the derivative was found: the last one, and how often it was another way. */
export function derivative_words({ derivative, derivatives: { times, by_differences }, off_from_differences: off, why_differences: why }) {
  const partly = by_differences > 0 && by_differences < times ? ` ${by_differences} of ${times} times` : "";
  if (derivative !== "tangent") return `differences${partly}${why ? `: ${why}` : ""}`;
  const compared = off == null ? "no effect at the start" : `${number(off, 2)} off from differences at the start`;
  return `tangent of the balance; ${compared}${partly ? `; differences${partly}: ${why}` : ""}`;
}

function values_table(fit) {
  return table("Values", ["Value", "Start", "Found", "Standard error", "95 % from", "to", "Derivative"], fit.values.map((v) => {
    const [low, high] = v.interval_95, in_unit = (x) => with_unit(x, v.unit, 6);
    const interval = low == null || high == null ? [without_interval(v, fit), ""] : [in_unit(low), in_unit(high)];
    return [v.key, in_unit(v.start), in_unit(v.value), v.standard_error == null ? "" : with_unit(v.standard_error, v.unit, 3), ...interval, derivative_words(v)];
  }));
}

function correlations(fit) {
  if (fit.values.length < 2 || !fit.correlation.length) return null;
  const keys = fit.values.map(({ key }) => key);
  return table("Correlations", ["Value", ...keys], keys.map((key, i) => [key, ...fit.correlation[i].map((c) => number(c, 5))]));
}

/** What the reader must know before the figures. */
export function messages_of(fit) {
  const list = [], say = (level, text) => list.push({ level, text });
  if (fit.end !== "converged") say("warning", `The search has not converged: ${fit.why}.`);
  for (const keys of fit.not_told_apart) say("warning", `The points do not tell apart ${keys.join(", ")}: their values are one choice of many.`);
  for (const key of fit.no_effect) say("warning", `${key} has no effect on the points: it is not determined.`);
  for (const { key, at_bound } of fit.values) if (at_bound) say("warning", `${key} is at its ${at_bound} bound: the bound decides it, not the points.`);
  if (fit.interpolation_off > 0.1)
    say("note", `Between rows of history.csv the curve may be off by ${number(fit.interpolation_off, 2)} of ${fit.sigma_known ? "sigma" : "the residuals' deviation"}.`);
  const lines = [...new Set(fit.left_out_lines)];   // a line may have a point of each column
  if (lines.length) say("note", `${fit.left_out_lines.length} points beyond the run at the start are left out: lines ${lines.slice(0, 10).join(", ")}${lines.length > 10 ? ", ..." : ""}.`);
  for (const failure of fit.failures) say("note", `A run failed: ${failure}`);
  return list;
}

function plots_of(fit) {
  const plots = curves_of(fit).flatMap(({ name, by, history }) => [
    new Plot(history, { title: name, x: fit.x, y: ["measured", "start", "fitted"], points: ["measured"] }, () => {}),
    new Plot(history, { title: `Residuals: ${name}`, x: fit.x, y: [`residual / ${by}`, "no residual"], points: [`residual / ${by}`] }, () => {})]);
  const search = search_of(fit), values = search.names.slice(2), positive = values.every((name) => search.column(name).values.every((v) => v > 0));
  return [...plots, new Plot(search, { title: "Sum of squares", x: "iteration", y: ["sum of squares"], markers: true, log_y: true }, () => {}),
    new Plot(search, { title: "Values", x: "iteration", y: values, markers: true, log_y: positive }, () => {})];
}

/** Fills the page with a fit. `theme_button` as in theme.js, `warnings` as in head.js. */
export function show_fit(fit, place, theme_button, warnings) {
  const plots = plots_of(fit), name = `Fit: ${fit.title || "case without a title"}`;
  const redraw = () => plots.forEach((plot) => plot.redraw());
  document.title = name;
  const quality = fit.residual_deviation == null ? "as many values as points"
    : fit.sigma_known ? `residuals are ${number(fit.residual_deviation, 4)} of the given standard deviations in the mean`
      : `standard deviation of the residuals ${number(fit.residual_deviation, 4)}`;
  const { made, failed, known } = fit.runs;
  place("head").replaceChildren(
    element("div", { class: "top" }, element("h1", {}, name), theme_button(redraw)),
    element("p", { class: "made" }, `${fit.case} to ${fit.data} · ${fit.points.length} points, ${fit.degrees_of_freedom} degrees of freedom · ${quality} · `
      + `${made} runs${failed ? `, ${failed} failed` : ""}${known ? `, ${known} known from before` : ""} · ${fit.program}`),
    values_table(fit));
  place("messages").replaceChildren(...warnings(messages_of(fit)));
  place("figures").replaceChildren(element("section", { class: "plots fit", "aria-label": "Curves" }, ...plots.map((plot) => plot.root)));
  place("foot").replaceChildren(...[correlations(fit), element("p", { class: "made" }, "This is a minimum near the start. Other starts may lead to others.")].filter(Boolean));
  plots.forEach((plot) => plot.build());
  new ResizeObserver(redraw).observe(place("figures"));
  document.documentElement.dataset.ready = "drawn";
}
