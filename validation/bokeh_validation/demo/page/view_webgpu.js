// As view.js, on WebGPU.

import { checked, copy, draw, read as readBack, start, texture } from "../../browser/page/webgpu.js";
import { unhalf } from "./exr.js";

const HALF = { channels: 4, type: "half" };
const SHOW = `
struct Shown { split: f32, exposure: f32 }
@group(0) @binding(0) var<uniform> shown: Shown;
@group(0) @binding(1) var left: texture_2d<f32>;
@group(0) @binding(2) var right: texture_2d<f32>;
@vertex fn whole(@builtin(vertex_index) id: u32) -> @builtin(position) vec4f
{
    return vec4f(select(-1.0, 3.0, id == 1u), select(-1.0, 3.0, id == 2u), 0.0, 1.0);
}
@fragment fn show(@builtin(position) place: vec4f) -> @location(0) vec4f
{
    let texel = vec2i(place.xy);
    let size = vec2f(textureDimensions(left));
    let color = select(textureLoad(right, texel, 0).rgb, textureLoad(left, texel, 0).rgb, place.x < shown.split * size.x);
    let x = clamp(color, vec3f(0.0), vec3f(65504.0)) * shown.exposure;
    let y = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    return vec4f(pow(clamp(y, vec3f(0.0), vec3f(1.0)), vec3f(1.0 / 2.2)), 1.0);
}`;

let gpu = null;
let data = null;
let context = null;
let pipeline = null;
let buffer = null;
let size = [1, 1];
const handed = {}; // color, depth, truth -> { handle, size, channels, type }
const pool = new Map(); // "side name" -> the same

export async function open(canvas, given) {
  data = given;
  gpu = await start();
  context = canvas.getContext("webgpu");
  const format = navigator.gpu.getPreferredCanvasFormat();
  context.configure({ device: gpu.device, format });
  const module = gpu.device.createShaderModule({ code: SHOW });
  const fragment = { module, entryPoint: "show", targets: [{ format }] };
  pipeline = gpu.device.createRenderPipeline({ layout: "auto", vertex: { module, entryPoint: "whole" }, fragment });
  buffer = gpu.device.createBuffer({ size: 16, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST });
}

function made(image) {
  return { ...image, data: null, handle: texture(gpu.device, image) };
}

export function load({ color, depth, truth }) {
  for (const old of [...Object.values(handed), ...pool.values()]) old.handle.destroy();
  pool.clear();
  for (const name of Object.keys(handed)) delete handed[name];
  size = color.size;
  [context.canvas.width, context.canvas.height] = size;
  Object.assign(handed, { color: made(color), depth: made(depth) });
  if (truth) handed.truth = made(truth);
}

export function largest() {
  return gpu.device.limits.maxTextureDimension2D;
}

function target(side, name, wanted) {
  const key = `${side} ${name}`;
  const old = pool.get(key);
  if (old?.size[0] === wanted[0] && old.size[1] === wanted[1]) return old;
  old?.handle.destroy();
  pool.set(key, made({ ...HALF, size: wanted }));
  return pool.get(key);
}

export function put(side, name, image) {
  pool.get(`${side} ${name}`)?.handle.destroy();
  pool.set(`${side} ${name}`, made(image));
}

export async function run(side, passes) {
  const images = { ...handed };
  for (const pass of passes) for (const name of pass.targets) images[name] = target(side, name, pass.size);
  const textures = Object.fromEntries(Object.entries(images).map(([name, { handle }]) => [name, handle]));
  const drawn = passes.map((pass) => ({ ...pass, area: [0, 0, ...pass.size], over: [] }));
  const job = { code: data.wgsl, vertex: "BokehFullScreen_VS", slots: data.slots, images, passes: drawn };
  const buffers = [];
  try {
    return await checked(gpu.device, async () => {
      const encoder = gpu.device.createCommandEncoder();
      await draw(gpu, encoder, job, textures, buffers);
      const before = performance.now();
      gpu.device.queue.submit([encoder.finish()]);
      await gpu.device.queue.onSubmittedWorkDone();
      return performance.now() - before;
    });
  } finally {
    for (const one of buffers) one.destroy();
  }
}

// r, g, b, a of a texel of a target.
export async function read(side, name, x, y) {
  const { handle } = textureOf(side, name);
  const encoder = gpu.device.createCommandEncoder();
  const staging = gpu.device.createBuffer({ size: 256, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ });
  encoder.copyTextureToBuffer({ texture: handle, origin: [x, y] }, { buffer: staging, bytesPerRow: 256 }, [1, 1]);
  gpu.device.queue.submit([encoder.finish()]);
  await staging.mapAsync(GPUMapMode.READ);
  const bits = new Uint16Array(staging.getMappedRange().slice(0, 8));
  staging.destroy();
  return Array.from(bits, unhalf);
}

// An image as job.js has it, of what a side shows or has drawn.
export async function picture(side, name) {
  const { handle, ...image } = textureOf(side, name);
  const encoder = gpu.device.createCommandEncoder();
  const copied = copy(gpu.device, encoder, image, handle);
  gpu.device.queue.submit([encoder.finish()]);
  const found = await readBack(copied);
  copied.buffer.destroy();
  return found;
}

function textureOf(side, name) {
  return handed[name] ?? pool.get(`${side} ${name}`);
}

export function show(left, right, split, exposure) {
  const { device } = gpu;
  device.queue.writeBuffer(buffer, 0, new Float32Array([split, exposure]));
  const views = [textureOf("left", left), textureOf("right", right)].map(({ handle }) => handle.createView());
  const resources = [{ buffer }, ...views];
  const entries = resources.map((resource, binding) => ({ binding, resource }));
  const encoder = device.createCommandEncoder();
  const view = context.getCurrentTexture().createView();
  const pass = encoder.beginRenderPass({ colorAttachments: [{ view, loadOp: "clear", storeOp: "store" }] });
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
  pass.draw(3);
  pass.end();
  device.queue.submit([encoder.finish()]);
}
