// What react.test.js asks of the components, in the scene of scene.js.

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

const FRAMES = 4; // after React has mounted the page, until a change begins or an error of one is told
const SILENT = 600; // frames without either: something hangs
const frame = () => new Promise(requestAnimationFrame);
const { scene, camera, subject } = makeScene(1);
const orthographic = new THREE.OrthographicCamera(-1.5, 1.5, 1, -1, 0.2, 40);
const cameras = { perspective: camera, orthographic };
for (const one of Object.values(cameras)) one.manual = true; // react-three-fiber leaves it as it is

const found = {}; // renderer and node of what is shown
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

// What a canvas, or for WebGPU the node, shows: numbers of RGBA
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
  // { image, error, logged } of the page with these settings. anew: all of it mounted again
  async show({ anew = false, ...settings }) {
    if (anew) mounted += 1;
    Object.assign(found, { error: null });
    logged.length = 0;
    asked += 1;
    root.render(<Boundary key={mounted}><Page {...settings} number={asked} /></Boundary>);
    for (let i = 0; i < SILENT && found.number !== asked && !found.error; i++) await frame();
    for (let i = 0; i < FRAMES; i++) await frame();
    const { error } = found;
    // shaders are compiled beside the frames, and one frame draws with them
    while (!error && found.bokeh.changing && found.bokeh.passes !== found.bokeh.changing.passes) await frame();
    await frame();
    return { error, logged: [...logged], image: error ? null : await image(settings.renderer) };
  },

  // What the node draws by hand, with a renderer of its own
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
