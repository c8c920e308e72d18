// node test/campaign.mjs VBOND ROOT CASES [SEED]: the pages of random runs (ROOT/tests/random_body.py), each used at
// random: quantities, ranges, cuts, marks, frames, clicks and drags in the body and in plots, narrow and wide.
// Counts: sound; refused, where the program has no page to show; wrong, where the page complains, fetches, is wider than
// the screen, or shows a text of what is no number. The status is 1 if one was wrong.
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { launch } from "./chromium.mjs";
import { fits, open, two_pictures } from "./opened.mjs";

const [vbond, root] = process.argv.slice(2, 4).map((path) => resolve(path)), cases = Number(process.argv[4]), seed = Number(process.argv[5] ?? 1);
const uses = 25;   // of each page

/** Random numbers from 0 to 1 (mulberry32), so that a case can be had again. */
function random_of(state) {
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

function random_case(k) {
  const text = execFileSync("python3", ["-c", `
import random, sys
sys.path.insert(0, sys.argv[1])
from random_body import random_case
print(random_case(random.Random(int(sys.argv[2]))))`, join(root, "tests"), String(seed * 100003 + k)], { encoding: "utf8" });
  return `${text}frames = {every = "0.4 T0", contacts = ${/^\[contact\]/m.test(text)}}\n`;
}

/** Something that a reader may do. Sets what any control may have, then clicks or drags. */
async function use(page, random) {
  const control = Math.floor(random() * 1000), value = random(), place = [random(), random()], kind = random();
  if (kind < 0.1) return page.setViewport({ width: value < 0.5 ? 390 : 1300, height: 800 });
  if (kind < 0.6) {
    return page.evaluate((n, part) => {
      const all = [...document.querySelectorAll(".settings select, .settings input, .settings button, .scrub, .plots button")]
        .filter((e) => e.offsetHeight && !["PNG", "CSV"].includes(e.textContent));
      const chosen = all[n % all.length];
      if (chosen.type === "checkbox" || chosen.tagName === "BUTTON") return chosen.click();
      if (chosen.tagName === "SELECT") chosen.selectedIndex = Math.floor(part * chosen.options.length);
      else if (chosen.type === "range") chosen.value = Number(chosen.min) + part * (chosen.max - chosen.min);
      else chosen.value = (part - 0.3) * 10;
      for (const event of ["input", "change"]) chosen.dispatchEvent(new Event(event));
    }, control, value);
  }
  const targets = await page.$$(".stage canvas, .plot:not([hidden]) .u-over"), target = targets[control % targets.length];
  await target.evaluate((e) => e.scrollIntoView({ block: "center" }));
  const { x, y, width, height } = await target.boundingBox(), [px, py] = [x + place[0] * width, y + place[1] * height];
  if (kind < 0.8) return page.mouse.click(px, py, { count: value < 0.2 ? 2 : 1 });
  await page.mouse.move(px, py);
  await page.mouse.down();
  await page.mouse.move(px + 200 * (value - 0.5), py + 100 * (place[0] - 0.5), { steps: 3 });
  await page.mouse.up();
}

async function what_is_wrong(browser, file, random) {
  const { page, complaints } = await open(browser, file);
  try {
    for (let k = 0; k < uses; ++k) {
      await use(page, random);
      await two_pictures(page);
      const text = await page.evaluate(() => [".stage", ".picked", ".plots", ".timeline"].map((s) => document.querySelector(s)?.innerText ?? "").join(" "));
      const odd = text.match(/NaN|undefined|null|Infinity|\[object/);
      if (odd) return `after use ${k}: "${odd[0]}" in ${text.replace(/\s+/g, " ").slice(0, 300)}`;
      if (!await fits(page)) return `after use ${k}: wider than the screen`;
      if (complaints.length) return `after use ${k}: ${complaints.join("; ")}`;
    }
    return "";
  } finally {
    await page.close();
  }
}

const counts = { sound: 0, refused: 0, wrong: 0 }, folder = mkdtempSync(join(tmpdir(), "vbond-page-campaign-")), browser = await launch();
try {
  for (let k = 0; k < cases; ++k) {
    const run = join(folder, String(k));
    writeFileSync(`${run}.toml`, random_case(k));
    spawnSync(vbond, ["run", `${run}.toml`, "-o", run, "--quiet"]);   // one that ends badly has a page, too
    if (!existsSync(run) || spawnSync(vbond, ["report", run]).status !== 0) { ++counts.refused; continue; }
    const why = await what_is_wrong(browser, join(run, "report.html"), random_of(seed * 100003 + k)).catch((error) => String(error.stack));
    ++counts[why ? "wrong" : "sound"];
    if (why) console.log(`case ${k} of seed ${seed}: ${why}`);
    rmSync(run, { recursive: true });
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
console.log(Object.entries(counts).map(([what, number]) => `${number} ${what}`).join(", "));
process.exit(counts.wrong ? 1 : 0);
