// For the validation suite only: draws every method and polygon, and returns their inputs and results as raw pixels.

import { OrthographicCamera, Raycaster, REVISION, Vector2 } from 'three';
import { addShot, base64, cameraOf, HEIGHT, pulledTo } from '../web/test/captures.js';
import { SHAPES, shotsOf, SIZE, sizeOf, uniformsOf, viewsOf, WIDTH } from '../web/test/captures.js';

// The same functions for each sample:
//   draw(options, size, changes)  draws a frame and returns it, { bokeh, ... }; `changes` are another camera, renderer,
//                                 debug mode (mode) or chain, and uniforms
//   read(frame)                   returns its pixels, beginning with the first row in memory: { color, depth, result };
//                                 depth is as in the engine's buffer, with paper in metres
//   readPasses(frame)             returns the pixels that the passes wrote, in the order of docs/reference/passes.md
//   picture(frame)                resolves with the image on the canvas, as PNG
//   other(options)                returns a renderer with another kind of depth buffer
const samples = {
  async webgl() {
    const { FloatType, RedFormat, ShaderMaterial, WebGLRenderer, WebGLRenderTarget } = await import('three');
    const { FullScreenQuad } = await import('three/addons/postprocessing/Pass.js');
    const sample = await import('./webgl.js');
    const gl = sample.renderer.getContext();
    const names = gl.getExtension('WEBGL_debug_renderer_info');
    const pixels = (renderer, target, Type, channels, index = 0) => {
      const { width, height } = target;
      const into = new Type(width * height * channels);
      renderer.readRenderTargetPixels(target, 0, 0, width, height, into, undefined, index);
      return into;
    };
    // a depth buffer cannot be read back, so copy it
    const COPY = 'uniform sampler2D depth; void main() { gl_FragColor = texelFetch(depth, ivec2(gl_FragCoord), 0); }';
    const copied = (renderer, depth) => {
      const { width, height } = depth.image;
      const target = new WebGLRenderTarget(width, height, { type: FloatType, format: RedFormat, depthBuffer: false });
      renderer.setRenderTarget(target);
      const material = new ShaderMaterial({ uniforms: { depth: { value: depth } }, fragmentShader: COPY });
      new FullScreenQuad(material).render(renderer);
      return pixels(renderer, target, Float32Array, 1);
    };
    return {
      ...sample,
      engine: 'three.js WebGLRenderer',
      device: gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER),
      draw(options, [width, height], changes = {}) {
        const { camera = sample.camera, renderer = sample.renderer, mode = 0, uniforms = {} } = changes;
        const { composer, bokeh } = sample.addBokeh(renderer, sample.scene, camera, options);
        composer.setSize(width, height);
        bokeh.focusOn(sample.subject.position);
        bokeh.uniforms.debugMode.value = mode;
        for (const [name, value] of Object.entries(uniforms)) bokeh.uniforms[name].value = value;
        composer.render();
        return { composer, bokeh, renderer };
      },
      read({ composer, bokeh, renderer }) {
        // the buffers were swapped after the bokeh and after the output pass, so the input of the bokeh is in
        // readBuffer
        const color = pixels(renderer, composer.readBuffer, Uint16Array, 4);
        const result = pixels(renderer, composer.writeBuffer, Uint16Array, 4);
        const { metres, depth } = bokeh.textures;
        const target = metres && bokeh.passes[0].target;
        const held = target ? pixels(renderer, target, Float32Array, 1) : copied(renderer, depth.value);
        return { color, depth: held, result };
      },
      readPasses({ composer, bokeh, renderer }) {
        const passes = bokeh.passes.map(({ target = composer.writeBuffer }) => ({ target }));
        return written({ passes }, (target, i) => pixels(renderer, target, Uint16Array, 4, i));
      },
      picture: ({ renderer }) => new Promise((done) => renderer.domElement.toBlob(done)),
      other: (options) => new WebGLRenderer(options),
    };
  },

  async webgpu() {
    const { FloatType, NodeMaterial, QuadMesh, RedFormat } = await import('three/webgpu');
    const { RenderTarget, WebGPURenderer } = await import('three/webgpu');
    const { vec4 } = await import('three/tsl');
    const sample = await import('./webgpu.js');
    const { vendor, architecture, description } = sample.renderer.backend.device.adapterInfo;
    const pixels = (renderer, target, index) => {
      return renderer.readRenderTargetPixelsAsync(target, 0, 0, target.width, target.height, index);
    };
    const copied = (renderer, { size: [width, height], source }) => {
      const target = new RenderTarget(width, height, { type: FloatType, format: RedFormat, depthBuffer: false });
      const fragmentNode = vec4(source.depth.r);
      renderer.setRenderTarget(target);
      new QuadMesh(Object.assign(new NodeMaterial(), { fragmentNode })).render(renderer);
      renderer.setRenderTarget(null);
      return pixels(renderer, target);
    };
    return {
      ...sample,
      engine: 'three.js WebGPURenderer',
      device: [vendor, architecture, description].filter(Boolean).join(' '),
      draw(options, size, changes = {}) {
        const { camera = sample.camera, renderer = sample.renderer, mode = 0, chain = sample.addBokeh } = changes;
        const { pipeline, bokeh } = chain(renderer, sample.scene, camera, options);
        const target = new RenderTarget(...size); // a canvas cannot be read back
        renderer.setSize(...size);
        renderer.setRenderTarget(target);
        bokeh.focusOn(sample.subject.position);
        bokeh.uniforms.debugMode.value = mode;
        for (const [name, value] of Object.entries(changes.uniforms ?? {})) bokeh.uniforms[name].value = value;
        pipeline.render();
        renderer.setRenderTarget(null);
        return { bokeh, renderer, target };
      },
      async read({ bokeh, renderer }) {
        const { passNode, renderTarget = passNode.renderTarget } = bokeh.source.color;
        const color = await pixels(renderer, renderTarget);
        const result = await pixels(renderer, bokeh.passes.at(-1).target);
        const [{ writes, target }] = bokeh.passes;
        const depth = await (writes[0] === 'metres' ? pixels(renderer, target) : copied(renderer, bokeh));
        return { color, depth, result };
      },
      readPasses: ({ bokeh, renderer }) => written(bokeh, (target, i) => pixels(renderer, target, i)),
      async picture({ renderer, target }) {
        const shown = new Uint8ClampedArray((await pixels(renderer, target)).buffer);
        const canvas = new OffscreenCanvas(target.width, target.height);
        canvas.getContext('2d').putImageData(new ImageData(shown, target.width, target.height), 0, 0);
        return canvas.convertToBlob();
      },
      async other(options) {
        const renderer = new WebGPURenderer(options);
        await renderer.init();
        return renderer;
      },
    };
  },
};

