// SPDX-License-Identifier: Apache-2.0
// Tests the page in a real browser: node --test tests/page/page_test.mjs
// Build it first: cd web && npm ci && npm run build
//   ISOATLAS_PAGE=page.html         also checks a page that the tool has made
//   ISOATLAS_PAGE_SCREENSHOTS=DIR   folder for screenshots (default: build/page-screenshots)
//   ISOATLAS_CHROMIUM=PATH          default: /usr/bin/chromium
import assert from "node:assert/strict";
import {mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync} from "node:fs";
import {tmpdir} from "node:os";
import {join, resolve} from "node:path";
import {after, before, describe, test} from "node:test";
import {pathToFileURL} from "node:url";

import {pages} from "./make_page.mjs";
import {chromium, repository} from "./modules.mjs";

const screenshots = resolve(
  process.env.ISOATLAS_PAGE_SCREENSHOTS ?? join(repository, "build/page-screenshots"),
);
const LAUNCH = {
  executablePath: process.env.ISOATLAS_CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
  ],
};
const SLOW = 60_000;  // software rendering is slow on a busy machine

let browser;
let folder;
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

function fileOf(name) {
  if (!files.has(name)) {
    const {html, results} = pages[name]();
    const path = join(folder, `${name}.html`);
    writeFileSync(path, html);
    files.set(name, {path, results});
  }
  return files.get(name);
}

/** Opens a page and collects console messages, errors, and requests for other addresses. */
async function open(
  path,
  {
    width = 1440,
    height = 900,
    dark = false,
    motion = false,
    touch = false,
    in: from = browser,
  } = {},
) {
  const context = await from.newContext({
    viewport: {width, height},
    colorScheme: dark ? "dark" : "light",
    reducedMotion: motion ? "no-preference" : "reduce",
    hasTouch: touch,
    isMobile: touch,
  });
  const page = await context.newPage();
  page.setDefaultTimeout(SLOW / 2);
  const trouble = [];
  const url = pathToFileURL(path).href;
  page.on("console", (message) => trouble.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => trouble.push(`error: ${error.message}`));
  page.on("request", (request) => {
    if (request.url() !== url) trouble.push(`request: ${request.url().slice(0, 80)}`);
  });
  await page.goto(url);
  await page.waitForSelector("html[data-ready]");
  return {page, trouble, close: () => context.close()};
}

/** The canvas as a data URL; equal texts mean equal pixels. */
const picture = (page) => page.evaluate(() => window.isoatlas.picture());
const state = (page, name) => page.evaluate((key) => window.isoatlas[key], name);

/** Waits for two frames, so that pending changes are drawn. */
const drawn = (page) =>
  page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
  );
const settled = (page) => page.waitForFunction(() => !window.isoatlas.moving);

async function slide(page, selector, value) {
  await page.locator(selector).evaluate((input, to) => {
    input.value = to;
    input.dispatchEvent(new Event("input", {bubbles: true}));
  }, String(value));
}

async function changes(page, what, act) {
  const old = await picture(page);
  await act();
  const now = await picture(page);
  assert.notEqual(now, old, `${what} changes the picture`);
  return now;
}

/** Clicks a radio button, which is an invisible element over its label. */
const choose = (page, id) => page.locator(`#${id}`).click();

async function rows(page, selector) {
  return page
    .locator(`${selector} tbody tr`)
    .evaluateAll((all) => all.map((tr) => [...tr.children].map((cell) => cell.textContent)));
}

