// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the page's data: a JSON directory and one base64 text of little-endian arrays (see scene_payload.h).

const TYPES = {
  u8: Uint8Array, i8: Int8Array, u16: Uint16Array, i16: Int16Array, i32: Int32Array, f32: Float32Array,
};

function decode(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

/// The scene with every {type, offset, count} replaced by its typed array.
export function readScene(document) {
  const scene = JSON.parse(document.getElementById('scene').textContent);
  const buffer = decode(document.getElementById('scene-data').textContent);
  const resolve = (value) => {
    if (Array.isArray(value) || value === null || typeof value !== 'object') return value;
    if ('offset' in value && 'type' in value) return new TYPES[value.type](buffer, value.offset, value.count);
    return Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, resolve(inner)]));
  };
  return resolve(scene);
}

/// Position k of a quantised set, written into `out` (three numbers).
export function place(set, k, out) {
  for (let c = 0; c < 3; ++c) out[c] = set.lo[c] + set.step[c] * set.data[3 * k + c];
  return out;
}
