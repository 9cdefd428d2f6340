// Which videos and pictures are there?

import { element } from "../element/dom.ts";
import { bytes, clock, spokenTime } from "../element/words.ts";
import { type Listed, addressOf, factsOf, fetchListing, titleOf } from "./listing.ts";

function item(pack: Listed): HTMLElement {
  const { poster } = pack;
  const picture = element("img", {
    src: `./${addressOf(poster.file)}`,
    width: poster.width,
    height: poster.height,
    alt: "",
    loading: "lazy",
  });
  const { seconds } = pack;
  const still = pack.projection === null ? "Scene" : "Picture";
  const length = seconds === null
    ? still
    : element("span", { "aria-label": spokenTime(seconds) }, clock(seconds));
  const facts = element("p", {}, length, `, ${factsOf(pack)}, ${bytes(pack.bytes)}`);
  const address = `./view.html?pack=${encodeURIComponent(pack.file)}`;
  const { description } = pack;
  const about = description === undefined ? [] : [element("p", { class: "about" }, description)];
  const title = element("h2", {}, titleOf(pack));
  return element("li", {}, element("a", { href: address }, picture, title, facts), ...about);
}

async function show(): Promise<void> {
  const wait = document.getElementById("wait");
  const list = document.getElementById("packs");
  if (wait === null || list === null) return;
  try {
    const packs = await fetchListing();
    list.replaceChildren(...packs.map(item));
    list.hidden = packs.length === 0;
    wait.hidden = packs.length > 0;
    if (packs.length === 0) wait.textContent = "Nothing is here yet.";
  } catch (error) {
    wait.className = "problem";
    wait.textContent = error instanceof Error ? error.message : String(error);
  }
}

void show();
