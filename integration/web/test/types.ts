// install.test.js compiles this file with tsc --strict. It uses each class as its guide does, and has lines that the
// types must reject.

import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { AppBase, CameraComponent, Vec3 } from 'playcanvas';
import { FrameGraph } from '@babylonjs/core/FrameGraph/frameGraph.js';
import { PolygonBokeh, PolygonBokehTask } from 'polygonal-bokeh/babylon';
import { PolygonBokehFrame } from 'polygonal-bokeh/playcanvas';
import { PolygonBokehPass as PmndrsPass } from 'polygonal-bokeh/postprocessing';
import { PolygonBokeh as Component } from 'polygonal-bokeh/react';
import { PolygonBokeh as WebGPUComponent } from 'polygonal-bokeh/react-webgpu';
import { PolygonBokehPass, SharpPass, depthOf, depthWithOpacity } from 'polygonal-bokeh/three';
import { PolygonBokehNode } from 'polygonal-bokeh/three-webgpu';
import * as pmndrs from 'postprocessing';
import { createElement, createRef } from 'react';
import { Mesh, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import { mrt, normalView, output, pass } from 'three/tsl';
import { type PassNode, RenderPipeline, WebGPURenderer } from 'three/webgpu';

const [scene, camera] = [new Scene(), new PerspectiveCamera()];

export async function webgl(renderer: WebGLRenderer): Promise<number> {
  const composer = new EffectComposer(renderer);
  const scenePass = new RenderPass(scene, camera);
  const bokeh = new PolygonBokehPass(camera, { sides: 8, extras: ['jitter'], depthTexture: depthOf(scenePass) });
  for (const one of [scenePass, bokeh, new SharpPass(bokeh, scene)]) composer.addPass(one);
  const weighted = new PolygonBokehPass(camera, { depthTexture: depthWithOpacity(scenePass) });
  composer.addPass(weighted);
  bokeh.setLens(1.4);
  bokeh.focusOn(new Mesh());
  bokeh.focusOn(new Vector3());
  bokeh.pullFocus(1 / 60, bokeh.depthsUnder([[0, 0]], scene));
  bokeh.focusByClicks(renderer.domElement, scene, () => composer.render()).dispose();
  bokeh.uniforms.maxCoC.value = 0.05;
  bokeh.setCamera(new PerspectiveCamera());
  await Promise.all([bokeh.setPreset('HIGH'), bokeh.setSides(4), bokeh.change({ method: 'exact', alpha: true })]);
  return bokeh.memory + bokeh.passes.length;
}

export function webgpu(renderer: WebGPURenderer): RenderPipeline {
  const bokeh = new PolygonBokehNode(pass(scene, camera), { alpha: true });
  bokeh.setLens(1.4);
  return new RenderPipeline(renderer, bokeh);
}

export function afterOthers(): PolygonBokehNode {
  const scenePass = pass(scene, camera);
  scenePass.setMRT(mrt({ output, normal: normalView }));
  const color = scenePass.getTextureNode().mul(0.5);
  return new PolygonBokehNode(color, scenePass.getTextureNode('depth'), camera, { sides: 8 });
}

export function others(app: AppBase, component: CameraComponent, free: FreeCamera): void {
  const frame = new PolygonBokehFrame(app, component, { method: 'paper', opaque: false });
  frame.focusOn(new Vec3());
  frame.uniforms.focusDistance = 3;
  frame.debugMode = 2;
  const bokeh = new PolygonBokeh(free, { view: 'coc' });
  bokeh.uniforms.rotation = bokeh.depthOf(free.position);
  const task = new PolygonBokehTask('bokeh', new FrameGraph(free.getScene()), free, { sides: 8 });
  task.sourceTexture = task.outputTexture;
  task.setLens(1.4);
}

export function react(composer: pmndrs.EffectComposer): unknown {
  composer.addPass(new PmndrsPass(camera, { preset: 'LOW' }));
  const focus = createRef<Mesh>();
  return createElement(Component, { fStop: 2, focus, tau: 0.2, sides: 8, maxCoC: 0.05, ref: createRef<PmndrsPass>() });
}

export function reactWebGPU(): unknown {
  const before = (scenePass: PassNode) => [scenePass.getTextureNode().mul(0.5), scenePass.getTextureNode('depth')] as const;
  const after = (bokeh: PolygonBokehNode) => bokeh.mul(0.5);
  return createElement(WebGPUComponent, { fStop: 2, before, after, sharpLayer: 1, ref: createRef<PolygonBokehNode>() });
}

// @ts-expect-error
createElement(WebGPUComponent, { before: () => null });
// @ts-expect-error
createElement(Component, { sides: 5 });
// @ts-expect-error
new PolygonBokehPass(camera, { preset: 'high' });
// @ts-expect-error
new PolygonBokehPass(camera, { sides: 5 });
// @ts-expect-error
new PolygonBokehNode(pass(scene, camera), { depthTexture: null });
// @ts-expect-error
new PolygonBokehNode(pass(scene, camera).getTextureNode(), camera);
// @ts-expect-error
new PolygonBokehPass(camera).uniforms.focus;
