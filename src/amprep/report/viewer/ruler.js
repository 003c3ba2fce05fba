// Measures the distance of two points that the user clicks.
import * as THREE from "three";

const NEAR_PX = 10;
const COLOUR = 0x0b57d0;

export class Ruler {
  constructor(stage) {
    this.stage = stage;
    this.points = [];
    this.group = new THREE.Group();
    stage.scene.add(this.group);
  }

  clear() {
    this.points = [];
    for (const each of this.group.children) {
      each.geometry.dispose();
      each.material.dispose();
    }
    this.group.clear();
    this.stage.draw();
  }

  // Adds the point of a hit; returns the distance in words when there are two points, else null.
  add(hit, frame) {
    if (this.points.length === 2) this.clear();
    const point = this.#snapped(hit, frame);
    this.points.push(point);
    this.group.add(this.#dot(point));
    if (this.points.length === 2) this.group.add(this.#line());
    this.stage.draw();
    return this.points.length === 2 ? words(...this.points) : null;
  }

  // The corner of the triangle that was hit, if it is near the pointer on the screen; else the point itself.
  #snapped({ object, face, point }, frame) {
    const positions = object.geometry.getAttribute("position");
    const near = [face.a, face.b, face.c]
      .map((index) => new THREE.Vector3().fromBufferAttribute(positions, index).applyMatrix4(object.matrixWorld))
      .map((corner) => ({ corner, away: this.#pixels(corner, point, frame) }))
      .sort((a, b) => a.away - b.away)[0];
    return near.away < NEAR_PX && !object.isInstancedMesh ? near.corner : point.clone();
  }

  #pixels(one, other, frame) {
    const [a, b] = [one, other].map((each) => each.clone().project(this.stage.camera));
    return Math.hypot(((a.x - b.x) * frame.width) / 2, ((a.y - b.y) * frame.height) / 2);
  }

  #dot(point) {
    const look = new THREE.PointsMaterial({ color: COLOUR, size: 9, sizeAttenuation: false, depthTest: false });
    const dot = new THREE.Points(new THREE.BufferGeometry().setFromPoints([point]), look);
    dot.renderOrder = 6;
    return dot;
  }

  #line() {
    const look = new THREE.LineBasicMaterial({ color: COLOUR, depthTest: false });
    const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(this.points), look);
    line.renderOrder = 6;
    return line;
  }
}

function words(one, other) {
  const [x, y, z] = other.clone().sub(one).toArray().map((value) => Math.abs(value).toFixed(2));
  const places = [one, other].map((each) => each.toArray().map((value) => value.toFixed(2)).join(", "));
  return [`${one.distanceTo(other).toFixed(2)} mm`, `along x ${x}, y ${y}, z ${z} mm`, `from ${places[0]} to ${places[1]} mm`];
}
