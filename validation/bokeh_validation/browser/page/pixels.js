// Pixels as they travel between Python and the page: base64 of the raw rows, first row first, nothing between the rows.
//
//   { width, height, channels: 4 | 2 | 1, type: "half" | "float", data }

export const BYTES = { half: 2, float: 4 };

const ARRAYS = { half: Uint16Array, float: Float32Array };

// Elements of a job's texture; half floats as their 16 bits.
export function decode(pixels) {
  return new ARRAYS[pixels.type](Uint8Array.fromBase64(pixels.data).buffer);
}

// What decode() takes, for one target.
export function encode([width, height], channels, type, elements) {
  const bytes = new Uint8Array(elements.buffer, elements.byteOffset, elements.byteLength);
  return { width, height, channels, type, data: bytes.toBase64() };
}

// Room for one image.
export function elements([width, height], channels, type) {
  return new ARRAYS[type](width * height * channels);
}
