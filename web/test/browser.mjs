// The page in a real browser, opened from file:// as a reader would:
//   node test/browser.mjs [--measure] PAGE...
// Without pages it makes them up from TEMPLATE (VBOND_PAGE, else build/page/report.html). Ends with 77
// (skipped) where there is no chromium or no puppeteer-core.
import assert from "node:assert/strict";
import { mkdtemp, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { cause_colours, causes } from "../src/palette.js";
import { mark_colours } from "../src/marks.js";
import { choose, launch, tick } from "./chromium.mjs";
import { colours, fits, is_accessible, open, picture, pixels, pixels_of, show_frame, soon, steady_picture, two_pictures } from "./opened.mjs";
import { breaking, held, page as filled, periodic, rod, snapped, touching, wide } from "./sample.mjs";
import { contacts_are_as_wide_as_strong, contacts_come_and_go, has_contacts } from "./touching.mjs";

const here = dirname(fileURLToPath(import.meta.url));

/** From left to right and from top to bottom: where the picture has a colour of the body. */
async function extent_of_the_body(page, png) {
  return (await pixels(page, png)).evaluate(({ rgba, width, height }) => {
    let [left, right] = [width, 0];
    for (let y = Math.floor(0.15 * height); y < 0.8 * height; ++y) {
      for (let x = 0; x < width; ++x) {
        const [r, g, b] = rgba.slice(4 * (y * width + x), 4 * (y * width + x) + 3);
        if (Math.max(r, g, b) - Math.min(r, g, b) > 60) { left = Math.min(left, x); right = Math.max(right, x); }
      }
    }
    return (right - left) / width;
  });
}

/** How many pixels have the blue of the cell's lines, mixed with any part of the ground. */
async function pixels_of_the_cell(page, png) {
  return (await pixels(page, png)).evaluate(({ rgba }) => {
    let count = 0;
    for (let k = 0; k < rgba.length; k += 4) {
      const [r, g, b] = rgba.slice(k, k + 3);
      if (b - r > 20 && b - r < 90 && Math.abs(b + r - 2 * g) < 6) ++count;
    }
    return count;
  });
}

/** Lines of the cell, and particles that have left it: switched to their images they stand in it, and the picture is filled by them. */
async function the_cell_is_drawn_and_particles_come_into_it(browser, file) {
  const { page, complaints } = await open(browser, file);
  const before = await steady_picture(page);
  assert.ok(await pixels_of_the_cell(page, before) > 800, "the cell is in the picture");
  await tick(page, "Particles in the cell");
  assert.ok(await soon(async () => await picture(page) !== before), "images are another picture");
  const wrapped = await steady_picture(page);
  assert.ok(await pixels_of_the_cell(page, wrapped) > 800, "the cell is in the picture of images, too");
  assert.ok(await extent_of_the_body(page, wrapped) > await extent_of_the_body(page, before), "nothing but the cell has to be in the picture, which images fill");
  await tick(page, "Particles in the cell");
  assert.ok(await soon(async () => await picture(page) === before), "and back again");
  assert.deepEqual(complaints, []);
  await page.close();
}

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

const input = (page, selector, value, event = "input") => page.$eval(selector, (field, { value, event }) => {
  field.value = value;
  field.dispatchEvent(new Event(event));
}, { value, event });

/** The reader's own ends of the colours: kept for their quantity, told in the legend, refused if they are turned round. */
async function colours_have_the_range_that_is_wanted(browser, file) {
  const { page, complaints } = await open(browser, file);
  const marks = () => page.$$eval(".legend .marks span", (spans) => spans.map((span) => Number(span.textContent.replace("−", "-"))));
  const fields = '[aria-label="Range of the colours"] input', automatic = await marks(), before = await steady_picture(page);
  await input(page, `${fields}:nth-of-type(1)`, 1, "change");
  await input(page, `${fields}:nth-of-type(2)`, 1.5, "change");
  assert.deepEqual(await marks(), [1, 1.25, 1.5]);
  assert.ok((await page.$eval(".legend", (legend) => legend.textContent)).includes("beyond"));
  assert.ok(await soon(async () => await picture(page) !== before), "other colours");
  await input(page, `${fields}:nth-of-type(2)`, 0.5, "change");
  assert.deepEqual(await marks(), [1, 1.25, 1.5], "no range");
  assert.equal(await page.$eval(`${fields}:nth-of-type(2)`, (field) => field.validity.valid), false);
  await page.select("#quantity", "range");
  assert.equal(await page.$eval(fields, (field) => field.offsetHeight), 0, "classes have none");
  await page.select("#quantity", "displacement");
  assert.deepEqual(await marks(), [1, 1.25, 1.5]);
  await page.select(".settings select", "1");
  assert.deepEqual(await marks(), [0, 0.5, 1], "a mode has its own");
  await page.select(".settings select", "0");
  await page.$eval('[aria-label="Range of the colours"] button', (button) => button.click());
  assert.deepEqual(await marks(), automatic);
  assert.deepEqual(complaints, []);
  await page.close();
}

/** The cut takes away what is beyond, for the eye and for the pointer; the undeformed shape comes and goes. */
async function the_body_is_cut_and_has_a_ghost(browser, file) {
  const { page, complaints } = await open(browser, file);
  await page.select("#quantity", "displacement");
  const count = async () => (await canvas_pixels(page)).green.length, whole = await count(), before = await steady_picture(page);
  await choose(page, "Cut away", "+x");
  const at = (part) => input(page, '[aria-label="Where the body is cut"]', part);
  const left = [];
  for (const part of [0, 0.5, 1]) { await at(part); left.push(await count()); }
  assert.equal(left[0], whole, "at its end nothing is cut away");
  assert.ok(left[1] < 0.9 * whole && left[1] > 0.1 * whole && left[2] < 0.1 * whole, `green pixels: ${whole}, cut ${left}`);
  await choose(page, "Cut away", "nothing");
  assert.equal(await steady_picture(page), before);
  const { x, y, green } = await canvas_pixels(page), place = green[Math.floor(green.length / 3)], click = () => page.mouse.click(x + place.x, y + place.y);
  await choose(page, "Cut away", "+x");   // still all of it
  await click();
  assert.equal(await page.$(".picked"), null, "what is cut away is not picked");
  await choose(page, "Cut away", "nothing");
  await click();
  await page.click(".picked button");
  await page.$eval('.settings input[type="checkbox"]', (box) => box.click());
  assert.ok(await soon(async () => await picture(page) !== before), "a ghost");
  await page.$eval('.settings input[type="checkbox"]', (box) => box.click());
  assert.equal(await steady_picture(page), before, "gone again");
  assert.deepEqual(complaints, []);
  await page.close();
}

/** What holds and loads the body is marked where it is, in the stage that asks for it, and told in the legend. */
async function supports_and_loads_are_marked(browser, file) {
  const { page, complaints } = await open(browser, file);
  const box = await page.evaluateHandle(() => [...document.querySelectorAll(".control")].find((c) => c.textContent === "Supports and loads").querySelector("input"));
  const words = () => page.$$eval(".legend", (legends) => legends.slice(1).map((legend) => [...legend.querySelectorAll("li")].map((li) => li.textContent)));
  await show_frame(page, 0);
  const before = await steady_picture(page);
  await box.evaluate((input) => input.click());
  assert.deepEqual(await words(), [["held in x, y and z", "held in some direction", "forces", "moments, by the right hand"]]);
  const marked = await steady_picture(page);
  for (const kind of Object.keys(mark_colours)) assert.ok(await pixels_of(page, marked, mark_colours[kind]) > 3, `${kind} is drawn`);
  await show_frame(page, 59);
  assert.deepEqual(await words(), [], "the second stage has none");
  await show_frame(page, 0);
  await box.evaluate((input) => input.click());
  assert.equal(await steady_picture(page), before);
  assert.deepEqual(complaints, []);
  await page.close();
}

/** A rectangle drawn in a plot becomes the plot, without going to another frame; a double click and a button bring all back. */
async function plots_zoom(browser, file) {
  const { page, complaints } = await open(browser, file);
  const plot = await page.$(".plot"), over = await plot.$(".u-over");
  await over.scrollIntoView();
  const { x, y } = await over.boundingBox(), drawn = () => plot.screenshot({ encoding: "base64", captureBeyondViewport: false });
  const is_whole = () => plot.$$eval("header button", (buttons) => buttons.find((b) => b.textContent === "whole").hidden);
  const frame = () => page.$eval(".scrub", (scrub) => scrub.value), first = await frame();
  await page.mouse.move(5, 5);
  await two_pictures(page);
  const before = await drawn();
  const drag = async () => {
    await page.mouse.move(x + 60, y + 30);
    await page.mouse.down();
    await page.mouse.move(x + 160, y + 120, { steps: 4 });
    await page.mouse.up();
    await two_pictures(page);
  };
  await drag();
  assert.ok(!await is_whole() && await soon(async () => await drawn() !== before), "a drag zooms");
  await page.setViewport({ width: 900, height: 900 });   // the plots are drawn anew
  assert.ok(await soon(() => over.evaluate((element) => !element.isConnected)), "another width is another plot");
  assert.ok(!await is_whole(), "which stays zoomed");
  await page.setViewport({ width: 1300, height: 900 });
  await two_pictures(page);
  assert.equal(await frame(), first, "a drag picks nothing");
  await page.mouse.click(x + 50, y + 50, { count: 2 });
  assert.ok(await soon(is_whole), "a double click");
  await plot.$$eval("header button", (buttons) => buttons.find((b) => b.textContent === "+").click());
  assert.ok(!await is_whole(), "the button for those without a mouse");
  await plot.$$eval("header button", (buttons) => buttons.find((b) => b.textContent === "whole").click());
  assert.ok(await is_whole());
  await page.$eval(".scrub", (scrub, frame) => { scrub.value = frame; scrub.dispatchEvent(new Event("input")); }, first);
  await page.mouse.move(5, 5);
  assert.ok(await soon(async () => await drawn() === before), "as it was");
  assert.deepEqual(complaints, []);
  await page.close();
}

/** Every button that saves: names of the files and that they are not empty. */
async function saves_files(browser, file) {
  const { page, complaints } = await open(browser, file);
  const saved = await page.evaluate(async () => {
    const files = [], blobs = new Map(), address_of = URL.createObjectURL;
    URL.createObjectURL = (blob) => { const address = address_of.call(URL, blob); blobs.set(address, blob); return address; };
    HTMLAnchorElement.prototype.click = function () {   // the page may not fetch, not even its own blobs
      const { type, size } = blobs.get(this.href);
      files.push({ name: this.download, type, size });
    };
    const buttons = [...document.querySelectorAll(".settings button, .plot:not([hidden]) button")].filter((b) => ["PNG", "CSV"].includes(b.textContent));
    buttons.forEach((button) => button.click());
    while (files.length < buttons.length) await new Promise(requestAnimationFrame);
    return files;
  });
  assert.deepEqual(saved.map(({ name }) => name).sort(), ["a_rod_that_bends_run_59.png", "energies.csv", "energies.png", "error_of_the_energy_balance.csv",
    "error_of_the_energy_balance.png", "force_against_shortening.csv", "force_against_shortening.png"]);
  assert.ok(saved.every(({ type, size }) => size > 1000 && (type === "image/png" || type === "text/csv")));
  assert.deepEqual(complaints, []);
  await page.close();
}

/** The policy of the page lets a file out that the reader asks for. */
async function downloads(browser, file) {
  const { page, complaints } = await open(browser, file);
  const session = await page.createCDPSession(), folder = await mkdtemp(join(scratch, "downloads-"));
  await session.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder });
  await page.$$eval(".plot button", (buttons) => buttons.find((b) => b.textContent === "CSV").click());
  assert.ok(await soon(async () => (await readdir(folder)).join() === "force_against_shortening.csv"), "a file is saved");
  assert.deepEqual(complaints, []);
  await page.close();
}

