// What does a headset show pictures on?

/** What a headset shows pictures on. `WebGlTarget` is the one; a target over XRGPUBinding, which
 *  takes the engine's texture without a blit, is another once browsers have it. */
export interface XrTarget {
  /** Columns and rows for a view, or null where the view is not shown. */
  sizeOf(view: XRView): readonly [number, number] | null;
  /** Begins the pictures of one callback. */
  begin(): void;
  show(view: XRView, picture: ImageBitmap): void;
  end(): void;
}
