// The page with which react.test.js tests the components, in the scene of scene.js.

import * as THREE from 'three';
import { Canvas, useThree } from '@react-three/fiber';
import { EffectComposer } from '@react-three/postprocessing';
import { PolygonBokeh as WithComposer } from 'polygonal-bokeh/react';
import { PolygonBokeh as WithPipeline } from 'polygonal-bokeh/react-webgpu';
import { PolygonBokehNode } from 'polygonal-bokeh/three-webgpu';
import { Component, useLayoutEffect } from 'react';
import { createRoot } from 'react-dom/client';
import { pass } from 'three/tsl';
import { RenderPipeline, RenderTarget, WebGPURenderer } from 'three/webgpu';
import { SIZE, makeScene } from './scene.js';

const FRAMES = 4; // frames to wait after React has mounted the page; by then, a change has begun, or its error is known
const SILENT = 600; // after so many frames without a page and without an error, give up waiting
const frame = () => new Promise(requestAnimationFrame);
const { scene, camera, subject } = makeScene(1);
const orthographic = new THREE.OrthographicCamera(-1.5, 1.5, 1, -1, 0.2, 40);
const cameras = { perspective: camera, orthographic };
for (const one of Object.values(cameras)) one.manual = true; // react-three-fiber then does not change it

const found = {}; // of the page that is shown: renderer, pass or node, number and error
const logged = [];
console.error = (...words) => logged.push(words.join(' '));
window.reportError = (error) => logged.push(error.message);

const renderers = {
  webgl: { antialias: false, preserveDrawingBuffer: true },
  webgpu: async (given) => {
    const renderer = new WebGPURenderer({ ...given, antialias: false });
    await renderer.init();
    return renderer;
  },
};

const CHAINS = {
  half: { before: (scenePass) => [scenePass.getTextureNode().mul(0.5), scenePass.getTextureNode('depth')] },
  shown: { after: (bokeh) => bokeh.mul(0.5) },
};

class Boundary extends Component {
  state = { error: null };
  static getDerivedStateFromError = (error) => ({ error });
  componentDidCatch = (error) => (found.error = error.message);
  render() {
    return this.state.error ? null : this.props.children;
  }
}

function Chosen({ kind, number }) {
  const { set, gl } = useThree();
  useLayoutEffect(() => {
    found.renderer = gl;
    set({ camera: cameras[kind] });
  }, [kind]);
  useLayoutEffect(() => {
    found.number = number;
  }, [number]);
}

function Page({ number, renderer = 'webgl', component = renderer, kind = 'perspective', chain, props }) {
  const bokeh = { fStop: 1.4, bokehScale: 20, focus: subject, ref: (node) => (found.bokeh = node ?? found.bokeh), ...props };
  return (
    <Canvas camera={cameras[kind]} scene={scene} flat dpr={1} gl={renderers[renderer]}>
      <Chosen kind={kind} number={number} />
      {component === 'webgpu' ? (
        <WithPipeline {...CHAINS[chain]} {...bokeh} />
      ) : (
        <EffectComposer multisampling={0}>
          <WithComposer {...bokeh} />
        </EffectComposer>
      )}
    </Canvas>
  );
}

const element = document.createElement('div');
element.style = `width: ${SIZE[0]}px; height: ${SIZE[1]}px`;
document.body.append(element);
const root = createRoot(element, { onCaughtError: () => {} });
let mounted = 0;
let asked = 0;

// Returns the pixels of the canvas, or with WebGPU of the node, as RGBA numbers.
async function image(renderer) {
  if (renderer === 'webgpu') return halves(found.renderer, found.bokeh.result);
  const context = new OffscreenCanvas(...SIZE).getContext('2d');
  context.drawImage(document.querySelector('canvas'), 0, 0);
  return Array.from(context.getImageData(0, 0, ...SIZE).data);
}

async function halves(renderer, target) {
  return Array.from(await renderer.readRenderTargetPixelsAsync(target, 0, 0, ...SIZE), THREE.DataUtils.fromHalfFloat);
}

window.bokeh = {
  // Returns { image, error, logged } of the page with these settings. `anew` mounts the whole page again.
  async show({ anew = false, ...settings }) {
    if (anew) mounted += 1;
    Object.assign(found, { error: null });
    logged.length = 0;
    asked += 1;
    root.render(<Boundary key={mounted}><Page {...settings} number={asked} /></Boundary>);
    for (let i = 0; i < SILENT && found.number !== asked && !found.error; i++) await frame();
    for (let i = 0; i < FRAMES; i++) await frame();
    const { error } = found;
    // shaders are compiled between frames, so wait until they are, and then for a frame that uses them
    while (!error && found.bokeh.changing && found.bokeh.passes !== found.bokeh.changing.passes) await frame();
    await frame();
    return { error, logged: [...logged], image: error ? null : await image(settings.renderer) };
  },

  // Returns what PolygonBokehNode draws without React, with a renderer of its own.
  async byHand() {
    const renderer = new WebGPURenderer();
    renderer.setSize(...SIZE);
    await renderer.init();
    const bokeh = new PolygonBokehNode(pass(scene, camera));
    bokeh.setLens(1.4, 20);
    bokeh.focusOn(subject);
    renderer.setRenderTarget(new RenderTarget(...SIZE));
    new RenderPipeline(renderer, bokeh).render();
    return halves(renderer, bokeh.result);
  },};
