// SPDX-License-Identifier: Apache-2.0
// Controls: mouse, touch, keyboard, themes.
import assert from "node:assert/strict";
import {after, before, describe, test} from "node:test";

import {
  SLOW,
  SMALL,
  fileOf,
  open,
  picture,
  state,
  drawn,
  settled,
  choose,
  rows,
  leastContrast,
  slide,
  changes,
} from "./browser.mjs";

describe("controls", () => {
  let page;
  let trouble;
  let close;
  before(async () => {
    ({page, trouble, close} = await open(fileOf("ring").path, SMALL));
  });
  after(async () => {
    assert.deepEqual(trouble, []);
    await close();
  });

  test("style and colouring", {timeout: SLOW}, async () => {
    let last = await picture(page);
    const seen = new Set([last]);
    const differs = async (what, act) => seen.add((last = await changes(page, what, act, last)));
    for (const style of ["split", "lines"]) {
      await differs(style, () => choose(page, `style-${style}`));
      assert.equal(await state(page, "style"), style);
    }
    for (const style of ["smooth", "lines"]) {
      await choose(page, `style-${style}`);
      last = await picture(page);
      for (const colour of ["aspect", "distance", "component", "level"]) {
        await differs(colour, () => choose(page, `colouring-${colour}`));
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
    let last = await picture(page);
    for (const level of [2, 1, 0]) {
      const act = () => page.keyboard.press("ArrowLeft");
      last = await changes(page, `level ${level}`, act, last);
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
      assert.equal(await page.locator("#levels tr[aria-current] th").textContent(), `${level + 1}`);
    }
    await page.keyboard.press("End");
    assert.equal(await state(page, "level"), 3);
  });

  test("a cut along each axis, from both sides, and the reset", {timeout: SLOW}, async () => {
    const whole = await picture(page);
    for (const axis of ["x", "y", "z"]) {
      const cut = () => slide(page, `#cut-${axis}`, 0.4);
      const below = await changes(page, `cut ${axis}`, cut, whole);
      const text = await page.locator(`output[for="cut-${axis}"]`).textContent();
      // At first, the side that faces the viewer is removed.
      const [first, second] = axis === "y" ? ["≥ ", "≤ "] : ["≤ ", "≥ "];
      assert.ok(text.startsWith(first) && text.endsWith(" mm"), text);
      assert.ok((await page.locator("#legend").textContent()).includes("cut"));
      const flip = () => page.locator(`#flip-${axis}`).click();
      await changes(page, `the other side of ${axis}`, flip, below);
      assert.ok((await page.locator(`output[for="cut-${axis}"]`).textContent()).startsWith(second));
      await page.locator("#reset").click();
      assert.equal(await picture(page), whole);
      assert.equal(await page.locator(`output[for="cut-${axis}"]`).textContent(), "off");
    }
    // All sliders start at the left, where nothing is removed; at the right, nearly all is.
    assert.deepEqual(
      await page.locator(".cut input").evaluateAll((all) => all.map((input) => input.value)),
      ["0", "0", "0"],
    );
    await slide(page, "#cut-z", 1);
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
    await changes(page, "dragging", () => drag("left"), whole);
    assert.equal(await state(page, "zoom"), 1);
    await page.locator("#reset").click();
    assert.equal(await picture(page), whole, "the whole mesh again");
    const before = await page.evaluate(() => window.isoatlas.project(window.isoatlas.centre));
    await changes(page, "dragging with the right button", () => drag("right"), whole);
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
    let last = whole;
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
      "1",
      "2",
      "3",
      "4",
      "5",
      "6",
      "w",
    ])
      last = await changes(page, key, () => page.keyboard.press(key), last);
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
    const components = (await rows(page, "#components")).filter((r) => r.length > 1);
    const more = (await rows(page, "#components")).filter((r) => r.length === 1).map(([t]) => t);
    assert.equal(components.length, 6);
    assert.match(more[0], /genus 1$/, "the ring is the largest");
    assert.deepEqual(
      components.map((r) => Number(r[1].replaceAll(",", ""))),
      [20736, 6144, 2048, 512, 512, 512],
    );
    assert.match(more[1], /genus 0 · open: 2 loops$/, "the open tube");
    assert.equal(components[1][3], "–", "it encloses no volume");
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
    assert.deepEqual(
      await page.locator("#requested li, #defaults li").allTextContents(),
      [
        "✓ max-distance ≤ 0.0266 mm: 0.0263 mm",
        "– min-aspect ≥ 0.333: 0.31 (not reached) – at 178 places the volume is too coarse for " +
          "this bound; --supersample 2 makes it finer",
      ],
    );
    assert.equal(await page.locator("#defaults .bad").count(), 0, "a default is no failure");
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
        // The label of a checkbox can be tapped, too.
        .map((e) => ({
          name: e.id || e.textContent,
          ...((e.type === "checkbox" && e.closest("label")) || e).getBoundingClientRect().toJSON(),
        }))
        .filter(({width, height}) => width < 40 || height < 40)
        .map(({name, width, height}) => `${name}: ${width} x ${height}`),
    );
  assert.deepEqual(small, [], "all controls are large enough for a finger");
  assert.deepEqual(trouble, []);
  await close();
});

test("light and dark: contrast, and the switch", {timeout: 3 * SLOW}, async () => {
  for (const dark of [false, true]) {
    const {page, trouble, close} = await open(fileOf("ring").path, {...SMALL, dark});
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
  const {page, close} = await open(fileOf("several").path, SMALL);
  const reached = new Set();
  for (let i = 0; i < 100; ++i) {
    await page.keyboard.press("Tab");
    const name = await page.evaluate(() => {
      const e = document.activeElement;
      if (e === document.body || e.dataset.reached) return null;
      e.dataset.reached = "yes";
      return e.type === "radio" ? `[name=${e.name}]` : e.id ? `#${e.id}` : e.textContent;
    });
    if (name === null) break;
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
    "#fill-cuts",
    "#full-screen",
    "#view-front",
    "#view-bottom",
    "#measure",
    "#worst",
    "#reset",
    "#save-picture",
    "#save-mesh",
    "#format",
    "#copy-view",
    "#shown-1",
    "#only-1",
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

test("with motion allowed, the view moves smoothly to its goal", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("ring").path, {...SMALL, motion: true});
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
