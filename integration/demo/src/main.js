// The page: its controls, its state, what it draws when the state changes, and what the pointer and the keys do.

import { dropped, embedded } from "./pictures.js";
import { frame } from "./plan.js";
import { median, steady } from "./steady.js";
import * as view from "./view.js";
import data from "../data/page.json";

const PULL = 0.12; // time constant in seconds: in this time, 1 / focus distance covers 63 % of its way to a new focus
const SIDES = ["left", "right"];
const IDLE = 500; // after so many milliseconds without a change, the page measures how long a frame takes
const CLICK = 5; // a pointer that moves by more pixels between press and release drags instead of clicking
const LENS = { stop: 2.8, scale: 10 }; // the default of every integration
const byId = (id) => document.getElementById(id);

const METHODS = { input: "input", paper: "paper", exact: "exact", layered: "layered", truth: "ray traced", ...data.others };
const power = (x) => 2 ** x;
const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
// Name -> [label; smallest position, largest position and step of the slider; functions from the value to the position,
// from the position to the value, and from the value to its text]. The value in the state may lie between the steps.
const SLIDERS = {
  stop: ["f-stop", -1.6, 4, 0.05, Math.log2, power, (v) => `f/${v.toFixed(v < 10 ? 2 : 1)}`],
  scale: ["bokeh scale", 0, 20, 0.5, Number, Number, (v) => v.toFixed(v % 1 ? 1 : 0)],
  focus: ["focus", -1, 6, 0.01, Math.log2, power, (v) => `${v.toPrecision(3)} m`],
  focal: ["focal", 24, 135, 1, (v) => 1000 * v, (x) => x / 1000, (v) => `${(1000 * v).toFixed(0)} mm`],
  rotation: ["rotation", 0, 90, 1, Number, Number, (v) => `${v.toFixed(0)}\u00b0`],
  squeeze: ["squeeze", 0.5, 2, 0.05, Number, Number, (v) => v.toFixed(2)],
  exposure: ["exposure", -4, 4, 0.1, Math.log2, power, (v) => `${Math.log2(v).toFixed(1)} EV`],
};
const scenes = [...data.scenes];
const state = { scene: 0, left: "input", right: "layered", split: 0.5, preset: "medium", blades: 6, squeeze: 1 };
const drawn = {}; // side -> { key, name, facts }
let work = Promise.resolve(); // the queue of jobs that draw or load, one after the other
let scheduled = false; // whether the queue already has a job that draws the new state
let current = null; // the images of the scene
let pointer = null; // texel under the pointer
let measuring = 0; // timer of the next measurement
let pull = null; // the focus distance, in metres, to which the focus is moving

// Changes the state. Resolves when everything is drawn, and the focus has stopped moving.
function change(changes) {
  Object.assign(state, changes);
  if (!scheduled) after(() => new Promise(requestAnimationFrame).then(step));
  scheduled = true;
  return work;
}

// Runs a job after all jobs that have begun, because they may still use the images.
function after(job) {
  work = work.then(job).catch(say);
  return work;
}

function say(error) {
  byId("said").textContent = error?.message ?? error;
}

async function step(before) {
  scheduled = false;
  if (!current) return;
  await drawBoth();
  while (pull) {
    const now = await new Promise(requestAnimationFrame);
    pullFocus((now - before) / 1000);
    before = now;
    await drawBoth();
  }
}

async function drawBoth() {
  for (const side of SIDES) await render(side);
  view.show(drawn.left.name, drawn.right.name, state.split, state.exposure);
  tell();
  clearTimeout(measuring);
  measuring = setTimeout(() => after(measure), IDLE);
}

// Measures how long a frame of each side takes, and shows the time if it is steady. To do so, it draws the frame
// several times, and stops as soon as the state changes.
async function measure() {
  for (const side of SIDES) {
    const made = drawn[side];
    if (!made.passes || made.milliseconds) continue;
    const times = [];
    for (let i = 0; i < 12 && !scheduled && !steady(times); i++) {
      times.push(view.run(side, made.passes));
      await new Promise(requestAnimationFrame);
    }
    if (steady(times)) made.milliseconds = median(times);
  }
  tell();
}

// Moves the focus by one step. The time of a step is limited, so that the movement is visible on a slow device too.
function pullFocus(seconds) {
  const goal = 1 / pull;
  const left = (1 / state.focus - goal) * Math.exp(-clamp(seconds, 0.005, 2 * PULL) / PULL);
  state.focus = Math.abs(left) < Math.max(0.003 * goal, 0.0005) ? pull : 1 / (goal + left);
  if (state.focus === pull) pull = null;
}

