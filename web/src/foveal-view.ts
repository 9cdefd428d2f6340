// What does a page that imports `foveal-view` get?
//
// The element <foveal-view>, which importing this file defines, and the engine beneath it.

import { defineFovealView } from "./element/view-element.ts";

export * from "./engine/api.ts";
export { Engine } from "./engine/engine.ts";
export { FovealView } from "./element/view-element.ts";
export type { FovealViewEvents } from "./element/events.ts";

defineFovealView();
