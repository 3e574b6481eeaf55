import { type AppBase, CameraFrame, type CameraComponent, type Vec3 } from 'playcanvas';
import type { Lens, LensControls, Options } from './common.js';

/** A CameraFrame with depth of field, which runs after TAA, and before bloom and tone mapping */
export class PolygonBokehFrame extends CameraFrame {
  constructor(app: AppBase, camera: CameraComponent, options?: Options);
  readonly uniforms: Lens;
  /** What the frame shows: 0 the result, 1 depth, 2 circle of confusion, 3 near and far field */
  debugMode: number;
  /** Focuses on a point of the scene */
  focusOn(point: Vec3): void;
}
export interface PolygonBokehFrame extends LensControls {}
