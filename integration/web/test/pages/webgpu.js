// The page with which three-webgpu.test.js tests the class for WebGPURenderer, in the scene of scene.js.

import * as THREE from 'three/webgpu';
import { add, mrt, normalView, output, pass, texture, vec4 } from 'three/tsl';
import { bloom } from 'three/addons/tsl/display/BloomNode.js';
import { ao } from 'three/addons/tsl/display/GTAONode.js';
import { PolygonBokehNode } from 'polygonal-bokeh/three-webgpu';
import { SIZE, addGlass, calls, glassFound, inMiddle, makeScene as sceneOf, off, total } from './scene.js';

// How many pipelines were created synchronously, while the caller waited
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
  return pixels(bokeh.sharp ?? bokeh.result, other);
}

async function pixels(target, other = renderer) {
  const halves = await other.readRenderTargetPixelsAsync(target, 0, 0, target.width, target.height);
  return Array.from(halves, THREE.DataUtils.fromHalfFloat);
}

// Creates a chain with other nodes. build(scenePass, camera) returns the arguments of PolygonBokehNode, and
// after(bokeh) returns the node to show.
function graph({ scene, camera, subject }, build, after = (bokeh) => bokeh) {
  const scenePass = pass(scene, camera);
  const bokeh = new PolygonBokehNode(...build(scenePass, camera));
  bokeh.setLens(1.4, 20);
  bokeh.focusOn(subject);
  return { bokeh, pipeline: new Pipeline(renderer, after(bokeh)), scene };
}

// Returns the arguments for colour times ambient occlusion, as in the examples of three.js.
function occluded(scenePass, camera) {
  scenePass.setMRT(mrt({ output, normal: normalView }));
  const depth = scenePass.getTextureNode('depth');
  const occlusion = ao(depth, scenePass.getTextureNode('normal'), camera);
  occlusion.radius.value = 2;
  return [scenePass.getTextureNode().mul(vec4(occlusion.getTextureNode().rrr, 1)), depth, camera];
}

// Returns the same for global illumination, by the function ssgi of three.js.
const illuminated = (ssgi) => (scenePass, camera) => {
  scenePass.setMRT(mrt({ output, normal: normalView }));
  const [color, depth] = ['output', 'depth'].map((name) => scenePass.getTextureNode(name));
  const light = ssgi(color, depth, scenePass.getTextureNode('normal'), camera);
  return [color.mul(light.getAONode().r).add(color.mul(light.getGINode())), depth, camera];
};

const message = (call) => call().then(() => '', (error) => error.message);

