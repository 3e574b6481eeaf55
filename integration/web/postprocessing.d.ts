import { Pass } from 'postprocessing';
import type { Camera } from 'three';
import type { PassOptions } from './three.js';
import type { WithLens } from './three-common.js';

/** Depth of field for pmndrs' EffectComposer, which passes it the depth. Add it after the RenderPass. */
export class PolygonBokehPass extends Pass {
  constructor(camera: Camera, options?: PassOptions);
}
export interface PolygonBokehPass extends Omit<WithLens<PassOptions>, 'camera'> {}
