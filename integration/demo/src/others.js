// Depth of field by the libraries of three.js and pmndrs. They draw with a WebGL 2 context of their own, and the page
// gets a copy of their result.

import { upsideDown } from "@validation/lab/other_effects/page/feed.js";
import * as library from "@validation/lab/other_effects/page/three_webgl.js";

// Returns the circle of confusion (a diameter) at infinity, as a fraction of the image height.
const farCoC = ({ aperture, focal, focus, sensor }) => (aperture * focal) / ((focus - focal) * sensor);

// Effect -> function that returns its parameters for a thin lens. They follow the effect's documentation, and are
// multiplied by the factors that were best for the scene market_7.
const MAPPED = {
  // The effect's radius is 0.4 min(aperture |z - focus|, maxblur) image widths. `aperture` gives it the slope that the
  // lens has at the focus, and `maxblur` the limit that the lens has at infinity.
  BokehPass: (camera, [width, height]) => {
    const maxblur = (farCoC(camera) * height) / (0.8 * width);
    return { focus: camera.focus, aperture: (1.12 * maxblur) / camera.focus, maxblur: 0.7 * maxblur };
  },
  // focusRange is the distance from the focus, in metres, at which smoothstep reaches 1; bokehScale is the radius in
  // pixels
  DepthOfFieldEffect: (camera, [, height]) => {
    const lens = { focusDistance: camera.focus, focusRange: camera.focus, bokehScale: 0.175 * farCoC(camera) * height };
    return { ...lens, resolutionScale: 0.5 };
  },
};

const opened = new Map(); // name -> { pictures, effect }

// Draws an effect on the images `pictures`. camera is { aperture, focal, focus, sensor }, in metres. Returns an image
// in the form that job.js describes.
export async function draw(name, camera, pictures) {
  if (opened.get(name)?.pictures !== pictures) {
    opened.get(name)?.effect.close();
    opened.set(name, { pictures, effect: library[name](handed(camera, pictures)) });
  }
  const { effect } = opened.get(name);
  const { size } = pictures.color;
  effect.set(MAPPED[name](camera, size));
  effect.draw();
  return { size, format: "rgba16float", data: upsideDown(await effect.read(), { height: size[1] }) };
}

// Returns the scene in the form that the effects take, as in peers.js.
function handed({ focal, sensor }, { color, depth }) {
  let [near, far] = [Infinity, 0];
  for (const z of depth.data) if (z > 0 && z < 1e6) [near, far] = [Math.min(near, z), Math.max(far, z)];
  [near, far] = [0.5 * near, 1.01 * far];
  const metres = depth.data.map((z) => Math.min(Math.max(z, near), far));
  const [width, height] = color.size;
  return { width, height, color: color.data, depth: metres, near, far, fovy: 2 * Math.atan((0.5 * sensor) / focal) };
}
