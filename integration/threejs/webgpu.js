// The sample for WebGPURenderer.

import { ACESFilmicToneMapping, RenderPipeline, WebGPURenderer } from 'three/webgpu';
import { mrt, normalView, output, pass, vec4 } from 'three/tsl';
import { ao } from 'three/addons/tsl/display/GTAONode.js';
import { PolygonBokehNode } from 'polygonal-bokeh/three-webgpu';
import { makeScene } from './scene.js';

const WIDTH = 640;
const HEIGHT = 480;

// Creates a pipeline with depth of field for a scene. `options` are passed to PolygonBokehNode. Returns
// { pipeline, bokeh }.
export function addBokeh(renderer, scene, camera, options) {
  const bokeh = new PolygonBokehNode(pass(scene, camera), options);
  bokeh.setLens(1.4, 20); // f/1.4, with a blur 20 times as wide as a real lens's
  const pipeline = new RenderPipeline(renderer, bokeh); // applies tone mapping and sRGB encoding last
  return { pipeline, bokeh };
}

// Does the same, but with ambient occlusion before the bokeh, which takes any colour and the depth that belongs to it.
export function addOccludedBokeh(renderer, scene, camera, options) {
  const scenePass = pass(scene, camera);
  scenePass.setMRT(mrt({ output, normal: normalView }));
  const depth = scenePass.getTextureNode('depth');
  const occlusion = ao(depth, scenePass.getTextureNode('normal'), camera).getTextureNode();
  const color = scenePass.getTextureNode().mul(vec4(occlusion.rrr, 1));
  const bokeh = new PolygonBokehNode(color, depth, camera, options);
  bokeh.setLens(1.4, 20);
  return { pipeline: new RenderPipeline(renderer, bokeh), bokeh };
}

export const renderer = new WebGPURenderer();
renderer.toneMapping = ACESFilmicToneMapping;
renderer.setSize(WIDTH, HEIGHT);
document.body.append(renderer.domElement);
await renderer.init();

export const { scene, camera, subject } = makeScene(WIDTH / HEIGHT);
export const { pipeline, bokeh } = addBokeh(renderer, scene, camera);

bokeh.focusOn(subject);
pipeline.render();

// A click focuses on the object that it hits.
export const focus = bokeh.focusByClicks(renderer.domElement, scene, () => pipeline.render());

// Keys 1 to 3 show a debug view, and 0 shows the result.
addEventListener('keydown', ({ key }) => {
  if ('0123'.includes(key)) bokeh.uniforms.debugMode.value = Number(key);
  pipeline.render();
});
