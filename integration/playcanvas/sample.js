// The sample for WebGL 2 and WebGPU. The attribute data-device of the page's canvas selects one of them.

import { AppBase, AppOptions, CameraComponentSystem, createGraphicsDevice } from 'playcanvas';
import { LightComponentSystem, RenderComponentSystem, TONEMAP_ACES } from 'playcanvas';
import { PolygonBokehFrame } from 'polygonal-bokeh/playcanvas';
import { makeScene } from './scene.js'; // replace it with your own scene

const canvas = document.querySelector('canvas');
const options = new AppOptions();
options.graphicsDevice = await createGraphicsDevice(canvas, { deviceTypes: [canvas.dataset.device], antialias: false });
options.componentSystems = [CameraComponentSystem, LightComponentSystem, RenderComponentSystem];
export const app = new AppBase(canvas);
app.init(options);
app.autoRender = false; // nothing moves, so the app only draws frames on request
app.start();

// Adds depth of field to a camera component. `options` are passed to PolygonBokehFrame.
export function addBokeh(app, camera, options) {
  const frame = new PolygonBokehFrame(app, camera, options);
  frame.setLens(1.4, 20); // f/1.4, with a blur 20 times as wide as a real lens's
  frame.rendering.toneMapping = TONEMAP_ACES; // tone mapping and sRGB encoding come after the bokeh
  frame.update();
  return frame;
}

export const { camera, subject, box } = makeScene(app);
export const frame = addBokeh(app, camera);
frame.focusOn(subject.getPosition());
app.renderNextFrame = true;

import { Picker } from 'playcanvas';
const picker = new Picker(app, canvas.width, canvas.height, true);

// Returns the depths under points of the view, and Infinity where there is no object. The points go from (0, 0) at the
// upper left to (1, 1) at the lower right.
export async function depthsUnder(points) {
  const depths = [];
  picker.prepare(camera, app.scene);
  for (const [x, y] of points) {
    const point = await picker.getWorldPointAsync(x * picker.width, y * picker.height);
    depths.push(point ? -camera.viewMatrix.transformPoint(point).z : Infinity);
  }
  return depths;
}

// A click focuses on the nearest of the clicked point and four points around it; a drag does not. The focus reaches it
// after 1 s, five time constants.
let [aims, left, pressed] = [[], 0, null];
canvas.addEventListener('pointerdown', ({ clientX, clientY }) => (pressed = [clientX, clientY]));
canvas.addEventListener('click', async ({ offsetX, offsetY, clientX, clientY }) => {
  if (pressed && Math.hypot(clientX - pressed[0], clientY - pressed[1]) > 5) return;
  const [x, y, d] = [offsetX / canvas.clientWidth, offsetY / canvas.clientHeight, 0.01];
  aims = await depthsUnder([[x, y], [x - d, y], [x + d, y], [x, y - d], [x, y + d]]);
  left = 1;
});
app.on('update', (dt) => {
  if (left <= 0) return;
  left -= dt;
  frame.pullFocus(left > 0 ? dt : Infinity, aims);
  app.renderNextFrame = true;
});

// Keys 1 to 3 show a debug view, and 0 shows the result.
addEventListener('keydown', ({ key }) => {
  if ('0123'.includes(key)) frame.debugMode = Number(key);
  app.renderNextFrame = true;
});
