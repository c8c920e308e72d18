// The 3D view with all that belongs to it: controls, legend, caption, keys.
import { contacts_legend, draw_axes, faces_legend, legend, marks_legend } from "./legend.js";
import { paint, scale_of } from "./paint.js";
import { numbers_box, numbers_of, picked_at } from "./pick.js";
import { Player } from "./player.js";
import { BodyScene } from "./scene.js";
import { colour_of, save_picture } from "./picture.js";
import { contact_key } from "./run.js";
import { capital, element, number, with_unit } from "./text.js";
import { along, bounds, first_view } from "./viewpoint.js";

const most_moved = 4;   // pixels, of a pointer that clicks
const speeds = [0.1, 0.25, 0.5, 1, 2, 4];

function choice(label, options, value, chosen) {
  const select = element("select", { onchange: () => chosen(select.value) },
    ...options.map(([key, text]) => element("option", { value: key, selected: String(key) === String(value) }, text)));
  return element("label", { class: "control" }, element("span", {}, label), select);
}

export class View {
  /** `frame_shown(frame, sequence)` is called after each change of the frame; `kept` of a view before this one. */
  constructor(run, history, frame_shown, kept = {}) {
    const { index = run.json.first_shown ?? 0, frame = null, camera = null, speed = 1, ...choices } = kept;
    this.run = run;
    this.history = history;
    this.frame_shown = frame_shown;
    this.factor = 1;
    this.map = "viridis";
    this.size = 0;
    this.key = null;
    this.picked = null;
    this.ranges = {};
    this.cut = { side: "", part: 0.5 };
    this.ghost = false;
    this.marks = false;
    this.contacts = false;
    this.wrapped = false;
    this.key_before = null;   // of the quantity that had the colour before contacts
    Object.assign(this, choices);
    this.first = { index: Math.min(index, run.sequences.length - 1), frame, camera };
    this.player = new Player(() => this.update());
    this.player.set_speed(speed);
    this.canvas = element("canvas", { tabindex: 0, role: "img", onpointerdown: (event) => { this.pressed = [event.clientX, event.clientY]; },
                                      onclick: (event) => this.clicked(event) });
    this.picked_place = element("div", {});
    this.caption = element("p", { class: "caption" });
    this.legend_place = element("div", {});
    this.marks_place = element("div", {});
    this.contacts_place = element("div", {});
    this.axes = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    this.axes.setAttribute("class", "axes");
    this.axes.setAttribute("viewBox", "0 0 80 80");
    this.axes.setAttribute("aria-hidden", "true");
    this.picture = element("div", { class: "picture" }, this.canvas, this.axes);
    this.stage = element("div", { class: "stage" }, this.caption, this.picture, this.legend_place);   // words beside the body, not on it
    this.note = element("p", { class: "note" });
    this.root = element("section", { class: "view", "aria-label": "The body in 3D" }, element("h2", { class: "unseen" }, "The body in 3D"), this.stage, this.timeline(), this.picked_place, this.settings(), this.note);
  }

  /** Call when `root` is in the document. Throws if there is no WebGL2. */
  start() {
    this.scene = new BodyScene(this.canvas, this.run, () => this.after_picture());
    this.set_ground();
    this.fit();
    const { index, frame, camera } = this.first;
    this.open(index);
    if (frame != null) this.player.show(frame);
    if (camera) this.scene.restore(camera);
    this.sizes = new ResizeObserver(() => this.fit());
    this.sizes.observe(this.picture);
  }

  /** What the reader has chosen, for a view of newer data. The last frame stays the last one. */
  kept() {
    if (!this.sequence) return undefined;
    const { factor, map, size, key, picked, ranges, cut, ghost, marks, contacts, wrapped, key_before, player, sequence, run } = this;
    return { factor, map, size, key, picked, ranges, cut, ghost, marks, contacts, wrapped, key_before, speed: player.speed, index: run.sequences.indexOf(sequence),
             frame: player.swings || player.frame === sequence.last ? null : player.frame, camera: this.scene.turned ? this.scene.camera_now() : null };
  }

  /** Frees what the browser has only a few of. */
  close() {
    this.player.pause();
    this.sizes?.disconnect();
    this.scene?.close();
  }

  /** After a change of theme, too. */
  set_ground() { this.scene?.set_ground(colour_of("--stage")); }

