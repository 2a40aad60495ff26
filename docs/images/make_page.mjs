// SPDX-License-Identifier: Apache-2.0
// Takes the pictures of the page in the documentation.
//   node docs/images/make_page.mjs DRAGON.html PROTEIN.html EMBRYO.html
// DRAGON.html becomes page.png, PROTEIN.html page-cut.png, EMBRYO.html page-embryo.png:
//   isoatlas extract dragon_sdf.nrrd --iso 0 --inside below --refine max-distance:4vx
//     --refine max-distance:1vx --refine max-distance:0.5vx -o dragon.glb --html DRAGON.html
//   isoatlas extract samples/protein_iron.nhdr --iso 100 --refine max-distance:2vx
//     --refine max-distance:1vx --refine max-distance:0.5vx -o protein.glb --html PROTEIN.html
//   isoatlas extract samples/embryo.nrrd --iso 50.5 --keep-components 1 --max-distance 1vx
//     -o embryo.ply --html EMBRYO.html
// Needs the packages of the page (cd web && npm ci) and Chromium; ISOATLAS_PAGE_BUILD and
// ISOATLAS_CHROMIUM as in tests/page.
import {dirname, join, resolve} from "node:path";
import {fileURLToPath, pathToFileURL} from "node:url";

import {chromium} from "../../tests/page/modules.mjs";

const [, , dragon, protein, embryo] = process.argv;
if (!embryo) {
  console.error("usage: node docs/images/make_page.mjs DRAGON.html PROTEIN.html EMBRYO.html");
  process.exit(2);
}
const browser = await chromium.launch({
  executablePath: process.env.ISOATLAS_CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  ],
});

async function take(path, name, act, [width, height] = [1280, 760]) {
  const page = await browser.newPage({
    viewport: {width, height},
    reducedMotion: "reduce",
  });
  await page.goto(pathToFileURL(resolve(path)).href);
  await page.waitForSelector("html[data-ready]");
  await act(page);
  await page.waitForTimeout(500);
  await page.screenshot({path: join(dirname(fileURLToPath(import.meta.url)), name)});
  await page.close();
}

await take(dragon, "page.png", (page) => page.locator("#style-split").click());
await take(protein, "page-cut.png", async (page) => {
  await page.locator("#colouring-component").click();
  await page.locator("#cut-y").fill("0.5");
  await page.locator("#measure").click();
  const {x, y, width, height} = await page.locator("#view").boundingBox();
  for (const [right, down] of [[0.59, 0.56], [0.67, 0.81]])
    await page.mouse.click(x + right * width, y + down * height);
});
await take(embryo, "page-embryo.png", (page) => page.locator("#view-left").click(), [1120, 600]);
await browser.close();
