import { Pass } from 'postprocessing';
import type { Camera } from 'three';
import type { PassOptions } from './three.js';
import type { WithLens } from './three-common.js';

/** Depth of field after the RenderPass of pmndrs' EffectComposer, which gives it depth */
export class PolygonBokehPass extends Pass {
  constructor(camera: Camera, options?: PassOptions);
}
export interface PolygonBokehPass extends Omit<WithLens<PassOptions>, 'camera'> {}
