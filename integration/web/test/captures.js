// What the captures of three.js, Babylon.js and PlayCanvas share. For the validation suite only.

export const WIDTH = 320;
export const HEIGHT = 240;
// The size of the shots is small, because the reference computes every pass of each shot.
export const SIZE = [160, 120];
// For layered, a size that 2, 4 and 8 do not divide, because its targets have 1 / 2, 1 / 4 and 1 / 8 of the size
export const ODD_SIZE = [157, 117];
export const SHAPES = {
  layered: { hexagon: 6, square: 4, octagon: 8, decagon: 10 }, // the default first
  exact: { square: 4, hexagon: 6, octagon: 8, decagon: 10 },
  paper: { hexagon: 6, octagon: 8 },
};
// Polygons to draw a second time, rotated by CLOCKWISE degrees and squeezed
const ROTATED = { exact: 'square', paper: 'hexagon' };
const CLOCKWISE = 10;
const SQUEEZE = 0.75;

// Returns a shot for every polygon of some methods, and those with `rotated`.
export function shotsOf(methods) {
  const all = methods.flatMap((method) => {
    return Object.keys(SHAPES[method]).map((aperture) => ({ name: `${method}-${aperture}`, method, aperture }));
  });
  const rotated = methods.filter((method) => ROTATED[method]).map((method) => {
    return { name: `rotated-${method}`, method, aperture: ROTATED[method], rotated: true };
  });
  return [...all, ...rotated];
}

export const sizeOf = ({ method }) => (method === 'layered' ? ODD_SIZE : SIZE);
export const uniformsOf = ({ rotated }) => {
  return rotated ? { rotation: (CLOCKWISE * Math.PI) / 180, squeeze: SQUEEZE } : {};
};
export const base64 = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength).toBase64();

// Adds a shot to a capture, { data: the content of capture.json, files: name -> base64 }.
//   more     further values of the shot
//   arrays   the pixels of its color, depth and result
//   written  the pixels of all targets, if they can be read
export function addShot({ data, files }, { name, method, aperture, rotated }, more, arrays, written) {
  const [width, height] = sizeOf({ method });
  const shot = { name, method, aperture, width, height, ...more };
  if (rotated) Object.assign(shot, { clockwise: CLOCKWISE, squeeze: SQUEEZE });
  for (const [what, array] of Object.entries(arrays)) {
    shot[what] = `${name}-${what}.${array.BYTES_PER_ELEMENT === 2 ? 'f16' : 'f32'}`;
    files[shot[what]] = base64(array);
  }
  if (written) {
    shot.written = `${name}.written`;
    files[shot.written] = base64(written);
  }
  data.shots.push(shot);
}

// Returns the lens as the shaders got it, in float32. valueOf(name) returns a uniform.
export function cameraOf(valueOf) {
  const value = (name) => Math.fround(valueOf(name));
  return {
    aperture_diameter: value('apertureDiameter'),
    focal_length: value('focalLength'),
    focus_distance: value('focusDistance'),
    sensor_height: value('sensorHeight'),
    max_coc: value('maxCoC'),
  };
}

// Runs the autofocus of a bokeh frame by frame. Returns its inputs and the focus distances.
//   focus()  returns the focus distance
//   points   [u, v] of each depth, in metres
export function pulledTo(bokeh, focus, points, depths) {
  const [frame, seconds, from, distances] = [1 / 30, 0.2, focus(), []];
  for (let i = 0; i < 12; i++) {
    bokeh.pullFocus(frame, depths, seconds);
    distances.push(focus());
  }
  return { frame, seconds, from, points: points.map((point, i) => [...point, depths[i]]), distances };
}

// Returns the debug views: { focus, maxCoC, depth, coc: rgba with the CoC in a, views: { 1: rgba, 2: rgba, 3: rgba } }.
//   drawn(mode)  resolves with a frame in debug mode 0 to 3: { depth, result: rgba, focus, maxCoC }
export async function viewsOf(drawn) {
  const found = { views: {} };
  for (const mode of [0, 1, 2, 3]) {
    const { depth, result, focus, maxCoC } = await drawn(mode);
    Object.assign(found, { focus, maxCoC, depth: base64(depth) });
    if (mode === 0) found.coc = base64(result);
    else found.views[mode] = base64(result);
  }
  return found;
}
