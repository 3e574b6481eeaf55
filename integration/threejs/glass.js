// A ball of glass in front of the subject, and sparks, each with its own blur: the bokeh reads depth weighted by
// opacity. With the usual depth, everything seen through the ball would be as blurred as the ball, and the sparks would
// be as blurred as the wall.

import { AdditiveBlending, BufferGeometry, Float32BufferAttribute, HalfFloatType, Mesh, MeshPhysicalMaterial } from 'three';
import { Points, PointsMaterial, SphereGeometry, WebGLRenderTarget } from 'three';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { OutputPass } from 'three/addons/postprocessing/OutputPass.js';
import { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import { PolygonBokehPass, depthWithOpacity } from 'polygonal-bokeh/three';
import { camera, renderer, scene, subject } from './webgl.js'; // replace it with your own scene and renderer

const ball = new Mesh(
  new SphereGeometry(0.28, 48, 32),
  new MeshPhysicalMaterial({ color: 0x9fd8ff, transparent: true, opacity: 0.4, roughness: 0.05 }),
);
ball.position.set(0.3, 0.95, -2.6);

const places = Array.from({ length: 90 }, (_, i) => [1.6 * Math.sin(7 * i), 0.4 + 0.09 * (i % 30), -3 - (i % 7)]);
const sparks = new Points(
  new BufferGeometry().setAttribute('position', new Float32BufferAttribute(places.flat(), 3)),
  new PointsMaterial({ size: 0.03, transparent: true, blending: AdditiveBlending, depthWrite: false }),
);
sparks.material.color.setRGB(8, 3, 0.4);
scene.add(ball, sparks);

export const composer = new EffectComposer(renderer, new WebGLRenderTarget(640, 480, { type: HalfFloatType }));
const scenePass = new RenderPass(scene, camera);
const bokeh = new PolygonBokehPass(camera, { depthTexture: depthWithOpacity(scenePass) });
bokeh.setLens(1.4, 20);
bokeh.focusOn(subject);
for (const pass of [scenePass, bokeh, new OutputPass()]) composer.addPass(pass);
composer.render(); // call it in each frame
