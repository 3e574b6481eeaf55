// What the tests ask of the page of `validation/run demo`: they work its controls as a hand would, and read what it
// shows. The page itself knows nothing of it.

const part = (name) => import(`bokeh/${name}.js`);
const byId = (id) => document.getElementById(id);

// Values of controls, as they are after an "input" or "change" of each; then what the page says.
async function set(values) {
  const { change, settled, state } = await part("main");
  for (const [id, value] of Object.entries(values)) {
    const element = byId(id);
    // what lies between the steps of a slider is set as by the scene's lens
    if (element.type === "range" && value.exactly !== undefined) {
      change({ [id]: value.exactly });
      continue;
    }
    element.value = value;
    element.dispatchEvent(new Event(element.type === "range" ? "input" : "change"));
  }
  await settled();
  const facts = ["leftFacts", "rightFacts", "under", "said"].map((id) => [id, byId(id).textContent]);
  return { state, ...Object.fromEntries(facts) };
}

// The pictures of these names on a side, as job.js has them.
async function pictures({ side, names }) {
  const { view } = await part("main");
  return Promise.all(names.map((name) => view.picture(side, name)));
}

// The canvas: base64 of RGBA, first row on top.
async function canvas() {
  const { settled, change } = await part("main");
  change({});
  await settled();
  const element = byId("canvas");
  const context = new OffscreenCanvas(element.width, element.height).getContext("2d");
  context.drawImage(element, 0, 0);
  return new Uint8Array(context.getImageData(0, 0, element.width, element.height).data.buffer).toBase64();
}

// A pointer at a place of the picture, texels; "click" or "pointermove".
async function point({ kind, place }) {
  const { settled, state, under } = await part("main");
  const element = byId("canvas");
  const box = element.getBoundingClientRect();
  const [clientX, clientY] = place.map(
    (texel, axis) => [box.left, box.top][axis] + ((texel + 0.5) * [box.width, box.height][axis]) / [element.width, element.height][axis],
  );
  const kinds = { click: MouseEvent, pointermove: PointerEvent };
  const seen = [];
  element.dispatchEvent(new kinds[kind](kind, { clientX, clientY, bubbles: true }));
  const watch = setInterval(() => seen.push(state.focus), 1);
  await settled();
  clearInterval(watch);
  return { state, under: await under(), seen };
}

async function press({ key, code = "", shiftKey = false }) {
  const { settled, state } = await part("main");
  dispatchEvent.call(document.body, new KeyboardEvent("keydown", { key, code, shiftKey, bubbles: true }));
  await settled();
  return { ...state };
}

// Files that are dropped onto the page: [[name, base64], ..]
async function drop(files) {
  const { open, settled, state } = await part("main");
  await open(files.map(([name, data]) => new File([Uint8Array.fromBase64(data)], name)));
  await settled();
  return { state, said: byId("said").textContent };
}

async function scene(index) {
  const { choose, state } = await part("main");
  await choose(index);
  return state;
}

// The passes that the page draws for settings, without their programs' common text.
async function frames(all) {
  const { frame } = await part("plan");
  const data = JSON.parse(byId("data").textContent);
  return all.map(([settings, size]) =>
    frame(data, settings, size).map((pass) => ({ ...pass, fragment: pass.fragment.replace(data.glsl, "") })),
  );
}

async function ready() {
  await (await part("main")).ready;
}

window.bokeh = { ready, set, pictures, canvas, point, press, drop, scene, frames };
