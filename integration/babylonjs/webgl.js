// The sample on WebGL 2.

import { Engine } from '@babylonjs/core/Engines/engine.js';
import { start } from './sample.js';

const canvas = document.createElement('canvas');
document.body.append(canvas);
export const sample = await start(new Engine(canvas, false));
