// What the pages share: images as they travel between Python and the page: { size: [width, height], format, data }. `data`
// is the raw rows, first row first, nothing between them, in base64 or as the array of its elements; a target has none.

// WebGPU's name of a format -> array of its elements (half floats as their 16 bits), how many a texel has
const FORMATS = { rgba16float: [Uint16Array, 4], rgba32float: [Float32Array, 4], r32float: [Float32Array, 1] };

// Room for the elements of an image.
export function elements({ size: [width, height], format }) {
  const [Elements, channels] = FORMATS[format];
  return new Elements(width * height * channels);
}

export function decode({ format, data }) {
  return typeof data === "string" ? new FORMATS[format][0](Uint8Array.fromBase64(data).buffer) : data;
}

export function encode({ size, format }, elements) {
  return { size, format, data: new Uint8Array(elements.buffer).toBase64() };
}