/** The text with the smallest contrast to its background, by WCAG, and the contrast. */
function leastContrast() {
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

describe("every page", () => {
  const names = [
    ...Object.keys(pages).filter((name) => name !== "large"),
    ...(process.env.ISOATLAS_PAGE ? ["ISOATLAS_PAGE"] : []),
  ];
  for (const name of names) {
    test(name, {timeout: 4 * SLOW}, async () => {
      const path =
        name === "ISOATLAS_PAGE" ? resolve(process.env.ISOATLAS_PAGE) : fileOf(name).path;
      const {page, trouble, close} = await open(path);
      const data = await page.evaluate(() =>
        JSON.parse(document.getElementById("isoatlas-data").textContent),
      );
      const [result] = data.results;
      assert.equal(await page.locator("h1").textContent(), result.title);

      // The level table contains the data of the JSON.
      const table = await rows(page, "#levels");
      assert.deepEqual(
        table.map((r) => r.slice(0, 3).map((text) => Number(text.replaceAll(",", "")))),
        result.levels.map((l) => [l.level, l.vertices, l.triangles]),
      );

      // Every level is drawn, and the topology counted in the page agrees with the JSON.
      const last = result.levels.length - 1;
      assert.equal(await state(page, "level"), last);
      let before = null;
      for (let level = 0; level <= last; ++level) {
        await slide(page, "#level", level);
        const now = await picture(page);
        if (
          before !== null &&
          result.levels[level].triangles !== result.levels[level - 1].triangles
        ) {
          assert.notEqual(now, before, `level ${level} looks different`);
        }
        before = now;
        const components = await state(page, "components");
        assert.equal(components.length, result.levels[level].components);
        assert.equal(
          components.reduce((sum, c) => sum + c.triangles, 0),
          result.levels[level].triangles,
        );
        if (result.levels[level].genus !== null) {
          assert.equal(
            components.reduce((sum, c) => sum + c.genus, 0),
            result.levels[level].genus,
          );
        }
        if (result.levels[level].boundary_loops !== null) {
          assert.equal(
            components.reduce((sum, c) => sum + c.boundaryLoops, 0),
            result.levels[level].boundary_loops,
          );
        }
        assert.match(
          await page.locator("#view").getAttribute("aria-label"),
          new RegExp(
            `level ${level} of ${last}: ${result.levels[level].vertices.toLocaleString("en")} vert`,
          ),
        );
      }

      await page.locator("#worst").click();
      const worst = await state(page, "worst");
      const {x, y, box} = await page.evaluate(() => {
        const [px, py] = window.isoatlas.project(window.isoatlas.worst.centroid);
        const {width, height} = document.getElementById("view").getBoundingClientRect();
        return {x: px, y: py, box: {width, height}};
      });
      assert.ok(
        Math.abs(x - box.width / 2) < 1 && Math.abs(y - box.height / 2) < 1,
        `the worst triangle is at ${x}, ${y} of ${box.width} x ${box.height}`,
      );
      assert.ok(
        (await page.locator("#status").textContent()).includes(
          `${Number(worst.ratio.toPrecision(3))}`,
        ),
      );

      for (const colour of [
        "aspect",
        "component",
        "level",
        ...(result.geometry.levels.some((l) => l.distance) ? ["distance"] : []),
      ])
        await choose(page, `colouring-${colour}`);
      for (const style of ["lines", "split", "smooth"]) await choose(page, `style-${style}`);
      assert.deepEqual(trouble, []);
      await close();

      for (const width of [360, 1440]) {
        const {page: narrow, close: done} = await open(path, {width, height: 800});
        const {scroll, client} = await narrow.evaluate(() => ({
          scroll: document.documentElement.scrollWidth,
          client: document.documentElement.clientWidth,
        }));
        assert.ok(scroll <= client, `at ${width} pixels nothing overflows: ${scroll} > ${client}`);
        for (const selector of ["table", "#facts section"]) {
          const over = await narrow
            .locator(selector)
            .evaluateAll(
              (all) =>
                all.filter(
                  (e) =>
                    e.getBoundingClientRect().right > innerWidth + 0.5 ||
                    e.scrollWidth > e.clientWidth + 1,
                ).length,
            );
          assert.equal(over, 0, `at ${width} pixels no ${selector} overflows`);
        }
        await done();
      }
    });
  }
});

describe("controls", () => {
  let page;
  let trouble;
  let close;
  before(async () => {
    ({page, trouble, close} = await open(fileOf("ring").path));
  });
  after(async () => {
    assert.deepEqual(trouble, []);
    await close();
  });

  test("style and colouring", {timeout: SLOW}, async () => {
    const seen = new Set([await picture(page)]);
    for (const style of ["split", "lines"]) {
      seen.add(await changes(page, style, () => choose(page, `style-${style}`)));
      assert.equal(await state(page, "style"), style);
    }
    for (const style of ["smooth", "lines"]) {
      await choose(page, `style-${style}`);
      for (const colour of ["aspect", "distance", "component", "level"]) {
        seen.add(await changes(page, colour, () => choose(page, `colouring-${colour}`)));
        assert.equal(await state(page, "colouring"), colour);
        assert.notEqual(await page.locator("#legend").textContent(), "");
      }
      await choose(page, "colouring-plain");
      assert.equal(await page.locator("#legend").textContent(), "");
    }
    assert.equal(seen.size, 11, "all pictures differ");
    await choose(page, "style-smooth");
  });

  test("legends explain the colours", {timeout: SLOW}, async () => {
    const {results: [result]} = fileOf("ring");
    await choose(page, "colouring-distance");
    const legend = await page.locator("#legend").textContent();
    assert.ok(
      legend.includes("mm") &&
        legend.includes(`${Number(result.geometry.levels[3].distance.maximum.toPrecision(3))}`),
      legend,
    );
    await choose(page, "colouring-aspect");
    assert.ok((await page.locator("#legend").textContent()).includes("1/3"));
    await choose(page, "colouring-component");
    assert.ok((await page.locator("#legend").textContent()).includes("6 components"));
    await choose(page, "colouring-level");
    assert.equal(await page.locator("#legend li").count(), 4);
    await choose(page, "colouring-plain");
  });

  test("the level slider and the error next to it", {timeout: SLOW}, async () => {
    const {results: [result]} = fileOf("ring");
    await page.locator("#level").focus();
    for (const level of [2, 1, 0]) {
      await changes(page, `level ${level}`, () => page.keyboard.press("ArrowLeft"));
      assert.equal(await state(page, "level"), level);
      const error = result.levels[level].metrics["max-distance"].maximum;
      assert.equal(
        await page.locator("#error").textContent(),
        `error ${Number(error.toPrecision(3))} mm`,
      );
      const expected =
        level === 2
          ? /^Proved: no point of the mesh is farther than 0\.106 mm from the isosurface/
          : /^Errors are sampled, at about 2 points per voxel face/;
      assert.match(await page.locator("#sampling").textContent(), expected);
      assert.ok((await page.locator("#level").getAttribute("aria-valuetext")).includes("mm"));
      assert.equal(await page.locator("#levels tr[aria-current] th").textContent(), `${level}`);
    }
    await page.keyboard.press("End");
    assert.equal(await state(page, "level"), 3);
  });

  test("a cut along each axis, from both sides, and the reset", {timeout: SLOW}, async () => {
    const whole = await picture(page);
    for (const axis of ["x", "y", "z"]) {
      const below = await changes(page, `cut ${axis}`, () => slide(page, `#cut-${axis}`, 0.4));
      const text = await page.locator(`output[for="cut-${axis}"]`).textContent();
      // At first, the side that faces the viewer is removed.
      const [first, second] = axis === "y" ? ["≥ ", "≤ "] : ["≤ ", "≥ "];
      assert.ok(text.startsWith(first), text);
      assert.ok((await page.locator("#legend").textContent()).includes("inside"));
      const above = await changes(page, `the other side of ${axis}`, () =>
        page.locator(`#flip-${axis}`).click(),
      );
      assert.notEqual(above, below);
      assert.ok((await page.locator(`output[for="cut-${axis}"]`).textContent()).startsWith(second));
      await page.locator("#reset").click();
      assert.equal(await picture(page), whole);
      assert.equal(await page.locator(`output[for="cut-${axis}"]`).textContent(), "off");
    }
    // A cut at the lower end of the mesh removes nearly all of it.
    await slide(page, "#cut-z", 0);
    await changes(page, "a cut of nearly all", () => page.locator("#reset").click());
  });

  test("mouse", {timeout: SLOW}, async () => {
    const whole = await picture(page);
    const box = await page.locator("#view").boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const drag = async (button) => {
      await page.mouse.move(x, y);
      await page.mouse.down({button});
      await page.mouse.move(x + 80, y + 50, {steps: 4});
      await page.mouse.up({button});
    };
    await changes(page, "dragging", () => drag("left"));
    assert.equal(await state(page, "zoom"), 1);
    await page.locator("#reset").click();
    assert.equal(await picture(page), whole, "the whole mesh again");
    const before = await page.evaluate(() => window.isoatlas.project(window.isoatlas.centre));
    await changes(page, "dragging with the right button", () => drag("right"));
    const moved = await page.evaluate(() => window.isoatlas.project(window.isoatlas.centre));
    assert.ok(
      Math.abs(moved[0] - before[0] - 80) < 1 && Math.abs(moved[1] - before[1] - 50) < 1,
      "the mesh moves with the mouse",
    );
    await page.locator("#reset").click();
    // The wheel zooms at the position of the mouse.
    const under = await page.evaluate(() =>
      window.isoatlas.project(window.isoatlas.worst.centroid),
    );
    await page.mouse.move(box.x + under[0], box.y + under[1]);
    await changes(page, "the wheel", async () => {
      await page.mouse.wheel(0, -300);
      await page.waitForFunction(() => window.isoatlas.zoom > 1.2);
    });
    const after = await page.evaluate(() =>
      window.isoatlas.project(window.isoatlas.worst.centroid),
    );
    assert.ok(
      Math.hypot(after[0] - under[0], after[1] - under[1]) < 2,
      `expected ${under}, got ${after}`,
    );
    await page.locator("#reset").click();
    assert.equal(await picture(page), whole);
  });

  test("keyboard", {timeout: SLOW}, async () => {
    const whole = await picture(page);
    await page.locator("#view").focus();
    for (const key of [
      "ArrowLeft",
      "ArrowUp",
      "Shift+ArrowRight",
      "Shift+ArrowDown",
      "+",
      "-",
      "[",
      "]",
      "x",
      "y",
      "z",
      "w",
    ])
      await changes(page, key, () => page.keyboard.press(key));
    assert.match(await page.locator("#status").textContent(), /aspect ratio/);
    await page.keyboard.press("0");
    assert.equal(await picture(page), whole);
  });

  test("frames are drawn only when something changes", {timeout: SLOW}, async () => {
    await drawn(page);
    const before = await state(page, "frames");
    await page.waitForTimeout(400);
    assert.equal(await state(page, "frames"), before);
  });

  test("tables contain the data", {timeout: SLOW}, async () => {
    const {
      results: [result],
    } = fileOf("ring");
    assert.deepEqual(
      await rows(page, "#kinds"),
      result.levels[3].kinds.map(({genus, boundary_loops: loops, count}) => [
        `genus ${genus}, ${loops} loop${loops === 1 ? "" : "s"}`,
        `${count}`,
        `${count}`,
        "✓",
      ]),
    );
    const components = await rows(page, "#components");
    assert.equal(components.length, 6);
    assert.deepEqual(components[0].slice(2), ["1", "0"], "the ring is the largest, of genus 1");
    assert.deepEqual(
      components.map((r) => Number(r[1].replaceAll(",", ""))),
      [20736, 6144, 2048, 512, 512, 512],
    );
    assert.deepEqual(
      components.find((r) => r[3] === "2")?.slice(1),
      ["6,144", "0", "2"],
      "the open tube",
    );
    const bins = await page
      .locator("#histogram-numbers tbody tr")
      .evaluateAll((all) =>
        all.map((tr) =>
          [...tr.querySelectorAll("td")].map((cell) =>
            Number(cell.textContent.replaceAll(",", "")),
          ),
        ),
      );
    assert.deepEqual(
      bins,
      result.levels[3].quality.aspect_ratio.histogram.map((n, i) => [
        n,
        result.marching_cubes.histogram[i],
      ]),
    );
    assert.equal(await page.locator("#command").textContent(), result.command);
    assert.ok(
      (await page.locator("section[aria-label=Certificate]").textContent()).includes(
        result.levels[3].vertices.toLocaleString("en"),
      ),
    );
    assert.ok(
      (await page.locator("section[aria-label=Certificate]").textContent()).includes(
        "✓ closed components have the orientation and nesting of the isosurface",
      ),
    );
    assert.equal(await page.locator("#constraints li").count(), 2);
    await page.locator("#parameters summary").click();
    for (const key of [
      ...Object.keys(result.parameters),
      ...Object.keys(result.input),
      ...Object.keys(result.surface),
    ]) {
      assert.equal(
        await page
          .locator("#parameters th", {hasText: new RegExp(`^${key.replaceAll("_", " ")}$`)})
          .count(),
        1,
        key,
      );
    }
  });

  test("copying the command", {timeout: SLOW}, async () => {
    await page.locator("#copy").click();
    await page.waitForFunction(() => document.getElementById("copy").textContent !== "Copy");
  });
});

test("touch: one finger rotates, two pan and zoom", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("ring").path, {
    width: 360,
    height: 740,
    touch: true,
  });
  const session = await page.context().newCDPSession(page);
  const box = await page.locator("#view").boundingBox();
  const at = (dx, dy, id) => ({x: box.x + box.width / 2 + dx, y: box.y + box.height / 2 + dy, id});
  const send = (type, ...touchPoints) =>
    session.send("Input.dispatchTouchEvent", {type, touchPoints});
  await changes(page, "one finger", async () => {
    await send("touchStart", at(0, 0, 1));
    for (const k of [1, 2, 3]) await send("touchMove", at(20 * k, 8 * k, 1));
    await send("touchEnd");
    await drawn(page);
  });
  assert.equal(await state(page, "zoom"), 1);
  assert.equal(await page.evaluate(() => scrollY), 0, "the page does not scroll with it");
  await changes(page, "a pinch", async () => {
    await send("touchStart", at(-20, 0, 1), at(20, 0, 2));
    for (const k of [1, 2, 3])
      await send("touchMove", at(-20 - 10 * k, 0, 1), at(20 + 10 * k, 0, 2));
    await send("touchEnd");
    await drawn(page);
  });
  assert.ok((await state(page, "zoom")) > 1.8, "fingers 2.5 times as far apart");
  const small = await page
    .locator("button:visible, select:visible, input:visible, summary:visible")
    .evaluateAll((all) =>
      all
        .map((e) => ({name: e.id || e.textContent, ...e.getBoundingClientRect().toJSON()}))
        .filter(({width, height}) => width < 40 || height < 40)
        .map(({name, width, height}) => `${name}: ${width} x ${height}`),
    );
  assert.deepEqual(small, [], "all controls are large enough for a finger");
  assert.deepEqual(trouble, []);
  await close();
});

