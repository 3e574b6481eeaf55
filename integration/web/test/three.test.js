// Tests the classes for WebGLRenderer with the newest and the oldest three.js, with the page pages/webgl.js.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { CHANGES, VERSIONS, assertNear, openedWith, shared } from './three.js';

const REFUSED = [
  [{ preset: 'high' }, 'preset is "high". Use one of "MEDIUM", "MOBILE", "LOW", "HIGH", "ULTRA"'],
  [{ sides: 5 }, 'sides is 5. Use one of 6, 4, 8, 10'],
  [{ sides: 12 }, 'sides is 12. Use one of 6, 4, 8, 10'],
  [{ method: 'foo' }, 'method is "foo". Use one of "layered", "exact", "paper"'],
  [{ method: 'paper', sides: 4 }, 'paper cannot draw 4 sides. Use one of 6, 8'],
  [{ side: 6 }, 'there is no option side. Use one of "method", "sides"'],
  [{ opaque: 1 }, 'opaque is 1. Use one of true, false'],
  [{ extras: 'jitter' }, 'extras must be a list, not "jitter". Use one of "jitter", "catsEye"'],
  [{ extras: ['cats'] }, 'extras is "cats". Use one of "jitter", "catsEye"'],
];
// [old focus distance, dt, depths]
const PULLS = [
  [NaN, 0.1, [4]],
  [0, 0.1, [4]],
  [-1, 0.1, [4]],
  [Infinity, Infinity, [4]],
  [2, Infinity, [NaN, 3, 0, -1]],
  [2, 0.1, []],
  [2, NaN, [4]],
];

for (const version of VERSIONS) {
  test(version, async (t) => {
    const { call, close } = await openedWith(version, 'webgl');
    t.after(close);

    await t.test('what no option can be is told in one line, with what it can be', async () => {
      for (const [options, said] of REFUSED) {
        const found = await call('refused', options);
        assert.ok(found?.includes(`polygonal-bokeh, PolygonBokehPass: ${said}`), `${said}: ${found}`);
      }
      assert.match(await call('stops'), /f-stop is 0/);
    });

    await t.test('a bokehScale of 0 draws no pass, but the copy that a screen needs, and is the scene', async () => {
      const { acts, ...found } = await call('unblurred');
      assert.deepEqual(found, { off: 0, inChain: 0, onScreen: 1, again: 0 });
      assert.ok(acts > 0);
    });

    await t.test('depth: none is said once and nothing blurs; empty is said; right: not a word; depthOf', async () => {
      const { none, empty, right } = await call('warned');
      assert.deepEqual([none, empty, right].map(({ said }) => said.length), [1, 1, 0]);
      assert.match(none.said[0], /no depth/);
      assert.match(empty.said[0], /depth is empty/);
      assert.equal(none.off, 0);
      assert.ok(right.off > 0);
      assert.deepEqual(await call('between'), [0, 0]); // depthOf works with passes between the scene and the bokeh
    });

    await t.test('the sample with glass: an edge behind it stays sharp, which its own depth would blur', async () => {
      const { call, close } = await openedWith(version, 'glass');
      t.after(close);
      const { weighted, plain } = await call('steps');
      assert.ok(weighted > 2 * plain, `${weighted}, ${plain}`);
    });

    for (const orthographic of [false, true]) {
      const view = orthographic ? 'an orthographic' : 'a perspective';
      await t.test(`depth weighted by opacity, of ${view} camera; the scene stays as it is, nothing is left`, async () => {
        const { metres, wanted, same, freed } = await call('weighted', orthographic);
        // red and green are half floats, and each surface rounds them once, by up to 2^-11
        for (const found of metres) found.forEach((value, i) => assertNear(value, wanted[i], 2 ** -9 * wanted[i], `place ${i}:`));
        assert.ok(same);
        assert.ok(freed > 0);
      });
    }

    await t.test('focus on a nested object, from a camera in a scaled rig: the depth that is drawn', async () => {
      const { focus, drawn, place } = await call('focus');
      for (const other of [focus, place]) assertNear(other, drawn, 1e-4 * drawn, 'focus');
      const wanted = Number(await call('revision')) < 180 ? 50 : 5;
      assertNear(focus, wanted, 1e-4 * wanted, 'focus');
    });

    await t.test('pullFocus recovers from a NaN and a 0, and takes no step to what is no depth', async () => {
      assert.deepEqual(await call('pulls', PULLS), [4, 4, 4, 4, 3, 2, 2]);
      assert.deepEqual(await call('pulls', [[2, Infinity, [Infinity]]]), [Infinity]);
    });

    for (const change of CHANGES) {
      await t.test(`${JSON.stringify(change)}: as from the beginning, compiled before, nothing left behind`, async () => {
        assert.deepEqual(await call('changed', change), { off: 0, added: 0, leaked: 0 });
      });
    }

    await t.test('of changes at once the last counts; a refused one rejects, and changes nothing', async () => {
      const { sides, preset, error } = await call('raced');
      assert.deepEqual([sides, preset], [4, 'MEDIUM']);
      assert.ok(error.includes('preset is "low"'), error);
    });

    await t.test('another camera, of another kind', async () => {
      assert.equal(await call('camera'), 0);
    });

    await t.test('memory of exact: map and two targets, RGBA16F; the result is the composer\'s', async () => {
      assert.deepEqual(await call('memory'), { bytes: 3 * 8 * 96 * 64, passes: 3 });
    });

    await t.test('four samples a pixel: the subject as sharp, and as much light', async () => {
      const { middle, kept } = await call('samples');
      assert.ok(middle < 0.002, `${middle}`);
      assertNear(kept[0], kept[1], 0.01, 'light');
    });

    await shared(t, call);
  });
}
