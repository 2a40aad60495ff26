// SPDX-License-Identifier: Apache-2.0
// The page of `isoatlas view` with a made-up server: controls, and faults of the server.
import assert from "node:assert/strict";
import {after, before, describe, test} from "node:test";

import {drawn, leastContrast, LAUNCH, settled, SLOW, state} from "./browser.mjs";
import {chromium} from "./modules.mjs";
import {isBlue, meshPixels, openView, option, placeOfSample, sliceColours, type, upToDate}
  from "./view_browser.mjs";
import {serveVolume} from "./view_server.mjs";

/** Opens the page of a volume; both end after `use`. */
async function viewing(name, use, {faults = {}, ...options} = {}) {
  const server = await serveVolume(name, faults);
  const {page, trouble, close} = await openView(server.address, options);
  try {
    await use(page, server, trouble);
    assert.deepEqual(trouble, []);
  } finally {
    await close();
    await server.stop();
  }
}

const meshes = (server) => server.received.filter(({path}) => path === "mesh");
const lastMesh = (server) => Object.fromEntries(meshes(server).at(-1).options);

test("the volume, its slices and its mesh", {timeout: 4 * SLOW}, async () => {
  for (const [width, dark] of [[1440, false], [1440, true], [360, false], [360, true]]) {
    await viewing("ball", async (page) => {
      await upToDate(page);
      assert.equal(await page.title(), "ball.nrrd – isoatlas view");
      assert.match(await page.locator("header p").textContent(), /64 × 48 × 40 float32/);
      assert.ok(await page.evaluate(() =>
        document.documentElement.scrollWidth <= document.documentElement.clientWidth), "no scroll");
      const least = await page.evaluate(leastContrast);
      assert.ok(least.ratio >= 4.5, JSON.stringify(least));
      assert.ok((await meshPixels(page)) > 0.1);
      assert.match(await page.locator("#mesh-line").textContent(),
        /^Coarse mesh: [\d,]+ triangles, 1 component, certified, 0\.01 s\.$/);
    }, {width, dark, height: width < 500 ? 740 : 900, touch: width < 500});
  }
});

