import type { Camera, Scene, Texture } from 'three';
import { Pass } from 'three/addons/postprocessing/Pass.js';
import type { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import type { ThreeOptions, WithLens } from './three-common.js';

export interface PassOptions extends ThreeOptions {
  /** Of the scene, where it is not that of the composer's target */
  depthTexture?: Texture;
}

/** Depth of field after a RenderPass, before bloom and OutputPass */
export class PolygonBokehPass extends Pass {
  constructor(camera: Camera, options?: PassOptions);
}
export interface PolygonBokehPass extends WithLens<PassOptions> {}

/** For `depthTexture`, where passes stand between a RenderPass and the bokeh: a copy of the depth that it drew */
export function depthOf(renderPass: RenderPass): Texture;

/**
 * For `depthTexture`: the scene is drawn once more, for its depth weighted by opacity. Glass, particles and hair then get a
 * blur between their own and that of what is behind them
 */
export function depthWithOpacity(renderPass: RenderPass): Texture;

/** After the bokeh: what is on a layer of its own (1), sharp over the picture, behind what is before it: glass */
export class SharpPass extends Pass {
  constructor(bokeh: PolygonBokehPass, scene: Scene, layer?: number);
}
