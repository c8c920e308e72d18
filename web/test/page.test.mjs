import assert from "node:assert/strict";
import { test } from "node:test";
import { gunzipSync } from "node:zlib";
import { Cell } from "../src/cell.js";
import { maps, scale_ends, shade } from "../src/colours.js";
import { cause_colours, causes, fragment_colours } from "../src/palette.js";
import { from_base64, inflate, stored, undelta } from "../src/decode.js";
import { curves_of as fit_curves, derivative_words, messages_of, search_of, without_interval } from "../src/fit.js";
import { name_of } from "../src/head.js";
import { linear_axis, log_axis, log_ticks } from "../src/axis.js";
import { around, constants_of, units_of } from "../src/material.js";
import { direction_words, rings_of } from "../src/polar.js";
import { History, extent, nearest, stack } from "../src/history.js";
import { Plot } from "../src/plot.js";
import { scale_of } from "../src/paint.js";
import { Player } from "../src/player.js";
import { Vector3 } from "three";
import { disc_hit, line_hit, numbers_of, sphere_hit } from "../src/pick.js";
import { Run, fragment_classes } from "../src/run.js";
import { axes_of, curves_of, results_worth_showing } from "../src/sweep.js";
import { file_name, number, with_unit } from "../src/text.js";
import { bounds, first_view } from "../src/viewpoint.js";
import { Walls } from "../src/walls.js";
import { Block, breaking, held, rod } from "./sample.mjs";

test("Decoding.DifferencesBetweenFramesWrapAround", () => {
  assert.deepEqual([...undelta(Uint8Array.of(250, 3, 10, 255, 1, 0), 2)], [250, 3, 4, 2, 5, 2]);
  assert.deepEqual([...undelta(Uint16Array.of(65535, 2), 1)], [65535, 1]);
});

test("Decoding.LowBytesStandBeforeHighBytes", () => {
  const block = Uint8Array.of(9, 9, 9, 9, 0x34, 0xff, 0x12, 0x01);
  assert.deepEqual([...stored(block, { offset: 4, type: "u16", count: 2 })], [0x1234, 0x01ff]);
});

test("Decoding.PlainArraysAreLittleEndian", () => {
  const block = Uint8Array.of(1, 2, 0, 0, 0, 0, 128, 191);
  assert.deepEqual([...stored(block, { offset: 0, type: "u32", count: 1 })], [513]);
  assert.deepEqual([...stored(block, { offset: 4, type: "f32", count: 1 })], [-1]);
});

test("Decoding.AnArrayBeyondTheBlockIsAnError", () => {
  assert.throws(() => stored(new Uint8Array(7), { offset: 4, type: "f32", count: 1 }), /ends at byte 8, the block at 7/);
  assert.throws(() => stored(new Uint8Array(8), { offset: 0, type: "f64", count: 1 }), /unknown type/);
});

test("Decoding.WhatWasPackedComesBack", async () => {
  const block = new Block(), values = [0, 7, 3, 255, 0, 128, 9, 1];
  const array = block.integers("u8", values, 4);
  const bytes = await inflate(from_base64(block.base64()));
  assert.deepEqual([...stored(bytes, array)], values);
});

test("Run.PositionsAreWithinHalfAStepOfWhatWasWritten", () => {
  const { json, base64 } = rod();
  const run = new Run(json, new Uint8Array(gunzipSync(Buffer.from(base64, "base64"))));
  const [sequence] = run.sequences, last = sequence.last;
  const at = sequence.positions(last, 1, new Float32Array(30), 3);
  const half_step = 0.5 * Math.max(...json.sequences[0].displacement.step);
  for (let k = 0; k < 10; ++k) {   // as rod() bends it; f32 adds 1e-6 at this size
    assert.ok(Math.abs(at[3 * k] - (k - (0.8 * k) / 9)) < half_step + 1e-6);
    assert.ok(Math.abs(at[3 * k + 2] - 2.2 * Math.sin((Math.PI * k) / 9)) < half_step + 1e-6);
  }
  assert.equal(sequence.positions(last, 0, new Float32Array(30), 3)[27], 9, "factor 0 is the reference");
  assert.equal(sequence.bonds_at(0), 8);
  assert.equal(sequence.nearest_frame(149), 1);
});

test("Run.TotalEnergyIsTheSumAndAnglesAreInDegrees", () => {
  const { json, base64 } = rod();
  const [sequence] = new Run(json, new Uint8Array(gunzipSync(Buffer.from(base64, "base64")))).sequences;
  const of = (key) => sequence.quantities.find((q) => q.key === key);
  const parts = ["U_L", "U_B", "U_T"].map((key) => of(key).value(59, 4));
  assert.equal(of("U").value(59, 4), parts[0] + parts[1] + parts[2]);
  assert.equal(of("bend").unit, "°");
  // largest difference of neighbours: 2.2 (sin(pi / 9) - 0), times 6 rad
  assert.ok(Math.abs(of("bend").extremes()[1] - (180 / Math.PI) * 13.2 * Math.sin(Math.PI / 9)) < 1e-9);
});

test("Run.OnlyTheUnitMakesAnAngle", () => {
  const { json, base64 } = rod();
  const bend = json.sequences[0].bond_fields.find(({ key }) => key === "bend");
  bend.unit = "";
  const [sequence] = new Run(json, new Uint8Array(gunzipSync(Buffer.from(base64, "base64")))).sequences;
  const read = sequence.quantities.find(({ key }) => key === "bend");
  assert.equal(read.unit, "");
  assert.ok(Math.abs(read.extremes()[1] - (bend.array.low + 255 * bend.array.step)) < 1e-9);
});

