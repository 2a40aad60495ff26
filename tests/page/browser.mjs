// SPDX-License-Identifier: Apache-2.0
// Opens pages in a real browser, for the tests: node --test tests/page/*_test.mjs
// Build the page first: cd web && npm ci && npm run build
//   ISOATLAS_PAGE=page.html         also checks a page that the tool has made
//   ISOATLAS_PAGE_SCREENSHOTS=DIR   folder for screenshots (default: build/page-screenshots)
//   ISOATLAS_CHROMIUM=PATH          default: /usr/bin/chromium
import assert from "node:assert/strict";
import {mkdirSync, mkdtempSync, rmSync, writeFileSync} from "node:fs";
import {tmpdir} from "node:os";
import {join, resolve} from "node:path";
import {after, before} from "node:test";
import {pathToFileURL} from "node:url";

import {pages} from "./make_page.mjs";
import {chromium, repository} from "./modules.mjs";

export const screenshots = resolve(
  process.env.ISOATLAS_PAGE_SCREENSHOTS ?? join(repository, "build/page-screenshots"),
);
export const LAUNCH = {
  executablePath: process.env.ISOATLAS_CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    // Only WebGL needs the graphics process. Drawing the page there, too, takes most of its time.
    "--disable-gpu-compositing",
  ],
};
export const SLOW = 60_000;  // software rendering is slow on a busy machine
/** The smallest window for the wide layout, in which pictures are drawn sooner. */
export const SMALL = {width: 1000, height: 640};

export let browser;
export let folder;
const files = new Map();

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "isoatlas-page-"));
  mkdirSync(screenshots, {recursive: true});
  browser = await chromium.launch(LAUNCH);
});
after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, {recursive: true});
});

export function fileOf(name) {
  if (!files.has(name)) {
    const {html, results} = pages[name]();
    const path = join(folder, `${name}.html`);
    writeFileSync(path, html);
    files.set(name, {path, results});
  }
  return files.get(name);
}

/** Windows that are used again, by whether they have touch: a new one takes a second. */
const idle = {false: [], true: []};

