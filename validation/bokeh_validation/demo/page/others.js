// Depth of field by three.js's and pmndrs' own libraries, which the page holds packed. They draw on WebGL 2, apart from
// the page, and what they drew is handed over.

import { MAPPED } from "../../truth/peers/page/lens.js";

let library = null; // promise of peers/page/three_webgl.js
const opened = new Map(); // name -> { pictures, effect }

// Modules from the text that the page holds: each is imported by those behind it
async function load() {
  const packed = document.getElementById("others").textContent;
  const answer = await fetch(`data:application/octet-stream;base64,${packed}`);
  const files = await new Response(answer.body.pipeThrough(new DecompressionStream("gzip"))).json();
  const places = {};
  for (const [name, text] of files) {
    const found = text.replace(/"bokeh\/([\w.]+)"/g, (_, imported) => `"${places[imported]}"`);
    places[name] = URL.createObjectURL(new Blob([found], { type: "text/javascript" }));
  }
  return import(places["three_webgl.js"]);
}

// The image as job.js has it, and milliseconds, of an effect on pictures; others: what the page was told of it
export async function draw(name, { factors, options }, camera, pictures) {
  library ??= load();
  const made = await library;
  if (opened.get(name)?.pictures !== pictures) {
    opened.get(name)?.effect.close();
    opened.set(name, { pictures, effect: made[name](handed(camera, pictures)) });
  }
  const { effect } = opened.get(name);
  const { size } = pictures.color;
  const parameters = MAPPED[name](camera, size);
  for (const [one, factor] of Object.entries(factors)) parameters[one] *= factor;
  effect.set({ ...parameters, ...options });
  const before = performance.now();
  effect.draw();
  const read = await effect.read();
  const milliseconds = performance.now() - before;
  const data = new Uint16Array(read.length);
  const row = 4 * size[0];
  for (let y = 0; y < size[1]; y++) data.set(read.subarray(y * row, (y + 1) * row), (size[1] - 1 - y) * row);
  return { image: { size, channels: 4, type: "half", data }, milliseconds };
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
