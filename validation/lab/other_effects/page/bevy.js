// Bevy's depth of field, hexagonal and Gaussian: its WGSL on WebGPU, with what it imports put in before it.

import { checked, copy, draw, read, start, texture, uniforms } from "./browser/webgpu.js";
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

const numbered = (resources) => resources.map((resource, binding) => ({ binding, resource }));

function pipelineOf(device, code, entryPoint, targets, depthStencil) {
  const module = device.createShaderModule({ code });
  const fragment = { module, entryPoint, targets: Array(targets).fill({ format: "rgba16float" }) };
  return device.createRenderPipelineAsync({ layout: "auto", vertex: { module, entryPoint: "whole" }, fragment, depthStencil });
}

// A depth buffer of metres
async function depthOf(device, near, metres, size) {
  const format = "depth32float";
  const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING;
  const depth = device.createTexture({ size, format, usage });
  const pipeline = await pipelineOf(device, DEPTH, "depth", 0, { format, depthWriteEnabled: true, depthCompare: "always" });
  const image = texture(device, { size, format: "r32float", data: metres });
  const entries = numbered([{ buffer: near }, image.createView()]);
  const encoder = device.createCommandEncoder();
  const attachment = { view: depth.createView(), depthClearValue: 0, depthLoadOp: "clear", depthStoreOp: "store" };
  const pass = encoder.beginRenderPass({ colorAttachments: [], depthStencilAttachment: attachment });
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
  pass.draw(3);
  pass.end();
  device.queue.submit([encoder.finish()]);
  return depth;
}

async function bevy(handed, passes) {
  const { device } = await start();
  const size = [handed.width, handed.height];
  const rgba = { size, format: "rgba16float" };
  const fetched = async (name) => (await fetch(`${FOLDER}/${name}`)).text();
  const texts = await Promise.all(["gaussian_blur.wgsl", "dof/dof.wgsl"].map(fetched));
  const near = uniforms(device, [handed.near]);
  const lens = uniforms(device, Array(8).fill(0));
  const depth = await depthOf(device, near, handed.depth, size);
  const sampler = device.createSampler({ magFilter: "linear", minFilter: "linear" });
  let reads = [texture(device, { ...rgba, data: handed.color })];
  const steps = [];
  for (const [entry, dual, count] of passes) {
    const code = IMPORTED + WHOLE + texts.map((text) => preprocessed(text, dual ? ["DUAL_INPUT"] : [])).join("\n");
    const pipeline = await checked(device, () => pipelineOf(device, code, entry, count));
    const writes = Array.from({ length: count }, () => texture(device, rgba));
    const inputs = numbered([{ buffer: near }, ...[depth, ...reads].map((one) => one.createView())]);
    steps.push([pipeline, [inputs, numbered([{ buffer: lens }, sampler])], writes, [0, 0, ...size]]);
    reads = writes;
  }
  return {
    set: ({ focalDistance, focalLength, scale, maxDiameter, maxDepth }) => {
      device.queue.writeBuffer(lens, 0, new Float32Array([focalDistance, focalLength, scale, maxDiameter, maxDepth]));
    },
    draw: () => {
      const encoder = device.createCommandEncoder();
      for (const step of steps) draw(device, encoder, ...step);
      device.queue.submit([encoder.finish()]);
    },
    read: async () => {
      const encoder = device.createCommandEncoder();
      const copied = copy(device, encoder, rgba, reads[0]);
      device.queue.submit([encoder.finish()]);
      return upsideDown(await read(copied), handed); // as WebGL reads
    },
  };
}
