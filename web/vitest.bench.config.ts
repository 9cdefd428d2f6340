// How are the trials run that take minutes?

import { defineConfig } from "vitest/config";

export default defineConfig({
  test: {
    include: ["test/bench/*.test.ts"],
    globalSetup: ["test/e2e/setup.ts"],
    fileParallelism: false,
    hookTimeout: 300_000,
  },
});
