// What does `packs.json` say?

import { parts } from "../element/words.ts";
import { SAMPLES, type Samples } from "../engine/api.ts";

/** A pack in the list; names are relative to the page. A video has no samples of a scene. */
export interface Listed extends Partial<Samples> {
  readonly name: string;
  /** What people read of it; the name where a list is too old to have one. */
  readonly title?: string;
  readonly description?: string;
  readonly licence?: string;
  readonly file: string;
  readonly poster: { readonly file: string; readonly width: number; readonly height: number };
  readonly bytes: number;
  /** Null for a scene, as its width and height. */
  readonly projection: "flat" | "cube" | "equirect" | null;
  readonly eyes: number;
  readonly width: number | null;
  readonly height: number | null;
  /** Null for what does not move. */
  readonly seconds: number | null;
  readonly sound: boolean;
}

/** Fetches the list that lies at `root`. Rejects with a sentence for people. */
export async function fetchListing(root = "./"): Promise<readonly Listed[]> {
  const answer = await fetch(`${root}packs.json`).catch(() => null);
  if (answer === null) throw new Error("The list of packs cannot be fetched: is the host there?");
  if (!answer.ok) {
    throw new Error(`The host has no list of packs (packs.json: ${answer.status}).`);
  }
  const listing: unknown = await answer.json().catch(() => null);
  if (typeof listing !== "object" || listing === null || !("packs" in listing)) {
    throw new Error("packs.json is no list of packs; export the site again.");
  }
  const { packs } = listing;
  if (!Array.isArray(packs) || !packs.every(isListed)) {
    throw new Error("packs.json lists something else than packs; export the site again.");
  }
  return packs;
}

function isListed(one: unknown): one is Listed {
  if (typeof one !== "object" || one === null) return false;
  const is = (of: object, type: "string" | "number" | "boolean", names: readonly string[]) =>
    names.every((name) => typeof (of as Record<string, unknown>)[name] === type);
  const { poster } = one as { poster?: unknown };
  const samples = SAMPLES.filter((name) => name in one);
  const isScene = samples.length > 0;
  const said = ["title", "description", "licence"].filter((name) => name in one);
  return (
    is(one, "string", said) &&
    is(one, "string", ["name", "file", ...(isScene ? [] : ["projection"])]) &&
    is(one, "number", ["bytes", "eyes", ...(isScene ? samples : ["width", "height"])]) &&
    ((one as { seconds?: unknown }).seconds === null || is(one, "number", ["seconds"])) &&
    is(one, "boolean", ["sound"]) &&
    typeof poster === "object" &&
    poster !== null &&
    is(poster, "string", ["file"]) &&
    is(poster, "number", ["width", "height"])
  );
}

/** A name in an address, folder by folder. */
export function addressOf(file: string): string {
  return file.split("/").map(encodeURIComponent).join("/");
}

/** How a pack is called. */
export function titleOf(pack: Listed): string {
  return pack.title ?? pack.name;
}

/** What a pack is, in a few words. */
export function factsOf(pack: Listed): string {
  const licence = pack.licence === undefined ? "" : `, ${pack.licence}`;
  if (pack.projection === null) return `${parts(pack)}${licence}`;
  const kind = pack.projection === "flat" ? "flat" : "360°";
  const eyes = pack.eyes === 2 ? ", 3D" : "";
  const sound = pack.sound ? ", sound" : "";
  return `${kind}${eyes}, ${pack.width} × ${pack.height}${sound}${licence}`;
}
