// SPDX-License-Identifier: Apache-2.0
// Pictures of the page of `isoatlas view`, for visual inspection: of a chest and a head, or of a
// made-up volume without the tool or without these.
import {existsSync} from "node:fs";
import {join} from "node:path";
import {test} from "node:test";

import {drawn, screenshots, SLOW} from "./browser.mjs";
import {openView, type, upToDate} from "./view_browser.mjs";
import {serveVolume} from "./view_server.mjs";
import {data, startView, tool} from "./view_tool.mjs";

const SIZES = [
  {name: "1440", width: 1440, height: 900},
  {name: "360", width: 360, height: 740, touch: true},
];

async function take(name, start, act = async () => undefined) {
  for (const {name: size, ...options} of SIZES) {
    const server = await start();
    const {page, close} = await openView(server.address, options);
    await upToDate(page);
    await act(page);
    await upToDate(page);
    await page.evaluate(() => scrollTo(0, 0));
    for (const theme of ["light", "dark"]) {
      await page.emulateMedia({colorScheme: theme});  // which the page follows
      await drawn(page);
      const path = (part) => join(screenshots, `view-${name}-${size}-${theme}${part}.png`);
      await page.screenshot({path: path("")});
      if (theme === "light") await page.screenshot({path: path("-whole"), fullPage: true});
    }
    await close();
    await server.stop();
  }
}

test("screenshots for visual inspection", {timeout: 20 * SLOW}, async () => {
  const real = (name, ...words) => () => startView(join(data, name), ...words);
  if (tool && existsSync(join(data, "ct_chest.mha"))) {
    await take("chest", real("ct_chest.mha", "--iso", "112.5"), async (page) => {
      await page.locator("#colouring-component").click();
    });
    await take("head", real("head_igea_sdf.nrrd"), async (page) => {
      await type(page, "#isovalue", "0");
      await type(page, "#region-z-last", "140");
    });
  } else {
    await take("balls", () => serveVolume("two"));
  }
});
