// The sample on WebGL 2.

import { Engine } from '@babylonjs/core/Engines/engine.js';
import { show } from './sample.js';

const canvas = document.createElement('canvas');
document.body.append(canvas);
export const sample = show(new Engine(canvas, false));
