// How do sources become the folder of files that a static host serves?

import { existsSync } from "node:fs";
import { defineConfig } from "vitest/config";

const pages = ["index.html", "view.html", "404.html"].filter((page) => existsSync(page));

export default defineConfig({
  // Everything is found next to the page, wherever the folder lies.
  base: "./",
  build: {
    target: "es2022",
    outDir: "dist",
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    rolldownOptions: {
      input: [...pages, "src/foveal-view.ts"],
      preserveEntrySignatures: "exports-only",
      output: {
        // The element has a name that a page can write down; all else is named by its content.
        entryFileNames: (chunk) =>
          chunk.name === "foveal-view" ? "foveal-view.js" : "assets/[name]-[hash].js",
      },
    },
  },
  worker: { format: "es" },
  test: { include: ["src/**/*.test.ts"] },
});
