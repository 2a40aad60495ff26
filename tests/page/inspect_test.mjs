// SPDX-License-Identifier: Apache-2.0
// Looking closely: values under the pointer, measuring, components, filled cuts, views, links.
import assert from "node:assert/strict";
import {test} from "node:test";

import {
  SLOW,
  SMALL,
  capColour,
  changes,
  choose,
  clickAt,
  colourAt,
  drawn,
  fileOf,
  front,
  open,
  pickAt,
  picture,
  pixelOf,
  placeOf,
  rows,
  settled,
  slide,
  state,
} from "./browser.mjs";

const near = (a, b, by) => Math.hypot(...a.map((v, i) => v - b[i])) <= by;
const isColour = (found, wanted) =>
  found[3] === 255 && found.slice(0, 3).every((v, i) => Math.abs(v - wanted[i]) <= 3);
const letters = async (page) =>
  (await page.locator(".axes text").allTextContents()).sort().join("");

const numberOf = (text) => Number(text.replaceAll(",", ""));

test("coordinates, error and component under the pointer", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("balls").path);
  await front(page);
  // A vertex of the ball is nearest to the viewer.
  const picked = await pickAt(page, [0, -20, 0]);
  assert.ok(near(picked.point, [0, -20, 0], 0.1), `${picked.point}`);
  const {x, y} = await placeOf(page, [0, -20, 0]);
  await page.mouse.move(x, y);
  await page.waitForFunction(() => document.getElementById("readout").textContent !== "");
  const words = await page.locator("#readout").textContent();
  const found = words.match(
    /^\((.+), (.+), (.+)\) mm LPS · error here at most (.+) mm · component 1$/,
  );
  assert.ok(found, words);
  assert.ok(near(found.slice(1, 4).map(Number), [0, -20, 0], 0.2), words);
  const {results: [result]} = fileOf("balls");
  const {maximum} = result.geometry.levels[0].distance;
  assert.ok(Number(found[4]) > 0 && Number(found[4]) <= maximum * 1.01, words);
  // Beside the mesh it is empty.
  const beside = await placeOf(page, [28, 0, 40]);
  await page.mouse.move(beside.x, beside.y);
  await page.waitForFunction(() => document.getElementById("readout").textContent === "");
  assert.deepEqual(trouble, []);
  await close();
});

test("what is measured between two clicks", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("balls").path);
  await front(page);
  await page.locator("#measure").click();
  assert.equal(await page.locator("#measure").getAttribute("aria-pressed"), "true");
  await clickAt(page, [28, 0, 40]);
  assert.match(await page.locator("#status").textContent(), /no mesh/);
  await clickAt(page, [0, -20, 0]);
  assert.match(await page.locator("#status").textContent(), /^First point/);
  assert.equal(await page.locator(".ruler circle").count(), 1);
  await clickAt(page, [40, -10, 0]);
  const {points, distance} = await state(page, "measured");
  assert.ok(near(points[0], [0, -20, 0], 0.2) && near(points[1], [40, -10, 0], 0.2), `${points}`);
  assert.ok(Math.abs(distance - Math.hypot(40, 10)) < 0.3, `${distance}`);
  assert.equal(
    await page.locator(".ruler text").textContent(),
    `${Number(distance.toPrecision(4))} mm`,
  );
  assert.match(await page.locator("#status").textContent(), /^Distance 41\.\d+ mm, from \(/);
  // The marks are at the points, also after the view has moved.
  await page.locator("#view").focus();
  await page.keyboard.press("ArrowLeft");
  await drawn(page);
  const marks = await page
    .locator(".ruler circle")
    .evaluateAll((all) => all.map((one) => [one.cx.baseVal.value, one.cy.baseVal.value]));
  for (const [i, point] of points.entries()) {
    const at = await page.evaluate((p) => window.isoatlas.project(p), point);
    assert.ok(near(marks[i], at, 0.2), `${marks[i]} is not ${at}`);
  }
  await page.keyboard.press("Escape");
  assert.equal(await page.locator(".ruler circle").count(), 0);
  assert.equal(await page.locator("#measure").getAttribute("aria-pressed"), "false");
  // With the keyboard alone: the points are at the cross.
  await front(page);
  await page.locator("#view").focus();
  await page.keyboard.press("m");
  assert.equal(await page.locator(".ruler path").count(), 1, "the cross");
  for (let k = 0; k < 2; ++k) {
    for (let step = 0; step < 3; ++step) await page.keyboard.press("Shift+ArrowRight");
    await page.keyboard.press("Enter");
  }
  assert.equal((await state(page, "measured")).points.length, 2);
  assert.deepEqual(trouble, []);
  await close();
});

