// How is a picture put into the layer of a headset through WebGL?

import type { XrTarget } from "./xr-target.ts";

const VERTICES = `#version 300 es
// One triangle that covers the viewport; pictures have their first row on top.
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  place = vec2(corner.x + 1.0, 1.0 - corner.y) * 0.5;
  gl_Position = vec4(corner, 0.0, 1.0);
}`;

const COLOURS = `#version 300 es
precision mediump float;
uniform sampler2D picture;
in vec2 place;
out vec4 colour;
void main() { colour = vec4(texture(picture, place).rgb, 1.0); }`;

/** The framebuffer of an XRWebGLLayer. */
export class WebGlTarget implements XrTarget {
  private constructor(
    private readonly gl: WebGL2RenderingContext,
    private readonly layer: XRWebGLLayer,
  ) {}

  /** Makes a layer the session's. Rejects with a sentence for people. */
  static async in(session: XRSession): Promise<WebGlTarget> {
    const canvas = document.createElement("canvas");
    const gl = canvas.getContext("webgl2", { xrCompatible: true, antialias: false, alpha: false });
    if (gl === null) throw new Error("The headset needs WebGL 2, which this browser lacks.");
    const layer = new XRWebGLLayer(session, gl, { antialias: false, depth: false, alpha: false });
    await session.updateRenderState({ baseLayer: layer });
    gl.useProgram(program(gl));
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    for (const [name, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ] as const) {
      gl.texParameteri(gl.TEXTURE_2D, name, value);
    }
    return new WebGlTarget(gl, layer);
  }

  sizeOf(view: XRView): readonly [number, number] | null {
    const port = this.layer.getViewport(view);
    return port === null || port === undefined || port.width < 1 || port.height < 1
      ? null
      : [port.width, port.height];
  }

  begin(): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.layer.framebuffer);
    gl.clearColor(0, 0, 0, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
  }

  show(view: XRView, picture: ImageBitmap): void {
    const { gl } = this;
    const port = this.layer.getViewport(view);
    if (port === null || port === undefined) return;
    gl.viewport(port.x, port.y, port.width, port.height);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, picture);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  end(): void {
    this.gl.flush();
  }
}

function program(gl: WebGL2RenderingContext): WebGLProgram {
  const whole = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, VERTICES],
    [gl.FRAGMENT_SHADER, COLOURS],
  ] as const) {
    const shader = gl.createShader(kind);
    if (shader === null) throw new Error("The headset's graphics device is gone.");
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(whole, shader);
  }
  gl.linkProgram(whole);
  if (gl.getProgramParameter(whole, gl.LINK_STATUS) !== true) {
    throw new Error(`WebGL refuses a shader: ${gl.getProgramInfoLog(whole) ?? ""}`);
  }
  return whole;
}
