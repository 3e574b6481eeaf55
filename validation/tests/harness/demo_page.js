// What the tests ask of the page of `validation/run demo`: they work its controls as a hand would, and read what it
// shows. The page itself knows nothing of it.

const part = (name) => import(`bokeh/${name}.js`);
const byId = (id) => document.getElementById(id);

async function ready() {
  while (!document.querySelector("script[type=importmap]")) await new Promise(requestAnimationFrame);
  await (await part("main")).ready;
}

// Values of controls, as they are after an "input" or "change" of each, then values of the state, which may lie between
// the steps of a slider. Returns what the page says.
async function set([values, exactly]) {
  const { change, state } = await part("main");
  for (const [id, value] of Object.entries(values)) {
    byId(id).value = value;
    byId(id).dispatchEvent(new Event(byId(id).type === "range" ? "input" : "change"));
  }
  await change(exactly);
  const [facts, under, said] = ["rightFacts", "under", "said"].map((id) => byId(id).textContent);
  return { ...state, facts, under, said };
}

// The pictures of these names on a side, as job.js has them.
async function pictures({ side, names }) {
  const view = await part("view");
  return names.map((name) => view.picture(side, name));
}

// The canvas: base64 of RGBA, first row on top.
async function canvas() {
  const { change } = await part("main");
  await change({});
  const element = byId("canvas");
  const context = new OffscreenCanvas(element.width, element.height).getContext("2d");
  context.drawImage(element, 0, 0);
  return new Uint8Array(context.getImageData(0, 0, element.width, element.height).data.buffer).toBase64();
}

// Give the page files, [[name, base64], ..]; returns what it says.
async function open(files) {
  await (await part("main")).open(files.map(([name, data]) => new File([Uint8Array.fromBase64(data)], name)));
  return byId("said").textContent;
}

async function scene(index) {
  await (await part("main")).choose(index);
}

// From the first call on the focus is noted in every frame; returns what was.
const noted = [];
async function focuses() {
  const { state } = await part("main");
  const note = () => requestAnimationFrame(() => (noted.push(state.focus), note()));
  if (!noted.length) note();
  return noted;
}

window.bokeh = { ready, set, pictures, canvas, open, scene, focuses };