test("touch selects and measures, too", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("balls").path, {
    width: 360,
    height: 740,
    touch: true,
  });
  await page.locator("#view-front").tap();
  await settled(page);
  const tap = async (point) => {
    await page.locator("#view").scrollIntoViewIfNeeded();
    const {x, y} = await placeOf(page, point);
    await page.touchscreen.tap(x, y);
    await drawn(page);
  };
  await tap([0, -20, 0]);
  assert.match(await page.locator("#readout").textContent(), /mm LPS · error here at most .* mm/);
  assert.equal(await state(page, "selected"), 0);
  await page.locator("#hide-selected").tap();
  assert.deepEqual(await state(page, "hidden"), [0]);
  await page.locator("#show-all").tap();
  await page.locator("#measure").tap();
  for (const point of [[0, -20, 0], [40, -10, 0]]) await tap(point);
  const {distance} = await state(page, "measured");
  assert.ok(Math.abs(distance - Math.hypot(40, 10)) < 1, `${distance}`);
  const {scroll, client} = await page.evaluate(() => ({
    scroll: document.documentElement.scrollWidth,
    client: document.documentElement.clientWidth,
  }));
  assert.ok(scroll <= client, "nothing overflows");
  assert.deepEqual(trouble, []);
  await close();
});

test("extent, area and volume of each component", {timeout: 2 * SLOW}, async () => {
  for (const name of ["balls", "inverted"]) {
    const {page, close} = await open(fileOf(name).path);
    const table = await rows(page, "#components");
    const of = (i) => ({numbers: table[2 * i].map(numberOf), more: table[2 * i + 1][0]});
    const radii = [20, 8, 10];
    for (const [i, radius] of radii.entries()) {
      const {numbers: [, , area, volume], more} = of([0, 1, 3][i]);
      // The polyhedra are inscribed, and have up to 8 % less volume.
      const share = {area: area / (4 * Math.PI * radius ** 2)};
      share.volume = volume / ((4 / 3) * Math.PI * radius ** 3);
      const least = [0.97, 0.95, 0.85][i];
      assert.ok(share.area > least && share.area < 1, `${radius}: ${share.area}`);
      assert.ok(share.volume > least - 0.02 && share.volume < 1, `${radius}: ${share.volume}`);
      assert.match(more, new RegExp(`^${2 * radius} × ${2 * radius} × ${2 * radius} mm`));
      assert.equal(/cavity/.test(more), radius === 8, more);
    }
    assert.equal(table[4][3], "–", "the open tube encloses nothing");
    await close();
  }
});

test("components are hidden and isolated", {timeout: 3 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("balls").path);
  await front(page);
  const whole = await picture(page);
  const small = [40, -10, 0];
  await clickAt(page, small);
  assert.equal(await state(page, "selected"), 3);
  const selection = await page.locator("#selection").textContent();
  assert.match(selection, /^Component 4: 128 triangles, 20 × /);
  assert.equal(await page.locator("#components tr.selected").count(), 2);
  await changes(page, "hiding", () => page.locator("#hide-selected").click());
  assert.equal(await pickAt(page, small), null);
  assert.deepEqual(await state(page, "hidden"), [3]);
  assert.equal(await page.locator("#shown-4").isChecked(), false);
  await page.locator("#show-all").click();
  assert.equal(await picture(page), whole);
  // In the list; the focus stays.
  await changes(page, "only one", () => page.locator("#only-3").click());
  assert.equal(await page.evaluate(() => document.activeElement.id), "only-3");
  assert.equal(await pickAt(page, [0, -20, 0]), null);
  assert.equal((await pickAt(page, [0, -6, 40])).component, 2);
  await changes(page, "two", () => page.locator("#shown-1").click());
  assert.deepEqual(await state(page, "hidden"), [1, 3]);
  // A view from a side fits what is shown.
  await page.locator("#only-3").click();
  const zoom = await state(page, "zoom");
  await page.locator("#view-right").click();
  await settled(page);
  assert.ok((await state(page, "zoom")) > 1.5 * zoom);
  const {width, height} = await page.locator("#view").boundingBox();
  assert.ok(near(await pixelOf(page, [0, 0, 40]), [width / 2, height / 2], 3), "at the centre");
  // With the keyboard: what is at the centre of the picture.
  await page.locator("#view").focus();
  await page.keyboard.press("a");
  assert.deepEqual(await state(page, "hidden"), []);
  await front(page);
  await page.locator("#view").focus();
  for (let step = 0; step < 4; ++step) await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("Enter");
  assert.equal(await state(page, "selected"), 0);
  await page.keyboard.press("i");
  assert.deepEqual(await state(page, "hidden"), [1, 2, 3]);
  await page.keyboard.press("h");
  assert.deepEqual(await state(page, "hidden"), [1, 2, 3, 0]);
  await page.keyboard.press("0");
  assert.deepEqual(await state(page, "hidden"), []);
  assert.deepEqual(trouble, []);
  await close();
});

