// How is the sound of a pack heard, in step with its pictures?
//
// The sound leads: packets are decoded a little ahead and put on the audio clock, and the engine is
// told what is heard, to which the pictures keep.

import type { EngineApi, SoundPackets } from "../engine/api.ts";

/** Seconds that are decoded ahead. */
const AHEAD = 1.5;
/** Seconds between two looks at what is decoded and heard. */
const TICK = 0.1;
/** Seconds before the first sample is heard after a start. */
const LEAD = 0.08;
/** Seconds of packets that a decoder needs before the first that is heard (RFC 7845). */
const PREROLL = 0.08;
/** Seconds of the longest packet: with so much more, the last one reaches to the end. */
const LONGEST_PACKET = 0.06;
/** Bytes of a track's packets asked for at once stay small: this many seconds. */
const PIECE = 0.5;

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
    const tick = (): void => {
      const heard = this.run?.tick();
      if (heard !== undefined && heard !== null) this.engine.heard(heard);
    };
    this.timer = window.setInterval(tick, 1000 * TICK);
    tick();
  }

  stop(): void {
    window.clearInterval(this.timer);
    this.run?.end();
    this.run = null;
  }
}

const RATE = 48_000;
const OPUS: AudioDecoderConfig = { codec: "opus", sampleRate: RATE, numberOfChannels: 2 };

/** Sound from one start until it ends. Times count on through the rounds of the content. */
class Run {
  /** Time of the audio clock at which content time `from` is heard. */
  private readonly begins: number;
  /** Content time up to which packets were asked for. */
  private asked: number;
  private busy = false;
  private ended = false;
  private readonly sources = new Set<AudioBufferSourceNode>();

  constructor(
    private readonly engine: EngineApi,
    private readonly context: AudioContext,
    private readonly to: AudioNode,
    private readonly from: number,
  ) {
    this.begins = context.currentTime + LEAD;
    this.asked = from;
  }

  /** Asks for what comes next; the content time that is heard now, null while nothing is. */
  tick(): number | null {
    if (this.context.state !== "running") return null;
    const latency = this.context.outputLatency || this.context.baseLatency || 0;
    const heard = this.from + this.context.currentTime - latency - this.begins;
    if (this.asked < heard + AHEAD) void this.fill();
    return heard < this.from ? null : heard % this.engine.pack.seconds;
  }

  end(): void {
    this.ended = true;
    for (const source of this.sources) source.stop();
    this.sources.clear();
  }

  private async fill(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    const { seconds } = this.engine.pack;
    const round = Math.floor(this.asked / seconds);
    const from = this.asked - round * seconds;
    const until = Math.min(from + PIECE, seconds);
    try {
      const begin = Math.max(0, from - PREROLL);
      const packets = await this.engine.soundPackets(begin, until + LONGEST_PACKET);
      if (packets !== null && !this.ended) {
        const samples = await decode(packets);
        if (!this.ended) this.place(packets, samples, round, from, until);
      }
      this.asked = round * seconds + until;
    } catch {
      // What cannot be had is silence; the pictures go on by themselves.
      this.asked = round * seconds + until;
    } finally {
      this.busy = false;
    }
  }

  /** Puts the samples of a stretch on the audio clock. */
  private place(
    packets: SoundPackets,
    channels: readonly Float32Array<ArrayBuffer>[],
    round: number,
    from: number,
    until: number,
  ): void {
    const first = packets.first * packets.packetSamples - packets.preSkip;
    const begin = Math.max(0, Math.round(from * RATE) - first);
    const length = channels[0]?.length ?? 0;
    const end = Math.min(length, Math.round(until * RATE) - first);
    if (end <= begin) return;
    const buffer = new AudioBuffer({
      length: end - begin,
      numberOfChannels: channels.length,
      sampleRate: RATE,
    });
    channels.forEach((samples, channel) => {
      buffer.copyToChannel(samples.subarray(begin, end), channel);
    });
    const time = round * this.engine.pack.seconds + (first + begin) / RATE;
    const at = this.begins + time - this.from;
    const late = Math.max(0, this.context.currentTime - at);
    if (late >= buffer.duration) return;
    const source = new AudioBufferSourceNode(this.context, { buffer });
    source.connect(this.to);
    source.addEventListener("ended", () => this.sources.delete(source));
    source.start(at + late, late);
    this.sources.add(source);
  }
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
