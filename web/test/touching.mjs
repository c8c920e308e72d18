// Contacts in a page: the switch that shows them, their legend, their lines.
import assert from "node:assert/strict";
import { maps, shade } from "../src/colours.js";
import { choose, tick } from "./chromium.mjs";
import { colours, open, picture, pixels_of, show_frame, soon, steady_picture } from "./opened.mjs";

const label = "Contact forces", key = "contact_force", range = '[aria-label="Range of the colours"]';

/** Whether the page has the switch. */
export const has_contacts = (page) => page.$$eval(".control", (controls, label) => controls.some((control) => control.textContent === label), label);

const text = (page, selector) => page.$eval(selector, (found) => found.textContent);
const quantity = (page) => page.$eval("#quantity", (select) => select.value);
const legend = (page) => page.$$eval("p.legend", (found) => found.map((p) => p.textContent).join());

/** Numbers of the frames with the most contacts and with the fewest, of the run. */
function frames_of(page) {
  return page.evaluate(() => {
    const { frames } = JSON.parse(document.getElementById("run").textContent).sequences.find(({ contacts }) => contacts);
    const counts = frames.map(({ contacts }) => contacts?.count ?? -1);
    return { most: counts.indexOf(Math.max(...counts)), fewest: counts.indexOf(Math.min(...counts)) };
  });
}

/** Off at first; on they carry the colour and are told in the legend, frame by frame; off again all is as before. */
export async function contacts_come_and_go(browser, file) {
  const { page, complaints } = await open(browser, file);
  const may_choose = await page.$$eval("option", (options) => options.some((option) => option.textContent === "Run"));
  if (may_choose) await choose(page, "Show", "Run");
  const { most, fewest } = await frames_of(page);
  await show_frame(page, most);
  await page.select("#quantity", "speed");
  const before = await steady_picture(page);
  assert.equal(await legend(page), "", "off");

  await tick(page, label);
  assert.equal(await quantity(page), key);
  assert.ok((await text(page, ".legend-title")).startsWith("Normal force of contacts"));
  assert.ok((await legend(page)).includes("the largest of this frame"), await legend(page));
  const shown = await steady_picture(page);
  assert.notEqual(shown, before);
  assert.ok((await colours(page, shown)) > 20, "lines in colour");
  const there = await legend(page);
  await show_frame(page, fewest);
  assert.notEqual(await legend(page), there, "another frame has another largest force, or none");
  await show_frame(page, most);
  assert.equal(await steady_picture(page), shown);

  await page.$eval(`${range} input:nth-of-type(2)`, (field) => { field.value = Number(field.value) / 3; field.dispatchEvent(new Event("change")); });
  assert.ok((await legend(page)).includes("as chosen"), "the range of the colours is that of the widths");
  assert.ok(await soon(async () => await picture(page) !== shown));
  await page.$eval(`${range} button`, (button) => button.click());
  assert.equal(await steady_picture(page), shown);

  await page.select("#quantity", "displacement");
  assert.ok((await legend(page)).includes("the largest of this frame"), "lines stay, the body has the colours");
  await page.select("#quantity", key);
  assert.equal(await steady_picture(page), shown);
  await tick(page, label);
  assert.deepEqual([await quantity(page), await legend(page)], ["speed", ""]);
  assert.equal(await steady_picture(page), before);
  await page.select("#quantity", key);
  assert.equal(await steady_picture(page), shown, "their colours alone would be nothing to see");
  assert.deepEqual(complaints, []);
  await page.close();
}

/** Of touching() of sample.mjs. */
export async function contacts_are_as_wide_as_strong(browser, file) {
  const { page, complaints } = await open(browser, file);
  await tick(page, label);
  const words = [];
  for (const frame of [0, 1, 2, 3]) {
    await show_frame(page, frame);
    words.push(await legend(page));
  }
  assert.deepEqual(words.slice(0, 2), ["This frame was written without contacts.", "Nothing touches in this frame."]);
  assert.ok(words[2].includes("widest at 2 N") && words[3].includes("widest at 4 N"), words.join());
  // Lines of one length: their areas are as their widths. An edge may be off by a pixel, of 20 and more: 10 % together.
  await show_frame(page, 2);
  const area_in = (png, force) => pixels_of(page, png, [...maps.viridis.slice(3 * shade(force, [0, 4]), 3 * shade(force, [0, 4]) + 3)]);
  const png = await steady_picture(page), areas = [await area_in(png, 2), await area_in(png, 1)];
  assert.ok(areas[1] > 400 && Math.abs(areas[0] / areas[1] - 2) < 0.2, `areas ${areas}`);
  await choose(page, "Cut away", "+z");   // between the rows
  const rest = await steady_picture(page);
  assert.deepEqual([await area_in(rest, 2), await area_in(rest, 1)], [areas[0], 0], "the cut takes the upper one away");
  await choose(page, "Cut away", "nothing");
  await show_frame(page, 3);
  assert.ok(await area_in(await steady_picture(page), 0.8) > 100, "the line to the floor");
  assert.deepEqual(complaints, []);
  await page.close();
}
