// WebGPU: WGSL through tint and Dawn. Row 0 of every image is v = 0, in uploads, targets and copies alike.

import { BYTES, decode, elements, encode } from "./pixels.js";

const SLOTS = ["ColorSamp", "DepthSamp", "ColorSampB", "KernelSamp"]; // bindings 1 to 4
const FILTERED = ["ColorSamp", "ColorSampB"]; // the others may be unfilterable
const FORMATS = { half4: "rgba16float", float4: "rgba32float", float1: "r32float" };
const PARAMETER_BYTES = 64; // 14 floats, and room up to a multiple of 16 bytes

let started = null; // promise of { adapter, device, layout, samplers, dummy }
const modules = new Map(); // source -> GPUShaderModule
const pipelines = new Map(); // entry, samples, format and source -> GPURenderPipeline

// The device, made on first use and again after it was lost.
function start() {
  started ??= open();
  return started;
}

async function open() {
  if (!navigator.gpu) throw new Error("this browser has no WebGPU");
  const adapter = await navigator.gpu.requestAdapter();
  if (!adapter) throw new Error("this browser gives no WebGPU adapter");
  const device = await adapter.requestDevice({
    requiredFeatures: ["float32-filterable"].filter((feature) => adapter.features.has(feature)),
  });
  modules.clear();
  pipelines.clear();
  device.lost.then(() => (started = null));
  const samplers = ["linear", "nearest"].map((kind) => device.createSampler({ minFilter: kind, magFilter: kind }));
  const usage = GPUTextureUsage.TEXTURE_BINDING;
  const dummy = device.createTexture({ size: [1, 1], format: "rgba16float", usage });
  return { adapter, device, layout: layout(device), samplers, dummy };
}

// One layout for every pass, as the package documents it: parameters, four textures, two samplers.
function layout(device) {
  const visibility = GPUShaderStage.FRAGMENT;
  const textures = SLOTS.map((slot, index) => {
    const sampleType = FILTERED.includes(slot) ? "float" : "unfilterable-float";
    return { binding: 1 + index, visibility, texture: { sampleType } };
  });
  return device.createBindGroupLayout({
    entries: [
      { binding: 0, visibility, buffer: { type: "uniform" } },
      ...textures,
      { binding: 5, visibility, sampler: { type: "filtering" } },
      { binding: 6, visibility, sampler: { type: "non-filtering" } },
    ],
  });
}

// { vendor, architecture, description, floatFilterable }
export async function describe() {
  const { adapter, device } = await start();
  const { vendor, architecture, description } = adapter.info;
  return { vendor, architecture, description, floatFilterable: device.features.has("float32-filterable") };
}

// Run steps and throw what the device says of them: its errors come out of scopes, not as exceptions.
async function checked(device, step) {
  const kinds = ["validation", "out-of-memory", "internal"];
  for (const kind of kinds) device.pushErrorScope(kind);
  try {
    return await step();
  } finally {
    const errors = await Promise.all(kinds.map(() => device.popErrorScope()));
    const said = errors.filter((error) => error !== null).map((error) => error.message);
    if (said.length) throw new Error(said.join("\n"));
  }
}

function pipelineDescriptor({ device, layout }, vertex, fragment, format) {
  return {
    layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
    vertex: { module: vertex.module, entryPoint: vertex.entry, constants: vertex.constants },
    fragment: {
      module: fragment.module,
      entryPoint: fragment.entry,
      constants: fragment.constants,
      targets: [{ format }],
    },
    primitive: { topology: "triangle-list" },
  };
}

// { ok, messages: [{ type, line, column, text }], pipeline } of { code, vertex, fragment, format }, the stages being
// { entry, constants }. `pipeline` is what making a render pipeline was refused with, or "".
export async function compile({ code, vertex, fragment, format }) {
  const gpu = await start();
  gpu.device.pushErrorScope("validation"); // the errors of a module come with its messages
  const module = gpu.device.createShaderModule({ code });
  const info = await module.getCompilationInfo();
  await gpu.device.popErrorScope();
  const messages = info.messages.map((said) => ({
    type: said.type,
    line: said.lineNum,
    column: said.linePos,
    text: said.message,
  }));
  if (messages.some((said) => said.type === "error")) return { ok: false, messages, pipeline: "" };
  try {
    const stages = [vertex, fragment].map((stage) => ({ module, ...stage }));
    await gpu.device.createRenderPipelineAsync(pipelineDescriptor(gpu, ...stages, format));
  } catch (error) {
    return { ok: false, messages, pipeline: error.message };
  }
  return { ok: true, messages, pipeline: "" };
}

