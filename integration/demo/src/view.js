// Draws the frames of both sides, and shows them side by side, in WebGL 2, with the code that the validation draws
// with.

import { draw, linked, onto, read, start, texture } from "@validation/bokeh_validation/browser/page/webgl2.js";

// Shows both images, with a filmic curve (Narkowicz's fit of ACES), as for the images of the documentation. v = 0 is
// the first row of an image, but the bottom row of the canvas.
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
const images = new Map(); // color, depth and truth of the scene, and "SIDE NAME" for other images -> { size, handle }

export function open(element, data) {
  canvas = element;
  vertex = data.vertex + data.glsl;
  gl = start(canvas);
}

// Replaces the images of the scene. They have the form that job.js describes; truth may be null.
export function load({ color, depth, truth }) {
  for (const { handle } of images.values()) gl.deleteTexture(handle);
  images.clear();
  [canvas.width, canvas.height] = color.size;
  for (const [name, image] of Object.entries({ color, depth, truth })) if (image) put(name, image);
}

export function largest() {
  return gl.getParameter(gl.MAX_TEXTURE_SIZE);
}

// Stores an image, for example one that another library has drawn for a side.
export function put(key, image) {
  if (images.has(key)) gl.deleteTexture(images.get(key).handle);
  images.set(key, { size: image.size, handle: texture(image) });
}

function imageOf(side, name) {
  return images.get(name) ?? images.get(`${side} ${name}`);
}

// Draws the passes of a side, and waits until the GPU is done. Returns the time in milliseconds, without compiling.
export function run(side, passes) {
  for (const { fragment } of passes) linked(vertex, fragment);
  const handleOf = (name) => imageOf(side, name)?.handle;
  const before = performance.now();
  for (const { targets, size, ...pass } of passes) {
    for (const name of targets) {
      if (`${imageOf(side, name)?.size}` !== `${size}`) put(`${side} ${name}`, { size, format: "rgba16float" });
    }
    const textures = Object.fromEntries(pass.inputs.map(({ image }) => [image, handleOf(image)]));
    onto(targets.map(handleOf), () => draw({ ...pass, area: [0, 0, ...size] }, vertex, textures));
  }
  read(handleOf("result"), [1, 1]); // reading a pixel waits until everything is drawn
  return performance.now() - before;
}

// Returns red, green, blue and alpha of a texel of an image that a side shows or has drawn.
export function texel(side, name, [x, y]) {
  const value = new Float32Array(4);
  onto([imageOf(side, name).handle], () => gl.readPixels(x, y, 1, 1, gl.RGBA, gl.FLOAT, value));
  return value;
}

// Returns an image that a side shows or has drawn, in the form that job.js describes.
export function picture(side, name) {
  const { handle, size } = imageOf(side, name);
  return read(handle, size);
}

// Shows both sides on the canvas. `left` and `right` are the names of their images.
export function show(left, right, split, exposure) {
  const textures = { left: imageOf("left", left).handle, right: imageOf("right", right).handle };
  const inputs = [
    { slot: "Left", image: "left", linear: false },
    { slot: "Right", image: "right", linear: false },
  ];
  const area = [0, 0, canvas.width, canvas.height];
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  draw({ fragment: SHOW, area, inputs, values: { split, exposure } }, vertex, textures);
}
