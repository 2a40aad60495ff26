// SPDX-License-Identifier: Apache-2.0
// Rewrites the section "Pages" of docs/results.md: the tool writes the pages of four volumes with
// four levels each, and Chromium opens them with software rendering. Needs the tool with pages
// (build/release), the volumes and Chromium. --out is the folder for pages and screenshots:
//   ISOATLAS_PAGE_BUILD=build/release/src/page/web node bench/pages.mjs [--data FOLDER]
//     [--out FOLDER]
import {execFileSync} from "node:child_process";
import {mkdirSync, readFileSync, statSync, writeFileSync} from "node:fs";
import {join, resolve} from "node:path";
import {performance} from "node:perf_hooks";
import {pathToFileURL} from "node:url";

import {chromium, repository} from "../tests/page/modules.mjs";

const REPEATS = 5;
const LEVELS = ["4vx", "1vx", "0.5vx"].flatMap((bound) => ["--refine", `max-distance:${bound}`]);
const VOLUMES = [
  ["head", "head_igea_sdf.nrrd", ["--iso", "0", "--inside", "below"]],
  ["dragon", "dragon_sdf.nrrd", ["--iso", "0", "--inside", "below"]],
  ["neuron", "neuron_dendrite.nrrd", ["--iso", "127.5"]],
  ["brain_fa", "brain_fa.nii.gz", ["--iso", "0.3"]],
];
const TITLE = "## Pages";
const NEXT = "## Guarantees past the paper";

function option(name, value) {
  const at = process.argv.indexOf(name);
  return resolve(at < 0 ? value : process.argv[at + 1]);
}

const data = option("--data", join(repository, "../shared/data"));
const out = option("--out", join(repository, "build/pages"));
const tool = join(repository, "build/release/bin/isoatlas");
mkdirSync(out, {recursive: true});

const browser = await chromium.launch({
  executablePath: process.env.ISOATLAS_CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

/** Milliseconds from the request of a page to its first picture: the least and the median. */
async function opened(path, screenshot) {
  const times = [];
  for (let k = 0; k < REPEATS; ++k) {
    const page = await browser.newPage({viewport: {width: 1440, height: 900}});
    const start = performance.now();
    await page.goto(pathToFileURL(path).href);
    await page.waitForSelector("html[data-ready]");
    times.push(performance.now() - start);
    if (k === 0) await page.screenshot({path: screenshot});
    await page.close();
  }
  times.sort((a, b) => a - b);
  return [times[0], times[REPEATS >> 1]];
}

const rows = [];
for (const [name, file, options] of VOLUMES) {
  const page = join(out, `${name}.html`);
  const report = join(out, `${name}.json`);
  try {
    const outputs = ["-o", join(out, `${name}.glb`), "--report", report, "--html", page, "-q"];
    execFileSync(tool, ["extract", join(data, file), ...options, ...LEVELS, ...outputs], {
      stdio: "pipe",
    });
  } catch (error) {
    if (error.status !== 1) throw error; // 1: a bound is violated
  }
  const {levels} = JSON.parse(readFileSync(report));
  const [least, median] = await opened(page, join(out, `${name}.png`));
  const triangles = levels.map((level) => level.triangles.toLocaleString("en"));
  const all = levels.reduce((sum, level) => sum + level.triangles, 0);
  const geometry = /id="isoatlas-geometry">([^<]*)</.exec(readFileSync(page, "utf8"))[1].length;
  const megabytes = (statSync(page).size / 1e6).toFixed(2);
  const seconds = [least, median].map((milliseconds) => (milliseconds / 1000).toFixed(2));
  const cells = [name, triangles.join(", "), megabytes, (geometry / all).toFixed(1), ...seconds];
  rows.push(`| ${cells.join(" | ")} |`);
  console.log(rows.at(-1));
}
await browser.close();

const section = `${TITLE}

Written by \`bench/pages.mjs\`. Each page has four levels (\`extract --html\`) and was opened
${REPEATS} times in headless Chromium with software rendering, on a machine shared with other work.
Times are seconds from the request to the first picture, which shows the finest level. "Bytes for a
triangle" counts the geometry of all levels as base64.

| page | triangles | size, MB | bytes for a triangle | opened in, s: least | median |
|---|---:|---:|---:|---:|---:|
${rows.join("\n")}

`;
const results = join(repository, "docs/results.md");
const old = readFileSync(results, "utf8");
const end = old.indexOf(NEXT);
const start = old.includes(TITLE + "\n") ? old.indexOf(TITLE + "\n") : end;
writeFileSync(results, old.slice(0, start) + section + old.slice(end));
