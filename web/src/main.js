// Puts the page together. `data-ready` of the document says how far it is: "drawn" after the first
// picture, "no-frames", "no-webgl" or "failed" where there will be none.
import { breaks_section } from "./breaks.js";
import { from_base64, inflate } from "./decode.js";
import { show_fit } from "./fit.js";
import { foot, head, name_of, warnings } from "./head.js";
import { History } from "./history.js";
import { Live, contents } from "./live.js";
import { show_material } from "./material.js";
import { Plots } from "./plots.js";
import { Run } from "./run.js";
import { show_sweep } from "./sweep.js";
import { element } from "./text.js";
import { apply_theme, theme_button } from "./theme.js";
import { View } from "./view.js";

const place = (name) => document.getElementById(name);

function message(level, text) {
  place("messages").append(...warnings([{ level, text }]));
}

const still = location.hash.match(/^#still(?:=(\d+))?$/);   // the 3D view alone, with its last frame or this one

/** What is shown of one state of a run; a live page shows one after another. */
class Shown {
  /** `before`: what was shown until now, or null; what the reader has chosen there is kept. */
  constructor({ json, data }, before) {
    this.json = json;
    this.data = data;
    this.kept = { view: before?.view?.kept() ?? (still?.[1] && { frame: Number(still[1]) }) ?? undefined, plots: before?.plots?.kept() };
    this.history = new History(json.history, json.clock, json.over);
  }

  async build() {
    const { json, history } = this;
    this.run = new Run(json, await inflate(from_base64(this.data)), history.column("time")?.unit);
    this.share_cursor();
    document.title = name_of(json);
    place("head").replaceChildren(...head(json, theme_button(() => { this.plots?.draw(); this.view?.set_ground(); })));
    place("messages").replaceChildren(...warnings(json.warnings));
    place("foot").replaceChildren(...foot(json));
    place("figures").replaceChildren(...[this.view?.root, this.plots?.root].filter(Boolean));
    this.plots?.start();
    this.start_view(json.no_frames);
    document.querySelector(".breaks")?.remove();
    if (json.breaks) place("figures").after(breaks_section(json.breaks, json.units, this.view?.scene && ((row) => this.view.show_break(row))));
  }

  share_cursor() {
    const { run, history } = this;
    this.plots = history.rows ? new Plots(history, run.json.plots, (row) => {
      const step = history.column("step")?.values[row];
      const sequence = this.view?.sequence;
      if (step == null || sequence?.json.kind !== "run") return;
      this.view.player.pause();
      this.view.player.show(sequence.nearest_frame(step));
    }, this.kept.plots) : null;
    this.view = run.sequences.length ? new View(run, history, (frame, sequence) => {
      this.plots?.mark(sequence.json.kind === "run" ? history.row_of_step(sequence.frames[frame].step) : null);
    }, this.kept.view) : null;
  }

  start_view(why_none = "There are no frames, so there is no 3D view. Give [output] frames in the case to have them.") {
    const state = document.documentElement.dataset;
    if (!this.view) {
      message("note", why_none);
      state.ready = "no-frames";
      return;
    }
    try {
      this.view.start();
    } catch (error) {
      if (this.view.scene) throw error;
      this.view.root.remove();   // the renderer could not be made
      message("warning", "This browser has no WebGL2, or it is switched off: the 3D view is left out. Plots and numbers are all here.");
      state.ready = "no-webgl";
    }
  }
}

let shown = null;

async function show(page) {
  const next = new Shown(page, shown), top = scrollY;
  shown?.view?.close();
  shown = next;
  await next.build();
  scrollTo(0, top);   // the page was shorter meanwhile
}

async function start() {
  if (place("sweep")) return show_sweep(JSON.parse(place("sweep").textContent), place, theme_button);
  if (place("fit")) return show_fit(JSON.parse(place("fit").textContent), place, theme_button, warnings);
  if (place("material")) return show_material(JSON.parse(place("material").textContent), place, theme_button, warnings);
  const page = contents(document);
  await show(page);
  document.addEventListener("keydown", (event) => shown.view?.scene && shown.view.key_pressed(event));
  if (page.json.live == null) return;
  const line = element("p", { id: "live", role: "status" });
  place("messages").before(line);
  await new Live(page.json.live, show, (lines) => line.replaceChildren(...lines.map((text) => element("span", {}, text)))).follow();
}

apply_theme();
if (still) document.documentElement.dataset.still = "";
document.addEventListener("DOMContentLoaded", () => start().catch((error) => {
  place("waiting")?.remove();
  message("error", `The page could not be shown: ${error.message}`);
  document.documentElement.dataset.ready = "failed";
  throw error;
}));
