// The sample for pmndrs' postprocessing.

import { EffectComposer, EffectPass, RenderPass, ToneMappingEffect, ToneMappingMode } from 'postprocessing';
import { HalfFloatType, WebGLRenderer } from 'three';
import { PolygonBokehPass } from 'polygonal-bokeh/postprocessing';
import { makeScene } from './scene.js';

export const renderer = new WebGLRenderer();
document.body.append(renderer.domElement);
const { scene, camera, subject } = makeScene(640 / 480);

export const composer = new EffectComposer(renderer, { frameBufferType: HalfFloatType });
export const bokeh = new PolygonBokehPass(camera);
bokeh.setLens(1.4, 20); // f/1.4, with a blur 20 times as wide as a real lens's
bokeh.focusOn(subject);
composer.addPass(new RenderPass(scene, camera));
composer.addPass(bokeh);
const tone = new ToneMappingEffect({ mode: ToneMappingMode.ACES_FILMIC });
composer.addPass(new EffectPass(camera, tone)); // the last pass also encodes the image as sRGB
composer.setSize(640, 480);
composer.render();
