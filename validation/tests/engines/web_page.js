// What test_web.py asks of the classes for WebGLRenderer, in a scene of planes that face the camera.

import * as THREE from 'three';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import { ShaderPass } from 'three/addons/postprocessing/ShaderPass.js';
import { CopyShader } from 'three/addons/shaders/CopyShader.js';
import { PolygonBokehPass, SharpPass, depthOf } from 'polygonal-bokeh/three';

const SIZE = [96, 64];
const renderer = new THREE.WebGLRenderer();
renderer.setSize(...SIZE);
document.body.append(renderer.domElement);

const warnings = [];
console.warn = (...said) => warnings.push(said.join(' '));

function plane(scene, color, size, x, z, options = {}) {
  const material = new THREE.MeshBasicMaterial({ color, ...options });
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(size, size), material);
  mesh.position.set(x, 0, z);
  scene.add(mesh);
  return mesh;
}

// A sharp plane at 4 m, one before and one behind it, and a wall
function makeScene() {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0.02, 0.03, 0.05);
  const subject = plane(scene, 0xc08040, 1, 0, -4);
  plane(scene, 0x4080ff, 0.4, -0.5, -2);
  plane(scene, 0xffffff, 0.3, 1.2, -7).material.color.multiplyScalar(8);
  plane(scene, 0x203040, 60, 0, -12);
  const camera = new THREE.PerspectiveCamera(45, SIZE[0] / SIZE[1], 0.1, 50);
  return { scene, camera, subject };
}

// { composer, bokeh, scenePass, ... } with passes between the scene and the bokeh, and after it
function chain({ scene, camera, subject }, options, { samples = 0, depth = true, between = 0, after = () => [] } = {}) {
  const depthTexture = depth ? new THREE.DepthTexture(1, 1, THREE.FloatType) : null;
  const target = new THREE.WebGLRenderTarget(...SIZE, { type: THREE.HalfFloatType, depthTexture, samples });
  const composer = new EffectComposer(renderer, target);
  composer.renderToScreen = false;
  const scenePass = new RenderPass(scene, camera);
  const bokeh = new PolygonBokehPass(camera, typeof options === 'function' ? options(scenePass) : options);
  bokeh.setLens(0.07);
  bokeh.focusOn(subject);
  const copies = Array.from({ length: between }, () => new ShaderPass(CopyShader));
  for (const pass of [scenePass, ...copies, bokeh, ...after(bokeh)]) composer.addPass(pass);
  composer.setSize(...SIZE);
  return { composer, bokeh, scenePass };
}

// RGBA of what the chain drew, as numbers
function drawn({ composer }, frames = 1) {
  for (let i = 0; i < frames; i++) composer.render();
  const halves = new Uint16Array(4 * SIZE[0] * SIZE[1]);
  renderer.readRenderTargetPixels(composer.readBuffer, 0, 0, ...SIZE, halves);
  return Array.from(halves, THREE.DataUtils.fromHalfFloat);
}

const off = (a, b) => Math.max(...a.map((value, i) => Math.abs(value - b[i])));
const thrown = (call) => {
  try {
    call();
  } catch (error) {
    return error.message;
  }
};

