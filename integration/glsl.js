// For the samples: bokeh.glsl and bokeh_layers.glsl as one text. A package has a file of this name with the text in it.

const text = async (name) => (await fetch(new URL(`../glsl/${name}`, import.meta.url))).text();
export const library = (await text('bokeh.glsl')) + (await text('bokeh_layers.glsl'));
