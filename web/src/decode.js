// From the arrays of the block, as FORMAT.md describes them, to numbers.

const bytes_of = { u8: 1, u16: 2, u32: 4, f32: 4 };

/** Undoes the difference between frames in place; the element type wraps around as the format asks. */
export function undelta(q, frame) {
  for (let k = frame; k < q.length; ++k) q[k] += q[k - frame];
  return q;
}

function low_and_high_bytes(block, offset, count) {
  const q = new Uint16Array(count);
  for (let k = 0; k < count; ++k) q[k] = block[offset + k] | (block[offset + count + k] << 8);
  return q;
}

/** The stored integers (or floats) of an array, delta undone. Throws if the block is too short for it. */
export function stored(block, array) {
  const { offset, type, count } = array;
  if (!(type in bytes_of)) throw new Error(`array of unknown type ${type}`);
  const end = offset + count * bytes_of[type];
  if (end > block.length) throw new Error(`array ends at byte ${end}, the block at ${block.length}`);
  let q;
  if (type === "u16") q = low_and_high_bytes(block, offset, count);
  else if (type === "u8") q = block.slice(offset, end);
  else q = new (type === "u32" ? Uint32Array : Float32Array)(block.slice(offset, end).buffer);
  return array.delta ? undelta(q, array.delta) : q;
}

/** Bytes of a base64 text; white space in it is ignored. */
export function from_base64(text) {
  const newer = /** @type {any} */ (Uint8Array);
  if (newer.fromBase64) return newer.fromBase64(text);
  const chars = atob(text);
  const bytes = new Uint8Array(chars.length);
  for (let k = 0; k < chars.length; ++k) bytes[k] = chars.charCodeAt(k);
  return bytes;
}

/** Inflates a gzip stream. Throws if the browser cannot. */
export async function inflate(bytes) {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser cannot unpack the page. Chrome and Edge 80, Firefox 113 and Safari 16.4 or newer can.");
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
