// What webgl.js and webgpu.js share: a scene of planes that face the camera, and calls that mean the same for both classes.

import * as THREE from 'three';

export const SIZE = [96, 64];

function plane(scene, color, size, x, z, options = {}) {
  const material = new THREE.MeshBasicMaterial({ color, ...options });
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(size, size), material);
  mesh.position.set(x, 0, z);
  scene.add(mesh);
  return mesh;
}

// A sharp plane at 4 m, one before and one behind it, which is so many times as bright as white, and a wall
export function makeScene(light, camera = new THREE.PerspectiveCamera(45, SIZE[0] / SIZE[1], 0.1, 50)) {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0.02, 0.03, 0.05);
  const subject = plane(scene, 0xc08040, 1, 0, -4);
  plane(scene, 0x4080ff, 0.4, -0.5, -2);
  plane(scene, 0xffffff, 0.3, 1.2, -7).material.color.multiplyScalar(light);
  plane(scene, 0x203040, 60, 0, -12);
  return { scene, camera, subject };
}

// Glass on layer 1, half behind the subject
export function addGlass({ scene }) {
  plane(scene, 0x00ff00, 1.2, 0.7, -4.5, { transparent: true, opacity: 0.5, depthWrite: false }).layers.set(1);
}

// What is said of a picture without the glass, and of others with it: colours at three places
export function glassFound(images, { scene, camera }) {
  const at = (image, x, y) => image.slice(4 * (y * SIZE[0] + x), 4 * (y * SIZE[0] + x) + 3);
  const found = {};
  for (const [name, [x, y]] of Object.entries({ behind: [50, 32], glass: [66, 32], beside: [8, 8] })) {
    found[name] = images.map((image) => at(image, x, y));
  }
  return { found, background: Boolean(scene.background), mask: camera.layers.mask };
}

export const off = (a, b) => Math.max(...a.map((value, i) => Math.abs(value - b[i])));
export const total = (image) => image.reduce((sum, value, i) => (i % 4 < 3 ? sum + value : sum), 0);
export const inMiddle = (image) => image.slice(4 * (32 * SIZE[0] + 48), 4 * (32 * SIZE[0] + 48) + 3);

// The calls that both pages have; `newWorld`, `chain` and `drawn` are the page's own
export const calls = (renderer, newWorld, chain, drawn) => ({
  // Uniforms of an extra set to what changes nothing, and to what does: how far from a pass without it
  async extra([name, neutral, values, options]) {
    const plain = await drawn(chain(newWorld(), options));
    const found = [];
    for (const set of [neutral, values]) {
      const made = chain(newWorld(), { ...options, extras: [name] });
      for (const [key, value] of Object.entries(set)) made.bokeh.uniforms[key].value = value;
      found.push(off(await drawn(made), plain));
    }
    return found;
  },

  async memory() {
    const made = chain(newWorld(), { method: 'exact' });
    await drawn(made);
    return { bytes: made.bokeh.memory, passes: made.bokeh.passes.length };
  },

  // A transparent canvas: the result over a page's colour, and the scene before that colour, blurred
  async alpha(options) {
    const world = newWorld();
    const { scene } = world;
    scene.remove(scene.children.at(-1)); // the wall
    const page = [0.3, 0.5, 0.2];
    scene.background = null;
    renderer.setClearColor(0, 0);
    const clear = await drawn(chain(world, { ...options, alpha: true }));
    scene.background = new THREE.Color(...page);
    // with alpha too: without it a pixel beside a brighter one may get that one's circle of confusion
    const truth = await drawn(chain(world, { ...options, alpha: true }));
    renderer.setClearColor(0, 1);
    const over = clear.map((value, i) => (i % 4 < 3 ? value + page[i % 4] * (1 - clear[i - (i % 4) + 3]) : 1));
    const shares = clear.filter((_, i) => i % 4 === 3);
    const inside = shares.filter((share) => share > 0.01 && share < 0.99).length;
    return { off: off(over, truth), inside, shares: [Math.min(...shares), Math.max(...shares)] };
  },
});
