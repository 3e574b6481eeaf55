// For the validation suite only: draws every method and polygon, and returns their inputs and results as raw pixels.

import { AbstractEngine } from '@babylonjs/core/Engines/abstractEngine.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import '@babylonjs/core/Engines/Extensions/engine.readTexture.js';
import '@babylonjs/core/Engines/WebGPU/Extensions/engine.readTexture.js';
import { addGraph } from './frameGraph.js';
import { addBokeh, depthsUnder } from './sample.js';
import { addShot, base64, cameraOf, HEIGHT, ODD_SIZE, pulledTo } from '../web/test/captures.js';
import { SHAPES, shotsOf, SIZE, sizeOf, uniformsOf, viewsOf, WIDTH } from '../web/test/captures.js';

const METHODS = ['layered', 'exact']; // the default first

// Returns the sample, with its render loop stopped.
async function stopped(kind) {
  const { sample } = await import(`./${kind}.js`);
  sample.engine.stopRenderLoop();
  return sample;
}

function drawFrame(engine, scene) {
  engine.beginFrame();
  scene.render();
  engine.endFrame();
}

// Replaces the PolygonBokeh with one that has these options, and draws a frame.
async function draw(sample, options, [width, height], uniforms = {}) {
  const { engine, scene, subject } = sample;
  sample.bokeh.dispose();
  sample.bokeh = addBokeh(scene.activeCamera, options);
  sample.bokeh.focusOn(subject.position);
  Object.assign(sample.bokeh.uniforms, uniforms);
  engine.setSize(width, height);
  while (!scene.isReady()) {
    const errors = sample.bokeh.passes.map(({ wrapper }) => wrapper.effect.getCompilationError());
    if (errors.some(Boolean)) throw new Error(errors.join('\n'));
    await new Promise((done) => setTimeout(done, 10));
  }
  drawFrame(engine, scene);
}

// Returns the pixels of an internal texture of the engine, beginning with the first row in memory.
async function pixels(engine, texture, channels) {
  const { width, height } = texture;
  const bytes = await engine._readTexturePixels(texture, width, height, -1, 0, null, true, true); // WebGPU: as bytes
  const Type = channels === 1 ? Float32Array : Uint16Array;
  const read = new Type(bytes.buffer, bytes.byteOffset, bytes.byteLength / Type.BYTES_PER_ELEMENT);
  const stride = read.length / (width * height);
  return stride === channels ? read : read.filter((_, i) => i % stride < channels);
}

async function metres({ engine, scene, bokeh }) {
  const depth = await pixels(engine, bokeh.textures.depth.getInternalTexture(), 1);
  return scene.useRightHandedSystem ? depth.map((z) => -z) : depth;
}

async function readFrame(sample) {
  const { engine, bokeh, tone } = sample;
  return {
    color: await pixels(engine, bokeh.inputTexture.texture, 4),
    depth: await metres(sample),
    result: await pixels(engine, tone.inputTexture.texture, 4),
  };
}

// Returns the pixels that the passes wrote, one target after the other, in the order of docs/reference/passes.md.
async function readPasses({ engine, bokeh, tone }) {
  const textures = bokeh.passes.flatMap(({ target }) => target?.renderTarget.textures ?? tone.inputTexture.texture);
  const found = [];
  for (const texture of textures) found.push(await pixels(engine, texture, 4));
  return new Uint8Array(await new Blob(found).arrayBuffer());
}

// Returns { data: the content of capture.json, files: name -> base64 } for 'webgl' or 'webgpu'.
export async function capture(kind) {
  const sample = await stopped(kind);
  const { engine } = sample;
  const title = `Babylon.js ${AbstractEngine.Version}, ${engine.name}`;
  const data = { engine: title, device: engine.getInfo().renderer, width: SIZE[0], height: SIZE[1], shots: [] };
  await draw(sample, {}, [2 * WIDTH, 2 * HEIGHT]);
  const picture = await new Promise((done) => engine.getRenderingCanvas().toBlob(done));
  const files = { 'picture.png': base64(await picture.bytes()) };
  const found = { data, files };
  for (const shot of shotsOf(METHODS)) {
    const { method, aperture } = shot;
    await draw(sample, { method, sides: SHAPES[method][aperture], opaque: false }, sizeOf(shot), uniformsOf(shot));
    const written = method !== 'paper' && (await readPasses(sample));
    addShot(found, shot, settings(sample.bokeh.uniforms), await readFrame(sample), written);
  }
  data.pull = pulled(sample);
  await draw(sample, {}, [2 * WIDTH, 2 * HEIGHT]);
  files['frame-graph.png'] = base64((await drawnByGraph(sample, {})).picture);
  await draw(sample, {}, ODD_SIZE);
  const { shown, written, picture: _, ...arrays } = await drawnByGraph(sample, { opaque: false });
  addShot(found, { name: 'frame-graph', method: 'layered', aperture: 'hexagon' }, shown, arrays, written);
  return found;
}

