// The page: its state, what it draws when, and what pointer and keys do.

import { controls, shown } from "./controls.js";
import * as others from "./others.js";
import { dropped, embedded } from "./pictures.js";
import { frame } from "./plan.js";
import * as view from "./view.js";

const PULL = 0.12; // seconds in which a pull of focus goes 63 % of its way, in dioptres
const SIDES = ["left", "right"];
const byId = (id) => document.getElementById(id);

const data = JSON.parse(byId("data").textContent);
const METHODS = { input: "input", paper: "paper", exact: "exact", layered: "layered", truth: "ray traced" };
for (const [name, { title }] of Object.entries(data.others)) METHODS[name] = title;
const scenes = [...data.scenes];
export const state = { scene: 0, left: "input", right: "layered", split: 0.5, preset: "medium", blades: 6, squeeze: 1 };
const drawn = {}; // side -> { key, name, milliseconds, passes, fetches }
let work = Promise.resolve(); // what is drawn and loaded, one after the other
let current = null; // the scene's pictures
let pointer = null; // texel under it
let pull = null; // { focus } where focus is on its way
let waiting = []; // those who wait for the next picture
let scheduled = false; // whether a picture is on its way
let last = 0;

// Resolves when everything is drawn, a pull of focus too.
export function settled() {
  return new Promise((resolve) => {
    waiting.push(resolve);
    ask();
  });
}

export function change(changes) {
  Object.assign(state, changes);
  ask();
}

function ask() {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(() => after(step));
}

// Do something when all that was begun is done: it may still use the pictures.
function after(job) {
  work = work.then(job, job);
  return work;
}

async function step() {
  scheduled = false;
  if (!current) return;
  const now = performance.now();
  if (pull) focusOn((now - last) / 1000);
  last = now;
  const mine = waiting.splice(0); // those who come meanwhile have changed something
  try {
    for (const side of SIDES) await render(side);
    view.show(drawn.left.name, drawn.right.name, state.split, state.exposure);
    tell();
  } catch (error) {
    say(error);
  }
  if (pull) {
    waiting.unshift(...mine);
    return ask();
  }
  for (const resolve of mine) resolve();
}

// A part of the way to where focus is pulled to; a slow device sees some of it too.
function focusOn(seconds) {
  const goal = 1 / pull.focus;
  const left = (1 / state.focus - goal) * Math.exp(-Math.min(Math.max(seconds, 0.005), 2 * PULL) / PULL);
  state.focus = Math.abs(left) < Math.max(0.003 * goal, 0.0005) ? pull.focus : 1 / (goal + left);
  if (state.focus === pull.focus) pull = null;
}

// Draw a side where its settings are others than those it has been drawn with.
async function render(side) {
  const method = state[side];
  if (method === "input" || method === "truth") {
    drawn[side] = { name: method === "input" ? "color" : "truth" };
    return;
  }
  const { stop, focal, focus, blades, rotation, squeeze, preset } = state;
  const settings = { method, stop, focal, focus, blades, rotation, squeeze, preset };
  const key = JSON.stringify(settings);
  if (drawn[side]?.key === key) return;
  if (method in data.others) {
    const camera = { aperture: focal / stop, focal, focus, sensor: data.sensor };
    const { image, milliseconds } = await others.draw(method, data.others[method], camera, current);
    view.put(side, method, image);
    drawn[side] = { key, name: method, milliseconds };
    return;
  }
  const passes = frame(data, settings, current.color.size);
  const milliseconds = view.run(side, passes);
  drawn[side] = { key, name: "result", milliseconds, passes: passes.length, fetches: fetches(settings) };
}

// At the most, a pixel, all passes together.
function fetches({ method, blades, preset }) {
  const name = `${method} ${data.apertures[blades]}`;
  const [fixed, each] = (data.plans[`${name} ${preset}`] ?? data.plans[name]).fetches;
  const tiles = Math.ceil((data.maxCoC * current.color.size[1]) / 16) + 2;
  return fixed + each * Math.min(2 * tiles + 1, 255);
}

