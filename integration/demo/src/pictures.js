// Loads images with depth: the scenes of the page, and the user's own files. Images have the form that job.js
// describes.

import { FloatType, HalfFloatType, RedFormat } from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { upsideDown } from "@validation/lab/other_effects/page/feed.js";

const WIDEST = 1920; // pixels; a wider PNG is made smaller
const FAR = 100; // metres that black means in a depth image; white means 1 metre
// Name of a scene's file -> its address. If the page is one HTML file, the address contains the file.
const FILES = import.meta.glob("../data/*.exr", { query: "?url", import: "default", eager: true });
const TOGETHER = [4, 8, 9]; // numbers of the compressions PIZ, DWAA and DWAB

// Loads a scene of the page. Returns { color, depth, truth: null, loadTruth() }. The ray-traced image (truth) is as
// large as the input, so it is only loaded when it is needed.
export async function embedded(name) {
  const read = async (kind) => {
    const file = await fetch(FILES[`../data/${name}_${kind}.exr`]);
    return readExr(new Uint8Array(await file.arrayBuffer()));
  };
  return { ...(await read("pinhole")), truth: null, loadTruth: async () => (await read("truth")).color };
}

// Loads the user's files: an EXR with the channels R, G, B and Z, or two images, of which the one with a name such as
// depth.png is the depth (white is near). Returns { name, color, depth, truth: null, focal, focus, exposure }. Its lens
// is a default: 50 mm, focused on the middle of the image. Throws an Error with a message of one line.
export async function dropped(files) {
  const isDepth = (file) => /depth|disparity|_z\b/i.test(file.name);
  const file = files.find((file) => !isDepth(file)) ?? files[0];
  const other = files.find((second) => second !== file);
  const { color, depth } = await decoded(file);
  const metres = depth ?? (other && depthOf(await decoded(other)));
  if (!metres) throw new Error(`${file.name}: it has no depth. Open an EXR with a channel Z, or an image with its depth.png`);
  const [width, height] = color.size;
  if (`${metres.size}` !== `${color.size}`) {
    throw new Error(`depth is ${metres.size.join(" x ")}, but the image is ${width} x ${height} pixels`);
  }
  const middle = metres.data[(height >> 1) * width + (width >> 1)];
  const focus = Math.min(Math.max(middle || 5, 0.5), 64);
  const lens = { focal: 0.05, focus, exposure: 1 };
  return { name: file.name, color, depth: metres, truth: null, ...lens };
}

async function decoded(file) {
  try {
    if (/\.exr$/i.test(file.name)) return readExr(new Uint8Array(await file.arrayBuffer()));
    return await readPicture(file);
  } catch (error) {
    throw new Error(`${file.name}: ${error.message}`);
  }
}

// Reads a PNG, or another format that the browser knows, and converts it from sRGB to linear colour. Such an image has
// nothing brighter than white, and no depth.
async function readPicture(file) {
  const bitmap = await createImageBitmap(file, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const share = Math.min(1, WIDEST / bitmap.width);
  const size = [bitmap.width, bitmap.height].map((side) => Math.max(1, Math.round(side * share)));
  const context = new OffscreenCanvas(...size).getContext("2d");
  context.drawImage(bitmap, 0, 0, ...size);
  const bytes = context.getImageData(0, 0, ...size).data;
  const linear = (value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  const levels = Float32Array.from({ length: 256 }, (_, byte) => linear(byte / 255));
  const data = Float32Array.from(bytes, (byte, i) => (i % 4 === 3 ? 1 : levels[byte]));
  return { color: { size, format: "rgba32float", data }, depth: null, bytes };
}

// Returns the metres of a depth image: channel Z of an EXR, or grey levels, which are reciprocal depths.
function depthOf({ color: { size }, depth, bytes }) {
  if (!bytes) return depth;
  const metres = (byte) => 1 / (1 / FAR + (1 - 1 / FAR) * (byte / 255));
  const data = Float32Array.from({ length: size[0] * size[1] }, (_, i) => metres(bytes[4 * i]));
  return { size, format: "r32float", data };
}

// Reads an EXR. Returns { color, depth: metres of channel Z, or null }. Throws an Error that says what it cannot read.
function readExr(bytes) {
  const channels = channelsOf(bytes);
  const rgb = channels.filter(({ name }) => ["R", "G", "B", "A"].includes(name));
  const names = channels.map(({ name }) => name).join(" ") || "none";
  if (rgb.length < 3) throw new Error(`it needs the channels R G B, but has ${names}`);
  if (new Set(rgb.map(({ type }) => type)).size > 1) throw new Error("the channels R, G and B have different types");
  if (channels.some(({ subsampled }) => subsampled)) throw new Error("a channel is subsampled");
  // with PIZ and DWA, the loader assumes that all channels have the same type; for a PIZ with two types, it never
  // returns
  const together = TOGETHER.includes(bytes[attribute(bytes, "compression", "compression")]);
  if (together && channels.some(({ type }) => type !== rgb[0].type)) {
    throw new Error("its channels have different types. Save it with ZIP compression");
  }
  const half = rgb[0].type === 1;
  const picture = new EXRLoader().setDataType(half ? HalfFloatType : FloatType).parse(bytes.buffer);
  const size = [picture.width, picture.height];
  const color = { size, format: half ? "rgba16float" : "rgba32float", data: upsideDown(picture.data, picture) };
  if (channels.every(({ name }) => name !== "Z")) return { color, depth: null };
  // The loader reads colour or luminance, but not depth. So rename Z to Y, rename R, G and B too, and load the file
  // again.
  for (const { name, at } of channels) if (name.length === 1) bytes[at] = (name === "Z" ? "Y" : "x").charCodeAt(0);
  const luminance = new EXRLoader().setDataType(FloatType).setOutputFormat(RedFormat).parse(bytes.buffer);
  return { color, depth: { size, format: "r32float", data: upsideDown(luminance.data, luminance) } };
}

// Returns the position of an attribute's value in the header. Throws an Error if there is no such attribute.
function attribute(bytes, name, type) {
  const mark = `${name}\0${type}\0`;
  const begin = new TextDecoder("latin1").decode(bytes.subarray(0, 65536)).indexOf(mark);
  if (begin < 0) throw new Error("not an EXR file");
  return begin + mark.length + 4; // 4 bytes have the length of the value
}

// Returns [{ name, type (1 means half floats), subsampled, at: position of the name }].
function channelsOf(bytes) {
  const channels = [];
  let at = attribute(bytes, "channels", "chlist");
  while (bytes[at]) {
    const end = bytes.indexOf(0, at);
    const name = new TextDecoder().decode(bytes.subarray(at, end));
    channels.push({ name, type: bytes[end + 1], subsampled: bytes[end + 9] !== 1 || bytes[end + 13] !== 1, at });
    at = end + 17; // skip type, linearity and sampling
  }
  return channels;
}
