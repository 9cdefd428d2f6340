// What does a page that imports `foveal-view` get?

export * from "./engine/api.ts";
export { Engine } from "./engine/engine.ts";