  fit() {
    const { clientWidth, clientHeight } = this.picture;
    if (!clientWidth || !clientHeight) return;
    this.scene.resize(clientWidth, clientHeight);
    if (this.viewpoint && !this.scene.turned) this.look(this.viewpoint);
    this.scene.draw();   // at once: a canvas of new size is blank until drawn
  }

  after_picture() {
    draw_axes(this.axes, this.scene.camera);
    document.documentElement.dataset.ready = "drawn";
  }

  timeline() {
    this.play_button = element("button", { type: "button", class: "play", onclick: () => this.player.toggle() });
    this.scrub = element("input", { type: "range", class: "scrub", min: 0, value: 0, "aria-label": "Frame",
                                    oninput: () => { this.player.pause(); this.player.show(Number(this.scrub.value)); } });
    this.count = element("span", { class: "count" });
    return element("div", { class: "timeline" }, this.play_button, this.scrub, this.count);
  }

  settings() {
    this.quantity_place = element("div", { class: "group" });
    const factor = element("input", { type: "number", min: 0, step: "any", value: this.factor, list: "factors", id: "factor",
                                      onchange: () => this.set_factor(factor) });
    const factors = element("datalist", { id: "factors" }, ...[1, 2, 5, 10, 20, 50, 100, 1000].map((value) => element("option", { value })));
    const looks = ["+x", "−x", "+y", "−y", "+z", "−z"].map((name) => element("button",
      { type: "button", "aria-label": `Look from ${name}`, onclick: () => this.look(along(name.replace("−", "-"))) }, name));
    return element("div", { class: "settings" },
      this.run.sequences.length > 1
        ? choice("Show", this.run.sequences.map((s, k) => [k, s.json.name]), this.first.index, (k) => this.open(Number(k))) : null,
      this.quantity_place,
      choice("Colour map", [["viridis", "viridis"], ["cividis", "cividis"]], this.map, (map) => { this.map = map; this.choose(this.key); }),
      element("label", { class: "control" }, element("span", {}, "Displacements ×"), factor, factors),
      this.range_control(),
      choice("Spheres", [[0, "automatic"], [1, "full size"], [0.45, "small"], [0.3, "tiny"]], this.size, (size) => { this.size = Number(size); this.update(); }),
      this.cut_control(),
      this.check_box("Undeformed shape", "ghost"),
      this.run.sequences.some(({ cell }) => cell) ? this.check_box("Particles in the cell", "wrapped", () => { this.reset(); this.update(); }) : null,
      this.run.stages.size ? this.check_box("Supports and loads", "marks") : null,
      this.run.sequences.some(({ contacts }) => contacts) ? this.contacts_box = this.check_box("Contact forces", "contacts", () => this.colour_contacts()) : null,
      choice("Speed", speeds.map((s) => [s, `${s} ×`]), this.player.speed, (s) => this.player.set_speed(Number(s))),
      element("div", { class: "control" }, element("span", {}, "Look from"),
        element("div", { class: "buttons", role: "group", "aria-label": "Look from" }, ...looks,
          element("button", { type: "button", onclick: () => this.reset() }, "Reset"))),
      element("div", { class: "control" }, element("span", {}, "Picture"),
        element("button", { type: "button", "aria-label": "Save the 3D view as PNG", onclick: () => save_picture(this) }, "PNG")));
  }

  check_box(label, shown, changed = () => this.update()) {
    const box = element("input", { type: "checkbox", checked: this[shown], onchange: () => { this[shown] = box.checked; changed(); } });
    return element("label", { class: "control" }, element("span", {}, label), box);
  }

  /** Contacts that have just been switched on carry the colour, and leave it to what had it before. */
  colour_contacts() {
    const { quantities, contacts } = this.sequence;
    if (!contacts) return this.update();
    if (this.contacts) this.key_before = this.key;
    else if (this.key !== contact_key) return this.update();
    const select = this.quantity_place.querySelector("select");
    select.value = this.contacts ? contact_key : this.key_before ?? quantities[0].key;
    this.choose(select.value);
  }

  /** Ends of the colours, as the reader wants them: for each quantity of its own, and apart for modes, whose quantities are relative. */
  range_control() {
    const field = (label) => element("input", { type: "number", step: "any", "aria-label": label, onchange: () => this.set_range() });
    this.range_ends = [field("Value of the lowest colour"), field("Value of the highest colour")];
    const automatic = element("button", { type: "button", onclick: () => { delete this.ranges[this.quantity.label]; this.choose(this.key); } }, "Automatic");
    return this.range_place = element("div", { class: "control" }, element("span", {}, "Colours from, to"),
      element("div", { class: "buttons", role: "group", "aria-label": "Range of the colours" }, ...this.range_ends, automatic));
  }

