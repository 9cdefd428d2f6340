// Does the npm package describe the element to editors and compilers as it is?

import { execFile } from "node:child_process";
import { mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import { afterAll, beforeAll, expect, test } from "vitest";

const run = promisify(execFile);
const web = join(import.meta.dirname, "../..");

interface Named {
  readonly name: string;
  readonly kind?: string;
}

interface Declared {
  readonly tagName: string;
  readonly attributes: readonly Named[];
  readonly members: readonly Named[];
  readonly events: readonly Named[];
}

let folder: string;
let declared: Declared;

/** Packs the package, and installs it into a folder of another project. */
beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), "foveal-package-"));
  const at = join(folder, "node_modules/foveal-view");
  await mkdir(at, { recursive: true });
  const words = ["pack", "--silent", "--ignore-scripts", "--pack-destination", folder];
  const { stdout } = await run("npm", words, { cwd: web });
  const packed = join(folder, stdout.trim());
  await run("tar", ["xzf", packed, "-C", at, "--strip-components", "1"]);
  const about = JSON.parse(await readFile(join(at, "package.json"), "utf8")) as {
    customElements: string;
  };
  const manifest = JSON.parse(await readFile(join(at, about.customElements), "utf8")) as {
    modules: { path: string; declarations: Declared[] }[];
  };
  const [module] = manifest.modules;
  const [first] = module?.declarations ?? [];
  if (module === undefined || first === undefined) throw new Error("the manifest is empty");
  // What it points at is in the package.
  await readFile(join(at, module.path));
  declared = first;
});

afterAll(() => rm(folder, { recursive: true, force: true }));

/** What the compiler says of a program that imports the package. */
async function compiled(program: string, module: "nodenext" | "preserve"): Promise<string> {
  await writeFile(join(folder, "consumer.ts"), program);
  const resolution = module === "nodenext" ? "nodenext" : "bundler";
  const compilerOptions = {
    target: "es2022",
    lib: ["es2022", "dom", "dom.iterable"],
    types: [],
    strict: true,
    noEmit: true,
    module,
    moduleResolution: resolution,
  };
  const config = { compilerOptions, files: ["consumer.ts"] };
  await writeFile(join(folder, "tsconfig.json"), JSON.stringify(config));
  await writeFile(join(folder, "package.json"), '{"type":"module"}');
  const compiler = join(web, "node_modules/typescript/bin/tsc");
  return run("node", [compiler, "-p", folder]).then(
    ({ stdout }) => stdout,
    (failed: { stdout: string }) => failed.stdout,
  );
}

const record = (all: readonly Named[]): string =>
  JSON.stringify(Object.fromEntries(all.map(({ name }) => [name, true])));

test("a program that uses the element compiles against the package's types", async () => {
  const program = `
    import { Engine, FovealView, POLICIES, type PackFacts, type Stats } from "foveal-view";
    const view = document.createElement("foveal-view");
    const same: FovealView = view;
    view.addEventListener("settled", ({ detail }) => {
      const share: number = detail.share;
      console.log(share, detail.headDeg[0], detail.fovDeg, same.pack?.seconds, POLICIES[0]);
    });
    const pose: Promise<{ rollDeg: number }> = view.pose({ yawDeg: 30, pitchDeg: 10 });
    const stats: Promise<Stats> = view.stats();
    const facts: Promise<PackFacts> = Engine.open(document.body, {
      src: "a.foveal", size: [640, 360], view: { yawDeg: 10, fovDeg: 60 },
    }).then((engine) => engine.pack);
    void [pose, stats, facts];
    // @ts-expect-error
    view.seek("1");
    // @ts-expect-error
    view.addEventListener("settled", ({ detail }) => detail.nothing);
  `;
  for (const module of ["nodenext", "preserve"] as const) {
    expect(await compiled(program, module)).toBe("");
  }
});

test("the manifest lists the events, calls and fields of the element, no others", async () => {
  const program = `
    import type { FovealView, FovealViewEvents } from "foveal-view";
    type Own = Exclude<keyof FovealView, keyof HTMLElement | \`\${string}Callback\`>;
    const events: Record<keyof FovealViewEvents, true> = ${record(declared.events)};
    const members: Record<Own, true> = ${record(declared.members)};
    type Call = (...given: never) => unknown;
    type Calls = { [K in Own]: FovealView[K] extends Call ? K : never }[Own];
    const calls: Record<Calls, true> =
      ${record(declared.members.filter(({ kind }) => kind === "method"))};
    void [events, members, calls];
  `;
  expect(await compiled(program, "preserve")).toBe("");
  expect(declared.tagName).toBe("foveal-view");
});

test("the document describes every attribute, call and event of the manifest", async () => {
  const text = await readFile(join(web, "../docs/concepts/browser.md"), "utf8");
  const table = text.slice(text.indexOf("## The element"));
  for (const { name } of [...declared.attributes, ...declared.members, ...declared.events]) {
    expect(table, name).toMatch(new RegExp(`^\\|.*\`${name}\\b.*\\|`, "m"));
  }
});
