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
  /** Shows a debug view instead of the result: depth, circle of confusion, or near and far field. None by default. */
  view?: 'depth' | 'coc' | 'focus';
}

/** The members that PolygonBokeh and PolygonBokehTask share */
export interface WithLens {
  camera: Camera;
  readonly uniforms: Lens;
  /**
   * Sets the focal length and the aperture diameter from the camera's field of view and an f-stop. Call it again after
   * a zoom.
   * @param fStop above 0; 2.8 by default
   * @param bokehScale how many times as wide the blur is as that of a real lens; 10 by default, 0 turns the blur off
   */
  setLens(fStop?: number, bokehScale?: number): void;
  /** Focuses on a point of the scene */
  focusOn(point: Vector3): void;
  /** Returns the depth of a point of the scene along the view axis, in metres */
  depthOf(point: Vector3): number;
  /**
   * Moves the focus smoothly to the nearest of several depths. Call it in every frame.
   * @param dt time since the last frame, in seconds
   * @param depths metres along the view axis
   * @param tau time constant of the movement, in seconds; 0.2 by default
   */
  pullFocus(dt: number, depths: number[], tau?: number): void;
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
