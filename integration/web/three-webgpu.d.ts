import type { Camera } from 'three';
import { type Node, type PassNode, TempNode, type TextureNode } from 'three/webgpu';
import type { ThreeOptions, WithLens } from './three-common.js';

export interface NodeOptions extends ThreeOptions {
  /**
   * A layer whose objects are drawn sharp after the bokeh, and hidden by nearer objects: for glass. It needs a scene
   * pass with one sample per pixel.
   */
  sharpLayer?: number;
}

/** Depth of field for RenderPipeline. Use it before bloom and tone mapping. With WebGL 2, nothing is blurred. */
export class PolygonBokehNode extends TempNode<'vec4'> {
  /** Blurs the scene of a scene pass, `pass(scene, camera)` */
  constructor(scenePass: PassNode, options?: NodeOptions);
  /** Blurs any colour, such as a scene pass times ambient occlusion, with the depth texture that belongs to it */
  constructor(color: Node, depth: TextureNode, camera: Camera, options?: Omit<NodeOptions, 'sharpLayer'>);
}
export interface PolygonBokehNode extends WithLens<NodeOptions> {}
