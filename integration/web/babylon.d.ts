import type { Camera } from '@babylonjs/core/Cameras/camera.js';
import type { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import type { DepthRenderer } from '@babylonjs/core/Rendering/depthRenderer.js';
import type { Lens, Options } from './common.js';

export interface BabylonOptions extends Options {
  method?: 'layered' | 'exact';
  /** In place of the result: depth, circle of confusion, near and far field */
  view?: 'depth' | 'coc' | 'focus';
}

/** Depth of field, the first post process of its camera */
export class PolygonBokeh extends PostProcess {
  constructor(camera: Camera, options?: BabylonOptions);
  readonly uniforms: Lens;
  readonly passes: readonly unknown[];
  readonly depth: DepthRenderer;
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
