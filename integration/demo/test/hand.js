// Uses the page's controls as a user does, and reads what the page shows. The functions run in the page.

// Sets controls to `values`, each with its "input" or "change" event. Then sets the state to `exactly`, whose values
// may lie between the steps of a slider. Returns the state, and the texts that the page shows.
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

// Returns the images of a side with these names: [name, image in the form that job.js describes].
export function pictures([side, names]) {
  return names.map((name) => [name, bokeh.picture(side, name)]);
}

// Returns the pixels of the canvas: RGBA in base64, beginning with the top row.
export async function canvas() {
  await bokeh.change({});
  const element = document.getElementById("canvas");
  const context = new OffscreenCanvas(element.width, element.height).getContext("2d");
  context.drawImage(element, 0, 0);
  return new Uint8Array(context.getImageData(0, 0, element.width, element.height).data.buffer).toBase64();
}

// Opens files, [[name, base64], ..], in the page. Returns the message that the page shows.
export async function open(files) {
  await bokeh.open(files.map(([name, data]) => new File([Uint8Array.fromBase64(data)], name)));
  return document.getElementById("said").textContent;
}

// Stores the focus distance in every frame from the first call on. Returns all stored distances.
export function focuses() {
  const noted = (window.noted ??= []);
  const note = () => requestAnimationFrame(() => (noted.push(bokeh.state.focus), note()));
  if (!noted.length) note();
  return noted;
}
