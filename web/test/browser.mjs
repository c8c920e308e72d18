// The page in a real browser, opened from file:// as a reader would:
//   node test/browser.mjs [--measure] PAGE...
// Without pages it makes them up from TEMPLATE (VBOND_PAGE, else build/page/report.html). Ends with 77
// (skipped) where there is no chromium or no puppeteer-core.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { choose, launch, patience } from "./chromium.mjs";
import { page as filled, rod, snapped, wide } from "./sample.mjs";

const here = dirname(fileURLToPath(import.meta.url));

/** Opens a page and waits for its first picture; whatever it complains of or fetches is in `complaints`. */
async function open(browser, file, { width = 1300, reduced = "reduce", ready = "drawn", hash = "", touch = false } = {}) {
  const page = await browser.newPage();
  page.setDefaultTimeout(patience);
  const complaints = [];
  const address = pathToFileURL(file).href + hash;
  page.on("console", (message) => complaints.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(`error: ${error.message}`));
  page.on("request", (request) => {
    if (request.url() !== pathToFileURL(file).href && !/^(data|blob):/.test(request.url())) complaints.push(`request: ${request.url()}`);
  });
  await page.emulateMediaFeatures([{ name: "prefers-reduced-motion", value: reduced }]);
  await page.setViewport({ width, height: 900, hasTouch: touch });
  const start = performance.now();
  await page.goto(address);
  await page.waitForSelector("[data-ready]");
  assert.equal(await page.evaluate(() => document.documentElement.dataset.ready), ready);
  return { page, complaints, first_picture: performance.now() - start };
}

const two_pictures = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** The next picture on the screen, after what was asked for has been drawn. */
async function picture(page) {
  await two_pictures(page);
  return (await page.$(".stage")).screenshot({ encoding: "base64" });
}

/** Waits until `found()`, which may take a busy browser a while, holds; whether it did. */
async function soon(found) {
  for (const end = performance.now() + patience; performance.now() < end;) if (await found()) return true;
  return false;
}

/** The picture when two in a row are the same. */
async function steady_picture(page) {
  let last = await picture(page);
  assert.ok(await soon(async () => { const before = last; last = await picture(page); return last === before; }), "the picture comes to rest");
  return last;
}

/** How many different colours the middle of a picture has; counted in `page`, which does not show it. */
function colours(page, png) {
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const pen = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height }).getContext("2d");
    pen.drawImage(image, 0, 0);
    const { data: rgba } = pen.getImageData(0, image.height * 0.15, image.width, image.height * 0.65);   // neither caption nor legend
    const seen = new Set();
    for (let k = 0; k < rgba.length; k += 4) if (Math.max(...rgba.slice(k, k + 3)) - Math.min(...rgba.slice(k, k + 3)) > 40) seen.add(rgba.slice(k, k + 3).join());
    return seen.size;
  }, png);
}

const fits = (page) => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);

/** What must hold for the page of any run with frames and a history. */
async function shows_the_run(browser, file) {
  const { page, complaints, first_picture } = await open(browser, file);
  const last = await steady_picture(page);
  // Shading gives a painted body very many colours; the ground is grey and counts for nothing.
  assert.ok((await colours(page, last)) > 50, "the body is in the picture, in colour");

  await page.$eval(".scrub", (scrub) => { scrub.value = 0; scrub.dispatchEvent(new Event("input")); });
  assert.ok(await soon(async () => await picture(page) !== last), "another frame is another picture");
  await page.$eval(".stage canvas", (canvas) => canvas.focus());
  await page.keyboard.press("End");
  assert.equal(await page.$eval(".scrub", (scrub) => scrub.value === scrub.max), true, "End goes to the last frame");

  const before = await steady_picture(page);
  await page.select("#quantity", "elongation");
  assert.ok(await soon(async () => await picture(page) !== before), "another quantity is another picture");

  const chip = (await page.$$(".chips button")).at(-1);
  await chip.evaluate((button) => button.click());
  assert.ok(await page.$eval(".plot:last-of-type canvas", (canvas) => canvas.width > 0), "a plot of free choice appears");
  await chip.evaluate((button) => button.click());
  assert.equal(await page.$eval(".plot:last-of-type", (plot) => plot.hidden), true, "and goes again");

  const may_choose = await page.$$eval("option", (options) => options.some((option) => option.textContent === "Run"));
  if (may_choose) await choose(page, "Show", "Run");   // a mode has no place in the plots
  await click_first_plot(page);
  assert.notEqual(await page.$eval(".scrub", (scrub) => scrub.value), await page.$eval(".scrub", (scrub) => scrub.max), "a click in a plot goes to its frame");

  await page.setViewport({ width: 400, height: 800 });
  await picture(page);
  assert.ok(await fits(page), "400 px are wide enough");
  assert.deepEqual(complaints, []);
  await page.close();
  return first_picture;
}

