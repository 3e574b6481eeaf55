// Pictures with depth: those in the page, and files that are dropped onto it.

import { readExr } from "./exr.js";

const WIDEST = 1920; // a PNG is made so wide at the most
const NEAREST = 1; // metres, of white in a depth PNG; black is FAR times as far
const FAR = 100;
const FOCAL = 0.05; // metres; a lens for pictures that come without
const STOP = 1.4;

// An image of one channel, as in job.js.
function single(size, values) {
  return { size, channels: 1, type: "float", data: values };
}

// { color, depth, truth, meters } of a scene in the page.
export async function embedded(name) {
  const element = (kind) => document.getElementById(`${name} ${kind}`);
  const unpacked = async (kind) => {
    const answer = await fetch(`data:application/octet-stream;base64,${element(kind).textContent}`);
    return readExr(new Uint8Array(await answer.arrayBuffer()));
  };
  const [pinhole, truth] = await Promise.all(["pinhole", "truth"].map(unpacked));
  const depth = single(pinhole.size, pinhole.depth);
  return { color: pinhole.color, depth, truth: truth.color };
}

// The same of files: an EXR with R G B Z, or two pictures, the one whose name has "depth" in it being depth (white is
// near). Throws an Error with one line.
export async function dropped(files) {
  const isDepth = (file) => /depth|disparity|_z\b/i.test(file.name);
  const first = files.find((file) => !isDepth(file)) ?? files[0];
  const other = files.find((file) => file !== first);
  const color = await decoded(first);
  const depth = color.depth ?? (other && depthOf(await decoded(other), color.size));
  if (!depth) throw new Error(`${first.name}: no depth. Drop an EXR with a channel Z, or a picture and its depth.png`);
  const [width, height] = color.size;
  const middle = depth[(height >> 1) * width + (width >> 1)];
  const lens = { stop: STOP, focal: FOCAL, focus: Math.min(Math.max(middle || 5, 0.5), 64), exposure: 1, rotation: 0 };
  return { name: first.name, color: color.color, depth: single(color.size, depth), truth: null, ...lens };
}

async function decoded(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  try {
    if (/\.exr$/i.test(file.name)) return await readExr(bytes);
    return await readPicture(file);
  } catch (error) {
    throw new Error(`${file.name}: ${error.message}`);
  }
}

// A PNG or whatever the browser reads: sRGB made linear. It has no light beyond white.
async function readPicture(file) {
  const options = { colorSpaceConversion: "none", premultiplyAlpha: "none" };
  const bitmap = await createImageBitmap(file, options);
  const share = Math.min(1, WIDEST / bitmap.width);
  const size = [bitmap.width, bitmap.height].map((side) => Math.max(1, Math.round(side * share)));
  const context = new OffscreenCanvas(...size).getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0, ...size);
  const bytes = context.getImageData(0, 0, ...size).data;
  const linear = Float32Array.from({ length: 256 }, (_, byte) => {
    const value = byte / 255;
    return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  });
  const data = new Float32Array(bytes.length);
  for (let i = 0; i < bytes.length; i++) data[i] = (i & 3) === 3 ? 1 : linear[bytes[i]];
  return { size, color: { size, channels: 4, type: "float", data }, depth: null, bytes };
}

// Metres of a depth picture: the Z of an EXR, or grey levels as reciprocal depth.
function depthOf({ size, depth, bytes }, wanted) {
  if (size[0] !== wanted[0] || size[1] !== wanted[1]) {
    throw new Error(`depth is ${size.join(" x ")}, the picture ${wanted.join(" x ")}`);
  }
  if (depth || !bytes) return depth;
  const metres = (byte) => NEAREST / (1 / FAR + (1 - 1 / FAR) * (byte / 255));
  return Float32Array.from({ length: size[0] * size[1] }, (_, i) => metres(bytes[4 * i]));
}
