// SPDX-License-Identifier: Apache-2.0
// One script and one style sheet per page, which CMake puts into the tool: page.js and page.css of
// the report page, view.js and view.css of `isoatlas view`. The mode is the name of the page.
import {readFileSync} from "node:fs";

import {defineConfig} from "vite";

const ENTRIES = {page: "src/main.ts", view: "src/view/main.ts"};
const LICENCES = {three: "LICENSE", meshoptimizer: "LICENSE.md"};

const licence = (name) => {
  const url = new URL(`node_modules/${name}/${LICENCES[name]}`, import.meta.url);
  return `${name}\n\n${readFileSync(url, "utf8").trim()}`;
};

/**
 * The licences require their text in every copy. The minifier would drop a comment, so the text is
 * inserted at the start afterwards.
 */
const notices = {
  name: "notices",
  enforce: "post",
  generateBundle(_, bundle) {
    for (const output of Object.values(bundle)) {
      if (output.type !== "chunk") continue;
      const contains = (name) =>
        Object.keys(output.modules).some((id) => id.includes(`/node_modules/${name}/`));
      const text = [
        "isoatlas page, SPDX-License-Identifier: Apache-2.0. It contains:",
        ...Object.keys(LICENCES).filter(contains).map(licence),
      ].join("\n\n");
      output.code = `/*!\n${text.replaceAll("*/", "* /")}\n*/\n${output.code}`;
      // The script stands inside an HTML page, where these would end it or hide its end.
      for (const forbidden of [/<\/script/i, /<!--/, /<script/i]) {
        if (forbidden.test(output.code)) this.error(`${output.fileName} contains ${forbidden}`);
      }
    }
  },
};

export default defineConfig(({mode}) => ({
  plugins: [notices],
  build: {
    target: "es2022",
    outDir: process.env.ISOATLAS_PAGE_OUT || "dist",
    emptyOutDir: mode === "page",
    cssCodeSplit: false,
    lib: {
      entry: ENTRIES[mode] ?? ENTRIES.page,
      formats: ["iife"],
      name: "isoatlasPage",
      fileName: () => `${mode}.js`,
      cssFileName: mode,
    },
  },
}));
