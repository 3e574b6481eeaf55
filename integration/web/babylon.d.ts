import type { Camera } from '@babylonjs/core/Cameras/camera.js';
import type { FrameGraph } from '@babylonjs/core/FrameGraph/frameGraph.js';
import { FrameGraphTask } from '@babylonjs/core/FrameGraph/frameGraphTask.js';
import type { FrameGraphTextureHandle } from '@babylonjs/core/FrameGraph/frameGraphTypes.js';
import type { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import type { DepthRenderer } from '@babylonjs/core/Rendering/depthRenderer.js';
import type { Lens, LensControls, Options } from './common.js';

export interface BabylonOptions extends Options {
  method?: 'layered' | 'exact';
  /** Shows a debug view instead of the result: depth, circle of confusion, or near and far field. None by default. */
  view?: 'depth' | 'coc' | 'focus';
}

/** The members that PolygonBokeh and PolygonBokehTask share */
export interface WithLens extends LensControls {
  camera: Camera;
  readonly uniforms: Lens;
  /** Focuses on a point of the scene */
  focusOn(point: Vector3): void;
  /** Returns the depth of a point of the scene along the view axis, in metres */
  depthOf(point: Vector3): number;
}

/** Depth of field as a post process. It attaches itself as the first post process of its camera. */
export class PolygonBokeh extends PostProcess {
  constructor(camera: Camera, options?: BabylonOptions);
  readonly passes: readonly unknown[];
  readonly depth: DepthRenderer;
}
export interface PolygonBokeh extends WithLens {}

/** Depth of field as a task of a frame graph. Add it before bloom and image processing. */
export class PolygonBokehTask extends FrameGraphTask {
  constructor(name: string, frameGraph: FrameGraph, camera: Camera, options?: BabylonOptions);
  /** The linear colour of the scene */
  sourceTexture?: FrameGraphTextureHandle;
  /** The screen depth in 32-bit floats: geometryScreenDepthTexture of a FrameGraphGeometryRendererTask */
  depthTexture?: FrameGraphTextureHandle;
  /** The texture to draw into; if you leave it out, the task creates one */
  targetTexture?: FrameGraphTextureHandle;
  readonly outputTexture: FrameGraphTextureHandle;
  record(skipCreationOfDisabledPasses?: boolean): void;
}
export interface PolygonBokehTask extends WithLens {}
