// The sample for WebGLRenderer.

import { ACESFilmicToneMapping, DepthTexture, FloatType, HalfFloatType } from 'three';
import { WebGLRenderer, WebGLRenderTarget } from 'three';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { OutputPass } from 'three/addons/postprocessing/OutputPass.js';
import { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import { PolygonBokehPass } from 'polygonal-bokeh/three';
import { makeScene } from './scene.js'; // replace it with your own scene

const [WIDTH, HEIGHT] = [640, 480];

// Creates a composer with depth of field for a scene. `options` are passed to PolygonBokehPass.
export function addBokeh(renderer, scene, camera, options) {
  const depthTexture = new DepthTexture(1, 1, FloatType);
  const target = new WebGLRenderTarget(1, 1, { type: HalfFloatType, depthTexture });
  const composer = new EffectComposer(renderer, target);
  const bokeh = new PolygonBokehPass(camera, options);
  bokeh.setLens(1.4, 20); // f/1.4, with a blur 20 times as wide as a real lens's
  composer.addPass(new RenderPass(scene, camera));
  composer.addPass(bokeh);
  composer.addPass(new OutputPass()); // tone mapping and sRGB encoding come last
  return { composer, bokeh };
}

export const renderer = new WebGLRenderer();
renderer.toneMapping = ACESFilmicToneMapping;
renderer.setSize(WIDTH, HEIGHT);
document.body.append(renderer.domElement);

export const { scene, camera, subject } = makeScene(WIDTH / HEIGHT);
export const { composer, bokeh } = addBokeh(renderer, scene, camera);
composer.setSize(WIDTH, HEIGHT); // also gives the targets of 1 x 1 pixel their size

bokeh.focusOn(subject); // call it again when the camera or the subject moves
composer.render(); // call it in each frame

// A click focuses on the object that it hits. If you have a render loop, leave the last argument out.
export const focus = bokeh.focusByClicks(renderer.domElement, scene, () => composer.render());

// Keys 1 to 3 show a debug view, and 0 shows the result.
addEventListener('keydown', ({ key }) => {
  if ('0123'.includes(key)) bokeh.uniforms.debugMode.value = Number(key);
  composer.render();
});
