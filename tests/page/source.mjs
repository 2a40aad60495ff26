// SPDX-License-Identifier: Apache-2.0
// Imports modules of the page from their TypeScript sources, for tests without a browser.
import {createRequire} from "node:module";
import {join} from "node:path";

import {buildFolder, repository} from "./modules.mjs";

const require = createRequire(join(buildFolder, "package.json"));
const {build} = createRequire(require.resolve("vite"))("esbuild");

/** @param path below web/src, such as "view/isoline.ts" */
export async function imported(path) {
  const {outputFiles: [{text}]} = await build({
    entryPoints: [join(repository, "web/src", path)],
    bundle: true,
    format: "esm",
    write: false,
    nodePaths: [join(buildFolder, "node_modules")],
  });
  return import(`data:text/javascript;base64,${Buffer.from(text).toString("base64")}`);
}
