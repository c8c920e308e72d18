// The list of bonds that broke, in words; empty of runs in which none did.
import { css_colour } from "./colours.js";
import { cause_colours, causes } from "./palette.js";
import { element, number } from "./text.js";

function heading(name, unit) { return element("th", { scope: "col" }, unit ? `${name} [${unit}]` : name); }

/** `json` as in FORMAT.md; `shown(row)` is called with the row of a bond that is asked for. */
export function breaks_section({ count, words, first }, units, shown) {
  const si = units === "SI";
  const row = (broke) => element("tr", {},
    element("td", {}, broke.when),
    element("td", {}, shown ? element("button", { type: "button", "aria-label": `Show bond ${broke.bond}`, onclick: () => shown(broke) }, broke.bond) : broke.bond),
    element("td", {}, `${broke.i}, ${broke.j}`),
    element("td", {}, element("span", { class: "swatch", style: { background: css_colour(cause_colours[broke.mode]) } }), causes[broke.mode]),
    element("td", {}, broke.cause),
    element("td", {}, number(broke.energy)));
  return element("section", { class: "breaks", "aria-label": "Bonds that broke" },
    element("h2", {}, "Bonds that broke"),
    element("p", {}, `${words}.`, count > first.length ? ` The first ${first.length} are listed; breaks.csv has them all.` : ""),
    element("div", { class: "rows", tabindex: 0, role: "region", "aria-label": "List of the bonds that broke" }, element("table", {},
      element("thead", {}, element("tr", {}, heading("When"), heading("Bond"), heading("Particles"), heading("By"), heading("Cause"),
        heading("Energy it held", si && "J"))),
      element("tbody", {}, ...first.map(row)))));
}