// Draws a side if its settings have changed since it was last drawn.
async function render(side) {
  const { [side]: method, stop, scale, focal, focus, blades, rotation, squeeze, preset } = state;
  if (method === "truth" && !current.truth) {
    current.truth = await current.loadTruth();
    view.put("truth", current.truth);
  }
  if (method === "input" || method === "truth") {
    drawn[side] = { name: method === "input" ? "color" : "truth", facts: method === "truth" ? ofTruth() : "" };
    return;
  }
  const settings = { method, stop, scale, focal, focus, blades, rotation, squeeze, preset };
  const key = JSON.stringify(settings);
  if (drawn[side]?.key === key) return;
  if (method in data.others) {
    const camera = { aperture: (focal / stop) * scale, focal, focus, sensor: data.sensor };
    const others = await import("./others.js");
    view.put(`${side} ${method}`, await others.draw(method, camera, current));
    drawn[side] = { key, name: method, facts: "round bokeh" };
    return;
  }
  const passes = frame(data, settings, current.color.size);
  view.run(side, passes);
  drawn[side] = { key, name: "result", passes, facts: `${passes.length} passes` };
}

// Shows the state in the controls, and the facts about each side.
function tell() {
  for (const side of SIDES) {
    byId(side).value = state[side];
    const { facts, milliseconds } = drawn[side];
    byId(`${side}Facts`).textContent = milliseconds ? `${facts}, ${milliseconds.toFixed(milliseconds < 100 ? 1 : 0)} ms` : facts;
    byId(`${side}Facts`).className = state[side] === "truth" ? "note" : "";
  }
  byId("divider").style.left = `${100 * state.split}%`;
  byId("divider").setAttribute("aria-valuenow", Math.round(100 * state.split));
  for (const name of ["scene", "preset", "blades"]) byId(name).value = state[name];
  for (const [name, [, , , , forth, , text]] of Object.entries(SLIDERS)) {
    byId(name).previousElementSibling.textContent = text(state[name]);
    if (document.activeElement !== byId(name)) byId(name).value = forth(state[name]);
  }
  tellUnder();
}

// Shows the depth under the pointer, and the circle of confusion, which is the alpha of the map that a method has
// drawn.
function tellUnder() {
  if (!pointer) return;
  const [x, y] = pointer;
  const [width, height] = current.depth.size;
  const metres = current.depth.data[y * width + x];
  const side = SIDES.find((name) => drawn[name]?.name === "result");
  let said = `${x}, ${y}: ${metres.toPrecision(3)} m`;
  if (side) {
    const pixels = Math.abs(view.texel(side, "coc", pointer)[3]) * height;
    const field = metres < state.focus ? "near" : "far";
    said += `, CoC ${pixels.toFixed(1)} pixels${pixels < 0.5 ? "" : ` ${field}`}`;
  }
  byId("under").textContent = said;
}

// Returns a text about the lens with which the scene was ray traced, or "" if the controls have the same lens.
function ofTruth() {
  const traced = tracedLens();
  const same = Object.entries(traced).every(([name, value]) => state[name] === value);
  return same ? "" : `ray traced only at f/${traced.stop.toFixed(1)}, scale ${traced.scale}, ${traced.focus} m, 6 blades`;
}

function tracedLens() {
  const { traced, focal, focus, rotation } = scenes[state.scene];
  return { stop: traced, scale: LENS.scale, focal, focus, rotation, squeeze: 1, blades: 6 };
}

// Shows a scene of the list.
async function choose(index) {
  const scene = scenes[index];
  say("");
  const pictures = scene.color ? scene : await embedded(scene.file);
  if (Math.max(...pictures.color.size) > view.largest()) throw new Error("this image is too large for a texture");
  await after(() => take(index, pictures));
  await reset();
}

function take(index, pictures) {
  view.load(pictures);
  current = pictures;
  pointer = null;
  byId("under").textContent = "point at the image to see its depth";
  for (const side of SIDES) {
    delete drawn[side];
    byId(side).querySelector("[value=truth]").disabled = !pictures.loadTruth;
    if (!pictures.loadTruth && state[side] === "truth") state[side] = "layered";
  }
  const [width, height] = pictures.color.size;
  byId("frame").style.setProperty("--wide", width);
  byId("frame").style.setProperty("--high", height);
  byId("traced").disabled = !pictures.loadTruth;
  state.scene = index;
  // show the input while programs are compiled
  view.show("color", "color", state.split, 1);
}

