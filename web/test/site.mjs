// The site of tools/site in chromium, from files: node test/site.mjs FOLDER [PICTURES]
// Its pages on a wide and a narrow screen: no script fails, nothing is asked of a network or missing, no page is wider
// than the screen, the search finds. PICTURES: a folder for pictures of them.
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { launch } from "./chromium.mjs";

const [folder, pictures] = process.argv.slice(2);
const site = pathToFileURL(resolve(folder)).href;
const pages = ["index.html", "examples/rod_buckling.html", "examples/crushed_sphere.html", "docs/theory.html", "docs/output.html",
               "docs/case-reference.html", "docs/glossary.html", "docs/notebooks/first-steps.html", "docs/site/python-reference.html",
               "library/index.html", "library/classvbond_1_1Run.html", "search.html?q=bifurcation"];
const browser = await launch();
try {
  const page = await browser.newPage(), problems = [];
  page.on("pageerror", (error) => problems.push(`${page.url()}: ${error}`));
  page.on("requestfailed", (request) => problems.push(`${page.url()}: missing ${request.url()}`));
  page.on("request", (request) => { if (/^(https?|wss?):/.test(request.url())) problems.push(`${page.url()} asks ${request.url()}`); });
  for (const width of [1400, 390]) {
    await page.setViewport({ width, height: 900 });
    for (const name of pages) {
      await page.goto(`${site}/${name}`, { waitUntil: "networkidle0" });
      const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      if (wider > 0) problems.push(`${name} is wider than a screen of ${width} by ${wider}`);
      if (name.startsWith("search")) {
        await page.waitForSelector("#search-results li");
        const found = await page.$$eval("#search-results li a", (links) => links.map((a) => a.textContent));
        assert(found.some((title) => title.includes("Buckling loads of a rod")), `the search finds ${found}`);
      }
      if (pictures) await page.screenshot({ path: `${pictures}/${width}-${name.replace(/\W+/g, "-")}.png` });
    }
  }
  assert.deepEqual(problems, []);
  console.log(`${pages.length} pages, wide and narrow: nothing amiss`);
} finally {
  await browser.close();
}
