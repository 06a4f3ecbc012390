// Reads pictures as {width, height, pixels}, with one byte for each of red, green and blue.
import {inflateSync} from 'node:zlib';

/// Reads a PNG file of 8 bits a channel, without alpha and interlacing, as the goldens are.
export function readPng(file) {
  const parts = [];
  let width, height;
  for (let at = 8; at < file.length;) {
    const size = file.readUInt32BE(at), type = file.toString('latin1', at + 4, at + 8), body = file.subarray(at + 8, at + 8 + size);
    if (type === 'IHDR') {
      [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
      if (body.subarray(8).toString('hex') !== '0802000000') throw new Error('a PNG of another kind');
    }
    if (type === 'IDAT') parts.push(body);
    at += size + 12;
  }
  const lines = inflateSync(Buffer.concat(parts)), row = 3 * width, pixels = new Uint8Array(row * height);
  for (let y = 0; y < height; ++y) {
    const filter = lines[y * (row + 1)];
    for (let x = 0; x < row; ++x) {
      const left = x < 3 ? 0 : pixels[y * row + x - 3], above = y ? pixels[(y - 1) * row + x] : 0;
      const corner = x < 3 || !y ? 0 : pixels[(y - 1) * row + x - 3], by = left + above - corner;
      const [a, b, c] = [left, above, corner].map(value => Math.abs(by - value));
      const paeth = a <= b && a <= c ? left : b <= c ? above : corner;
      pixels[y * row + x] = lines[y * (row + 1) + 1 + x] + [0, left, above, (left + above) >> 1, paeth][filter];
    }
  }
  return {width, height, pixels};
}

/// Reads a PPM file of 8 bits a channel: binary, or decimal numbers.
export function readPpm(file) {
  const [head, kind, width, height] = /^P([36])\s+(\d+)\s+(\d+)\s+255\s/.exec(Buffer.from(file.subarray(0, 40)).toString('latin1'));
  const body = file.subarray(head.length);
  const pixels = kind === '6' ? body : Uint8Array.from(Buffer.from(body).toString('latin1').trim().split(/\s+/), Number);
  return {width: Number(width), height: Number(height), pixels};
}
