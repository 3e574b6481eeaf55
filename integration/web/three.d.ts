import type { Camera, Scene, Texture } from 'three';
import { Pass } from 'three/addons/postprocessing/Pass.js';
import type { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import type { ThreeOptions, WithLens } from './three-common.js';

export interface PassOptions extends ThreeOptions {
  /** Depth of the scene, if it is not the depth of the composer's target */
  depthTexture?: Texture;
}

/** Depth of field for EffectComposer. Add it after a RenderPass, and before bloom and OutputPass. */
export class PolygonBokehPass extends Pass {
  constructor(camera: Camera, options?: PassOptions);
}
export interface PolygonBokehPass extends WithLens<PassOptions> {}

/**
 * Returns a texture for the option `depthTexture`, with a copy of the depth that a RenderPass draws. You need it if
 * there are passes between the RenderPass and the bokeh, because they clear the depth.
 */
export function depthOf(renderPass: RenderPass): Texture;

/**
 * Returns a texture for the option `depthTexture`, with depth weighted by opacity: a pixel of glass, particles or hair
 * is then blurred as if it lay between the surface and the background. The scene is drawn a second time for this.
 */
export function depthWithOpacity(renderPass: RenderPass): Texture;

/**
 * Draws the objects of a layer (1 by default) sharp, and hidden by nearer objects: for glass. Add it after the bokeh,
 * and put the objects on this layer.
 */
export class SharpPass extends Pass {
  constructor(bokeh: PolygonBokehPass, scene: Scene, layer?: number);
}
