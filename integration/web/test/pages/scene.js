// The code that webgl.js and webgpu.js share: a scene of planes that face the camera, and calls that both pages have.

import * as THREE from 'three';

export const SIZE = [96, 64];

function plane(scene, color, size, x, z, options = {}) {
  const material = new THREE.MeshBasicMaterial({ color, ...options });
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(size, size), material);
  mesh.position.set(x, 0, z);
  scene.add(mesh);
  return mesh;
}

// Returns a scene with a sharp plane at 4 m (`subject`), a plane in front of it, a plane behind it and a wall. The
// plane behind it is `light` times as bright as white.
export function makeScene(light, camera = new THREE.PerspectiveCamera(45, SIZE[0] / SIZE[1], 0.1, 50)) {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0.02, 0.03, 0.05);
  const subject = plane(scene, 0xc08040, 1, 0, -4);
  plane(scene, 0x4080ff, 0.4, -0.5, -2);
  plane(scene, 0xffffff, 0.3, 1.2, -7).material.color.multiplyScalar(light);
  plane(scene, 0x203040, 60, 0, -12);
  return { scene, camera, subject };
}

// Adds glass on layer 1; one half of it is behind the subject.
export function addGlass({ scene }) {
  plane(scene, 0x00ff00, 1.2, 0.7, -4.5, { transparent: true, opacity: 0.5, depthWrite: false }).layers.set(1);
}

// Returns the colours at three points of several images: the first without the glass, the others with it. Also returns
// whether the scene still has its background, and the camera's layer mask.
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

// Returns the calls that both pages have. `newWorld`, `chain` and `drawn` are functions of the page.
export const calls = (renderer, newWorld, chain, drawn) => ({
  // Sets the uniforms of an extra first to neutral values, then to others. Returns how much each image differs from the
  // image without the extra.
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

  // Compares a transparent canvas over the colour of a page with the blurred scene whose background has that colour.
  async alpha(options) {
    const world = newWorld();
    const { scene } = world;
    scene.remove(scene.children.at(-1)); // the wall
    const page = [0.3, 0.5, 0.2];
    scene.background = null;
    renderer.setClearColor(0, 0);
    const clear = await drawn(chain(world, { ...options, alpha: true }));
    scene.background = new THREE.Color(...page);
    // with alpha here too: without it, a pixel next to a brighter one may get the circle of confusion of that pixel
    const truth = await drawn(chain(world, { ...options, alpha: true }));
    renderer.setClearColor(0, 1);
    const over = clear.map((value, i) => (i % 4 < 3 ? value + page[i % 4] * (1 - clear[i - (i % 4) + 3]) : 1));
    const shares = clear.filter((_, i) => i % 4 === 3);
    const inside = shares.filter((share) => share > 0.01 && share < 0.99).length;
    return { off: off(over, truth), inside, shares: [Math.min(...shares), Math.max(...shares)] };
  },
});
