// SPDX-License-Identifier: Apache-2.0
// Opens the page of `isoatlas view` in a real browser, for the tests.
//   ISOATLAS_VIEW_PAGE=1   uses the page that npm has built, not the one in the tool
import {readFileSync} from "node:fs";
import {join} from "node:path";

import {emptyPage, SLOW} from "./browser.mjs";
import {bundleFolder} from "./modules.mjs";

/** The page, as the tool serves it. */
export function html() {
  const part = (name) => readFileSync(join(bundleFolder, name), "utf8");
  return `<!doctype html><html lang="en"><head><meta charset="utf-8">` +
    `<meta name="viewport" content="width=device-width, initial-scale=1">` +
    `<title>isoatlas view</title><style>${part("view.css")}</style></head><body><script>` +
    `${part("view.js")}</script></body></html>`;
}

/** Opens the page and collects console messages, errors, and requests for other servers. */
export async function openView(address, options = {}) {
  const expects = (url) => [address, "data:", "blob:"].some((start) => url.startsWith(start));
  const {page, trouble, close} = await emptyPage(expects, options);
  page.setDefaultTimeout(SLOW);
  if (process.env.ISOATLAS_VIEW_PAGE)
    await page.route(address, (route) => route.fulfill({contentType: "text/html", body: html()}));
  await page.goto(address);
  await page.waitForSelector("html[data-ready]");
  return {page, trouble, close};
}

/** Waits until the mesh of the options, its components and the slices are shown. */
export const upToDate = (page) =>
  page.waitForFunction(
    () => window.isoatlas.upToDate && !document.querySelector("[aria-busy=true]"),
    null,
    {timeout: 3 * SLOW},
  );

export async function type(page, selector, text) {
  await page.locator(selector).fill(`${text}`);
  await page.locator(selector).press("Enter");
}

/** The value of an option of the shown mesh; undefined if it is not given. */
export const option = (page, name) =>
  page.evaluate((wanted) => window.isoatlas.options.find(([n]) => n === wanted)?.[1], name);

/** The pixels of a picture of the page: red, green, blue, alpha at points in CSS pixels. */
export const pixelsAt = (page, picture, width, points) =>
  page.evaluate(
    async ([url, wide, places]) => {
      const image = new Image();
      image.src = url;
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [image.width, image.height];
      const context = canvas.getContext("2d", {willReadFrequently: true});
      context.drawImage(image, 0, 0);
      const ratio = image.width / wide;
      return places.map(([x, y]) => [
        ...context.getImageData(Math.floor(x * ratio), Math.floor(y * ratio), 1, 1).data,
      ]);
    },
    [picture, width, points],
  );

const NAMES = ["x", "y", "z"];

/** The colours of a slice view at samples of the volume. */
export async function sliceColours(page, axis, samples) {
  const picture = await page.evaluate((a) => window.isoatlas.slicePicture(a), axis);
  const points = await page.evaluate(
    ([a, all]) => all.map((s) => window.isoatlas.pixelOf(a, s)).map(({x, y}) => [x, y]),
    [axis, samples],
  );
  const {width} = await page.locator(`#slice-${NAMES[axis]}`).boundingBox();
  return pixelsAt(page, picture, width, points);
}

/** Where a sample is in the page, in the view of slices across an axis. */
export async function placeOfSample(page, axis, sample) {
  const box = await page.locator(`#slice-${NAMES[axis]}`).boundingBox();
  const {x, y} = await page.evaluate(
    ([a, s]) => window.isoatlas.pixelOf(a, s), [axis, sample]);
  return {x: box.x + x, y: box.y + y};
}

/** The colour of the isoline and of the tint: blue. */
export const isBlue = ([r, , b]) => b > r + 50;

/** The number of pixels of the mesh view that are not background. */
export const meshPixels = (page) =>
  page.evaluate(async () => {
    const image = new Image();
    image.src = window.isoatlas.picture();
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const {data} = context.getImageData(0, 0, canvas.width, canvas.height);
    let drawn = 0;
    for (let i = 3; i < data.length; i += 4) if (data[i] > 0) ++drawn;
    return drawn / (data.length / 4);
  });
