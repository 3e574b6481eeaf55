// The sample on WebGPU.

import { WebGPUEngine } from '@babylonjs/core/Engines/webgpuEngine.js';
import { show } from './sample.js';

const canvas = document.createElement('canvas');
document.body.append(canvas);
const engine = new WebGPUEngine(canvas);
await engine.initAsync();
export const sample = show(engine);
