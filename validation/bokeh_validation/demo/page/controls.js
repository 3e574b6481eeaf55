// The controls below the picture. A slider shows the state and changes it; the state may lie between its steps.

const percent = (value) => value.toFixed(2);

// name -> text, least, most and step of the slider, of what function of the value (and back), and how it is written
const SLIDERS = {
  stop: ["f-stop", -1.6, 4, 0.05, Math.log2, (x) => 2 ** x, (v) => `f/${v < 10 ? v.toFixed(2) : v.toFixed(1)}`],
  focus: ["focus", -1, 6, 0.01, Math.log2, (x) => 2 ** x, (v) => `${v.toPrecision(3)} m`],
  focal: ["focal", 24, 135, 1, (v) => 1000 * v, (x) => x / 1000, (v) => `${(1000 * v).toFixed(0)} mm`],
  rotation: ["rotation", 0, 90, 1, Number, Number, (v) => `${v.toFixed(0)}\u00b0`],
  squeeze: ["squeeze", 0.5, 2, 0.05, Number, Number, percent],
  exposure: ["exposure", -4, 4, 0.1, Math.log2, (x) => 2 ** x, (v) => `${Math.log2(v).toFixed(1)} EV`],
};

const inputs = {};

// Make them in an element. change(changes) is called by all but the scene's, which calls choose(number).
export function controls(element, { apertures, presets }, change, choose) {
  const scene = select(element, "scene", "scene", []);
  scene.addEventListener("change", () => choose(Number(scene.value)));
  const preset = select(element, "preset", "preset", presets.map((name) => [name.toUpperCase(), name]));
  preset.title = "of exact and layered; paper has 13 samples a line";
  preset.addEventListener("change", () => change({ preset: preset.value }));
  const blades = select(element, "blades", "blades", Object.keys(apertures).map((sides) => [sides, sides]));
  blades.addEventListener("change", () => change({ blades: Number(blades.value) }));
  for (const [name, [text, least, most, step, , back]] of Object.entries(SLIDERS)) {
    const input = document.createElement("input");
    Object.assign(input, { type: "range", id: name, min: least, max: most, step });
    input.addEventListener("input", () => change({ [name]: back(Number(input.value)) }));
    labelled(element, text, input);
  }
}

function select(element, id, text, options) {
  const list = document.createElement("select");
  list.id = id;
  list.replaceChildren(...options.map(([shown, value]) => new Option(shown, value)));
  labelled(element, text, list);
  return list;
}

function labelled(element, text, input) {
  const label = document.createElement("label");
  const name = document.createElement("span");
  name.textContent = text;
  label.append(name, document.createElement("output"), input);
  element.append(label);
  inputs[input.id] = input;
}

// Show a state.
export function shown(state) {
  for (const side of ["left", "right"]) document.getElementById(side).value = state[side];
  for (const [name, input] of Object.entries(inputs)) {
    const [, , , , forth, , text] = SLIDERS[name] ?? [];
    if (forth) input.previousElementSibling.textContent = text(state[name]);
    if (document.activeElement !== input || !forth) input.value = forth ? forth(state[name]) : state[name];
  }
}
