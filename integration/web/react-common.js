// SPDX-License-Identifier: MIT
//
// The code that the components for react-three-fiber share: it checks their properties, and passes them on in each
// frame.

import { useEffect, useRef, useState } from 'react';
import { EXTRAS, uniformsOf } from './common.js';

const OTHERS = ['fStop', 'bokehScale', 'focus', 'tau'];
const OF_REACT = ['ref', 'children', 'key'];
// Uniforms that are not properties, because setLens and pullFocus set them in each frame
const OF_LENS = ['apertureDiameter', 'focalLength', 'focusDistance'];

// Returns those properties that are options of the class.
export const optionsOf = (props, names) => Object.fromEntries(names.map((name) => [name, props[name]]));

// Keeps a pass or node up to date with the properties of its component. Returns a function to call in each frame, with
// the time since the last frame in seconds.
//
// bokeh    a PolygonBokehPass or PolygonBokehNode
// names    names of its options, which may change
// own      names of properties that only this component has
// Throws an Error if a property does not exist, or if the f-stop, the bokeh scale or a uniform is not a valid number.
export function useBokeh(bokeh, props, names, own = []) {
  const { fStop = 2.8, bokehScale = 10, focus = 5, tau = 0, ...others } = props;
  const options = optionsOf(props, names);
  const [, fail] = useState();
  const defaults = useRef({});
  const extras = Array.isArray(props.extras) ? props.extras : [];
  const numbers = ['debugMode', ...Object.keys(uniformsOf({ extras }))].filter((name) => !OF_LENS.includes(name));
  const wrong = refused(props, [...names, ...OTHERS, ...own], numbers);
  if (wrong) throw new Error(`polygonal-bokeh, <PolygonBokeh>: ${wrong}`);

  const key = JSON.stringify(options);
  const drawn = useRef({});
  useEffect(() => {
    const changed = drawn.current.bokeh === bokeh && drawn.current.key !== key;
    drawn.current = { bokeh, key };
    if (!changed) return;
    bokeh.change(options).catch((error) =>
      fail(() => {
        throw error;
      }),
    );
  }, [bokeh, key]);
  useEffect(() => () => bokeh.dispose(), [bokeh]);

  const set = numbers.filter((name) => name in others);
  return (dt) => {
    for (const name of new Set([...Object.keys(defaults.current), ...set])) {
      const uniform = bokeh.uniforms[name];
      if (!uniform) continue; // it belongs to an extra whose shaders are not compiled yet
      if (!(name in defaults.current)) defaults.current[name] = uniform.value;
      uniform.value = others[name] ?? defaults.current[name];
    }
    // without a field of view, setLens keeps the focal length: reset it, or the one of an earlier camera would remain
    if (bokeh.camera.isOrthographicCamera) bokeh.uniforms.focalLength.value = uniformsOf({ extras: [] }).focalLength;
    bokeh.setLens(fStop, bokehScale);
    const aim = focus.current ?? focus;
    bokeh.pullFocus(dt, [typeof aim === 'number' ? aim : bokeh.depthOf(aim)], tau);
  };
}

// Returns what is wrong with the properties, or ''. It is called while React renders, so an error boundary gets the
// error, and only once.
function refused({ fStop = 1, bokehScale = 1, ...others }, names, numbers) {
  if (!(fStop > 0)) return `fStop is ${fStop}. It must be a number above 0.`;
  if (!(bokehScale >= 0)) return `bokehScale is ${bokehScale}. It must be 0 or a number above 0.`;
  for (const [name, value] of Object.entries(others)) {
    if ([...names, ...OF_REACT].includes(name)) continue;
    if (!numbers.includes(name)) {
      const [extra] = Object.entries(EXTRAS).find(([, uniforms]) => name in uniforms) ?? [];
      if (extra) return `${name} needs extras={['${extra}']}.`;
      return `there is no property ${name}. The properties are ${[...names, ...numbers].join(', ')}.`;
    }
    if (value !== undefined && !Number.isFinite(value)) return `${name} is ${value}. It must be a finite number.`;
  }
  return '';
}
