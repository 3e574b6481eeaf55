// The page: its controls and state, and what it draws when.

import * as others from "./others.js";
import { embedded, own } from "./pictures.js";
import { frame } from "./plan.js";
import * as view from "./view.js";

const SIDES = ["left", "right"];
const byId = (id) => document.getElementById(id);

const data = JSON.parse(byId("data").textContent);
const METHODS = { input: "input", paper: "paper", exact: "exact", layered: "layered", truth: "ray traced", ...data.others };
const power = (x) => 2 ** x;
// name -> text, least, most and step of the slider, of what function of the value (and back), and how it is written; the
// state may lie between the steps
const SLIDERS = {
  stop: ["f-stop", -1.6, 4, 0.05, Math.log2, power, (v) => `f/${v.toFixed(v < 10 ? 2 : 1)}`],
  focus: ["focus", -1, 6, 0.01, Math.log2, power, (v) => `${v.toPrecision(3)} m`],
  focal: ["focal", 24, 135, 1, (v) => 1000 * v, (x) => x / 1000, (v) => `${(1000 * v).toFixed(0)} mm`],
  rotation: ["rotation", 0, 90, 1, Number, Number, (v) => `${v.toFixed(0)}\u00b0`],
  squeeze: ["squeeze", 0.5, 2, 0.05, Number, Number, (v) => v.toFixed(2)],
  exposure: ["exposure", -4, 4, 0.1, Math.log2, power, (v) => `${Math.log2(v).toFixed(1)} EV`],
  split: ["split", 0, 1, 0.01, Number, Number, (v) => v.toFixed(2)],
};
const scenes = [...data.scenes];
export const state = { scene: 0, left: "input", right: "layered", split: 0.5, preset: "medium", blades: 6, squeeze: 1 };
const drawn = {}; // side -> { key, name, facts }
let work = Promise.resolve(); // what is drawn and loaded, one after the other
let scheduled = false; // whether a picture is on its way
let current = null; // the scene's pictures

// Change the state; resolves when everything is drawn.
export function change(changes) {
  Object.assign(state, changes);
  if (!scheduled) after(() => new Promise(requestAnimationFrame).then(step));
  scheduled = true;
  return work;
}

// Do something when all that was begun is done: it may still use the pictures.
function after(job) {
  work = work.then(job).catch(say);
  return work;
}

function say(error) {
  byId("said").textContent = error?.message ?? error;
}

async function step() {
  scheduled = false;
  if (!current) return;
  for (const side of SIDES) await render(side);
  view.show(drawn.left.name, drawn.right.name, state.split, state.exposure);
  for (const side of SIDES) {
    byId(side).value = state[side];
    byId(`${side}Facts`).textContent = drawn[side].facts;
  }
  byId("divider").style.left = `${100 * state.split}%`;
  for (const name of ["scene", "preset", "blades"]) byId(name).value = state[name];
  for (const [name, [, , , , forth, , text]] of Object.entries(SLIDERS)) {
    byId(name).previousElementSibling.textContent = text(state[name]);
    if (document.activeElement !== byId(name)) byId(name).value = forth(state[name]);
  }
}

// Draw a side where its settings are others than those it has been drawn with.
async function render(side) {
  const { [side]: method, stop, focal, focus, blades, rotation, squeeze, preset } = state;
  if (method === "input" || method === "truth") {
    drawn[side] = { name: method === "input" ? "color" : "truth", facts: method === "truth" ? ofTruth() : "" };
    return;
  }
  const settings = { method, stop, focal, focus, blades, rotation, squeeze, preset };
  const key = JSON.stringify(settings);
  if (drawn[side]?.key === key) return;
  if (method in data.others) {
    const camera = { aperture: focal / stop, focal, focus, sensor: data.sensor };
    const { image, milliseconds } = await others.draw(method, camera, current);
    view.put(`${side} ${method}`, image);
    drawn[side] = { key, name: method, facts: `a disc, ${milliseconds.toFixed(1)} ms and reading it back` };
    return;
  }
  const passes = frame(data, settings, current.color.size);
  const milliseconds = view.run(side, passes);
  drawn[side] = { key, name: "result", facts: `${passes.length} passes, ${milliseconds.toFixed(1)} ms` };
}