test("Run.AnotherFormatIsRefused", () => {
  assert.throws(() => new Run({ format: 2 }, new Uint8Array(0)), /format 1.*format 2/);
});

test("Colours.MapsBeginAndEndAsPublished", () => {
  const ends = (map) => [[...map.slice(0, 3)], [...map.slice(-3)]];
  assert.deepEqual(ends(maps.viridis), [[0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]]);   // matplotlib
  const [dark, bright] = ends(maps.cividis);   // a polynomial fit of matplotlib's: off by up to 4 of 255
  assert.ok(dark[2] > dark[0] && bright[0] > bright[2]);
});

test("Colours.LightnessGrowsAlongOneSignedMaps", () => {
  for (const map of [maps.viridis, maps.cividis]) {
    const light = (k) => 0.2126 * map[3 * k] + 0.7152 * map[3 * k + 1] + 0.0722 * map[3 * k + 2];
    for (let k = 8; k < 256; k += 8) assert.ok(light(k) > light(k - 8));
  }
});

test("Colours.ZeroIsTheMiddleOfASignedScale", () => {
  const ends = scale_ends([-1, 3], true);
  assert.deepEqual(ends, [-3, 3]);
  assert.ok([127, 128].includes(shade(0, ends)));
  assert.deepEqual(scale_ends([2, 3], false), [0, 3]);
  assert.deepEqual(scale_ends([-1e-19, 3], false), [0, 3]);
  assert.equal(shade(5, [0, 0]), 0);
});

test("History.NearestTakesTheFirstOfEquals", () => {
  assert.equal(nearest([0, 10, 10, 20], 10), 1);
  assert.equal(nearest([0, 10, 20], 16), 2);
  assert.equal(nearest([0, 10], 99), 1);
});

test("History.StacksKeepGaps", () => {
  assert.deepEqual(stack([[1, null, 3], [1, 1, 1]]), [[1, null, 3], [2, null, 4]]);
  assert.deepEqual(extent([[null, 2], [-1, null]]), [-1, 2]);
  assert.equal(extent([[null]]), null);
});

test("History.TheClockIsTheOneGivenElseTime", () => {
  const columns = { columns: [{ name: "step" }, { name: "time" }, { name: "load_factor" }], values: [[0, 1], [0, 1], [0, 1]] };
  assert.equal(new History(columns, "step").clock, "step");
  assert.equal(new History(columns).clock, "time");
  assert.equal(new History({ columns: [{ name: "U_L" }], values: [[0]] }, "step").clock, "U_L");
});

test("History.LoadFactorsAreOfBalancesAlone", () => {
  const columns = ["step", "load_factor"].map((name) => ({ name })), history = new History({ columns, values: [[1, 2, 50], [0, 0.5, null]] });
  assert.deepEqual([1, 2, 50].map((step) => history.load_factor_at(step)), [0, 0.5, null]);
  assert.deepEqual([3, 20, 49, 60].map((step) => history.load_factor_at(step)), [null, null, null, null], "in motion, between rows");
  assert.equal(new History({ columns: columns.slice(0, 1), values: [[1, 2]] }).load_factor_at(2), null);
  assert.equal(new History({ columns: columns.slice(1), values: [[0, 1]] }).load_factor_at(1), null);
});

test("History.PresetsWithoutTheirColumnsAreLeftOut", () => {
  const history = new History({ columns: [{ name: "time" }, { name: "U_L" }], values: [[0, 1], [0, 2]], rows_in_file: 2 });
  assert.deepEqual(history.presets([{ title: "?", x: "time", y: ["force"] }]).map((p) => p.title), ["Energies"]);
  assert.equal(history.csv(["time", "U_L"]), "time,U_L\n0,0\n1,2\n");
  const at_rest = new History({ columns: [{ name: "time" }, { name: "U_L" }], values: [[0, 1], [0, 0]], rows_in_file: 2 });
  assert.deepEqual(at_rest.presets([]), [], "no energy, no plot of it");
});

test("History.CurvesOfCompressionGoForward", () => {
  const columns = { columns: ["step", "time", "u", "F", "G"].map((name) => ({ name })),
                    values: [[0, 1, 2], [0, 1, 2], [0, -1, -2], [0, -5, -3], [0, 4, 5.5]] };
  const turned = (x, y) => new History(columns).presets([{ title: "", x, y }])[0].turned;
  assert.deepEqual(turned("u", ["F"]), { x: true, y: true });
  assert.deepEqual(turned("u", ["F", "G"]), { x: true, y: false }, "the larger one decides");
  assert.deepEqual(turned("G", ["F"]), { x: false, y: true });
  for (const clock of ["time", "step"]) assert.equal(turned(clock, ["u"]), undefined, "what happens over time keeps its sign");
});

test("Plot.AxesAreTurnedAsTheirNamesSay", () => {
  const columns = { columns: [{ name: "time" }, { name: "u" }, { name: "F" }, { name: "G" }], values: [[0, 1, 2], [0, -1, -2], [0, -5, -3], [0, null, 1]] };
  const history = new History(columns), [preset] = history.presets([{ title: "", x: "u", y: ["G", "F"] }]);
  const plot = Object.assign(Object.create(Plot.prototype), { history, preset, hidden: new Set(), log: {} });
  const { x_axis, y_axis, x, ys } = plot.curves(), read = (axis, values) => values.map((v) => (v == null ? v : axis.words([v])[0]));
  assert.deepEqual([read(x_axis, x), read(y_axis, ys[0]), read(y_axis, ys[1])], [["0", "1", "2"], ["0", null, "−1"], ["0", "5", "3"]]);
  assert.deepEqual([plot.axis_words(["u"], "x"), plot.axis_words(["F"], "y"), plot.turned(-5, "y")], ["−u", "−F", 5]);
  plot.preset = { ...preset, turned: undefined };
  assert.deepEqual([plot.axis_words(["u"], "x"), plot.curves().x.at(-1) < 0, plot.turned(-5, "y")], ["u", true, -5]);
});

