// WebGPU: WGSL through tint and Dawn. Row 0 of every image is v = 0, in uploads, targets and copies alike.

import { decode, elements, encode, pitch } from "./job.js";

// Bytes a pixel of all targets of a pass together. WebGPU's default is four half-float targets, but two of 32 bits.
const ATTACHMENT_BYTES = "maxColorAttachmentBytesPerSample";

let started = null; // promise of { adapter, device, sampler, dummy }
const modules = new Map(); // source -> GPUShaderModule
const pipelines = new Map(); // entry, constants, formats and source -> GPURenderPipeline

// The device, made on first use and again after it was lost.
export function start() {
  started ??= open();
  return started;
}

async function open() {
  if (!navigator.gpu) throw new Error("this browser has no WebGPU");
  const adapter = await navigator.gpu.requestAdapter();
  if (!adapter) throw new Error("this browser gives no WebGPU adapter");
  const device = await adapter.requestDevice({
    requiredFeatures: ["float32-filterable"].filter((feature) => adapter.features.has(feature)),
    requiredLimits: { [ATTACHMENT_BYTES]: adapter.limits[ATTACHMENT_BYTES] },
  });
  modules.clear();
  pipelines.clear();
  device.lost.then(() => (started = null));
  const sampler = device.createSampler({ minFilter: "linear", magFilter: "linear" });
  const usage = GPUTextureUsage.TEXTURE_BINDING;
  const dummy = device.createTexture({ size: [1, 1], format: "rgba16float", usage });
  return { adapter, device, sampler, dummy };
}

const SAMPLER = 7; // its binding: textures of the layers come after it

// One layout for every pass, as the package documents it: parameters, textures, the sampler, bound in this order.
// `slots`: name of a texture -> its sample type, in the order of the bindings.
function layout(device, slots) {
  const resources = [
    { buffer: { type: "uniform" } },
    ...Object.values(slots).map((sampleType) => ({ texture: { sampleType } })),
  ];
  resources.splice(SAMPLER, 0, { sampler: { type: "filtering" } });
  const visibility = GPUShaderStage.FRAGMENT;
  const entries = resources.map((resource, binding) => ({ binding, visibility, ...resource }));
  return device.createBindGroupLayout({ entries });
}

// As webgl2.describe().
export async function describe() {
  const { adapter, device } = await start();
  const { vendor, architecture, description } = adapter.info;
  const name = [vendor, architecture, description].filter(Boolean).join(" ");
  const floatFilterable = device.features.has("float32-filterable");
  return { device: name, floatFilterable, attachmentBytes: device.limits[ATTACHMENT_BYTES] };
}

