// For the validation suite only: draws every method and polygon, and returns their inputs and results as raw pixels.

import { BoundingBox, Entity, FILLMODE_NONE, FloatPacking, GSplatComponentSystem } from 'playcanvas';
import { GSplatContainer, GSplatFormat } from 'playcanvas';
import { PROJECTION_ORTHOGRAPHIC, PROJECTION_PERSPECTIVE } from 'playcanvas';
import { RESOLUTION_FIXED, SSAOTYPE_LIGHTING, Vec3, version } from 'playcanvas';
import { addBokeh, app, box, camera, depthsUnder, frame as first, subject } from './sample.js';
import { addShot, base64, cameraOf, HEIGHT, ODD_SIZE, pulledTo } from '../web/test/captures.js';
import { SHAPES, shotsOf, SIZE, sizeOf, uniformsOf, viewsOf, WIDTH } from '../web/test/captures.js';

// Draws a frame with a new PolygonBokehFrame, which the next call destroys. change(frame) is called before it is drawn.
let last = first;
async function draw(options, [width, height], change = () => {}) {
  last.destroy();
  app.setCanvasFillMode(FILLMODE_NONE, width, height);
  app.setCanvasResolution(RESOLUTION_FIXED, width, height);
  last = addBokeh(app, camera, options);
  last.focusOn(subject.getPosition());
  change(last);
  last.update();
  await drawn();
  return last;
}

// Resolves after the next frame.
function drawn() {
  app.renderNextFrame = true;
  return new Promise((done) => app.once('frameend', done));
}

const pixels = (texture) => texture.read(0, 0, texture.width, texture.height, { immediate: true });

// Returns the pixels of a frame, beginning with the first row in memory.
async function read({ renderPassCamera: { bokeh } }) {
  const { color, depth, result } = bokeh.textures;
  return { color: await pixels(color), depth: await pixels(depth), result: await pixels(result) };
}

// Returns the depth of a frame in metres. (The scene pass writes 1 / metres.)
async function metresOf(frame) {
  const { depth } = await read(frame);
  return frame.renderPassCamera.sceneDepthTexture ? depth.map((value) => 1 / value) : depth;
}

// Returns the pixels that the passes wrote, in the order of docs/reference/passes.md.
async function written({ renderPassCamera: { bokeh } }) {
  const found = [];
  for (const { _colorBuffers } of bokeh.targets) for (const texture of _colorBuffers) found.push(await pixels(texture));
  return new Uint8Array(await new Blob(found).arrayBuffer());
}

// Returns { data: the content of capture.json, files: name -> base64 }.
export async function capture() {
  const { gl, wgpu, canvas } = app.graphicsDevice;
  const device = gl ? gl.getParameter(names(gl).UNMASKED_RENDERER_WEBGL) : adapter(wgpu);
  const engine = `PlayCanvas ${version}, ${gl ? 'WebGL 2' : 'WebGPU'}`;
  const data = { engine, device, width: SIZE[0], height: SIZE[1], shots: [] };
  await draw({}, [2 * WIDTH, 2 * HEIGHT]);
  app.renderNextFrame = true;
  const picture = await new Promise((done) => app.once('frameend', () => canvas.toBlob(done)));
  const files = { 'picture.png': base64(await picture.bytes()) };
  for (const shot of shotsOf(Object.keys(SHAPES))) {
    const { method, aperture } = shot;
    const change = ({ uniforms }) => Object.assign(uniforms, uniformsOf(shot));
    const frame = await draw({ method, sides: SHAPES[method][aperture], opaque: false }, sizeOf(shot), change);
    const targets = method !== 'paper' && (await written(frame));
    addShot({ data, files }, shot, settings(method, frame), await read(frame), targets);
  }
  data.pull = await pulled(Boolean(gl));
  return { data, files };
}

// Runs the autofocus frame by frame, on a point of the floor and a point of the wall. Returns its inputs and the focus
// distances.
async function pulled(bottomUp) {
  const points = [[0.951, 0.656], [0.595, 0.464]];
  const depths = await depthsUnder(points);
  const shown = points.map(([x, y]) => [x, bottomUp ? 1 - y : y]);
  return pulledTo(last, () => last.uniforms.focusDistance, shown, depths);
}

