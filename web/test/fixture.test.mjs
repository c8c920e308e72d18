// The page of known numbers that the program's packer wrote, ../../tests/data/page.html, decoded by the page's own code.
// tests/report/page_fixture_test.cpp holds the packer against the same file. Needs node alone, no packages.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { from_base64, inflate, stored } from "../src/decode.js";
import { History } from "../src/history.js";
import { Run } from "../src/run.js";

const html = await readFile(new URL("../../tests/data/page.html", import.meta.url), "utf8");

/** The elements of the page as a browser's parser ends them: at the first "</script", in any case. */
const elements = [...html.matchAll(/<script type="([^"]*)" id="([^"]*)">(.*?)<\/script/gis)].map(([, type, id, text]) => ({ type, id, text }));
const json = JSON.parse(elements[0].text);
const block = await inflate(from_base64(elements[1].text));
const run = new Run(json, block);

const displacement = (f, c, k) => (30000 * f + 3001 * c + 17 * k) % 65536, field = (f, n, k) => (100 * f + 11 * n + 5 * k) % 256;

test("Fixture.NoTextEndsItsElement", () => {
  assert.deepEqual(elements.map(({ type, id }) => [type, id]), [["application/json", "run"], ["text/plain", "data"]]);
  assert.equal(html.replace(/<script.*?<\/script>/gis, "").trim(), "<!doctype html>", "nothing else is in the page");
  assert.ok(!/[<>&]/.test(elements[0].text));
  assert.equal(json.title, "</script><script>document.title='run'</script><!-- & \\u003c");
  assert.equal(json.rerun.case, "title = \"<!-- run -->\"\n");
  assert.deepEqual(json.results, [["<i>", "&amp;"]]);
});

test("Fixture.PositionsComeBackExactly", () => {
  const [sequence] = run.sequences, reference = [-1.5, 0, 0, 0, 0.5, 0, 1.5, 0, -0.125];
  const low = [-1, 0, 2], step = [2 ** -10, 2 ** -12, 0];
  assert.deepEqual([run.particles, ...run.radius], [3, 0.25, 0.5, 0.75]);
  assert.deepEqual(sequence.json.origin, [1e8, 0.25, -3e12]);
  for (let f = 0; f < 4; ++f) {
    const at = sequence.positions(f, 1, new Float64Array(9), 3);
    for (let k = 0; k < 3; ++k) for (let c = 0; c < 3; ++c) assert.equal(at[3 * k + c], reference[3 * k + c] + low[c] + step[c] * displacement(f, c, k));
  }
});

test("Fixture.BondsAndTheirFieldsComeBackExactly", () => {
  const [sequence, mode] = run.sequences, of = (key) => sequence.quantities.find((q) => q.key === key);
  assert.deepEqual([...run.ends], [0, 1, 1, 2]);
  assert.deepEqual(sequence.frames.map((f) => f.bonds), [1, 2, 2, 2]);
  assert.deepEqual(sequence.frames.map((f) => [f.step, f.time, f.stage]), [[0, 0, "push"], [10, 0.5, "push"], [20, 1, "hold"], [30, 1.5, "hold"]]);
  const keys = ["elongation", "bend", "twist", "U_L", "U_B", "U_T", "utilisation", "axial_force", "shear_force", "bending_moment", "torque"], degrees = 180 / Math.PI;
  keys.forEach((key, n) => {
    for (let f = 0; f < 4; ++f) {
      for (let b = 0; b < sequence.bonds_at(f); ++b) {
        const value = -n + 2 ** -n * field(f, n, b);
        assert.equal(of(key).value(f, b), key === "bend" || key === "twist" ? degrees * value : value, `${key}, frame ${f}, bond ${b}`);
      }
    }
  });
  assert.deepEqual([of("U_B").unit, of("bend").unit, of("elongation").unit, of("speed").unit], ["J", "°", "", "m/s"]);
  assert.equal(of("speed").value(3, 2), 2 ** -3 * field(3, 7, 2));
  assert.deepEqual([0, 1, 2, 3].map((f) => of("range").value(f, 0)), [0, 1, 2, 0]);
  assert.deepEqual([mode.json.kind, mode.json.loop, mode.json.note, mode.last], ["mode", true, "frequency 2 Hz & more", 2]);
  assert.ok(!mode.quantities.some(({ key }) => key === "speed"));
});

