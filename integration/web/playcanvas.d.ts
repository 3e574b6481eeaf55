import { type AppBase, CameraFrame, type CameraComponent, type Vec3 } from 'playcanvas';
import type { Lens, Options } from './common.js';

/** A CameraFrame with depth of field after TAA, before bloom and tone mapping */
export class PolygonBokehFrame extends CameraFrame {
  constructor(app: AppBase, camera: CameraComponent, options?: Options);
  readonly uniforms: Lens;
  /** 0 the picture, 1 depth, 2 circle of confusion, 3 near and far field */
  debugMode: number;
  /**
   * The lens of the camera's field of view, at an f-stop above 0: 2.8. The blur is bokehScale times as wide as that lens's:
   * 10; 1 is the real lens, 0 is none
   */
  setLens(fStop?: number, bokehScale?: number): void;
  focusOn(point: Vec3): void;
  /** Once a frame of dt seconds, to the nearest of `depths` in metres; tau is the time constant in seconds: 0.2 */
  pullFocus(dt: number, depths: number[], tau?: number): void;
}