/** What is not of the page can neither run nor send: a script, a handler, a style in an attribute, a request. */
async function the_policy_allows_the_page_alone(browser, file) {
  const { page } = await open(browser, file);
  const refused = await page.evaluate(async () => {
    const seen = [];
    document.addEventListener("securitypolicyviolation", (event) => seen.push(event.effectiveDirective));
    document.body.append(Object.assign(document.createElement("script"), { textContent: "document.title = 'run'" }));
    const image = document.createElement("img");
    image.setAttribute("onerror", "document.title = 'run'");
    image.setAttribute("style", "color: red");
    image.src = "https://example.invalid/a.png";
    await fetch("https://example.invalid/").catch(() => {});
    for (const end = performance.now() + 10_000; seen.length < 5 && performance.now() < end;) await new Promise((done) => setTimeout(done, 50));
    return seen;
  });
  assert.deepEqual(refused.sort(), ["connect-src", "img-src", "script-src-attr", "script-src-elem", "style-src-attr"]);
  assert.equal(await page.title(), "A rod that bends");
  await page.close();
}

const box_of = (page, selector) => page.$eval(selector, (element) => { const { top, bottom, height } = element.getBoundingClientRect(); return { top, bottom, height }; });

/** Caption and legend stand above and below the picture of the body, whatever the quantity and the width. */
async function no_words_on_the_body(browser, file) {
  const { page, complaints } = await open(browser, file);
  for (const width of [1300, 360]) {
    await page.setViewport({ width, height: 700 });
    for (const quantity of ["displacement", "U_B", "range"]) {
      await page.select("#quantity", quantity);
      await two_pictures(page);
      const [canvas, legend, caption, stage] = await Promise.all([".stage canvas", ".legend", ".caption", ".stage"].map((s) => box_of(page, s)));
      assert.ok(legend.top >= canvas.bottom && legend.bottom <= stage.bottom && caption.bottom <= canvas.top, `${quantity} at ${width} px`);
      assert.ok(canvas.height > 0.6 * stage.height);
    }
    assert.ok(await fits(page));
  }
  assert.deepEqual(complaints, []);
  await page.close();
}

