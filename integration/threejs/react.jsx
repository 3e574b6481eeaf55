// The sample for react-three-fiber with WebGLRenderer.

import { Canvas } from '@react-three/fiber';
import { EffectComposer, ToneMapping } from '@react-three/postprocessing';
import { ToneMappingMode } from 'postprocessing';
import { createRoot } from 'react-dom/client';
import { PolygonBokeh } from 'polygonal-bokeh/react';
import { makeScene } from './scene.js';

const { scene, camera, subject } = makeScene(640 / 480);

function Sample(options) {
  return (
    <Canvas camera={camera} scene={scene} flat dpr={1} gl={{ antialias: false, preserveDrawingBuffer: true }}>
      <EffectComposer multisampling={0}>
        <PolygonBokeh fStop={1.4} bokehScale={20} focus={subject} {...options} />
        <ToneMapping mode={ToneMappingMode.ACES_FILMIC} />
      </EffectComposer>
    </Canvas>
  );
}

const element = document.createElement('div');
element.style = 'width: 640px; height: 480px';
document.body.append(element);
const root = createRoot(element);
root.render(<Sample />);

// Draws with other options, which may change like any property.
export const show = (options) => root.render(<Sample {...options} />);
