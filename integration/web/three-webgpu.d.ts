import type { Camera } from 'three';
import { TempNode, type PassNode } from 'three/webgpu';
import type { ThreeOptions, WithLens } from './three-common.js';

/** Depth of field of `pass(scene, camera)`, for RenderPipeline: before bloom and tone mapping. WebGPU only */
export class PolygonBokehNode extends TempNode<'vec4'> {
  constructor(scenePass: PassNode, options?: ThreeOptions);
}
export interface PolygonBokehNode extends WithLens<ThreeOptions> {}
