// What the pages share: images as they travel between Python and the page.
//
//   { size: [width, height], channels: 4 | 1, type: "half" | "float", data }
//
// `data` is the raw rows, first row first, nothing between the rows, in base64 or as the array of its elements; a target
// has none.

const ARRAYS = { half: Uint16Array, float: Float32Array };

// Room for the elements of an image; half floats as their 16 bits.
export function elements({ size: [width, height], channels, type }) {
  return new ARRAYS[type](width * height * channels);
}

export function decode({ type, data }) {
  return typeof data === "string" ? new ARRAYS[type](Uint8Array.fromBase64(data).buffer) : data;
}

export function encode({ size, channels, type }, elements) {
  return { size, channels, type, data: new Uint8Array(elements.buffer).toBase64() };
}

// Bytes of a row.
export function pitch({ size, channels, type }) {
  return size[0] * channels * ARRAYS[type].BYTES_PER_ELEMENT;
}