test("light and dark: contrast, and the switch", {timeout: 3 * SLOW}, async () => {
  for (const dark of [false, true]) {
    const {page, trouble, close} = await open(fileOf("ring").path, {dark});
    await page.locator("details").evaluateAll((all) => all.forEach((one) => (one.open = true)));
    const background = () =>
      page.evaluate(() => getComputedStyle(document.querySelector(".stage")).backgroundColor);
    for (const theme of ["first", "other"]) {
      for (const colour of ["plain", "aspect", "level", "component", "distance"]) {
        await choose(page, `colouring-${colour}`);
        const {ratio, text} = await page.evaluate(leastContrast);
        assert.ok(ratio >= 4.5, `${text}: ${ratio.toFixed(2)}`);
      }
      if (theme === "other") break;
      const old = await background();
      const lines = (await choose(page, "style-lines"), await picture(page));
      await page.locator("#theme").click();
      assert.notEqual(await background(), old);
      assert.notEqual(await picture(page), lines);
      assert.equal(await page.locator("#theme").getAttribute("aria-pressed"), `${!dark}`);
    }
    assert.deepEqual(trouble, []);
    await close();
  }
});

test("every control is reached by Tab, and has a name", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("several").path);
  const reached = new Set();
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press("Tab");
    const name = await page.evaluate(() => {
      const e = document.activeElement;
      if (e === document.body) return null;
      return e.type === "radio" ? `[name=${e.name}]` : e.id ? `#${e.id}` : e.textContent;
    });
    if (name === null || reached.has(name)) break;
    reached.add(name);
    const seen = await page.evaluate(() => {
      const e = document.activeElement;
      const outlined = e.type === "radio" ? document.querySelector(`label[for="${e.id}"]`) : e;
      return getComputedStyle(outlined).outlineStyle;
    });
    assert.notEqual(seen, "none", `the focus is visible: ${name}`);
  }
  for (const control of [
    "#result",
    "#theme",
    "#view",
    "#level",
    "[name=style]",
    "[name=colouring]",
    "#cut-x",
    "#flip-x",
    "#cut-y",
    "#cut-z",
    "#worst",
    "#reset",
    "#command",
    "#copy",
  ]) {
    assert.ok(reached.has(control), `${control} is reached: ${[...reached]}`);
  }
  const session = await page.context().newCDPSession(page);
  const {nodes} = await session.send("Accessibility.getFullAXTree");
  const roles = new Set(["button", "slider", "radio", "combobox", "application", "image"]);
  const nameless = nodes
    .filter((n) => !n.ignored && roles.has(n.role?.value) && !n.name?.value)
    .map((n) => n.role.value);
  assert.deepEqual(nameless, []);
  assert.ok(
    nodes.some((n) => n.role?.value === "application" && /level/.test(n.name.value)),
    "the picture has a label",
  );
  assert.equal(await page.locator("[role=status]").count(), 1);
  await close();
});