test("Run.AModeHasNoSize", () => {
  const { json, base64 } = rod();
  json.units = "SI";
  const { sequences: [run, mode] } = new Run(json, new Uint8Array(gunzipSync(Buffer.from(base64, "base64"))));
  const of = (sequence, key) => sequence.quantities.find((q) => q.key === key);
  assert.equal(of(run, "displacement").unit, "m");
  for (const { key, unit, extremes, label } of mode.quantities.filter((q) => q.key !== "range")) {
    assert.equal(unit, "", key);
    assert.ok(label.endsWith("relative to the largest"));
    assert.equal(Math.max(...extremes().map(Math.abs)), 1, key);
  }
  // the wave sin(2 pi k / 9) swings most at k = 2 and 7; k = 1 has sin(40 deg) / sin(80 deg) of it
  const shape = of(mode, "displacement");
  assert.ok(Math.abs(shape.value(10, 2) - 1) < 1e-4);
  assert.ok(Math.abs(shape.value(10, 1) - Math.sin(Math.PI / 4.5) / Math.sin(Math.PI / 2.25)) < 1e-4);
});

const run_of = ({ json, base64 }) => new Run(json, new Uint8Array(gunzipSync(Buffer.from(base64, "base64"))));

test("Run.TellsWhatHoldsAndLoadsAParticle", () => {
  const run = run_of(held()), [sequence] = run.sequences, holds = run.holds_in(sequence, 0);
  assert.deepEqual(holds.words(0), [["Held in", "x, y, z, rx, ry, rz"]]);
  assert.deepEqual(holds.words(9), [["Held in", "y, z"], ["Given force", "−2, 0, 0"]]);
  assert.deepEqual(holds.words(4), [["Given force", "0, 0, 1"], ["Given moment", "0, 0.5, 0"]]);
  assert.deepEqual(holds.words(5), []);
  assert.equal(run.holds_in(sequence, sequence.last), undefined, "another stage");
  assert.equal(run_of(rod()).holds_in(sequence, 0), undefined);
  const [label, text] = numbers_of(run, sequence, 0, { kind: "particle", number: 9 })[1][2];
  assert.equal(`${label} ${text}`, "Held in y, z");
});

test("Broken.BondsAreListedInTheOrderOfTheirFrames", () => {
  const made = breaking(), { lost, bonds } = made, run = run_of(made), [{ broken }] = run.sequences;
  assert.deepEqual(broken.list, lost.map((bond, k) => ({ bond, cause: 1 + (bond % 4), frame: 10 + 5 * k })));
  assert.deepEqual([0, 9, 10, 14, 15, 25, 39].map((f) => broken.count(f)), [0, 0, 1, 1, 2, 4, 4]);
  assert.deepEqual(broken.until(20).map(({ bond }) => bond), lost.slice(0, 3));
  assert.deepEqual([broken.cause(9, lost[0]), broken.cause(10, lost[0]), broken.cause(39, 0)], [0, 1 + (lost[0] % 4), 0]);
  // at frame 9 both ends of the lowest bond have moved, +2 and -1, by (9/39)^2: 1 + 3 (9/39)^2 apart
  assert.equal(bonds[lost[0]][0] % 4, 0);
  assert.ok(Math.abs(broken.half_length(broken.list[0]) - 0.5 * (1 + 3 * (9 / 39) ** 2)) < 1e-4);
});

test("Broken.ARunInWhichNothingBreaksHasNone", () => {
  const run = run_of(rod());
  for (const { broken, quantities } of run.sequences) {
    assert.deepEqual([broken.list, broken.count(3), broken.cause(3, 1), broken.until(3)], [[], 0, 0, []]);
    assert.ok(!quantities.some(({ key }) => ["fragment", "utilisation", "axial_force"].includes(key)));
  }
});

test("Run.UtilisationIsShownUpToOne", () => {
  const [{ quantities }] = run_of(breaking()).sequences, of = (key) => quantities.find((q) => q.key === key);
  assert.deepEqual(scale_of(of("utilisation"), "viridis").ends, [0, 1]);
  assert.ok(of("utilisation").extremes()[1] < 0.999, "though none comes so far");
  assert.deepEqual(scale_of(of("torque"), "viridis").ends.map((v) => Math.round(1e3 * v)), [-390, 390], "-0.4 * 39 / 40 of the last bond");
  assert.deepEqual(["axial_force", "shear_force", "bending_moment", "torque"].map((key) => of(key).unit), ["N", "N", "N m", "N m"]);
});

