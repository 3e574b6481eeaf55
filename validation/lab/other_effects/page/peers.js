// What Python calls: a scene is handed over once, then each peer draws it with parameters. All are on WebGL 2, but Bevy's.

import { decode, encode } from "./browser/job.js";
import { Babylon } from "./babylon.js";
import { BevyBokeh, BevyGaussian } from "./bevy.js";
import { upsideDown } from "./feed.js";
import { CameraFrame } from "./playcanvas.js";
import { DepthOfFieldNode } from "./three_tsl.js";
import { BokehPass, DepthOfFieldEffect } from "./three_webgl.js";

const OPEN = { BokehPass, DepthOfFieldNode, DepthOfFieldEffect, Babylon, CameraFrame, BevyBokeh, BevyGaussian };

let scene = null;
const opened = new Map(); // name -> { set, draw, read }

// Images as job.js has them: half RGBA, and metres as floats
export function load({ color, depth, ...camera }) {
  const [width, height] = color.size;
  scene = { ...camera, width, height, color: decode(color), depth: decode(depth) };
  opened.clear();
}

// The picture, as job.js has it
export async function draw({ name, parameters }) {
  if (!opened.has(name)) opened.set(name, await OPEN[name](scene));
  const peer = opened.get(name);
  // three.js's nodes draw nothing at first
  for (let time = 0; time < 2; time++) {
    await peer.set(parameters);
    await peer.draw();
  }
  const data = await peer.read();
  const format = data instanceof Uint16Array ? "rgba16float" : "rgba32float";
  return encode({ size: [scene.width, scene.height], format }, upsideDown(data, scene));
}