// The lens that a scene was ray traced with, where the controls have another.
function ofTruth() {
  const { stop, focal, focus, rotation } = scenes[state.scene];
  const traced = { stop, focal, focus, rotation, blades: 6, squeeze: 1 };
  const same = Object.entries(traced).every(([name, value]) => state[name] === value);
  return same ? "" : `ray traced at f/${stop.toFixed(2)}, ${focus} m, 6 blades only`;
}

// Show a scene of the list with the lens that it comes with.
export async function choose(index) {
  const scene = scenes[index];
  say("");
  const pictures = scene.color ? scene : await embedded(scene.name);
  if (Math.max(...pictures.color.size) > view.largest()) throw new Error("this picture is larger than a texture here");
  await after(() => take(index, pictures));
  await reset();
}

function take(index, pictures) {
  view.load(pictures);
  current = pictures;
  for (const side of SIDES) {
    delete drawn[side];
    byId(side).querySelector("[value=truth]").disabled = !pictures.truth;
    if (!pictures.truth && state[side] === "truth") state[side] = "layered";
  }
  const [width, height] = pictures.color.size;
  byId("picture").style.setProperty("--wide", width);
  byId("picture").style.setProperty("--high", height);
  state.scene = index;
  // something to look at while programs are compiled
  view.show("color", "color", state.split, 1);
}

function reset() {
  const { stop, focal, focus, rotation, exposure } = scenes[state.scene];
  return change({ stop, focal, focus, rotation, squeeze: 1, blades: 6, exposure });
}

// Take a file that was dropped or chosen.
export async function open(file) {
  try {
    scenes.splice(data.scenes.length, 1, await own(file));
    listScenes();
    await choose(data.scenes.length);
  } catch (error) {
    say(error);
  }
}

function listScenes() {
  byId("scene").replaceChildren(...scenes.map(({ name }, index) => new Option(name, index)));
}

// Focus on what is under the pointer.
function focusAt(event) {
  const box = byId("canvas").getBoundingClientRect();
  const share = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  const [x, y] = current.depth.size.map((side, axis) => Math.min(Math.floor(share[axis] * side), side - 1));
  const metres = current.depth.data[y * current.depth.size[0] + x];
  // where there is depth; a lens cannot focus nearer than its focal length
  if (metres > 0) change({ focus: Math.min(Math.max(metres, 1.5 * state.focal), 1000) });
}

function labelled(text, id, input) {
  const label = Object.assign(document.createElement("label"), { textContent: text });
  label.append(document.createElement("output"), Object.assign(input, { id }));
  byId("controls").append(label);
  return input;
}

function list(select, options, chosen) {
  select.replaceChildren(...options.map(([text, value]) => new Option(text, value)));
  select.addEventListener("change", () => chosen(select.value));
}

async function begin() {
  view.open(byId("canvas"), data);
  const select = (name) => labelled(name, name, document.createElement("select"));
  list(select("scene"), [], (index) => choose(Number(index)).catch(say));
  list(select("preset"), data.presets.map((name) => [name.toUpperCase(), name]), (preset) => change({ preset }));
  list(select("blades"), Object.keys(data.apertures).map((sides) => [sides, sides]), (sides) => change({ blades: Number(sides) }));
  for (const side of SIDES) {
    list(byId(side), Object.entries(METHODS).map(([name, text]) => [text, name]), (method) => change({ [side]: method }));
  }
  for (const [name, [text, min, max, step, , back]] of Object.entries(SLIDERS)) {
    const input = Object.assign(document.createElement("input"), { type: "range", min, max, step });
    labelled(text, name, input).addEventListener("input", () => change({ [name]: back(Number(input.value)) }));
  }
  byId("canvas").addEventListener("click", (event) => current && focusAt(event));
  byId("reset").addEventListener("click", reset);
  byId("file").addEventListener("change", ({ target }) => open(target.files[0]));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    if (event.dataTransfer.files.length) open(event.dataTransfer.files[0]);
  });
  listScenes();
  await choose(0);
}

export const ready = begin();
ready.catch(say);