test("several results", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("several").path);
  await choose(page, "colouring-component");
  const first = await picture(page);
  await page.locator("#result").selectOption("1");
  await page.waitForSelector("html[data-ready='1']");
  assert.notEqual(await picture(page), first);
  assert.equal(await page.locator("h1").textContent(), "second");
  assert.equal((await rows(page, "#levels")).length, 2);
  assert.match(await page.locator("#error").textContent(), /voxels$/);
  await page.locator("#result").selectOption("0");
  await page.waitForSelector("html[data-ready='0']");
  assert.equal(await picture(page), first);
  assert.deepEqual(trouble, []);
  await close();
});

test("missing facts are named", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("bare").path);
  assert.ok(await page.locator("#colouring-distance").isDisabled());
  const words = await page.locator("main").textContent();
  for (const text of [
    "no distance error",
    "does not contain the command",
    "does not contain the parameters",
    "No comparison with marching cubes",
    "does not contain the topology of the isosurface",
    "were not tested",
  ]) {
    assert.ok(words.includes(text), text);
  }
  assert.equal(await page.locator("#error").textContent(), "error not measured");
  assert.equal(await page.locator("#sampling").count(), 0);
  await close();
});

test(
  "the page counts shapes and kinds that a file does not contain",
  {timeout: 2 * SLOW},
  async () => {
    const {page, close} = await open(fileOf("terse").path);
    const {
      results: [expected],
    } = pages.ring();
    const least = (await rows(page, "#levels")).map((r) => r[4]);
    // The last digits differ, because positions in the page are rounded to a grid.
    least.forEach((text, level) =>
      assert.ok(
        Math.abs(Number(text) - expected.levels[level].quality.aspect_ratio.minimum) < 0.005,
        text,
      ),
    );
    assert.deepEqual(
      new Set((await rows(page, "#kinds")).map((r) => r.join())),
      new Set(["genus 1, 0 loops,1,1,✓", "genus 0, 2 loops,1,1,✓", "genus 0, 0 loops,4,4,✓"]),
    );
    assert.ok(
      (await page.locator("section[aria-label=Certificate]").textContent()).includes(
        "no certificate",
      ),
    );
    await close();
  },
);

