// Pictures with depth: those in the page, and EXR files of somebody's own.

import { FloatType, HalfFloatType, RedFormat } from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { upsideDown } from "../../truth/peers/page/feed.js";

const TOGETHER = [4, 8, 9]; // PIZ, DWAA, DWAB

// { color, depth, truth } of a scene in the page: images as in job.js.
export async function embedded(name) {
  const read = (kind) => readExr(Uint8Array.fromBase64(document.getElementById(`${name} ${kind}`).textContent));
  return { ...read("pinhole"), truth: read("truth").color };
}

// The same of a file, with a lens for what comes without. Throws an Error with one line.
export async function own(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  let picture = null;
  try {
    picture = readExr(bytes);
  } catch (error) {
    throw new Error(`${file.name}: ${error.message}`);
  }
  if (!picture.depth) throw new Error(`${file.name}: no depth. Give an EXR with a channel Z`);
  const [width, height] = picture.depth.size;
  const middle = picture.depth.data[(height >> 1) * width + (width >> 1)];
  const focus = Math.min(Math.max(middle || 5, 0.5), 64);
  return { name: file.name, ...picture, truth: null, stop: 1.4, focal: 0.05, focus, exposure: 1, rotation: 0 };
}

// { color, depth: metres of channel Z, or null } of an EXR. Throws an Error that says what it cannot read.
function readExr(bytes) {
  const channels = channelsOf(bytes);
  const rgb = channels.filter(({ name }) => ["R", "G", "B", "A"].includes(name));
  if (rgb.length < 3) throw new Error(`no channels R G B; it has ${channels.map(({ name }) => name).join(" ") || "none"}`);
  if (new Set(rgb.map(({ type }) => type)).size > 1) throw new Error("R, G and B are of different types");
  // the loader takes all channels of PIZ and DWA for one type, and of a PIZ with two it never comes back
  const together = TOGETHER.includes(bytes[attribute(bytes, "compression", "compression")]);
  if (together && channels.some(({ type }) => type !== rgb[0].type)) throw new Error("channels of two types; save it with ZIP");
  const half = rgb[0].type === 1;
  const picture = new EXRLoader().setDataType(half ? HalfFloatType : FloatType).parse(bytes.buffer);
  const size = [picture.width, picture.height];
  const color = { size, format: half ? "rgba16float" : "rgba32float", data: upsideDown(picture.data, picture) };
  if (channels.every(({ name }) => name !== "Z")) return { color, depth: null };
  // the loader reads colour or luminance, not depth: the same file with Y for Z, and no R G B
  for (const { name, at } of channels) if (name.length === 1) bytes[at] = (name === "Z" ? "Y" : "x").charCodeAt(0);
  const luminance = new EXRLoader().setDataType(FloatType).setOutputFormat(RedFormat).parse(bytes.buffer);
  return { color, depth: { size, format: "r32float", data: upsideDown(luminance.data, luminance) } };
}

// Place of an attribute's value in the header.
function attribute(bytes, name, type) {
  const mark = `${name}\0${type}\0`;
  const begin = new TextDecoder("latin1").decode(bytes.subarray(0, 65536)).indexOf(mark);
  if (begin < 0) throw new Error("not an EXR file");
  return begin + mark.length + 4; // its length
}

// [{ name, type: 1 is half, at: place of the name }]
function channelsOf(bytes) {
  const channels = [];
  let at = attribute(bytes, "channels", "chlist");
  while (bytes[at]) {
    const end = bytes.indexOf(0, at);
    channels.push({ name: new TextDecoder().decode(bytes.subarray(at, end)), type: bytes[end + 1], at });
    at = end + 17; // type, linearity, sampling
  }
  return channels;
}
