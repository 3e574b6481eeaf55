// The page with which three.test.js tests the classes for WebGLRenderer, in the scene of scene.js.

import * as THREE from 'three';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import { ShaderPass } from 'three/addons/postprocessing/ShaderPass.js';
import { CopyShader } from 'three/addons/shaders/CopyShader.js';
import { PolygonBokehPass, SharpPass, depthOf, depthWithOpacity } from 'polygonal-bokeh/three';
import { SIZE, addGlass, calls, glassFound, inMiddle, makeScene as sceneOf, off, total } from './scene.js';

const renderer = new THREE.WebGLRenderer();
renderer.setSize(...SIZE);
document.body.append(renderer.domElement);

const warnings = [];
console.warn = (...said) => warnings.push(said.join(' '));

const makeScene = () => sceneOf(8);

// Creates a composer with the bokeh. Returns { composer, bokeh, scenePass }.
//   between  number of passes between the scene and the bokeh
//   after    function from the bokeh to the passes after it
function chain({ scene, camera, subject }, options, { samples = 0, depth = true, between = 0, after = () => [] } = {}) {
  const depthTexture = depth ? new THREE.DepthTexture(1, 1, THREE.FloatType) : null;
  const target = new THREE.WebGLRenderTarget(...SIZE, { type: THREE.HalfFloatType, depthTexture, samples });
  const composer = new EffectComposer(renderer, target);
  composer.renderToScreen = false;
  const scenePass = new RenderPass(scene, camera);
  const bokeh = new PolygonBokehPass(camera, typeof options === 'function' ? options(scenePass) : options);
  bokeh.setLens(1.4, 20);
  bokeh.focusOn(subject);
  const copies = Array.from({ length: between }, () => new ShaderPass(CopyShader));
  for (const pass of [scenePass, ...copies, bokeh, ...after(bokeh)]) composer.addPass(pass);
  composer.setSize(...SIZE);
  return { composer, bokeh, scenePass };
}

// Draws frames, and returns the pixels of the last one as RGBA numbers.
function drawn({ composer }, frames = 1) {
  for (let i = 0; i < frames; i++) composer.render();
  const halves = new Uint16Array(4 * SIZE[0] * SIZE[1]);
  renderer.readRenderTargetPixels(composer.readBuffer, 0, 0, ...SIZE, halves);
  return Array.from(halves, THREE.DataUtils.fromHalfFloat);
}

const glass = (opacity, options = {}) => new THREE.MeshBasicMaterial({ transparent: true, opacity, ...options });
const faint = new THREE.DataTexture(new Uint8Array([255, 255, 255, 51]), 1, 1); // an alpha of 0.2
faint.needsUpdate = true;
const OWN_OUTPUT = {
  glslVersion: THREE.GLSL3,
  transparent: true,
  vertexShader: 'void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
  fragmentShader: 'out highp vec4 mine; void main() { mine = vec4(1.0, 0.0, 0.0, 0.5); }',
};
// Surfaces in front of the subject at 4 m, the wall at 12 m or the sky:
//   at        pixel to look at
//   surfaces  [metres, material], from back to front
//   metres    the depth expected there
const WEIGHTED = {
  subject: { at: [48, 34], surfaces: [], metres: 4 },
  wall: { at: [48, 4], surfaces: [], metres: 12 },
  sky: { at: [3, 4], surfaces: [], metres: 1e9 },
  half: { at: [48, 30], surfaces: [[3, glass(0.5)]], metres: 0.5 * 3 + 0.5 * 4 },
  two: { at: [60, 6], surfaces: [[6, glass(0.25)], [2, glass(0.5)]], metres: 0.5 * 2 + 0.5 * (0.25 * 6 + 0.75 * 12) },
  map: { at: [36, 58], surfaces: [[3, glass(1, { map: faint })]], metres: 0.2 * 3 + 0.8 * 12 },
  added: { at: [36, 6], surfaces: [[3, glass(0.5, { blending: THREE.AdditiveBlending })]], metres: 0.5 * 3 + 0.5 * 12 },
  solid: { at: [48, 58], surfaces: [[3, new THREE.MeshLambertMaterial()]], metres: 3 },
  clear: { at: [60, 58], surfaces: [[3, new THREE.MeshPhysicalMaterial({ transmission: 0.75 })]], metres: 0.25 * 3 + 0.75 * 12 },
  shader: { at: [66, 50], surfaces: [[3, new THREE.ShaderMaterial(OWN_OUTPUT)]], metres: 0.5 * 3 + 0.5 * 12 },
  most: { at: [93, 50], surfaces: [[3, glass(0.6)]], metres: 3 },
  least: { at: [93, 14], surfaces: [[3, glass(0.4)]], metres: 1e9 },
};

const thrown = (call) => {
  try {
    call();
  } catch (error) {
    return error.message;
  }
};

