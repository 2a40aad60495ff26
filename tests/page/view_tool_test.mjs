// SPDX-License-Identifier: Apache-2.0
// `isoatlas view` with its page, in a real browser, on made-up and real volumes.
import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {mkdirSync, readFileSync} from "node:fs";
import {join} from "node:path";
import {before, test} from "node:test";

import {drawn, folder, leastContrast, SLOW, SMALL, state} from "./browser.mjs";
import {repository} from "./modules.mjs";
import {isBlue, meshPixels, openView, option, placeOfSample, sliceColours, type, upToDate}
  from "./view_browser.mjs";
import {data, needs, startView, tool, writeVolume} from "./view_tool.mjs";

const protein = join(repository, "samples/protein_iron.nhdr");
let ball;  // radius 20 - v around (31.5, 23.5, 19.5), turned and far from the origin
const CENTRE = [31.5, 23.5, 19.5];
const [C, S] = [Math.cos(0.5), Math.sin(0.5)];
const world = ([i, j, k]) => [1000 + C * i - S * j, -2000 + S * i + C * j, 300 + k];
before(() => {
  ball = writeVolume(join(folder, "ball.nrrd"), [64, 48, 40], "float",
    (i, j, k) => 20 - Math.hypot(i - CENTRE[0], j - CENTRE[1], k - CENTRE[2]),
    ["space: left-posterior-superior", `space directions: (${C},${S},0) (${-S},${C},0) (0,0,1)`,
      "space origin: (1000,-2000,300)", 'space units: "mm" "mm" "mm"']);
});

/**
 * The ends of the tools whose pages are closed. It takes seconds, so the last test awaits them, and
 * the test before it does without them.
 */
const ends = [];

/** Starts the tool and opens its page. */
async function viewing(words, use, options = {}) {
  const server = await startView(...words);
  const {page, trouble, close} = await openView(server.address, options);
  try {
    await use(page, server);
    assert.deepEqual(trouble, []);
  } catch (error) {
    await server.stop();
    throw error;
  } finally {
    await close();
  }
  ends.push(server.ended);
}

const TINY = {width: 480, height: 360};  // quickly drawn

const distance = (a, b) => Math.hypot(...a.map((v, axis) => v - b[axis]));

async function vertices(page) {
  const flat = await state(page, "positions");
  return Array.from({length: flat.length / 3}, (_, v) => flat.slice(3 * v, 3 * v + 3));
}

/**
 * Clicks a button as soon as a state of the page is true, in the page itself: on a busy machine,
 * the state can end before the click of a mouse arrives.
 */
const clickWhile = (page, name, button) =>
  page.waitForFunction(([key, selector]) => {
    if (!window.isoatlas[key]) return false;
    document.querySelector(selector).click();
    return true;
  }, [name, button]);

const run = (...words) => execFileSync(tool, words, {encoding: "utf8"});
const percentile = (times, share) =>
  [...times].sort((a, b) => a - b)[Math.min(Math.floor(share * times.length), times.length - 1)];

test("isoline and mesh are where the ball is", {...needs(), timeout: 4 * SLOW}, async () => {
  for (const dark of [false, true]) {
    await viewing([ball, "--iso", "6"], async (page) => {
      await upToDate(page);
      await page.locator("#cross").uncheck();
      await page.locator("#tint").uncheck();
      const r = Math.sqrt(14 ** 2 - 0.5 ** 2);
      for (const axis of [0, 1, 2]) {
        const [u, v] = [0, 1, 2].filter((a) => a !== axis);
        const at = (radius, angle) => {
          const p = [...CENTRE];
          p[u] += radius * Math.cos(angle);
          p[v] += radius * Math.sin(angle);
          return p;
        };
        const angles = [0.4, 2, 3.5, 5];
        const samples = angles.flatMap((angle) => [r, r - 1, r + 1].map((x) => at(x, angle)));
        const colours = await sliceColours(page, axis, samples);
        const expected = angles.flatMap(() => [true, false, false]);
        assert.deepEqual(colours.map(isBlue), expected, `${axis} ${colours}`);
      }
      // The mesh: its vertices, and what is at the pixel of the ball's centre and beside the ball.
      for (const at of await vertices(page))
        assert.ok(Math.abs(distance(at, world(CENTRE)) - 14) < 0.1, `${at}`);
      assert.ok((await meshPixels(page)) > 0.1);
      const seen = (point) =>
        page.evaluate((p) => window.isoatlas.pick(...window.isoatlas.project(p)), point);
      assert.ok(await seen(world(CENTRE)));
      assert.equal(await seen(world([CENTRE[0] + 16, CENTRE[1] - 16, CENTRE[2]])), null);
      assert.match(await page.locator("#mesh-line").textContent(),
        /^Coarse mesh: [\d,]+ triangles, 1 component, genus 0, certified, [\d.]+ s\.$/);
      assert.ok((await page.evaluate(leastContrast)).ratio >= 4.5);
      // The value and the world coordinates under the pointer.
      const place = await placeOfSample(page, 2, [40, 30, 20]);
      await page.mouse.move(place.x, place.y);
      const value = 20 - Math.hypot(8.5, 6.5, 0.5);
      const [x, y, z] = world([40, 30, 20]).map((v) => Number(v.toPrecision(5)));
      assert.equal(await page.locator("#slice-z-readout").textContent(),
        `(40, 30, 20) value ${Number(value.toPrecision(6))} · (${x}, ${y}, ${z}) mm LPS`);
    }, {dark});
  }
});

