// OpenEXR, as far as renderers write it for one picture: scanlines, uncompressed or ZIP, half and float channels.

const MAGIC = 20000630;
const NOT_SCANLINES = 0x200 | 0x800 | 0x1000; // tiled, deep, several parts
const LINES = { 0: 1, 2: 1, 3: 16 }; // compression -> lines of a chunk: none, ZIPS, ZIP
const TYPES = { 1: Uint16Array, 2: Float32Array }; // half floats as their 16 bits
const ONE = { 1: 0x3c00, 2: 1 };

// { size: [width, height], color: an image of 4 channels as in job.js, depth: Float32Array or null } of a file.
// Channels are R, G, B and Z, of any layer. Throws an Error that says what it cannot read.
export async function readExr(bytes) {
  const { header, at } = parsed(bytes);
  const [left, top, right, bottom] = header.dataWindow;
  const size = [right - left + 1, bottom - top + 1];
  const find = (letter) => header.channels.find(({ name }) => name.split(".").at(-1) === letter);
  const wanted = ["R", "G", "B"].map(find);
  if (wanted.includes(undefined)) throw new Error(`no channels R G B; it has ${names(header)}`);
  const kind = wanted[0].type;
  const z = find("Z") ?? null;
  for (const one of [...wanted, ...(z ? [z] : [])]) {
    if (!TYPES[one.type]) throw new Error(`channel ${one.name} holds integers`);
  }
  if (wanted.some(({ type }) => type !== kind)) throw new Error("R, G and B are of different types");
  const color = new TYPES[kind](size[0] * size[1] * 4).fill(ONE[kind]);
  const depth = z && new Float32Array(size[0] * size[1]);
  const place = ({ name }) => wanted.findIndex((one) => one.name === name);
  await eachLine(bytes, at, header, size, (y, channel, values) => {
    const first = (y - top) * size[0];
    const index = place(channel);
    if (index >= 0) for (let x = 0; x < size[0]; x++) color[4 * (first + x) + index] = values[x];
    if (channel === z) for (let x = 0; x < size[0]; x++) depth[first + x] = z.type === 1 ? unhalf(values[x]) : values[x];
  });
  return { size, color: { size, channels: 4, type: kind === 1 ? "half" : "float", data: color }, depth };
}

function names({ channels }) {
  return channels.map(({ name }) => name).join(" ");
}

// The attributes that matter, and where the pixels begin.
function parsed(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 8 || view.getInt32(0, true) !== MAGIC) throw new Error("not an EXR file");
  if (view.getInt32(4, true) & NOT_SCANLINES) throw new Error("tiles, deep pixels and several parts are not read here");
  let at = 8;
  const text = () => {
    const end = bytes.indexOf(0, at);
    const found = new TextDecoder().decode(bytes.subarray(at, end));
    at = end + 1;
    return found;
  };
  const header = {};
  for (let name = text(); name; name = text()) {
    text(); // its type
    const length = view.getInt32(at, true);
    const begin = (at += 4);
    if (name === "dataWindow") header[name] = [0, 4, 8, 12].map((step) => view.getInt32(begin + step, true));
    if (name === "compression") header[name] = bytes[begin];
    if (name === "channels") {
      header.channels = [];
      for (let channel = text(); channel; channel = text()) {
        header.channels.push({ name: channel, type: view.getInt32(at, true) });
        if (view.getInt32(at + 8, true) !== 1 || view.getInt32(at + 12, true) !== 1) {
          throw new Error(`channel ${channel} is subsampled`);
        }
        at += 16;
      }
    }
    at = begin + length;
  }
  if (!(header.compression in LINES)) throw new Error("its compression is not read here; save it with ZIP or with none");
  return { header, at };
}

// Calls found(y, channel, values) for every line of every channel.
async function eachLine(bytes, at, { channels, compression, dataWindow }, [width, height], found) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [, top] = dataWindow;
  const lines = LINES[compression];
  const pitch = channels.reduce((sum, { type }) => sum + width * (type === 1 ? 2 : 4), 0);
  const chunks = Math.ceil(height / lines);
  await Promise.all(
    Array.from({ length: chunks }, async (_, index) => {
      const begin = Number(view.getBigUint64(at + 8 * index, true));
      const y = view.getInt32(begin, true);
      const count = Math.min(lines, top + height - y);
      const packed = bytes.subarray(begin + 8, begin + 8 + view.getInt32(begin + 4, true));
      // what does not get smaller is stored as it is
      const data = packed.length === pitch * count ? packed.slice() : await unzipped(packed);
      if (data.length !== pitch * count) throw new Error("a chunk has another length than its lines");
      let place = 0;
      for (let line = y; line < y + count; line++) {
        for (const channel of channels) {
          const length = width * (channel.type === 1 ? 2 : 4);
          const part = data.slice(place, place + length);
          if (TYPES[channel.type]) found(line, channel, new TYPES[channel.type](part.buffer));
          place += length;
        }
      }
    }),
  );
}

// Deflate, then differences of bytes, of which the even ones come first.
async function unzipped(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  for (let i = 1; i < bytes.length; i++) bytes[i] += bytes[i - 1] - 128;
  const data = new Uint8Array(bytes.length);
  const half = (bytes.length + 1) >> 1;
  for (let i = 0; i < bytes.length; i++) data[i] = bytes[(i & 1 ? half : 0) + (i >> 1)];
  return data;
}

// The number of the 16 bits of a half float.
export function unhalf(bits) {
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  const sign = bits & 0x8000 ? -1 : 1;
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  return sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction);
}
