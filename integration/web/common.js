// SPDX-License-Identifier: MIT
//
// The options and the settings that the classes of all engines share.

// Option -> its valid values, the default first. The value of `extras` is a list of keys of EXTRAS.
export const CHOICES = {
  method: ['layered', 'exact', 'paper'],
  sides: [6, 4, 8, 10],
  preset: ['MEDIUM', 'MOBILE', 'LOW', 'HIGH', 'ULTRA'],
  opaque: [true, false],
  extras: [],
};

// Extra, which costs time only if the user asks for it -> its settings with their defaults
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

// Returns the settings with their defaults, as uniforms of the shaders.
export const uniformsOf = ({ extras }) => Object.assign({}, LENS, ...extras.map((extra) => EXTRAS[extra]));

// Checks the options that the user has given, and returns all options, with defaults for the others.
//   who      name of the class, for messages
//   choices  option -> its valid values, the default first; undefined allows any value
// If an option or its value is not valid, it throws an Error that lists the valid ones.
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

// Returns the aperture diameter at an f-stop, multiplied by bokehScale, in the unit of focalLength. Throws an Error if
// fStop is not above 0, or bokehScale is below 0.
export function diameter(focalLength, fStop = 2.8, bokehScale = 10) {
  if (!(fStop > 0)) throw new Error(`polygonal-bokeh: the f-stop is ${fStop}. It must be above 0.`);
  if (!(bokehScale >= 0)) throw new Error(`polygonal-bokeh: bokehScale is ${bokehScale}. It must be 0 or above.`);
  return (focalLength / fStop) * bokehScale;
}

// Returns the focus distance dt seconds later, as it moves to the nearest of these depths. It interpolates 1 / distance
// instead of the distance; tau is the time constant in seconds (docs/lens.md). If the old distance is invalid, such as
// 0 or NaN, the focus jumps. If no depth is valid, the focus stays.
export function pulled(distance, dt, depths, tau) {
  const aim = Math.min(...depths.filter((depth) => depth > 0));
  if (!depths.some((depth) => depth > 0)) return distance;
  const k = distance > 0 && tau > 0 ? 1 - Math.exp(-(dt > 0 ? dt : 0) / tau) : 1;
  return k === 1 ? aim : 1 / ((1 - k) / distance + k / aim);
}
