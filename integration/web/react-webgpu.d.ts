import type { ReactElement, Ref } from 'react';
import type { Camera } from 'three';
import type { Node, PassNode, TextureNode } from 'three/webgpu';
import type { PolygonBokehProps as Props } from './react.js';
import type { PolygonBokehNode } from './three-webgpu.js';

export interface PolygonBokehProps extends Omit<Props, 'ref'> {
  /**
   * A layer whose objects are drawn sharp after the bokeh, for example glass. It does not work together with `before`.
   */
  sharpLayer?: number;
  /**
   * Adds nodes between the scene and the bokeh, such as ambient occlusion. Returns the colour to blur, and the depth
   * texture that belongs to it.
   */
  before?: (scenePass: PassNode, camera: Camera) => readonly [Node, TextureNode];
  /** Adds nodes after the bokeh, such as bloom. Returns the node to show. */
  after?: (bokeh: PolygonBokehNode, scenePass: PassNode) => Node;
  ref?: Ref<PolygonBokehNode>;
}

/**
 * Depth of field for react-three-fiber with WebGPURenderer. Put it directly into <Canvas>; it draws every frame itself.
 */
export function PolygonBokeh(props: PolygonBokehProps): ReactElement | null;
