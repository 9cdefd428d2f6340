// What is said where something is asked for that is not there?

import { element } from "../element/dom.ts";
import { type Listed, factsOf, fetchListing, titleOf } from "./listing.ts";

/** Says what was asked for, and what can be opened instead; `root` is where the site begins. */
export function missing(asked: string, root: string): HTMLElement {
  const said = element("p", {}, "There is nothing at ", element("code", {}, decoded(asked)), ".");
  const instead = element("p", {}, element("a", { href: `${root}index.html` }, "The list"));
  const place = element("section", { class: "missing", role: "alert" }, said, instead);
  void fetchListing(root).then(
    (packs) => {
      if (packs.length === 0) return;
      const item = (pack: Listed): HTMLElement => {
        const address = `${root}view.html?pack=${encodeURIComponent(pack.file)}`;
        const link = element("a", { href: address }, titleOf(pack));
        return element("li", {}, link, `, ${factsOf(pack)}`);
      };
      place.append(element("p", {}, "These are here:"), element("ul", {}, ...packs.map(item)));
    },
    // Without a list the link to it is all that can be offered.
    () => undefined,
  );
  return place;
}

/** An address as people write it. */
function decoded(address: string): string {
  try {
    return decodeURIComponent(address);
  } catch {
    return address;
  }
}
