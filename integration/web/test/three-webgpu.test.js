// Tests the class for WebGPURenderer with the newest and the oldest three.js, with the page pages/webgpu.js.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { CHANGES, VERSIONS, assertNear, openedWith, shared } from './three.js';

for (const version of VERSIONS) {
  test(version, async (t) => {
    const { call, close } = await openedWith(version, 'webgpu');
    t.after(close);

    await t.test('errors are told to the caller, which three.js only logs', async () => {
      assert.ok((await call('refused', { preset: 'high' })).includes('PolygonBokehNode: preset is "high"'));
      assert.match(await call('logarithmic'), /cannot read logarithmicDepthBuffer/);
    });

    await t.test('on WebGL 2 it shows the scene as it is, and says so once', async () => {
      const { warnings, off, light } = await call('fallback');
      const own = warnings.filter((text) => text.includes('polygonal-bokeh'));
      assert.equal(own.length, 1);
      assert.match(own[0], /nothing is blurred.*fell back to WebGL 2/);
      assert.equal(off, 0);
      assert.ok(light > 0);
    });

    await t.test('a bokehScale of 0 draws a copy instead of all passes, and shows the scene', async () => {
      const { fewer, passes, acts, ...found } = await call('unblurred');
      assert.equal(fewer, passes - 1);
      assert.deepEqual(found, { off: 0, again: 0 });
      assert.ok(acts > 0);
    });

    for (const change of CHANGES) {
      await t.test(`${JSON.stringify(change)}: as from the beginning, and the next frame makes no pipeline`, async () => {
        const { off, added, acts } = await call('changed', change);
        assert.deepEqual([off, added], [0, 0]);
        assert.ok(acts > 0);
      });
    }

    await t.test('frames while shaders are compiled are as before, on the canvas too', async () => {
      const { off, count } = await call('between', { sides: 4 });
      assert.equal(off, 0);
      assert.ok(count > 2, `${count}`);
    });

    await t.test('it follows the camera of its scene\'s pass', async () => {
      assert.deepEqual(await call('camera'), { off: 0, kind: 5, far: 40 });
    });

    await t.test('(color, depth, camera): as the node of the pass; scales with its light; another camera', async () => {
      const { same, half, kind, far } = await call('nodes');
      assert.deepEqual([same, kind, far], [0, 5, 40]);
      assert.ok(half < 2e-3, `${half}`);
    });

    for (const by of ['ambient occlusion', 'ssgi']) {
      await t.test(`${by} before it: as of a texture with the same pixels; follows a resize`, async (t) => {
        const found = await call('occlusion', by);
        if (!found) return t.skip('this three.js has no SSGINode');
        assert.equal(found.baked, 0);
        assert.ok(found.acts > 0.01, `${found.acts}`);
        // three.js 0.172 draws an expression into a texture that keeps its first size
        if (found.revision >= 180) assert.deepEqual(found.resized, [48, 32]);
      });
    }

    await t.test('bloom after it leaves the bokeh as it is', async () => {
      assert.deepEqual(await call('bloom'), { off: 0 });
    });

    await t.test('temporal anti-aliasing before it: the subject as sharp, and as much light', async (t) => {
      const found = await call('traa');
      if (!found) return t.skip('this three.js has no TRAANode');
      assert.ok(found.middle < 2e-3, `${found.middle}`);
      assertNear(found.light, 1, 0.02, 'light');
    });

    await t.test('arguments that are none are told in the constructor', async () => {
      const said = await call('wrongNodes');
      for (const text of said.slice(0, 4)) assert.match(text, /takes \(scenePass, options\), or \(color, depth, camera, options\)/);
      assert.match(said[4], /sharpLayer needs the arguments \(scenePass, options\)/);
    });

    await t.test('memory of exact: map, two targets and the result', async () => {
      assert.deepEqual(await call('memory'), { bytes: 4 * 8 * 96 * 64, passes: 3 });
    });

    // the scene of this page has no highlights: four samples would change the light at their edges
    await t.test('four samples a pixel: the subject as sharp, and as much light', async () => {
      const { middle, light } = await call('samples');
      assert.ok(middle < 0.002, `${middle}`);
      assertNear(light, 1, 0.02, 'light');
    });

    await shared(t, call);
  });
}
