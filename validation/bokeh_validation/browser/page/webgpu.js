// WebGPU: WGSL through tint and Dawn. Row 0 of every image is v = 0, in uploads, targets and copies.

import { decode, elements, encode } from "./job.js";

// Bytes a pixel of all targets of a pass together. WebGPU's default is four half-float targets, but two of 32 bits.
const ATTACHMENT_BYTES = "maxColorAttachmentBytesPerSample";

let started = null; // promise of { adapter, device, sampler, dummy }
const pipelines = new Map(); // entry, constants, formats and source -> GPURenderPipeline

// The device, made on first use and again after it was lost.
export function start() {
  started ??= open();
  return started;
}

async function open() {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error("this browser gives no WebGPU adapter");
  const device = await adapter.requestDevice({
    requiredFeatures: ["float32-filterable"],
    requiredLimits: { [ATTACHMENT_BYTES]: adapter.limits[ATTACHMENT_BYTES] },
  });
  pipelines.clear();
  device.lost.then(() => (started = null));
  const sampler = device.createSampler({ minFilter: "linear", magFilter: "linear" });
  return { adapter, device, sampler, dummy: texture(device, { size: [1, 1], format: "rgba16float" }) };
}

// As webgl2.describe().
export async function describe() {
  const { adapter, device } = await start();
  const { vendor, architecture, description } = adapter.info;
  const name = [vendor, architecture, description].filter(Boolean).join(" ");
  return { device: name, attachmentBytes: device.limits[ATTACHMENT_BYTES] };
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

// What every pass has bound, in this order, as the package documents it: parameters, textures, the sampler; textures of
// the layers come after it.
function bindings(parameters, textures, sampler) {
  const all = [parameters, ...textures];
  all.splice(7, 0, sampler);
  return all.map((one, binding) => ({ binding, ...one }));
}

// A render pipeline of two entries of a module, each { entry, constants }, with a target of each format; `slots`: name of
// a texture -> its sample type.
function pipelineOf(device, module, slots, vertex, fragment, formats) {
  const textures = Object.values(slots).map((sampleType) => ({ texture: { sampleType } }));
  const all = bindings({ buffer: { type: "uniform" } }, textures, { sampler: { type: "filtering" } });
  const entries = all.map((one) => ({ ...one, visibility: GPUShaderStage.FRAGMENT }));
  const stage = ({ entry, constants }) => ({ module, entryPoint: entry, constants });
  return device.createRenderPipelineAsync({
    layout: device.createPipelineLayout({ bindGroupLayouts: [device.createBindGroupLayout({ entries })] }),
    vertex: stage(vertex),
    fragment: { ...stage(fragment), targets: formats.map((format) => ({ format })) },
  });
}

// { ok, lines of messages }: whether a module is right, and a pipeline of it can be made as above.
export async function compile({ code, vertex, fragment, slots, formats }) {
  const { device } = await start();
  device.pushErrorScope("validation"); // the errors of a module come with its messages
  const module = device.createShaderModule({ code });
  const { messages } = await module.getCompilationInfo();
  await device.popErrorScope();
  const lines = messages.map(({ type, lineNum, linePos, message }) => `wgsl:${lineNum}:${linePos}: ${type}: ${message}`);
  if (messages.some(({ type }) => type === "error")) return { ok: false, lines };
  try {
    await pipelineOf(device, module, slots, vertex, fragment, formats);
    return { ok: true, lines };
  } catch (error) {
    return { ok: false, lines: [...lines, error.message] };
  }
}

export function texture(device, { size, format, data }) {
  const { TEXTURE_BINDING, COPY_DST, COPY_SRC, RENDER_ATTACHMENT } = GPUTextureUsage;
  const usage = TEXTURE_BINDING | COPY_SRC | (data ? COPY_DST : RENDER_ATTACHMENT);
  const handle = device.createTexture({ size, format, usage });
  if (data) {
    const pixels = decode({ format, data });
    device.queue.writeTexture({ texture: handle }, pixels, { bytesPerRow: pixels.byteLength / size[1] }, size);
  }
  return handle;
}

export function uniforms(device, values) {
  const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
  const buffer = device.createBuffer({ size: Math.ceil(values.length / 4) * 16, usage }); // of a uniform block
  device.queue.writeBuffer(buffer, 0, new Float32Array(values));
  return buffer;
}

// Copy a target to a buffer that can be mapped: there a row begins at a multiple of 256 bytes.
export function copy(device, encoder, { size, format }, texture) {
  const into = elements({ size, format });
  const bytesPerRow = Math.ceil(into.byteLength / size[1] / 256) * 256;
  const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  const buffer = device.createBuffer({ size: bytesPerRow * size[1], usage });
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, size);
  return { buffer, bytesPerRow, into, height: size[1] };
}

// The elements of an image that was copied.
export async function read({ buffer, bytesPerRow, into, height }) {
  await buffer.mapAsync(GPUMapMode.READ);
  const padded = new Uint8Array(buffer.getMappedRange());
  const bytes = new Uint8Array(into.buffer);
  const row = bytes.length / height;
  for (let y = 0; y < height; y++) bytes.set(padded.subarray(y * bytesPerRow, y * bytesPerRow + row), y * row);
  buffer.destroy();
  return into;
}

// Run a job and return the images that it keeps.
export async function run({ code, vertex, slots, images, passes, keep }) {
  const { device, sampler, dummy } = await start();
  const resources = []; // destroyed at the end: waiting for the garbage collector would hold them for long
  const owned = (resource) => resources[resources.push(resource) - 1];
  try {
    return await checked(device, async () => {
      const textures = images.map((image) => owned(texture(device, image)));
      const encoder = device.createCommandEncoder();
      for (const pass of passes) {
        const formats = pass.targets.map((image) => images[image].format);
        const key = [pass.entry, JSON.stringify(pass.constants), ...formats, code].join("\0");
        if (!pipelines.has(key)) {
          const module = device.createShaderModule({ code });
          pipelines.set(key, await pipelineOf(device, module, slots, { entry: vertex }, pass, formats));
        }
        const buffer = owned(uniforms(device, Object.values(pass.values)));
        // a pass has something at every binding, also where it reads nothing
        const inputs = Object.fromEntries(pass.inputs.map(({ slot, image }) => [slot, textures[image]]));
        const views = Object.keys(slots).map((slot) => ({ resource: (inputs[slot] ?? dummy).createView() }));
        const entries = bindings({ resource: { buffer } }, views, { resource: sampler });
        draw(device, encoder, pipelines.get(key), [entries], pass.targets.map((image) => textures[image]), pass.area);
      }
      const copies = keep.map((image) => copy(device, encoder, images[image], textures[image]));
      device.queue.submit([encoder.finish()]);
      return Promise.all(copies.map(async (copied, index) => encode(images[keep[index]], await read(copied))));
    });
  } finally {
    for (const resource of resources) resource.destroy();
  }
}

// Record a pass: `groups` are the entries of its bind groups.
export function draw(device, encoder, pipeline, groups, targets, area) {
  // a new texture holds 0, and what is around the area that is drawn stays
  const kept = { loadOp: "load", storeOp: "store" };
  const pass = encoder.beginRenderPass({ colorAttachments: targets.map((target) => ({ view: target.createView(), ...kept })) });
  pass.setPipeline(pipeline);
  groups.forEach((entries, index) => {
    pass.setBindGroup(index, device.createBindGroup({ layout: pipeline.getBindGroupLayout(index), entries }));
  });
  pass.setViewport(...area, 0, 1); // a triangle is clipped to it
  pass.draw(3);
  pass.end();
}
