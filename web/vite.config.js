// SPDX-License-Identifier: Apache-2.0
// One script and one style sheet, page.js and page.css, which CMake puts into the tool.
import {readFileSync} from "node:fs";

import {defineConfig} from "vite";

const licence = (name, file) => {
  const url = new URL(`node_modules/${name}/${file}`, import.meta.url);
  return `${name}\n\n${readFileSync(url, "utf8").trim()}`;
};

/**
 * Both licences require their text in every copy. The minifier would drop a comment, so the text is
 * inserted at the start afterwards.
 */
const notices = {
  name: "notices",
  enforce: "post",
  generateBundle(_, bundle) {
    for (const output of Object.values(bundle)) {
      if (output.type !== "chunk") continue;
      const text = [
        "isoatlas page, SPDX-License-Identifier: Apache-2.0. It contains:",
        licence("three", "LICENSE"),
        licence("meshoptimizer", "LICENSE.md"),
      ].join("\n\n");
      output.code = `/*!\n${text.replaceAll("*/", "* /")}\n*/\n${output.code}`;
      // The script stands inside an HTML page, where these would end it or hide its end.
      for (const forbidden of [/<\/script/i, /<!--/, /<script/i]) {
        if (forbidden.test(output.code)) this.error(`${output.fileName} contains ${forbidden}`);
      }
    }
  },
};

export default defineConfig({
  plugins: [notices],
  build: {
    target: "es2022",
    outDir: process.env.ISOATLAS_PAGE_OUT || "dist",
    emptyOutDir: true,
    cssCodeSplit: false,
    lib: {
      entry: "src/main.ts",
      formats: ["iife"],
      name: "isoatlasPage",
      fileName: () => "page.js",
      cssFileName: "page",
    },
  },
});
