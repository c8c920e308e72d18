// A table with a heading, which scrolls where it is wider than the page.
import { element } from "./text.js";

/** `headings` of the columns; `rows` of texts; `of`: what tells it from others of this label. */
export function table(label, headings, rows, of = "") {
  return element("section", { class: "breaks" }, element("h2", {}, label),
    element("div", { class: "rows", tabindex: 0, role: "region", "aria-label": of ? `${label}: ${of}` : label }, element("table", {},
      element("thead", {}, element("tr", {}, ...headings.map((name) => element("th", { scope: "col" }, name)))),
      element("tbody", {}, ...rows.map((cells) => element("tr", {}, ...cells.map((cell) => element("td", {}, cell))))))));
}