describe("slices", () => {
  let server, page, trouble, close;
  before(async () => {
    server = await serveVolume("ball");
    ({page, trouble, close} = await openView(server.address));
    await upToDate(page);
    await page.locator("#cross").uncheck();
  });
  after(async () => {
    assert.deepEqual(trouble, []);
    await close();
    await server.stop();
  });

  test("the isoline is where the samples are", {timeout: SLOW}, async () => {
    // A ball around (31.5, 23.5, 19.5); slices at 32, 24 and 20.
    for (const isovalue of [6, 12]) {
      await type(page, "#isovalue", isovalue);
      await page.locator("#tint").uncheck();
      const r = Math.sqrt((20 - isovalue) ** 2 - 0.5 ** 2);
      const centre = [31.5, 23.5, 19.5];
      for (const axis of [0, 1, 2]) {
        const [u, v] = [0, 1, 2].filter((a) => a !== axis);
        const at = (radius, angle) => {
          const p = [...centre];
          p[u] += radius * Math.cos(angle);
          p[v] += radius * Math.sin(angle);
          return p;
        };
        const angles = [0.3, 1.1, 2, 2.9, 4, 5.5];
        const radii = [r, r - 1, r + 1];
        const samples = radii.flatMap((radius) => angles.map((angle) => at(radius, angle)));
        const colours = await sliceColours(page, axis, samples);
        for (const [n, colour] of colours.entries()) {
          const isOnLine = n < angles.length;
          assert.equal(isBlue(colour), isOnLine, `${axis} ${samples[n]}: ${colour}`);
        }
      }
      await page.locator("#tint").check();
      const [inside, outside] = await sliceColours(page, 2, [[36, 23, 20], [60, 23, 20]]);
      assert.ok(isBlue(inside) && !isBlue(outside), "the inside is tinted");
    }
    await page.locator("#isoline").uncheck();
    await page.locator("#tint").uncheck();
    const r = Math.sqrt(8 ** 2 - 0.5);
    assert.ok(!isBlue((await sliceColours(page, 2, [[31.5 + r, 23.5, 20]]))[0]), "no isoline");
    await page.locator("#isoline").check();
  });

  test("slider, keyboard and wheel scroll", {timeout: SLOW}, async () => {
    const position = () => state(page, "position");
    await page.locator("#slice-z-index").focus();
    await page.keyboard.press("ArrowRight");
    assert.deepEqual(await position(), [32, 24, 21]);
    await page.locator("#slice-z").focus();
    for (const [key, index] of [["ArrowUp", 22], ["ArrowDown", 21], ["PageUp", 31],
      ["ArrowLeft", 30], ["Home", 0], ["ArrowDown", 0], ["End", 39]]) {
      await page.keyboard.press(key);
      assert.equal((await position())[2], index, key);
    }
    assert.match(await page.locator('[data-view="slice-z"] output').first().textContent(),
      /z = 39 of 0 to 39/);
    const {x, y} = await placeOfSample(page, 1, [20, 24, 20]);
    await page.mouse.move(x, y);
    await page.keyboard.down("Shift");
    await page.mouse.wheel(0, 100);
    await page.keyboard.up("Shift");
    assert.equal((await position())[1], 23);
  });

  test("a click moves the other slices; the pointer has a value", {timeout: SLOW}, async () => {
    const at = await placeOfSample(page, 2, [40, 30, 0]);
    await page.mouse.move(at.x, at.y);
    await page.mouse.click(at.x, at.y);
    assert.deepEqual((await state(page, "position")).slice(0, 2), [40, 30]);
    await page.locator("#slice-z").focus();
    for (let k = 0; k < 4; ++k) await page.keyboard.press("PageDown");
    await page.waitForFunction(() => !document.querySelector("[aria-busy=true]"));
    await page.mouse.move(at.x + 1, at.y);
    const value = 20 - Math.hypot(40 - 31.5, 30 - 23.5, 19.5);
    assert.equal(await page.locator("#slice-z-readout").textContent(),
      `(40, 30, 0) value ${Number(value.toPrecision(6))} · (40, 30, 0)`);
  });

  test("the value under the pointer follows the slice", {timeout: SLOW}, async () => {
    const readout = page.locator("#slice-y-readout");
    const valueOf = (i, j, k) =>
      Number((20 - Math.hypot(i - 31.5, j - 23.5, k - 19.5)).toPrecision(6));
    const shows = (i, j, k) =>
      page.waitForFunction((text) =>
        document.querySelector("#slice-y-readout").textContent === text,
      `(${i}, ${j}, ${k}) value ${valueOf(i, j, k)} · (${i}, ${j}, ${k})`);
    const {x, y} = await placeOfSample(page, 1, [20, 0, 12]);
    await page.locator("#slice-y").focus();
    await page.mouse.move(x, y);
    const [, j] = await state(page, "position");
    await shows(20, j, 12);
    server.faults.lateSlices = 300;
    await page.keyboard.press("PageDown");
    assert.match(await readout.textContent(), new RegExp(`^\\(20, ${j - 10}, 12\\) \\(`));
    await shows(20, j - 10, 12);
    server.faults.lateSlices = 0;
    await page.keyboard.down("Shift");
    await page.mouse.wheel(0, -100);
    await page.keyboard.up("Shift");
    await shows(20, j - 9, 12);
    // Zoomed about the middle and panned, another sample is there.
    const drag = async () => {
      await page.mouse.move(x - 40, y - 10);
      await page.mouse.down();
      await page.mouse.move(x, y, {steps: 3});
      await page.mouse.up();
    };
    for (const key of ["+", "+", "+", "+", "Shift+ArrowRight", "drag"]) {
      await (key === "drag" ? drag() : page.keyboard.press(key));
      const text = await readout.textContent();
      const [i, , k] = text.match(/\d+/g).map(Number);
      const at = await placeOfSample(page, 1, [i, 0, k]);
      const next = await placeOfSample(page, 1, [i + 1, 0, k + 1]);
      assert.ok(Math.abs(at.x - x) <= Math.abs(next.x - at.x) / 2 + 0.5, `${key}: ${text}`);
      assert.ok(Math.abs(at.y - y) <= Math.abs(next.y - at.y) / 2 + 0.5, `${key}: ${text}`);
    }
    await page.keyboard.press("0");
    await shows(20, j - 9, 12);
    await page.mouse.move(1, 1);
    assert.equal(await readout.textContent(), "");
    await page.keyboard.press("PageUp");
    assert.equal(await readout.textContent(), "");
  });

  test("wheel, drag, keys and double click", {timeout: SLOW}, async () => {
    const where = () => placeOfSample(page, 2, [10, 10, 0]);
    const whole = await where();
    await page.mouse.move(whole.x, whole.y);
    await page.mouse.wheel(0, -300);
    const zoomed = await where();
    assert.ok(Math.hypot(zoomed.x - whole.x, zoomed.y - whole.y) < 1, "zooms at the pointer");
    const far = await placeOfSample(page, 2, [20, 10, 0]);
    await page.mouse.down();
    await page.mouse.move(whole.x + 30, whole.y + 20, {steps: 3});
    await page.mouse.up();
    const moved = await where();
    assert.ok(Math.abs(moved.x - zoomed.x - 30) < 1.5 && Math.abs(moved.y - zoomed.y - 20) < 1.5);
    assert.ok(far.x - zoomed.x > 60);
    await page.locator("#slice-z").focus();
    await page.keyboard.press("Shift+ArrowRight");
    assert.ok((await where()).x < moved.x - 20);
    await page.mouse.dblclick(whole.x, whole.y);
    assert.deepEqual(await where(), whole);
    await page.keyboard.press("+");
    assert.notDeepEqual(await where(), whole);
    await page.keyboard.press("0");
    assert.deepEqual(await where(), whole);
  });

  test("window and level: right button and numbers", {timeout: SLOW}, async () => {
    const before = await state(page, "range");
    const {x, y} = await placeOfSample(page, 1, [20, 0, 20]);
    await page.mouse.move(x, y);
    await page.mouse.down({button: "right"});
    await page.mouse.move(x + 60, y, {steps: 3});
    await page.mouse.up({button: "right"});
    const after = await state(page, "range");
    assert.ok(after.high - after.low < 0.8 * (before.high - before.low), "more contrast");
    assert.ok(Math.abs(after.high + after.low - before.high - before.low) < 1e-6);
    await type(page, "#window", 10);
    await type(page, "#level", -5);
    assert.deepEqual(await state(page, "range"), {low: -10, high: 0});
    await type(page, "#window", -3);
    assert.match(await page.locator("#window-problem").textContent(), /a number above 0, got “-3”/);
    assert.deepEqual(await state(page, "range"), {low: -10, high: 0});
    await page.locator("#reset-window").click();
    assert.deepEqual(await state(page, "range"), before);
  });

  test("a view can be enlarged", {timeout: SLOW}, async () => {
    const small = await page.locator("#view").boundingBox();
    await page.locator("#enlarge-mesh").click();
    await drawn(page);
    const large = await page.locator("#view").boundingBox();
    assert.ok(large.width > 1.8 * small.width && large.height > 1.8 * small.height);
    assert.ok(!(await page.locator("#slice-x").isVisible()));
    assert.ok((await meshPixels(page)) > 0.1);
    await page.locator("#enlarge-mesh").click();
    assert.ok(await page.locator("#slice-x").isVisible());
  });
});

