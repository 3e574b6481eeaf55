// SPDX-License-Identifier: MIT
//
// <PolygonBokeh /> for react-three-fiber with WebGLRenderer. Put it into <EffectComposer> of
// @react-three/postprocessing, before <Bloom /> and <ToneMapping />.

import { useFrame, useThree } from '@react-three/fiber';
import { createElement, useMemo } from 'react';
import { PolygonBokehPass } from './postprocessing.js';
import { optionsOf, useBokeh } from './react-common.js';

const OPTIONS = ['method', 'sides', 'preset', 'opaque', 'extras', 'alpha'];

// Its properties are:
//   OPTIONS     the options of PolygonBokehPass; they may change
//   fStop       f-stop of the lens, above 0; 2.8 by default
//   bokehScale  how many times as wide the blur is as that of a real lens; 10 by default, 0 turns the blur off
//   focus       focus distance in metres (5 by default), or a point of the scene, an object, or a ref to an object,
//               whose depth is computed in each frame
//   tau         time constant of the movement to another focus, in seconds; with 0, the default, the focus jumps
//   others      uniforms of the pass, such as maxCoC and rotation; if you leave one out, it has its default
// Throws an Error if a property does not exist, or if the f-stop, the bokeh scale or a uniform is not a valid number.
export function PolygonBokeh(props) {
  const camera = useThree((state) => state.camera);
  const pass = useMemo(() => new PolygonBokehPass(camera, optionsOf(props, OPTIONS)), []);
  const update = useBokeh(pass, props, OPTIONS);
  useFrame((_, dt) => {
    pass.camera = camera;
    update(dt);
  });
  return createElement('primitive', { object: pass, ref: props.ref });
}
