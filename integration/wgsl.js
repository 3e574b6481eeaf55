// For the samples: bokeh.wgsl and bokeh_layers.wgsl as one text. A package has a file of this name with the text in it.

const text = async (name) => (await fetch(new URL(`../wgsl/${name}`, import.meta.url))).text();
export const library = (await text('bokeh.wgsl')) + (await text('bokeh_layers.wgsl'));
