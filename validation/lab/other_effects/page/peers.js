// What Python calls: a scene is handed over once, then each peer draws it with parameters. All are on WebGL 2, but Bevy's.

import { decode, encode } from "./browser/job.js";
import { Babylon } from "./babylon.js";
import { BevyBokeh, BevyGaussian } from "./bevy.js";
import { upsideDown } from "./feed.js";
import { polygonBokeh } from "./ours.js";
import { CameraFrame } from "./playcanvas.js";
import { DepthOfFieldNode } from "./three_tsl.js";
import { BokehPass, DepthOfFieldEffect } from "./three_webgl.js";

const OPEN = { BokehPass, DepthOfFieldNode, DepthOfFieldEffect, Babylon, CameraFrame, BevyBokeh, BevyGaussian };
for (const method of ["exact", "layered"]) {
  for (const preset of ["MOBILE", "LOW", "MEDIUM", "HIGH", "ULTRA"]) {
    OPEN[`${method} ${preset.toLowerCase()}`] = polygonBokeh(method, preset);
  }
}

let scene = null;
// name -> { set, draw, read }, and on WebGL { gl, enable } for time(); enable() turns the effect on or off, before set()
const opened = new Map();

// Images as job.js has them: half RGBA, and metres as floats
export function load({ color, depth, ...camera }) {
  const [width, height] = color.size;
  scene = { ...camera, width, height, color: decode(color), depth: decode(depth) };
  opened.clear();
}

async function peerOf(name) {
  if (!opened.has(name)) opened.set(name, await OPEN[name](scene));
  return opened.get(name);
}

// The picture, as job.js has it
export async function draw({ name, parameters }) {
  const peer = await peerOf(name);
  // three.js's nodes draw nothing at first
  for (let time = 0; time < 2; time++) {
    await peer.set(parameters);
    await peer.draw();
  }
  const data = await peer.read();
  const format = data instanceof Uint16Array ? "rgba16float" : "rgba32float";
  return encode({ size: [scene.width, scene.height], format }, upsideDown(data, scene));
}

// Waits until the GPU is done, by reading a pixel
function finish(gl) {
  const bound = gl.getParameter(gl.READ_FRAMEBUFFER_BINDING);
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, null);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  gl.bindFramebuffer(gl.READ_FRAMEBUFFER, bound);
}

// Milliseconds of a frame without the effect, and of a frame with it. Each draws two frames and times the second, because
// turning the effect on or off can make the first one slower.
export async function time({ name, parameters }) {
  const peer = await peerOf(name);
  const times = [];
  for (const on of [false, true]) {
    let start = 0;
    await peer.set(parameters); // Babylon.js makes its effect here on first use
    peer.enable(on);
    for (let frame = 0; frame < 2; frame++) {
      await peer.set(parameters);
      finish(peer.gl);
      start = performance.now();
      peer.draw();
      finish(peer.gl);
    }
    times.push(performance.now() - start);
  }
  return times;
}

// Name of the device that draws a peer
export async function device(name) {
  const { gl } = await peerOf(name);
  return gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL);
}
