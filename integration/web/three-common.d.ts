import type { Camera, Object3D, Scene, Vector2 } from 'three';
import type { Lens, LensControls, Options, Preset, Sides } from './common.js';

export interface ThreeOptions extends Options {
  /**
   * Set it to true for a transparent canvas: alpha is then blurred too, and colour must be premultiplied. This takes
   * twice as long. false by default.
   */
  alpha?: boolean;
}

export interface Uniforms extends Lens<{ value: number }> {
  /** What is shown: 0 the result, 1 depth, 2 circle of confusion, 3 near and far field */
  debugMode: { value: number };
  imageSize: { value: Vector2 };
}

type Place = { x: number; y: number; z: number } | Object3D;

/** The members that PolygonBokehPass and PolygonBokehNode share */
export interface WithLens<Given> extends LensControls {
  camera: Camera;
  readonly options: Required<Omit<Given, 'depthTexture'>>;
  readonly uniforms: Uniforms;
  readonly passes: readonly unknown[];
  /** Size of the effect's own render targets in bytes */
  readonly memory: number;
  /** Returns the depth of a point of the scene or of an object along the view axis, in metres */
  depthOf(place: Place): number;
  /** Focuses on a point of the scene or on an object */
  focusOn(place: Place): void;
  /**
   * Returns the depths of the visible objects under points of the view, in metres, and Infinity where there is none
   * @param points [x, y], from (-1, -1) at the lower left to (1, 1) at the upper right
   */
  depthsUnder(points: readonly (readonly [number, number])[], scene: Scene): number[];
  /**
   * From now on, focuses on what the user clicks on. To stop, call dispose() of the result.
   * @param draw called after each step of the focus; leave it out if you have a render loop
   * @param tau time constant of the movement of the focus, in seconds; 0.2 by default
   */
  focusByClicks(
    canvas: HTMLElement,
    scene: Scene,
    draw?: () => void,
    tau?: number,
  ): { readonly pulling: boolean; dispose(): void };
  /**
   * Changes some of the options. The promise resolves when the new shaders are compiled: the next frame is drawn with
   * the new options. Until then, frames look as before.
   */
  change(options: Given): Promise<void>;
  setPreset(preset: Preset): Promise<void>;
  setSides(sides: Sides): Promise<void>;
  setCamera(camera: Camera): void;
}
