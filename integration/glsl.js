// For the samples: the files of the library that they call, as one text. A package has a file of this name with the text
// in it.

const text = async (name) => (await fetch(new URL(`../glsl/${name}.glsl`, import.meta.url))).text();
export const library = (await Promise.all(['bokeh', 'bokeh_paper', 'bokeh_layers'].map(text))).join('');
