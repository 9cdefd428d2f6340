// How soon is there a picture, and when is it sharp, over a link?
//
// In virtual time: through requests, decoding and drawing, and independent of the machine.

import { expect, inject, test } from "vitest";
import { RangeHost } from "../range-server.ts";
import { connect } from "./browser.ts";
import { expectPrompt } from "./looking.ts";

for (const pack of ["flat", "sphere"] as const) {
  test(`the ${pack} pack is seen, sharp and followed as soon as a link allows`, async () => {
    const browser = await connect(inject("browser"));
    const host = await RangeHost.of(inject("site"));
    try {
      await expectPrompt(browser, host.url, `${pack}.foveal`);
      expect(host.log.every(({ status }) => status === 200 || status === 206)).toBe(true);
    } finally {
      await browser.close();
      await host.close();
    }
  });
}
