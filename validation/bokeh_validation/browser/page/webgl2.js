// WebGL 2: GLSL ES 3.00 through ANGLE. Row 0 of every image is v = 0: the first row of an upload and of readPixels() on
// a framebuffer is the bottom one in OpenGL's words. The validation draws onto no screen; the live page (demo/page) turns
// its picture over when it shows it.

import { decode, elements, encode } from "./job.js";

// Format -> that of a texture, and layout and type of an upload
const FORMATS = {
  rgba16float: ["RGBA16F", "RGBA", "HALF_FLOAT"],
  rgba32float: ["RGBA32F", "RGBA", "FLOAT"],
  r32float: ["R32F", "RED", "FLOAT"],
};

let gl = null;
let samplers = null; // by "is linear"
const programs = new Map(); // both sources -> linked program

// Make the context on first use, of a canvas that is seen or of none. Returns it.
export function start(canvas = new OffscreenCanvas(1, 1)) {
  if (gl && !gl.isContextLost()) return gl;
  gl = canvas.getContext("webgl2", { antialias: false, depth: false, alpha: true });
  if (!gl) throw new Error("this browser gives no WebGL 2 context");
  if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("no EXT_color_buffer_float: no float targets");
  if (!gl.getExtension("OES_texture_float_linear")) throw new Error("it does not filter 32-bit textures");
  gl.getExtension("EXT_color_buffer_half_float");
  samplers = { true: sampler(gl.LINEAR), false: sampler(gl.NEAREST) };
  programs.clear();
  gl.disable(gl.DITHER);
  return gl;
}

function sampler(filter) {
  const clamping = gl.createSampler();
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.samplerParameteri(clamping, name, filter);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.samplerParameteri(clamping, name, gl.CLAMP_TO_EDGE);
  return clamping;
}

// What the device is, and the bytes a pixel that all targets of a pass may have: there is room for four of any format.
export function describe() {
  start();
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const device = gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  return { device, attachmentBytes: 64 };
}

// { ok, lines of the compiler's and linker's logs, program } of a pair of stages
export function compile({ vertex, fragment }) {
  start();
  const program = gl.createProgram();
  const lines = [];
  // ANGLE ends its logs with a zero
  const note = (stage, log) => {
    for (const line of log.replace("\0", "").split("\n")) if (line.trim()) lines.push(`${stage}: ${line.trimEnd()}`);
  };
  let ok = true;
  const stages = [["vertex", gl.VERTEX_SHADER, vertex], ["fragment", gl.FRAGMENT_SHADER, fragment]];
  for (const [name, stage, source] of stages) {
    const shader = gl.createShader(stage);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    ok = gl.getShaderParameter(shader, gl.COMPILE_STATUS) && ok;
    note(name, gl.getShaderInfoLog(shader) ?? "");
    gl.attachShader(program, shader);
    gl.deleteShader(shader); // it goes with the program
  }
  if (ok) {
    gl.linkProgram(program);
    ok = gl.getProgramParameter(program, gl.LINK_STATUS);
    note("link", gl.getProgramInfoLog(program) ?? "");
  }
  return { ok, lines, program };
}

// A linked program, made once for each pair of sources.
export function linked(vertex, fragment) {
  const key = vertex + "\0" + fragment;
  if (!programs.has(key)) {
    const { ok, lines, program } = compile({ vertex, fragment });
    if (!ok) throw new Error(["ANGLE refused a shader:", ...lines].join("\n"));
    programs.set(key, program);
  }
  return programs.get(key);
}

// A texture of a job; a target is 0 everywhere, as WebGL has it.
export function texture({ size, format, data }) {
  const [internal, layout, type] = FORMATS[format].map((name) => gl[name]);
  const handle = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, handle);
  gl.texStorage2D(gl.TEXTURE_2D, 1, internal, ...size);
  // a row of any of these formats is a multiple of 4 bytes, the alignment that uploads and readPixels() have by default
  if (data) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ...size, layout, type, decode({ format, data }));
  return handle;
}

// Do something with a framebuffer of some targets, in the order of the shader's outputs.
export function onto(targets, step) {
  const framebuffer = gl.createFramebuffer();
  try {
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    const attachments = targets.map((target, index) => gl.COLOR_ATTACHMENT0 + index);
    targets.forEach((target, index) => {
      gl.framebufferTexture2D(gl.FRAMEBUFFER, attachments[index], gl.TEXTURE_2D, target, 0);
    });
    gl.drawBuffers(attachments);
    const status = gl.checkFramebufferStatus(gl.FRAMEBUFFER);
    if (status !== gl.FRAMEBUFFER_COMPLETE) throw new Error(`framebuffer incomplete: 0x${status.toString(16)}`);
    return step();
  } finally {
    gl.deleteFramebuffer(framebuffer);
  }
}

// Draw one pass into the framebuffer that is bound.
export function draw({ fragment, area, inputs, values }, vertex, textures) {
  const program = linked(vertex, fragment);
  gl.viewport(...area); // a triangle is clipped to it
  gl.useProgram(program);
  const bind = (unit, texture, sampler) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.bindSampler(unit, sampler);
  };
  // a uniform that the program does not use has no location, and setting it there does nothing
  inputs.forEach(({ slot, image, linear }, unit) => {
    bind(unit, textures[image], samplers[linear]);
    gl.uniform1i(gl.getUniformLocation(program, "Bokeh" + slot), unit);
  });
  for (const [name, value] of Object.entries(values)) gl.uniform1f(gl.getUniformLocation(program, name), value);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  // or a target would stay bound to a pass that reads fewer slots
  inputs.forEach((_, unit) => bind(unit, null, null));
}

// A target, in 32 bits: every one can be read as that, and a half float is the same number.
export function read(target, size) {
  const image = { size, format: "rgba32float" };
  const into = elements(image);
  onto([target], () => gl.readPixels(0, 0, ...size, gl.RGBA, gl.FLOAT, into));
  return encode(image, into);
}

// Run a job and return the images that it keeps.
export function run({ images, passes, keep, vertex }) {
  start();
  const textures = images.map(texture);
  try {
    for (const pass of passes) {
      onto(pass.targets.map((image) => textures[image]), () => draw(pass, vertex, textures));
    }
    const kept = keep.map((image) => read(textures[image], images[image].size));
    const error = gl.getError();
    if (error !== gl.NO_ERROR) throw new Error(`WebGL error 0x${error.toString(16)}`);
    return kept;
  } finally {
    for (const texture of textures) gl.deleteTexture(texture);
  }
}
