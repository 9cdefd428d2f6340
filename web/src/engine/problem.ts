// What is said when something does not work?

import type { EngineProblem } from "./api.ts";

type Kind = EngineProblem["kind"];

const SENTENCES: Readonly<Record<Kind, string>> = {
  "no-webgpu":
    "This browser does not support WebGPU, which draws pictures; a current Chrome, Edge, Safari " +
    "or Firefox on a machine with a graphics device does.",
  "no-ranges":
    "This host does not serve parts of files (byte ranges), so nothing can be shown from " +
    "it; put the file on a host that does, as object stores and most web servers do.",
  "not-found": "There is no pack at this address.",
  network: "The host cannot be reached; trying again.",
  "broken-pack":
    "The file that the host sends cannot be read; ask the site's owner to copy it there again, " +
    "or to export the site again with the program that prepared it.",
  codec:
    "This browser cannot decode this video; ask the site's owner to prepare it with --codec vp9, " +
    "which all browsers decode.",
  gaze: "The gaze's sender sends something that is not a gaze.",
  internal:
    "The viewer failed; load the page again, and if that does not help, ask the site's owner to " +
    "export it again.",
};

/** A problem in words; `detail` says what was found. */
export function problem(kind: Kind, fatal: boolean, detail = ""): EngineProblem {
  const message = detail === "" ? SENTENCES[kind] : `${SENTENCES[kind]} (${detail})`;
  return { kind, message, fatal };
}

/** Whether something thrown is a problem already. */
export function isProblem(thrown: unknown): thrown is EngineProblem {
  return typeof thrown === "object" && thrown !== null && "kind" in thrown && "message" in thrown;
}

/** What was thrown, as a problem. */
export function problemOf(thrown: unknown): EngineProblem {
  return isProblem(thrown) ? thrown : problem("internal", true, String(thrown));
}