test("many components: the first 20 and the number of others", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("dust").path);
  assert.equal((await rows(page, "#components")).length, 20);
  assert.match(await page.locator("#rest").textContent(), /11 more/);
  assert.ok(await page.locator("#level").isDisabled(), "one level: nothing to slide");
  await close();
});

test("inverted components and dropped components", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("balanced").path);
  assert.ok(
    (await page.locator("section[aria-label=Certificate]").textContent()).includes(
      "✗ 1 component inverted, or inside another",
    ),
  );
  assert.equal(
    await page.locator("#kept").textContent(),
    "Kept: 1 part in 3 components of 12.5 cubic mm.",
  );
  assert.equal(
    await page.locator("#dropped").textContent(),
    "Dropped: 7 components, the largest of 0.25 cubic mm.",
  );
  await close();
});

test("hostile text stays text", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("hostile").path);
  const {results: [result]} = fileOf("hostile");
  assert.equal(await page.locator("h1").textContent(), result.title);
  assert.equal(await page.locator("#command").textContent(), result.command);
  assert.equal(await page.locator("h1 b, img").count(), 0);
  assert.deepEqual(trouble, []);
  await close();
});

test("far from the origin it looks the same", {timeout: 2 * SLOW}, async () => {
  const near = await open(fileOf("ring").path);
  const far = await open(fileOf("far").path);
  await slide(near.page, "#level", 2);  // the finest of the other
  // Pixels may differ, because positions are rounded differently. Positions and the worst triangle
  // are compared instead.
  const [a, b] = await Promise.all(
    [near, far].map(({page}) =>
      page.evaluate(() => window.isoatlas.project(window.isoatlas.centre)),
    ),
  );
  assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) < 1, `${a} and ${b}`);
  const worst = [await state(near.page, "worst"), await state(far.page, "worst")];
  assert.ok(Math.abs(worst[0].ratio - worst[1].ratio) < 0.01);
  assert.ok(Math.abs(worst[1].centroid[0]) > 9e5, "in the file's coordinates");
  await near.close();
  await far.close();
});

