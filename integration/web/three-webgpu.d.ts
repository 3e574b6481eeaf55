import type { Camera } from 'three';
import { type Node, type PassNode, TempNode, type TextureNode } from 'three/webgpu';
import type { ThreeOptions, WithLens } from './three-common.js';

export interface NodeOptions extends ThreeOptions {
  /** A layer that is drawn sharp over the picture, behind what is before it: glass. Scene passes of one sample only */
  sharpLayer?: number;
}

/** Depth of field for RenderPipeline: before bloom and tone mapping. With WebGL 2 nothing is blurred */
export class PolygonBokehNode extends TempNode<'vec4'> {
  /** Of `pass(scene, camera)` */
  constructor(scenePass: PassNode, options?: NodeOptions);
  /** Of any colour, such as a scene pass times ambient occlusion, and of the depth texture that belongs to it */
  constructor(color: Node, depth: TextureNode, camera: Camera, options?: Omit<NodeOptions, 'sharpLayer'>);
}
export interface PolygonBokehNode extends WithLens<NodeOptions> {}
