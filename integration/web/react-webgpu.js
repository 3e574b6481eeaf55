// SPDX-License-Identifier: MIT
//
// <PolygonBokeh /> for react-three-fiber with WebGPURenderer, in its <Canvas>. It draws the frame, by a RenderPipeline of
// three.js 0.183 or later: react-three-fiber itself then draws none.

import { useFrame, useThree } from '@react-three/fiber';
import { useEffect, useImperativeHandle, useMemo } from 'react';
import { pass } from 'three/tsl';
import { RenderPipeline } from 'three/webgpu';
import { optionsOf, useBokeh } from './react-common.js';
import { PolygonBokehNode } from './three-webgpu.js';

const OPTIONS = ['method', 'sides', 'preset', 'opaque', 'extras', 'alpha', 'sharpLayer'];
const RENDERER =
  'polygonal-bokeh, <PolygonBokeh>: polygonal-bokeh/react-webgpu needs WebGPURenderer. Create it in the property gl of ' +
  '<Canvas>. With WebGLRenderer, import polygonal-bokeh/react instead.';

// As that of react.js, with options of PolygonBokehNode, and
//   before  (scenePass, camera) => [color, depth]: nodes between the scene and the bokeh, such as ambient occlusion
//   after   (bokeh, scenePass) => node: what is shown, such as bloom
// Both are called when renderer, scene or camera are others, and then the node is made anew.
export function PolygonBokeh(props) {
  const { before, after, ref } = props;
  const { gl, scene, camera } = useThree();
  if (!gl.isWebGPURenderer) throw new Error(RENDERER);
  const { bokeh, scenePass, pipeline } = useMemo(() => {
    const scenePass = pass(scene, camera);
    const given = before ? [...before(scenePass, camera), camera] : [scenePass];
    const bokeh = new PolygonBokehNode(...given, optionsOf(props, OPTIONS));
    return { bokeh, scenePass, pipeline: new RenderPipeline(gl, after ? after(bokeh, scenePass) : bokeh) };
  }, [gl, scene, camera]);
  const update = useBokeh(bokeh, props, OPTIONS, ['before', 'after']);
  useImperativeHandle(ref, () => bokeh, [bokeh]);
  useEffect(() => () => [pipeline, scenePass].forEach((own) => own.dispose()), [pipeline, scenePass]);
  // react-three-fiber draws nothing where a callback has a priority
  useFrame((_, dt) => {
    update(dt);
    pipeline.render();
  }, 1);
  return null;
}