function reset() {
  const { focal, focus, exposure } = scenes[state.scene];
  pull = null;
  return change({ ...LENS, focal, focus, rotation: 0, squeeze: 1, blades: 6, exposure });
}

// Sets the lens with which the scene was ray traced.
function traced() {
  pull = null;
  return change(current.loadTruth ? tracedLens() : {});
}

// Loads files that the user has dropped or chosen.
async function open(files) {
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

// Focuses on the object under the pointer.
function focusAt(event) {
  point(event);
  const box = byId("canvas").getBoundingClientRect();
  const mark = byId("mark").style;
  const [left, top] = [`${event.clientX - box.left}px`, `${event.clientY - box.top}px`];
  Object.assign(mark, { left, top, transition: "none", opacity: 1 });
  setTimeout(() => Object.assign(mark, { transition: "", opacity: 0 }), 300);
  const metres = current.depth.data[pointer[1] * current.depth.size[0] + pointer[0]];
  if (!(metres > 0)) return; // no depth there
  pull = clamp(metres, 1.5 * state.focal, 1000); // a lens cannot focus nearer than its focal length
  change({});
}

function point(event) {
  const box = byId("canvas").getBoundingClientRect();
  const share = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  pointer = current.depth.size.map((side, axis) => clamp(Math.floor(share[axis] * side), 0, side - 1));
}

function key(event) {
  if (!current || event.ctrlKey || event.altKey || event.metaKey || event.target.matches("select")) return;
  if (event.target.matches("input") && event.key.startsWith("Arrow")) return; // a slider handles its arrows itself
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
    t: traced,
  };
  const digit = /^Digit([1-7])$/.exec(event.code);
  const method = digit && Object.keys(METHODS)[digit[1] - 1];
  if (method && (method !== "truth" || current.loadTruth)) change({ [event.shiftKey ? "right" : "left"]: method });
  else if (event.key in actions) actions[event.key]();
  else return;
  event.preventDefault();
}

function listen() {
  const [canvas, divider] = [byId("canvas"), byId("divider")];
  divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
  divider.addEventListener("pointermove", (event) => {
    if (!divider.hasPointerCapture(event.pointerId)) return;
    const box = canvas.getBoundingClientRect();
    change({ split: clamp((event.clientX - box.left) / box.width, 0, 1) });
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!current) return;
    point(event);
    after(tellUnder);
  });
  let pressed = null;
  canvas.addEventListener("pointerdown", ({ clientX, clientY }) => (pressed = [clientX, clientY]));
  canvas.addEventListener("click", (event) => {
    const moved = pressed ? Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) : 0;
    if (current && moved <= CLICK) focusAt(event);
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
  byId("traced").addEventListener("click", traced);
  byId("copy").addEventListener("click", copy);
  byId("own").addEventListener("click", () => byId("file").click());
  byId("file").addEventListener("change", ({ target }) => open(target.files));
}

async function copy() {
  await navigator.clipboard.writeText(data.install);
  byId("copy").textContent = "copied";
  setTimeout(() => (byId("copy").textContent = "copy"), 2000);
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
  byId("install").firstElementChild.textContent = data.install;
  byId("links").replaceChildren(...data.links.map(([textContent, href]) => Object.assign(document.createElement("a"), { textContent, href })));
  view.open(byId("canvas"), data);
  const select = (name) => labelled(name, name, document.createElement("select"));
  // a scene looks best through the lens that it was made for
  list(select("scene"), [], (index) => choose(Number(index)).then(traced).catch(say));
  list(select("preset"), data.presets.map((name) => [name.toUpperCase(), name]), (preset) => change({ preset }));
  list(select("blades"), Object.keys(data.apertures).map((sides) => [sides, sides]), (sides) => change({ blades: Number(sides) }));
  for (const side of SIDES) {
    list(byId(side), Object.entries(METHODS).map(([name, text]) => [text, name]), (method) => change({ [side]: method }));
  }
  for (const [name, [text, min, max, step, , back]] of Object.entries(SLIDERS)) {
    const input = Object.assign(document.createElement("input"), { type: "range", min, max, step });
    labelled(text, name, input).addEventListener("input", () => change({ [name]: back(Number(input.value)) }));
  }
  listScenes();
  listen();
  await choose(0);
}

const ready = begin();
ready.catch(say);
// For the browser's console, and for the tests in ../test
window.bokeh = { ready, state, change, choose, open, traced, measure: () => after(measure), picture: view.picture };
