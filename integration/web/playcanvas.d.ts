import { type AppBase, CameraFrame, type CameraComponent, type Vec3 } from 'playcanvas';
import type { Lens, Options } from './common.js';

/** A CameraFrame with depth of field, which runs after TAA, and before bloom and tone mapping */
export class PolygonBokehFrame extends CameraFrame {
  constructor(app: AppBase, camera: CameraComponent, options?: Options);
  readonly uniforms: Lens;
  /** What the frame shows: 0 the result, 1 depth, 2 circle of confusion, 3 near and far field */
  debugMode: number;
  /**
   * Sets the focal length and the aperture diameter from the camera's field of view and an f-stop. Call it again after
   * a zoom.
   * @param fStop above 0; 2.8 by default
   * @param bokehScale how many times as wide the blur is as that of a real lens; 10 by default, 0 turns the blur off
   */
  setLens(fStop?: number, bokehScale?: number): void;
  /** Focuses on a point of the scene */
  focusOn(point: Vec3): void;
  /**
   * Moves the focus smoothly to the nearest of several depths. Call it in every frame.
   * @param dt time since the last frame, in seconds
   * @param depths metres along the view axis
   * @param tau time constant of the movement, in seconds; 0.2 by default
   */
  pullFocus(dt: number, depths: number[], tau?: number): void;
}
