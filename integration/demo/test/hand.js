// Works the page's controls as a hand would, and reads what it shows. The functions run in the page.

// Set controls to values, as they are after an "input" or "change" of each, then values of the state, which may lie between
// the steps of a slider. Returns what the page says.
export async function set([values, exactly]) {
  const byId = (id) => document.getElementById(id);
  for (const [id, value] of Object.entries(values)) {
    byId(id).value = value;
    byId(id).dispatchEvent(new Event(byId(id).type === "range" ? "input" : "change"));
  }
  await bokeh.change(exactly);
  const [facts, under, said] = ["rightFacts", "under", "said"].map((id) => byId(id).textContent);
  return { ...bokeh.state, facts, under, said };
}

// The pictures of these names on a side: [name, image as job.js has it].
export function pictures([side, names]) {
  return names.map((name) => [name, bokeh.picture(side, name)]);
}

// The canvas: RGBA in base64, first row on top.
export async function canvas() {
  await bokeh.change({});
  const element = document.getElementById("canvas");
  const context = new OffscreenCanvas(element.width, element.height).getContext("2d");
  context.drawImage(element, 0, 0);
  return new Uint8Array(context.getImageData(0, 0, element.width, element.height).data.buffer).toBase64();
}

// Give the page files, [[name, base64], ..]; returns what it says.
export async function open(files) {
  await bokeh.open(files.map(([name, data]) => new File([Uint8Array.fromBase64(data)], name)));
  return document.getElementById("said").textContent;
}

// Note the focus in every frame from the first call on; returns what was noted.
export function focuses() {
  const noted = (window.noted ??= []);
  const note = () => requestAnimationFrame(() => (noted.push(bokeh.state.focus), note()));
  if (!noted.length) note();
  return noted;
}
