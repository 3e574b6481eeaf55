// three.js's DepthOfFieldNode, on the WebGL 2 backend of WebGPURenderer.

import * as THREE from "three/webgpu";
import { float, pass, positionGeometry, texture, uniform, uv, vec2, vec4 } from "three/tsl";
import { dof } from "three/addons/tsl/display/DepthOfFieldNode.js";
import { canvasOf, degrees } from "./feed.js";

export async function DepthOfFieldNode(handed) {
  const { width, height, near, far } = handed;
  const data = (pixels, format, type) => {
    const made = new THREE.DataTexture(pixels, width, height, format, type);
    made.needsUpdate = true;
    return texture(made, vec2(uv().x, uv().y.oneMinus()));
  };
  const metres = data(handed.depth, THREE.RedFormat, THREE.FloatType).r;
  const material = new THREE.NodeMaterial();
  material.vertexNode = vec4(positionGeometry.xy, 0, 1);
  material.fragmentNode = data(handed.color, THREE.RGBAFormat, THREE.HalfFloatType);
  material.depthNode = float(far).mul(metres.sub(near)).div(metres.mul(far - near));
  const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
  quad.frustumCulled = false;

  const renderer = new THREE.WebGPURenderer({ canvas: canvasOf(handed), forceWebGL: true });
  renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
  await renderer.init();
  const camera = new THREE.PerspectiveCamera(degrees(handed), width / height, near, far);
  const drawn = pass(new THREE.Scene().add(quad), camera);
  const set = { focusDistance: uniform(1), focalLength: uniform(1), bokehScale: uniform(1) };
  const node = dof(drawn.getTextureNode(), drawn.getViewZNode(), set.focusDistance, set.focalLength, set.bokehScale);
  const pipelines = [drawn.getTextureNode(), node].map((output) => new THREE.RenderPipeline(renderer, output));
  let enabled = true;
  return {
    gl: renderer.backend.gl,
    enable: (on) => (enabled = on),
    set: async (parameters) => {
      for (const [name, value] of Object.entries(parameters)) set[name].value = value;
      // it draws its passes once for each of the browser's frames
      for (let i = 0; i < 2; i++) await new Promise(requestAnimationFrame);
    },
    draw: () => pipelines[Number(enabled)].render(),
    read: () => renderer.readRenderTargetPixelsAsync(node._compositeRT, 0, 0, width, height),
  };
}