test("Fixture.BreaksComeBackExactly", () => {
  const [sequence, mode] = run.sequences, fragment = sequence.quantities.find(({ key }) => key === "fragment");
  assert.deepEqual(sequence.broken.list, [{ bond: 1, cause: 5, frame: 2 }]);
  for (let f = 0; f < 4; ++f) for (let k = 0; k < 3; ++k) assert.equal(fragment.value(f, k), 300 * f * k);
  assert.deepEqual([mode.broken.list, mode.quantities.some(({ key }) => ["fragment", "utilisation", "torque"].includes(key))], [[], false]);
  assert.deepEqual(json.breaks, { count: 1, words: "1 bond broke: 1 in compression",
    first: [{ step: 15, when: "t = 0.75 s", bond: 1, i: 1, j: 2, mode: 5, cause: "-N/A + M_b r/J = 3 of 2 MPa", energy: 0.25 }] });
});

test("Fixture.ContactsComeBackExactly", () => {
  const [{ contacts, quantities }, mode] = run.sequences, force = quantities.find(({ key }) => key === "contact_force");
  assert.deepEqual([0, 1, 2, 3].map((f) => [contacts.written(f), contacts.count(f), contacts.largest(f)]),
    [[false, 0, 0], [true, 1, 0.5], [true, 2, 2 + 255 / 16], [true, 0, 0]]);
  assert.deepEqual([[1, 0], [2, 0], [2, 1]].map(([f, k]) => [contacts.between(f, k), contacts.force(f, k), contacts.ends(f, k)]),
    [[[0, 2], 0.5, null], [[0, 1], 2 + 255 / 16, null], [[1, 1], 2, [0, 0, 0, -0.5, -0.25, -0.5 + 255 / 256]]]);
  assert.deepEqual([force.unit, force.extremes(), contacts.most], ["N", [0.5, 2 + 255 / 16], 2]);
  assert.deepEqual([mode.contacts, mode.quantities.some(({ key }) => key === "contact_force")], [undefined, false]);
});

test("Fixture.HistoryAndPresetsComeBack", () => {
  const history = new History(json.history, json.clock);
  assert.deepEqual(history.column("axial_force.all"), { name: "axial_force.all", unit: "N", values: [0, null, -3] });
  assert.deepEqual([history.column("displacement.1.x").unit, json.history.rows_in_file, json.clock], ["m", 3, "time"]);
  const [preset] = history.presets(json.plots);
  assert.deepEqual([preset.x, preset.y, preset.turned], ["displacement.1.x", ["axial_force.all"], { x: true, y: true }]);
});

/** Every array that JSON describes. */
function* arrays(value) {
  if (value === null || typeof value !== "object") return;
  if ("offset" in value) yield value;
  else for (const part of Object.values(value)) yield* arrays(part);
}

test("Fixture.ArraysAreWhatTheFormatSays", () => {
  for (const array of arrays(json)) {
    const plain = ["offset", "type", "count"], quantised = [...plain, "low", "step"], of_contacts = Object.values(json.sequences[0].contacts).includes(array);
    assert.deepEqual(Object.keys(array), ["u32", "f32"].includes(array.type) ? plain : of_contacts ? quantised : [...quantised, "delta"]);
    assert.equal(array.offset % 4, 0);
    assert.equal(stored(block, array).length, array.count);
  }
  const top = ["format", "program", "title", "units", "facts", "results", "warnings", "rerun", "plots", "clock", "over", "left_out", "history", "breaks", "radius", "bonds",
               "first_shown", "sequences"];
  const sequence = ["kind", "name", "note", "loop", "frames", "origin", "reference", "displacement", "particle_fields", "bond_fields", "bond_range"];
  const of_runs = ["bond_broken", "fragment", "contacts"];
  assert.deepEqual([json, ...json.sequences].map(Object.keys), [top, [...sequence, ...of_runs], sequence]);
});