test("the handle: mouse, keyboard, touch", {...needs(), timeout: 4 * SLOW}, async () => {
  await viewing([protein], async (page) => {
    await upToDate(page);
    const first = await state(page, "isovalue");
    assert.equal(first % 1, 0.5, "half-way between integers");
    await page.locator("#handle").focus();
    await page.keyboard.press("ArrowRight");
    await upToDate(page);
    assert.equal(await state(page, "isovalue"), first + 1);
    assert.equal((await state(page, "mesh")).options[0][1], `${first + 1}`);
    const box = await page.locator("#histogram").boundingBox();
    await page.mouse.move(box.x + box.width / 4, box.y + 20);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y + 20, {steps: 8});
    await page.mouse.up();
    await upToDate(page);
    const components = (await state(page, "mesh")).components;
    const isovalue = await state(page, "isovalue");
    const report = JSON.parse(run("extract", protein, "--iso", `${isovalue}`, "--coarse", "-q",
      "-o", join(folder, "handle.ply"), "--report", "-"));
    assert.equal(components, report.levels[0].components);
  });
  await viewing([protein], async (page) => {
    await upToDate(page);
    const box = await page.locator("#histogram").boundingBox();
    await page.touchscreen.tap(box.x + box.width * 0.4, box.y + 20);
    await upToDate(page);
    const isovalue = await state(page, "isovalue");
    assert.ok(Math.abs(isovalue - 0.4 * 255) < 3, `${isovalue}`);
    assert.ok(await page.evaluate(() =>
      document.documentElement.scrollWidth <= document.documentElement.clientWidth));
  }, {width: 360, height: 740, touch: true});
});

