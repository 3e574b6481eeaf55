// The sample on WebGL 2.

import { Engine } from '@babylonjs/core/Engines/engine.js';
import { start } from './sample.js';

const text = async (name) => (await fetch(`../../glsl/${name}`)).text();
const library = (await text('bokeh.glsl')) + (await text('bokeh_layers.glsl'));

const canvas = document.createElement('canvas');
document.body.append(canvas);
export const sample = await start(new Engine(canvas, false), library);
