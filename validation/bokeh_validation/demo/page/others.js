// Depth of field by three.js's and pmndrs' own libraries. They draw on WebGL 2, apart from the page, and what they drew is
// handed over.

import { upsideDown } from "../../truth/peers/page/feed.js";
import { MAPPED } from "../../truth/peers/page/lens.js";
import * as library from "../../truth/peers/page/three_webgl.js";

const opened = new Map(); // name -> { pictures, effect }

// { image as job.js has it, milliseconds } of an effect on pictures; the second argument is what the page has of it
export async function draw(name, { factors, options }, camera, pictures) {
  if (opened.get(name)?.pictures !== pictures) {
    opened.get(name)?.effect.close();
    opened.set(name, { pictures, effect: library[name](handed(camera, pictures)) });
  }
  const { effect } = opened.get(name);
  const { size } = pictures.color;
  const parameters = MAPPED[name](camera, size);
  for (const [parameter, factor] of Object.entries(factors)) parameters[parameter] *= factor;
  effect.set({ ...parameters, ...options });
  const before = performance.now();
  effect.draw();
  const rows = await effect.read();
  const milliseconds = performance.now() - before;
  return { image: { size, channels: 4, type: "half", data: upsideDown(rows, { height: size[1] }) }, milliseconds };
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
