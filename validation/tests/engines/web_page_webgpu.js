// What test_web.py asks of the class for WebGPURenderer, in a scene of planes that face the camera.

import * as THREE from 'three/webgpu';
import { pass } from 'three/tsl';
import { PolygonBokehNode } from 'polygonal-bokeh/three-webgpu';

// How many pipelines were made while the caller waited
let pipelines = 0;
const { createRenderPipeline } = GPUDevice.prototype;
GPUDevice.prototype.createRenderPipeline = function (...given) {
  pipelines += 1;
  return createRenderPipeline.call(this, ...given);
};

const SIZE = [96, 64];
const Pipeline = THREE.RenderPipeline ?? THREE.PostProcessing;
const renderer = new THREE.WebGPURenderer();
renderer.setSize(...SIZE);
document.body.append(renderer.domElement);
await renderer.init();

function makeScene(camera = new THREE.PerspectiveCamera(45, SIZE[0] / SIZE[1], 0.1, 50)) {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0.02, 0.03, 0.05);
  const rows = [[0xc08040, 1, 0, -4], [0x4080ff, 0.4, -0.5, -2], [0xffffff, 0.3, 1.2, -7], [0x203040, 60, 0, -12]];
  const [subject] = rows.map(([color, size, x, z]) => {
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(size, size), new THREE.MeshBasicMaterial({ color }));
    mesh.position.set(x, 0, z);
    scene.add(mesh);
    return mesh;
  });
  return { scene, camera, subject };
}

function chain({ scene, camera, subject }, options, other = renderer, settings = {}) {
  const bokeh = new PolygonBokehNode(pass(scene, camera, settings), options);
  bokeh.setLens(0.07);
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

const off = (a, b) => Math.max(...a.map((value, i) => Math.abs(value - b[i])));
const message = (call) => call().then(() => '', (error) => error.message);

window.bokeh = {
  refused: (options) => message(async () => new PolygonBokehNode(pass(...Object.values(makeScene()).slice(0, 2)), options)),

  // WebGL under WebGPURenderer, and a depth buffer that cannot be read: what render() throws
  async errors() {
    const found = [];
    for (const options of [{ forceWebGL: true }, { logarithmicDepthBuffer: true }]) {
      const other = new THREE.WebGPURenderer(options);
      await other.init();
      found.push(await message(async () => chain(makeScene(), {}, other).pipeline.render()));
    }
    return found;
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

  async extra([name, neutral, values, options]) {
    const plain = await drawn(chain(makeScene(), options));
    const found = [];
    for (const set of [neutral, values]) {
      const made = chain(makeScene(), { ...options, extras: [name] });
      for (const [key, value] of Object.entries(set)) made.bokeh.uniforms[key].value = value;
      found.push(off(await drawn(made), plain));
    }
    return found;
  },

  async alpha(options) {
    const world = makeScene();
    const { scene } = world;
    scene.remove(scene.children.at(-1)); // the wall
    const page = [0.3, 0.5, 0.2];
    scene.background = null;
    renderer.setClearColor(0, 0);
    const clear = await drawn(chain(world, { ...options, alpha: true }));
    scene.background = new THREE.Color(...page);
    const truth = await drawn(chain(world, options));
    const over = clear.map((value, i) => (i % 4 < 3 ? value + page[i % 4] * (1 - clear[i - (i % 4) + 3]) : 1));
    const shares = clear.filter((_, i) => i % 4 === 3);
    const inside = shares.filter((share) => share > 0.01 && share < 0.99).length;
    return { off: off(over, truth), inside, shares: [Math.min(...shares), Math.max(...shares)] };
  },

  // Glass on layer 1, half behind the subject: the picture without it and with it, at three places
  async glass() {
    const world = makeScene();
    const without = await drawn(chain(world, {}));
    const material = new THREE.MeshBasicMaterial({ color: 0x00ff00, transparent: true, opacity: 0.5, depthWrite: false });
    const pane = new THREE.Mesh(new THREE.PlaneGeometry(1.2, 1.2), material);
    pane.position.set(0.7, 0, -4.5);
    pane.layers.set(1);
    world.scene.add(pane);
    const made = chain(world, { sharpLayer: 1 });
    const frames = [await drawn(made), await drawn(made)];
    const at = (image, x) => image.slice(4 * (32 * SIZE[0] + x), 4 * (32 * SIZE[0] + x) + 3);
    const places = { behind: 50, glass: 66, beside: 8 };
    const found = Object.entries(places).map(([name, x]) => [name, [without, ...frames].map((image) => at(image, x))]);
    return { found: Object.fromEntries(found), background: Boolean(world.scene.background), mask: world.camera.layers.mask };
  },

  // Four samples a pixel: how far from one in the middle of the subject, and what share of the light is kept
  async samples() {
    const total = (image) => image.reduce((sum, value, i) => (i % 4 < 3 ? sum + value : sum), 0);
    const [several, one] = [await drawn(chain(makeScene(), {}, renderer, { samples: 4 })), await drawn(chain(makeScene(), {}))];
    const middle = 4 * (32 * SIZE[0] + 48);
    return { middle: off(several.slice(middle, middle + 3), one.slice(middle, middle + 3)), light: total(several) / total(one) };
  },

  memory: async () => {
    const made = chain(makeScene(), { method: 'exact' });
    await drawn(made);
    return { bytes: made.bokeh.memory, passes: made.bokeh.passes.length };
  },
};
