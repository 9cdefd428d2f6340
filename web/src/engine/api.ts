// What can be asked of an engine, and what does it report?
//
// The element and the pages know only this file and `engine.ts`. Angles are in degrees where a
// name says so; places and sizes are in device pixels of the canvas; times are in seconds of the
// content.

/** The policies by which levels are chosen, by the names of `foveal --policy`. */
export const POLICIES = [
  "viewport",
  "acuity",
  "perceptual",
  "eccentricity",
  "uniform",
  "grid",
  "distance",
  "full",
  "coarsest",
] as const;

/** What scenes consist of. */
export const SAMPLES = ["triangles", "points"] as const;

/** How much of each of {@link SAMPLES} there is at the finest level. */
export type Samples = Readonly<Record<(typeof SAMPLES)[number], number>>;

/** One of {@link POLICIES}. */
export type PolicyName = (typeof POLICIES)[number];

/** A score in JOD, 1 to 9.99, that what is shown is to keep against every finest tile; or none. */
export type Target = number | "none";

/** A view of a sphere, in degrees; what is left out stays. */
export interface View {
  /** To the right of the front, -360 to 360. */
  readonly yawDeg?: number;
  /** Up from the horizon, -90 to 90. */
  readonly pitchDeg?: number;
  /** How wide it is, above 0, at most 140. */
  readonly fovDeg?: number;
}

/** What an engine begins with. */
export interface EngineOptions {
  /** Where the pack lies; relative to the document. */
  readonly src: string;
  /** The pointer is the gaze, and only what an eye there could see is fetched. */
  readonly demo?: boolean;
  /**
   * Which levels are wanted. Where it is left out: `acuity` with `slope`; with `demo`
   * `perceptual`, or `acuity` for scenes and for packs without signatures; else
   * `viewport`.
   */
  readonly policy?: PolicyName;
  /** The score that levels are chosen for; where it is left out, 9.5 for `acuity`, `perceptual`. */
  readonly target?: Target;
  /**
   * Of `acuity`, in place of a target: degrees by which the smallest pixel that an eye resolves
   * grows with each degree of eccentricity, 0 to 1.
   */
  readonly slope?: number;
  /** What a host may learn of where its viewer looks: single tiles, or 3 x 3 of them. */
  readonly privacy?: "tiles" | "coarse";
  /** Columns and rows of device pixels to begin with. */
  readonly size: readonly [number, number];
  /** Begin paused. */
  readonly paused?: boolean;
  /** Stay at the end instead of starting over. */
  readonly once?: boolean;
  /** Where drawing happens: a worker, or the page's own thread, as WebXR needs it. */
  readonly thread?: "worker" | "main";
  /** Most bytes of the pack that are kept in memory. */
  readonly cacheBytes?: number;
  /** Keeps what was selected and for which gaze, for {@link EngineApi.sessionLog}. */
  readonly log?: boolean;
  /** The screen as a person can measure it; guessed from the device where it is left out. */
  readonly screen?: {
    /** Device pixels of the whole screen. */
    readonly pixels: readonly [number, number];
    readonly diagonalInches: number;
    readonly distanceM: number;
  };
  /** The larger side of a sphere's view before zooming, in degrees; 100 where it is left out. */
  readonly fieldDeg?: number;
  /** Where a sphere's view begins; at its front where it is left out. */
  readonly view?: View;
}

/**
 * The policy of a demo with a pack: the first of these that the pack has the tables for. The
 * score of a scene is unknown, so `perceptual` would fetch all of it.
 */
export function demoPolicy({ kind, policies }: Pick<PackFacts, "kind" | "policies">): PolicyName {
  return kind === "video" && policies.includes("perceptual") ? "perceptual" : "acuity";
}

/** The policy that an engine begins with. */
export function firstPolicy(
  { policy, demo, slope }: Pick<EngineOptions, "policy" | "demo" | "slope">,
  pack: Pick<PackFacts, "kind" | "policies">,
): PolicyName {
  if (policy !== undefined) return policy;
  if (slope !== undefined) return "acuity";
  return demo ? demoPolicy(pack) : "viewport";
}

/** Whether the content decides by which policy an engine goes on once its tables are there. */
export function choosesItself(
  { policy, demo, slope }: Pick<EngineOptions, "policy" | "demo" | "slope">,
  { kind }: Pick<PackFacts, "kind">,
): boolean {
  return policy === undefined && slope === undefined && demo === true && kind === "video";
}

