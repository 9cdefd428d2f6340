// What is said at an address where nothing lies?

import { missing } from "./missing.ts";

const all = document.getElementById("all");
const main = document.getElementById("main");
// The address may be of any depth: the link to the list shows where the site begins.
if (all instanceof HTMLAnchorElement && main !== null) {
  main.replaceChildren(missing(location.pathname, new URL(".", all.href).href));
}