async function newWindow(from, touch) {
  const context = await from.newContext({
    viewport: {width: 1440, height: 900},
    hasTouch: touch,
    isMobile: touch,
    acceptDownloads: true,
  });
  const page = await context.newPage();
  const window = {page, report: () => undefined, expects: () => true};
  page.on("console", (message) => {
    // A remark of the browser, which reads each picture of the canvas to show it.
    if (/GPU stall due to ReadPixels/.test(message.text())) return;
    window.report(`${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => window.report(`error: ${error.message}`));
  page.on("request", (request) => {
    const url = request.url();
    if (!window.expects(url)) window.report(`request: ${url.slice(0, 80)}`);
  });
  return window;
}

/**
 * An empty page, and the list in which its console messages, errors, and unexpected requests will
 * be.
 * @param expects whether an address is expected
 * @param fresh whether it has its own window, which is closed after it
 */
export async function emptyPage(
  expects,
  {
    width = 1440,
    height = 900,
    dark = false,
    motion = false,
    touch = false,
    fresh = false,
    in: from = browser,
  } = {},
) {
  const isKept = !fresh && from === browser;
  const window = (isKept && idle[touch].pop()) || (await newWindow(from, touch));
  const {page} = window;
  await page.setViewportSize({width, height});
  await page.emulateMedia({
    colorScheme: dark ? "dark" : "light",
    reducedMotion: motion ? "no-preference" : "reduce",
  });
  const trouble = [];
  window.report = (line) => trouble.push(line);
  window.expects = expects;
  const close = async () => {
    window.report = () => undefined;
    if (!isKept) return page.context().close();
    await page.goto("about:blank");
    if (!touch) await page.mouse.move(0, 0);  // nothing of the next page is under it
    idle[touch].push(window);
  };
  return {page, trouble, close};
}

/** Opens a page and collects console messages, errors, and requests for other addresses. */
export async function open(path, {hash = "", ...options} = {}) {
  const url = pathToFileURL(path).href;
  const {page, trouble, close} = await emptyPage((requested) => requested === url, options);
  page.setDefaultTimeout(SLOW / 2);
  await page.goto(url + hash);
  await page.waitForSelector("html[data-ready]");
  return {page, trouble, close};
}

/** The canvas as a data URL; equal texts mean equal pixels. */
export const picture = (page) => page.evaluate(() => window.isoatlas.picture());
export const state = (page, name) => page.evaluate((key) => window.isoatlas[key], name);

/** Waits for two frames, so that pending changes are drawn. */
export const drawn = (page) =>
  page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
  );
export const settled = (page) => page.waitForFunction(() => !window.isoatlas.moving);

export async function slide(page, selector, value) {
  await page.locator(selector).evaluate((input, to) => {
    input.value = to;
    input.dispatchEvent(new Event("input", {bubbles: true}));
  }, String(value));
}

/** @param old the picture before, if it is known @returns the picture after */
export async function changes(page, what, act, old) {
  old ??= await picture(page);
  await act();
  const now = await picture(page);
  assert.notEqual(now, old, `${what} changes the picture`);
  return now;
}

/** Clicks a radio button, which is an invisible element over its label. */
export const choose = (page, id) => page.locator(`#${id}`).click();

export async function rows(page, selector) {
  return page
    .locator(`${selector} tbody tr`)
    .evaluateAll((all) => all.map((tr) => [...tr.children].map((cell) => cell.textContent)));
}

/** The text with the smallest contrast to its background, by WCAG, and the contrast. */
export function leastContrast() {
  const parse = (text) => {
    const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number);
    return {rgb: [r, g, b], a};
  };
  const luminance = (rgb) =>
    rgb
      .map((v) => v / 255)
      .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
      .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const backgroundOf = (element) => {
    // The background of the element itself or of its first ancestor with an opaque one.
    for (let e = element; e; e = e.parentElement) {
      const {rgb, a} = parse(getComputedStyle(e).backgroundColor);
      if (a > 0.99) return rgb;
    }
    return [255, 255, 255];
  };
  let least = {ratio: 99, text: ""};
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const element = node.parentElement;
    if (
      !node.data.trim() ||
      ["SCRIPT", "STYLE", "NOSCRIPT"].includes(element.tagName) ||
      element.closest(".visually-hidden") ||
      element.getClientRects().length === 0
    ) {
      continue;
    }
    const style = getComputedStyle(element);
    const svg = element instanceof SVGElement;
    const fore = luminance(parse(svg ? style.fill : style.color).rgb);
    const back = luminance(backgroundOf(element));
    const ratio = (Math.max(fore, back) + 0.05) / (Math.min(fore, back) + 0.05);
    if (ratio < least.ratio) least = {ratio, text: node.data.trim()};
  }
  return least;
}

/** Moves the view so that it can be compared with known positions: from the front, all of it. */
export async function front(page) {
  await page.locator("#view-front").click();
  await settled(page);
}

/** The pixel of a point of the file in the canvas. */
export const pixelOf = (page, point) =>
  page.evaluate((at) => window.isoatlas.project(at), point);

/** The pixel of a point of the file in the page. */
export async function placeOf(page, point) {
  const box = await page.locator("#view").boundingBox();
  const [x, y] = await pixelOf(page, point);
  return {x: box.x + x, y: box.y + y};
}

export async function clickAt(page, point) {
  const {x, y} = await placeOf(page, point);
  await page.mouse.click(x, y);
  await drawn(page);
}

/** What the page finds at the pixel of a point of the file. */
export const pickAt = (page, point) =>
  page.evaluate((at) => window.isoatlas.pick(...window.isoatlas.project(at)), point);

/** The colour of the canvas at the pixel of a point of the file: red, green, blue, alpha. */
export const colourAt = (page, point) =>
  page.evaluate(async (at) => {
    const image = new Image();
    image.src = window.isoatlas.picture();
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const ratio = image.width / document.getElementById("view").clientWidth;
    const [x, y] = window.isoatlas.project(at).map((v) => Math.floor(v * ratio));
    return [...context.getImageData(x, y, 1, 1).data];
  }, point);

/** The colour of filled cuts in the theme. */
export const capColour = (page) =>
  page.evaluate(() => {
    const text = getComputedStyle(document.documentElement).getPropertyValue("--cap").trim();
    return [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
  });
