// The code that the tests of both classes for three.js share.

import assert from 'node:assert/strict';
import { INTEGRATION, MODULES, opened } from './opened.js';

// Packages: the newest three.js, and the oldest that works
export const VERSIONS = ['three', 'three-oldest'];
export const CHANGES = [{ preset: 'LOW' }, { sides: 8 }, { method: 'exact' }, { extras: ['lateral'] }];
// [extra, uniforms with neutral values, uniforms with values that have an effect, options]
const EXTRAS = [
  ['jitter', { jitter: 0 }, { jitter: 1 }, { method: 'exact', preset: 'LOW' }],
  ['catsEye', { catsEye: 0 }, { catsEye: 0.8 }, {}],
  ['catsEye', { catsEye: 0, roundness: 1 }, { catsEye: 0, roundness: 0 }, { sides: 8 }],
  ['lateral', { lateral: 0 }, { lateral: 0.02 }, {}],
  ['focusRange', {}, { frontRange: 1, backRange: 8 }, {}],
  ['focusRange', {}, { nearScale: 0 }, {}],
];
// Without these flags, Chromium's software device is lost as soon as WebGPU draws onto a canvas
export const CANVAS = ['--enable-features=Vulkan', '--use-vulkan=swiftshader'];

// Opens pages/webgl.js, webgpu.js or glass.js with a version of three.js.
export function openedWith(version, kind) {
  const build = `/MODULES/${version}/build`;
  const imports = {
    'polygonal-bokeh/': '/integration/web/',
    'polygonal-bokeh/three': '/integration/web/three.js',
    'polygonal-bokeh/three-webgpu': '/integration/web/three-webgpu.js',
    three: `${build}/three.${kind === 'webgpu' ? 'webgpu' : 'module'}.js`,
    'three/addons/': `/MODULES/${version}/examples/jsm/`,
    'three/webgpu': `${build}/three.webgpu.js`,
    'three/tsl': `${build}/three.tsl.js`,
  };
  const script = `/integration/web/test/pages/${kind}.js`;
  const html = `<!doctype html><script type="importmap">${JSON.stringify({ imports })}</script>
<script type="module" src="${script}"></script>`;
  const places = [['page.html', Buffer.from(html)], ['MODULES/', MODULES], ['integration/', INTEGRATION]];
  return opened(places, kind === 'webgpu' ? CANVAS : []);
}

export function assertNear(value, wanted, most, what = '') {
  assert.ok(Math.abs(value - wanted) <= most, `${what} ${value} is more than ${most} off ${wanted}`);
}

// Runs the tests that both classes must pass. `t` is the enclosing test, and `call` calls a function of the page.
export async function shared(t, call) {
  for (const extra of EXTRAS) {
    await t.test(`${JSON.stringify(extra)} acts, and at its neutral value only rounds half floats`, async () => {
      const [neutral, acting] = await call('extra', extra);
      assert.ok(neutral < 0.005 && acting > 0.005, `${neutral}, ${acting}`);
    });
  }

  for (const [method, sides] of [['exact', 8], ['exact', 6], ['layered', 6]]) {
    const what = `${method}, ${sides} sides`;
    await t.test(`${what}: alpha is blurred as colour is; over the page it is as if the page were in the scene`, async () => {
      const { shares, inside, off } = await call('alpha', { method, sides });
      for (const index of [0, 1]) assertNear(shares[index], index, 1e-3, 'share');
      assert.ok(inside > 300, `${inside}`);
      // exact spreads bright pixels by their own circle of confusion, but the light of the page, which would make its
      // pixels bright, is added only later
      if (method !== 'exact') assert.ok(off < 0.01, `${off}`);
    });
  }

  await t.test('glass: sharp over the picture, not behind the subject; scene and camera stay', async () => {
    for (const { found, background, mask } of await call('glass')) {
      for (const name of ['behind', 'beside']) assert.deepEqual(found[name].at(-1), found[name][0], name);
      const [[red, green, blue], after] = [found.glass[0], found.glass.at(-1)];
      [0.5 * red, 0.5 * green + 0.5, 0.5 * blue].forEach((wanted, i) => assertNear(after[i], wanted, 2e-3, 'glass'));
      assert.ok(background);
      assert.equal(mask, 1);
    }
  });
}
