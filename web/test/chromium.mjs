// Debian's chromium without a window, drawing WebGL2 in software. Ends the program with 77 (skipped) where it or
// puppeteer-core is missing.
import { existsSync } from "node:fs";

export const patience = 120_000;   // ms for one wait, on a machine that is busy with other tests
const skipped = 77;

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(skipped);
}

export async function launch() {
  const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/google-chrome"].find((path) => path && existsSync(path));
  if (!executablePath) skip("no chromium (apt-get install --no-install-recommends chromium)");
  const { default: puppeteer } = await import("puppeteer-core").catch(() => skip("no puppeteer-core (npm ci --ignore-scripts in web/)"));
  return puppeteer.launch({ executablePath, headless: true, timeout: patience, protocolTimeout: patience,
                            args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
}

/** Takes the option with this text of the control with this label. */
export function choose(page, label, text) {
  return page.evaluate((label, text) => {
    const control = [...document.querySelectorAll(".control")].find((c) => c.querySelector("span")?.textContent === label);
    const select = control?.querySelector("select");
    const option = [...(select?.options ?? [])].find((o) => o.textContent === text);
    if (!option) throw new Error(`no option "${text}" of "${label}"`);
    select.value = option.value;
    select.dispatchEvent(new Event("change"));
  }, label, text);
}

/** Clicks the box of the control with this label. */
export function tick(page, label) {
  return page.evaluate((label) => {
    const control = [...document.querySelectorAll(".control")].find((c) => c.textContent === label);
    control.querySelector("input").click();
  }, label);
}
