// Bundles the installed package. The bundler must not warn, and a page without an import map must draw the image of its
// guide.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { INTEGRATION, opened, started } from './opened.js';
import { SAMPLES, bundled, folder, madeIn } from './project.js';

// Sample -> a module that imports the sample, and defines its canvas and a function that draws a frame
const ENTRIES = {
  threejs: `import { renderer, composer } from './webgl.js';
const canvas = renderer.domElement, draw = () => composer.render();`,
  postprocessing: `import { renderer, composer } from './postprocessing.js';
const canvas = renderer.domElement, draw = () => composer.render();`,
  react: `import './react.jsx';
let canvas;
const draw = async () => {
  // until something is mounted, and five frames are equal
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
// Warnings become errors, except for react-three-fiber, because three.js warns of features that it uses
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

// Runs in a page, with the addresses of two images. Returns their sizes, whether both are opaque, and how much they
// differ on average, for values from 0 to 255.
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
    // with three.js, the bundle has only the shaders in GLSL: the classes for WebGLRenderer need none in WGSL
    const text = readFileSync(join(project, out, 'main.js'), 'utf8');
    assert.ok(text.includes('vec4 BokehFetchTexel'));
    assert.equal(text.includes('fn BokehFetchTexel'), engine !== 'threejs');

    const shown = join(INTEGRATION, engine, 'picture.png');
    const places = [['page.html', Buffer.from(pageOf(sample))], ['guide.png', readFileSync(shown)], ['', join(project, out)]];
    const session = await opened(places, [], browser);
    try {
      const drawn = await session.call('picture');
      // because of rounding, they may differ by half a level on average
      const { sizes, opaque, off } = await session.page.evaluate(apart, [drawn, 'guide.png']);
      assert.deepEqual(sizes[0], sizes[1]);
      assert.ok(opaque, 'a canvas keeps the colours of opaque pixels alone as they are');
      assert.ok(off < 0.5, `${off} of 255 off on average`);
    } finally {
      await session.close();
    }
  });
}