test("Run.AFragmentKeepsItsColourWhenNumbersChange", () => {
  const before = fragment_classes([0, 0, 2, 2, 1, 1]), after = fragment_classes([0, 0, 1, 1, 2, 2]);
  assert.deepEqual([...before], [...after]);
  assert.deepEqual([before[0], before[2] === before[3], before[2] > 0, before[4] > 0], [0, true, true, true]);
  assert.ok(new Set(fragment_classes(Uint16Array.from({ length: 200 }, (_, k) => k))).size === fragment_colours.length, "all colours come up");
  const [{ quantities }] = run_of(breaking()).sequences, fragment = quantities.find(({ key }) => key === "fragment");
  assert.deepEqual([[24, 0], [24, 47], [25, 0], [25, 47]].map(([f, k]) => fragment.value(f, k)), [0, 0, 0, 1]);
  assert.ok(fragment.class_of(25, 47) > 0 && fragment.class_of(25, 0) === 0 && fragment.class_of(24, 47) === 0);
});

test("Colours.EveryCauseHasOne", () => {
  assert.equal(causes.length, cause_colours.length);
  assert.equal(new Set(cause_colours.map(String)).size, cause_colours.length);
});

test("Pick.TheRayMeetsSpheresAndLinesWhereTheyAre", () => {
  const eye = new Vector3(0, 0, 10), way = new Vector3(0, 0, -1), at = (...x) => new Vector3(...x);
  assert.equal(sphere_hit(eye, way, at(0, 0, 0), 2), 8);
  assert.ok(Math.abs(sphere_hit(eye, way, at(1.2, 0, 0), 2) - 8.4) < 1e-12, "3-4-5: 1.2 beside, 1.6 before");
  assert.equal(sphere_hit(eye, way, at(2.01, 0, 0), 2), Infinity);
  assert.equal(sphere_hit(eye, way, at(0, 0, 20), 2), Infinity, "behind the eye");
  assert.equal(line_hit(eye, way, at(-1, 0.2, 0), at(1, 0.2, 0), 0.25, 0), 9.75);
  assert.equal(line_hit(eye, way, at(-1, 0.3, 0), at(1, 0.3, 0), 0.25, 0), Infinity);
  assert.equal(line_hit(eye, way, at(-1, 0.3, 0), at(1, 0.3, 0), 0.25, 0.01), 9.75, "wider by 0.1 at a distance of 10");
  assert.equal(line_hit(eye, way, at(0.5, 0, 0), at(1, 0, 0), 0.25, 0), Infinity, "beyond its end");
  assert.equal(line_hit(eye, way, at(0, 0, 0), at(0, 0, 2), 0.25, 0), 8.75, "along the ray");
  assert.equal(disc_hit(eye, way, at(0.4, 0, 0), at(0, 0, 1), 0.5), 10);
  assert.equal(disc_hit(eye, way, at(0.6, 0, 0), at(0, 0, 1), 0.5), Infinity);
  assert.equal(disc_hit(eye, way, at(0, 0, 0), at(1, 0, 0), 0.5), Infinity, "from its side");
});

test("Pick.NumbersAreThoseOfTheFrame", () => {
  const made = breaking(), run = run_of(made), [sequence] = run.sequences, of = (frame, picked) => {
    const [title, numbers] = numbers_of(run, sequence, frame, picked);
    return { title, ...Object.fromEntries(numbers) };
  };
  const bond = made.lost[0], whole = of(9, { kind: "bond", number: bond }), particle = of(39, { kind: "particle", number: 47 });
  assert.equal(whole.title, `Bond ${bond}, of particles ${made.bonds[bond].join(" and ")}`);
  assert.equal(whole["axial force, tension is positive"].split(" ")[1], "N");
  assert.ok(Math.abs(parseFloat(whole["axial force, tension is positive"]) - (200 * (bond + 1) * 9) / (80 * 40)) < 0.5);
  assert.equal(whole["Range of the bond"], "small");
  assert.deepEqual(of(10, { kind: "bond", number: bond }), { title: whole.title, State: `broken by ${causes[1 + (bond % 4)]}` });
  assert.equal(particle["Place x, y, z"], "11.5, 2.5, 0 m");
  assert.equal(particle.Fragment, "1");
});

test("History.BreaksArePlottedWhereThereAreSome", () => {
  const columns = (broken) => ({ columns: [{ name: "time" }, { name: "released" }, { name: "broken" }], values: [[0, 1], [0, 2], broken] });
  assert.deepEqual(new History(columns([0, 3])).presets([]).map(({ y }) => y), [["broken"], ["released"], ["released"]]);
  assert.deepEqual(new History(columns([0, 0])).presets([]).map(({ title }) => title), ["Energies"]);
});

test("History.LossesArePlottedByCauseWhereThereIsMoreThanOne", () => {
  const columns = (drag) => ({ columns: [{ name: "time" }, { name: "dissipated.friction" }, { name: "dissipated.drag" }, { name: "dissipated.creep" }], values: [[0, 1], [0, 2], drag, [0, 0]] });
  assert.deepEqual(new History(columns([0, 3])).presets([]).map(({ y }) => y), [["dissipated.friction", "dissipated.drag"]]);
  assert.deepEqual(new History(columns([0, 0])).presets([]), []);
});

test("Axis.LogarithmsSkipZerosAndSigns", () => {
  assert.deepEqual(log_axis([[-100, 0, null, 0.1]]).values, [[2, null, null, -1]]);
  assert.deepEqual(log_axis([[null, 0]]).ends, [0, 1]);
});

test("Axis.ALogarithmicAxisIsCutTwelveDecadesBelowTheLargestValue", () => {
  const axis = log_axis([[1e-22, 1e-22], [5, 1e3]]);
  assert.deepEqual(axis.ends, [-9, 3]);
  assert.equal(axis.cut, "Sizes below 1e−9 are not shown.");
  assert.equal(log_axis([[1e-22, 3e-20]]).cut, "");
  assert.deepEqual(axis.words(log_ticks(-9, 3)), ["1e−9", "1e−7", "1e−5", "0.001", "0.1", "10", "1000"]);
});

