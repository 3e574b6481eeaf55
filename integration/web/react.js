// SPDX-License-Identifier: MIT
//
// <PolygonBokeh /> for react-three-fiber, in the EffectComposer of @react-three/postprocessing, before <Bloom /> and
// <ToneMapping />.

import { useFrame, useThree } from '@react-three/fiber';
import { createElement, useEffect, useMemo, useRef, useState } from 'react';
import { PolygonBokehPass } from './postprocessing.js';

// method, sides, preset, opaque, extras, alpha  options of PolygonBokehPass; they may change
// fStop   of the lens
// focus   metres, or a place in the world, an object, or a ref of one, looked at in each frame
// tau     seconds: the time constant of a pull to another focus; 0: at once
// others  uniforms of the pass, such as maxCoC and rotation
export function PolygonBokeh(props) {
  const { method, sides, preset, opaque, extras, alpha, fStop = 1.4, focus = 5, tau = 0, ref, ...uniforms } = props;
  const options = { method, sides, preset, opaque, extras, alpha };
  const camera = useThree((state) => state.camera);
  const pass = useMemo(() => new PolygonBokehPass(camera, options), []);
  const [, fail] = useState();

  const key = JSON.stringify(options);
  const drawn = useRef(key);
  useEffect(() => {
    if (drawn.current === key) return;
    drawn.current = key;
    const refused = (error) => {
      fail(() => {
        throw error;
      });
    };
    pass.change(options).catch(refused);
  }, [key]);
  useEffect(() => () => pass.dispose(), [pass]);

  useFrame((_, dt) => {
    pass.camera = camera;
    for (const [name, value] of Object.entries(uniforms)) {
      if (!pass.uniforms[name]) throw new Error(`polygonal-bokeh, <PolygonBokeh>: there is no ${name}.`);
      pass.uniforms[name].value = value;
    }
    pass.setLens(fStop);
    const aim = focus.current ?? focus;
    pass.pullFocus(dt, [typeof aim === 'number' ? aim : pass.depthOf(aim)], tau);
  });
  return createElement('primitive', { object: pass, ref });
}
