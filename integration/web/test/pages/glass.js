// What three.test.js asks of the sample glass.js.

import { composer } from '/integration/threejs/glass.js';
import { composer as plain, renderer } from '/integration/threejs/webgl.js';

const BOX = [370, 178, 24, 16]; // the box's left edge, seen through the ball: left, bottom, width, height

// The largest step between neighbouring pixels of a row of the box's edge, of 255
function step(chain) {
  chain.render();
  const gl = renderer.getContext();
  const [x, y, width, height] = BOX;
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(x, y, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const green = Array.from({ length: width }, (_, i) => pixels[4 * (width * (height >> 1) + i) + 1]);
  return Math.max(...green.slice(1).map((value, i) => Math.abs(value - green[i])));
}

window.bokeh = { steps: () => ({ weighted: step(composer), plain: step(plain) }) };