// ------------------------------------------------------------------------------------------------------------- readout

function say(error) {
  byId("said").textContent = error?.message ?? error;
}

function tell() {
  for (const side of SIDES) {
    const { passes, fetches, milliseconds } = drawn[side] ?? {};
    const facts = byId(`${side}Facts`);
    const fixed = state[side] === "truth" && !atTruth();
    facts.className = fixed ? "note" : "";
    facts.textContent = passes ? `${passes} passes, ${fetches.toFixed(0)} fetches a pixel, ${milliseconds.toFixed(1)} ms` : "";
    if (state[side] in data.others && milliseconds) {
      const { version } = data.others[state[side]];
      facts.textContent = `${version}, a disc, ${milliseconds.toFixed(1)} ms and reading it back`;
    }
    if (fixed) {
      const { stop, focus } = scenes[state.scene];
      facts.textContent = `ray traced at f/${stop.toFixed(2)}, ${focus} m, 6 blades only`;
    }
  }
  byId("divider").style.left = `${100 * state.split}%`;
  byId("divider").setAttribute("aria-valuenow", Math.round(100 * state.split));
  shown(state);
  under();
}

// Whether the lens is the one that the scene was ray traced with.
function atTruth() {
  const { stop, focal, focus, rotation } = scenes[state.scene];
  const same = state.stop === stop && state.focal === focal && state.focus === focus;
  return same && state.blades === 6 && state.rotation === rotation && state.squeeze === 1;
}

// Depth and circle of confusion under the pointer: alpha of the map that a method has drawn.
export async function under() {
  if (!pointer || !current) return null;
  const [x, y] = pointer;
  const [width, height] = current.color.size;
  const metres = current.depth.data[y * width + x];
  const side = SIDES.find((name) => drawn[name]?.passes);
  const pixels = side ? Math.abs((await after(() => view.read(side, "coc", x, y)))[3]) * height : null;
  if (pointer?.[0] !== x || pointer[1] !== y) return null;
  const field = metres < state.focus ? "near" : "far";
  const circle = pixels === null ? "" : `, CoC ${pixels.toFixed(1)} pixels${pixels < 0.5 ? "" : ` ${field}`}`;
  byId("under").textContent = `${x}, ${y}: ${metres.toPrecision(3)} m${circle}`;
  return { metres, pixels };
}

// -------------------------------------------------------------------------------------------------------------- scenes

// Show a scene of the list with the lens that it comes with.
export async function choose(index) {
  const scene = scenes[index];
  say("");
  const pictures = scene.color ? scene : await embedded(scene.name);
  if (Math.max(...pictures.color.size) > view.largest()) throw new Error("this picture is larger than a texture here");
  await after(() => take(index, pictures));
  await settled();
}

function take(index, pictures) {
  view.load(pictures);
  current = pictures;
  pointer = null;
  byId("under").textContent = "point at the picture";
  for (const side of SIDES) {
    delete drawn[side];
    byId(side).querySelector("[value=truth]").disabled = !pictures.truth;
    if (!pictures.truth && state[side] === "truth") state[side] = "layered";
  }
  const [width, height] = pictures.color.size;
  byId("picture").style.setProperty("--wide", width);
  byId("picture").style.setProperty("--high", height);
  state.scene = index;
  reset();
  // something to look at while programs are compiled
  view.show("color", "color", state.split, state.exposure);
  return new Promise(requestAnimationFrame);
}

function reset() {
  const { stop, focal, focus, rotation, exposure } = scenes[state.scene];
  pull = null;
  change({ stop, focal, focus, rotation, squeeze: 1, blades: 6, exposure });
}

// Take files that were dropped or chosen.
export async function open(files) {
  try {
    scenes.splice(data.scenes.length, 1, await dropped([...files]));
    listScenes();
    await choose(data.scenes.length);
  } catch (error) {
    say(error);
  }
}

