// Starts the 3D view of a report: reads the data blocks of the page, shows a build and connects the controls.
import * as THREE from "three";
import { inflate } from "./decode.js";
import { addEdges, Geometries, pointer, retire, showBuild, showVolumes } from "./build.js";
import { Ruler } from "./ruler.js";
import { Stage, surroundings } from "./stage.js";

const VIEWS = {
  oblique: new THREE.Vector3(0.52, -0.95, 0.72),
  top: new THREE.Vector3(0, -0.0001, 1),
  front: new THREE.Vector3(0, -1, 0.0001),
  right: new THREE.Vector3(1, 0, 0.0001),
  below: new THREE.Vector3(0.4, -0.7, -0.62),
};
const MOST_PRINTED = 12;
const dark = window.matchMedia("(prefers-color-scheme: dark)");
const element = (id) => document.getElementById(id);

function make(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value !== false) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

function swatch(colour) {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("class", "swatch");
  svg.setAttribute("viewBox", "0 0 10 10");
  const dot = document.createElementNS(space, "circle");
  for (const [name, value] of Object.entries({ cx: 5, cy: 5, r: 5, fill: colour })) dot.setAttribute(name, value);
  svg.append(dot);
  return svg;
}

function themeColours() {
  const style = getComputedStyle(document.documentElement);
  const names = { fine: "--grid", coarse: "--grid-strong", frame: "--frame", plate: "--plate", zone: "--bad" };
  return Object.fromEntries(Object.entries(names).map(([key, name]) => [key, style.getPropertyValue(name).trim()]));
}

class Viewer {
  constructor(model, bytes) {
    this.model = model;
    this.geometries = new Geometries(bytes, model.meshes);
    this.stage = new Stage(element("canvas"));
    this.layers = { parts: true, supports: true, marks: true, edges: true, frame: !model.alone, transparent: false };
    this.hidden = new Set();
    this.#tabs();
    this.#toolbar();
    this.#picking();
    this.pointer = pointer();
    this.stage.scene.add(this.pointer);
    this.ruler = new Ruler(this.stage);
    this.#keys();
    this.#printing();
    document.addEventListener("show-finding", ({ detail }) => this.point(detail));
    dark.addEventListener("change", () => this.#surround());
    this.stage.resize();
    this.open(0);
  }

  open(number) {
    this.number = number;
    this.build = this.model.builds[number];
    this.hidden.clear();
    if (this.shown) {
      this.stage.scene.remove(this.shown.group);
      retire(this.shown);
    }
    this.shown = showBuild(this.build, this.geometries);
    this.stage.scene.add(this.shown.group);
    this.#surround();
    this.#lists();
    this.#choices();
    this.choose(-1);
    this.measure(false);
    const slider = element("section");
    slider.max = Math.ceil(10 * this.build.height) / 10 || 1;
    slider.value = slider.max;
    this.#cut();
    element("tabs").querySelectorAll("button").forEach((tab, index) => {
      tab.setAttribute("aria-selected", String(index === number));
    });
    this.#apply();
    this.view("oblique");
    addEdges(this.shown, this.geometries, () => this.#apply());
  }

  // Shows one of the sets of bounding volumes, or none for -1.
  choose(number) {
    if (this.volumes) {
      this.stage.scene.remove(this.volumes.group);
      retire(this.volumes);
    }
    const set = this.build.volumes[number];
    this.volumes = set ? showVolumes(set.shown, this.geometries) : null;
    this.chosen = set;
    if (set) this.stage.scene.add(this.volumes.group);
    element("volumes").querySelectorAll("button").forEach((button, index) => {
      button.setAttribute("aria-checked", String(index === number + 1));
    });
    this.select(set?.shown.length === 1 ? { kind: "volume", index: 0 } : null);
    this.#apply();
  }

  view(name) {
    const [x, y] = this.build.space.size;
    const box = new THREE.Box3(new THREE.Vector3(), new THREE.Vector3(x, y, Math.max(this.build.height, this.model.alone ? 0 : 10)));
    const filled = new THREE.Box3();
    for (const mesh of [...this.shown.parts, ...this.shown.supports]) filled.expandByObject(mesh);
    const size = filled.getSize(new THREE.Vector3());
    // parts that cover only a small part of the plate fill the view, as they do in pictures
    const small = !filled.isEmpty() && Math.max(size.x, size.y) < 0.45 * Math.max(x, y);
    const ball = (small ? filled : box).getBoundingSphere(new THREE.Sphere());
    this.stage.look(ball.center, (small ? 1.15 : 0.87) * ball.radius, VIEWS[name].clone());
  }

  select(found) {
    for (const mesh of [...this.shown.parts, ...this.shown.supports, ...(this.volumes?.meshes ?? [])]) mesh.material.emissive.setHex(0);
    document.querySelectorAll("#lists [aria-current]").forEach((row) => row.removeAttribute("aria-current"));
    this.pointer.visible = false;
    const card = element("card");
    card.replaceChildren();
    card.hidden = !found;
    if (found) this.#describe(found, card);
    this.stage.draw();
  }

  // Begins or ends measuring: the next two clicks are the ends of a distance.
  measure(on) {
    this.ruler.clear();
    this.measuring = on;
    element("measure").setAttribute("aria-pressed", String(on));
    this.select(null);
    if (on) this.#say("Measure", ["Click two points. Corners near the pointer attract it. Escape ends."]);
  }

  #say(title, lines) {
    const card = element("card");
    card.replaceChildren(make("strong", {}, title), ...lines.map((line) => make("span", {}, line)));
    card.hidden = false;
  }

  // Shows a point of a build with its description, as a row of the tables asks.
  point({ build, at, name, facts }) {
    if (build !== this.number) this.open(build);
    this.select(null);
    const card = element("card");
    card.hidden = false;
    card.append(make("strong", {}, name), ...facts.map((line) => make("span", {}, line)));
    const centre = new THREE.Vector3(...at);
    this.pointer.position.copy(centre);
    this.pointer.scale.setScalar(2);
    this.pointer.visible = true;
    this.stage.look(centre, 14);
    element("viewer").scrollIntoView({ block: "nearest", behavior: "smooth" });
    this.stage.draw();
  }

  #describe({ kind, index }, card) {
    const row = document.querySelector(`#lists [data-key="${kind}-${index}"]`);
    if (row) {
      row.setAttribute("aria-current", "true");
      row.closest("details").open = true;
      row.scrollIntoView({ block: "nearest" });
    }
    const lit = { part: this.shown.parts, support: this.shown.supports }[kind];
    if (lit) lit[index].material.emissive.setHex(0x3a4c6c);
    const entry = { part: this.build.parts, support: this.build.supports, mark: this.build.marks, volume: this.chosen?.shown }[kind][index];
    card.append(make("strong", {}, entry.name), ...entry.facts.map((line) => make("span", {}, line)));
  }