/** In the plot of energies, which goes by time: near its left end. */
async function click_first_plot(page) {
  const over = await page.evaluateHandle(() => [...document.querySelectorAll(".plot")].find((plot) => plot.querySelector("h3").textContent === "Energies").querySelector(".u-over"));
  await over.evaluate((element) => element.scrollIntoView({ block: "center" }));
  await over.click({ offset: { x: 20, y: 60 } });
}

/** Every button that saves: names of the files and that they are not empty. */
async function saves_files(browser, file) {
  const { page, complaints } = await open(browser, file);
  const saved = await page.evaluate(async () => {
    const files = [];
    HTMLAnchorElement.prototype.click = function () {
      files.push(fetch(this.href).then((reply) => reply.blob()).then((blob) => ({ name: this.download, type: blob.type, size: blob.size })));
    };
    const buttons = [...document.querySelectorAll(".settings button, .plot:not([hidden]) button")].filter((b) => ["PNG", "CSV"].includes(b.textContent));
    buttons.forEach((button) => button.click());
    while (files.length < buttons.length) await new Promise(requestAnimationFrame);
    return Promise.all(files);
  });
  assert.deepEqual(saved.map(({ name }) => name).sort(), ["a_rod_that_bends_run_59.png", "energies.csv", "energies.png", "error_of_the_energy_balance.csv",
    "error_of_the_energy_balance.png", "force_against_shortening.csv", "force_against_shortening.png"]);
  assert.ok(saved.every(({ type, size }) => size > 1000 && (type === "image/png" || type === "text/csv")));
  assert.deepEqual(complaints, []);
  await page.close();
}

async function text_stays_text(browser, file) {
  const { page, complaints } = await open(browser, file);
  assert.ok((await page.title()).startsWith("Rod <script>"));
  assert.ok((await page.$eval("h1", (h1) => h1.textContent)).includes("<script>document.title='run'</script>"));
  assert.equal(await page.$$eval("main img, main script", (found) => found.length), 0);
  assert.ok((await page.$eval('[role="alert"]', (alert) => alert.textContent)).includes("bonds have snapped"), "an error is an alert");
  assert.ok(await page.evaluate(() => document.querySelector("main").firstElementChild.contains(document.querySelector("[role=alert]"))), "on top");
  assert.deepEqual(complaints, []);
  await page.close();
}

async function modes_swing(browser, file) {
  const { page, complaints } = await open(browser, file, { reduced: "no-preference" });
  await page.select(".settings select", "1");
  await page.waitForFunction(() => Number(document.querySelector(".scrub").value) > 3);
  await page.$eval(".play", (button) => button.click());
  const frame = () => page.$eval(".scrub", (scrub) => scrub.value);
  const stopped = await frame();
  await picture(page);
  assert.equal(await frame(), stopped, "paused is paused");
  assert.deepEqual(complaints, []);
  await page.close();
}

/** Every plot on logarithmic axes, and then with each of its curves hidden in turn until none is left. */
async function plots_take_any_choice(browser, file) {
  const { page, complaints } = await open(browser, file);
  await page.$$eval('.chips button[aria-pressed="false"]', (chips) => chips.forEach((chip) => chip.click()));
  for (const plot of await page.$$(".plot")) {
    const click = async (selector, k) => {
      await plot.$$eval(selector, (found, k) => found[k].click(), k);
      await two_pictures(page);
    };
    for (const k of [0, 1, 0, 1]) await click(".buttons button", k);
    const curves = (await plot.$$(".key")).length;
    await plot.$$eval(".buttons button", ([log_x]) => { log_x.click(); log_x.click(); });   // before the first is drawn
    await two_pictures(page);
    assert.equal((await plot.$$(".dot")).length, curves, "one dot for each curve");
    for (const pressed of ["false", "true"]) {
      for (let k = 0; k < curves; ++k) {
        await click(".key", k);
        const shown = await plot.$$eval('.key[aria-pressed="true"]', (keys) => keys.length);
        assert.equal(shown, pressed === "true" ? k + 1 : curves - k - 1);
        assert.equal((await plot.$$(".dot")).length, shown, "one dot for each curve");
        assert.equal((await plot.$$("canvas")).length, 1);
      }
    }
  }
  assert.deepEqual(complaints, []);
  await page.close();
}

/** Presses a key on the element, or on none; whether the frame changed. */
async function changes_frame(page, selector, key) {
  const frame = () => page.$eval(".scrub", (scrub) => scrub.value);
  await page.evaluate((selector) => { document.activeElement.blur(); if (selector) document.querySelector(selector).focus(); }, selector);
  const before = await frame();
  await page.keyboard.press(key);
  await two_pictures(page);
  return await frame() !== before;
}

async function keys_belong_to_the_focus(browser, file) {
  const { page } = await open(browser, file);
  await page.$eval("details", (details) => { details.open = true; });
  for (const [selector, key, wanted] of [["details pre", "Home", false], ["details pre", "ArrowLeft", false], [null, "Home", false], [".chips button", "ArrowLeft", false],
                                         [null, "ArrowLeft", true], [".stage canvas", "ArrowLeft", true], [".stage canvas", "Home", true]]) {
    assert.equal(await changes_frame(page, selector, key), wanted, `${key} with focus on ${selector}`);
  }
  await page.close();
}

