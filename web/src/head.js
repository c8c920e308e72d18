// The words of the page: what was run, what came out, what to worry about, how to run it again.
import { element } from "./text.js";

const names = { error: "Error", warning: "Warning", note: "Note" };

export function warnings(list) {
  return list.map(({ level, text }) => element("p", { class: `message ${level}`, role: level === "error" ? "alert" : null },
    element("strong", {}, names[level] ?? "Note"), " ", text));
}

function table(caption, rows) {
  return element("table", {}, element("caption", {}, caption),
    element("tbody", {}, ...rows.map(([name, value]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, value)))));
}

const rows_of_a_table = 5;   // more go beside it, so that the figures stay high on the page

function tables(caption, rows) {
  const parts = [];
  for (let k = 0; k < rows.length; k += rows_of_a_table) parts.push(table(k ? `${caption}, continued` : caption, rows.slice(k, k + rows_of_a_table)));
  return parts;
}

export function head({ title, program, facts, results }, theme_button) {
  return [
    element("div", { class: "top" }, element("h1", {}, title), theme_button),
    element("div", { class: "tables" }, ...tables("Results", results), ...tables("What was run", facts)),
    element("p", { class: "made" }, `Computed with ${program}`),
  ];
}

/** A text with a button that copies it. */
function copyable(label, text) {
  const block = element("pre", { tabindex: 0, "aria-label": label }, text);
  const button = element("button", { type: "button", onclick: async () => {
    button.textContent = (await copied(text, block)) ? "Copied" : "Press Ctrl+C";
    setTimeout(() => { button.textContent = "Copy"; }, 2000);
  }, "aria-label": `Copy: ${label}` }, "Copy");
  return element("div", { class: "copyable" }, block, button);
}

/** False where the browser lets no script copy; the text is selected then. */
async function copied(text, block) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection().selectAllChildren(block);
    return false;
  }
}

export function foot({ rerun, left_out, history }) {
  const parts = [];
  if (rerun) {
    parts.push(element("h2", {}, "Run it again"), element("p", {}, "Save the case below as resolved.toml, then:"),
      copyable("the command", rerun.command),
      element("details", {}, element("summary", {}, "The case, with all defaults filled in"), copyable("the case", rerun.case)));
  }
  const sentences = [...left_out];
  const rows = history.values[0]?.length ?? 0;
  if (history.rows_in_file > rows) sentences.push(`Plots have ${rows} of the ${history.rows_in_file} rows of history.csv.`);
  if (sentences.length) parts.push(element("h2", {}, "What this page leaves out"), element("ul", {}, ...sentences.map((s) => element("li", {}, s))));
  parts.push(element("p", { class: "made" },
    "Keys: space plays and pauses, arrows go one frame on or back, Home and End go to the first and last frame. ",
    "Drag to turn the body, scroll or pinch to come nearer, drag with the right button to move it. Click a plot to go to that time."));
  return parts;
}