const names = (gl) => gl.getExtension('WEBGL_debug_renderer_info');
const adapter = ({ adapterInfo: { vendor, architecture, description } }) =>
  [vendor, architecture, description].filter(Boolean).join(' ');

// Returns the settings as the shaders got them, in float32.
function settings(method, { uniforms, renderPassCamera: { sceneDepthTexture } }) {
  return {
    // the reference has no presets for paper: give it the samples and the spacing of MEDIUM
    ...(method === 'paper' && { samples: 9, spacing: 1.5 }),
    ...(sceneDepthTexture && { stored: { kind: 3, near: 1, far: 0 } }),
    camera: cameraOf((name) => uniforms[name]),
  };
}

// For a bokehScale of 0, returns how many passes are drawn, whether later passes read the scene, and whether the blur
// comes back afterwards.
export async function unblurred() {
  const frame = await draw({}, ODD_SIZE, (made) => made.setLens(2.8, 0));
  const { bokeh, composePass } = frame.renderPassCamera;
  const drawing = () => [...bokeh.passes, ...bokeh.views].filter(({ enabled }) => enabled).length;
  const found = { drawing: drawing(), isScene: composePass.sceneTexture === bokeh.textures.color };
  frame.setLens(1.4, 20);
  await drawn();
  const comesBack = drawing() === bokeh.passes.length && composePass.sceneTexture === bokeh.textures.result;
  return { ...found, comesBack };
}

// Compares depths in the leftmost columns, which show only the floor and the wall. Returns [{ name, drawn: the depths
// in metres as the passes read them, met: the depths where rays hit the floor or the wall }].
export async function depths() {
  const found = [];
  for (const [name, projection] of Object.entries({ PROJECTION_PERSPECTIVE, PROJECTION_ORTHOGRAPHIC })) {
    Object.assign(camera, { projection, orthoHeight: 1.2 });
    const depth = await metresOf(await draw({}, [WIDTH, HEIGHT]));
    const [drawn, met] = [[], []];
    for (let row = 0; row < HEIGHT; row++) {
      for (let x = 0; x < WIDTH / 10; x++) {
        drawn.push(depth[row * WIDTH + x]);
        met.push(meets(x + 0.5, (app.graphicsDevice.isWebGPU ? row : HEIGHT - 1 - row) + 0.5));
      }
    }
    found.push({ name, drawn, met });
  }
  camera.projection = PROJECTION_PERSPECTIVE;
  return found;
}

function meets(x, y) {
  const start = camera.screenToWorld(x, y, 1);
  const along = camera.screenToWorld(x, y, 2).sub(start);
  const floor = along.y < 0 ? -start.y / along.y : Infinity;
  const there = along.mulScalar(Math.min(floor, (-16 - start.z) / along.z)).add(start);
  return -camera.viewMatrix.transformPoint(there).z;
}

// Draws the debug views, for viewsOf.
export function views() {
  return viewsOf(async (mode) => {
    const frame = await draw({ opaque: false }, [WIDTH, HEIGHT], (changed) => (changed.debugMode = mode));
    const { focusDistance, maxCoC } = frame.uniforms;
    return { result: (await read(frame)).result, depth: await metresOf(frame), focus: focusDistance, maxCoC };
  });
}

// Other effects of the camera frame, which effects() turns on one at a time
const EFFECTS = {
  none: () => {},
  bloom: ({ bloom }) => (bloom.intensity = 0.02),
  ssao: ({ ssao }) => (ssao.type = SSAOTYPE_LIGHTING),
  taa: ({ taa }) => (taa.enabled = true),
  samples: ({ rendering }) => (rendering.samples = 4),
  scale: ({ rendering }) => (rendering.renderTargetScale = 0.5),
};
// Draws the bokeh together with each effect. Returns { effect: { size, result: rgba, blooms: whether bloom reads the
// result, prepass: whether there is a prepass } }.
export async function effects() {
  const found = {};
  for (const [effect, change] of Object.entries(EFFECTS)) {
    const frame = await draw({}, [WIDTH, HEIGHT], change);
    for (let i = 0; i < 8; i++) await drawn(); // TAA needs several frames
    const { bokeh, scenePassHalf } = frame.renderPassCamera;
    const { result } = bokeh.textures;
    const blooms = scenePassHalf?.sourceTexture === result;
    const { prePass } = frame.renderPassCamera;
    const shown = { size: [result.height, result.width], result: base64(await pixels(result)) };
    found[effect] = { ...shown, blooms, prepass: Boolean(prePass) };
  }
  return found;
}

