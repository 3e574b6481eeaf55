// What three-webgpu.test.js asks of the class for WebGPURenderer, in the scene of scene.js.

import * as THREE from 'three/webgpu';
import { pass } from 'three/tsl';
import { PolygonBokehNode } from 'polygonal-bokeh/three-webgpu';
import { SIZE, addGlass, calls, glassFound, inMiddle, makeScene as sceneOf, off, total } from './scene.js';

// How many pipelines were made while the caller waited
let pipelines = 0;
const { createRenderPipeline } = GPUDevice.prototype;
GPUDevice.prototype.createRenderPipeline = function (...given) {
  pipelines += 1;
  return createRenderPipeline.call(this, ...given);
};

const Pipeline = THREE.RenderPipeline ?? THREE.PostProcessing;
const renderer = new THREE.WebGPURenderer();
renderer.setSize(...SIZE);
document.body.append(renderer.domElement);
await renderer.init();

const makeScene = (camera) => sceneOf(1, camera);

function chain({ scene, camera, subject }, options, other = renderer, settings = {}) {
  const bokeh = new PolygonBokehNode(pass(scene, camera, settings), options);
  bokeh.setLens(1.4, 20);
  bokeh.focusOn(subject);
  return { bokeh, pipeline: new Pipeline(other, bokeh), scene };
}

async function drawn({ bokeh, pipeline }, other = renderer) {
  const target = new THREE.RenderTarget(...SIZE);
  other.setRenderTarget(target);
  await (pipeline.render() ?? 0);
  other.setRenderTarget(null);
  const shown = bokeh.sharp ?? bokeh.result;
  const halves = await other.readRenderTargetPixelsAsync(shown, 0, 0, shown.width, shown.height);
  return Array.from(halves, THREE.DataUtils.fromHalfFloat);
}

const message = (call) => call().then(() => '', (error) => error.message);

window.bokeh = {
  ...calls(renderer, makeScene, chain, drawn),

  refused: (options) => message(async () => new PolygonBokehNode(pass(...Object.values(makeScene()).slice(0, 2)), options)),

  // A depth buffer that cannot be read: what render() throws
  async logarithmic() {
    const other = new THREE.WebGPURenderer({ logarithmicDepthBuffer: true });
    await other.init();
    return message(async () => chain(makeScene(), {}, other).pipeline.render());
  },

  // WebGL under WebGPURenderer: what two frames warn of, and how far their picture is from the scene's own
  async fallback() {
    const other = new THREE.WebGPURenderer({ forceWebGL: true });
    other.setSize(...SIZE);
    await other.init();
    const warnings = [];
    const { warn } = console;
    console.warn = (...words) => warnings.push(words.join(' '));
    const world = makeScene();
    const pipelines = [chain(world, {}, other).pipeline, new Pipeline(other, pass(world.scene, world.camera))];
    const shown = [];
    for (const pipeline of pipelines) {
      const target = new THREE.RenderTarget(...SIZE);
      other.setRenderTarget(target);
      await (pipeline.render() ?? 0);
      await (pipeline.render() ?? 0);
      other.setRenderTarget(null);
      shown.push(Array.from(await other.readRenderTargetPixelsAsync(target, 0, 0, ...SIZE)));
    }
    console.warn = warn;
    return { warnings, off: off(...shown), light: total(shown[0]) };
  },

  async changed(change) {
    const world = makeScene();
    const made = chain(world, {});
    const before = await drawn(made);
    await made.bokeh.change(change);
    pipelines = 0;
    const result = await drawn(made);
    const added = pipelines;
    const wanted = await drawn(chain(makeScene(), change));
    return { off: off(result, wanted), acts: off(before, wanted), added };
  },

  // Another camera of another kind, and the planes that the node reads
  async camera() {
    const made = chain(makeScene(), {});
    await drawn(made);
    const other = new THREE.OrthographicCamera(-1.5, 1.5, 1, -1, 0.2, 40);
    made.bokeh.setCamera(other);
    const wanted = chain(makeScene(other), {});
    for (const name of ['focalLength', 'apertureDiameter']) wanted.bokeh.uniforms[name].value = made.bokeh.uniforms[name].value;
    const { depthKind, farPlane } = made.bokeh.uniforms;
    return { off: off(await drawn(made), await drawn(wanted)), kind: depthKind.value, far: farPlane.value };
  },

  // Glass: the picture without it and with it, at three places
  async glass() {
    const world = makeScene();
    const without = await drawn(chain(world, {}));
    addGlass(world);
    const made = chain(world, { sharpLayer: 1 });
    return glassFound([without, await drawn(made), await drawn(made)], world);
  },

  // Four samples a pixel: how far from one in the middle of the subject, and what share of the light is kept
  async samples() {
    const [several, one] = [await drawn(chain(makeScene(), {}, renderer, { samples: 4 })), await drawn(chain(makeScene(), {}))];
    return { middle: off(inMiddle(several), inMiddle(one)), light: total(several) / total(one) };
  },
};
