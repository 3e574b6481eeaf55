// Hands a scene to an engine: a quad over the whole image that writes the scene's colour, and its depth as the engine's
// camera would have left it. The order of rows is reversed, so that the image is upright.

export const VERTEX = `
varying vec2 peerAt;
void main()
{
    peerAt = position.xy * 0.5 + 0.5;
    gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

export const FEED = `
varying vec2 peerAt;
uniform sampler2D peerColor, peerDepth;
uniform float peerNear, peerFar;
vec4 peerLight() { return texture2D(peerColor, vec2(peerAt.x, 1.0 - peerAt.y)); }
float peerMetres() { return texture2D(peerDepth, vec2(peerAt.x, 1.0 - peerAt.y)).r; }
float peerWindow() { return peerFar * (peerMetres() - peerNear) / (peerMetres() * (peerFar - peerNear)); }
`;

// A canvas of the scene's size
export function canvasOf({ width, height }) {
  return Object.assign(document.createElement("canvas"), { width, height });
}

// Rows in the opposite order; rows begin with the first as they come from Python, with the last in WebGL
export function upsideDown(data, { height }) {
  const turned = new data.constructor(data.length);
  const row = data.length / height;
  for (let y = 0; y < height; y++) turned.set(data.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
  return turned;
}

export const degrees = ({ fovy }) => (fovy * 180) / Math.PI;
