import type { Camera } from '@babylonjs/core/Cameras/camera.js';
import type { FrameGraph } from '@babylonjs/core/FrameGraph/frameGraph.js';
import { FrameGraphTask } from '@babylonjs/core/FrameGraph/frameGraphTask.js';
import type { FrameGraphTextureHandle } from '@babylonjs/core/FrameGraph/frameGraphTypes.js';
import type { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import type { DepthRenderer } from '@babylonjs/core/Rendering/depthRenderer.js';
import type { Lens, Options } from './common.js';

export interface BabylonOptions extends Options {
  method?: 'layered' | 'exact';
  /** In place of the result: depth, circle of confusion, near and far field */
  view?: 'depth' | 'coc' | 'focus';
}

/** What PolygonBokeh and PolygonBokehTask share */
export interface WithLens {
  camera: Camera;
  readonly uniforms: Lens;
  /**
   * The lens of the camera's field of view, at an f-stop above 0: 2.8. The blur is bokehScale times as wide as that lens's:
   * 10; 1 is the real lens, 0 is none
   */
  setLens(fStop?: number, bokehScale?: number): void;
  focusOn(point: Vector3): void;
  /** Metres along the view axis */
  depthOf(point: Vector3): number;
  /** Once a frame of dt seconds, to the nearest of `depths` in metres; tau is the time constant in seconds: 0.2 */
  pullFocus(dt: number, depths: number[], tau?: number): void;
}

/** Depth of field, the first post process of its camera */
export class PolygonBokeh extends PostProcess {
  constructor(camera: Camera, options?: BabylonOptions);
  readonly passes: readonly unknown[];
  readonly depth: DepthRenderer;
}
export interface PolygonBokeh extends WithLens {}

/** Depth of field as a task of a frame graph: before bloom and image processing */
export class PolygonBokehTask extends FrameGraphTask {
  constructor(name: string, frameGraph: FrameGraph, camera: Camera, options?: BabylonOptions);
  /** The scene's colours, linear */
  sourceTexture?: FrameGraphTextureHandle;
  /** geometryScreenDepthTexture of a FrameGraphGeometryRendererTask, 32-bit floats */
  depthTexture?: FrameGraphTextureHandle;
  /** What is written; left out, a texture of its own */
  targetTexture?: FrameGraphTextureHandle;
  readonly outputTexture: FrameGraphTextureHandle;
  record(skipCreationOfDisabledPasses?: boolean): void;
}
export interface PolygonBokehTask extends WithLens {}