test("Axis.TicksAreFewOverAnyRange", () => {
  for (const [low, high] of [[1e-22, 1e3], [1e-22, 2e-22], [0.81, 0.93], [1, 1], [3, 800], [4.9e-324, 1e-310], [1e300, 1e308], [1e-20, 1e-20]]) {
    const axis = log_axis([[low, high]]), ticks = axis.splits(null, 1, ...axis.ends);
    assert.ok(ticks.length >= 2 && ticks.length <= 7, `${low} to ${high}: ${axis.words(ticks)}`);
    assert.ok(ticks.every((v) => v > axis.ends[0] - 1e-6 && v < axis.ends[1] + 1e-6));
    assert.ok(axis.values[0][1] <= axis.ends[1] + 1e-6 && axis.ends[1] - axis.ends[0] < 14);
  }
  assert.deepEqual(log_axis([[1]]).words(log_ticks(0, 1)), ["1", "2", "5", "10"]);
});

test("Axis.LinearAxesAreDrawnAboutOneInTheWordsOfTheValues", () => {
  const axis = linear_axis([[0, 2e-20, null, 4e-20]]);
  assert.ok(axis.ends[0] === 0 && Math.abs(axis.ends[1] - 4.16) < 1e-9);
  assert.deepEqual(axis.words([0, 2]), ["0", "2e−20"]);
  for (const column of [[4.9e-324, 1e-320], [-1e308, 1e308], [0, 0], [null, null]]) {
    const { values, ends } = linear_axis([column]);
    assert.ok([...ends, ...values[0].filter((v) => v != null)].every(Number.isFinite), String(column));
    assert.ok(ends[1] > ends[0]);
  }
  assert.equal(linear_axis([[2, 3]], true).ends[0], 0);
});

test("Player.MovesStayWithinTheFrames", () => {
  const player = new Player(() => {});
  player.open({ frames: new Array(5), json: { loop: false } });
  assert.equal(player.frame, 4);
  player.move(1);
  assert.equal(player.frame, 4);
  player.move(-Infinity);
  assert.equal(player.frame, 0);
});

/** Time that a test moves on by hand: what asks for a picture gets it at the next tick. */
function with_clock(body) {
  const asked = new Map(), kept = [globalThis.requestAnimationFrame, globalThis.cancelAnimationFrame, performance.now];
  let number = 0, now = 0;
  globalThis.requestAnimationFrame = (callback) => { asked.set(++number, callback); return number; };
  globalThis.cancelAnimationFrame = (k) => asked.delete(k);
  performance.now = () => now;
  const tick = (ms) => { now += ms; const due = [...asked.values()]; asked.clear(); due.forEach((callback) => callback(now)); };
  try { body(asked, tick); } finally { [globalThis.requestAnimationFrame, globalThis.cancelAnimationFrame, performance.now] = kept; }
}

test("Player.PauseAndPlayLeaveOneLoop", () => with_clock((asked, tick) => {
  const player = new Player(() => {});
  player.open({ frames: new Array(100), json: { loop: true } });
  for (let k = 0; k < 7; ++k) { player.toggle(); tick(1); player.toggle(); player.toggle(); }   // paused and played within a picture, too
  assert.equal(player.playing, true);
  for (let k = 0; k < 5; ++k) { tick(20); assert.equal(asked.size, 1, "one tick a picture"); }
  player.pause();
  assert.equal(asked.size, 0, "and none when paused");
}));

test("Player.PlaysToTheEndAndStops", () => with_clock((asked, tick) => {
  const shown = [], player = new Player(({ frame }) => shown.push(frame));
  player.open({ frames: new Array(5), json: { loop: false } });
  player.play();
  for (let k = 0; k < 10; ++k) tick(50);   // 20 frames a second
  assert.deepEqual([...new Set(shown)].slice(-5), [4, 0, 1, 2, 3]);
  assert.deepEqual([shown.at(-1), player.playing, asked.size], [4, false, 0]);
}));

test("Head.ARunAlwaysHasAName", () => {
  assert.equal(name_of({ title: "A rod" }), "A rod");
  for (const title of ["", "  ", undefined]) assert.equal(name_of({ title }), "Run without a title");
});

test("Text.NumbersAreShortAndKeepTheirSize", () => {
  assert.equal(number(3.0780001e-4), "3.078e−4");
  assert.equal(number(-0.5), "−0.5");
  assert.equal(number(123456), "1.235e5");
  assert.equal(number(null), "–");
  assert.equal(with_unit(12, "°"), "12°");
  assert.equal(file_name("../a <b>", "csv"), "a_b.csv");
});

test("Walls.TurnAndMoveEachByItsOwnMotion", () => {
  const floats = [1, 2, 3, 4, 5, 6,                                // two corners of two walls
                  1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0,     // as they were
                  1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -7, 0, -1, 0, 1, 0, 0, 0, 0, 1, 10, 0, 0];  // down; a quarter about z, and along x
  const block = new Uint8Array([...new Uint8Array(Float32Array.from(floats).buffer), ...new Uint8Array(Uint32Array.of(0, 1, 1, 0, 1).buffer)]);
  const walls = new Walls({ corners: { offset: 0, type: "f32", count: 6 }, motion: { offset: 24, type: "f32", count: 48 },
                            triangles: { offset: 216, type: "u32", count: 3 }, wall: { offset: 228, type: "u32", count: 2 } }, block, 2);
  assert.deepEqual([...walls.positions(0, new Float32Array(6))], [1, 2, 3, 4, 5, 6]);
  assert.deepEqual([...walls.positions(1, new Float32Array(6))], [1, 2, -4, 5, 4, 6]);
});