// Run steps and throw what the device says of them: its errors come out of scopes, not as exceptions.
export async function checked(device, step) {
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

// Stages are { module, entryPoint, constants }.
function pipelineDescriptor(device, slots, vertex, fragment, formats) {
  return {
    layout: device.createPipelineLayout({ bindGroupLayouts: [layout(device, slots)] }),
    vertex,
    fragment: { ...fragment, targets: formats.map((format) => ({ format })) },
    primitive: { topology: "triangle-list" },
  };
}

// { ok, messages: [{ type, line, column, text }], pipeline } of { code, vertex, fragment, slots, formats }, the stages
// being { entry, constants }, with a target of each format. `pipeline` is what making a render pipeline was refused
// with, or "".
export async function compile({ code, vertex, fragment, slots, formats }) {
  const { device } = await start();
  device.pushErrorScope("validation"); // the errors of a module come with its messages
  const module = device.createShaderModule({ code });
  const info = await module.getCompilationInfo();
  await device.popErrorScope();
  const messages = info.messages.map(({ type, lineNum, linePos, message }) => ({
    type, line: lineNum, column: linePos, text: message,
  })); // prettier-ignore
  if (messages.some(({ type }) => type === "error")) return { ok: false, messages, pipeline: "" };
  try {
    const stages = [vertex, fragment].map(({ entry, constants }) => ({ module, entryPoint: entry, constants }));
    await device.createRenderPipelineAsync(pipelineDescriptor(device, slots, ...stages, formats));
  } catch (error) {
    return { ok: false, messages, pipeline: error.message };
  }
  return { ok: true, messages, pipeline: "" };
}

function format({ channels, type }) {
  return { 4: "rgba", 1: "r" }[channels] + { half: "16float", float: "32float" }[type];
}

// A pipeline, made once for each entry, configuration and formats of targets.
async function pipeline(device, { code, vertex, slots }, pass, formats) {
  const key = [pass.entry, JSON.stringify(pass.constants), ...formats, code].join("\0");
  if (!pipelines.has(key)) {
    if (!modules.has(code)) modules.set(code, device.createShaderModule({ code }));
    const module = modules.get(code);
    const fragment = { module, entryPoint: pass.entry, constants: pass.constants };
    const descriptor = pipelineDescriptor(device, slots, { module, entryPoint: vertex }, fragment, formats);
    pipelines.set(key, await device.createRenderPipelineAsync(descriptor));
  }
  return pipelines.get(key);
}

export function texture(device, image) {
  const { TEXTURE_BINDING, COPY_DST, COPY_SRC, RENDER_ATTACHMENT } = GPUTextureUsage;
  const usage = TEXTURE_BINDING | COPY_SRC | (image.data ? COPY_DST : RENDER_ATTACHMENT);
  const handle = device.createTexture({ size: image.size, format: format(image), usage });
  // writeTexture() wants no alignment
  const rows = { bytesPerRow: pitch(image) };
  if (image.data) device.queue.writeTexture({ texture: handle }, decode(image), rows, image.size);
  return handle;
}

// The parameters of a pass.
function uniforms(device, pass) {
  const values = new Float32Array(Object.values(pass.values));
  const buffer = device.createBuffer({
    size: Math.ceil(values.byteLength / 16) * 16, // of a uniform block
    usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST,
  });
  device.queue.writeBuffer(buffer, 0, values);
  return buffer;
}

function bind({ device, sampler, dummy }, slots, pass, buffer, textures) {
  // a pass has something at every binding, also where it reads nothing
  const read = new Map(pass.inputs.map(({ slot, image }) => [slot, textures[image]]));
  const resources = [{ buffer }, ...Object.keys(slots).map((slot) => (read.get(slot) ?? dummy).createView())];
  resources.splice(SAMPLER, 0, sampler);
  const entries = resources.map((resource, binding) => ({ binding, resource }));
  return device.createBindGroup({ layout: layout(device, slots), entries });
}

// Copy a target to a buffer that can be mapped: there a row begins at a multiple of 256 bytes.
export function copy(device, encoder, image, texture) {
  const bytesPerRow = Math.ceil(pitch(image) / 256) * 256;
  const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  const buffer = device.createBuffer({ size: bytesPerRow * image.size[1], usage });
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, image.size);
  return { image, buffer, bytesPerRow };
}

export async function read({ image, buffer, bytesPerRow }) {
  await buffer.mapAsync(GPUMapMode.READ);
  const padded = new Uint8Array(buffer.getMappedRange());
  const into = elements(image);
  const bytes = new Uint8Array(into.buffer);
  const row = pitch(image);
  for (let y = 0; y < image.size[1]; y++) bytes.set(padded.subarray(y * bytesPerRow, y * bytesPerRow + row), y * row);
  return encode(image, into);
}

// Run a job and return the images that it keeps.
export async function run(job) {
  const gpu = await start();
  const { device } = gpu;
  const resources = []; // destroyed at the end: waiting for the garbage collector would hold them for long
  const owned = (resource) => resources[resources.push(resource) - 1];
  try {
    return await checked(device, async () => {
      const textures = job.images.map((image) => owned(texture(device, image)));
      const encoder = device.createCommandEncoder();
      for (const pass of job.passes) {
        const formats = pass.targets.map((image) => format(job.images[image]));
        const chosen = await pipeline(device, job, pass, formats);
        const buffer = owned(uniforms(device, pass));
        draw(encoder, pass, chosen, bind(gpu, job.slots, pass, buffer, textures), textures);
      }
      const copies = job.keep.map((image) => copy(device, encoder, job.images[image], textures[image]));
      copies.forEach(({ buffer }) => owned(buffer));
      device.queue.submit([encoder.finish()]);
      return Promise.all(copies.map(read));
    });
  } finally {
    for (const resource of resources) resource.destroy();
  }
}

function draw(encoder, pass, pipeline, bindings, textures) {
  // a new texture holds 0, and what is around the area that is drawn stays
  const kept = { loadOp: "load", storeOp: "store" };
  const colorAttachments = pass.targets.map((image) => ({ view: textures[image].createView(), ...kept }));
  const render = encoder.beginRenderPass({ colorAttachments });
  render.setPipeline(pipeline);
  render.setBindGroup(0, bindings);
  render.setViewport(...pass.area, 0, 1); // a triangle is clipped to it
  render.draw(3);
  render.end();
}
