// contacts.mjs VBOND ROOT: contacts of a real run in a browser; and that of a run without them the page has no switch.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { launch } from "./chromium.mjs";
import { open } from "./opened.mjs";
import { contacts_come_and_go, has_contacts } from "./touching.mjs";

const [vbond, root] = process.argv.slice(2), folder = mkdtempSync(join(tmpdir(), "vbond-contacts-"));
const browser = await launch();

/** The page of a bonded cube that has just begun to be crushed. */
function report(name, contacts) {
  const out = join(folder, name), values = [`output.frames.contacts=${contacts}`, "stage[0].duration=4 T0", "output.frames.every=1 T0"];
  execFileSync(vbond, ["run", `${root}/examples/crushing.toml`, "-o", out, "--report", ...values.flatMap((value) => ["--set", value])], { stdio: "ignore" });
  return join(out, "report.html");
}

try {
  await contacts_come_and_go(browser, report("with", true));
  const { page, complaints } = await open(browser, report("without", false));
  assert.equal(await has_contacts(page), false);
  assert.equal(await page.$('#quantity option[value="contact_force"]'), null);
  assert.deepEqual(complaints, []);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