test("Sweep.CurvesAreOfOneKeyAndSortedByIt", () => {
  const keys = [{ name: "bonds[0].E" }, { name: "stage[0].duration" }];
  const points = [["1e9", "4 T0"], ["1e9", "2 T0"], ["2e9", "4 T0"], ["2e9", "2 T0"]].map((values) => ({ values }));
  assert.deepEqual(axes_of(keys, points), [0, 1]);
  const { x, names, history } = curves_of({ keys, points }, 1, [10, 20, 30, null]);
  assert.equal(x, "stage[0].duration");
  assert.deepEqual(names, ["E 1e9", "E 2e9"]);
  assert.deepEqual(history.column(x).values, [2, 4]);
  assert.deepEqual(history.column("E 1e9").values, [20, 10]);
  assert.deepEqual(history.column("E 2e9").values, [null, 30]);
});

test("Sweep.KeysThatGoTogetherMakeOneCurve", () => {
  const keys = [{ name: "law" }, { name: "a.E" }, { name: "a.nu", with: "a.E" }];
  const points = [["x", "1e9", "0.1"], ["x", "2e9", "0.2"], ["y", "1e9", "0.1"], ["y", "2e9", "0.2"]].map((values) => ({ values }));
  assert.deepEqual(axes_of(keys, points), [1, 2]);
  for (const [x, places] of [[1, [1e9, 2e9]], [2, [0.1, 0.2]]]) {
    const curves = curves_of({ keys, points }, x, [1, 2, 3, 4]);
    assert.deepEqual(curves.names, ["law x", "law y"]);
    assert.deepEqual(curves.history.column(curves.x).values, places);
    assert.deepEqual(curves.history.column("law y").values, [3, 4]);
  }
});

test("Sweep.WordsAreNoAxisAndConstantsAreNotShown", () => {
  const points = [["v-model", "1"], ["evm", "1"]].map((values) => ({ values }));
  assert.deepEqual(axes_of([{ name: "law" }, { name: "seed" }], points), []);
  const { history } = curves_of({ keys: [{ name: "law" }, { name: "seed" }], points }, null, [3, 4]);
  assert.deepEqual(history.column("all points").values, [3, 4]);
  const results = { names: ["T0", "total", "critical_force", "none"], values: [[1, 1], [2, 3], [5, 6], [null, null]] };
  assert.deepEqual(results_worth_showing(results), ["critical_force", "total"]);
  const names = ["b.factors.largest", "b.points", "b.critical_load_factors.0", "b.smallest_eigenvalue", "b.critical_forces.0"];
  assert.deepEqual(results_worth_showing({ names, values: names.map(() => [1, 2]) }),
                   ["b.critical_forces.0", "b.critical_load_factors.0", "b.smallest_eigenvalue", "b.factors.largest", "b.points"]);
});

test("Viewpoint.FlatBodiesAreSeenAcrossTheirPlane", () => {
  const seen_from = (x, y, z) => first_view({ half: { x, y, z } }, 0.1).direction.toArray().map((c) => c + 0);   // no -0
  assert.deepEqual(seen_from(10, 10, 0.5), [0, 0, 1], "a mat of fibres that cross");
  assert.deepEqual(seen_from(10, 0.5, 8), [0, -1, 0]);
  assert.deepEqual(seen_from(0.1, 5, 5), [1, 0, 0]);
  assert.deepEqual(seen_from(10, 10, 4), [0.55, -1, 0.5], "a block from a corner");
});

test("History.BalancesAreDrawnOverWhatTheRunSays", () => {
  const columns = { columns: [{ name: "step" }, { name: "load_factor" }, { name: "U_L" }], values: [[0, 1], [0, 1], [0, 2]] };
  assert.equal(new History(columns, "step", "load_factor").presets([])[0].x, "load_factor");
  assert.equal(new History(columns, "step").presets([])[0].x, "step");
  assert.equal(new History(columns, "step", "gone").over, "step");
});

/** A tilted cell in two frames, in the second one sheared and longer along z. */
function sheared_cell(periodic = [true, true, true]) {
  const floats = [4, 0, 0, 1, 4, 0, 0, 0, 4, -1, 0, 0.5,
                  4, 0, 0, 3, 4, 0, 0, 0, 6, -1, 0, 0.75];
  return new Cell({ edges: { offset: 0, type: "f32", count: 24 }, periodic }, new Uint8Array(Float32Array.from(floats).buffer));
}

test("Cell.DeformsInProportionToTheFactor", () => {
  assert.deepEqual(sheared_cell().at(1, 1), { edges: [[4, 0, 0], [3, 4, 0], [0, 0, 6]], corner: [-1, 0, 0.75] });
  assert.deepEqual(sheared_cell().at(1, 2), { edges: [[4, 0, 0], [5, 4, 0], [0, 0, 8]], corner: [-1, 0, 1] });
});

test("Cell.HasTwelveLinesOrFourOfASheet", () => {
  const whole = sheared_cell(), lines = whole.lines(whole.at(1, 1));
  assert.equal(lines.length, 12 * 6);
  for (let k = 0; k < lines.length; k += 6) {
    const along = [0, 1, 2].map((c) => lines[k + 3 + c] - lines[k + c]);
    assert.ok(whole.at(1, 1).edges.some((edge) => edge.join() === along.join()), along.join());
  }
  const sheet = sheared_cell([true, true, false]);
  assert.equal(sheet.lines(sheet.at(0, 1)).length, 4 * 6);
});

