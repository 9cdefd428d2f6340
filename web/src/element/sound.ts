// How is the sound of a pack heard, in step with its pictures?
//
// The sound leads: packets are decoded a little ahead and put on the audio clock, and the engine
// learns what is heard; the pictures follow it.

import type { EngineApi, SoundPackets } from "../engine/api.ts";

/** Seconds that are decoded ahead: more than a busy machine, or a hidden page, leaves out. */
const AHEAD = 3;
/** Seconds between two looks at what is decoded and heard. */
const TICK = 0.1;
/** Seconds before the first sample is heard after a start. */
const LEAD = 0.08;
/** Seconds of packets that a decoder needs before the first that is heard (RFC 7845). */
const PREROLL = 0.08;
/** Seconds of the longest packet: with so much more, the last one reaches to the end. */
const LONGEST_PACKET = 0.06;
/** Packets asked for at once stay few: this many seconds. */
const PIECE = 1;
/** Seconds that the pictures wait for sound that is not decoded in time. */
const PATIENCE = 0.5;
/** Seconds after which sound that was waited for begins where the pictures are by then. */
const STALE = 0.2;

/** Plays the sound of one pack. */
export class Sound {
  private context: AudioContext | null = null;
  private loudness: GainNode | null = null;
  private run: Run | null = null;
  private timer = 0;

  constructor(private readonly engine: EngineApi) {}

  /** Whether it can be heard here: the pack has sound and the browser decodes Opus. */
  static async isPossible(engine: EngineApi): Promise<boolean> {
    if (!engine.pack.hasSound || !("AudioDecoder" in window)) return false;
    const support = await AudioDecoder.isConfigSupported(OPUS).catch(() => null);
    return support?.supported === true;
  }

  /** Whether it is on. */
  get isOn(): boolean {
    return this.context !== null;
  }

  /** Turns it on, which browsers allow after a gesture; begins at `seconds` where it plays. */
  async turnOn(playing: boolean, seconds: number): Promise<void> {
    if (this.context !== null) return;
    const context = new AudioContext({ sampleRate: RATE, latencyHint: "playback" });
    this.context = context;
    this.loudness = new GainNode(context);
    this.loudness.connect(context.destination);
    await context.resume();
    if (playing) this.start(seconds);
  }

  turnOff(): void {
    this.stop();
    void this.context?.close();
    this.context = null;
    this.loudness = null;
  }

  /** Begins at a time of the content; what was heard ends. */
  start(seconds: number): void {
    this.stop();
    if (this.context === null || this.loudness === null) return;
    this.run = new Run(this.engine, this.context, this.loudness, seconds);
    this.timer = window.setInterval(() => this.tick(), 1000 * TICK);
    this.tick();
  }

  private tick(): void {
    const heard = this.run?.tick() ?? null;
    if (heard !== null) this.engine.heard(heard);
  }

  stop(): void {
    window.clearInterval(this.timer);
    this.run?.end();
    this.run = null;
  }
}

const RATE = 48_000;
const OPUS: AudioDecoderConfig = { codec: "opus", sampleRate: RATE, numberOfChannels: 2 };

/** A stretch of the content on the audio clock without a break; times in seconds. */
interface Line {
  /** Time of the content that is heard at time `at` of the clock. */
  readonly time: number;
  readonly at: number;
}

/** Sound from one start until it ends. Times count on through the rounds of the content. */
class Run {
  /** What is heard when; null before there is anything. */
  private line: Line | null = null;
  /** Content time up to which samples are on the clock. */
  private placed: number;
  /** Since when sound is waited for, by the clock; null once it was joined to the pictures. */
  private waits: number | null;
  private busy = false;
  private ended = false;
  private readonly sources = new Set<AudioBufferSourceNode>();

  constructor(
    private readonly engine: EngineApi,
    private readonly context: AudioContext,
    private readonly to: AudioNode,
    from: number,
  ) {
    this.placed = from;
    this.waits = context.currentTime;
  }

  /** Asks for what comes next; the content time that is heard now, null while nothing is. */
  tick(): number | null {
    if (this.context.state !== "running") return null;
    void this.fill();
    if (this.line === null) return null;
    const latency = this.context.outputLatency || this.context.baseLatency || 0;
    const heard = this.line.time + this.context.currentTime - latency - this.line.at;
    if (heard < this.line.time) return null;
    // What is not there yet holds the pictures up for a moment; then they go on without it.
    if (heard > this.placed + PATIENCE) {
      this.line = null;
      this.waits = 0;
    }
    return Math.min(heard, this.placed) % this.engine.pack.seconds;
  }

