// What the tests ask of the page of `validation/run demo`: they work its controls as a hand would, and read what it
// shows. The page itself knows nothing of it.

const part = (name) => import(`bokeh/${name}.js`);
const byId = (id) => document.getElementById(id);

async function ready() {
  while (!document.querySelector("script[type=importmap]")) await new Promise(requestAnimationFrame);
  await (await part("main")).ready;
}

// Values of controls, as they are after an "input" or "change" of each; then what the page says.
async function set(values) {
  const { change, settled, state } = await part("main");
  for (const [id, value] of Object.entries(values)) {
    const element = byId(id);
    // what lies between the steps of a slider is set as by the scene's lens
    if (value.exactly !== undefined) change({ [id]: value.exactly });
    else {
      element.value = value;
      element.dispatchEvent(new Event(element.type === "range" ? "input" : "change"));
    }
  }
  await settled();
  const facts = ["leftFacts", "rightFacts", "under", "said"].map((id) => [id, byId(id).textContent]);
  return { state, ...Object.fromEntries(facts) };
}

// The pictures of these names on a side, as job.js has them.
async function pictures({ side, names }) {
  const view = await part("view");
  return names.map((name) => view.picture(side, name));
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

// Files that are dropped onto the page: [[name, base64], ..]
async function drop(files) {
  const { open, settled, state } = await part("main");
  await open(files.map(([name, data]) => new File([Uint8Array.fromBase64(data)], name)));
  await settled();
  return { state, said: byId("said").textContent };
}

async function scene(index) {
  const { choose, under, state } = await part("main");
  if (index !== null) await choose(index);
  return { ...state, under: await under() };
}

// The passes that the page draws for settings, without their programs' common text.
async function frames(all) {
  const { frame } = await part("plan");
  const data = JSON.parse(byId("data").textContent);
  return all.map(([settings, size]) =>
    frame(data, settings, size).map((pass) => ({ ...pass, fragment: pass.fragment.replace(data.glsl, "") })),
  );
}

window.bokeh = { ready, set, pictures, canvas, drop, scene, frames };
