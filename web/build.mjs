// Writes the page, with style and script inside: node build.mjs [OUTPUT]
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdir, readFile, rename, writeFile } from "node:fs/promises";
import { dirname, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const output = resolve(process.argv[2] ?? `${here}/../build/page/report.html`);

const packages = new Set();   // of others, in the page

async function bundled(entry) {
  const { outputFiles, metafile } = await build({ entryPoints: [`${here}/${entry}`], bundle: true, minify: true, write: false, format: "iife",
                                        target: ["chrome91", "firefox113", "safari16"], legalComments: "none", charset: "utf8", metafile: true });
  for (const input of Object.keys(metafile.inputs)) {
    const name = input.match(/node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1];
    if (name) packages.add(name);
  }
  return outputFiles[0].text.trim();
}

function replaced(page, line, text) {
  if (page.split(line).length !== 2) throw new Error(`page.html: "${line}" must stand there once`);
  return page.replace(line, () => text);
}

/** Replaces a line once; text that could end the element it stands in is an error. */
function put(page, line, open, text, close) {
  if (text.includes(close) || text.includes("<!-- run -->")) throw new Error(`"${close}" in the text for ${line}`);
  return replaced(page, line, `${open}\n${text}\n${close}`);
}

/** What the page may do: run this one script, with this one style. It loads nothing and sends nothing. */
function policy(style, script) {
  const hash = (text) => `'sha256-${createHash("sha256").update(`\n${text}\n`).digest("base64")}'`;   // as put() writes it
  const rules = ["default-src 'none'", `script-src ${hash(script)}`, `style-src ${hash(style)}`, "img-src data:",   // the icon
                 "connect-src 'none'", "base-uri 'none'", "form-action 'none'"];
  return `<meta http-equiv="Content-Security-Policy" content="${rules.join("; ")}">`;
}

const style = await bundled("page.css"), script = await bundled("src/main.js");
let page = await readFile(`${here}/page.html`, "utf8");
page = replaced(page, "<!-- policy -->", policy(style, script));   // before what it allows
page = put(page, "<!-- style -->", "<style>", style, "</style>");
page = put(page, "<!-- script -->", "<script>", script, "</script>");
/** Their licences ask for their notices wherever they go. */
async function notices() {
  const texts = await Promise.all([...packages].sort().map(async (name) => `${name}\n\n${await readFile(`${here}/node_modules/${name}/LICENSE`, "utf8")}`));
  return texts.join("\n").replaceAll("--", "- -");
}

page = put(page, "<!-- notices -->", "<!-- This page contains:", await notices(), "-->");
await mkdir(dirname(output), { recursive: true });
await writeFile(`${output}.part`, page);
await rename(`${output}.part`, output);   // a page is whole or not there
console.log(`${output}: ${Math.round(page.length / 1000)} kB`);