// Returns the pixels that the passes wrote, one target after the other.
async function written({ passes }, pixels) {
  const found = [];
  for (const { target } of passes) {
    for (const i of target.textures.keys()) found.push(new Uint8Array((await pixels(target, i)).buffer));
  }
  return new Uint8Array(await new Blob(found).arrayBuffer());
}

// Returns { data: the content of capture.json, files: name -> base64 } for 'webgl' or 'webgpu'.
export async function capture(kind) {
  const sample = await samples[kind]();
  const { engine, device } = sample;
  const data = { engine: `${engine} r${REVISION}`, device, width: SIZE[0], height: SIZE[1], shots: [] };
  const picture = await sample.picture(sample.draw({}, [2 * WIDTH, 2 * HEIGHT]));
  const files = { 'picture.png': base64(await picture.bytes()) };
  const shots = shotsOf(Object.keys(SHAPES));
  const occluded = { name: 'after-occlusion', method: 'layered', aperture: 'hexagon', chain: sample.addOccludedBokeh };
  if (sample.addOccludedBokeh) shots.splice(1, 0, occluded);
  for (const shot of shots) {
    const { method, aperture, chain } = shot;
    const changes = { ...(chain && { chain }), uniforms: uniformsOf(shot) };
    const frame = sample.draw({ method, sides: SHAPES[method][aperture], opaque: false }, sizeOf(shot), changes);
    const written = method !== 'paper' && (await sample.readPasses(frame));
    addShot({ data, files }, shot, settings(method, frame.bokeh.uniforms), await sample.read(frame), written);
    data.pull = pulled(frame.bokeh, sample, kind === 'webgl');
  }
  return { data, files };
}

// Runs the autofocus frame by frame, on a point of the floor and a point of the wall. Returns its inputs and the focus
// distances.
function pulled(bokeh, { scene, camera }, bottomUp) {
  const { focusDistance } = bokeh.uniforms;
  const points = [[0.9, -0.31], [0.19, 0.07]];
  const depths = bokeh.depthsUnder(points, scene);
  const shown = points.map(([x, y]) => [(x + 1) / 2, bottomUp ? (1 + y) / 2 : (1 - y) / 2]);
  return pulledTo(bokeh, () => focusDistance.value, shown, depths);
}

// Returns the settings as the shaders got them, in float32.
function settings(method, uniforms) {
  const value = (name) => Math.fround(uniforms[name].value);
  const stored = { kind: value('depthKind'), near: value('nearPlane'), far: value('farPlane') };
  return {
    // the reference has no presets for paper: give it the samples and the spacing of MEDIUM
    ...(method === 'paper' ? { samples: 9, spacing: 1.5 } : { stored }),
    camera: cameraOf((name) => uniforms[name].value),
  };
}

const BUFFERS = { reversed: { reversedDepthBuffer: true }, logarithmic: { logarithmicDepthBuffer: true } };

