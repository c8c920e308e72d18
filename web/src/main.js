// Puts the page together. `data-ready` of the document says how far it is: "drawn" after the first
// picture, "no-frames", "no-webgl" or "failed" where there will be none.
import { breaks_section } from "./breaks.js";
import { from_base64, inflate } from "./decode.js";
import { foot, head, name_of, warnings } from "./head.js";
import { History } from "./history.js";
import { Plots } from "./plots.js";
import { Run } from "./run.js";
import { element } from "./text.js";
import { apply_theme, theme_button } from "./theme.js";
import { View } from "./view.js";

const place = (name) => document.getElementById(name);

function message(level, text) {
  place("messages").append(...warnings([{ level, text }]));
}

function shared_cursor(run, history, figures) {
  const plots = history.rows ? new Plots(history, run.json.plots, (row) => {
    const step = history.column("step")?.values[row];
    const sequence = view?.sequence;
    if (step == null || sequence?.json.kind !== "run") return;
    view.player.pause();
    view.player.show(sequence.nearest_frame(step));
  }) : null;
  const view = run.sequences.length ? new View(run, history, (frame, sequence) => {
    plots?.mark(sequence.json.kind === "run" ? history.row_of_step(sequence.frames[frame].step) : null);
  }) : null;
  figures.append(...[view?.root, plots?.root].filter(Boolean));
  return { plots, view };
}

function start_view(view, why_none = "There are no frames, so there is no 3D view. Give [output] frames in the case to have them.") {
  const state = document.documentElement.dataset;
  if (!view) {
    message("note", why_none);
    state.ready = "no-frames";
    return;
  }
  try {
    view.start();
  } catch (error) {
    if (!view.scene) {   // the renderer could not be made
      view.root.remove();
      message("warning", "This browser has no WebGL2, or it is switched off: the 3D view is left out. Plots and numbers are all here.");
      state.ready = "no-webgl";
      return;
    }
    throw error;
  }
  document.addEventListener("keydown", (event) => view.key_pressed(event));
}

async function show() {
  const json = JSON.parse(place("run").textContent);
  document.title = name_of(json);
  const history = new History(json.history, json.clock);
  let plots, view;
  place("head").append(...head(json, theme_button(() => { plots?.draw(); view?.set_ground(); })));
  place("messages").append(...warnings(json.warnings));
  place("foot").append(...foot(json));
  const run = new Run(json, await inflate(from_base64(place("data").textContent)));
  run.time_unit = history.column("time")?.unit ?? "";
  ({ plots, view } = shared_cursor(run, history, place("figures")));
  place("waiting").remove();
  plots?.start();
  start_view(view, json.no_frames);
  if (json.breaks) place("figures").after(breaks_section(json.breaks, json.units, view?.scene && ((row) => view.show_break(row))));
}

apply_theme();
if (location.hash === "#still") document.documentElement.dataset.still = "";
document.addEventListener("DOMContentLoaded", () => show().catch((error) => {
  place("waiting")?.remove();
  message("error", `The page could not be shown: ${error.message}`);
  document.documentElement.dataset.ready = "failed";
  throw error;
}));
