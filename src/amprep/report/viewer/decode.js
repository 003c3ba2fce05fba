// Decodes the geometry that amprep.report.page.geometry encodes.

export async function inflate(base64) {
  const binary = atob(base64.trim());
  const packed = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) packed[i] = binary.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// mesh: {offset, vertices, triangles, low: [x, y, z], high: [x, y, z]}
export function decodeMesh(bytes, mesh) {
  const positions = decodePositions(bytes, mesh);
  const start = mesh.offset + 6 * mesh.vertices;
  return { positions, indices: decodeIndices(bytes, start, 3 * mesh.triangles) };
}

function decodePositions(bytes, { offset, vertices, low, high }) {
  const positions = new Float32Array(3 * vertices);
  for (let axis = 0; axis < 3; axis++) {
    const small = offset + 2 * axis * vertices;
    const scale = (high[axis] - low[axis]) / 65535;
    let value = 0;
    for (let i = 0; i < vertices; i++) {
      value = (value + bytes[small + i] + (bytes[small + vertices + i] << 8)) & 0xffff;
      positions[3 * i + axis] = low[axis] + scale * value;
    }
  }
  return positions;
}

function decodeIndices(bytes, start, count) {
  const indices = new Uint32Array(count);
  let value = 0;
  for (let i = 0; i < count; i++) {
    const folded =
      (bytes[start + i] |
        (bytes[start + count + i] << 8) |
        (bytes[start + 2 * count + i] << 16) |
        (bytes[start + 3 * count + i] << 24)) >>> 0;
    value += (folded >>> 1) ^ -(folded & 1);
    indices[i] = value;
  }
  return indices;
}
