// Pictures of a report as a reader sees it, for the documentation:
//   node test/screenshot.mjs REPORT.html SHOT...
// A SHOT is JSON: {"out": file, "size": [width, height], "part": ".stage" or none for the window,
//   "dark": true, "step": of the frame to show, "choose": {"label of a control": "text of its option"}}
import { pathToFileURL } from "node:url";
import { resolve } from "node:path";
import { choose, launch } from "./chromium.mjs";

async function shoot(browser, report, { out, size, part, dark, step, choose: choices = {} }) {
  const page = await browser.newPage();
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: dark ? "dark" : "light" },
                                   { name: "prefers-reduced-motion", value: "reduce" }]);
  await page.setViewport({ width: size[0], height: size[1] });
  await page.goto(pathToFileURL(resolve(report)).href);
  await page.waitForSelector('[data-ready="drawn"]');
  for (const [label, text] of Object.entries(choices)) await choose(page, label, text);
  if (step != null)
    await page.$eval(".scrub", (scrub, value) => {
      const { frames } = JSON.parse(document.getElementById("run").textContent).sequences[0];
      scrub.value = frames.findLastIndex((frame) => frame.step <= value);
      scrub.dispatchEvent(new Event("input"));
    }, step);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await (part ? await page.$(part) : page).screenshot({ path: out });
  await page.close();
}

const [report, ...shots] = process.argv.slice(2);
const browser = await launch();
try {
  for (const shot of shots) await shoot(browser, report, JSON.parse(shot));
} finally {
  await browser.close();
}
