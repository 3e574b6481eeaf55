// Tests the two components for react-three-fiber, with the page pages/react.jsx.

import assert from 'node:assert/strict';
import { cpSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { opened } from './opened.js';
import { WEB, bundled, folder, madeIn } from './project.js';
import { CANVAS } from './three.js';

let root, project, session;

before(async () => {
  root = folder();
  project = await madeIn(root.path);
  cpSync(join(WEB, 'test/pages'), join(project, 'pages'), { recursive: true });
  await bundled(project, 'esbuild', 'pages/react.jsx', 'out');
  await bundled(project, 'esbuild', 'threejs/react-webgpu.jsx', 'sample');
  const html = '<!doctype html><script type="module" src="main.js"></script>';
  session = await opened([['page.html', Buffer.from(html)], ['', join(project, 'out')]], CANVAS);
});

after(async () => {
  await session?.close();
  root?.remove();
});

// Shows the page with these settings. If the properties name no method, it uses exact: layered has four times as many
// shaders to compile, and these tests do not depend on the method.
const show = ({ props, ...settings }) => session.call('show', { ...settings, props: { method: 'exact', ...props } });

// Returns the image of a page, which must have no error.
async function picture(settings) {
  const { error, logged, image } = await show(settings);
  assert.deepEqual([error, logged], [null, []]);
  return image;
}

const off = (a, b) => Math.max(...a.map((value, i) => Math.abs(value - b[i])));

const LAYERED = { method: undefined };
const WRONG = [
  [{ squeze: 1 }, /there is no property squeze. The properties are method, .*squeeze/],
  [{ focusDistance: 3 }, /there is no property focusDistance. The properties are .*focus, /],
  [{ fStop: 0 }, /fStop is 0. It must be a number above 0/],
  [{ rotation: NaN }, /rotation is NaN/],
  [{ catsEye: 0.5 }, /catsEye needs extras=\{\['catsEye'\]\}/],
  [{ sides: 5 }, /sides is 5. Use one of 6, 4, 8, 10/],
];

for (const renderer of ['webgl', 'webgpu']) {
  test(`${renderer}: a property that was removed has its default again`, async () => {
    const plain = await picture({ renderer, anew: true });
    for (const props of [{ squeeze: 0.5 }, { fStop: 5.6 }, { sides: 4 }, { extras: ['catsEye'], catsEye: 0.9 }]) {
      assert.notEqual(off(await picture({ renderer, props }), plain), 0, JSON.stringify(props));
      assert.equal(off(await picture({ renderer }), plain), 0, JSON.stringify(props));
    }
    const layered = await picture({ renderer, props: LAYERED });
    assert.notEqual(off(layered, plain), 0);
    assert.equal(off(await picture({ renderer }), plain), 0);
    assert.equal(off(await picture({ renderer, props: LAYERED }), layered), 0);
  });

  test(`${renderer}: a camera of the other kind, as from the beginning`, async () => {
    const [perspective, orthographic] = [
      await picture({ renderer, anew: true }),
      await picture({ renderer, kind: 'orthographic', anew: true }),
    ];
    assert.notEqual(off(perspective, orthographic), 0);
    assert.equal(off(await picture({ renderer, kind: 'perspective' }), perspective), 0);
    assert.equal(off(await picture({ renderer, kind: 'orthographic' }), orthographic), 0);
  });

  for (const [index, [props, told]] of WRONG.entries()) {
    // react-common.js checks the properties for both renderers. So each property is wrong from the beginning with one
    // renderer, and becomes wrong later with the other.
    const later = (index + Number(renderer === 'webgpu')) % 2 === 1;
    test(`${renderer}: ${JSON.stringify(props)} ${later ? 'later' : 'at first'} is one error that says what is allowed`, async () => {
      if (later) await picture({ renderer, anew: true });
      const { error, logged } = await show({ renderer, props, anew: !later });
      assert.match(error ?? '', told);
      assert.ok(logged.length <= 2, logged.join('\n'));
    });
  }
}

test('webgpu: the picture of PolygonBokehNode', async () => {
  const shown = await picture({ renderer: 'webgpu', props: LAYERED, anew: true });
  assert.equal(off(shown, await session.call('byHand')), 0);
});

test('webgpu: nodes before it count', async () => {
  const whole = await picture({ renderer: 'webgpu', anew: true });
  const half = await picture({ renderer: 'webgpu', chain: 'half', anew: true });
  assert.ok(off(half.map((value, i) => (i % 4 < 3 ? 2 * value : value)), whole) < 2e-3);
});

test('webgpu: the canvas shows what `after` makes of it', async () => {
  const shown = [];
  for (const chain of [undefined, 'shown', undefined]) {
    await picture({ renderer: 'webgpu', chain, anew: true });
    shown.push((await session.page.screenshot({ clip: { x: 8, y: 8, width: 96, height: 64 } })).toString('base64'));
  }
  assert.notEqual(shown[0], shown[1]);
  assert.equal(shown[0], shown[2]);
});

// The page of the sample. It stops after 100 submits, so that it does not draw while the screenshot is taken.
const FEW = `<!doctype html><script type="module" src="main.js"></script>
<script>
  let submitted = 0;
  const { requestAnimationFrame } = window;
  const { submit } = GPUQueue.prototype;
  GPUQueue.prototype.submit = function (...given) {
    submitted += 1;
    return submit.apply(this, given);
  };
  window.requestAnimationFrame = (call) => (submitted < 100 ? requestAnimationFrame(call) : 0);
  window.bokeh = { ended: async () => {
    while (submitted < 100) await new Promise((go) => requestAnimationFrame(go));
  } };
</script>`;

test('webgpu: the sample shows a picture, and writes no error', async () => {
  const sample = await opened([['page.html', Buffer.from(FEW)], ['', join(project, 'sample')]], CANVAS);
  try {
    await sample.call('ended');
    const shown = await sample.page.screenshot();
    assert.ok(shown.length > 100_000, `a PNG of ${shown.length} bytes: nothing in it`);
    await sample.call('valueOf'); // throws what was written to the console
  } finally {
    await sample.close();
  }
});

test('webgpu: with WebGLRenderer one error names the other import', async () => {
  const { error } = await show({ renderer: 'webgl', component: 'webgpu', anew: true });
  assert.match(error ?? '', /needs WebGPURenderer.*polygonal-bokeh\/react/);
});