test("with motion allowed, the view moves smoothly to its goal", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("ring").path, {motion: true});
  const whole = await picture(page);
  await page.locator("#worst").click();
  assert.ok(await page.evaluate(() => window.isoatlas.moving || window.isoatlas.zoom > 1));
  await settled(page);
  assert.ok((await state(page, "zoom")) > 1);
  await page.locator("#reset").click();
  await settled(page);
  assert.equal(await picture(page), whole);
  await close();
});

test("without WebGL: a message and all tables", {timeout: 2 * SLOW}, async () => {
  const blind = await chromium.launch({
    ...LAUNCH,
    args: ["--headless=new", "--no-sandbox", "--disable-3d-apis"],
  });
  const {page, trouble, close} = await open(fileOf("ring").path, {in: blind});
  assert.match(await page.locator("[role=alert]").textContent(), /no WebGL 2/);
  assert.equal((await rows(page, "#levels")).length, 4);
  assert.equal((await rows(page, "#components")).length, 6);
  await slide(page, "#level", 0);
  assert.equal(await page.locator("#levels tr[aria-current] th").textContent(), "0");
  assert.deepEqual(trouble.filter((text) => !text.includes("WebGL")), []);
  await close();
  await blind.close();
});

test("a broken page shows an error", {timeout: 2 * SLOW}, async () => {
  const html = readFileSync(fileOf("ring").path, "utf8").replace(
    /(id="isoatlas-geometry">.{1000})[^<]*/,
    "$1",
  );
  const path = join(folder, "broken.html");
  writeFileSync(path, html);
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(pathToFileURL(path).href);
  await page.waitForSelector("[role=alert]");
  assert.match(await page.locator("[role=alert]").textContent(), /cannot be shown: its geometry/);
  await context.close();
});

