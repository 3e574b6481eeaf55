// SPDX-License-Identifier: MIT
//
// <PolygonBokeh /> for react-three-fiber with WebGLRenderer, in the EffectComposer of @react-three/postprocessing, before
// <Bloom /> and <ToneMapping />.

import { useFrame, useThree } from '@react-three/fiber';
import { createElement, useMemo } from 'react';
import { PolygonBokehPass } from './postprocessing.js';
import { optionsOf, useBokeh } from './react-common.js';

const OPTIONS = ['method', 'sides', 'preset', 'opaque', 'extras', 'alpha'];

// OPTIONS  those of PolygonBokehPass; they may change
// fStop    of the lens; bokehScale is how many times wider the blur is than that lens's
// focus    metres, or a place in the world, an object, or a ref of one, looked at in each frame
// tau      seconds: the time constant of a pull to another focus; 0: at once
// others   uniforms of the pass, such as maxCoC and rotation; one that is left out has its default
// Throws an Error for a property that there is not, and for an f-stop or uniform that is no number.
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
