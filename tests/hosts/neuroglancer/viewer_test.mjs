// SPDX-License-Identifier: Apache-2.0
// Opens a mesh of the tool in Neuroglancer, in a browser: far away it loads the coarsest level
// alone, near by the finer ones.
//   ISOATLAS_TOOL, ISOATLAS_CHROMIUM, ISOATLAS_PAGE_BUILD   as for tests/page
//   ISOATLAS_NEUROGLANCER   the folder of build_viewer.sh; screenshots are written there
import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {existsSync, mkdtempSync, readFileSync, rmSync, statSync} from "node:fs";
import {createServer} from "node:http";
import {tmpdir} from "node:os";
import {extname, join} from "node:path";
import {after, before, test} from "node:test";

import {chromium, repository} from "../../page/modules.mjs";

const FOLDER = process.env.ISOATLAS_NEUROGLANCER;
const TYPES = {
  ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm",
};
const SLOW = 60_000;

let folder, server, address, browser;
const fragments = []; // the first and last byte of each fragment that was requested

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "isoatlas-neuroglancer-"));
  execFileSync(process.env.ISOATLAS_TOOL, [
    "extract", join(repository, "samples/protein_iron.nhdr"), "--iso", "100",
    "--refine", "max-distance:2vx", "--refine", "max-distance:0.5vx",
    "-o", join(folder, "mesh.ply"), "--neuroglancer", join(folder, "mesh"), "-q",
  ]);
  server = createServer(answer);
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  address = `http://127.0.0.1:${server.address().port}`;
  browser = await chromium.launch({
    executablePath: process.env.ISOATLAS_CHROMIUM ?? "/usr/bin/chromium",
    args: ["--headless=new", "--no-sandbox", "--use-angle=swiftshader",
           "--enable-unsafe-swiftshader"],
  });
});
after(async () => {
  await browser?.close();
  server?.close();
  if (folder) rmSync(folder, {recursive: true});
});

// A server of files with ranges, as the format needs.
function answer(request, response) {
  const path = decodeURIComponent(new URL(request.url, address).pathname);
  const file = path.startsWith("/mesh/")
    ? join(folder, path)
    : join(FOLDER, "dist", path === "/" ? "index.html" : path);
  if (!existsSync(file) || !statSync(file).isFile()) {
    response.writeHead(404).end();
    return;
  }
  const bytes = readFileSync(file);
  const head = {"content-type": TYPES[extname(file)] ?? "application/octet-stream"};
  const range = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? "");
  if (!range) {
    response.writeHead(200, head).end(bytes);
    return;
  }
  const [first, last] = [Number(range[1]), Math.min(Number(range[2]), bytes.length - 1)];
  if (path === "/mesh/1") fragments.push([first, last]);
  response
    .writeHead(206, {...head, "content-range": `bytes ${first}-${last}/${bytes.length}`})
    .end(bytes.subarray(first, last + 1));
}

// The bytes of each level, finest first.
function levelsOfManifest() {
  const bytes = readFileSync(join(folder, "mesh/1.index"));
  const count = bytes.readUInt32LE(24);
  let at = 28 + 16 * count;
  const counts = Array.from({length: count}, (_, k) => bytes.readUInt32LE(at + 4 * k));
  at += 4 * count;
  let begin = 0;
  return counts.map((n) => {
    const first = begin;
    for (let i = 0; i < n; ++i) begin += bytes.readUInt32LE(at + 12 * n + 4 * i);
    at += 16 * n;
    return [first, begin];
  });
}

function levelsRequested(levels) {
  const found = fragments.map(([first]) =>
    levels.findIndex(([begin, end]) => first >= begin && first < end));
  return [...new Set(found)].sort();
}

// The share of pixels that are not black, in the middle of the view.
async function drawnShare(page, name) {
  const path = join(FOLDER, name);
  await page.screenshot({path, clip: {x: 150, y: 100, width: 400, height: 350}});
  const data = readFileSync(path).toString("base64");
  return page.evaluate(async (png) => {
    const file = await fetch(`data:image/png;base64,${png}`);
    const image = await createImageBitmap(await file.blob());
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const {data} = context.getImageData(0, 0, image.width, image.height);
    let drawn = 0;
    for (let i = 0; i < data.length; i += 4) drawn += data[i] + data[i + 1] + data[i + 2] > 60;
    return drawn / (data.length / 4);
  }, data);
}

test("Neuroglancer shows the mesh and loads its levels as they are needed", async () => {
  const levels = levelsOfManifest();
  assert.equal(levels.length, 3);
  const state = {
    dimensions: {x: [1e-9, "m"], y: [1e-9, "m"], z: [1e-9, "m"]},
    position: [33, 33, 33],
    projectionScale: 20000,
    layout: "3d",
    showAxisLines: false,
    layers: [{
      type: "segmentation", name: "mesh", source: `precomputed://${address}/mesh`,
      segments: ["1"],
    }],
  };
  const page = await browser.newPage({viewport: {width: 700, height: 500}});
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  await page.goto(`${address}/#!${encodeURIComponent(JSON.stringify(state))}`);
  const loaded = async (expected) => {
    const end = Date.now() + SLOW;
    while (Date.now() < end) {
      if (String(levelsRequested(levels)) === String(expected)) break;
      await page.waitForTimeout(100);
    }
    await page.waitForFunction(() => window.viewer?.isReady(), null, {timeout: SLOW});
    assert.deepEqual(levelsRequested(levels), expected);
  };
  await loaded([2]); // the coarsest
  await page.evaluate(() => {
    const state = window.viewer.state.toJSON();
    state.projectionScale = 90;
    window.viewer.state.restoreState(state);
  });
  await loaded([0, 1, 2]);
  const share = await drawnShare(page, "neuroglancer.png");
  assert.ok(share > 0.2 && share < 0.95, `${share} of the view is drawn`);
  assert.deepEqual(errors, []);
});