test("touch: slices, handle", {timeout: 2 * SLOW}, async () => {
  await viewing("ball", async (page, server) => {
    await upToDate(page);
    await page.locator("#slice-z").scrollIntoViewIfNeeded();
    const at = await placeOfSample(page, 2, [20, 20, 20]);
    await page.touchscreen.tap(at.x, at.y);
    assert.deepEqual((await state(page, "position")).slice(0, 2), [20, 20]);
    assert.match(await page.locator("#slice-z-readout").textContent(), /^\(20, 20, 20\) value/);
    const box = await page.locator("#histogram").boundingBox();
    await page.touchscreen.tap(box.x + box.width * 0.75, box.y + 20);
    const {minimum, maximum} = server.volume;
    const expected = minimum + 0.75 * (maximum - minimum);
    assert.ok(Math.abs((await state(page, "isovalue")) - expected) < 0.2);
    await upToDate(page);
    assert.equal(lastMesh(server).iso, `${await state(page, "isovalue")}`);
    // A finger that moves sideways drags the handle.
    const client = await page.context().newCDPSession(page);
    const swipe = async (places) => {
      const send = (type, touchPoints) =>
        client.send("Input.dispatchTouchEvent", {type, touchPoints});
      await send("touchStart", [places[0]]);
      for (const place of places.slice(1)) await send("touchMove", [place]);
      await send("touchEnd", []);
    };
    await swipe([0.75, 0.7, 0.65, 0.6].map((x) => ({x: box.x + x * box.width, y: box.y + 20})));
    const dragged = minimum + 0.6 * (maximum - minimum);
    assert.ok(Math.abs((await state(page, "isovalue")) - dragged) < 0.2);
    await upToDate(page);
    // An edge of the region of interest.
    await page.locator("#edit-region").click();
    await page.locator("#slice-z").scrollIntoViewIfNeeded();
    const edge = await placeOfSample(page, 2, [-0.5, 14, 20]);
    const to = await placeOfSample(page, 2, [15.5, 14, 20]);
    const between = [0, 0.3, 0.6, 1].map((t) => ({x: edge.x + t * (to.x - edge.x), y: edge.y}));
    await swipe(between);
    assert.equal((await state(page, "region"))[0][0], 16);
    await upToDate(page);
    assert.equal(lastMesh(server).roi, "16:63,:,:");
  }, {width: 360, height: 740, touch: true});
});