// Draws a frame of the sample's scene with a frame graph. Returns its colour, depth and result, the output of all
// passes, the canvas as PNG (picture), and further values of the shot (shown).
async function drawnByGraph({ engine, scene, camera, subject }, options, bokehScale = 20) {
  const { imageProcessingConfiguration: processing } = scene;
  processing.applyByPostProcess = false; // as in a scene without post processes; the task only reacts to changes
  const { graph, bokeh } = await addGraph(scene, camera, options);
  graph.optimizeTextureAllocation = false; // otherwise, the graph reuses textures that are read below
  bokeh.focusOn(subject.position);
  bokeh.setLens(1.4, bokehScale);
  await graph.buildAsync();
  drawFrame(engine, scene);
  const canvas = await new Promise((done) => engine.getRenderingCanvas().toBlob(done));
  const read = (handle, channels) => pixels(engine, graph.textureManager.getTextureFromHandle(handle), channels);
  const written = [];
  for (const { writes } of bokeh.bokehPasses) for (const name of writes) written.push(await read(bokeh.handles[name], 4));
  const found = {
    written: new Uint8Array(await new Blob(written).arrayBuffer()),
    color: await read(bokeh.sourceTexture, 4),
    depth: await read(bokeh.depthTexture, 1),
    result: await read(bokeh.outputTexture, 4),
    picture: await canvas.bytes(),
    shown: { ...settings(bokeh.uniforms), stored: { kind: 1, near: Math.fround(camera.minZ), far: Math.fround(camera.maxZ) } },
  };
  scene.frameGraph = null;
  graph.dispose();
  processing.applyByPostProcess = true;
  scene.activeCamera = camera; // the graph has removed it
  return found;
}

// Runs the autofocus frame by frame, on a point of the floor and a point of the wall. Returns its inputs and the focus
// distances.
function pulled(sample) {
  const { bokeh } = sample;
  const points = [[152.5, 78.5], [95.5, 55.5]];
  const depths = depthsUnder(points, sample);
  // v = 0 is the lowest row
  const shown = points.map(([x, y]) => [x / SIZE[0], 1 - y / SIZE[1]]);
  return pulledTo(bokeh, () => bokeh.uniforms.focusDistance, shown, depths);
}

// Returns the settings as the shaders got them.
const settings = (uniforms) => ({ camera: cameraOf((name) => uniforms[name]) });

// Sets a bokehScale of 0. For the post process, returns how many passes are drawn, whether the result is the scene, and
// whether the blur comes back; for the task, whether its result is the scene.
export async function unblurred(kind) {
  const sample = await stopped(kind);
  const { engine, tone, scene, camera } = sample;
  await draw(sample, {}, ODD_SIZE);
  const color = await pixels(engine, sample.bokeh.inputTexture.texture, 4);
  const blurred = base64(await pixels(engine, tone.inputTexture.texture, 4));
  const { quad, uniforms, textures } = sample.bokeh;
  const { apertureDiameter } = uniforms;
  const { render } = quad;
  let drawing = 0;
  quad.render = (...given) => {
    drawing += 1;
    render.apply(quad, given);
  };
  const frame = async () => {
    drawFrame(engine, scene);
    return base64(await pixels(engine, tone.inputTexture.texture, 4));
  };
  sample.bokeh.setLens(2.8, 0);
  const isScene = (await frame()) === base64(color) && !camera.customRenderTargets.includes(textures.depth);
  const found = { drawing, isScene };
  uniforms.apertureDiameter = apertureDiameter;
  while (!scene.isReady()) await new Promise((done) => setTimeout(done, 10));
  await frame();
  const comesBack = (await frame()) === blurred && drawing > 0;
  const byTask = await drawnByGraph(sample, { opaque: false }, 0);
  return { ...found, comesBack, task: base64(byTask.result) === base64(byTask.color) };
}