// A pipeline, made once for each entry, sample count and format.
async function pipeline(gpu, code, vertex, pass, format) {
  const key = [pass.entry, pass.samples, format, code].join("\0");
  if (!pipelines.has(key)) {
    if (!modules.has(code)) modules.set(code, gpu.device.createShaderModule({ code }));
    const module = modules.get(code);
    const fragment = { module, entry: pass.entry, constants: { BOKEH_NUM_SAMPLES: pass.samples } };
    const descriptor = pipelineDescriptor(gpu, { module, entry: vertex }, fragment, format);
    pipelines.set(key, await gpu.device.createRenderPipelineAsync(descriptor));
  }
  return pipelines.get(key);
}

function upload(device, pixels) {
  const size = [pixels.width, pixels.height];
  const made = device.createTexture({
    size,
    format: FORMATS[pixels.type + pixels.channels],
    usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
  });
  const bytesPerRow = pixels.width * pixels.channels * BYTES[pixels.type]; // writeTexture() wants no alignment
  device.queue.writeTexture({ texture: made }, decode(pixels), { bytesPerRow }, size);
  return made;
}

function bind({ device, layout, samplers, dummy }, pass, live) {
  const buffer = device.createBuffer({
    size: PARAMETER_BYTES,
    usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST,
  });
  device.queue.writeBuffer(buffer, 0, new Float32Array(Object.values(pass.values)));
  // a pass has something at every binding, also where it reads nothing
  const textures = SLOTS.map((slot) => (slot in pass.inputs ? live.get(pass.inputs[slot].texture) : dummy));
  const entries = [{ binding: 0, resource: { buffer } }];
  textures.forEach((texture, index) => entries.push({ binding: 1 + index, resource: texture.createView() }));
  samplers.forEach((resource, index) => entries.push({ binding: 5 + index, resource }));
  return { buffer, group: device.createBindGroup({ layout, entries }) };
}

// Copy a target to a buffer that can be mapped: there a row begins at a multiple of 256 bytes.
function copy(device, encoder, texture, [width, height], storage) {
  const bytesPerRow = Math.ceil((width * 4 * BYTES[storage]) / 256) * 256;
  const buffer = device.createBuffer({
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [width, height]);
  return { buffer, bytesPerRow };
}

async function read({ buffer, bytesPerRow }, size, storage) {
  await buffer.mapAsync(GPUMapMode.READ);
  const padded = new Uint8Array(buffer.getMappedRange());
  const into = elements(size, storage);
  const bytes = new Uint8Array(into.buffer);
  const row = bytes.length / size[1];
  for (let y = 0; y < size[1]; y++) bytes.set(padded.subarray(y * bytesPerRow, y * bytesPerRow + row), y * row);
  return encode(size, storage, into);
}

// Run a job and return the targets that it keeps, by name.
export async function run(job) {
  const gpu = await start();
  const made = []; // what is destroyed at the end: waiting for the garbage collector would hold it for long
  try {
    return await checked(gpu.device, () => record(gpu, job, made));
  } finally {
    for (const resource of made) resource.destroy();
  }
}

async function record(gpu, { size, storage, textures, passes, keep, code, vertex }, made) {
  const { device } = gpu;
  const format = FORMATS[storage + 4];
  const live = new Map();
  for (const [name, pixels] of Object.entries(textures)) {
    live.set(name, upload(device, pixels));
    made.push(live.get(name));
  }
  const ready = [];
  for (const pass of passes) ready.push(await pipeline(gpu, code, vertex, pass, format));
  const encoder = device.createCommandEncoder();
  passes.forEach((pass, index) => {
    const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC;
    const target = device.createTexture({ size, format, usage });
    const { buffer, group } = bind(gpu, pass, live);
    made.push(target, buffer);
    const attachment = { view: target.createView(), loadOp: "clear", storeOp: "store", clearValue: [0, 0, 0, 0] };
    const render = encoder.beginRenderPass({ colorAttachments: [attachment] });
    render.setPipeline(ready[index]);
    render.setBindGroup(0, group);
    render.draw(3);
    render.end();
    live.set(pass.output, target);
  });
  const copies = new Map(keep.map((name) => [name, copy(device, encoder, live.get(name), size, storage)]));
  for (const { buffer } of copies.values()) made.push(buffer);
  device.queue.submit([encoder.finish()]);
  const kept = {};
  for (const [name, copied] of copies) kept[name] = await read(copied, size, storage);
  return kept;
}
