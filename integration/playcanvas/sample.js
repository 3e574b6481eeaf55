// The sample, for WebGL 2 and WebGPU: the canvas of the page says which.

import { AppBase, AppOptions, CameraComponentSystem, createGraphicsDevice } from 'playcanvas';
import { LightComponentSystem, Picker, RenderComponentSystem, TONEMAP_ACES } from 'playcanvas';
import { PolygonBokehFrame } from 'polygonal-bokeh/playcanvas';
import { makeScene } from './scene.js'; // yours

const canvas = document.querySelector('canvas');
const options = new AppOptions();
options.graphicsDevice = await createGraphicsDevice(canvas, { deviceTypes: [canvas.dataset.device], antialias: false });
options.componentSystems = [CameraComponentSystem, LightComponentSystem, RenderComponentSystem];
export const app = new AppBase(canvas);
app.init(options);
app.autoRender = false; // nothing moves: a frame is drawn when it is asked for
app.start();

// The camera component with depth of field. `options` are those of PolygonBokehFrame.
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

// Depths under points of the view, from the upper left, 0 to 1; Infinity where nothing is
const picker = new Picker(app, canvas.width, canvas.height, true);
export async function depthsUnder(points) {
  const depths = [];
  picker.prepare(camera, app.scene);
  for (const [x, y] of points) {
    const point = await picker.getWorldPointAsync(x * picker.width, y * picker.height);
    depths.push(point ? -camera.viewMatrix.transformPoint(point).z : Infinity);
  }
  return depths;
}

// A click focuses on what is there, on the nearest of some points around it, within five time constants; a drag does not.
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

// Keys 0 to 3 choose the debug view.
addEventListener('keydown', ({ key }) => {
  if ('0123'.includes(key)) frame.debugMode = Number(key);
  app.renderNextFrame = true;
});