/** What is known of a pack once its beginning is there; a video has no samples of a scene. */
export interface PackFacts extends Samples {
  /** Pictures, one or many, or what an eye flies through. */
  readonly kind: "video" | "scene";
  /** Null for a scene. */
  readonly projection: "flat" | "cube" | "equirect" | null;
  /** Pixels of the content, or of a face, at the finest level; zeros for a scene. */
  readonly size: readonly [number, number];
  /** Faces of a cube, an eye; 0 for a scene, else 1. */
  readonly faces: number;
  /** Eyes with pictures of their own. */
  readonly eyes: 1 | 2;
  readonly levels: number;
  /** Empty for a scene. */
  readonly codec: string;
  readonly frames: number;
  /** Length of a round. */
  readonly seconds: number;
  readonly hasSound: boolean;
  readonly bytes: number;
  /** What the pack was made from. */
  readonly name: string;
  /** What draws: without a graphics device, the processor draws the coarsest level. */
  readonly drawing: "gpu" | "software";
  /** The policies that this pack has the tables for. */
  readonly policies: readonly PolicyName[];
}

/** Figures of the moment, and sums since the beginning. */
export interface Stats {
  readonly policy: PolicyName;
  /** The score that is asked for, in JOD; null where none is. */
  readonly target: number | null;
  /**
   * The score that what was chosen is expected to have against every finest tile, once all of it is
   * shown; null while that is not known, as it needs the pack's tables of its tiles.
   */
  readonly expectedScore: number | null;
  readonly playing: boolean;
  /** The time of the content, within a round. */
  readonly time: number;
  /** The frame on screen. */
  readonly frame: number;
  /** Pixels shown over all pixels of the finest level; of a scene triangles and points. */
  readonly share: number;
  /** Tiles on screen of each level, finest first; of a scene units. */
  readonly levels: readonly number[];
  /** Bytes that came from the host. */
  readonly bytesFetched: number;
  /** Requests that were made. */
  readonly requests: number;
  /** Bits per second while anything was on its way, lately. */
  readonly throughput: number;
  readonly cachedBytes: number;
  readonly gpuBytes: number;
  /** Milliseconds from a chunk to the planes of a tile, lately. */
  readonly decodeMs: number;
  /** Milliseconds of the page's work for a picture, lately. */
  readonly frameMs: number;
  readonly framesShown: number;
  /** Frames of the content that were never shown. */
  readonly framesLeftOut: number;
  /** Frames shown after their time. */
  readonly framesLate: number;
  /** Frames shown before all tiles were there. */
  readonly framesIncomplete: number;
  readonly damagedTiles: number;
  /** Whether what is on screen is what is wanted, with nothing missing. */
  readonly settled: boolean;
  /** Yaw, pitch and roll of the head in degrees. */
  readonly headDeg: readonly [number, number, number];
  /** Where the eye is in a scene, in metres. */
  readonly position: readonly [number, number, number];
  /** Triangles that the last picture drew of a scene. */
  readonly trianglesDrawn: number;
  readonly zoom: number;
  /** How wide the view of a sphere or a scene is, in degrees. */
  readonly fovDeg: number;
  /** Display pixels over one pixel of the content, in the middle. */
  readonly scale: number;
  /** The gaze: yaw and pitch in degrees of the content's forward. */
  readonly gazeDeg: readonly [number, number];
  /** Where the gaze is on the canvas, in device pixels; null outside. */
  readonly gazePlace: readonly [number, number] | null;
  /** Seconds from opening to the first picture; null before it. */
  readonly firstPicture: number | null;
  /** Round trips of the fetches that the first picture waited for, one after the other. */
  readonly firstPictureTrips: number | null;
  /** What draws: the graphics device as far as the browser names it, or the processor. */
  readonly drawing: string;
}

/** A record as docs/formats/gaze.md defines it. */
export interface GazeRecord {
  readonly t_s: number;
  readonly yaw_deg?: number | null;
  readonly pitch_deg?: number | null;
  readonly valid?: boolean | number | null;
  readonly spread_deg?: number | null;
  readonly head_yaw_deg?: number | null;
  readonly head_pitch_deg?: number | null;
  readonly head_roll_deg?: number | null;
  readonly space?: "content" | "head" | null;
}

/** A direction of the head, in degrees: right, up, clockwise. */
export interface Pose {
  readonly yawDeg: number;
  readonly pitchDeg: number;
  readonly rollDeg?: number;
}

/** To the right, up and ahead of a head. */
export type Towards = readonly [number, number, number];

/** A view of one eye of a headset, in the space of the content. */
export interface EyeRequest {
  readonly eye: "left" | "right";
  /** Where the eye is, in metres from where the head began. */
  readonly position: readonly [number, number, number];
  /** Orientation of the eye: x, y, z, w as WebXR gives it (-z forward, +y up). */
  readonly orientation: readonly [number, number, number, number];
  /** Tangents to the left, right, top and bottom edge; right and top are positive outwards. */
  readonly tangents: readonly [number, number, number, number];
  readonly size: readonly [number, number];
}