async function a_finger_scrolls_until_the_body_is_tapped(browser, file) {
  const { page } = await open(browser, file, { width: 400, touch: true });
  const box = await page.$eval(".stage", (stage) => { stage.scrollIntoView(); const { x, y } = stage.getBoundingClientRect(); return { x, y }; });
  const drag = async () => {
    const touch = await page.touchscreen.touchStart(box.x + 200, box.y + 300);
    for (let k = 1; k < 16; ++k) await touch.move(box.x + 200, box.y + 300 - 10 * k);
    await touch.end();
  };
  const scroll = () => page.evaluate(() => scrollY), from = await scroll();
  let before = await steady_picture(page);
  await drag();
  assert.ok(await soon(async () => await scroll() !== from), "a finger scrolls");
  assert.ok(await soon(async () => { const y = await scroll(); await two_pictures(page); return await scroll() === y; }), "and stops");
  await page.evaluate((y) => scrollTo(0, y), from);
  assert.ok(await soon(async () => await picture(page) === before), "and turns nothing");
  await page.touchscreen.tap(box.x + 200, box.y + 200);
  before = await steady_picture(page);
  await drag();
  assert.ok(await soon(async () => await picture(page) !== before), "after a tap it turns the body");
  await two_pictures(page);
  assert.equal(await scroll(), from, "and does not scroll");
  await page.close();
}

/** Without a picture `#still` has the message alone. */
async function still_says_why_there_is_no_picture(browser, file, ready, words) {
  const { page } = await open(browser, file, { hash: "#still", ready });
  assert.ok((await page.$eval("main", (main) => main.innerText)).includes(words), words);
  assert.equal(await page.$eval("#head", (head) => head.offsetHeight), 0);
  await page.close();
}

async function classes_are_words(browser, file) {
  const { page } = await open(browser, file);
  await page.select("#quantity", "range");
  assert.deepEqual(await page.$$eval(".legend li", (items) => items.map((item) => item.textContent)),
    ["small", "strained: moments no longer grow", "snapped: pulls towards a wrong shape"]);
  assert.ok(await page.$eval(".legend", (legend) => legend.scrollWidth <= legend.clientWidth));
  assert.ok(!(await page.$eval("#foot", (foot) => foot.textContent)).includes("12345"), "rows left out are told in left_out alone");
  await page.close();
}

/** Pictures per second while playing, in a window of 1300 x 900. */
async function frame_rate(browser, file) {
  const { page } = await open(browser, file);
  const rate = await page.evaluate(async () => {
    let pictures = 0;
    const watch = new MutationObserver(() => { ++pictures; });
    watch.observe(document.querySelector(".axes"), { childList: true });
    document.querySelector(".play").click();
    const start = performance.now();
    await new Promise((done) => setTimeout(done, 4000));
    return pictures / ((performance.now() - start) / 1000);
  });
  await page.close();
  return rate;
}

const browser = await launch();
const scratch = await mkdtemp(join(tmpdir(), "vbond-page-"));
try {
  const measure = process.argv.includes("--measure");
  const given = process.argv.slice(2).filter((word) => word !== "--measure").map((path) => resolve(path));
  const template = process.env.VBOND_PAGE ?? `${here}/../../build/page/report.html`;
  const made = async (name, { json, base64 }) => {
    const file = join(scratch, `${name}.html`);
    await writeFile(file, filled(await readFile(template, "utf8"), json, base64));
    return file;
  };
  const pages = given.length ? given : [await made("rod", rod())];
  for (const file of pages) {
    console.log(`${file}: first picture after ${Math.round(await shows_the_run(browser, file))} ms`);
    if (measure) console.log(`${file}: ${(await frame_rate(browser, file)).toFixed(1)} pictures/s`);
  }
  if (!given.length) {
    await text_stays_text(browser, await made("snapped", snapped()));
    await modes_swing(browser, pages[0]);
    await saves_files(browser, pages[0]);
    await plots_take_any_choice(browser, pages[0]);
    await plots_take_any_choice(browser, await made("wide", wide()));
    await keys_belong_to_the_focus(browser, pages[0]);
    await a_finger_scrolls_until_the_body_is_tapped(browser, pages[0]);
    await classes_are_words(browser, pages[0]);
    const none = { sequences: [], first_shown: 0 };
    await still_says_why_there_is_no_picture(browser, await made("no_frames", rod(none)), "no-frames", "Give [output] frames");
    await still_says_why_there_is_no_picture(browser, await made("too_large", rod({ ...none, no_frames: "No frame fits." })), "no-frames", "No frame fits.");
    await still_says_why_there_is_no_picture(browser, await made("broken", { ...rod(), base64: "AAAA" }), "failed", "could not be shown");
  }
} finally {
  await browser.close();
  await rm(scratch, { recursive: true });
}
