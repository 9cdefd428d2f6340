// How is one video shown on a page of its own?
//
// The address says which and how: ?pack=a.foveal, &demo, &policy=NAME, &target=JOD or
// &slope=SLOPE, &gaze=ws://127.0.0.1:PORT, &privacy=coarse, &muted, &paused, &once; and where in
// a sphere one looks: &yaw, &pitch, &fov.

import { DETAIL } from "../element/detail.ts";
import { DIRECTION, queryOf } from "../element/direction.ts";
import { element } from "../element/dom.ts";
import { type FovealView, defineFovealView } from "../element/view-element.ts";
import type { Stats } from "../engine/api.ts";
import { addressOf, factsOf, fetchListing, titleOf } from "./listing.ts";
import { missing } from "./missing.ts";

/** Parameters of the address that are attributes of the element. */
const FLAGS = ["demo", "muted", "paused", "once"] as const;
const VALUES = ["policy", "privacy", ...DETAIL, ...DIRECTION] as const;

/** How often the address is rewritten at most, in milliseconds: browsers refuse more than about ten
 *  a second. */
const REWRITE = 500;

function show(): void {
  const main = document.getElementById("main");
  if (main === null) return;
  const asked = new URLSearchParams(location.search);
  const pack = asked.get("pack");
  if (pack === null || pack === "") {
    const all = element("a", { href: "./index.html" }, "the list");
    const text = "This address names nothing to show; choose from ";
    main.replaceChildren(element("p", { class: "said" }, text, all, "."));
    return;
  }
  const title = (pack.split("/").pop() ?? pack).replace(/\.foveal$/, "");
  showTitle(title);
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
    showTitle("No such video");
    main.replaceChildren(missing(pack, "./"));
  });
  main.replaceChildren(view);
  view.focus();
  const tracker = asked.get("gaze");
  if (tracker !== null) askForGaze(view, tracker);
  keepInAddress(view);
  void showFacts(pack, view);
}

/** Asks before a tracker is connected to: a link from someone else must not do that. */
function askForGaze(view: FovealView, address: string): void {
  const yes = element("button", { type: "button" }, "Connect");
  const no = element("button", { type: "button" }, "No");
  const text = `Take the gaze of an eye tracker from ${address}? `;
  const question = element("p", { class: "said asked" }, text, yes, " ", no);
  yes.addEventListener("click", () => {
    view.setAttribute("gaze", address);
    question.remove();
    view.focus();
  });
  no.addEventListener("click", () => {
    question.remove();
    view.focus();
  });
  view.before(question);
}

function showTitle(title: string): void {
  const name = document.getElementById("name");
  if (name !== null) name.textContent = title;
  document.title = title;
}

/** Keeps where one looks in the address, so that it can be shared; not where a host, which sees an
 *  address when it is opened again, is to learn less than that. */
function keepInAddress(view: FovealView): void {
  if (![null, "tiles"].includes(view.getAttribute("privacy"))) return;
  let last: Stats | null = null;
  let isDue = false;
  const write = (): void => {
    isDue = false;
    if (last === null || view.pack?.kind !== "video" || view.pack.projection === "flat") return;
    const query = queryOf(location.search, last);
    if (query !== location.search) history.replaceState(history.state, "", query + location.hash);
  };
  const heard = ({ detail }: CustomEvent<Stats>): void => {
    last = detail;
    if (isDue) return;
    isDue = true;
    window.setTimeout(write, REWRITE);
  };
  view.addEventListener("stats", heard);
  view.addEventListener("settled", heard);
}

/** What the list says of it; a viewer works without. */
async function showFacts(pack: string, view: HTMLElement): Promise<void> {
  const packs = await fetchListing().catch(() => []);
  const listed = packs.find((one) => one.file === pack);
  const facts = document.getElementById("facts");
  if (listed === undefined) return;
  if (facts !== null) facts.textContent = factsOf(listed);
  showTitle(titleOf(listed));
  view.setAttribute("label", titleOf(listed));
  if (listed.description !== undefined) {
    facts?.after(element("p", { class: "about" }, listed.description));
  }
  view.setAttribute("poster", `./${addressOf(listed.poster.file)}`);
}

show();
