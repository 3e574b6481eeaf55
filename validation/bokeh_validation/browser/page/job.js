// What the pages share: pixels as they travel between Python and the page, and the way through a job.
//
// Pixels are base64 of the raw rows, first row first, nothing between the rows:
//
//   { width, height, channels: 4 | 1, type: "half" | "float", data }

export const BYTES = { half: 2, float: 4 };

const ARRAYS = { half: Uint16Array, float: Float32Array };

// Elements of a job's texture; half floats as their 16 bits.
export function decode(pixels) {
  return new ARRAYS[pixels.type](Uint8Array.fromBase64(pixels.data).buffer);
}

// What decode() takes, for one target.
export function encode([width, height], type, elements) {
  const bytes = new Uint8Array(elements.buffer, elements.byteOffset, elements.byteLength);
  return { width, height, channels: 4, type, data: bytes.toBase64() };
}

// Room for one target.
export function elements([width, height], type) {
  return new ARRAYS[type](width * height * 4);
}

// Upload the textures of a job and draw its passes; return all textures by name, as { texture, size }.
// `made` takes every texture: a later one may have the name of an earlier one.
export function walk({ textures, passes }, made, { upload, target, draw }) {
  const live = new Map();
  const add = (texture) => made[made.push(texture) - 1];
  for (const [name, pixels] of Object.entries(textures)) live.set(name, { texture: add(upload(pixels)) });
  passes.forEach((pass, index) => {
    const { size, outputs } = pass;
    const targets = outputs.map(({ name, over }) => (over ? live.get(name) : { texture: add(target(size)), size }));
    const reading = Object.entries(pass.inputs);
    const inputs = new Map(reading.map(([slot, { texture, linear }]) => [slot, { ...live.get(texture), linear }]));
    draw(pass, inputs, targets.map(({ texture }) => texture), index);
    pass.outputs.forEach(({ name }, output) => live.set(name, targets[output]));
  });
  return live;
}
