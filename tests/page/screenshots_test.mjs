// SPDX-License-Identifier: Apache-2.0
// Pictures for visual inspection.
import assert from "node:assert/strict";
import {join, resolve} from "node:path";
import {test} from "node:test";

import {
  SLOW,
  screenshots,
  fileOf,
  open,
  drawn,
  choose,
  slide,
} from "./browser.mjs";

async function clickShare(page, right, down) {
  await page.locator("#view").scrollIntoViewIfNeeded();
  const {x, y, width, height} = await page.locator("#view").boundingBox();
  await page.mouse.click(x + right * width, y + down * height);
}

test("screenshots for visual inspection", {timeout: 10 * SLOW}, async () => {
  const path = process.env.ISOATLAS_PAGE ? resolve(process.env.ISOATLAS_PAGE) : fileOf("ring").path;
  const take = async (name, options, ...ids) => {
    const {page, close} = await open(path, options);
    for (const id of ids) {
      if (id.startsWith("#")) await page.locator(id).click();
      else if (id.startsWith("@")) await clickShare(page, ...id.slice(1).split(",").map(Number));
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
  await take("1440-dark-cut-hollow", {dark: true}, "cut-x=0.4", "#fill-cuts");
  await take("1440-dark-cut-lines", {dark: true}, "cut-y=0.55", "style-lines");
  await take("1440-light-measured", {}, "#view-front", "#measure", "@0.35,0.55", "@0.7,0.65");
  await take("1440-dark-selected", {dark: true}, "colouring-component", "@0.5,0.45");
  const narrow = {width: 360, height: 740, touch: true};
  await take("360-light-selected", narrow, "#view-front", "@0.5,0.5");
  await take("1440-light-worst", {}, "style-lines", "colouring-aspect", "#worst");
  await take("1440-light-whole-page", {whole: true});
  await take("360-light", {width: 360, height: 740, touch: true, whole: true});
  await take(
    "360-dark-aspect",
    {width: 360, height: 740, touch: true, dark: true},
    "colouring-aspect",
  );
});