/** Saves the mesh and runs the shown command line. The two files have to be equal. */
async function savedAsCommanded(page, format) {
  await page.locator("#format").selectOption(format);
  const shown = await page.waitForFunction((end) => {
    const {command: now} = window.isoatlas;
    return now?.endsWith(end) && now;
  }, `.${format}`);
  const command = await shown.jsonValue();
  const [download] = await Promise.all([
    page.waitForEvent("download", {timeout: 5 * SLOW}),
    page.locator("#save").click(),
  ]);
  const path = join(folder, `saved.${format}`);
  await download.saveAs(path);
  assert.equal(command.split(" ")[0], "isoatlas");
  const cwd = join(folder, "by-command");
  mkdirSync(cwd, {recursive: true});
  execFileSync("sh", ["-c", `"$0" ${command.slice("isoatlas".length)} -q`, tool], {cwd});
  const written = command.match(/(\S+)$/)[1];
  const name = download.suggestedFilename();
  assert.equal(name, written.replace(/^.*\//, ""));
  assert.ok(readFileSync(path).equals(readFileSync(join(cwd, name))), `${command}: other bytes`);
  return {path, command};
}

test("a saved mesh is that of the command line", {...needs(), timeout: 6 * SLOW}, async () => {
  await viewing([protein, "--iso", "100.5"], async (page) => {
    await upToDate(page);
    await page.locator("#max-distance").fill("1");
    const {path, command} = await savedAsCommanded(page, "ply");
    assert.match(command, /--iso[ =]100\.5 --max-distance 1vx/);
    const checked = JSON.parse(run("check", path, "--json"));
    assert.equal(checked.components, (await state(page, "mesh")).components);
    assert.equal(checked.manifold, true);
    assert.match(await page.locator("#save-summary").textContent(), /certificate\s+passed/);
    await page.locator("#detail-coarse").click();
    const coarse = await savedAsCommanded(page, "stl");
    assert.match(coarse.command, /--coarse/);
    assert.equal(readFileSync(coarse.path).readUInt32LE(80), (await state(page, "mesh")).triangles);
    // A region, a choice of components, caps.
    await type(page, "#region-z-first", 12);
    await type(page, "#keep-largest", 3);
    await page.locator('[name="border"][value="closed"]').click();
    await upToDate(page);
    const part = await savedAsCommanded(page, "ply");
    assert.match(part.command, /--roi '?:,:,12:67'? --keep-components 3 --border closed/);
    const closed = JSON.parse(run("check", part.path, "--json"));
    assert.equal(closed.boundary_loops, 0);
    assert.equal(closed.components, (await state(page, "mesh")).components);
  });
});

test("components: keep, drop, use again", {...needs(), timeout: 4 * SLOW}, async () => {
  await viewing([protein, "--iso", "100.5"], async (page) => {
    await upToDate(page);
    const all = (await state(page, "mesh")).components;
    await page.waitForSelector("#only-2");
    await page.locator("#only-2").click();
    const [{triangles}] = (await state(page, "components")).slice(1);
    await page.locator("#keep-shown").click();
    await upToDate(page);
    const kept = await state(page, "mesh");
    assert.equal(kept.components, 1);
    assert.equal(kept.dropped, all - 1);
    assert.equal(kept.triangles, triangles, "the component that was shown");
    await page.waitForSelector(".returnable button");
    await page.locator(".returnable button").first().click();
    await upToDate(page);
    assert.equal((await state(page, "mesh")).components, 2);
    await page.waitForSelector("#take-all");
    await page.locator("#take-all").click();
    await upToDate(page);
    assert.equal((await state(page, "mesh")).components, all);
    // Nearly all: those that are hidden are dropped.
    await page.waitForSelector("#shown-2");
    await page.locator("#shown-2").uncheck();
    await page.locator("#keep-shown").click();
    await upToDate(page);
    assert.ok(await option(page, "drop-near"));
    assert.equal((await state(page, "mesh")).components, all - 1);
  });
});

test("isovalues without a surface, options that cannot be", {...needs(), timeout: 3 * SLOW},
  async () => {
    const server = await startView(protein, "--iso", "100.5");
    const {page, close} = await openView(server.address);
    await upToDate(page);
    const {triangles} = await state(page, "mesh");
    await type(page, "#isovalue", "1e9");
    const problem = await page.locator("#isovalue-problem").textContent();
    assert.match(problem, /samples are from 0 to 255/);
    await type(page, "#isovalue", "100.5");
    await type(page, "#drop-smaller", "1e9");
    await page.waitForFunction(() => window.isoatlas.problem);
    assert.match(await page.locator("#mesh-line").textContent(),
      /^Every component .*\. The last mesh is still shown\.$/);
    assert.equal((await state(page, "mesh")).triangles, triangles);
    await type(page, "#drop-smaller", "");
    await upToDate(page);
    await type(page, "#isovalue", "0");
    await page.waitForFunction(() => window.isoatlas.problem);
    assert.match(await page.locator("#mesh-line").textContent(), /last mesh is still shown/);
    await close();
    ends.push(server.ended);
  });

test("NaN samples", {...needs("tmap_nan.nii.gz"), timeout: 4 * SLOW}, async () => {
  await viewing([join(data, "tmap_nan.nii.gz"), "--iso", "2"], async (page) => {
    await upToDate(page);
    assert.equal(await option(page, "nan"), "below");
    const outside = (await state(page, "mesh")).triangles;
    await page.locator("#cross").uncheck();
    const [, , k] = await state(page, "position");
    const first = await page.evaluate(async (index) => {
      const samples = new Float32Array(await (await fetch(`slices/2/${index}`)).arrayBuffer());
      return samples.findIndex(Number.isNaN);
    }, k);
    const across = Number(await page.locator("#slice-x-index").getAttribute("max")) + 1;
    const at = [first % across, Math.floor(first / across), k];
    const [colour] = await sliceColours(page, 2, [at]);
    assert.deepEqual(colour.slice(0, 3), [176, 58, 122], "the colour of NaN");
    await page.locator("#nan-above").click();
    await upToDate(page);
    assert.notEqual((await state(page, "mesh")).triangles, outside);
    assert.match(await state(page, "command"), /--nan above/);
  });
});

test("the region of interest is that of the mesh", {...needs(), timeout: 3 * SLOW}, async () => {
  await viewing([ball, "--iso", "6"], async (page) => {
    await upToDate(page);
    await page.locator("#edit-region").click();
    const edge = await placeOfSample(page, 2, [63.5, 20, 20]);
    const to = await placeOfSample(page, 2, [31.5, 20, 20]);
    await page.mouse.move(edge.x, edge.y);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, {steps: 6});
    await page.mouse.up();
    await upToDate(page);
    assert.equal(await option(page, "roi"), "0:31,:,:");
    // Half of the ball, from 17.5 to 31 along x of the volume.
    const along = (await vertices(page)).map(([x, y]) => C * (x - 1000) + S * (y + 2000));
    assert.ok(Math.abs(Math.max(...along) - 31) < 1e-3, `${Math.max(...along)}`);
    assert.ok(Math.abs(Math.min(...along) - 17.5) < 1);
    assert.match(await page.locator("#mesh-line").textContent(), /genus 0/);
    const [{boundaryLoops}] = await state(page, "components");
    assert.equal(boundaryLoops, 1);
    await page.locator("#whole-volume").click();
    await upToDate(page);
    assert.equal((await state(page, "components"))[0].boundaryLoops, 0);
  });
});

test("512 x 512 x 512: preview, cancel, the whole volume", {...needs(), timeout: 10 * SLOW},
  async () => {
    const n = 512;
    const sine = Array.from({length: n}, (_, i) => Math.sin(i / 9));
    const far = (i, j, k) => Math.sqrt((i - 256) ** 2 + (j - 256) ** 2 + (k - 256) ** 2) +
      12 * sine[i] * sine[j] * sine[k];
    const path = writeVolume(join(folder, "large.nrrd"), [n, n, n], "uint8",
      (i, j, k) => Math.min(255, far(i, j, k)));
    await viewing([path, "--iso", "200.5", "--inside", "below"], async (page) => {
      await page.waitForFunction(() => window.isoatlas.mesh, null, {timeout: 3 * SLOW});
      const first = await state(page, "mesh");
      const line = () => page.locator("#mesh-line").textContent();
      if (!first.final) {
        assert.ok(first.reduction > 1);
        assert.match(await line(), /^Preview: every (\d) × \1 × \1 samples as one/);
        assert.ok((await meshPixels(page)) > 0.1);
      }
      await page.locator("#handle").focus();
      await page.keyboard.press("ArrowLeft");
      await clickWhile(page, "running", "#cancel-mesh");
      await page.waitForFunction(() => !window.isoatlas.running, null, {timeout: 2 * SLOW});
      assert.match(await line(), /cancelled|is still shown|There is no mesh yet/);
      await page.keyboard.press("ArrowLeft");
      await page.waitForFunction(() => window.isoatlas.upToDate, null, {timeout: 8 * SLOW});
      assert.match(await line(), /^Coarse mesh: .* certified/);
      const last = (await state(page, "timings")).at(-1);
      console.log(`512^3: first mesh after ${Math.round(last.first)} ms, ` +
        `final after ${Math.round(last.final)} ms`);
      assert.equal(await state(page, "isovalue"), 198.5);
      // Slices of 512 x 512 scroll.
      await page.locator("#slice-z").focus();
      await page.keyboard.press("PageUp");
      await page.waitForFunction(() =>
        document.querySelector("#slice-z").getAttribute("aria-busy") === "false");
      assert.deepEqual((await state(page, "position"))[2], 266);
    });
  });

test("saving is cancelled", {...needs(), timeout: 4 * SLOW}, async () => {
  await viewing([ball, "--iso", "6"], async (page) => {
    await upToDate(page);
    await page.locator("#max-distance").fill("0.002");
    await page.locator("#save").click();
    await clickWhile(page, "saving", "#cancel-save");
    await page.waitForFunction(() => !window.isoatlas.saving, null, {timeout: 2 * SLOW});
    assert.match(await page.locator("#save-status").textContent(), /Nothing was saved/);
  });
});

test("two pages; the tool ends with the last one", {...needs(), timeout: 3 * SLOW}, async () => {
  const server = await startView(protein);
  const window = {...SMALL, fresh: true};
  const [one, two] = [
    await openView(server.address, window), await openView(server.address, window)];
  await upToDate(one.page);
  await upToDate(two.page);
  await one.close();
  await two.page.locator("#handle").focus();
  await two.page.keyboard.press("ArrowRight");
  await upToDate(two.page);
  assert.deepEqual(two.trouble, []);
  await two.close();
  ends.push(server.ended);
});

test("changes of the isovalue leave the memory of tool and page flat",
  {...needs(), timeout: 10 * SLOW}, async () => {
    const shown = (page) =>
      page.waitForFunction(() => window.isoatlas.upToDate, null, {timeout: 3 * SLOW});
    await viewing([protein], async (page, server) => {
      await shown(page);
      const client = await page.context().newCDPSession(page);
      const used = async () => {
        await client.send("HeapProfiler.collectGarbage");
        return page.evaluate(() => performance.memory.usedJSHeapSize);
      };
      const change = async (times) => {
        await page.locator("#handle").focus();
        for (let k = 0; k < times; ++k) {
          await page.keyboard.press(k % 40 < 20 ? "ArrowRight" : "ArrowLeft");
          await shown(page);
        }
      };
      await change(40);
      const before = {page: await used(), tool: server.memory()};
      await change(80);
      const after = {page: await used(), tool: server.memory()};
      const inMb = (bytes) => (bytes / 1e6).toFixed(1);
      const text = (bytes) => `page ${inMb(bytes.page)}, tool ${inMb(bytes.tool)}`;
      console.log(`MB before: ${text(before)}; after 80 meshes: ${text(after)}`);
      assert.ok(after.page < before.page + 3e6);
      assert.ok(after.tool < before.tool + 12e6);
    }, {...TINY, fresh: true});
  });

/** Moves the handle and reports how soon a mesh follows. */
async function follows(name, isovalues) {
  await viewing([join(data, name)], async (page) => {
    await page.waitForFunction(() => window.isoatlas.mesh, null, {timeout: 3 * SLOW});
    for (const isovalue of isovalues) {
      const before = (await state(page, "mesh")).request;
      await type(page, "#isovalue", isovalue);
      await page.waitForFunction((r) => window.isoatlas.mesh.request > r, before);
    }
    await drawn(page);
    const times = (await state(page, "timings")).slice(-isovalues.length).map(({first}) => first);
    const shown = [0.5, 0.95].map((share) => Math.round(percentile(times, share)));
    console.log(`${name}: first mesh of ${times.length} isovalues: median ${shown[0]} ms, ` +
      `95 % within ${shown[1]} ms (goal: 500)`);
    // The goal is for an idle machine; this detects an order of magnitude.
    assert.ok(shown[1] < 10_000, `${times}`);
    assert.ok((await meshPixels(page)) > 0.02);
  });
}

test("the mesh follows on the head", {...needs("head_igea_sdf.nrrd"), timeout: 6 * SLOW}, () =>
  follows("head_igea_sdf.nrrd", Array.from({length: 12}, (_, k) => -3 + 0.5 * k)));

test("the mesh follows on the chest", {...needs("ct_chest.mha"), timeout: 6 * SLOW}, () =>
  follows("ct_chest.mha", Array.from({length: 8}, (_, k) => 40.5 + 18 * k)));

test("interrupted: the page reports it", {...needs(), timeout: 3 * SLOW}, async () => {
  const server = await startView(protein);
  const {page, close} = await openView(server.address);
  await upToDate(page);
  await server.stop();
  await page.waitForSelector("html[data-ended]");
  assert.match(await page.locator("#ended").textContent(), /isoatlas view has ended/);
  assert.ok(await page.locator("#save").isDisabled());
  assert.ok((await meshPixels(page)) > 0.02);
  await close();
});

test("the tool ends with its page, with status 0", {timeout: SLOW}, async () => {
  for (const {code, output} of await Promise.all(ends)) assert.equal(code, 0, output);
});