/** Two long warnings leave a small screen to the body; all of their text is a tap away, and errors are whole. */
async function warnings_leave_room(browser, file) {
  const { page } = await open(browser, file, { width: 360 });
  await page.setViewport({ width: 360, height: 640 });
  assert.ok((await box_of(page, "#messages")).height < 640 / 4, "two warnings take less than a quarter");
  const text = await page.$(".message.warning p"), hidden = () => text.evaluate((p) => p.scrollHeight > p.clientHeight);
  assert.ok(await hidden());
  await page.click(".message.warning .more");
  assert.ok(!await hidden(), "More shows all of it");
  await page.setViewport({ width: 1300, height: 640 });
  assert.equal(await page.$eval(".more", (button) => button.offsetHeight), 0, "a wide screen has room");
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

async function untitled_has_a_heading(browser, file) {
  const { page } = await open(browser, file);
  assert.deepEqual([await page.$eval("h1", (h1) => h1.textContent), await page.title()], ["Run without a title", "Run without a title"]);
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
  const asked = await page.evaluate(async () => {
    let times = 0;
    const ask = requestAnimationFrame;
    globalThis.requestAnimationFrame = (callback) => { ++times; return ask(callback); };
    await new Promise((done) => setTimeout(done, 300));
    globalThis.requestAnimationFrame = ask;
    return times;
  });
  assert.equal(asked, 0, "and asks for no pictures");
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

/** A picture of a mode is one of its shape: taken where it swings most, whenever it is taken. */
async function a_still_of_a_mode_stands_still(browser, file) {
  const { page } = await open(browser, file, { hash: "#still", reduced: "no-preference" });
  const frame = () => page.$eval(".scrub", (scrub) => Number(scrub.value));
  for (let k = 0; k < 20; ++k) await two_pictures(page);
  assert.equal(await frame(), 10, "a quarter of 40 frames");
  await page.close();
}

/** `#still=K` is frame K, and the last one where there are not so many. */
async function a_still_has_the_frame_it_is_asked_for(browser, file) {
  for (const [hash, frame] of [["#still=2", 2], ["#still=99999", null], ["#still", null]]) {
    const { page } = await open(browser, file, { hash });
    const [shown, last] = await page.$eval(".scrub", (scrub) => [Number(scrub.value), Number(scrub.max)]);
    assert.equal(shown, frame ?? last, hash);
    await page.close();
  }
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

/** Where the canvas is in the window, its green pixels, as viridis has them and faces have not, and the colour at a place. */
async function canvas_pixels(page, place = { x: 0, y: 0 }) {
  await two_pictures(page);
  const canvas = await page.$(".stage canvas"), png = await canvas.screenshot({ encoding: "base64" }), { x, y } = await canvas.boundingBox();
  const found = await (await pixels(page, png)).evaluate(({ rgba, width }, place) => {
    const green = [], from = 4 * (place.y * width + place.x);
    for (let k = 0; k < rgba.length; k += 4) {
      const [r, g, b] = rgba.slice(k, k + 3), p = { x: (k / 4) % width, y: Math.floor(k / 4 / width) };
      if (g > 1.3 * r && g > 1.1 * b && p.x < width - 90) green.push(p);   // nor the axes
    }
    return { green, at: [...rgba.slice(from, from + 3)] };
  }, place);
  return { x, y, ...found };
}

/** A bond that breaks leaves a face in the colour of its cause, from its frame on. */
async function breaks_are_faces(browser, file, { json: { breaks }, lost }) {
  const { page, complaints } = await open(browser, file);
  await page.select("#quantity", "range");   // small spheres; its colours are other ones
  assert.deepEqual(await page.$$eval(".legend:nth-child(2) li", (items) => items.map((item) => item.textContent)), ["tension", "shear", "bending"]);
  assert.deepEqual(lost.map((b) => 1 + (b % 4)), breaks.first.map(({ mode }) => mode));
  for (const [k, { mode }] of breaks.first.slice(0, 3).entries()) {
    const same_before = breaks.first.slice(0, k).filter((other) => other.mode === mode).length, counts = [];
    for (const frame of [9 + 5 * k, 10 + 5 * k]) {
      await show_frame(page, frame);
      counts.push(await pixels_of(page, await steady_picture(page), cause_colours[mode]));
    }
    assert.ok(same_before ? counts[1] > counts[0] : counts[0] === 0 && counts[1] > 20, `${causes[mode]}: ${counts}`);
  }
  assert.deepEqual(complaints, []);
  await page.close();
}

/** The list says why bonds broke; its buttons go there; a click in the picture shows numbers, another one elsewhere none. */
async function breaks_are_told_and_things_picked(browser, file, { json: { breaks: { first } }, lost }) {
  const { page, complaints } = await open(browser, file);
  const text = (selector) => page.$eval(selector, (found) => found.textContent);
  assert.equal(await text(".breaks p"), "240 bonds broke: 200 in tension, 40 in shear. The first 4 are listed; breaks.csv has them all.");
  assert.deepEqual(await page.$$eval(".breaks tbody tr", (rows) => rows.map((row) => [0, 4].map((k) => row.children[k].textContent))),
    first.map(({ when, cause }) => [when, cause]));
  await page.$$eval(".breaks tbody button", (buttons) => buttons[1].click());
  assert.equal(await page.$eval(".scrub", (scrub) => scrub.value), "15", "the first frame without the second bond");
  assert.ok((await text(".picked h3")).startsWith(`Bond ${lost[1]}, of particles`));
  assert.ok((await text(".picked .note")).includes("12.1 of 12 MPa, and 1"));
  await show_frame(page, 14);
  assert.ok((await text(".picked dl")).includes("axial force") && !(await page.$(".picked .note")), "whole before");

  for (const [quantity, kind] of [["displacement", "Particle "], ["utilisation", "Bond "]]) {
    await page.click(".picked button");
    await show_frame(page, 39);
    await page.select("#quantity", quantity);
    const seen = await canvas_pixels(page), place = seen.green[Math.floor(seen.green.length / 3)];
    await page.mouse.click(seen.x + place.x, seen.y + place.y);
    assert.ok((await text(".picked h3")).startsWith(kind), `${quantity}: ${await text(".picked h3")}`);
    const [r, g, b] = (await canvas_pixels(page, place)).at;
    assert.ok(r > 1.5 * g && b > 1.5 * g, `what is picked lies under the pointer: ${[r, g, b]}`);
  }
  const { x, y } = await canvas_pixels(page);
  await page.mouse.click(x + 5, y + 5);
  assert.equal(await page.$(".picked"), null, "nothing is there");
  await page.setViewport({ width: 400, height: 800 });
  await two_pictures(page);
  assert.ok(await fits(page), "400 px are wide enough for the list");
  assert.deepEqual(complaints, []);
  await page.close();
}

/** Of a run in which nothing breaks the page is as if there were no breaks. */
async function nothing_breaks(browser, file) {
  const { page } = await open(browser, file);
  assert.equal(await page.$(".breaks"), null);
  assert.equal(await has_contacts(page), false);
  assert.equal((await page.$$(".legend")).length, 1);
  assert.deepEqual(await page.$$eval("#quantity option", (options) => options.map(({ value }) => value)),
    ["displacement", "speed", "elongation", "bend", "twist", "U", "U_L", "U_B", "U_T", "range"]);
  assert.deepEqual(await page.$$eval(".chips button", (chips) => chips.map(({ textContent }) => textContent)),
    ["Force against shortening", "Energies", "Error of the energy balance", "Any columns"]);
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
    await no_words_on_the_body(browser, pages[0]);
    const long = "12 pairs of particles without a bond between them overlapped by more than watch.overlap of the smaller radius, the first of them at t = 3.5 s; the terminal named the first ten. ";
    await warnings_leave_room(browser, await made("warned", rod({ warnings: [{ level: "warning", text: long.repeat(2) }, { level: "warning", text: long }] })));
    await the_policy_allows_the_page_alone(browser, pages[0]);
    await downloads(browser, pages[0]);
    await untitled_has_a_heading(browser, await made("untitled", rod({ title: "" })));
    await saves_files(browser, pages[0]);
    await plots_take_any_choice(browser, pages[0]);
    await plots_take_any_choice(browser, await made("wide", wide()));
    await keys_belong_to_the_focus(browser, pages[0]);
    await a_finger_scrolls_until_the_body_is_tapped(browser, pages[0]);
    await classes_are_words(browser, pages[0]);
    await colours_have_the_range_that_is_wanted(browser, pages[0]);
    await the_body_is_cut_and_has_a_ghost(browser, pages[0]);
    await supports_and_loads_are_marked(browser, await made("held", held()));
    await plots_zoom(browser, pages[0]);
    await is_accessible(browser, pages[0]);
    await is_accessible(browser, await made("accessible", snapped()));
    await nothing_breaks(browser, pages[0]);
    const parted = breaking(), parted_page = await made("breaking", parted);
    await shows_the_run(browser, parted_page);
    await plots_take_any_choice(browser, parted_page);
    await is_accessible(browser, parted_page);
    await breaks_are_faces(browser, parted_page, parted);
    await breaks_are_told_and_things_picked(browser, parted_page, parted);
    const touched = await made("touching", touching());
    await contacts_come_and_go(browser, touched);
    await contacts_are_as_wide_as_strong(browser, touched);
    await is_accessible(browser, touched, "Contact forces");
    const repeating = await made("periodic", periodic());
    await shows_the_run(browser, repeating);
    await the_cell_is_drawn_and_particles_come_into_it(browser, repeating);
    await is_accessible(browser, repeating);
    await a_still_of_a_mode_stands_still(browser, await made("mode", rod({ first_shown: 1 })));
    await a_still_has_the_frame_it_is_asked_for(browser, await made("still", rod()));
    const none = { sequences: [], first_shown: 0 };
    await still_says_why_there_is_no_picture(browser, await made("no_frames", rod(none)), "no-frames", "Give [output] frames");
    await still_says_why_there_is_no_picture(browser, await made("too_large", rod({ ...none, no_frames: "No frame fits." })), "no-frames", "No frame fits.");
    await still_says_why_there_is_no_picture(browser, await made("broken", { ...rod(), base64: "AAAA" }), "failed", "could not be shown");
  }
} finally {
  await browser.close();
  await rm(scratch, { recursive: true });
}
