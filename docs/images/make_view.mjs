// SPDX-License-Identifier: Apache-2.0
// Takes the pictures of the page of `isoatlas view` in the documentation, view.jpg and
// view-narrow.jpg, with the tool that ISOATLAS_TOOL names.
//   node docs/images/make_view.mjs ct_chest.mha
// Needs the packages of the page (cd web && npm ci) and Chromium; ISOATLAS_PAGE_BUILD and
// ISOATLAS_CHROMIUM as in tests/page.
import {spawn} from "node:child_process";
import {dirname, join} from "node:path";
import {fileURLToPath} from "node:url";

import {chromium} from "../../tests/page/modules.mjs";

const [, , chest] = process.argv;
if (!chest || !process.env.ISOATLAS_TOOL) {
  console.error("usage: ISOATLAS_TOOL=isoatlas node docs/images/make_view.mjs ct_chest.mha");
  process.exit(2);
}
const browser = await chromium.launch({
  executablePath: process.env.ISOATLAS_CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

async function take(name, viewport, act) {
  const tool = spawn(process.env.ISOATLAS_TOOL,
    ["view", chest, "--iso", "112.5", "--no-browser"], {stdio: ["ignore", "pipe", "inherit"]});
  const address = await new Promise((done) =>
    tool.stdout.once("data", (text) => done(`${text}`.match(/http:\S+/)[0])));
  const page = await browser.newPage({viewport, reducedMotion: "reduce"});
  await page.goto(address);
  await page.waitForFunction(() => window.isoatlas?.upToDate, null, {timeout: 120_000});
  await act(page);
  await page.waitForTimeout(800);
  await page.screenshot({
    path: join(dirname(fileURLToPath(import.meta.url)), name),
    type: "jpeg",
    quality: 80,
  });
  await page.close();
  await new Promise((done) => tool.on("close", done));
}

await take("view.jpg", {width: 1440, height: 900}, (page) =>
  page.locator("#colouring-component").evaluate((input) => input.click()));
await take("view-narrow.jpg", {width: 360, height: 740}, (page) =>
  page.locator('[data-view="mesh"]').evaluate((view) => view.scrollIntoView({block: "start"})));
await browser.close();
