// Bevy's depth of field, hexagonal and Gaussian: its WGSL on WebGPU, with what it imports put in before it.

import { decode } from "./browser/job.js";
import { checked, copy, read, start, texture } from "./browser/webgpu.js";
import { upsideDown } from "./feed.js";

const FOLDER = "/bevy_post_process/src";
// What its #import lines stand for, as far as it is used; depth is Bevy's: reversed, infinite, near / z
const IMPORTED = `
struct FullscreenVertexOutput { @builtin(position) position: vec4<f32>, @location(0) uv: vec2<f32> }
struct Near { near: f32 }
@group(0) @binding(0) var<uniform> view: Near;
fn depth_ndc_to_view_z(depth: f32) -> f32 { return -view.near / depth; }
`;
const WHOLE = `
@vertex fn whole(@builtin(vertex_index) id: u32) -> FullscreenVertexOutput
{
    let uv = vec2f(f32((id << 1u) & 2u), f32(id & 2u));
    return FullscreenVertexOutput(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}
`;
const DEPTH = `${IMPORTED}${WHOLE}
@group(0) @binding(1) var metres: texture_2d<f32>;
@fragment fn depth(in: FullscreenVertexOutput) -> @builtin(frag_depth) f32
{
    return view.near / textureLoad(metres, vec2i(in.position.xy), 0).r;
}`;
// entry, whether it reads two textures, targets it writes: each into the next, as Bevy's plug-in has them
const MODES = {
  bokeh: [["bokeh_pass_a", false, 2], ["bokeh_pass_b", true, 1]],
  gaussian: [["gaussian_horizontal", false, 1], ["gaussian_vertical", false, 1]],
};

// Lines between #ifdef, #else and #endif, as far as these names are defined; imports are left out
function preprocessed(text, defined) {
  const kept = [];
  const stack = [];
  for (const line of text.split("\n")) {
    const [word, name] = line.trim().split(/\s+/);
    if (word === "#ifdef") stack.push(defined.includes(name));
    else if (word === "#else") stack.push(!stack.pop());
    else if (word === "#endif") stack.pop();
    else if (!word.startsWith("#") && stack.every(Boolean)) kept.push(line);
  }
  return kept.join("\n");
}

export const BevyBokeh = (scene) => bevy(scene, MODES.bokeh);
export const BevyGaussian = (scene) => bevy(scene, MODES.gaussian);

async function bevy(handed, passes) {
  const { device } = await start();
  const { width, height } = handed;
  const size = [width, height];
  const fetched = async (name) => (await fetch(`${FOLDER}/${name}`)).text();
  const texts = await Promise.all(["gaussian_blur.wgsl", "dof/dof.wgsl"].map(fetched));
  const rgba = { size, channels: 4, type: "half" };
  const color = texture(device, { ...rgba, data: handed.color });
  const metres = texture(device, { size, channels: 1, type: "float", data: handed.depth });
  const { RENDER_ATTACHMENT, TEXTURE_BINDING } = GPUTextureUsage;
  const depth = device.createTexture({ size, format: "depth32float", usage: RENDER_ATTACHMENT | TEXTURE_BINDING });
  const uniform = (values) => {
    const buffer = device.createBuffer({ size: 32, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST });
    device.queue.writeBuffer(buffer, 0, new Float32Array(values));
    return buffer;
  };
  const near = uniform([handed.near]);
  const lens = uniform([]);
  const group = (pipeline, index, resources) => {
    const entries = resources.map((resource, binding) => ({ binding, resource }));
    return device.createBindGroup({ layout: pipeline.getBindGroupLayout(index), entries });
  };
  const pipelineOf = (code, entryPoint, targets, depthStencil) => {
    const module = device.createShaderModule({ code });
    const vertex = { module, entryPoint: "whole" };
    const formats = Array(targets).fill({ format: "rgba16float" });
    return device.createRenderPipelineAsync({
      layout: "auto", vertex, fragment: { module, entryPoint, targets: formats }, depthStencil,
    }); // prettier-ignore
  };
  const encoded = (encoder, pipeline, groups, descriptor) => {
    const pass = encoder.beginRenderPass(descriptor);
    pass.setPipeline(pipeline);
    groups.forEach((one, index) => pass.setBindGroup(index, one));
    pass.draw(3);
    pass.end();
  };

  const stencil = { format: "depth32float", depthWriteEnabled: true, depthCompare: "always" };
  const first = await pipelineOf(DEPTH, "depth", 0, stencil);
  const encoder = device.createCommandEncoder();
  const depthStencilAttachment = { view: depth.createView(), depthClearValue: 0, depthLoadOp: "clear", depthStoreOp: "store" };
  encoded(encoder, first, [group(first, 0, [{ buffer: near }, metres.createView()])], { colorAttachments: [], depthStencilAttachment });
  device.queue.submit([encoder.finish()]);

  const sampler = device.createSampler({ magFilter: "linear", minFilter: "linear" });
  let reads = [color];
  const steps = [];
  for (const [entry, dual, count] of passes) {
    const code = IMPORTED + WHOLE + texts.map((text) => preprocessed(text, dual ? ["DUAL_INPUT"] : [])).join("\n");
    const pipeline = await checked(device, () => pipelineOf(code, entry, count));
    const writes = Array.from({ length: count }, () => texture(device, rgba));
    const inputs = [{ buffer: near }, depth.createView(), ...reads.map((one) => one.createView())];
    steps.push({ pipeline, writes, groups: [group(pipeline, 0, inputs), group(pipeline, 1, [{ buffer: lens }, sampler])] });
    reads = writes;
  }
  const [result] = reads;
  return {
    set: ({ focalDistance, focalLength, scale, maxDiameter, maxDepth }) => {
      device.queue.writeBuffer(lens, 0, new Float32Array([focalDistance, focalLength, scale, maxDiameter, maxDepth]));
    },
    draw: () => {
      const commands = device.createCommandEncoder();
      for (const { pipeline, writes, groups } of steps) {
        const colorAttachments = writes.map((one) => ({ view: one.createView(), loadOp: "clear", storeOp: "store" }));
        encoded(commands, pipeline, groups, { colorAttachments });
      }
      device.queue.submit([commands.finish()]);
      return device.queue.onSubmittedWorkDone();
    },
    read: async () => {
      const commands = device.createCommandEncoder();
      const copied = copy(device, commands, rgba, result);
      device.queue.submit([commands.finish()]);
      const picture = decode(await read(copied));
      copied.buffer.destroy();
      return upsideDown(picture, handed); // as WebGL reads
    },
  };
}
