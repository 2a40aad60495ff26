// SPDX-License-Identifier: Apache-2.0
// Finds the built page. ISOATLAS_PAGE_BUILD is the folder in which `npm ci && npm run build` ran
// (default: web/), ISOATLAS_PAGE_OUT the folder with page.js and page.css (default: its dist/).
import {createRequire} from "node:module";
import {dirname, join, resolve} from "node:path";
import {fileURLToPath, pathToFileURL} from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
export const repository = resolve(here, "../..");
export const buildFolder = resolve(process.env.ISOATLAS_PAGE_BUILD ?? join(repository, "web"));
export const bundleFolder = resolve(process.env.ISOATLAS_PAGE_OUT ?? join(buildFolder, "dist"));

const require = createRequire(join(buildFolder, "package.json"));
export const {chromium} = require("playwright-core");
export const {MeshoptEncoder} = await import(
  pathToFileURL(require.resolve("meshoptimizer/encoder")).href
);