  set_range() {
    const [low, high] = this.range_ends.map((field) => field.valueAsNumber), last = this.range_ends[1];
    last.setCustomValidity(low < high ? "" : "Two numbers, the second larger than the first");
    if (!last.reportValidity()) return;
    this.ranges[this.quantity.label] = [low, high];
    this.choose(this.key);
  }

  show_range() {
    this.range_place.hidden = !this.scale.ends;
    this.range_ends.forEach((field, k) => { field.value = this.scale.ends ? Number(this.scale.ends[k].toPrecision(4)) : ""; field.setCustomValidity(""); });
  }

  /** A plane across an axis; what is centred beyond it is not drawn. */
  cut_control() {
    const where = element("input", { type: "range", min: 0, max: 1, step: 0.005, value: this.cut.part, hidden: !this.cut.side, "aria-label": "Where the body is cut",
                                     oninput: () => { this.cut.part = where.valueAsNumber; this.update(); } });
    const sides = ["", "+x", "−x", "+y", "−y", "+z", "−z"];
    const side = choice("Cut away", sides.map((name) => [name.replace("−", "-"), name || "nothing"]), this.cut.side, (name) => {
      this.cut.side = name;
      where.hidden = !name;
      this.update();
    });
    return element("div", { class: "control" }, side, where);
  }

  /** Normal and offset of the plane, of a body in its box: what n.r > offset is gone. */
  cut_plane() {
    const { side, part } = this.cut;
    if (!side) return [0, 0, 0, 0];
    const { direction } = along(side), { centre, half } = this.box, size = Math.abs(direction.dot(half));
    return [...direction.toArray(), direction.dot(centre) + (1 - 2 * part) * size];
  }

  open(index) {
    this.sequence = this.run.sequences[index];
    const quantities = this.sequence.quantities;
    if (!quantities.some((q) => q.key === this.key)) this.key = quantities[0].key;
    this.quantity_place.replaceChildren(choice("Colour by", quantities.map((q) => [q.key, capital(q.label)]), this.key, (key) => this.choose(key)));
    this.quantity_place.querySelector("select").id = "quantity";
    this.note.textContent = this.sequence.json.note ?? "";
    this.reset();   // first: a cut lies in the box
    this.scrub.max = this.sequence.last;
    this.choose(this.key);
    this.player.open(this.sequence);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches || document.documentElement.dataset.still != null;
    if (this.player.swings && !calm) this.player.play();
  }

  choose(key) {
    this.key = key;
    this.quantity = this.sequence.quantities.find((q) => q.key === key);
    if (this.quantity.on === "contacts") this.contacts = this.contacts_box.querySelector("input").checked = true;
    this.scale = scale_of(this.quantity, this.map, this.ranges[this.quantity.label]);
    this.show_range();
    const faces = this.quantity.on === "contacts" ? "" : faces_legend(this.sequence.broken);
    this.legend_place.replaceChildren(legend(this.quantity, this.scale), faces, this.contacts_place, this.marks_place);
    this.update();
  }

  show_marks(kinds) {
    if (kinds.join() === this.marked) return;
    this.marked = kinds.join();
    this.marks_place.replaceChildren(marks_legend(kinds));
  }

  /** The lines of contacts, if they are wanted, with what their width means: that follows a range of colours that was chosen. Returns whether there are any. */
  show_contacts(frame) {
    const { sequence } = this, shown = this.contacts && !!sequence.contacts;
    const wanted = shown && this.ranges[sequence.quantities.find(({ key }) => key === contact_key).label];
    const widest = wanted ? Math.max(...wanted.map(Math.abs)) : shown ? sequence.contacts.largest(frame) : null;
    this.scene.place_contacts(sequence, frame, widest, this.quantity.on === "contacts");
    this.contacts_place.replaceChildren(shown ? contacts_legend(sequence, frame, widest, !!wanted) : "");
    return shown;
  }

  set_factor(input) {
    const value = input.valueAsNumber;
    input.setCustomValidity(value >= 0 ? "" : "A number that is not negative");
    if (!input.reportValidity()) return;
    this.factor = value;
    this.reset();
    this.update();
  }

