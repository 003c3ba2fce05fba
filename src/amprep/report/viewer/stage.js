// The 3D scene: camera, lights, build plate and build volume; it is drawn only when something has changed.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const UP = new THREE.Vector3(0, 0, 1);

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 1, 10000);
    this.camera.up.copy(UP);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.clip = new THREE.Plane(new THREE.Vector3(0, 0, -1), Infinity);
    this.#light();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  #light() {
    const sky = new THREE.HemisphereLight(0xffffff, 0x8a90a0, 1.9);
    sky.position.set(0, 0, 1);
    this.sun = new THREE.DirectionalLight(0xffffff, 1.5);
    this.sun.position.set(-0.5, -1, 1.6);
    this.lamp = new THREE.DirectionalLight(0xffffff, 0.8);
    this.camera.add(this.lamp);
    this.scene.add(sky, this.sun, this.camera);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.renderer.render(this.scene, this.camera);
    });
  }

  // Shows a sphere from a direction, which points from the sphere to the viewer.
  look(centre, radius, direction) {
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const away = direction ?? this.camera.position.clone().sub(this.controls.target);
    away.normalize().multiplyScalar(radius / Math.sin(narrow));
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).add(away);
    this.camera.near = Math.max(0.1, radius / 100);
    this.camera.far = radius * 100;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  // Moves the camera to a multiple of its distance.
  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  // What is shown, as the address of a picture.
  picture() {
    this.renderer.render(this.scene, this.camera);
    return this.canvas.toDataURL("image/png");
  }

  setClip(height) {
    this.clip.constant = height;
    this.renderer.clippingPlanes = Number.isFinite(height) ? [this.clip] : [];
    this.draw();
  }
}

// Makes the build plate with lines every 10 and 50 mm, the wireframe of the build volume and the forbidden zones.
export function surroundings(space, colours) {
  const group = new THREE.Group();
  const [x, y, z] = space.size;
  const round = space.shape === "cylinder";
  const fine = [];
  const coarse = [];
  for (let i = 0; i <= x + 1e-9; i += 10) pushLine(i % 50 ? fine : coarse, chord(i, x, y, round), (t) => [i, t, 0]);
  for (let i = 0; i <= y + 1e-9; i += 10) pushLine(i % 50 ? fine : coarse, chord(i, y, x, round), (t) => [t, i, 0]);
  group.add(lines(fine, colours.fine), lines(coarse, colours.coarse));
  const frame = lines(round ? cylinderFrame(x / 2, z) : boxFrame(x, y, z), colours.frame);
  frame.name = "frame";
  group.add(frame, plate(x, y, round, colours.plate));
  for (const [low, high] of space.zones) group.add(zone(low, high, colours.zone));
  return group;
}

function chord(at, width, length, round) {
  if (!round) return [0, length];
  const half = Math.sqrt(Math.max(0, (width / 2) ** 2 - (at - width / 2) ** 2));
  return [length / 2 - half, length / 2 + half];
}

function pushLine(list, [from, to], point) {
  if (to > from) list.push(...point(from), ...point(to));
}

function boxFrame(x, y, z) {
  const list = [];
  for (const a of [0, 1]) for (const b of [0, 1]) {
    list.push(0, a * y, b * z, x, a * y, b * z, a * x, 0, b * z, a * x, y, b * z, a * x, b * y, 0, a * x, b * y, z);
  }
  return list;
}

function cylinderFrame(radius, z) {
  const list = [];
  const point = (k, height) => {
    const angle = (k * Math.PI) / 48;
    return [radius + radius * Math.cos(angle), radius + radius * Math.sin(angle), height];
  };
  for (let k = 0; k < 96; k++) {
    for (const height of [0, z]) list.push(...point(k, height), ...point(k + 1, height));
    if (k % 12 === 0) list.push(...point(k, 0), ...point(k, z));
  }
  return list;
}

function lines(list, colour) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(list, 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour }));
}

function plate(x, y, round, colour) {
  const geometry = round ? new THREE.CircleGeometry(x / 2, 96) : new THREE.PlaneGeometry(x, y);
  const material = new THREE.MeshBasicMaterial({
    color: colour, transparent: true, opacity: 0.55, depthWrite: false, // seen from above only
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.position.set(x / 2, y / 2, -0.05);
  mesh.renderOrder = -1;
  return mesh;
}

function zone(low, high, colour) {
  const size = high.map((value, axis) => value - low[axis]);
  const mesh = new THREE.Mesh(
    new THREE.BoxGeometry(...size),
    new THREE.MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.18, depthWrite: false }),
  );
  mesh.position.set(...low.map((value, axis) => value + size[axis] / 2));
  return mesh;
}
