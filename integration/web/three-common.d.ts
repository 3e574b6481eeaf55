import type { Camera, Object3D, Scene, Vector2 } from 'three';
import type { Lens, Options, Preset, Sides } from './common.js';

export interface ThreeOptions extends Options {
  /** true: colour has a share of the page in alpha, premultiplied, and is blurred with it. Twice the cost. */
  alpha?: boolean;
}

export interface Uniforms extends Lens<{ value: number }> {
  /** 0 the picture, 1 depth, 2 circle of confusion, 3 near and far field */
  debugMode: { value: number };
  imageSize: { value: Vector2 };
}

type Place = { x: number; y: number; z: number } | Object3D;

/** What PolygonBokehPass and PolygonBokehNode share. */
export interface WithLens<Given> {
  camera: Camera;
  readonly options: Required<Omit<Given, 'depthTexture'>>;
  readonly uniforms: Uniforms;
  readonly passes: readonly unknown[];
  /** Bytes of its targets */
  readonly memory: number;
  /**
   * The lens of the camera's field of view, at an f-stop above 0: 2.8. The blur is bokehScale times as wide as that lens's:
   * 10; 1 is the real lens, 0 is none
   */
  setLens(fStop?: number, bokehScale?: number): void;
  /** Metres along the view axis, of a place in the world or an object */
  depthOf(place: Place): number;
  focusOn(place: Place): void;
  /** Once a frame of dt seconds, to the nearest of `depths` in metres; tau is the time constant in seconds: 0.2 */
  pullFocus(dt: number, depths: number[], tau?: number): void;
  /** Metres under points of the view, (-1, -1) lower left; Infinity where nothing is */
  depthsUnder(points: readonly (readonly [number, number])[], scene: Scene): number[];
  /** A click focuses on what is there; `draw` is called after each step of a pull. */
  focusByClicks(
    canvas: HTMLElement,
    scene: Scene,
    draw?: () => void,
    tau?: number,
  ): { readonly pulling: boolean; dispose(): void };
  /** Resolves when the next frame has them; shaders are compiled beside the frames until then. */
  change(options: Given): Promise<void>;
  setPreset(preset: Preset): Promise<void>;
  setSides(sides: Sides): Promise<void>;
  setCamera(camera: Camera): void;
}