  look(viewpoint) {
    this.viewpoint = viewpoint;
    this.scene.look(this.box, viewpoint.direction, viewpoint.up);
  }

  reset() {
    this.box = bounds(this.run, this.sequence, this.factor, this.wrapped);
    this.look(first_view(this.box, this.run.radius.reduce((most, r) => Math.max(most, r), 0)));
  }

  update() {
    const { frame, count, playing } = this.player;
    if (count !== this.sequence.frames.length) return;   // between two sequences
    this.scene.place_body(this.sequence, frame, this.factor, this.cut_plane(), this.ghost, this.wrapped);
    this.show_marks(this.scene.place_marks(this.sequence, frame, this.marks));
    const contacts = this.show_contacts(frame);
    paint(this.scene, this.sequence, frame, this.quantity, this.scale, this.size, this.picked, contacts);
    this.show_picked();
    this.play_button.textContent = playing ? "❚❚" : "▶";
    this.play_button.setAttribute("aria-label", playing ? "Pause" : "Play");
    this.scrub.value = frame;
    this.count.textContent = `${frame + 1} / ${count}`;
    this.caption.textContent = this.words();
    this.scrub.setAttribute("aria-valuetext", this.words());
    this.canvas.setAttribute("aria-label", `${this.sequence.json.name}, ${this.words()}, coloured by ${this.quantity.label}`);
    this.frame_shown(frame, this.sequence);
  }

  /** A click on the picture that did not turn the body. */
  clicked({ clientX, clientY }) {
    if (Math.hypot(clientX - this.pressed?.[0], clientY - this.pressed?.[1]) > most_moved) return;
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    this.pick(picked_at(this.scene, this.sequence, this.player.frame, (2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height));
  }

  /** {kind, number} of what is looked at, or null. */
  pick(picked) {
    this.picked = picked;
    this.update();
  }

  show_picked() {
    const { picked, run, sequence } = this;
    if (!picked) return this.picked_place.replaceChildren();
    const told = picked.kind === "bond" && run.json.breaks?.first.find(({ bond }) => bond === picked.number);
    const numbers = numbers_of(run, sequence, this.player.frame, picked);
    const sentence = told && sequence.broken.cause(this.player.frame, picked.number) ? `${told.cause}, at time ${with_unit(told.time, run.time_unit, 6)}.` : "";
    this.picked_place.replaceChildren(numbers_box(numbers, sentence, () => this.pick(null)));
  }

  /** Shows the run where a bond has just broken, and its numbers. */
  show_break({ bond, step }) {
    const run = this.run.sequences.findIndex(({ json }) => json.kind === "run");
    if (run < 0) return;
    if (this.sequence !== this.run.sequences[run]) this.open(run);
    this.player.pause();
    const { frames } = this.sequence, after = frames.findIndex((frame) => frame.step >= step);
    this.player.show(after < 0 ? frames.length - 1 : after);
    this.pick({ kind: "bond", number: bond });
    this.stage.scrollIntoView({ block: "nearest" });
  }

  /** Where in the run we are. */
  words() {
    const { frame } = this.player, at = this.sequence.frames[frame];
    const scaled = this.factor === 1 ? "" : `, displacements × ${number(this.factor)}`;
    if (this.sequence.json.kind === "mode") return this.sequence.json.name + scaled;
    const stage = at.stage ? `Stage ${at.stage}, ` : "", load_factor = this.history.load_factor_at(at.step);
    if (load_factor != null) return `${stage}point ${at.step}, load factor ${number(load_factor)}${scaled}`;
    return `${stage}time ${with_unit(at.time, this.run.time_unit)}, step ${at.step}${scaled}`;
  }

  /** Keys for the view; without focus anywhere those that do not scroll the page far. */
  key_pressed(event) {
    const anywhere = event.target === document.body, here = this.root.contains(event.target) && !event.target.closest("input, select, button");
    if (event.altKey || event.ctrlKey || event.metaKey || !(anywhere || here)) return;
    const does = { " ": () => this.player.toggle(), ArrowRight: () => this.player.move(1), ArrowLeft: () => this.player.move(-1),
                   ...(here && { Home: () => this.player.move(-Infinity), End: () => this.player.move(Infinity) }) }[event.key];
    if (!does) return;
    event.preventDefault();
    does();
  }
}
