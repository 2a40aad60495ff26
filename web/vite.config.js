// One script and one style sheet, which CMake puts into the tool.
import {defineConfig} from "vite";

export default defineConfig({
  build: {
    target: "es2022",
    outDir: process.env.ISOATLAS_PAGE_OUT || "dist",
    emptyOutDir: true,
    cssCodeSplit: false,
    lib: {entry: "src/main.ts", formats: ["iife"], name: "isoatlasPage", fileName: () => "page.js", cssFileName: "page"},
  },
});