test("a hidden component stays hidden in other levels", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("reordered").path);
  await front(page);
  const [ball, ring] = [[40, -5, 0], [0, -20, 0]];
  assert.equal((await pickAt(page, ball)).component, 0, "it has the most triangles in level 2");
  await page.locator("#shown-1").click();
  await slide(page, "#level", 0);
  assert.equal(await page.locator("#shown-1").isChecked(), false);
  assert.equal(await pickAt(page, ball), null);
  assert.equal((await pickAt(page, ring)).component, 1);
  assert.deepEqual(trouble, []);
  await close();
});

test("cuts are filled where they are inside", {timeout: 4 * SLOW}, async () => {
  const [solid, cavity, tube, outside] = [[14, 0, 0], [0, 0, 0], [0, 0, 40], [24, 0, 0]];
  for (const name of ["balls", "inverted"]) {
    const {page, trouble, close} = await open(fileOf(name).path, SMALL);
    const cap = await capColour(page);
    const y = (at) => (at + 20) / 40;  // the slider's value for a cut in the box from -20 to 20
    await front(page);
    assert.ok(!isColour(await colourAt(page, solid), cap));
    await slide(page, "#cut-y", y(0));
    assert.ok(isColour(await colourAt(page, solid), cap), `${await colourAt(page, solid)}`);
    assert.ok(isColour(await colourAt(page, tube), cap), "open ends are closed flat");
    const inCavity = await colourAt(page, cavity);
    assert.ok(!isColour(inCavity, cap) && inCavity[3] === 255, "the wall of the cavity");
    assert.equal((await colourAt(page, outside))[3], 0, "the background");
    assert.match(await page.locator("#legend").textContent(), /cut$/);
    // The value under the pointer is that of the cut.
    const onCut = await pickAt(page, solid);
    assert.equal(onCut.triangle, null);
    assert.ok(near(onCut.point, solid, 1e-3), `${onCut.point}`);
    const wall = await pickAt(page, cavity);
    assert.ok(near(wall.point, [0, 8, 0], 0.2), `${wall.point}`);
    assert.equal(await pickAt(page, outside), null);
    // A hidden component is not filled, but that inside it.
    await page.locator("#shown-1").click();
    assert.equal((await colourAt(page, solid))[3], 0);
    await page.locator("#show-all").click();
    // Two cuts: each removes a part of the other.
    await slide(page, "#cut-x", 0.5);
    await page.evaluate(() => document.getElementById("cut-x").value);
    const corner = await colourAt(page, [30, 0, 5]);
    assert.equal(corner[3], 0, "removed by the second cut");
    assert.ok(isColour(await colourAt(page, [-14, 0, 0]), cap));
    await slide(page, "#cut-x", 0);
    // From behind, the cut is not visible.
    await page.locator("#view-back").click();
    await settled(page);
    assert.ok(!isColour(await colourAt(page, solid), cap));
    await front(page);
    // Along the tube, the line of sight leaves it through its lower, closed end.
    await slide(page, "#cut-y", 0);
    await slide(page, "#cut-z", 0.145);
    await page.locator("#view-top").click();
    await settled(page);
    assert.ok(isColour(await colourAt(page, [2, 1, 40]), cap));
    assert.equal((await pickAt(page, [2, 1, 40])).triangle, null);
    await slide(page, "#cut-z", 0);
    await slide(page, "#cut-y", y(0));
    await front(page);
    // Hollow.
    await changes(page, "not filled", () => page.locator("#fill-cuts").click());
    assert.ok(!isColour(await colourAt(page, solid), cap));
    assert.match(await page.locator("#legend").textContent(), /inside$/);
    assert.notEqual((await pickAt(page, solid)).triangle, null);
    assert.deepEqual(trouble, []);
    await close();
  }
});