/** Opus packets of a stretch of the sound. */
export interface SoundPackets {
  readonly sampleRate: number;
  readonly channels: number;
  /** Samples that decoding yields before sample 0. */
  readonly preSkip: number;
  readonly packetSamples: number;
  /** Number of the first packet. */
  readonly first: number;
  readonly packets: readonly Uint8Array[];
  /** Packets of the whole track. */
  readonly total: number;
}

/** RGBA, 8 bits each, rows from the top. */
export interface Pixels {
  readonly width: number;
  readonly height: number;
  readonly data: Uint8Array;
}

/** Why nothing, or less, can be shown; `message` is a sentence for people. */
export interface EngineProblem {
  readonly kind:
    | "no-webgpu"
    | "no-ranges"
    | "not-found"
    | "network"
    | "broken-pack"
    | "codec"
    | "gaze"
    | "internal";
  readonly message: string;
  /** Nothing more will come of this engine. */
  readonly fatal: boolean;
}

/** What an engine reports by itself. */
export interface EngineEvents {
  /** The pack is understood; the first picture comes. */
  ready: PackFacts;
  /** A first, coarse picture, which lies over the canvas until there is a better one. */
  poster: ImageBitmap;
  /** The first picture is on the canvas, after so many seconds; time begins. */
  picture: number;
  /** All that is wanted in view is on the canvas. */
  settled: Stats;
  /** Twice a second while something changes. */
  stats: Stats;
  error: EngineProblem;
  /** The host has another file under this address now; the engine starts over with it. */
  changed: string;
  /** A device, worker or host is gone; what is on screen stays. */
  lost: "gpu" | "worker" | "network";
  restored: "gpu" | "worker" | "network";
  /** Playing began, paused, or reached its end. */
  play: number;
  pause: number;
  ended: number;
}

/** What the main thread can do with a pack on a canvas. */
export interface EngineApi {
  readonly pack: PackFacts;
  /** The canvas in use; another one after {@link lost worker} or {@link toThread}. */
  readonly canvas: HTMLCanvasElement;
  readonly thread: "worker" | "main";
  resize(width: number, height: number): void;
  /** Draws the content along by device pixels. */
  drag(dx: number, dy: number): void;
  /**
   * Flies through a scene, or no longer flies, along a direction of the head: to the right, up and
   * ahead, or against these where a number is negative.
   */
  fly(towards: Towards, isHeld: boolean, isHurried: boolean): void;
  /** Stays where it is in a scene. */
  stopFlying(): void;
  /** Comes closer by a factor; what is under the place stays there, and in a scene the eye goes
   *  ahead. */
  zoom(factor: number, place: readonly [number, number]): void;
  /** The head is turned by a sensor; the hand adds to it. */
  turn(pose: Pose | null): void;
  /** Turns the view of a sphere or a scene by hand; flat content stays as it is. */
  look(view: View): void;
  /** Back to the front of a sphere, the whole picture, or the start of a scene. */
  reset(): void;
  /** Where the pointer is, or null when it left. */
  pointer(place: readonly [number, number] | null): void;
  /**
   * A gaze from a tracker, an object or its JSON; null goes back to the pointer. What is wrong
   * with it comes as an `error` that is not fatal.
   */
  gaze(record: GazeRecord | string | null): void;
  play(): void;
  pause(): void;
  seek(seconds: number): void;
  step(frames: number): void;
  /** What is heard now, to which the picture keeps. */
  heard(seconds: number): void;
  setPolicy(name: PolicyName): void;
  /** Chooses for a score from now on; the usual one where nothing is said. */
  setTarget(target?: Target): void;
  /** Goes so many target scores on, or back; null where the policy has none. */
  nextTarget(by: number): Promise<Target | null>;
  showLevels(shown: boolean): void;
  stats(): Promise<Stats>;
  /** The packets of a stretch of time; null where the pack has no sound. */
  soundPackets(from: number, to: number): Promise<SoundPackets | null>;
  /** The picture on the canvas, once all that is wanted is there. */
  pixels(): Promise<Pixels>;
  /** What was selected and for which gaze, as `foveal replay` reads it. */
  sessionLog(): Promise<string>;
  /** Goes on in a worker or on the page's own thread, with all bytes that are there. */
  toThread(thread: "worker" | "main"): Promise<void>;
  /**
   * Draws what an eye of a headset sees, at once; levels follow both eyes' latest requests. Null
   * before the first picture. Only with thread "main"; the bitmap is the caller's to close.
   */
  drawEye(request: EyeRequest): ImageBitmap | null;
  /** Loses the graphics device or the worker, as tests do. */
  lose(what: "gpu" | "worker"): void;
  on<K extends keyof EngineEvents>(name: K, heard: (value: EngineEvents[K]) => void): () => void;
  close(): void;
}
