// Pictures with depth: those in the page, and files that are dropped onto it.

import { FloatType, HalfFloatType, RedFormat } from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { upsideDown } from "../../truth/peers/page/feed.js";

const WIDEST = 1920; // a PNG is made so wide at the most
const NEAREST = 1; // metres, of white in a depth PNG; black is FAR times as far
const FAR = 100;
const FOCAL = 0.05; // metres; a lens for pictures that come without
const STOP = 1.4;
const TOGETHER = [4, 8, 9]; // PIZ, DWAA, DWAB

// An image of one channel, as in job.js.
function single(size, values) {
  return { size, channels: 1, type: "float", data: values };
}

// { color, depth, truth } of a scene in the page.
export async function embedded(name) {
  const element = (kind) => document.getElementById(`${name} ${kind}`);
  const [pinhole, truth] = ["pinhole", "truth"].map((kind) => readExr(Uint8Array.fromBase64(element(kind).textContent).buffer));
  return { color: pinhole.color, depth: single(pinhole.size, pinhole.depth), truth: truth.color };
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
  try {
    if (/\.exr$/i.test(file.name)) return readExr(await file.arrayBuffer());
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
function depthOf({ size, depth, bytes }, expected) {
  if (size[0] !== expected[0] || size[1] !== expected[1]) {
    throw new Error(`depth is ${size.join(" x ")}, the picture ${expected.join(" x ")}`);
  }
  if (depth || !bytes) return depth;
  const metres = (byte) => NEAREST / (1 / FAR + (1 - 1 / FAR) * (byte / 255));
  return Float32Array.from({ length: size[0] * size[1] }, (_, i) => metres(bytes[4 * i]));
}

// { size, color: an image as in job.js, depth: Float32Array of channel Z or null } of an EXR. Throws an Error that says
// what it cannot read.
function readExr(buffer) {
  const bytes = new Uint8Array(buffer);
  const channels = channelsOf(bytes);
  const rgb = channels.filter(({ name }) => ["R", "G", "B", "A"].includes(name));
  if (rgb.length < 3) throw new Error(`no channels R G B; it has ${channels.map(({ name }) => name).join(" ") || "none"}`);
  if (new Set(rgb.map(({ type }) => type)).size > 1) throw new Error("R, G and B are of different types");
  if (channels.some(({ subsampled }) => subsampled)) throw new Error("a channel is subsampled");
  const z = channels.find(({ name }) => name === "Z");
  // the loader takes all channels of PIZ and DWA for one type, and of a PIZ with two it never comes back
  const together = TOGETHER.includes(bytes[attribute(bytes, "compression", "compression")]);
  if (together && channels.some(({ type }) => type !== rgb[0].type)) throw new Error("channels of two types; save it with ZIP");
  const half = rgb[0].type === 1;
  const picture = new EXRLoader().setDataType(half ? HalfFloatType : FloatType).parse(buffer);
  const size = [picture.width, picture.height];
  const color = { size, channels: 4, type: half ? "half" : "float", data: upsideDown(picture.data, picture) };
  if (!z) return { size, color, depth: null };
  // the loader reads colour or luminance, not depth: the same file with Y for Z, and no R G B
  const renamed = bytes.slice();
  for (const { name, at } of channels) if (name.length === 1) renamed[at] = (name === "Z" ? "Y" : "x").charCodeAt(0);
  const luminance = new EXRLoader().setDataType(FloatType).setOutputFormat(RedFormat).parse(renamed.buffer);
  return { size, color, depth: upsideDown(luminance.data, luminance) };
}

// Place of an attribute's value in the header.
function attribute(bytes, name, type) {
  const mark = `${name}\0${type}\0`;
  const begin = new TextDecoder("latin1").decode(bytes.subarray(0, 65536)).indexOf(mark);
  if (begin < 0) throw new Error("not an EXR file");
  return begin + mark.length + 4; // its length
}

// [{ name, type: 1 is half, subsampled, at: place of the name }]
function channelsOf(bytes) {
  const channels = [];
  let at = attribute(bytes, "channels", "chlist");
  while (bytes[at]) {
    const end = bytes.indexOf(0, at);
    const name = new TextDecoder().decode(bytes.subarray(at, end));
    channels.push({ name, type: bytes[end + 1], subsampled: bytes[end + 9] !== 1 || bytes[end + 13] !== 1, at });
    at = end + 17; // type, linearity, sampling
  }
  return channels;
}
