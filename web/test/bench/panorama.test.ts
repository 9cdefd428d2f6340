// How soon is a 16K panorama seen over a link, and when is it sharp?
//
// PANORAMA names the pack; without it the one that `foveal bench video` keeps is taken.

import { existsSync } from "node:fs";
import { rm, symlink } from "node:fs/promises";
import { homedir } from "node:os";
import { join } from "node:path";
import { inject, test } from "vitest";
import { connect } from "../e2e/browser.ts";
import { expectPrompt } from "../e2e/looking.ts";
import { RangeHost } from "../range-server.ts";

const CACHE = process.env.XDG_CACHE_HOME ?? join(homedir(), ".cache");
const PACK = process.env.PANORAMA ?? join(CACHE, "foveal/panorama-16k-2.foveal");
const HOW = "`foveal bench video --generate panorama-16k` makes one, or PANORAMA names one";

test.skipIf(!existsSync(PACK))(`a 16K panorama is seen within 0.6 s (${HOW})`, async () => {
  const link = join(inject("site"), "panorama.foveal");
  await symlink(PACK, link);
  const host = await RangeHost.of(inject("site"));
  const browser = await connect(inject("browser"));
  try {
    await expectPrompt(browser, host.url, "panorama.foveal");
  } finally {
    await browser.close();
    await host.close();
    await rm(link);
  }
}, 600_000);
