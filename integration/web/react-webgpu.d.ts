import type { ReactElement, Ref } from 'react';
import type { Camera } from 'three';
import type { Node, PassNode, TextureNode } from 'three/webgpu';
import type { PolygonBokehProps as Props } from './react.js';
import type { PolygonBokehNode } from './three-webgpu.js';

export interface PolygonBokehProps extends Omit<Props, 'ref'> {
  /** A layer that is drawn sharp over the picture: glass. Not together with `before` */
  sharpLayer?: number;
  /** Nodes between the scene and the bokeh, such as ambient occlusion: colour, and the depth texture that belongs to it */
  before?: (scenePass: PassNode, camera: Camera) => readonly [Node, TextureNode];
  /** What is shown, such as bloom */
  after?: (bokeh: PolygonBokehNode, scenePass: PassNode) => Node;
  ref?: Ref<PolygonBokehNode>;
}

/** In the <Canvas> of react-three-fiber with WebGPURenderer: it draws the frame */
export function PolygonBokeh(props: PolygonBokehProps): ReactElement | null;