describe("isovalue", () => {
  test("mouse, keyboard, number, suggestion", {timeout: 2 * SLOW}, async () => {
    await viewing("bytes", async (page, server) => {
      await upToDate(page);
      const handle = page.locator("#handle");
      const value = async () => {
        const now = await state(page, "isovalue");
        assert.equal(await handle.getAttribute("aria-valuenow"), `${now}`);
        assert.equal(await page.locator("#isovalue").inputValue(), `${now}`);
        return now;
      };
      assert.equal(await value(), 99.5);
      await handle.focus();
      for (const [key, expected] of [["ArrowRight", 100.5], ["ArrowDown", 99.5],
        ["PageUp", 109.5], ["Shift+ArrowLeft", 99.5], ["Home", 0.5], ["End", 199.5]]) {
        await page.keyboard.press(key);
        assert.equal(await value(), expected, key);
      }
      const box = await page.locator("#histogram").boundingBox();
      const xOf = (v) => box.x + (box.width * (v + 0.5)) / 201;
      await page.mouse.move(xOf(199.5), box.y + 30);
      await page.mouse.down();
      await page.mouse.move(xOf(120.6), box.y + 10, {steps: 5});
      await page.mouse.up();
      assert.equal(await value(), 120.5);
      await upToDate(page);
      assert.equal(lastMesh(server).iso, "120.5");
      const before = meshes(server).length;
      await page.locator("#isovalue").fill("");
      await page.locator("#isovalue").pressSequentially("80");
      await page.keyboard.press("Enter");
      assert.equal(await value(), 80);
      await upToDate(page);
      assert.ok(!meshes(server).slice(before).some(({options}) => options[0][1] === "8"),
        "no mesh of the first digit");
      await page.locator("#suggested-1").click();
      assert.equal(await value(), 99.5);
      await page.locator("#inside-below").click();
      await upToDate(page);
      assert.deepEqual(await state(page, "options"), [
        ["iso", "99.5"], ["inside", "below"], ["max-radius", "3vx"]]);
      assert.match(await page.locator("#isovalue-share").textContent(), /9\d % of the samples/);
    });
  });

  test("a bad number is refused in words, and the last mesh stays", {timeout: SLOW}, async () => {
    await viewing("bytes", async (page, server) => {
      await upToDate(page);
      const {triangles} = await state(page, "mesh");
      const posted = meshes(server).length;
      for (const [text, words] of [["abc", /Expected a number like 300\.5, got “abc”/],
        ["99,5", /decimal point: 99\.5/], ["999", /samples are from 0 to 200/], ["", /a number/]]) {
        await type(page, "#isovalue", text);
        assert.match(await page.locator("#isovalue-problem").textContent(), words);
        assert.equal(await page.locator("#isovalue").getAttribute("aria-invalid"), "true");
      }
      assert.equal(await state(page, "isovalue"), 99.5);
      assert.equal((await state(page, "mesh")).triangles, triangles);
      assert.equal(meshes(server).length, posted);
      await page.locator("#handle").focus();
      await page.keyboard.press("ArrowRight");
      assert.equal(await page.locator("#isovalue-problem").textContent(), "");
    });
  });

  test("NaN samples: their colour and their side", {timeout: 2 * SLOW}, async () => {
    await viewing("nan", async (page, server) => {
      await upToDate(page);
      assert.equal(lastMesh(server).nan, "below");
      await page.locator("#cross").uncheck();
      const [nan, finite] = await sliceColours(page, 2, [[4, 8, 16], [30, 8, 16]]);
      assert.deepEqual(nan.slice(0, 3), [176, 58, 122]);
      assert.ok(Math.abs(finite[0] - finite[1]) < 3);
      await page.locator("#inside-below").click();
      assert.equal(await option(page, "nan"), "above", "outside, until the user chooses");
      await page.locator("#nan-below").click();
      await upToDate(page);
      await page.locator("#inside-above").click();
      assert.equal(await option(page, "nan"), "below");
      const at = await placeOfSample(page, 2, [4, 8, 16]);
      await page.mouse.move(at.x, at.y);
      assert.match(await page.locator("#slice-z-readout").textContent(), /value NaN/);
    });
  });
});

