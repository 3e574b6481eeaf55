// SPDX-License-Identifier: MIT
//
// What the classes of all engines share: their options, and what they set from outside.

// Option -> what it may be, its default first. `extras` is a list of those below.
export const CHOICES = {
  method: ['layered', 'exact', 'paper'],
  sides: [6, 4, 8, 10],
  preset: ['MEDIUM', 'MOBILE', 'LOW', 'HIGH', 'ULTRA'],
  opaque: [true, false],
  extras: [],
};

// What costs something only where it is asked for -> the uniforms that it has
export const EXTRAS = {
  jitter: { jitter: 1, frame: 0 },
  catsEye: { catsEye: 0.5, roundness: 1 },
  lateral: { lateral: 0.001 },
  focusRange: { frontRange: 0, backRange: 0, nearScale: 1, farScale: 1, nearMaxCoC: 1, farMaxCoC: 1 },
};

const LENS = {
  apertureDiameter: diameter(0.05),
  focalLength: 0.05,
  focusDistance: 5,
  sensorHeight: 0.024,
  maxCoC: 0.1,
  rotation: 0,
  squeeze: 1,
};

// The numbers that are to be set from outside, with their defaults
export const uniformsOf = ({ extras }) => Object.assign({}, LENS, ...extras.map((extra) => EXTRAS[extra]));

// Options with their defaults. `who` is the class. Throws an Error for what no option can be.
export function checked(who, given = {}, choices = CHOICES) {
  const refuse = (what, list) => {
    const valid = list.map((value) => JSON.stringify(value)).join(', ');
    throw new Error(`polygonal-bokeh, ${who}: ${what}. Use one of ${valid}.`);
  };
  const options = {};
  for (const [name, values] of Object.entries(choices)) options[name] = name === 'extras' ? [] : values?.[0];
  for (const [name, value] of Object.entries(given)) {
    if (!(name in choices)) refuse(`there is no option ${name}`, Object.keys(choices));
    if (value === undefined) continue;
    const [values, allowed] = name === 'extras' ? [value, Object.keys(EXTRAS)] : [[value], choices[name]];
    if (!Array.isArray(values)) refuse(`extras must be a list, not ${JSON.stringify(value)}`, allowed);
    const wrong = values.find((one) => allowed && !allowed.includes(one));
    if (wrong !== undefined) refuse(`${name} is ${JSON.stringify(wrong)}`, allowed);
    options[name] = value;
  }
  if (options.method === 'paper' && ![6, 8].includes(options.sides)) {
    refuse(`paper cannot draw ${options.sides} sides`, [6, 8]);
  }
  return options;
}

// The aperture's diameter at an f-stop, bokehScale times as wide as a real lens's. Throws an Error for what is none.
export function diameter(focalLength, fStop = 2.8, bokehScale = 10) {
  if (!(fStop > 0)) throw new Error(`polygonal-bokeh: the f-stop is ${fStop}. It must be above 0.`);
  if (!(bokehScale >= 0)) throw new Error(`polygonal-bokeh: bokehScale is ${bokehScale}. It must be 0 or above.`);
  return (focalLength / fStop) * bokehScale;
}

// Returns the focus distance dt seconds later, on its way to the nearest of these depths. 1 / distance changes evenly,
// not the distance; tau is the time constant in seconds (docs/lens.md). An invalid distance, 0 or NaN, is left at once.
export function pulled(distance, dt, depths, tau) {
  const aim = Math.min(...depths.filter((depth) => depth > 0));
  if (!depths.some((depth) => depth > 0)) return distance;
  const k = distance > 0 && tau > 0 ? 1 - Math.exp(-(dt > 0 ? dt : 0) / tau) : 1;
  return k === 1 ? aim : 1 / ((1 - k) / distance + k / aim);
}
