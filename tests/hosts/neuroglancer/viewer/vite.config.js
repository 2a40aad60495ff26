// SPDX-License-Identifier: Apache-2.0
import {defineConfig} from "vite";

// The icons of the viewer's buttons come from a package that is not in the registry as a whole.
const icons = () => ({
  name: "icons",
  enforce: "pre",
  resolveId: (id) => (id.startsWith("ikonate/icons/") ? "\0icon" : null),
  load: (id) => (id === "\0icon" ? 'export default "<svg></svg>";' : null),
});

export default defineConfig({
  base: "./",
  plugins: [icons()],
  worker: {format: "es", plugins: () => [icons()]},
  build: {target: "esnext", minify: false, reportCompressedSize: false},
});
