// Makes the three.js objects of a build: parts, supports, bounding volumes, and marks on findings.
import * as THREE from "three";
import { decodeMesh } from "./decode.js";

const CREASE_DEG = 28;
const BALL = new THREE.IcosahedronGeometry(1, 1);
const DIAMOND = new THREE.OctahedronGeometry(1.35); // another shape than what must be fixed, for those who see no colours

export class Geometries {
  constructor(bytes, meshes) {
    this.bytes = bytes;
    this.meshes = meshes;
    this.made = new Map();
    this.outlines = new Map();
  }

  edges(index) {
    if (!this.outlines.has(index)) this.outlines.set(index, new THREE.EdgesGeometry(this.get(index), CREASE_DEG));
    return this.outlines.get(index);
  }

  // The mesh with a colour for each vertex: `pieces` holds the number of vertices of each piece.
  coloured(index, pieces, colours) {
    const geometry = this.get(index);
    if (!geometry.getAttribute("color")) {
      const values = new Float32Array(3 * geometry.getAttribute("position").count);
      let vertex = 0;
      pieces.forEach((count, piece) => {
        const colour = new THREE.Color(colours[piece % colours.length]);
        for (const end = vertex + count; vertex < end; vertex++) colour.toArray(values, 3 * vertex);
      });
      geometry.setAttribute("color", new THREE.BufferAttribute(values, 3));
    }
    return geometry;
  }

  get(index) {
    if (!this.made.has(index)) {
      const { positions, indices } = decodeMesh(this.bytes, this.meshes[index]);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
      if (indices.length) geometry.setIndex(new THREE.BufferAttribute(indices, 1));
      geometry.computeBoundingBox();
      geometry.computeBoundingSphere();
      this.made.set(index, geometry);
    }
    return this.made.get(index);
  }
}

// Faces are flat shaded. Back faces, which only a cut shows, are darker than front faces.
function material(colour, extra = {}) {
  const made = new THREE.MeshStandardMaterial({
    color: colour, flatShading: true, roughness: 0.62, metalness: 0.08, side: THREE.DoubleSide,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  });
  if (!extra.surface) {
    made.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <color_fragment>",
        "#include <color_fragment>\nif (!gl_FrontFacing) diffuseColor.rgb *= 0.42;",
      );
    };
  }
  return made;
}

export function showBuild(build, geometries) {
  const shown = { parts: [], supports: [], marks: [], edges: [], group: new THREE.Group() };
  build.parts.forEach((part, index) => {
    const mesh = new THREE.Mesh(geometries.get(part.mesh), material(part.colour));
    mesh.matrixAutoUpdate = false;
    mesh.matrix.set(...part.matrix);
    mesh.userData = { kind: "part", index, mesh: part.mesh };
    shown.parts.push(mesh);
  });
  build.supports.forEach((body, index) => {
    const mesh = new THREE.Mesh(geometries.get(body.mesh), material(build.supportColour, body));
    mesh.userData = { kind: "support", index };
    shown.supports.push(mesh);
  });
  (build.marks ?? []).forEach((finding, index) => shown.marks.push(marks(finding, index, geometries)));
  shown.group.add(...shown.parts, ...shown.supports, ...shown.marks);
  shown.group.updateMatrixWorld(true);
  return shown;
}

// Bounding volumes with their outlines: each piece has a colour of its own, and shows the part through its faces.
export function showVolumes(volumes, geometries) {
  const group = new THREE.Group();
  const shown = volumes.map((volume, index) => {
    const geometry = geometries.coloured(volume.mesh, volume.pieces, volume.colours);
    const look = new THREE.MeshStandardMaterial({
      vertexColors: true, flatShading: true, roughness: 0.7, side: THREE.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 0.5, polygonOffsetUnits: 0.5, // before parts, which have 1
    });
    const mesh = new THREE.Mesh(geometry, look);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.set(...volume.matrix);
    mesh.renderOrder = 1;
    mesh.userData = { kind: "volume", index };
    const line = new THREE.LineBasicMaterial({ color: 0x7a4a10, transparent: true, opacity: 0.8 });
    const edges = new THREE.LineSegments(geometries.edges(volume.mesh), line);
    edges.raycast = () => {};
    mesh.add(edges);
    return mesh;
  });
  group.add(...shown);
  group.updateMatrixWorld(true);
  return { meshes: shown, group };
}

// Spheres (what must be fixed) or diamonds (what is worth a check) at the points of a finding; they are faintly visible through parts.
function marks(finding, index, geometries) {
  const positions = geometries.get(finding.points).getAttribute("position");
  const group = new THREE.Group();
  const pose = new THREE.Matrix4();
  for (const [through, opacity] of [[true, 0.2], [false, 1]]) {
    const look = new THREE.MeshBasicMaterial({ color: finding.colour, transparent: through, opacity, depthTest: !through });
    const shape = finding.triage === "must fix" ? BALL : DIAMOND;
    const mesh = new THREE.InstancedMesh(shape, look, positions.count);
    for (let i = 0; i < positions.count; i++) {
      pose.makeScale(finding.radius, finding.radius, finding.radius);
      pose.setPosition(positions.getX(i), positions.getY(i), positions.getZ(i));
      mesh.setMatrixAt(i, pose);
    }
    mesh.renderOrder = through ? 2 : 3;
    mesh.userData = { kind: "mark", index };
    group.add(mesh);
  }
  return group;
}

// A cross of three thin bars that shows a point through everything.
export function pointer() {
  const group = new THREE.Group();
  const look = new THREE.MeshBasicMaterial({ color: 0x000000, transparent: true, opacity: 0.85, depthTest: false });
  for (const [x, y, z] of [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) {
    for (const side of [-1, 1]) {
      const bar = new THREE.Mesh(new THREE.BoxGeometry(x || 0.06, y || 0.06, z || 0.06), look);
      bar.position.set(0.8 * side * x, 0.8 * side * y, 0.8 * side * z);
      bar.renderOrder = 5;
      group.add(bar);
    }
  }
  return group;
}

// Makes the outlines of one mesh at a time between frames, so that the view can be used at once.
export function addEdges(shown, geometries, done) {
  const look = new THREE.LineBasicMaterial({ color: 0x10151c, transparent: true, opacity: 0.45 });
  const queue = [...shown.parts];
  const next = () => {
    const mesh = queue.shift();
    if (shown.gone) return;
    if (!mesh) return done();
    const edges = new THREE.LineSegments(geometries.edges(mesh.userData.mesh), look);
    edges.raycast = () => {};
    mesh.add(edges);
    edges.updateMatrixWorld(true);
    edges.visible = false;
    shown.edges.push(edges);
    setTimeout(next);
  };
  setTimeout(next);
}

// Frees the materials of a build that is no longer shown; its geometry is kept for the next time.
export function retire(shown) {
  shown.gone = true;
  shown.group.traverse((object) => object.material?.dispose());
}
