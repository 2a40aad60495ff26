// SPDX-License-Identifier: Apache-2.0
// Takes the picture of the page in the README: node docs/images/make_page.mjs PAGE.html
// PAGE.html shows the dragon:
//   isoatlas extract dragon_sdf.nrrd --iso 0 --inside below --refine max-distance:4vx
//     --refine max-distance:1vx --refine max-distance:0.5vx -o dragon.glb --html PAGE.html
// Needs the packages of the page (cd web && npm ci) and Chromium; ISOATLAS_PAGE_BUILD and
// ISOATLAS_CHROMIUM as in tests/page.
import {dirname, join, resolve} from "node:path";
import {fileURLToPath, pathToFileURL} from "node:url";

import {chromium} from "../../tests/page/modules.mjs";

const [, , path] = process.argv;
if (!path) {
  console.error("usage: node docs/images/make_page.mjs PAGE.html");
  process.exit(2);
}
const browser = await chromium.launch({
  executablePath: process.env.ISOATLAS_CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});
const page = await browser.newPage({viewport: {width: 1280, height: 760}});
await page.goto(pathToFileURL(resolve(path)).href);
await page.waitForSelector("html[data-ready]");
await page.locator("#style-split").click();
await page.waitForTimeout(500);
await page.screenshot({path: join(dirname(fileURLToPath(import.meta.url)), "page.png")});
await browser.close();