test("Cell.BringsParticlesIntoIt", () => {
  const cell = sheared_cell(), now = cell.at(1, 1), places = Float32Array.of(2, 9, 7, 0, -10, -0.5, 1, 0);
  const images = cell.images(now, places, 2, 4);
  assert.deepEqual([...images], [1, -2, -1, 3, 1, 0]);
  cell.bring(now, images, places, 4);
  assert.deepEqual([...places], [0, 1, 1, 0, 5, 3.5, 1, 0]);
  assert.deepEqual([...sheared_cell([false, true, true]).images(now, Float32Array.of(100, 9, 7), 1, 3)], [0, -2, -1]);
});

/** A particle bonded to its own next image along x, which leaves the cell. */
function periodic_run() {
  const block = new Block(), floats = (values) => block.plain("f32", values);
  const reference = floats([1, 1, 1]);
  const displacement = { ...block.integers("u16", [0, 0, 0, 9, 0, 0], 3), low: [0, 0, 0], step: [1, 1, 1] };
  const sequence = { kind: "run", name: "Run", frames: [{ step: 0, time: 0, bonds: 1 }, { step: 1, time: 1, bonds: 1 }], origin: [0, 0, 0],
                     reference, displacement, particle_fields: [], bond_fields: [],
                     cell: { edges: floats([4, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 5, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0]), periodic: [true, true, true] } };
  const json = { format: 1, radius: 0.5, bonds: block.plain("u32", [0, 0]), bond_image: floats([1, 0, 0]), sequences: [sequence] };
  return new Run(json, new Uint8Array(gunzipSync(Buffer.from(block.base64(), "base64"))));
}

test("Cell.BondsGoToImagesThatMoveWithIt", () => {
  const run = periodic_run(), [sequence] = run.sequences;
  assert.deepEqual(sequence.to_image(0, sequence.cell.at(0, 1)), [4, 0, 0]);
  assert.deepEqual(sequence.to_image(0, sequence.cell.at(1, 1)), [5, 0, 0]);
  assert.equal(sequence.broken.half_length({ bond: 0, frame: 2 }), 2.5);
});

test("Viewpoint.TheCellIsInThePicture", () => {
  const run = periodic_run(), [sequence] = run.sequences;
  const { centre, half } = bounds(run, sequence, 1);
  assert.deepEqual([centre.x - half.x, centre.x + half.x, centre.y - half.y, centre.y + half.y], [0, 10.5, 0, 4]);
  const wrapped = bounds(run, sequence, 1, true);
  assert.deepEqual([wrapped.centre.x - wrapped.half.x, wrapped.centre.x + wrapped.half.x], [-0.5, 5]);
});

/** A fit of two columns, of which one belongs to two stages. */
function a_fit() {
  const point = (curve, stage, x, measured, fitted) => ({ curve, stage, x, measured, fitted, start: 2 * fitted, sigma: null });
  return { columns: ["u", "F"], units: ["m", "N"], x: "load_factor", x_unit: "", stages: ["pull", "bend"], residual_deviation: 0.5,
           points: [point(0, 1, 0.5, 3, 4), point(0, 1, 0.2, 1, 1.5), point(0, 0, 0.3, 2, 2), point(1, null, 1, 7, 6)],
           iterations: [{ number: 0, sum_of_squares: 4, accepted: true, values: [2, 0] }, { number: 1, sum_of_squares: 9, accepted: false, values: [2, 0] },
                        { number: 2, sum_of_squares: 1, accepted: true, values: [3, 0.5] }],
           values: [{ key: "a", start: 2 }, { key: "b", start: 0 }] };
}

test("Fit.PointsOfAColumnAndStageStandInTheOrderOfX", () => {
  const curves = fit_curves(a_fit());
  assert.deepEqual(curves.map(({ name }) => name), ["u in stage bend", "u in stage pull", "F"]);
  const { history, by } = curves[0];
  assert.equal(by, "deviation");
  assert.deepEqual(history.column("load_factor").values, [0.2, 0.5]);
  assert.deepEqual(history.column("measured").values, [1, 3]);
  assert.deepEqual(history.column("start").values, [3, 8]);
  assert.deepEqual(history.column("residual / deviation").values, [1, 2]);
  assert.equal(history.column("fitted").unit, "m");
});

test("Fit.ResidualsAreOverTheGivenStandardDeviations", () => {
  const fit = a_fit();
  fit.points.forEach((point) => { point.sigma = 0.25; });
  const [{ history, by }] = fit_curves(fit);
  assert.equal(by, "sigma");
  assert.deepEqual(history.column("residual / sigma").values, [2, 4]);
});

test("Fit.TheSearchGoesOverItsIterations", () => {
  const search = search_of(a_fit());
  assert.deepEqual(search.names, ["iteration", "sum of squares", "a / start", "b"]);
  assert.deepEqual(search.column("sum of squares").values, [4, null, 1]);   // a step that was no better is a gap
  assert.deepEqual(search.column("a / start").values, [1, 1, 1.5]);
  assert.deepEqual(search.column("b").values, [0, 0, 0.5]);
});