window.bokeh = {
  revision: () => THREE.REVISION,

  refused(options) {
    return thrown(() => new PolygonBokehPass(new THREE.PerspectiveCamera(), options));
  },

  stops: () => thrown(() => new PolygonBokehPass(new THREE.PerspectiveCamera()).setLens(0)),

  // Without depth, and with an empty one: what was said, and how far from the colour that went in
  async warned() {
    const world = makeScene();
    const found = {};
    for (const [name, settings] of Object.entries({ none: { depth: false }, empty: { between: 1 }, right: {} })) {
      warnings.length = 0;
      const made = chain(world, {}, settings);
      const { look } = made.bokeh;
      let looked;
      made.bokeh.look = (...given) => (looked = look.apply(made.bokeh, given));
      const result = drawn(made, 31);
      await looked;
      const said = warnings.filter((text) => text.startsWith('polygonal-bokeh'));
      found[name] = { said, off: off(result, drawn(chain(world, {}, { depth: false }))) };
    }
    return found;
  },

  // A pass between the scene and the bokeh, with depthOf: as without it
  between() {
    const world = makeScene();
    const direct = drawn(chain(world, {}));
    return [1, 2].map((between) => {
      const options = (scenePass) => ({ depthTexture: depthOf(scenePass) });
      return off(drawn(chain(world, options, { between }), 3), direct);
    });
  },

  // Depth of a nested object from a camera in a scaled rig: as focusOn has it, and as the depth buffer does
  focus() {
    const { scene, camera, subject } = makeScene();
    const [rig, nest] = [new THREE.Group(), new THREE.Group()];
    rig.scale.setScalar(0.1);
    rig.add(camera);
    nest.position.set(0, 0, -1);
    nest.add(subject);
    scene.add(rig, nest);
    const { composer, bokeh } = chain({ scene, camera, subject }, { method: 'paper' });
    composer.render();
    const metres = new Float32Array(1);
    renderer.readRenderTargetPixels(bokeh.passes[0].target, SIZE[0] / 2, SIZE[1] / 2, 1, 1, metres);
    return { focus: bokeh.uniforms.focusDistance.value, drawn: metres[0], place: bokeh.depthOf({ x: 0, y: 0, z: -5 }) };
  },

  // The focus distance a frame later, of [from, dt, depths]
  pulls(cases) {
    const { bokeh } = chain(makeScene(), {});
    const { focusDistance } = bokeh.uniforms;
    return cases.map(([from, dt, depths]) => {
      focusDistance.value = from;
      bokeh.pullFocus(dt, depths);
      return focusDistance.value;
    });
  },

  // Options changed: how far from a pass that had them from the beginning, and the programs that its first frame made
  async changed(change) {
    const world = makeScene();
    const made = chain(world, {});
    drawn(made);
    const { textures } = renderer.info.memory;
    await made.bokeh.change(change);
    const programs = renderer.info.programs.length;
    const result = drawn(made);
    const added = renderer.info.programs.length - programs;
    await made.bokeh.change({ preset: 'MEDIUM', sides: 6, method: 'layered', extras: [] });
    drawn(made);
    const leaked = renderer.info.memory.textures - textures;
    return { off: off(result, drawn(chain(world, change))), added, leaked };
  },

  // Two changes at once: the last one counts. One that is refused changes nothing.
  async raced() {
    const made = chain(makeScene(), {});
    drawn(made);
    await Promise.all([made.bokeh.setSides(8), made.bokeh.setPreset('LOW'), made.bokeh.setSides(4)]);
    const error = await made.bokeh.setPreset('low').catch(({ message }) => message);
    drawn(made);
    return { sides: made.bokeh.options.sides, preset: made.bokeh.options.preset, error };
  },

  // Another camera: as a chain that had it from the beginning
  camera() {
    const world = makeScene();
    const made = chain(world, {});
    const other = new THREE.OrthographicCamera(-1.5, 1.5, 1, -1, 0.1, 50);
    made.bokeh.setCamera(other);
    made.scenePass.camera = other;
    made.bokeh.focusOn(world.subject);
    const wanted = chain({ ...world, camera: other }, {});
    wanted.bokeh.uniforms.focalLength.value = made.bokeh.uniforms.focalLength.value;
    wanted.bokeh.uniforms.apertureDiameter.value = made.bokeh.uniforms.apertureDiameter.value;
    return off(drawn(made), drawn(wanted));
  },

  // Uniforms of an extra set to what changes nothing, and to what does: how far from a pass without it
  extra([name, neutral, values, options]) {
    const world = makeScene();
    const plain = drawn(chain(world, options));
    return [neutral, values].map((set) => {
      const made = chain(world, { ...options, extras: [name] });
      for (const [key, value] of Object.entries(set)) made.bokeh.uniforms[key].value = value;
      return off(drawn(made), plain);
    });
  },

  memory() {
    const { bokeh } = chain(makeScene(), { method: 'exact' });
    return { bytes: bokeh.memory, passes: bokeh.passes.length };
  },

  // A transparent canvas: the result over a page's colour, and the scene before that colour, blurred
  alpha(options) {
    const { scene, camera, subject } = makeScene();
    scene.remove(scene.children.at(-1)); // the wall
    const page = [0.3, 0.5, 0.2];
    scene.background = null;
    renderer.setClearColor(0, 0);
    const clear = drawn(chain({ scene, camera, subject }, { ...options, alpha: true }));
    scene.background = new THREE.Color(...page);
    const truth = drawn(chain({ scene, camera, subject }, options));
    renderer.setClearColor(0, 1);
    const over = clear.map((value, i) => (i % 4 < 3 ? value + page[i % 4] * (1 - clear[i - (i % 4) + 3]) : 1));
    const shares = clear.filter((_, i) => i % 4 === 3);
    const inside = shares.filter((share) => share > 0.01 && share < 0.99).length;
    return { off: off(over, truth), inside, shares: [Math.min(...shares), Math.max(...shares)] };
  },

  // Glass on layer 1, half behind the subject: the picture with it, and what it has to be
  glass() {
    const world = makeScene();
    const without = drawn(chain(world, {}));
    const pane = plane(world.scene, 0x00ff00, 1.2, 0.7, -4.5, { transparent: true, opacity: 0.5, depthWrite: false });
    pane.layers.set(1);
    const result = drawn(chain(world, {}, { after: (bokeh) => [new SharpPass(bokeh, world.scene)] }));
    const at = (image, x, y) => image.slice(4 * (y * SIZE[0] + x), 4 * (y * SIZE[0] + x) + 3);
    const places = { behind: [50, 32], glass: [66, 32], beside: [8, 8] };
    const found = {};
    for (const [name, [x, y]] of Object.entries(places)) found[name] = [at(without, x, y), at(result, x, y)];
    return { found, background: world.scene.background.getHex(), mask: world.camera.layers.mask };
  },

  // Four samples a pixel: how far from one in the middle of the subject, and what share of its light a picture keeps
  samples() {
    const world = makeScene();
    const total = (image) => image.reduce((sum, value, i) => (i % 4 < 3 ? sum + value : sum), 0);
    const middle = 4 * (32 * SIZE[0] + 48);
    const [several, one] = [4, 0].map((samples) => {
      const image = drawn(chain(world, {}, { samples }));
      return { at: image.slice(middle, middle + 3), kept: total(image) / total(drawn(chain(world, {}, { samples, depth: false }))) };
    });
    return { middle: off(several.at, one.at), kept: [several.kept, one.kept] };
  },
};