function listScenes() {
  byId("scene").replaceChildren(...scenes.map(({ name }, index) => new Option(name, index)));
}

// --------------------------------------------------------------------------------------------------- pointer, keys

// Focus on the depth of a texel.
export function focusAt([x, y]) {
  const metres = current.depth.data[y * current.color.size[0] + x];
  if (!(metres > 0)) return; // no depth there
  // a lens cannot focus nearer than its focal length
  pull = { focus: Math.min(Math.max(metres, 1.5 * state.focal), 1000) };
  last = performance.now();
  ask();
}

function texelOf(event) {
  const box = byId("canvas").getBoundingClientRect();
  const share = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  return current.color.size.map((side, axis) => Math.min(Math.max(Math.floor(share[axis] * side), 0), side - 1));
}

function listen() {
  const picture = byId("picture");
  const divider = byId("divider");
  divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
  divider.addEventListener("pointermove", (event) => {
    if (!divider.hasPointerCapture(event.pointerId)) return;
    const box = byId("canvas").getBoundingClientRect();
    change({ split: Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1) });
  });
  byId("canvas").addEventListener("pointermove", (event) => {
    if (!current) return;
    pointer = texelOf(event);
    under();
  });
  byId("canvas").addEventListener("click", (event) => {
    if (!current) return;
    pointer = texelOf(event);
    const box = picture.getBoundingClientRect();
    const mark = byId("mark").style;
    [mark.left, mark.top, mark.transition, mark.opacity] = [`${event.clientX - box.left}px`, `${event.clientY - box.top}px`, "none", 1];
    setTimeout(() => ([mark.transition, mark.opacity] = ["", 0]), 300);
    focusAt(pointer);
  });
  addEventListener("keydown", key);
  for (const kind of ["dragenter", "dragover", "dragleave", "drop"]) {
    addEventListener(kind, (event) => {
      event.preventDefault();
      document.body.classList.toggle("over", kind === "dragover" || kind === "dragenter");
      if (kind === "drop" && event.dataTransfer.files.length) open(event.dataTransfer.files);
    });
  }
  byId("reset").addEventListener("click", reset);
  byId("own").addEventListener("click", () => byId("file").click());
  byId("file").addEventListener("change", ({ target }) => open(target.files));
}

function key(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches("select")) return;
  if (event.target.matches("input") && event.key.startsWith("Arrow")) return; // its own
  const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
  const sides = Object.keys(data.apertures).map(Number);
  const actions = {
    ArrowLeft: () => change({ split: clamp(state.split - 0.02, 0, 1) }),
    ArrowRight: () => change({ split: clamp(state.split + 0.02, 0, 1) }),
    x: () => change({ left: state.right, right: state.left }),
    "[": () => change({ stop: clamp(state.stop / 2 ** 0.25, 0.3, 16) }),
    "]": () => change({ stop: clamp(state.stop * 2 ** 0.25, 0.3, 16) }),
    b: () => change({ blades: sides[(sides.indexOf(state.blades) + 1) % sides.length] }),
    h: () => document.body.classList.toggle("bare"),
    0: reset,
  };
  const digit = /^Digit([1-7])$/.exec(event.code);
  const method = digit && Object.keys(METHODS)[digit[1] - 1];
  if (method && (method !== "truth" || current.truth)) change({ [event.shiftKey ? "right" : "left"]: method });
  else if (event.key in actions) actions[event.key]();
  else return;
  event.preventDefault();
}

async function begin() {
  view.open(byId("canvas"), data);
  controls(byId("controls"), data, change, (index) => choose(index).catch(say));
  for (const side of SIDES) {
    byId(side).replaceChildren(...Object.entries(METHODS).map(([value, text]) => new Option(text, value)));
    byId(side).addEventListener("change", ({ target }) => change({ [side]: target.value }));
  }
  listScenes();
  listen();
  await choose(0);
}

export const ready = begin();
ready.catch(say);
