// Draws the frames of both sides and shows them beside each other: WebGL 2, by the code that the validation draws with.

import { elements, encode } from "../../browser/page/job.js";
import { draw, linked, onto, start, texture } from "../../browser/page/webgl2.js";

// Both pictures, exposed by a filmic curve (Narkowicz's fit of ACES) as in the documentation's. v = 0 is the first row
// of a picture, and the bottom one of a canvas.
const SHOW = `#version 300 es
precision highp float;
uniform sampler2D BokehLeft, BokehRight;
uniform float split, exposure;
in vec2 BokehUV;
out vec4 shown;
void main()
{
    vec2 size = vec2(textureSize(BokehLeft, 0));
    ivec2 place = ivec2(vec2(BokehUV.x, 1.0 - BokehUV.y) * size);
    vec3 color = BokehUV.x < split ? texelFetch(BokehLeft, place, 0).rgb : texelFetch(BokehRight, place, 0).rgb;
    vec3 x = clamp(color, 0.0, 65504.0) * exposure;
    x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    shown = vec4(pow(clamp(x, 0.0, 1.0), vec3(1.0 / 2.2)), 1.0);
}`;

let gl = null;
let canvas = null;
let vertex = "";
let size = [1, 1];
const handed = {}; // color, depth, truth -> texture
const pool = new Map(); // "side name" -> { size, handle }

export function open(element, data) {
  canvas = element;
  ({ vertex } = data);
  gl = start(canvas);
}

// Take other pictures: images as in job.js; truth may be null.
export function load({ color, depth, truth }) {
  for (const old of [...Object.values(handed), ...[...pool.values()].map(({ handle }) => handle)]) gl.deleteTexture(old);
  pool.clear();
  for (const name of Object.keys(handed)) delete handed[name];
  size = color.size;
  [canvas.width, canvas.height] = size;
  handed.color = texture(color);
  handed.depth = texture(depth);
  if (truth) handed.truth = texture(truth);
}

export function largest() {
  return gl.getParameter(gl.MAX_TEXTURE_SIZE);
}

function target(side, name, [width, height]) {
  const key = `${side} ${name}`;
  const old = pool.get(key);
  if (old?.size[0] === width && old.size[1] === height) return old.handle;
  if (old) gl.deleteTexture(old.handle);
  const handle = texture({ size: [width, height], channels: 4, type: "half" });
  pool.set(key, { size: [width, height], handle });
  return handle;
}

// Take what another has drawn for a side.
export function put(side, name, image) {
  const key = `${side} ${name}`;
  if (pool.has(key)) gl.deleteTexture(pool.get(key).handle);
  pool.set(key, { size: image.size, handle: texture(image) });
}

// Draw the passes of a side and wait for the end; returns milliseconds, without those of compiling.
export function run(side, passes) {
  for (const { fragment } of passes) linked(vertex, fragment);
  const textures = { ...handed };
  const before = performance.now();
  for (const pass of passes) {
    const targets = pass.targets.map((name) => (textures[name] = target(side, name, pass.size)));
    onto(targets, () => draw({ ...pass, area: [0, 0, ...pass.size] }, vertex, textures));
  }
  texel(textures[passes.at(-1).targets[0]], 0, 0); // what is read has to be drawn
  return performance.now() - before;
}

function texel(handle, x, y) {
  const value = new Float32Array(4);
  onto([handle], () => gl.readPixels(x, y, 1, 1, gl.RGBA, gl.FLOAT, value));
  return value;
}

// r, g, b, a of a texel.
export function read(side, name, x, y) {
  return texel(textureOf(side, name).handle, x, y);
}

// An image as job.js has it, of what a side shows or has drawn; always of four 32-bit channels.
export function picture(side, name) {
  const { handle, size: whole } = textureOf(side, name);
  const image = { size: whole, channels: 4, type: "float" };
  const values = elements(image);
  onto([handle], () => gl.readPixels(0, 0, ...whole, gl.RGBA, gl.FLOAT, values));
  return encode(image, values);
}

// { handle, size } of it.
function textureOf(side, name) {
  return handed[name] ? { handle: handed[name], size } : pool.get(`${side} ${name}`);
}

// Show both sides on the canvas: the names of their pictures.
export function show(left, right, split, exposure) {
  const textures = { left: textureOf("left", left).handle, right: textureOf("right", right).handle };
  const inputs = [
    { slot: "Left", image: "left", linear: false },
    { slot: "Right", image: "right", linear: false },
  ];
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  draw({ fragment: SHOW, area: [0, 0, ...size], inputs, values: { split, exposure } }, vertex, textures);
}
