// The page with which three.test.js tests the sample glass.js.

import { composer } from '/integration/threejs/glass.js';
import { composer as plain, renderer } from '/integration/threejs/webgl.js';

// [left, bottom, width, height] in pixels, around the left edge of the box, which is seen through the ball
const BOX = [370, 178, 24, 16];

// Returns the largest difference between neighbouring pixels in a row across the edge of the box, 0 to 255.
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