describe("the mesh follows", () => {
  test("one request at a time, and the last value", {timeout: 2 * SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      await upToDate(page);
      const box = await page.locator("#histogram").boundingBox();
      await page.mouse.move(box.x + 0.6 * box.width, box.y + 20);
      await page.mouse.down();
      for (let k = 0; k < 40; ++k) {
        await page.mouse.move(box.x + (0.6 + 0.006 * k) * box.width, box.y + 20);
        await page.waitForTimeout(10);
      }
      const moving = meshes(server).length - 1;
      assert.ok(moving > 1, "the mesh follows while the handle moves");
      assert.equal(server.counts.replaced, 0, "one request at a time");
      await page.mouse.up();
      await upToDate(page);
      assert.ok(server.counts.replaced <= 1);
      assert.equal(lastMesh(server).iso, `${await state(page, "isovalue")}`);
      assert.deepEqual((await state(page, "mesh")).options, await state(page, "options"));
      const requests = meshes(server).map(({request}) => request);
      assert.deepEqual(requests, [...requests].sort((a, b) => a - b));
    }, {faults: {delay: 200}});
  });

  test("requests do not overtake each other", {timeout: SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      await upToDate(page);
      Object.assign(server.faults, {late: [0, 0, 700], delay: 1200});
      await type(page, "#region-z-first", 5);
      await type(page, "#region-z-last", 30);
      await page.locator("#topology-faces").click();
      await upToDate(page);
      assert.equal(lastMesh(server).roi, ":,:,5:30");
      assert.equal(lastMesh(server).topology, "faces");
      assert.deepEqual((await state(page, "mesh")).options, await state(page, "options"));
    });
  });

  test("a preview, then the whole volume; cancel", {timeout: 2 * SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      const line = () => page.locator("#mesh-line").textContent();
      await page.waitForFunction(() => window.isoatlas.mesh?.reduction === 2);
      await page.waitForFunction(() =>
        document.querySelector("#mesh-done").textContent.includes("40 %"));
      assert.equal(await line(), "Preview: every 2 × 2 × 2 samples as one; the mesh of the whole " +
        "volume is being made …");
      assert.ok(await page.locator("#mesh-progress").isVisible());
      await page.locator("#cancel-mesh").click();
      await page.waitForFunction(() => !window.isoatlas.running);
      assert.match(await line(), /^Preview.* was cancelled\.$/);
      assert.ok(!(await page.locator("#cancel-mesh").isVisible()));
      server.faults.holds = false;
      await page.locator("#handle").focus();
      await page.keyboard.press("ArrowRight");
      await upToDate(page);
      assert.match(await line(), /^Coarse mesh/);
      server.faults.holds = true;
      server.faults.preview = false;
      await page.keyboard.press("ArrowRight");
      await page.locator("#cancel-mesh").press("Enter");
      await page.waitForFunction(() => !window.isoatlas.running);
      await page.waitForTimeout(100);
      assert.equal(await line(), "Cancelled. The previous mesh is still shown.");
      assert.equal(await page.evaluate(() => document.activeElement.id), "handle");
      assert.ok((await meshPixels(page)) > 0.05);
    }, {faults: {preview: true, holds: true}});
  });

  test("another page replaces the mesh; the same isovalue again", {timeout: SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      await upToDate(page);
      const typed = () => type(page, "#isovalue", 5);
      const suggested = () => page.locator("#suggested-1").click();
      const moved = () => page.locator("#handle").press("ArrowRight");
      const entered = () => page.locator("#isovalue").press("Enter");
      for (const [first, again] of [[typed, entered], [suggested, suggested], [typed, moved]]) {
        const posted = meshes(server).length;
        server.faults.holds = true;
        await first();
        await page.waitForFunction(() => window.isoatlas.running);
        while (meshes(server).length === posted) await page.waitForTimeout(20);
        server.send({type: "cancelled", request: meshes(server).at(-1).request});
        await page.waitForFunction(() => !window.isoatlas.running);
        assert.equal(await page.locator("#mesh-line").textContent(),
          "Cancelled. The previous mesh is still shown.");
        server.faults.holds = false;
        await again();
        await upToDate(page);
        assert.equal(lastMesh(server).iso, `${await state(page, "isovalue")}`);
        assert.equal((await state(page, "mesh")).request, meshes(server).at(-1).request);
      }
    });
  });

  test("failures are shown, and the last mesh stays", {timeout: 2 * SLOW}, async () => {
    await viewing("ball", async (page, server, trouble) => {
      await upToDate(page);
      server.faults.fail = "no sample is inside: the largest is 19";
      await type(page, "#isovalue", 3);
      await page.waitForFunction(() => window.isoatlas.problem);
      assert.equal(await page.locator("#mesh-line").textContent(),
        "No sample is inside: the largest is 19. The last mesh is still shown.");
      assert.ok((await meshPixels(page)) > 0.1);
      server.faults.fail = "";
      server.faults.refuse = "--iso: expected a number";
      await type(page, "#isovalue", 4);
      await page.waitForFunction(() => /expected a number/.test(window.isoatlas.problem));
      await page.waitForFunction(() => document.querySelector("#command-problem").textContent);
      server.faults.refuse = "";
      await type(page, "#isovalue", 5);
      await upToDate(page);
      // The browser reports refused requests in its console.
      assert.ok(trouble.length >= 1 && trouble.every((text) => /status of 400/.test(text)));
      trouble.length = 0;
    });
  });

  test("the camera stays when the mesh changes", {timeout: 2 * SLOW}, async () => {
    await viewing("far", async (page) => {
      await upToDate(page);
      const of = await page.evaluate(() => window.isoatlas.centre);
      const where = (point) => page.evaluate((p) => window.isoatlas.project(p), point);
      await page.locator("#view").focus();
      await page.keyboard.press("ArrowRight");
      await page.keyboard.press("+");
      const points = [of, of.map((v) => v + 3)];
      const before = await Promise.all(points.map(where));
      await type(page, "#isovalue", 6);
      await upToDate(page);
      const after = await Promise.all(points.map(where));
      before.flat().forEach((v, i) => assert.ok(Math.abs(v - after.flat()[i]) < 0.5));
      await type(page, "#region-x-last", 30);
      await upToDate(page);
      assert.notDeepEqual(await page.evaluate(() => window.isoatlas.centre), of);
      const cut = await Promise.all(points.map(where));
      before.flat().forEach((v, i) => assert.ok(Math.abs(v - cut.flat()[i]) < 0.5));
      await page.locator("#fit").click();
      await settled(page);
      assert.notDeepEqual(await where(of), before[0]);
      assert.match(await page.locator('[data-view="slice-z"] h2').textContent(), /^Axial/);
    });
  });
});

