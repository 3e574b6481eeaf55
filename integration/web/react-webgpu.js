// SPDX-License-Identifier: MIT
//
// <PolygonBokeh /> for react-three-fiber with WebGPURenderer. Put it directly into <Canvas>. It draws every frame with
// a RenderPipeline of three.js 0.183 or later, and react-three-fiber itself then draws nothing.

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

// Has the properties of the component in react.js, with the options of PolygonBokehNode, and two more:
//   before  (scenePass, camera) => [color, depth]: adds nodes between the scene and the bokeh, such as ambient
//           occlusion
//   after   (bokeh, scenePass) => node: adds nodes after the bokeh, such as bloom, and returns the node to show
// When the renderer, the scene or the camera changes, the node is created again, and both functions are called again.
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
  // react-three-fiber does not draw the scene itself if a callback has a priority, here 1
  useFrame((_, dt) => {
    update(dt);
    pipeline.render();
  }, 1);
  return null;
}
