// How is one video shown on a page of its own?
//
// The address says which and how: ?pack=a.foveal, &demo, &policy=NAME, &gaze=ws://127.0.0.1:PORT,
// &privacy=coarse, &muted, &paused, &once.

import { element } from "../element/dom.ts";
import { defineFovealView } from "../element/view-element.ts";
import { addressOf, factsOf, fetchListing } from "./listing.ts";
import { missing } from "./missing.ts";

/** Parameters of the address that are attributes of the element. */
const FLAGS = ["demo", "muted", "paused", "once"] as const;
const VALUES = ["policy", "gaze", "privacy"] as const;

function show(): void {
  const main = document.getElementById("main");
  const name = document.getElementById("name");
  if (main === null || name === null) return;
  const asked = new URLSearchParams(location.search);
  const pack = asked.get("pack");
  if (pack === null || pack === "") {
    const all = element("a", { href: "./index.html" }, "all videos");
    const text = "This address names no video; choose one of ";
    main.replaceChildren(element("p", { class: "wait" }, text, all, "."));
    return;
  }
  const title = (pack.split("/").pop() ?? pack).replace(/\.foveal$/, "");
  name.textContent = title;
  document.title = title;
  const src = `./${addressOf(pack)}`;
  const attributes: Record<string, string | boolean> = { src, label: title };
  for (const flag of FLAGS) if (asked.has(flag)) attributes[flag] = true;
  for (const value of VALUES) {
    const given = asked.get(value);
    if (given !== null) attributes[value] = given;
  }
  defineFovealView();
  const view = element("foveal-view", attributes);
  view.addEventListener("problem", ({ detail }) => {
    if (detail.kind !== "not-found" || !detail.fatal) return;
    document.title = name.textContent = "No such video";
    main.replaceChildren(missing(pack, "./"));
  });
  main.replaceChildren(view);
  view.focus();
  void showFacts(pack, view);
}

/** What the list says of it; a viewer works without. */
async function showFacts(pack: string, view: HTMLElement): Promise<void> {
  const packs = await fetchListing().catch(() => []);
  const listed = packs.find((one) => one.file === pack);
  const facts = document.getElementById("facts");
  if (listed === undefined) return;
  if (facts !== null) facts.textContent = factsOf(listed);
  view.setAttribute("poster", `./${addressOf(listed.poster.file)}`);
}

show();