// Compares depths at some pixels, for every kind of camera and depth buffer except the one that is refused. Returns
// [{ name, drawn: the depths in metres as the passes of paper read them, met: the depths where rays hit an object }].
export async function depths(kind) {
  const sample = await samples[kind]();
  const orthographic = new OrthographicCamera(-3.2, 3.2, 2.4, -2.4, 0.1, 100);
  orthographic.position.copy(sample.camera.position);
  orthographic.quaternion.copy(sample.camera.quaternion);
  const found = [];
  const renderers = { usual: sample.renderer };
  for (const [buffer, options] of Object.entries(BUFFERS)) renderers[buffer] = await sample.other(options);
  for (const [buffer, renderer] of Object.entries(renderers)) {
    const cameras = { perspective: sample.camera.clone(), orthographic: orthographic.clone() };
    if (kind === 'webgpu' && buffer === 'logarithmic') delete cameras.perspective;
    for (const [view, camera] of Object.entries(cameras)) {
      const { depth } = await sample.read(sample.draw({ method: 'paper' }, [WIDTH, HEIGHT], { camera, renderer }));
      found.push({ name: `${view}, ${buffer}`, ...probed(sample, camera, depth, kind === 'webgl') });
    }
  }
  return found;
}

function probed({ scene }, camera, depth, bottomUp) {
  const drawn = [];
  const met = [];
  const caster = new Raycaster();
  for (let y = 5; y < HEIGHT; y += 10) {
    for (let x = 5; x < WIDTH; x += 10) {
      const row = bottomUp ? HEIGHT - 1 - y : y;
      caster.setFromCamera(new Vector2((2 * x + 1) / WIDTH - 1, 1 - (2 * y + 1) / HEIGHT), camera);
      const [hit] = caster.intersectObjects(scene.children);
      if (!hit) continue;
      drawn.push(depth[row * WIDTH + x]);
      met.push(-camera.worldToLocal(hit.point.clone()).z);
    }
  }
  return { drawn, met };
}

// Draws with a logarithmic depth buffer and a perspective camera.
export async function logarithmic(kind) {
  const sample = await samples[kind]();
  const renderer = await sample.other(BUFFERS.logarithmic);
  // use a copy of the camera, because three.js stores the kind of the renderer's depth buffer in it
  sample.draw({}, [WIDTH, HEIGHT], { camera: sample.camera.clone(), renderer });
}

// Draws the debug views, for viewsOf.
export async function views(kind) {
  const sample = await samples[kind]();
  const { depth } = await sample.read(sample.draw({ method: 'paper' }, [WIDTH, HEIGHT]));
  return viewsOf(async (mode) => {
    const frame = sample.draw({ opaque: false }, [WIDTH, HEIGHT], { mode });
    const { focusDistance, maxCoC } = frame.bokeh.uniforms;
    return { depth, result: (await sample.read(frame)).result, focus: focusDistance.value, maxCoC: maxCoC.value };
  });
}

// Tests the sample's own keys and clicks. Returns the focus distance before, after a drag that ends on the box, and
// after a click on the box through two hidden ones; the depth of the box; and the debug mode after a key was pressed.
export async function interaction(kind) {
  const { renderer, camera, scene, bokeh, focus } = await samples[kind]();
  const box = scene.children.find((child) => child.geometry?.type === 'BoxGeometry');
  const [x, y] = box.position.clone().project(camera).toArray();
  const { left, top, width, height } = renderer.domElement.getBoundingClientRect();
  const before = bokeh.uniforms.focusDistance.value;
  const place = { clientX: left + ((1 + x) / 2) * width, clientY: top + ((1 - y) / 2) * height };
  const { domElement } = renderer;
  domElement.dispatchEvent(new PointerEvent('pointerdown', { ...place, clientX: place.clientX + 6 }));
  domElement.dispatchEvent(new MouseEvent('click', place));
  const dragged = focus.pulling ? NaN : bokeh.uniforms.focusDistance.value;
  domElement.dispatchEvent(new PointerEvent('pointerdown', { ...place, clientX: place.clientX + 4 }));
  const [hidden, unseen] = [box.clone(), box.clone()];
  hidden.visible = false;
  unseen.material = Array(6).fill(Object.assign(box.material.clone(), { visible: false })); // one for each side
  scene.add(hidden, unseen);
  for (const one of [hidden, unseen]) one.position.lerp(camera.position, 0.5);
  scene.updateMatrixWorld();
  domElement.dispatchEvent(new MouseEvent('click', place));
  scene.remove(hidden, unseen);
  while (focus.pulling) await new Promise(requestAnimationFrame);
  dispatchEvent(new KeyboardEvent('keydown', { key: '2' }));
  const { focusDistance, debugMode } = bokeh.uniforms;
  const depth = -camera.worldToLocal(box.position.clone()).z;
  return { before, dragged, after: focusDistance.value, box: depth, mode: debugMode.value };
}
