// A page in a browser: opened, looked at, waited for.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { patience, tick } from "./chromium.mjs";

/** Opens a page and waits for its first picture; whatever it complains of or fetches is in `complaints`. */
export async function open(browser, file, { width = 1300, reduced = "reduce", ready = "drawn", hash = "", touch = false } = {}) {
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

export const two_pictures = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** The next picture on the screen, after what was asked for has been drawn. */
export async function picture(page) {
  await two_pictures(page);
  return (await page.$(".stage")).screenshot({ encoding: "base64", captureBeyondViewport: false });
}

/** Waits until `found()`, which may take a busy browser a while, holds; whether it did. */
export async function soon(found) {
  for (const end = performance.now() + patience; performance.now() < end;) if (await found()) return true;
  return false;
}

/** The picture when two in a row are the same. */
export async function steady_picture(page) {
  let last = await picture(page);
  assert.ok(await soon(async () => { const before = last; last = await picture(page); return last === before; }), "the picture comes to rest");
  return last;
}

/** A handle of {rgba, width, height} of a picture, decoded in `page`, which does not show it. */
export function pixels(page, png) {
  return page.evaluateHandle(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const { width, height } = image, pen = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d");
    pen.drawImage(image, 0, 0);
    return { rgba: pen.getImageData(0, 0, width, height).data, width, height };
  }, png);
}

/** How many different colours the middle of a picture has. */
export async function colours(page, png) {
  return (await pixels(page, png)).evaluate(({ rgba, width, height }) => {
    const seen = new Set(), row = (part) => 4 * width * Math.floor(part * height);   // neither caption nor legend
    for (let k = row(0.15); k < row(0.8); k += 4) if (Math.max(...rgba.slice(k, k + 3)) - Math.min(...rgba.slice(k, k + 3)) > 40) seen.add(rgba.slice(k, k + 3).join());
    return seen.size;
  });
}

export const fits = (page) => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);

export const show_frame = (page, frame) => page.$eval(".scrub", (scrub, frame) => { scrub.value = frame; scrub.dispatchEvent(new Event("input")); }, frame);

/** How many pixels of the picture are of this colour, however it is shaded: the same parts of red, green and blue to 4 %. */
export async function pixels_of(page, png, rgb) {
  return (await pixels(page, png)).evaluate(({ rgba }, rgb) => {
    const most = Math.max(...rgb);
    let count = 0;
    for (let k = 0; k < 0.85 * rgba.length; k += 4) {   // without the legend
      const light = Math.max(...rgba.slice(k, k + 3));
      if (light > 60 && rgb.every((x, c) => Math.abs(rgba[k + c] / light - x / most) < 0.04)) ++count;
    }
    return count;
  }, rgb);
}

/** Nothing that axe knows of keeps readers with other senses out, in both themes, wide and narrow. */
export async function is_accessible(browser, file, ticked) {
  const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  for (const [width, theme] of [[1300, "light"], [390, "dark"]]) {
    const { page } = await open(browser, file, { width });
    await page.evaluate((name) => { if (document.documentElement.dataset.theme !== name) document.querySelector(".top button").click(); }, theme);
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme ?? "light"), theme);
    if (ticked) await tick(page, ticked);
    await page.evaluate(axe);   // by the tester's tools: the page itself may not run it
    const { violations } = await page.evaluate(() => globalThis.axe.run(document));
    assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join("; ")}`), []);
    await page.close();
  }
}
