// live.mjs VBOND ROOT: a run that goes on, in a browser, by the page of `vbond watch`; and the pages of a sweep, of a fit and of a material.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { networkInterfaces, tmpdir } from "node:os";
import { join } from "node:path";
import { choose, launch, patience } from "./chromium.mjs";
import { number } from "../src/text.js";
import { fits as is_wide_enough, is_accessible, open } from "./opened.mjs";

const [vbond, root] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "vbond-live-")), run = join(folder, "run");
const browser = await launch(), children = [];

function start(...words) {
  const child = spawn(vbond, words, { stdio: ["ignore", "pipe", "inherit"] });
  child.text = "";
  child.stdout.on("data", (data) => { child.text += data; });
  children.push(child);
  return child;
}

/** Waits until `found()` holds; whether it did. */
async function soon(found) {
  for (const end = performance.now() + patience; performance.now() < end; await new Promise((done) => setTimeout(done, 50))) if (await found()) return true;
  return false;
}

async function ended(child, signal) {
  child.kill(signal);
  if (child.exitCode === null) await once(child, "exit");
}

try {
  const values = { "stage[0].duration": "1e9 T0", "output.history.every": "2e4 T0", "output.frames.every": "2e4 T0", "output.checkpoint.every": "1e8 T0" };
  const runs = start("run", `${root}/examples/two_particles.toml`, "-o", run, ...Object.entries(values).flatMap(([key, value]) => ["--set", `${key}=${value}`]));
  assert.ok(await soon(() => /output folder/.test(runs.text)), "the run begins");
  let watch;
  assert.ok(await soon(async () => {   // there is nothing to watch at first
    watch = start("watch", run, "--page");
    await Promise.race([once(watch, "exit"), soon(() => /^page at /m.test(watch.text))]);
    return watch.exitCode === null;
  }), "it is watched");
  const address = watch.text.match(/^page at (\S+)/m)[1], { origin, port, pathname } = new URL(address);

  const page = await browser.newPage(), complaints = [], asked = new Set();
  page.setDefaultTimeout(patience);
  page.on("console", (message) => complaints.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(`error: ${error.message}`));
  page.on("request", (request) => { if (!/^(data|blob):/.test(request.url())) asked.add(request.url()); });
  await page.emulateMediaFeatures([{ name: "prefers-reduced-motion", value: "reduce" }]);
  await page.setViewport({ width: 1300, height: 900 });
  await page.goto(address);
  const text = (selector) => page.$eval(selector, (element) => element.textContent).catch(() => "");
  const frames = async () => Number((await text(".count")).split("/")[1] ?? 0);
  const has_ready = (state) => page.evaluate((wanted) => document.documentElement.dataset.ready === wanted, state);
  assert.ok(await soon(() => has_ready("drawn")), "the body is drawn");
  assert.ok(await soon(async () => /^running.*step \d+.*kinetic/.test(await text("#live"))), "it says how the run stands");

  // what is chosen stays, while frames are added
  assert.ok(await soon(async () => (await frames()) > 2), "there are frames to choose from");
  await choose(page, "Colour map", "cividis");
  await choose(page, "Spheres", "tiny");
  await choose(page, "Cut away", "+x");
  let box = null;   // while frames are added the canvas may be laid out anew
  assert.ok(await soon(async () => { box = await (await page.$("canvas"))?.boundingBox(); return box; }), "the canvas has a place");
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 150, box.y + box.height / 2 + 80, { steps: 5 });
  await page.mouse.up();
  await page.$eval(".scrub", (input) => { input.value = 0; input.dispatchEvent(new Event("input")); });   // a frame that stays as it is
  const before = await frames(), axes = () => page.$$eval(".axes line", (lines) => lines.flatMap(({ x2, y2 }) => [x2, y2].map(({ baseVal }) => Math.round(baseVal.value))));
  const looked_from = await axes();
  assert.ok(await soon(async () => (await frames()) > before + 1), "frames are added to the page");
  assert.match(await text(".count"), /^1 \//, "the frame that is looked at stays");
  const chosen = await page.$$eval("select", (selects) => selects.map((select) => select.selectedOptions[0]?.textContent));
  assert.ok(["cividis", "tiny", "+x"].every((choice) => chosen.includes(choice)), `choices stay: ${chosen}`);
  assert.deepEqual(await axes(), looked_from, "the body stays as it was turned");

  // nobody else is asked, nobody else is answered
  assert.deepEqual([...asked].filter((url) => url !== address && url !== `${address}state`), []);
  const status = async (path, options) => (await fetch(origin + path, options)).status;
  assert.equal(await status("/"), 403);
  assert.equal(await status(pathname.replace(/.\/$/, (end) => (end[0] === "0" ? "1/" : "0/"))), 403);
  assert.equal(await status(`${pathname}resolved.toml`), 404);
  assert.equal(await status(`${pathname}../../etc/passwd`), 403);
  assert.equal(await status(pathname, { method: "POST", body: "x".repeat(100_000) }), 405);
  for (const { address: ip, internal, family } of Object.values(networkInterfaces()).flat())
    if (!internal && family === "IPv4") await assert.rejects(fetch(`http://${ip}:${port}${pathname}`), `${ip} answers`);

  await ended(runs, "SIGTERM");
  assert.ok(await soon(async () => /^interrupted/.test(await text("#live"))), "the end of the run is told");
  assert.ok(await soon(() => /stays until Ctrl-C/.test(watch.text)), "the page stays");
  assert.deepEqual(complaints, []);

  // of another run: whoever served it goes
  const again = start("watch", run, "--page");
  assert.ok(await soon(() => /^page at /m.test(again.text)), "a run that has ended is shown, too");
  await page.goto(again.text.match(/^page at (\S+)/m)[1]);
  assert.ok(await soon(async () => (await frames()) > before), "with its frames");
  await ended(again, "SIGINT");
  await ended(watch, "SIGINT");
  assert.equal(watch.exitCode, 1, "as without a page: the run was stopped");

  const sweep = join(folder, "sweep");
  const swept = start("sweep", `${root}/examples/two_particles.toml`, "-o", sweep, "--set", "bonds[0].nu=0.1,0.2,0.9", "--set", "stage[0].duration=2 T0,3 T0,4 T0");
  if (swept.exitCode === null) await once(swept, "exit");
  assert.equal(swept.exitCode, 1, "three points fail");
  const overview = await open(browser, join(sweep, "sweep.html"));
  assert.equal((await overview.page.$$(".plot")).length, 4);
  assert.match(await overview.page.$eval(".message", (element) => element.textContent), /3 of 9 points failed/);
  assert.equal((await overview.page.$$("tbody tr")).length, 9);
  const keys = await overview.page.$$eval(".plot:first-of-type .key", (all) => all.map((key) => key.textContent));
  assert.deepEqual(keys, ["nu 0.1", "nu 0.2"], "curves of points that failed are left out");
  await choose(overview.page, "Over", "bonds[0].nu");
  const others = await overview.page.$$eval(".plot:first-of-type .key", (all) => all.map((key) => key.textContent));
  assert.deepEqual(others, ["duration 2 T0", "duration 3 T0", "duration 4 T0"]);
  assert.deepEqual(overview.complaints, []);

  const example = `${root}/examples/stem_bending`;
  const fits = start("fit", `${example}.toml`, `${example}.csv`, "--vary", "bonds[fibre].k_n", "--vary", "bonds[0].k_s=log", "--x", "load_factor",
    "--compare", "displacement.last.z=deflection [mm]", "--iterations", "12", "--report", "-o", join(folder, "fit.toml"));
  if (fits.exitCode === null) await once(fits, "exit");
  assert.ok([1, 2].includes(fits.exitCode), "12 iterations are too few; without statics there are none");
  if (fits.exitCode === 1) {
    const fitted = await open(browser, join(folder, "fit.html"));
    assert.equal((await fitted.page.$$(".plot")).length, 4);
    assert.match(await fitted.page.$eval(".message", (element) => element.textContent), /has not converged/);
    const cells = await fitted.page.$$eval("#head td", (all) => all.map((cell) => cell.textContent));
    assert.equal(cells.length, 14);
    assert.match(cells[6], /^tangent of the balance/);
    assert.ok(await fitted.page.$$eval("canvas", (all) => all.every((canvas) => canvas.width > 300)), "all plots are drawn");
    assert.deepEqual(fitted.complaints, []);
  }

  const shown = join(folder, "material.html"), material = start("homogenise", `${root}/examples/silica.toml`, "--report", shown);
  if (material.exitCode === null) await once(material, "exit");
  assert.ok([0, 2].includes(material.exitCode), "without statics there are no constants");
  if (material.exitCode === 0) {
    const { page: around, complaints: complained } = await open(browser, shown);
    assert.equal((await around.$$(".plot canvas")).length, 9, "three planes of three quantities");
    assert.equal(await around.$$eval(".material thead", (tables) => tables.length), 4, "C, averages, along the axes, extremes");
    const canvas = await (await around.$(".plot canvas")).boundingBox(), right = [canvas.x + 0.9 * canvas.width, canvas.y + 0.5 * canvas.height];
    await around.mouse.move(...right);
    const { E, hill } = JSON.parse(await around.$eval("#material", (element) => element.textContent)).found;
    const told = await around.$eval(".plot", (plot) => ({ note: plot.querySelector(".note").textContent, values: [...plot.querySelectorAll("output")].map((value) => value.textContent) }));
    assert.deepEqual(told, { note: "Along x", values: [E.x, hill.E].map((value) => number(value)) });
    assert.equal((await around.$$(".plot .dot:not([hidden])")).length, 2, "both are marked");
    const drawn = () => around.$eval(".plot canvas", (element) => element.toDataURL());
    const light = await drawn();
    await around.click(".theme");
    assert.notEqual(await drawn(), light, "it is drawn anew in the other theme");
    await around.setViewport({ width: 390, height: 800 });
    await around.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    assert.ok(await is_wide_enough(around), "390 px are wide enough");
    assert.deepEqual(complained, []);
    await is_accessible(browser, shown);
  }
  console.log(`passed: ${before} and then ${await frames()} frames, ${asked.size} addresses asked`);
} finally {
  for (const child of children) child.kill("SIGKILL");
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