const SPLATS = [32, 24, 2.5]; // columns, rows, distance from the camera in metres

// Adds a wall of Gaussian splats in front of the camera, and returns its entity.
function addSplats() {
  const [columns, rows, distance] = SPLATS;
  const count = columns * rows;
  if (!app.systems.gsplat) app.systems.add(new GSplatComponentSystem(app));
  const device = app.graphicsDevice;
  const container = new GSplatContainer(device, count, GSplatFormat.createSimpleFormat(device));
  const [centers, colors] = ['dataCenter', 'dataColor'].map((name) => container.getTexture(name));
  const [places, shades] = [centers.lock(), colors.lock()];
  for (let i = 0; i < count; i++) {
    const [x, y] = [((i % columns) - columns / 2) * 0.06, (Math.floor(i / columns) - rows / 2) * 0.06];
    places.set([x, y, -distance, 0.05], 4 * i);
    shades.set([0.9, 0.5, 0.2, 1].map((value) => FloatPacking.float2Half(value)), 4 * i);
    container.centers.set([x, y, -distance], 3 * i);
  }
  centers.unlock();
  colors.unlock();
  container.aabb = new BoundingBox(new Vec3(0, 0, -distance), new Vec3(1, 1, 0.1));
  container.update();
  const entity = new Entity();
  entity.addComponent('gsplat', { resource: container });
  camera.entity.addChild(entity);
  return entity;
}

// Tests splats, which a prepass does not draw. Returns the depth in metres in the middle of the image (found) without
// them, with them, and with them while they write depth; and the distance of the splats.
export async function splats() {
  const found = [];
  const look = async () => {
    const frame = await draw({}, [WIDTH, HEIGHT]);
    // PlayCanvas sorts the splats while it draws frames, so draw some
    for (let i = 0; i < 20; i++) {
      await new Promise((done) => setTimeout(done, 20));
      await drawn();
    }
    found.push((await metresOf(frame))[(HEIGHT * WIDTH + WIDTH) / 2]);
  };
  await look();
  const entity = addSplats();
  const { gsplat } = app.scene;
  await look();
  gsplat.sceneDepthWrite = true;
  await look();
  gsplat.sceneDepthWrite = false;
  entity.destroy();
  return { found, distance: SPLATS[2] };
}

// Tests the sample's own keys and clicks. Returns the focus distance before, after a drag that ends on the box, and
// after a click on the box; the depth of the box; and the debug mode after a key was pressed.
export async function interaction() {
  await drawn();
  const { x, y } = camera.worldToScreen(box.getPosition());
  const { canvas } = app.graphicsDevice;
  const { left, top } = canvas.getBoundingClientRect();
  const before = first.uniforms.focusDistance;
  const pointer = (type, by) => canvas.dispatchEvent(new MouseEvent(type, { clientX: left + x + by, clientY: top + y }));
  pointer('pointerdown', 6);
  pointer('click', 0);
  app.renderNextFrame = true;
  for (let i = 0; i < 5; i++) await drawn();
  const dragged = first.uniforms.focusDistance;
  pointer('pointerdown', 4);
  pointer('click', 0);
  dispatchEvent(new KeyboardEvent('keydown', { key: '2' }));
  while (first.uniforms.focusDistance === before) await drawn();
  // until the focus stops moving
  for (let then; then !== first.uniforms.focusDistance; await drawn()) then = first.uniforms.focusDistance;
  const depth = -camera.viewMatrix.transformPoint(new Vec3().copy(box.getPosition())).z;
  return { before, dragged, after: first.uniforms.focusDistance, box: depth, mode: first.debugMode };
}

// Returns the pixels of a frame with these options and uniforms, or the error message.
export async function shown([, options, uniforms]) {
  try {
    const { result } = await read(await draw(options, [96, 72], (frame) => Object.assign(frame.uniforms, uniforms)));
    return base64(result);
  } catch ({ message }) {
    return message;
  }
}