test("100,000 triangles open in time, in a small file", {timeout: 4 * SLOW}, async () => {
  const {path, results: [result]} = fileOf("large");
  const {triangles} = result.levels[result.levels.length - 1];
  assert.ok(triangles >= 100_000);
  const bytes = statSync(path).size;
  assert.ok(bytes < 5e6, `${bytes} bytes`);
  const times = [];
  for (let k = 0; k < 3; ++k) {
    const {page, trouble, close} = await open(path);
    times.push(await page.evaluate(() => performance.getEntriesByName("ready")[0].startTime));
    assert.deepEqual(trouble, []);
    await close();
  }
  console.log(
    `${triangles.toLocaleString("en")} triangles, ${(bytes / 1e6).toFixed(2)} MB: ` +
      `ready after ${times.map((t) => Math.round(t)).join(", ")} ms; target: 2000`,
  );
  // The target is for an idle machine; this test detects an order of magnitude.
  assert.ok(Math.min(...times) < 8000, `${times}`);
});

test("screenshots for visual inspection", {timeout: 10 * SLOW}, async () => {
  const path = process.env.ISOATLAS_PAGE ? resolve(process.env.ISOATLAS_PAGE) : fileOf("ring").path;
  const take = async (name, options, ...ids) => {
    const {page, close} = await open(path, options);
    for (const id of ids) {
      if (id.startsWith("#")) await page.locator(id).click();
      else if (id.includes("=")) await slide(page, `#${id.split("=")[0]}`, id.split("=")[1]);
      else if (await page.locator(`#${id}`).isEnabled()) await choose(page, id);
    }
    await drawn(page);
    await page.screenshot({
      path: join(screenshots, `${name}.png`),
      fullPage: options.whole ?? false,
    });
    await close();
  };
  await take("1440-light-smooth", {});
  await take("1440-dark-hidden-line", {dark: true}, "style-lines");
  await take("1440-light-both", {}, "style-split");
  for (const colour of ["aspect", "distance", "component", "level"])
    await take(`1440-light-${colour}`, {}, `colouring-${colour}`);
  await take("1440-dark-level-lines", {dark: true}, "colouring-level", "style-lines");
  await take("1440-light-cut", {}, "cut-y=0.55");
  await take("1440-light-worst", {}, "style-lines", "colouring-aspect", "#worst");
  await take("1440-light-whole-page", {whole: true});
  await take("360-light", {width: 360, height: 740, touch: true, whole: true});
  await take(
    "360-dark-aspect",
    {width: 360, height: 740, touch: true, dark: true},
    "colouring-aspect",
  );
});