test("Fit.SaysWhyAValueHasNoInterval", () => {
  const fit = { no_effect: ["c"], not_told_apart: [["a", "b"]], degrees_of_freedom: 3 };
  const why = (value) => without_interval({ at_bound: null, held_by_failed_runs: false, ...value }, fit);
  assert.equal(why({ key: "a", at_bound: "upper" }), "at its upper bound: held there");
  assert.equal(why({ key: "a", held_by_failed_runs: true }), "held by runs that fail");
  assert.equal(why({ key: "c" }), "no effect on the points");
  assert.equal(why({ key: "b" }), "not told apart from others");
  assert.equal(without_interval({ key: "d" }, { ...fit, degrees_of_freedom: 0 }), "as many values as points");
});

test("Fit.SaysHowDerivativesWereFound", () => {
  const words = (derivative, times, by_differences, more) => derivative_words({ derivative, derivatives: { times, by_differences }, ...more });
  assert.equal(words("tangent", 4, 0, { off_from_differences: 1e-6 }), `tangent of the balance; ${number(1e-6, 2)} off from differences at the start`);
  assert.equal(words("tangent", 4, 0, {}), "tangent of the balance; no effect at the start");
  assert.equal(words("differences", 4, 4, { why_differences: "why" }), "differences: why");
  assert.equal(words("differences", 4, 3, { why_differences: "why" }), "differences 3 of 4 times: why");
  assert.match(words("tangent", 4, 1, { off_from_differences: 1e-6, why_differences: "why" }), /; differences 1 of 4 times: why$/);
});

test("Fit.WarnsOfWhatTheValuesAreNot", () => {
  const fit = { end: "held", why: "it fails", no_effect: ["c"], not_told_apart: [["a", "b"]], values: [{ key: "d", at_bound: "lower" }],
                interpolation_off: 0.3, sigma_known: true, left_out_lines: [4, 4, 5], failures: ["no balance"] };
  const said = messages_of(fit).map(({ text }) => text).join("\n");
  for (const words of ["has not converged: it fails", "do not tell apart a, b", "c has no effect", "d is at its lower bound", "0.3 of sigma", "lines 4, 5.", "no balance"])
    assert.ok(said.includes(words), words);
  assert.deepEqual(messages_of({ ...fit, end: "converged", no_effect: [], not_told_apart: [], values: [], interpolation_off: 0, left_out_lines: [], failures: [] }), []);
});

test("Polar.CirclesHaveRoundValuesFromZeroToTheRim", () => {
  assert.deepEqual(rings_of([[3, 7], [null, 5]]), { centre: 0, rim: 8, apart: 2 });
  assert.deepEqual(rings_of([[1.3e-11]]), { centre: 0, rim: 1.5e-11, apart: 5e-12 });
  assert.deepEqual(rings_of([[8]]), { centre: 0, rim: 8, apart: 2 });
  assert.deepEqual(rings_of([]), { centre: 0, rim: 1, apart: 0.2 });
});

test("Polar.BelowZeroTheCentreIsTheFirstRoundValueBelow", () => {
  const { centre, rim, apart } = rings_of([[-0.3, 0.9]]);
  assert.deepEqual([centre, rim, apart], [-0.5, 1, 0.5]);
  assert.deepEqual(rings_of([[-3, -1]]), { centre: -3, rim: 1, apart: 1 });
});

test("Polar.RoundingIsNotDrawnAsAShape", () => {
  const { centre, rim } = rings_of([[1e-17, 2e-17, -1e-17]], 0.01);
  assert.ok(rim >= 0.01 && centre > -0.01, `${[centre, rim]}`);
});

test("Polar.DirectionsAreSaidByTheirAxes", () => {
  assert.deepEqual([0, 90, 180, 270].map((degrees) => direction_words(degrees, ["z", "x"])), ["Along z", "Along x", "Along −z", "Along −x"]);
  assert.equal(direction_words(34, ["x", "y"]), "34° from x to y");
});

/** A body with two C, in SI units. */
function a_material() {
  const of = (E) => ({ C: [], hill: { E, G: E / 2, nu: 0 } });
  const plane = { plane: "xy", degrees: [0, 180], E: [3, 4], G_least: [1, 1], G_largest: [2, 3], nu_least: [-1, 0], nu_largest: [0.5, 1] };
  return { units: "SI", found: { by_displacement: of(4), by_traction: of(3) }, materials: [{ key: "by_displacement", planes: [plane] }, { key: "by_traction", planes: [plane] }] };
}

test("Material.ConstantsStandWhereTheMaterialSays", () => {
  const page = a_material();
  assert.equal(constants_of(page, page.materials[1]).hill.E, 3);
  assert.equal(constants_of({ found: { C: 7 } }, { key: "" }).C, 7);
});

test("Material.APlaneHasItsCurvesAndTheCircleOfHill", () => {
  const page = a_material(), [plane] = page.materials[0].planes;
  const { circle, names, history } = around({ key: "G", curves: { G_least: "least G", G_largest: "largest G" } }, plane, { G: 1.5 }, "Pa");
  assert.deepEqual([circle, ...names], ["Hill's G", "least G", "largest G", "Hill's G"]);
  assert.deepEqual(names.map((name) => history.column(name).values), [[1, 1], [2, 3], [1.5, 1.5]]);
  assert.deepEqual(history.column("direction"), { name: "direction", unit: "°", values: [0, 180] });
  assert.equal(history.column("largest G").unit, "Pa");
});

test("Material.ReducedUnitsHaveNoNames", () => {
  assert.ok(Object.values(units_of({ units: "reduced" })).every((unit) => unit === ""));
  assert.deepEqual([units_of({ units: "SI" }).modulus, units_of({ units: "SI" }).D], ["Pa", "N m"]);
});