  focus(object) {
    const box = new THREE.Box3().setFromObject(object);
    const ball = box.getBoundingSphere(new THREE.Sphere());
    this.stage.look(ball.center, Math.max(1.5 * ball.radius, 6));
  }

  #surround() {
    if (this.around) this.stage.scene.remove(this.around);
    this.around = surroundings(this.build.space, themeColours());
    this.stage.scene.add(this.around);
    this.#apply();
  }

  #apply() {
    const { shown, layers } = this;
    shown.parts.forEach((mesh, index) => {
      mesh.visible = layers.parts && !this.hidden.has(index);
      mesh.material.transparent = layers.transparent;
      mesh.material.opacity = layers.transparent ? 0.28 : 1;
      mesh.material.depthWrite = !layers.transparent;
    });
    for (const mesh of shown.supports) mesh.visible = layers.supports;
    for (const mesh of shown.marks) mesh.visible = layers.marks;
    for (const edges of shown.edges) edges.visible = layers.edges;
    // volumes without parts are drawn as solids
    this.volumes?.meshes.forEach((mesh, index) => {
      mesh.visible = this.chosen.shown.length !== shown.parts.length || !this.hidden.has(index);
      mesh.material.transparent = layers.parts;
      mesh.material.opacity = layers.parts ? 0.3 : 1;
      mesh.material.depthWrite = !layers.parts;
      mesh.children[0].visible = layers.edges;
    });
    this.around.getObjectByName("frame").visible = layers.frame;
    this.stage.draw();
  }

  #tabs() {
    const builds = this.model.builds;
    const tabs = builds.map((build, number) => make(
      "button", { type: "button", role: "tab", title: build.id, onclick: () => this.open(number) }, this.model.alone ? build.id : `Build ${number + 1}`,
    ));
    element("tabs").replaceChildren(...tabs);
    element("tabs").hidden = builds.length < 2;
  }

  #toolbar() {
    const names = { parts: "Parts", supports: "Supports", marks: "Marks", edges: "Outlines", frame: "Build volume", transparent: "Transparent parts" };
    const missing = (key) => this.model.alone && ["supports", "marks", "frame"].includes(key);
    const boxes = Object.entries(names).filter(([key]) => !missing(key)).map(([key, words]) => {
      const checkbox = make("input", { type: "checkbox", id: `layer-${key}` });
      checkbox.checked = this.layers[key];
      checkbox.addEventListener("change", () => {
        this.layers[key] = checkbox.checked;
        this.#apply();
      });
      return make("label", {}, checkbox, words);
    });
    element("layers").replaceChildren(...boxes);
    const views = Object.keys(VIEWS).map((name) => make("button", { type: "button", onclick: () => this.view(name) }, name));
    element("views").replaceChildren(...views);
    element("section").addEventListener("input", () => this.#cut());
    element("measure").addEventListener("click", () => this.measure(!this.measuring));
  }

  // Keys work while the view has the focus; arrows move it, and turn it together with Shift.
  #keys() {
    this.stage.canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const name = Object.keys(VIEWS)[Number(event.key) - 1];
      if (name) this.view(name);
      else if (event.key === "m") this.measure(!this.measuring);
      else if (event.key === "Escape") this.measure(false);
      else if (event.key === "+" || event.key === "-") this.stage.zoom(event.key === "+" ? 1 / 1.2 : 1.2);
      else return;
      event.preventDefault();
    });
  }

  // Paper has no 3D view: it shows a picture of each build, and all that is folded.
  #printing() {
    const before = [];
    window.addEventListener("beforeprint", () => {
      for (const folded of document.querySelectorAll("main details:not([open])")) {
        folded.open = true;
        before.push(folded);
      }
      const shown = this.number;
      const pictures = this.model.builds.slice(0, MOST_PRINTED).map((build, number) => {
        if (number !== this.number) this.open(number);
        return make("figure", {}, make("img", { src: this.stage.picture(), alt: build.id }), make("figcaption", {}, build.id));
      });
      if (this.number !== shown) this.open(shown);
      element("printed").replaceChildren(...pictures);
    });
    window.addEventListener("afterprint", () => {
      for (const folded of before.splice(0)) folded.open = false;
      element("printed").replaceChildren();
    });
  }

  #choices() {
    const names = ["no volume", ...this.build.volumes.map((set) => set.name)];
    const buttons = names.map((name, index) => make("button", { type: "button", role: "radio", onclick: () => this.choose(index - 1) }, name));
    element("volumes").replaceChildren(...buttons);
    element("volumes").hidden = names.length < 2;
  }

  #cut() {
    const slider = element("section");
    const whole = Number(slider.value) >= Number(slider.max);
    element("section-value").textContent = whole ? "off" : `z ≤ ${Number(slider.value).toFixed(1)} mm`;
    this.stage.setClip(whole ? Infinity : Number(slider.value));
  }

  #lists() {
    const rows = this.build.parts.map((part, index) => {
      const checkbox = make("input", { type: "checkbox", "aria-label": `show ${part.name}` });
      checkbox.checked = true;
      checkbox.addEventListener("change", () => {
        this.hidden[checkbox.checked ? "delete" : "add"](index);
        this.#apply();
      });
      return make("li", { "data-key": `part-${index}` }, checkbox, this.#rowButton("part", index, part.name, swatch(part.colour)));
    });
    const sections = [this.#section("Parts", rows, true)];
    for (const [triage, words] of [["worth a check", "Worth a check"], ["must fix", "Must fix"]]) {
      const found = (this.build.marks ?? []).map((finding, index) => [finding, index]).filter(([finding]) => finding.triage === triage);
      const items = found.map(([finding, index]) => make(
        "li", { "data-key": `mark-${index}` },
        this.#rowButton("mark", index, finding.name, swatch(finding.colour), make("small", {}, finding.facts[0])),
      ));
      if (items.length) sections.unshift(this.#section(words, items, items.length <= 8));
    }
    element("lists").replaceChildren(...sections);
  }

  #section(words, rows, open) {
    return make("details", { open: open && "" }, make("summary", {}, `${words} (${rows.length})`), make("ul", {}, ...rows));
  }

  #rowButton(kind, index, words, mark, ...more) {
    const go = () => {
      const object = kind === "part" ? this.shown.parts[index] : this.shown.marks[index];
      this.select({ kind, index });
      if (object) this.focus(object);
    };
    return make("button", { type: "button", onclick: go }, mark, make("span", {}, words), ...more);
  }

  #picking() {
    const canvas = this.stage.canvas;
    const caster = new THREE.Raycaster();
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      const frame = canvas.getBoundingClientRect();
      const x = (2 * (event.clientX - frame.left)) / frame.width - 1;
      const y = 1 - (2 * (event.clientY - frame.top)) / frame.height;
      caster.setFromCamera(new THREE.Vector2(x, y), this.stage.camera);
      const hit = this.#hit(caster);
      if (this.measuring) this.#measureAt(hit, frame);
      else this.select(hit ? hit.object.userData : null);
    });
  }

  #measureAt(hit, frame) {
    if (!hit) return;
    const lines = this.ruler.add(hit, frame);
    this.#say(lines ? lines[0] : "Measure", lines ? lines.slice(1) : ["Click the second point."]);
  }

  #hit(caster) {
    const visible = [...this.shown.marks.flatMap((group) => (group.visible ? group.children : [])),
      ...this.shown.parts, ...this.shown.supports, ...(this.layers.parts ? [] : this.volumes?.meshes ?? [])].filter((mesh) => mesh.visible);
    const cut = this.stage.renderer.clippingPlanes;
    const hits = caster.intersectObjects(visible, false)
      .filter(({ point }) => cut.every((plane) => plane.distanceToPoint(point) >= 0));
    return hits[0] ?? null;
  }
}

async function start() {
  const model = JSON.parse(element("model").textContent);
  if (!model.builds.length) {
    element("viewer").hidden = true;
    return;
  }
  if (typeof DecompressionStream === "undefined") throw new Error("this browser cannot decompress the geometry; use a newer browser");
  const bytes = await inflate(element("geometry").textContent);
  new Viewer(model, bytes);
  element("wait").hidden = true;
}

start().catch((error) => {
  element("viewer").classList.add("broken");
  element("wait").textContent = `The 3D view could not start: ${error.message}. The tables below are complete.`;
});
