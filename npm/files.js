// Files of images and arrays, in browsers and in Node.

const TYPES = [
  ['<f4', Float32Array],
  ['<f8', Float64Array],
];
const MAGIC = [0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59];

/** An NPY file (version 1.0) of an array of 32-bit or 64-bit floats, the last axis of `shape` fastest. */
export function npy(values, shape) {
  const [type] = TYPES.find(([, Type]) => values instanceof Type) ?? [];
  if (!type) throw new TypeError('values are a Float32Array or a Float64Array');
  if (values.length !== shape.reduce((product, n) => product * n, 1)) {
    throw new TypeError(`${values.length} values are not those of the shape (${shape.join(', ')})`);
  }
  const text = `{'descr': '${type}', 'fortran_order': False, 'shape': (${shape.map((n) => `${n},`).join(' ')}), }`;
  const length = Math.ceil((text.length + 11) / 64) * 64 - 10;
  const header = [...MAGIC, 1, 0, length & 255, length >> 8, ...ascii(`${text.padEnd(length - 1)}\n`)];
  return joined([header, new Uint8Array(values.buffer, values.byteOffset, values.byteLength)]);
}

/** The values and the shape of an NPY file of 32-bit or 64-bit floats. */
export function readNpy(bytes) {
  const file = ArrayBuffer.isView(bytes)
    ? new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength)
    : new Uint8Array(bytes);
  if (file.length < 12 || MAGIC.some((code, k) => file[k] !== code)) throw new TypeError('not an NPY file');
  const [first, length] =
    file[6] === 1 ? [10, file[8] + 256 * file[9]] : [12, new DataView(file.buffer, file.byteOffset).getUint32(8, true)];
  const header = String.fromCharCode(...file.subarray(first, Math.min(first + length, first + 4096)));
  const type = /'descr': *'([^']*)'/.exec(header)?.[1];
  const [, Type] = TYPES.find(([name]) => name === type) ?? [];
  if (!Type) throw new TypeError(`an NPY file of the type ${type}, and not of <f4 or <f8`);
  if (!/'fortran_order': *False/.test(header)) throw new TypeError('an NPY file in the order of Fortran');
  const shape = (/'shape': *\(([^)]*)\)/.exec(header)?.[1].match(/\d+/g) ?? []).map(Number);
  const count = shape.reduce((product, n) => product * n, 1);
  const rest = file.length - first - length;
  if (rest !== count * Type.BYTES_PER_ELEMENT) {
    throw new TypeError(`an NPY file of the shape (${shape.join(', ')}) with ${Math.max(rest, 0)} bytes of values`);
  }
  const at = file.byteOffset + first + length;
  return { values: new Type(file.buffer.slice(at, at + rest)), shape };
}

/** A PNG file of 8-bit codes, RGB or RGBA, top row first. It is not compressed. */
export function png(codes, width, height) {
  const channels = codes.length / (width * height);
  if (channels !== 3 && channels !== 4) {
    throw new TypeError(`${codes.length} codes are not ${width} × ${height} pixels of 3 or 4 channels`);
  }
  const rows = new Uint8Array(height * (1 + channels * width));
  for (let y = 0; y < height; y++) {
    rows.set(codes.subarray(channels * width * y, channels * width * (y + 1)), y * (1 + channels * width) + 1);
  }
  const head = [...word(width), ...word(height), 8, channels === 3 ? 2 : 6, 0, 0, 0];
  return joined([
    [0x89, ...ascii('PNG\r\n\x1a\n')],
    chunk('IHDR', Uint8Array.from(head)),
    chunk('IDAT', stored(rows)),
    chunk('IEND', new Uint8Array()),
  ]);
}

/** A stream of zlib that is not compressed. */
function stored(bytes) {
  const parts = [[0x78, 1]];
  for (let at = 0; at < bytes.length; at += 65535) {
    const part = bytes.subarray(at, at + 65535);
    const size = [part.length & 255, part.length >> 8];
    parts.push([at + 65535 >= bytes.length ? 1 : 0, ...size, ...size.map((code) => code ^ 255)], part);
  }
  let [a, b] = [1, 0];
  for (const byte of bytes) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  return joined([...parts, word(b * 65536 + a)]);
}

function chunk(kind, data) {
  const checked = joined([ascii(kind), data]);
  let rest = ~0;
  for (const byte of checked) rest = CRC[(rest ^ byte) & 255] ^ (rest >>> 8);
  return joined([word(data.length), checked, word(~rest >>> 0)]);
}

const CRC = Int32Array.from({ length: 256 }, (_, byte) => {
  let rest = byte;
  for (let bit = 0; bit < 8; bit++) rest = rest & 1 ? (rest >>> 1) ^ 0xedb88320 : rest >>> 1;
  return rest;
});

const ascii = (text) => [...text].map((letter) => letter.charCodeAt(0));
const word = (value) => [24, 16, 8, 0].map((bits) => (value >>> bits) & 255);

function joined(parts) {
  const whole = new Uint8Array(parts.reduce((length, part) => length + part.length, 0));
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}
