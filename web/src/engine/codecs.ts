// What do browsers call the codecs of a pack?

/** Profile, level and depth as every pack has them: 8 bits, 4:2:0. */
const NAMES: Readonly<Record<string, string>> = {
  vp8: "vp8",
  vp9: "vp09.00.61.08",
  h264: "avc1.640034",
  hevc: "hev1.1.6.L186.B0",
  av1: "av01.0.13M.08",
};

/** The decoder for a codec, or nothing where this browser has none. */
export async function configOf(codec: string): Promise<VideoDecoderConfig | null> {
  const name = NAMES[codec];
  if (!name || typeof VideoDecoder === "undefined") return null;
  // Tiles are small and many: hardware decoders are few and slow to begin.
  for (const hardwareAcceleration of ["prefer-software", "no-preference"] as const) {
    const config: VideoDecoderConfig = { codec: name, hardwareAcceleration };
    config.optimizeForLatency = true;
    const { supported } = await VideoDecoder.isConfigSupported(config);
    if (supported) return config;
  }
  return null;
}

/** Whether every access unit is a picture file of its own. */
export function isStills(codec: string): boolean {
  return codec === "jpeg" || codec === "png";
}