  end(): void {
    this.ended = true;
    for (const source of this.sources) source.stop();
    this.sources.clear();
  }

  /** Seconds from what is heard to the end of what is on the clock. */
  private get ahead(): number {
    if (this.line === null) return 0;
    return this.placed - (this.line.time + this.context.currentTime - this.line.at);
  }

  private async fill(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    try {
      while (!this.ended && this.ahead < AHEAD && (await this.piece()));
    } catch {
      // The worker is gone or its answer is no sound: the next tick asks again.
    } finally {
      this.busy = false;
    }
  }

  /** Puts the next stretch on the clock; whether there was one. */
  private async piece(): Promise<boolean> {
    const { seconds } = this.engine.pack;
    const round = Math.floor(this.placed / seconds);
    const from = this.placed - round * seconds;
    const until = Math.min(from + PIECE, seconds);
    const begin = Math.max(0, from - PREROLL);
    const packets = await this.engine.soundPackets(begin, until + LONGEST_PACKET);
    if (packets === null || this.ended) return false;
    if (this.waits !== null && this.context.currentTime - this.waits > STALE) {
      // The pictures went on meanwhile.
      this.waits = null;
      this.placed = (await this.engine.stats()).time;
      return true;
    }
    const samples = await decode(packets).catch(() => null);
    if (this.ended) return false;
    // What is damaged is silence.
    this.place(samples && bufferOf(packets, samples, from, until), until - from);
    return true;
  }

  /** Puts samples where those before them end, or as soon as can be where these are over. */
  private place(buffer: AudioBuffer | null, seconds: number): void {
    this.waits = null;
    const soonest = this.context.currentTime + (this.line === null ? LEAD : 0);
    const follows = this.line && this.line.at + this.placed - this.line.time;
    if (this.line === null || follows === null || follows < soonest) {
      this.line = { time: this.placed, at: soonest };
    }
    const at = this.line.at + this.placed - this.line.time;
    this.placed += seconds;
    if (buffer === null) return;
    const source = new AudioBufferSourceNode(this.context, { buffer });
    source.connect(this.to);
    source.addEventListener("ended", () => this.sources.delete(source));
    source.start(at);
    this.sources.add(source);
  }
}

/** The samples from one time of the content to another; null where there are none. */
function bufferOf(
  packets: SoundPackets,
  channels: readonly Float32Array<ArrayBuffer>[],
  from: number,
  until: number,
): AudioBuffer | null {
  const first = packets.first * packets.packetSamples - packets.preSkip;
  const begin = Math.max(0, Math.round(from * RATE) - first);
  const end = Math.min(channels[0]?.length ?? 0, Math.round(until * RATE) - first);
  if (end <= begin) return null;
  const buffer = new AudioBuffer({
    length: end - begin,
    numberOfChannels: channels.length,
    sampleRate: RATE,
  });
  channels.forEach((samples, channel) => {
    buffer.copyToChannel(samples.subarray(begin, end), channel);
  });
  return buffer;
}

/** The samples of packets that follow each other, channel by channel. */
async function decode(packets: SoundPackets): Promise<Float32Array<ArrayBuffer>[]> {
  const { channels, packetSamples } = packets;
  const length = packets.packets.length * packetSamples;
  const samples = Array.from({ length: channels }, () => new Float32Array(length));
  let done = 0;
  let failure: DOMException | null = null;
  const decoder = new AudioDecoder({
    output: (part) => {
      samples.forEach((into, channel) => {
        const room = into.subarray(done, done + part.numberOfFrames);
        const options = { planeIndex: channel, format: "f32-planar" as const };
        if (room.length === part.numberOfFrames) part.copyTo(room, options);
      });
      done += part.numberOfFrames;
      part.close();
    },
    error: (error) => {
      failure = error;
    },
  });
  decoder.configure({ ...OPUS, numberOfChannels: channels });
  packets.packets.forEach((data, index) => {
    const timestamp = Math.round((index * packetSamples * 1e6) / RATE);
    decoder.decode(new EncodedAudioChunk({ type: "key", timestamp, data }));
  });
  await decoder.flush();
  decoder.close();
  if (failure !== null) throw failure as DOMException;
  return samples;
}
