// The words of the page: what was run, what came out, what to worry about, how to run it again.
import { element } from "./text.js";

/** What the run is called, also where its case has no title. */
export function name_of({ title }) { return title?.trim() || "Run without a title"; }

const names = { error: "Error", warning: "Warning", note: "Note" };

const two_lines = 90;   // characters that a narrow screen has room for in two lines

/** On a narrow screen all but errors have two lines, and a button for the rest (page.css). */
export function warnings(list) {
  return list.map(({ level, text }) => {
    const message = element("div", { class: `message ${level}`, role: level === "error" ? "alert" : null },
      element("p", {}, element("strong", {}, names[level] ?? "Note"), " ", text));
    if (level !== "error" && text.length > two_lines) message.append(more(message));
    return message;
  });
}

function more(message) {
  const button = element("button", { type: "button", class: "more", "aria-expanded": "false", onclick: () => {
    const whole = message.classList.toggle("whole");
    button.setAttribute("aria-expanded", String(whole));
    button.textContent = whole ? "Less" : "More";
  } }, "More");
  return button;
}

function table(rows) {
  return element("table", {}, element("tbody", {}, ...rows.map(([name, value]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, value)))));
}

/** Short, so that the figures stand high on the page: all facts are at its foot. */
export function head(json, theme_button) {
  const { program, facts, results } = json;
  const cards = results.map(([name, value]) => element("div", {}, element("dt", {}, name), element("dd", {}, value)));
  const step = facts.find(([name]) => name === "Time step");
  const words = [...facts.slice(0, 3).map(([, value]) => value), step && `time step ${step[1]}`, program].filter(Boolean);
  return [
    element("div", { class: "top" }, element("h1", {}, name_of(json)), theme_button),
    element("p", { class: "made" }, words.join(" · ")),
    cards.length ? element("dl", { "aria-label": "Results" }, ...cards) : "",
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

export function foot({ facts, rerun, left_out }) {
  const parts = facts.length ? [element("h2", {}, "What was run"), table(facts)] : [];
  if (rerun) {
    parts.push(element("h2", {}, "Run it again"), element("p", {}, "Save the case below as resolved.toml, then:"),
      copyable("the command", rerun.command),
      element("details", {}, element("summary", {}, "The case, with all defaults filled in"), copyable("the case", rerun.case)));
  }
  if (left_out.length) parts.push(element("h2", {}, "What this page leaves out"), element("ul", {}, ...left_out.map((s) => element("li", {}, s))));
  parts.push(element("p", { class: "made" },
    "Keys: space plays and pauses, left and right go one frame back or on; after a click on the body, Home and End go to the first and last frame. ",
    "Drag to turn the body, scroll to come nearer, drag with the right button to move it. Click a particle or a bond to see its numbers, a plot to go to that time. ",
    "On a touch screen tap the body first: then one finger turns it, two move it and come nearer; tap elsewhere to scroll again."));
  return parts;
}
