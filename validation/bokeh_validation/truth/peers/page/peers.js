// What Python calls: a scene is handed over once, then each peer draws it with parameters. All are on WebGL 2, but Bevy's.

import { decode } from "./browser/job.js";
import { MAPPED } from "./lens.js";
import { Babylon } from "./babylon.js";
import { BevyBokeh, BevyGaussian } from "./bevy.js";
import { upsideDown } from "./feed.js";
import { CameraFrame } from "./playcanvas.js";
import { DepthOfFieldNode } from "./three_tsl.js";
import { BokehPass, DepthOfFieldEffect, input } from "./three_webgl.js";

const OPEN = { input, BokehPass, DepthOfFieldNode, DepthOfFieldEffect, Babylon, CameraFrame, BevyBokeh, BevyGaussian };

let scene = null;
const opened = new Map(); // name -> { set, draw, read }
let record = null; // draws of the frame that is being counted

// ------------------------------------------------------------------------------------ what an engine asks of WebGL

const GL = WebGL2RenderingContext.prototype;
const sources = new WeakMap(); // shader -> text, program -> text of its fragment shader
const used = new WeakMap(); // context -> program

function after(name, then) {
  const original = GL[name];
  GL[name] = function (...given) {
    then(this, ...given);
    return original.apply(this, given);
  };
}

after("shaderSource", (_, shader, text) => sources.set(shader, text));
after("attachShader", (gl, program, shader) => {
  if (gl.getShaderParameter(shader, gl.SHADER_TYPE) === gl.FRAGMENT_SHADER) sources.set(program, sources.get(shader));
});
after("useProgram", (gl, program) => used.set(gl, program));
for (const name of ["drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"]) {
  after(name, (gl) => {
    // nor what is only put onto the canvas
    if (!record || gl.getParameter(gl.DRAW_FRAMEBUFFER_BINDING) === null) return;
    const [, , width, height] = gl.getParameter(gl.VIEWPORT);
    record.push({ text: sources.get(used.get(gl)), share: (width * height) / (scene.width * scene.height) });
  });
}

// ------------------------------------------------------------------------------------------------------------- calls

// { width, height, color: base64 of half RGBA, depth: base64 of float32 metres, near, far, fovy,
//   camera: as in lens.js }
export function load(given) {
  for (const { close } of opened.values()) close?.();
  opened.clear();
  scene = { ...given, color: decode({ type: "half", data: given.color }), depth: decode({ type: "float", data: given.depth }) };
}

// Of an effect, for the scene's lens
export const mapped = (name) => MAPPED[name](scene.camera, [scene.width, scene.height]);

async function ready(name, parameters) {
  if (!opened.has(name)) {
    const peer = await OPEN[name](scene);
    opened.set(name, peer);
    await peer.set(parameters);
    await peer.draw(); // three.js's nodes draw nothing at first
  }
  const peer = opened.get(name);
  await peer.set(parameters);
  return peer;
}

// The picture: base64 of half RGBA, first row on top
export async function draw({ name, parameters }) {
  const peer = await ready(name, parameters);
  await peer.draw();
  const data = await peer.read();
  return { data: new Uint8Array(upsideDown(data, scene).buffer).toBase64(), half: data instanceof Uint16Array };
}

// The draws of a frame: [{ text: of the fragment shader, share: of the picture that it covers }]
export async function draws({ name, parameters }) {
  const peer = await ready(name, parameters);
  await peer.draw(); // the first compiles
  await peer.set(parameters);
  record = [];
  await peer.draw();
  const frame = record;
  record = null;
  return frame;
}
