// SPDX-License-Identifier: MIT
//
// <PolygonBokeh /> for react-three-fiber, in the EffectComposer of @react-three/postprocessing, before <Bloom /> and
// <ToneMapping />.

import { useFrame, useThree } from '@react-three/fiber';
import { createElement, useEffect, useMemo, useRef, useState } from 'react';
import { PolygonBokehPass } from './postprocessing.js';

// method, sides, preset, opaque, extras, alpha  options of PolygonBokehPass; they may change
// fStop   of the lens; bokehScale is how many times wider the blur is than that lens's
// focus   metres, or a place in the world, an object, or a ref of one, looked at in each frame
// tau     seconds: the time constant of a pull to another focus; 0: at once
// others  uniforms of the pass, such as maxCoC and rotation; one that is left out has its default
// Throws an Error for a property that there is not, and for an f-stop or uniform that is no number.
export function PolygonBokeh(props) {
  const { method, sides, preset, opaque, extras, alpha, fStop = 2.8, bokehScale = 10, focus = 5, tau = 0, ref, ...uniforms } = props;
  const options = { method, sides, preset, opaque, extras, alpha };
  const camera = useThree((state) => state.camera);
  const pass = useMemo(() => new PolygonBokehPass(camera, options), []);
  const [, fail] = useState();
  const defaults = useRef({});
  const wrong = refused(props, pass.uniforms);
  if (wrong) throw new Error(`polygonal-bokeh, <PolygonBokeh>: ${wrong}`);

  const key = JSON.stringify(options);
  const drawn = useRef(key);
  useEffect(() => {
    if (drawn.current === key) return;
    drawn.current = key;
    pass.change(options).catch((error) =>
      fail(() => {
        throw error;
      }),
    );
  }, [key]);
  useEffect(() => () => pass.dispose(), [pass]);

  useFrame((_, dt) => {
    pass.camera = camera;
    for (const [name, value] of Object.entries({ ...defaults.current, ...uniforms })) {
      if (!(name in defaults.current)) defaults.current[name] = pass.uniforms[name].value;
      pass.uniforms[name].value = value;
    }
    pass.setLens(fStop, bokehScale);
    const aim = focus.current ?? focus;
    pass.pullFocus(dt, [typeof aim === 'number' ? aim : pass.depthOf(aim)], tau);
  });
  return createElement('primitive', { object: pass, ref });
}

const OPTIONS = ['method', 'sides', 'preset', 'opaque', 'extras', 'alpha', 'fStop', 'bokehScale', 'focus', 'tau', 'ref', 'children', 'key'];

// What is wrong with properties, or nothing. Told while React renders: an error boundary gets it, once.
function refused({ fStop = 1, bokehScale = 1, ...others }, uniforms) {
  if (!(fStop > 0)) return `fStop is ${fStop}. Give a number above 0.`;
  if (!(bokehScale >= 0)) return `bokehScale is ${bokehScale}. Give 0 or a number above it.`;
  for (const [name, value] of Object.entries(others)) {
    if (OPTIONS.includes(name)) continue;
    if (!uniforms[name]) {
      const allowed = [...OPTIONS.slice(0, 10), ...Object.keys(uniforms)].join(', ');
      return `there is no property ${name}. There are ${allowed}.`;
    }
    if (typeof uniforms[name].value === 'number' && !Number.isFinite(value)) return `${name} is ${value}. Give a number.`;
  }
  return '';
}