window.bokeh = {
  ...calls(renderer, makeScene, chain, drawn),
  revision: () => THREE.REVISION,

  refused(options) {
    return thrown(() => new PolygonBokehPass(new THREE.PerspectiveCamera(), options));
  },

  stops: () => thrown(() => new PolygonBokehPass(new THREE.PerspectiveCamera()).setLens(0)),

  // For no depth, an empty depth and a correct one, returns the warnings, and how much the image differs from the
  // input.
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

  // For a bokehScale of 0, returns how many passes are drawn in the middle of a chain (inChain) and at its end
  // (onScreen), how much the image differs from the input (off) and from the blurred image (acts), and whether the blur
  // comes back (again: 0).
  unblurred() {
    const world = makeScene();
    const scene = drawn(chain(world, {}, { depth: false }));
    const made = chain(world, {});
    const { quad } = made.bokeh;
    const { render } = quad;
    let count = 0;
    quad.render = (...given) => {
      count += 1;
      render.apply(quad, given);
    };
    const blurred = drawn(made);
    made.bokeh.setLens(2.8, 0);
    count = 0;
    const off0 = off(drawn(made), scene);
    const inChain = count;
    made.composer.renderToScreen = true;
    made.composer.render();
    made.composer.renderToScreen = false;
    const onScreen = count - inChain;
    made.bokeh.setLens(1.4, 20);
    return { off: off0, inChain, onScreen, acts: off(blurred, scene), again: off(drawn(made), blurred) };
  },

  // Returns how much one and two passes between the scene and the bokeh change the image, with depthOf.
  between() {
    const world = makeScene();
    const direct = drawn(chain(world, {}));
    return [1, 2].map((between) => {
      const options = (scenePass) => ({ depthTexture: depthOf(scenePass) });
      return off(drawn(chain(world, options, { between }), 3), direct);
    });
  },

  // Returns the metres of depthWithOpacity at the pixels of WEIGHTED, in two frames, and the metres expected. Also
  // returns whether the scene has its materials again (same), and how many programs are freed when the pass is disposed
  // of.
  weighted(orthographic) {
    const world = makeScene();
    const { scene } = world;
    if (orthographic) world.camera = new THREE.OrthographicCamera(-6, 6, 4, -4, 0.1, 50);
    const { camera } = world;
    world.camera.updateMatrixWorld();
    scene.children.at(-1).scale.x = 0.12; // left and right of the wall is the sky
    for (const { at, surfaces } of Object.values(WEIGHTED)) {
      for (const [z, material] of surfaces) {
        const mesh = new THREE.Mesh(new THREE.PlaneGeometry(0.1 * z, 0.1 * z), material);
        const towards = new THREE.Vector3(...at.map((value, i) => (2 * value + 1) / SIZE[i] - 1), 0.5).unproject(camera);
        if (orthographic) mesh.position.set(towards.x, towards.y, -z);
        else mesh.position.copy(towards.multiplyScalar(-z / towards.z));
        scene.add(mesh);
      }
    }
    const materials = () => scene.children.map(({ material }) => material?.uuid + Object.hasOwn(material ?? {}, 'uuid'));
    const before = materials();
    const plain = chain(world, {});
    drawn(plain);
    const made = chain(world, (scenePass) => ({ method: 'paper', depthTexture: depthWithOpacity(scenePass) }));
    const metres = [1, 2].map(() => {
      drawn(made);
      const found = new Float32Array(SIZE[0] * SIZE[1]);
      renderer.readRenderTargetPixels(made.bokeh.passes[0].target, 0, 0, ...SIZE, found);
      return Object.values(WEIGHTED).map(({ at: [x, y] }) => found[y * SIZE[0] + x]);
    });
    const { length } = renderer.info.programs;
    made.scenePass.dispose();
    const wanted = Object.values(WEIGHTED).map(({ metres }) => metres);
    return { metres, wanted, same: String(before) === String(materials()), freed: length - renderer.info.programs.length };
  },

  // Returns the depth of a nested object from a camera in a scaled rig: as focusOn computes it (focus), as the depth
  // buffer has it (drawn), and as depthOf computes it for a point (place).
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

  // Returns the focus distance a frame later, for each [from, dt, depths].
  pulls(cases) {
    const { bokeh } = chain(makeScene(), {});
    const { focusDistance } = bokeh.uniforms;
    return cases.map(([from, dt, depths]) => {
      focusDistance.value = from;
      bokeh.pullFocus(dt, depths);
      return focusDistance.value;
    });
  },

  // Changes options. Returns how much the image differs from that of a pass that was created with them (off), how many
  // programs the first frame compiled (added), and how many textures remain after the options are changed back
  // (leaked).
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

  // Makes three changes at once, of which only the last must take effect, and then an invalid one, which must change
  // nothing. Returns the options afterwards, and the error.
  async raced() {
    const made = chain(makeScene(), {});
    drawn(made);
    await Promise.all([made.bokeh.setSides(8), made.bokeh.setPreset('LOW'), made.bokeh.setSides(4)]);
    const error = await made.bokeh.setPreset('low').catch(({ message }) => message);
    drawn(made);
    return { sides: made.bokeh.options.sides, preset: made.bokeh.options.preset, error };
  },

  // Sets another camera. Returns how much the image differs from that of a chain that was created with this camera.
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

  // Returns the colours at three points of the image, without glass and with it.
  glass() {
    const world = makeScene();
    const without = drawn(chain(world, {}));
    addGlass(world);
    const result = drawn(chain(world, {}, { after: (bokeh) => [new SharpPass(bokeh, world.scene)] }));
    return [glassFound([without, result], world)];
  },

  // Compares four samples per pixel with one. Returns how much the middle of the subject differs, and the fraction of
  // its light that each image keeps when it is blurred.
  samples() {
    const world = makeScene();
    const [several, one] = [4, 0].map((samples) => {
      const image = drawn(chain(world, {}, { samples }));
      return { at: inMiddle(image), kept: total(image) / total(drawn(chain(world, {}, { samples, depth: false }))) };
    });
    return { middle: off(several.at, one.at), kept: [several.kept, one.kept] };
  },
};