describe("components", () => {
  test("only the shown ones are kept; they come back", {timeout: 2 * SLOW}, async () => {
    await viewing("two", async (page, server) => {
      await upToDate(page);
      await page.locator("#only-1").click();
      assert.deepEqual(await state(page, "hidden"), [1]);
      await page.locator("#keep-shown").click();
      await upToDate(page);
      assert.equal(lastMesh(server)["keep-components"], "1", "the largest by its volume");
      await page.waitForSelector("#dropped");
      assert.match(await page.locator("#dropped").textContent(), /1 component of 2/);
      await page.locator("#take-all").click();
      await upToDate(page);
      assert.equal(lastMesh(server)["keep-components"], undefined);
      await page.waitForSelector("#only-2");
      await page.locator("#only-2").click();
      await page.locator("#keep-shown").click();
      await upToDate(page);
      const [x] = lastMesh(server)["keep-near"].split(",").map(Number);
      assert.ok(Math.abs(x - 44) < 6, `a vertex of the small ball: ${x}`);
      assert.equal((await state(page, "mesh")).kept, 1);
      await page.waitForSelector(".returnable button");
      await page.locator(".returnable button").first().click();
      await upToDate(page);
      assert.equal((await state(page, "mesh")).kept, 2);
    });
  });

  test("a double click uses one component again", {timeout: 2 * SLOW}, async () => {
    await viewing("five", async (page, server) => {
      await upToDate(page);
      const points = (name) => server.received.findLast(({path}) => path === "mesh")
        .options.filter(([n]) => n === name).length;
      await page.locator("#shown-1").uncheck();
      await page.locator("#shown-2").uncheck();
      await page.locator("#keep-shown").click();
      await upToDate(page);
      assert.equal(points("drop-near"), 2);
      server.faults.delay = 300;
      await page.locator(".returnable button").first().dblclick();
      await upToDate(page);
      assert.equal(points("drop-near"), 1);
      await page.locator("#take-all").click();
      await upToDate(page);
      await page.locator("#only-5").click();
      await page.locator("#keep-shown").click();
      await upToDate(page);
      assert.equal(points("keep-near"), 1);
      await page.locator(".returnable button").first().dblclick();
      await upToDate(page);
      assert.equal(points("keep-near"), 2);
    });
  });

  test("fields: the N largest, and no small ones", {timeout: 2 * SLOW}, async () => {
    await viewing("two", async (page, server) => {
      await upToDate(page);
      await type(page, "#keep-largest", 1);
      await type(page, "#drop-smaller", 10);
      await upToDate(page);
      assert.equal(lastMesh(server)["keep-components"], "1");
      assert.equal(lastMesh(server)["min-component-size"], "10vx");
      await type(page, "#keep-largest", "1.5");
      assert.match(await page.locator("#keep-problem").textContent(), /a whole number.*“1\.5”/);
      await type(page, "#keep-largest", "");
      await upToDate(page);
      assert.equal(lastMesh(server)["keep-components"], undefined);
    });
  });

  test("the keyboard focus stays when a button disappears", {timeout: 2 * SLOW}, async () => {
    await viewing("three", async (page) => {
      await upToDate(page);
      const focused = () => page.evaluate(() => {
        const {id, textContent, ariaLabel} = document.activeElement;
        return id || ariaLabel || textContent;
      });
      const press = async (selector, key = "Enter") => {
        await page.locator(selector).first().focus();
        await page.keyboard.press(key);
        await upToDate(page);
      };
      await press("#shown-1", "Space");
      assert.equal(await focused(), "shown-1");
      await press("#shown-2", "Space");
      await press("#keep-shown");
      assert.equal(await focused(), "keep-largest");
      // Two components can be used again; the next one has the focus, then the field.
      assert.equal(await page.locator(".returnable button").count(), 2);
      await press(".returnable button");
      assert.match(await focused(), /^Use again the component of/);
      assert.equal(await page.locator(".returnable button").count(), 1);
      await page.keyboard.press("Enter");
      await upToDate(page);
      assert.equal(await page.locator(".returnable button").count(), 0);
      assert.equal(await focused(), "keep-largest");
      await press("#take-all");
      assert.equal(await focused(), "keep-largest");
      // Rows of the list stay focused when the mesh changes.
      await page.locator("#only-2").focus();
      await page.evaluate(() => document.querySelector("#inside-below").click());
      await upToDate(page);
      assert.equal(await focused(), "only-2");
    });
  });

  test("hidden components stay hidden when the isovalue moves", {timeout: SLOW}, async () => {
    await viewing("two", async (page) => {
      await upToDate(page);
      await page.locator("#shown-2").uncheck();
      await page.locator("#handle").focus();
      await page.keyboard.press("ArrowRight");
      await upToDate(page);
      assert.deepEqual(await state(page, "hidden"), [1]);
    });
  });

  test("hidden components stay hidden after a preview without them", {timeout: SLOW}, async () => {
    await viewing("two", async (page, server) => {
      await upToDate(page);
      Object.assign(server.faults, {preview: true, coarse: true, holds: true});
      const preview = async () => {
        await page.keyboard.press("ArrowRight");
        await page.waitForFunction(() => window.isoatlas.mesh.reduction === 2);
      };
      const finish = async () => {
        server.faults.holds = false;
        await page.keyboard.press("ArrowRight");
        await upToDate(page);
        await page.waitForFunction(() => window.isoatlas.mesh.final);
        server.faults.holds = true;
      };
      await page.locator("#shown-2").uncheck();
      await page.locator("#handle").focus();
      await preview();
      assert.deepEqual(await state(page, "hidden"), []);
      await finish();
      assert.deepEqual(await state(page, "hidden"), [1]);
      // A choice in the preview replaces it.
      await preview();
      await page.locator("#view").focus();
      await page.keyboard.press("a");
      await page.locator("#handle").focus();
      await finish();
      assert.deepEqual(await state(page, "hidden"), []);
    });
  });
});

test("region of interest: numbers, edges, reset", {timeout: 2 * SLOW}, async () => {
  await viewing("ball", async (page, server) => {
    await upToDate(page);
    await type(page, "#region-x-first", 10);
    await type(page, "#region-x-last", 40);
    await upToDate(page);
    assert.equal(lastMesh(server).roi, "10:40,:,:");
    await type(page, "#region-y-last", 99);
    assert.match(await page.locator("#region-problem").textContent(), /y: .*from 0 to 47/);
    await type(page, "#region-y-last", 40);
    assert.equal(await page.locator("#region-problem").textContent(), "");
    const [dimmed, bright] = await sliceColours(page, 2, [[5, 5, 20], [12, 5, 20]]);
    assert.ok(dimmed[0] < bright[0] / 1.5);
    await page.locator("#edit-region").click();
    const edge = await placeOfSample(page, 2, [40.5, 10, 20]);
    const to = await placeOfSample(page, 2, [30.5, 10, 20]);
    await page.mouse.move(edge.x, edge.y);
    assert.equal(await page.locator("#slice-z").evaluate((c) => c.style.cursor), "ew-resize");
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, {steps: 4});
    await page.mouse.up();
    await upToDate(page);
    assert.equal(lastMesh(server).roi, "10:30,0:40,:");
    assert.equal(await page.locator("#region-x-last").inputValue(), "30");
    await page.locator("#whole-volume").press("Enter");
    assert.equal(await page.evaluate(() => document.activeElement.id), "edit-region");
    await upToDate(page);
    assert.equal(lastMesh(server).roi, undefined);
  });
});

