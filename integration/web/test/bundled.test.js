// The installed package through bundlers: no warning, and a page without an import map draws the picture of its guide.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { INTEGRATION, opened, started } from './opened.js';
import { SAMPLES, bundled, folder, madeIn } from './project.js';

// Sample -> statements that draw a frame of it, after its imports
const ENTRIES = {
  threejs: `import { renderer, composer } from './webgl.js';
const canvas = renderer.domElement, draw = () => composer.render();`,
  postprocessing: `import { renderer, composer } from './postprocessing.js';
const canvas = renderer.domElement, draw = () => composer.render();`,
  react: `import './react.jsx';
let canvas;
const draw = async () => {
  // until something is mounted, and drawn alike five times
  const blank = Object.assign(document.createElement('canvas'), { width: 640, height: 480 }).toDataURL();
  for (let seen, equal = 0; equal < 5; ) {
    await new Promise(requestAnimationFrame);
    canvas = document.querySelector('div canvas');
    const now = canvas?.toDataURL();
    equal = now && now !== blank && now === seen ? equal + 1 : 0;
    seen = now;
  }
};`,
  babylonjs: `import { sample } from './webgl.js';
const canvas = sample.engine.getRenderingCanvas(), draw = () => sample.scene.render();
await sample.scene.whenReadyAsync();`,
  playcanvas: `import { app } from './sample.js';
const canvas = app.graphicsDevice.canvas, draw = () => { app.renderNextFrame = true; app.tick(performance.now()); };`,
};
const CASES = [
  ...['esbuild', 'vite', 'webpack'].map((bundler) => [bundler, 'threejs']),
  ...['postprocessing', 'react', 'babylonjs', 'playcanvas'].map((sample) => ['esbuild', sample]),
];
// A warning counts as an error does; but react-three-fiber uses what three.js warns of
const pageOf = (sample) => `<!doctype html>
${sample === 'react' ? '' : '<script>console.warn = console.error;</script>'}
<canvas width="640" height="480" data-device="webgl2"></canvas>
<script type="module" src="main.js"></script>`;

let root, project, browser;

before(async () => {
  root = folder();
  project = await madeIn(root.path);
  browser = await started();
});

after(async () => {
  await browser?.close();
  root?.remove();
});

// In a page: the sizes of two pictures, by their addresses, and how far apart they are on average, of 255
async function apart([...addresses]) {
  const [a, b] = await Promise.all(
    addresses.map(async (address) => {
      const blob = await (await fetch(address)).blob();
      const image = await createImageBitmap(blob, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
      const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height);
    }),
  );
  const colors = Array.from(a.data.keys()).filter((i) => i % 4 < 3);
  return {
    sizes: [a, b].map(({ width, height }) => [width, height]),
    opaque: [a, b].every(({ data }) => data.every((value, i) => i % 4 < 3 || value === 255)),
    off: colors.reduce((sum, i) => sum + Math.abs(a.data[i] - b.data[i]), 0) / colors.length,
  };
}

for (const [bundler, sample] of CASES) {
  test(`${sample} by ${bundler}`, async () => {
    const engine = SAMPLES.includes(sample) ? sample : 'threejs';
    const [entry, out] = [`${engine}/${bundler}-${sample}.js`, `out-${bundler}-${sample}`];
    const picture = 'async () => { await draw(); return canvas.toDataURL(); }';
    writeFileSync(join(project, entry), `${ENTRIES[sample]}\nwindow.bokeh = { picture: ${picture} };\n`);
    const said = await bundled(project, bundler, entry, out);
    assert.doesNotMatch(said, /warn/i);
    // of the shaders there is one language where the engine has one
    const text = readFileSync(join(project, out, 'main.js'), 'utf8');
    assert.ok(text.includes('vec4 BokehFetchTexel'));
    assert.equal(text.includes('fn BokehFetchTexel'), engine !== 'threejs');

    const shown = join(INTEGRATION, engine, 'picture.png');
    const places = [['page.html', Buffer.from(pageOf(sample))], ['guide.png', readFileSync(shown)], ['', join(project, out)]];
    const session = await opened(places, [], browser);
    try {
      const drawn = await session.call('picture');
      // but for rounding: half a step on average
      const { sizes, opaque, off } = await session.page.evaluate(apart, [drawn, 'guide.png']);
      assert.deepEqual(sizes[0], sizes[1]);
      assert.ok(opaque, 'a canvas keeps the colours of opaque pixels alone as they are');
      assert.ok(off < 0.5, `${off} of 255 off on average`);
    } finally {
      await session.close();
    }
  });
}
