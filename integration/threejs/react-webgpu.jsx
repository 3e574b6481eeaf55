// The sample for react-three-fiber with WebGPURenderer. Options may change, as in react.jsx.

import { Canvas } from '@react-three/fiber';
import { createRoot } from 'react-dom/client';
import { ACESFilmicToneMapping, WebGPURenderer } from 'three/webgpu';
import { PolygonBokeh } from 'polygonal-bokeh/react-webgpu';
import { makeScene } from './scene.js';

const { scene, camera, subject } = makeScene(640 / 480);

async function makeRenderer(given) {
  const renderer = new WebGPURenderer({ ...given, antialias: false });
  await renderer.init();
  return renderer;
}

function Sample(options) {
  return (
    <Canvas camera={camera} scene={scene} dpr={1} gl={makeRenderer} onCreated={({ gl }) => (gl.toneMapping = ACESFilmicToneMapping)}>
      <PolygonBokeh fStop={1.4} bokehScale={20} focus={subject} {...options} />
    </Canvas>
  );
}

const element = document.createElement('div');
element.style = 'width: 640px; height: 480px';
document.body.append(element);
const root = createRoot(element);

export const show = (options) => root.render(<Sample {...options} />);
show({});