window.bokeh = {
  ...calls(renderer, makeScene, chain, drawn),

  refused: (options) => message(async () => new PolygonBokehNode(pass(...Object.values(makeScene()).slice(0, 2)), options)),

  // Returns the error that render() throws for a depth buffer that cannot be read.
  async logarithmic() {
    const other = new THREE.WebGPURenderer({ logarithmicDepthBuffer: true });
    await other.init();
    return message(async () => chain(makeScene(), {}, other).pipeline.render());
  },

  // Draws two frames with WebGPURenderer on WebGL. Returns the warnings, how much the image differs from the scene's,
  // and its light.
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

  // For a bokehScale of 0, returns how many fewer renders there are, the number of passes, how much the image differs
  // from the scene (off), how much the blurred image does (acts), and whether the blur comes back (again: 0).
  async unblurred() {
    const made = chain(makeScene(), {});
    const { render } = renderer;
    let count = 0;
    renderer.render = (...given) => {
      count += 1;
      return render.apply(renderer, given);
    };
    const blurred = await drawn(made);
    const whole = count;
    made.bokeh.setLens(2.8, 0);
    count = 0;
    const image = await drawn(made);
    const fewer = whole - count;
    delete renderer.render;
    const scene = await pixels(made.bokeh.scenePass.renderTarget);
    made.bokeh.setLens(1.4, 20);
    const again = off(await drawn(made), blurred);
    return { fewer, passes: made.bokeh.passes.length, off: off(image, scene), acts: off(blurred, scene), again };
  },

  // Draws frames while the shaders of a change are compiled. Returns how much they differ from a frame before the
  // change, and how many there were.
  async between(change) {
    const made = chain(makeScene(), {});
    const before = await drawn(made);
    let ended = false;
    made.bokeh.change(change).then(() => (ended = true));
    const found = [];
    while (!ended) {
      made.pipeline.render(); // onto the canvas
      const image = await drawn(made);
      if (!ended) found.push(off(image, before));
      await new Promise(requestAnimationFrame);
    }
    return { off: Math.max(...found), count: found.length };
  },

  // Sets a camera of another kind. Returns how much the image differs from that of a node that was created with this
  // camera, and the kind of depth and the far plane that the node uses.
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

  // Creates nodes from (color, depth, camera). Returns how much their image differs from that of the node of a scene
  // pass: for the same colour (same), and for half the colour, with the result doubled (half). Also returns the kind of
  // depth and the far plane after another camera is set.
  async nodes() {
    const plain = await drawn(chain(makeScene(), {}));
    const depthOf = (scenePass) => scenePass.getTextureNode('depth');
    const same = await drawn(graph(makeScene(), (scenePass, camera) => [scenePass, depthOf(scenePass), camera, {}]));
    const half = (scenePass, camera) => [scenePass.getTextureNode().mul(0.5), depthOf(scenePass), camera];
    const made = graph(makeScene(), half);
    const doubled = (await drawn(made)).map((value, i) => (i % 4 < 3 ? 2 * value : value));
    made.bokeh.setCamera(new THREE.OrthographicCamera(-1.5, 1.5, 1, -1, 0.2, 40));
    await drawn(made);
    const { depthKind, farPlane } = made.bokeh.uniforms;
    return { same: off(same, plain), half: off(doubled, plain), kind: depthKind.value, far: farPlane.value };
  },

  // Draws ambient occlusion or 'ssgi' before the bokeh. Returns how much the image differs from the bokeh of a texture
  // with the same pixels (baked), and from the bokeh of the scene alone (acts), and the size of the image after a
  // resize. Returns null if this version of three.js has no SSGINode. Each chain has a scene of its own, because old
  // versions of three.js mix up several passes of one scene.
  async occlusion(by) {
    if (by === 'ssgi' && Number(THREE.REVISION) < 180) return null;
    const build = by === 'ssgi' ? illuminated((await import('three/addons/tsl/display/SSGINode.js')).ssgi) : occluded;
    const worldOf = () => {
      const world = makeScene();
      world.scene.children.at(-1).position.z = -4.3; // the wall, near enough to the subject for some occlusion
      return world;
    };
    const made = graph(worldOf(), build);
    const found = await drawn(made);
    const colour = made.bokeh.source.color.renderTarget;
    const halves = await renderer.readRenderTargetPixelsAsync(colour, 0, 0, ...SIZE);
    const held = new THREE.DataTexture(halves, ...SIZE, THREE.RGBAFormat, THREE.HalfFloatType);
    held.needsUpdate = true;
    const baked = (scenePass, camera) => [texture(held), scenePass.getTextureNode('depth'), camera];
    const [same, without] = [await drawn(graph(worldOf(), baked)), await drawn(chain(worldOf(), {}))];
    renderer.setSize(48, 32);
    await drawn(made);
    renderer.setSize(...SIZE);
    return { baked: off(found, same), acts: off(found, without), resized: made.bokeh.size, revision: Number(THREE.REVISION) };
  },

  // Adds bloom after the bokeh, which draws its input in shaders of its own. Returns how much the result of the bokeh
  // differs from the result without bloom.
  async bloom() {
    const world = makeScene();
    const plain = await drawn(chain(world, {}));
    const made = graph(world, (scenePass) => [scenePass], (bokeh) => add(bokeh, bloom(bokeh, 1)));
    return { off: off(await drawn(made), plain) };
  },

  // Adds temporal anti-aliasing before the bokeh: the camera jitters, and the texture is another one in each frame.
  // Returns null if this version of three.js has no TRAANode.
  async traa() {
    if (Number(THREE.REVISION) < 180) return null;
    const { traa } = await import('three/addons/tsl/display/TRAANode.js');
    const { velocity } = await import('three/tsl');
    const world = makeScene();
    const made = graph(world, (scenePass, camera) => {
      scenePass.setMRT(mrt({ output, velocity }));
      const depth = scenePass.getTextureNode('depth');
      return [traa(scenePass.getTextureNode(), depth, scenePass.getTextureNode('velocity'), camera), depth, camera];
    });
    let image;
    for (let i = 0; i < 8; i++) image = await drawn(made);
    const plain = await drawn(chain(makeScene(), {}));
    return { middle: off(inMiddle(image), inMiddle(plain)), light: total(image) / total(plain) };
  },

  // Returns the errors that the constructor throws for invalid arguments.
  wrongNodes() {
    const { scene, camera } = makeScene();
    const scenePass = pass(scene, camera);
    const depth = scenePass.getTextureNode('depth');
    const given = [[], [scenePass.getTextureNode()], [scenePass, scenePass.getTextureNode(), camera], [scenePass, depth]];
    given.push([scenePass, depth, camera, { sharpLayer: 1 }]);
    return Promise.all(given.map((one) => message(async () => new PolygonBokehNode(...one))));
  },

  // Returns the colours at three points of several images: without glass and in two frames with it, and then, after a
  // change and with a bokehScale of 0, of the blurred image and of the image with glass. Throws an Error if the pass
  // draws another scene after dispose().
  async glass() {
    const world = makeScene();
    const without = await drawn(chain(world, {}));
    addGlass(world);
    const made = chain(world, { sharpLayer: 1 });
    const found = [glassFound([without, await drawn(made), await drawn(made)], world)];
    for (const step of [() => made.bokeh.change({ sides: 4 }), () => made.bokeh.setLens(2.8, 0)]) {
      await step();
      await drawn(made);
      found.push(glassFound([await pixels(made.bokeh.result), await pixels(made.bokeh.sharp)], world));
    }
    const { scenePass } = made.bokeh;
    const before = await pixels(scenePass.renderTarget);
    made.bokeh.dispose();
    Object.assign(made.pipeline, { outputNode: scenePass, needsUpdate: true });
    await (made.pipeline.render() ?? 0);
    if (off(await pixels(scenePass.renderTarget), before)) throw new Error('dispose() has changed the scene');
    return found;
  },

  // Compares four samples per pixel with one. Returns how much the middle of the subject differs, and the quotient of
  // the two amounts of light.
  async samples() {
    const [several, one] = [await drawn(chain(makeScene(), {}, renderer, { samples: 4 })), await drawn(chain(makeScene(), {}))];
    return { middle: off(inMiddle(several), inMiddle(one)), light: total(several) / total(one) };
  },
};