describe("saving", () => {
  test("options, the command, the file", {timeout: 2 * SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      await upToDate(page);
      const command = async (expected) =>
        page.waitForFunction((text) => window.isoatlas.command === text, expected);
      await command("isoatlas extract ball.nrrd --iso 6 -o ball.ply");
      await page.locator("#max-distance").fill("0.25");
      await page.locator("#levels").fill("3");
      await page.locator('[name="border"][value="closed"]').click();
      await page.locator("#format").selectOption("stl");
      await command("isoatlas extract ball.nrrd --iso 6 --border closed --max-distance 0.25vx " +
        "--levels 3 -o ball.stl");
      await page.locator("#further-bounds summary").click();
      await page.locator("#max-vertices").fill("3");
      assert.match(await page.locator("#bound-problem").textContent(),
        /Vertices, at most: expected a whole number, 4 or more, got “3”/);
      await page.waitForFunction(() => document.querySelector("#save").disabled);
      await page.locator("#max-vertices").fill("");
      await page.waitForFunction(() => !document.querySelector("#save").disabled);
      await page.locator("#detail-coarse").click();
      await command("isoatlas extract ball.nrrd --iso 6 --border closed --coarse " +
        "--max-radius 3vx " +
        "-o ball.stl");
      const [download] = await Promise.all([
        page.waitForEvent("download"),
        page.locator("#save").click(),
      ]);
      assert.equal(download.suggestedFilename().replace(/^mesh$/, "ball.stl"), "ball.stl");
      assert.match(await page.locator("#save-status").textContent(), /Saved ball\.stl, 1234 bytes/);
      assert.match(await page.locator("#save-summary").textContent(), /as on the command line/);
      const saved = server.received.find(({path}) => path === "save");
      assert.deepEqual(saved.options, [
        ["iso", "6"], ["border", "closed"], ["coarse", ""], ["max-radius", "3vx"]]);
      assert.equal(saved.format, "stl");
      await page.locator("#copy-command").click();
      await page.waitForFunction(() =>
        /Copied|Selected/.test(document.querySelector("#copy-command").textContent));
    });
  });

  test("violated bounds are a warning", {timeout: 2 * SLOW}, async () => {
    for (const width of [1440, 360]) {
      await viewing("ball", async (page, server) => {
        await upToDate(page);
        const status = page.locator("#save-status");
        const isBad = () => status.evaluate((line) => line.classList.contains("bad"));
        await page.locator("#save").click();
        await page.waitForFunction(() => !window.isoatlas.saving);
        assert.equal(await status.textContent(), "Saved ball.ply, 1234 bytes.");
        assert.equal(await isBad(), false);
        server.faults.violated = true;
        await page.locator("#save").click();
        await page.waitForFunction(() => !window.isoatlas.saving);
        assert.equal(await status.textContent(),
          "Saved ball.ply, 1234 bytes, but not all bounds are satisfied: see below.");
        assert.equal(await isBad(), true);
        const summary = page.locator("#save-summary");
        assert.match(await summary.textContent(),
          /command line\n {2}level 1 .*; violated: max-distance\n$/);
        assert.ok(await summary.evaluate((box) =>
          box.scrollWidth <= box.clientWidth && box.scrollHeight <= box.clientHeight), "not cut");
      }, {width, height: width < 500 ? 740 : 900});
    }
  });

  test("not while a field is invalid", {timeout: 2 * SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      await upToDate(page);
      await type(page, "#keep-largest", "3");
      await page.waitForFunction(() => /--keep-components 3/.test(window.isoatlas.command));
      await upToDate(page);
      const posted = server.received.length;
      for (const [id, wrong, right, words] of [
        ["keep-largest", "-3", "3", "the choice of components"],
        ["isovalue", "6,5", "6", "the isovalue"],
        ["region-y-last", "99", "47", "the region of interest"],
        ["max-distance", "-1", "", "the bounds of the mesh"],
      ]) {
        await page.locator(`#${id}`).fill(wrong);
        await page.locator(`#${id}`).dispatchEvent("change");
        // At once: a click on Save, which makes the field lose the focus, must not save.
        assert.ok(await page.locator("#save").isDisabled(), id);
        assert.equal(await page.locator("#save-problem").textContent(),
          `To save, correct ${words}.`);
        assert.equal(await page.locator("#command-problem").textContent(),
          `This is not the current command. Correct ${words}.`);
        assert.ok(await page.locator("#copy-command").isDisabled());
        assert.equal(await state(page, "command"), null);
        assert.equal(await option(page, "keep-components"), "3", "the last valid value");
        await page.locator(`#${id}`).fill(right);
        await page.locator(`#${id}`).dispatchEvent("change");
        assert.ok(await page.locator("#save").isEnabled(), id);
        assert.equal(await page.locator("#save-problem").textContent(), "");
        await page.waitForFunction(() => window.isoatlas.command ===
          "isoatlas extract ball.nrrd --iso 6 --keep-components 3 -o ball.ply");
        assert.ok(await page.locator("#copy-command").isEnabled());
      }
      assert.ok(server.received.slice(posted).every(({path}) => path === "command"));
      // The problem of an axis stays when another one is corrected.
      await type(page, "#region-y-last", "99");
      await type(page, "#region-x-first", "5");
      assert.match(await page.locator("#region-problem").textContent(), /^y: /);
      assert.ok(await page.locator("#save").isDisabled());
      await page.locator("#whole-volume").click();
      assert.ok(await page.locator("#save").isEnabled());
    });
  });

  test("messages of a broken connection arrive later", {timeout: SLOW}, async () => {
    await viewing("ball", async (page, server, trouble) => {
      await upToDate(page);
      server.faults.holds = true;
      await page.locator("#save").click();
      await page.waitForFunction(() =>
        /refining/.test(document.querySelector("#save-status").textContent));
      server.breakStreams();
      const {request} = server.received.find(({path}) => path === "save");
      server.send({type: "failed", request, message: "no space is left"});
      await page.waitForFunction(() => !window.isoatlas.saving);
      assert.equal(await page.locator("#save-status").textContent(), "No space is left.");
      assert.ok(await page.locator("#ended").isHidden());
      // The browser reports the connection in its console.
      assert.ok(trouble.every((text) => /ERR_/.test(text)), trouble.join());
      trouble.length = 0;
    });
  });

  test("cancel", {timeout: 2 * SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      await upToDate(page);
      server.faults.holds = true;
      const focused = () => page.evaluate(() => document.activeElement.id);
      await page.locator("#save").press("Enter");
      assert.equal(await focused(), "cancel-save");
      await page.waitForFunction(() =>
        document.querySelector("#save-status").textContent === "Saving: refining …");
      assert.ok(await page.locator("#save").isDisabled());
      await page.keyboard.press("Enter");
      await page.waitForFunction(() => !window.isoatlas.saving);
      assert.equal(await focused(), "save");
      assert.match(await page.locator("#save-status").textContent(), /Nothing was saved/);
      assert.ok(await page.locator("#save").isEnabled());
    });
  });
});

