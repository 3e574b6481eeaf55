// The sample for both engines of Babylon.js: WebGL 2 (Engine) and WebGPU (WebGPUEngine).

import { Constants } from '@babylonjs/core/Engines/constants.js';
import { ImageProcessingConfiguration } from '@babylonjs/core/Materials/imageProcessingConfiguration.js';
import { ImageProcessingPostProcess } from '@babylonjs/core/PostProcesses/imageProcessingPostProcess.js';
import { PolygonBokeh } from 'polygonal-bokeh/babylon';
import { makeScene } from './scene.js'; // replace it with your own scene

// Adds depth of field to a camera. `options` are passed to PolygonBokeh.
export function addBokeh(camera, options) {
  const bokeh = new PolygonBokeh(camera, options);
  bokeh.setLens(1.4, 20); // f/1.4, with a blur 20 times as wide as a real lens's
  return bokeh;
}

// Adds tone mapping and sRGB as the last step. The scene is then drawn in linear colours, which may be brighter than 1
function addTone(camera) {
  const { imageProcessingConfiguration: tone } = camera.getScene();
  tone.toneMappingEnabled = true;
  tone.toneMappingType = ImageProcessingConfiguration.TONEMAPPING_ACES;
  const [bilinear, half] = [Constants.TEXTURE_BILINEAR_SAMPLINGMODE, Constants.TEXTURETYPE_HALF_FLOAT];
  return new ImageProcessingPostProcess('tone', 1, camera, bilinear, undefined, false, half);
}

// Starts the sample. `engine` is new Engine(canvas), or a WebGPUEngine after initAsync().
export function start(engine) {
  const { scene, camera, subject } = makeScene(engine);
  const sample = { engine, scene, camera, subject, bokeh: addBokeh(camera), tone: addTone(camera) };
  sample.bokeh.focusOn(subject.position);
  sample.aims = [sample.bokeh.uniforms.focusDistance]; // metres; the nearest of them gets into focus
  engine.runRenderLoop(() => {
    sample.bokeh.pullFocus(engine.getDeltaTime() / 1000, sample.aims);
    scene.render();
  });
  return sample;
}

// Returns the depths under points of the canvas (in pixels), and Infinity where there is no object.
export function depthsUnder(points, { scene, bokeh }) {
  return points.map((point) => {
    const { hit, pickedPoint } = scene.pick(...point);
    return hit ? bokeh.depthOf(pickedPoint) : Infinity;
  });
}

export function show(engine) {
  engine.setSize(640, 480);
  const sample = start(engine);
  const { scene, camera } = sample;

  // A click focuses on the nearest of the clicked point and four points around it; a drag does not.
  let pressed = [0, 0];
  scene.onPointerDown = () => (pressed = [scene.pointerX, scene.pointerY]);
  scene.onPointerUp = () => {
    const { pointerX: x, pointerY: y } = scene;
    if (Math.hypot(x - pressed[0], y - pressed[1]) > 5) return;
    sample.aims = depthsUnder([[x, y], [x - 6, y], [x + 6, y], [x, y - 6], [x, y + 6]], sample);
  };

  // Keys 1 to 3 show a debug view, and 0 shows the result.
  addEventListener('keydown', ({ key }) => {
    if (!'0123'.includes(key)) return;
    const { uniforms } = sample.bokeh;
    sample.bokeh.dispose();
    sample.bokeh = addBokeh(camera, { view: [undefined, 'depth', 'coc', 'focus'][key] });
    Object.assign(sample.bokeh.uniforms, uniforms);
  });
  return sample;
}