// Compares depths at some pixels, for both kinds of cameras, and in a right-handed scene. Returns [{ name, drawn: the
// depths in metres as the passes read them, met: the depths where rays hit an object, or maxZ, nearer: whether the CoC
// map has the pixel in front of the focus, focus, maxZ }]. The wall is hidden, so that some rays hit nothing.
export async function depths(kind) {
  const sample = await stopped(kind);
  const { scene, camera } = sample;
  const [orthoLeft, orthoRight, orthoTop, orthoBottom] = [-3.2, 3.2, 2.4, -2.4];
  Object.assign(camera, { orthoLeft, orthoRight, orthoTop, orthoBottom });
  scene.getMeshByName('wall').setEnabled(false);
  // front and back faces swap in a right-handed scene
  for (const material of scene.materials) material.backFaceCulling = false;
  const found = [];
  for (const [name, mode, hand] of [['perspective', 0, false], ['orthographic', 1, false], ['right-handed', 0, true]]) {
    camera.mode = mode;
    scene.useRightHandedSystem = hand;
    await draw(sample, {}, [WIDTH, HEIGHT]);
    found.push({ name, maxZ: camera.maxZ, ...(await probed(sample)) });
  }
  return found;
}

async function probed(sample) {
  const { engine, scene, camera, bokeh } = sample;
  const depth = await metres(sample);
  const map = await pixels(engine, bokeh.textures.coc.getInternalTexture(), 4);
  const [drawn, met, nearer] = [[], [], []];
  for (let y = 5; y < HEIGHT; y += 10) {
    for (let x = 5; x < WIDTH; x += 10) {
      const place = (HEIGHT - 1 - y) * WIDTH + x;
      const { hit, pickedPoint } = scene.pick(x + 0.5, y + 0.5);
      drawn.push(depth[place]);
      nearer.push(map[4 * place + 3] > 0x8000); // the half float is negative
      met.push(hit ? Math.abs(Vector3.TransformCoordinates(pickedPoint, camera.getViewMatrix()).z) : camera.maxZ);
    }
  }
  return { drawn, met, nearer, focus: bokeh.uniforms.focusDistance };
}

// Draws the debug views, for viewsOf.
export async function views(kind) {
  const sample = await stopped(kind);
  return viewsOf(async (mode) => {
    await draw(sample, { view: [undefined, 'depth', 'coc', 'focus'][mode], opaque: false }, [WIDTH, HEIGHT]);
    const { focusDistance, maxCoC } = sample.bokeh.uniforms;
    return { ...(await readFrame(sample)), focus: focusDistance, maxCoC };
  });
}

// Tests the sample's own keys and clicks. Returns the focus distance before, after a drag that ends on the box, and
// after a click on the box; the depth of the box; and the passes after a key was pressed.
export async function interaction(kind) {
  const { sample } = await import(`./${kind}.js`);
  const { engine, scene, camera } = sample;
  const box = scene.getMeshByName('box');
  await scene.whenReadyAsync();
  const view = camera.getViewMatrix(true);
  const { x, y } = Vector3.TransformCoordinates(box.position, view.multiply(camera.getProjectionMatrix(true)));
  const canvas = engine.getRenderingCanvas();
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const place = { clientX: left + ((1 + x) / 2) * width, clientY: top + ((1 - y) / 2) * height };
  const before = sample.bokeh.uniforms.focusDistance;
  const pointer = (type, by) => {
    const init = { ...place, clientX: place.clientX + by, button: 0, pointerId: 1, bubbles: true };
    canvas.dispatchEvent(new PointerEvent(type, init));
  };
  const drawn = () => new Promise((done) => scene.onAfterRenderObservable.addOnce(done));
  pointer('pointerdown', 6);
  pointer('pointermove', 0);
  pointer('pointerup', 0);
  for (let i = 0; i < 3; i++) await drawn();
  const dragged = sample.bokeh.uniforms.focusDistance;
  pointer('pointerdown', 4);
  pointer('pointermove', 0);
  pointer('pointerup', 0);
  dispatchEvent(new KeyboardEvent('keydown', { key: '2' }));
  let [last, after] = [0, before];
  while (last !== after) {
    // until the focus moves by less than a tenth of a millimetre per frame
    await drawn();
    [last, after] = [after, Math.round(sample.bokeh.uniforms.focusDistance * 1e4) / 1e4];
  }
  const depth = Vector3.TransformCoordinates(box.position, view).z;
  return { before, dragged, after, box: depth, passes: sample.bokeh.passes.map(({ call }) => call) };
}

// Returns the pixels of a frame with these options and uniforms, or the error message.
export async function shown([kind, options, uniforms]) {
  const sample = await stopped(kind);
  try {
    await draw(sample, options, [96, 72], uniforms);
  } catch ({ message }) {
    return message;
  }
  return base64((await readFrame(sample)).result);
}