describe("the server ends", () => {
  async function hasEnded(page, reason) {
    await page.waitForSelector("html[data-ended]");
    assert.match(await page.locator("#ended").textContent(), reason);
    for (const id of ["save", "region-x-first", "keep-largest", "detail-coarse"])
      assert.ok(await page.locator(`#${id}`).isDisabled(), id);
    assert.ok((await meshPixels(page)) > 0.1);
    const before = await page.evaluate(() => window.isoatlas.picture());
    await page.locator("#view").focus();
    await page.keyboard.press("ArrowRight");
    await drawn(page);
    assert.notEqual(await page.evaluate(() => window.isoatlas.picture()), before);
    assert.ok(await page.locator("#tint").isEnabled());
  }

  test("and reports it", {timeout: SLOW}, async () => {
    await viewing("ball", async (page, server) => {
      await upToDate(page);
      server.send({type: "bye", message: "It was interrupted."});
      await hasEnded(page, /has ended\. It was interrupted\./);
    });
  });

  test("or refuses another page", {timeout: SLOW}, async () => {
    await viewing("ball", async (first, server) => {
      await upToDate(first);
      server.faults.refusePages = "too many pages are open; close one";
      const page = await first.context().newPage();
      await page.goto(server.address);
      await page.waitForSelector("html[data-ended]");
      assert.match(await page.locator("#ended").textContent(), /^isoatlas view does not serve/);
      assert.match(await page.locator("#ended").textContent(),
        /this page: too many pages are open; close one\. Then reload this page\. /);
      assert.ok(await page.locator("#save").isDisabled());
      server.faults.refusePages = "";
      await page.reload();
      await upToDate(page);
      assert.ok(await page.locator("#ended").isHidden());
      await page.close();
    });
  });

  test("without a word", {timeout: 2 * SLOW}, async () => {
    const server = await serveVolume("ball");
    const {page, close} = await openView(server.address);
    await upToDate(page);
    await server.stop();
    await hasEnded(page, /does not answer/);
    await close();
  });
});

test("no WebGL: a message, and slices", {timeout: 2 * SLOW}, async () => {
  const blind = await chromium.launch({
    ...LAUNCH,
    args: ["--headless=new", "--no-sandbox", "--disable-3d-apis"],
  });
  const server = await serveVolume("ball");
  const {page, close} = await openView(server.address, {in: blind});
  await upToDate(page);
  assert.match(await page.locator("[role=alert].missing").textContent(), /no WebGL 2/);
  assert.match(await page.locator("#mesh-line").textContent(), /^Coarse mesh/);
  assert.ok(isBlue((await sliceColours(page, 2, [[36, 23, 20]]))[0]));
  await close();
  await blind.close();
  await server.stop();
});
