import type { Camera } from 'three';
import { TempNode, type PassNode } from 'three/webgpu';
import type { ThreeOptions, WithLens } from './three-common.js';

export interface NodeOptions extends ThreeOptions {
  /** A layer that is drawn sharp over the picture, behind what is before it: glass. Scene passes of one sample only */
  sharpLayer?: number;
}

/** Depth of field of `pass(scene, camera)`, for RenderPipeline: before bloom and tone mapping. With WebGL 2 nothing is blurred */
export class PolygonBokehNode extends TempNode<'vec4'> {
  constructor(scenePass: PassNode, options?: NodeOptions);
}
export interface PolygonBokehNode extends WithLens<NodeOptions> {}
