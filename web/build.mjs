// Writes the page, with style and script inside: node build.mjs [OUTPUT]
import { build } from "esbuild";
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

/** Replaces a line once; text that could end the element it stands in is an error. */
function put(page, line, open, text, close) {
  if (page.split(line).length !== 2) throw new Error(`page.html: "${line}" must stand there once`);
  if (text.includes(close) || text.includes("<!-- run -->")) throw new Error(`"${close}" in the text for ${line}`);
  return page.replace(line, () => `${open}\n${text}\n${close}`);
}

let page = await readFile(`${here}/page.html`, "utf8");
page = put(page, "<!-- style -->", "<style>", await bundled("page.css"), "</style>");
page = put(page, "<!-- script -->", "<script>", await bundled("src/main.js"), "</script>");
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
