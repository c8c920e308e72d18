// The page of a material: moduli by direction, as the program has found them, and tables of constants.
import { History } from "./history.js";
import { PolarPlot, rings_of } from "./polar.js";
import { table } from "./table.js";
import { element, number, with_unit } from "./text.js";

const axes = ["x", "y", "z"];
const direction = "direction";

/** What is plotted: names of its curves by keys of a plane, and of the circle by that of an isotropic material. */
const kinds = [
  { title: "Young's modulus", key: "E", curves: { E: "E" }, rule: "E(n) of a pull along n" },
  { title: "Shear modulus", key: "G", curves: { G_least: "least G", G_largest: "largest G" }, rule: "G(n, m) in the plane of n and m: the least and the largest of all m across n" },
  { title: "Poisson's ratio", key: "nu", curves: { nu_least: "least nu", nu_largest: "largest nu" }, least: 0.01,
    rule: "nu(n, m), how much a pull along n thins along m: the least and the largest of all m across n" },
];

/** Units of the case: in reduced units numbers have none. */
export function units_of({ units }) {
  const si = units === "SI";
  return { modulus: si ? "Pa" : "", density: si ? "kg/m³" : "", speed: si ? "m/s" : "", A: si ? "N/m" : "", B: si ? "N" : "", D: si ? "N m" : "" };
}

/** The constants of a material: they stand among what was found, at the top or under its key. */
export const constants_of = ({ found }, { key }) => (key ? found[key] : found);

/** One plane as the rows of a history: the curves of a kind, and Hill's value at each direction. */
export function around({ key, curves }, plane, hill, unit) {
  const circle = `Hill's ${key}`, names = [...Object.values(curves), circle];
  return { circle, names, history: new History({ columns: [{ name: direction, unit: "°" }, ...names.map((name) => ({ name, unit }))],
    values: [plane.degrees, ...Object.keys(curves).map((name) => plane[name]), plane.degrees.map(() => hill[key])] }, direction) };
}

/** The plots of a kind in all planes of a material. All materials of a page have circles at the same values. */
function plots_of(page, material, kind) {
  const unit = kind.key === "nu" ? "" : units_of(page).modulus;
  const planes = (m) => m.planes.map((plane) => ({ plane, ...around(kind, plane, constants_of(page, m).hill, unit) }));
  const columns = page.materials.flatMap(planes).flatMap(({ names, history }) => names.map((name) => history.column(name).values));
  const rings = rings_of(columns, kind.least);
  return planes(material).map(({ plane, names, circle, history }) => new PolarPlot(history,
    { title: `${kind.title}, plane ${plane.plane}`, x: direction, y: names, dashed: [circle], axes: [...plane.plane], rings, unit }));
}

/** `corner` says what rows and columns are. */
function matrix(label, corner, names, rows, of) {
  return table(label, [corner, ...names], rows.map((row, k) => [names[k], ...row.map((x) => number(x, 6))]), of);
}

const in_brackets = (unit) => (unit ? ` [${unit}]` : "");

const vector = (along) => `(${along.map((x) => number(Number(x.toFixed(4)))).join(", ")})`;

function averages(found, unit, of) {
  return table(`Isotropic averages${in_brackets(unit)}`, ["Average", "K", "G", "E", "nu"], ["voigt", "reuss", "hill"].map((name) => {
    const { K, G, E, nu } = found[name];
    return [name[0].toUpperCase() + name.slice(1), ...[K, G, E].map((x) => number(x, 6)), number(nu, 5)];
  }), of);
}

/** Moduli along the axes and where they are extreme, and speeds of waves: of cells alone. */
function along_axes({ E, nu, G, wave_speeds }, { modulus, speed }) {
  if (!E) return [];
  const others = (of, n) => axes.filter((m) => m !== n).map((m) => `${n}${m}: ${number(of[`${n}${m}`] ?? of[`${m}${n}`], 5)}`).join(", ");
  return [
    table(`Along the axes${in_brackets(modulus)}`, ["Along", "E", "G in the plane", "nu", `Speeds of waves${in_brackets(speed)}`],
      axes.map((n) => [n, number(E[n], 6), others(G, n), others(nu, n), wave_speeds[n].map((v) => number(v, 5)).join(", ")])),
    table(`Young's modulus of all directions${in_brackets(modulus)}`, ["Of all", "E", "Along"],
      [["Least", number(E.least, 6), vector(E.least_along)], ["Largest", number(E.largest, 6), vector(E.largest_along)]])];
}

/** What is found first: short, above the plots. */
function results(found, { modulus, density }, page) {
  const { hill: { E, G, K, nu }, anisotropy } = found, cards = [["Hill's E", with_unit(E, modulus, 5)], ["Hill's nu", number(nu, 4)], ["Hill's K", with_unit(K, modulus, 5)],
    ["Hill's G", with_unit(G, modulus, 5)], ["Anisotropy 5 G_V/G_R + K_V/K_R − 6", number(anisotropy, 4)], ["Density", with_unit(page.found.density, density, 5)]];
  return element("dl", { "aria-label": "Results" }, ...cards.map(([name, value]) => element("div", {}, element("dt", {}, name), element("dd", {}, value))));
}

/** The part of the page that shows one C; the plots in it go to `drawn`. */
function part(page, material, drawn) {
  const units = units_of(page), found = constants_of(page, material), list = [];
  if (material.name) list.push(element("h2", {}, material.name));
  if (material.planes.length) {
    list.push(results(found, units, page));
    for (const kind of kinds) {
      const plots = plots_of(page, material, kind);
      drawn.push(...plots);
      list.push(element("section", {}, element("h2", {}, kind.title), element("p", { class: "made" }, `${kind.rule}. The dashed circle is the isotropic material of Hill's average.`),
        element("div", { class: "plots around" }, ...plots.map((plot) => plot.root))));
    }
  }
  list.push(matrix(`C${in_brackets(units.modulus)}, engineering shear`, "stress by strain", page.found.order, found.C, material.name));
  if (found.hill) list.push(averages(found, units.modulus, material.name), ...along_axes(found, units));
  return list;
}

/** The tables of a sheet. */
function sheet(page) {
  const units = units_of(page), names = { A: "force by strain", B: "force by curvature", D: "moment by curvature" };
  return Object.entries(names).map(([key, words]) => matrix(`${key}${in_brackets(units[key])}, per width`, words, page.found.order, page.found[key]));
}

/** Fills the page with a material. `theme_button` as in theme.js, `warnings` as in head.js. */
export function show_material(page, place, theme_button, warnings) {
  const name = `Material: ${page.title || "case without a title"}`, plots = [];
  const redraw = () => plots.forEach((plot) => plot.redraw());
  const parts = page.materials.length ? page.materials.flatMap((material) => part(page, material, plots)) : sheet(page);
  document.title = name;
  place("head").replaceChildren(
    element("div", { class: "top" }, element("h1", {}, name), theme_button(redraw)),
    ...[`${page.case} · ${page.program}`, ...page.facts].map((text) => element("p", { class: "made" }, text)));
  place("messages").replaceChildren(...warnings(page.warnings));
  place("figures").replaceChildren(element("div", { class: "material" }, ...parts));
  place("foot").replaceChildren();
  redraw();
  new ResizeObserver(redraw).observe(place("figures"));
  document.documentElement.dataset.ready = "drawn";
}