test("the sides of a patient, or axes", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("several").path, SMALL);
  const toRight = async (direction) => {
    const [[x], [at]] = await page.evaluate(
      (d) => [
        window.isoatlas.project(window.isoatlas.centre.map((v, i) => v + d[i])),
        window.isoatlas.project(window.isoatlas.centre),
      ],
      direction,
    );
    return Math.sign(Math.round(100 * (x - at)));
  };
  assert.equal(await letters(page), "AILPRS");
  const [left, posterior] = [[1, 0, 0], [0, 1, 0]];
  for (const [side, towardsLeft, towardsBack] of [
    ["front", 1, 0],
    ["back", -1, 0],
    ["left", 0, 1],
    ["right", 0, -1],
    ["top", -1, 0],
    ["bottom", 1, 0],
  ]) {
    await page.locator(`#view-${side}`).click();
    await settled(page);
    assert.equal(await toRight(left), towardsLeft, `${side}: left`);
    assert.equal(await toRight(posterior), towardsBack, `${side}: posterior`);
  }
  assert.equal(await page.locator("#view-front").textContent(), "Front A");
  await page.locator("#result").selectOption("1");
  await page.waitForSelector("html[data-ready='1']");
  await drawn(page);
  assert.equal(await letters(page), "xyz");
  assert.equal(await page.locator("#view-front").textContent(), "Front −y");
  assert.deepEqual(trouble, []);
  await close();
});

test("a link restores the view", {timeout: 3 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("several").path, SMALL);
  await slide(page, "#level", 1);
  await choose(page, "style-lines");
  await choose(page, "colouring-aspect");
  await slide(page, "#cut-z", 0.3);
  await page.locator("#flip-z").click();
  await page.locator("#shown-2").click();
  await page.locator("#view-left").click();
  await settled(page);
  await page.locator("#view").focus();
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("+");
  await page.locator("#copy-view").click();
  await page.waitForFunction(() => document.getElementById("status").textContent !== "");
  const view = await picture(page);
  const hash = await page.evaluate(() => location.hash);
  assert.match(hash, /level=2/);
  const {page: again, trouble: more, close: done} = await open(
    fileOf("several").path, {...SMALL, hash});
  await drawn(again);
  assert.equal(await picture(again), view);
  assert.deepEqual(await state(again, "hidden"), [1]);
  // Followed inside the page; nonsense has no effect.
  await again.locator("#reset").click();
  assert.notEqual(await picture(again), view);
  for (const other of ["#nonsense", "#target=1_2_x&rotation=0_0_0_0&zoom=-1", hash])
    await again.evaluate((to) => void (location.hash = to), other);
  await again.waitForFunction(() => window.isoatlas.hidden.length === 1);
  await drawn(again);
  assert.equal(await picture(again), view);
  assert.deepEqual([...trouble, ...more], []);
  await close();
  await done();
});

test("full screen", {timeout: 2 * SLOW}, async () => {
  const {page, trouble, close} = await open(fileOf("ring").path);
  await page.locator("#full-screen").click();
  await page.waitForFunction(() => document.fullscreenElement !== null);
  await page.waitForFunction(
    () => document.querySelector(".stage").getBoundingClientRect().width >= innerWidth - 1,
  );
  await page.waitForSelector("#full-screen[aria-pressed=true]");
  await page.locator("#view").focus();
  await page.keyboard.press("f");
  await page.waitForFunction(() => document.fullscreenElement === null);
  await page.waitForSelector("#full-screen[aria-pressed=false]");
  assert.deepEqual(trouble, []);
  await close();
});

test("levels are counted from 1", {timeout: 2 * SLOW}, async () => {
  const {page, close} = await open(fileOf("ring").path);
  const ticks = await page.locator(".track .ticks span").allTextContents();
  assert.deepEqual(ticks, ["1", "2", "3", "4"]);
  assert.match(await page.locator("#level-text").textContent(), /^4 of 4 · /);
  for (const level of [0, 3]) {
    await slide(page, "#level", level);
    await page.locator("#worst").click();
    const words = (await page.locator("main").textContent()).match(/level \d+/gi);
    assert.deepEqual(new Set(words.map((w) => w.toLowerCase())), new Set([`level ${level + 1}`]));
  }
  await close();
  // Of a .stl, only the finest level is known: it has the same number everywhere.
  const {page: one, close: done} = await open(fileOf("finest").path);
  assert.match(await one.locator("#level-text").textContent(), /^2 of 2 · /);
  assert.equal((await rows(one, "#levels"))[0][0], "2");
  assert.match(await one.locator("#missing-levels").textContent(), /^1 coarser level is not/);
  await done();
});
