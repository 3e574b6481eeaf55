// Depth of field by three.js's and pmndrs' own libraries. They draw on WebGL 2, apart from the page, and what they drew is
// handed over.

import { upsideDown } from "@validation/lab/other_effects/page/feed.js";
import * as library from "@validation/lab/other_effects/page/three_webgl.js";

// Circle of confusion at infinity, a diameter, over the image height
const farCoC = ({ aperture, focal, focus, sensor }) => (aperture * focal) / ((focus - focal) * sensor);

// How a thin lens is told to each effect: as its documentation has it, times what was best for market_7
const MAPPED = {
  // The radius is 0.4 min(aperture |z - focus|, maxblur) image widths: the slope is the lens's at the focus, the limit the
  // lens's at infinity
  BokehPass: (camera, [width, height]) => {
    const maxblur = (farCoC(camera) * height) / (0.8 * width);
    return { focus: camera.focus, aperture: (1.12 * maxblur) / camera.focus, maxblur: 0.7 * maxblur };
  },
  // focusRange: metres off the focus at which smoothstep is 1; bokehScale: the radius in pixels
  DepthOfFieldEffect: (camera, [, height]) => {
    const lens = { focusDistance: camera.focus, focusRange: camera.focus, bokehScale: 0.175 * farCoC(camera) * height };
    return { ...lens, resolutionScale: 0.5 };
  },
};

const opened = new Map(); // name -> { pictures, effect }

// The image, as job.js has it, of an effect on pictures; camera: { aperture, focal, focus, sensor }, metres
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

// As peers.js hands a scene over
function handed({ focal, sensor }, { color, depth }) {
  let [near, far] = [Infinity, 0];
  for (const z of depth.data) if (z > 0 && z < 1e6) [near, far] = [Math.min(near, z), Math.max(far, z)];
  [near, far] = [0.5 * near, 1.01 * far];
  const metres = depth.data.map((z) => Math.min(Math.max(z, near), far));
  const [width, height] = color.size;
  return { width, height, color: color.data, depth: metres, near, far, fovy: 2 * Math.atan((0.5 * sensor) / focal) };
}
