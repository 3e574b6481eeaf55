/** How the image is blurred: `layered` spreads blurred near objects over the sharp background, `exact` blurs each pixel
 * by its own circle of confusion in fewer passes, and `paper` is the method that McIntosh, Riecke and DiPaola
 * published. */
export type Method = 'layered' | 'exact' | 'paper';
export type Sides = 4 | 6 | 8 | 10;
export type Preset = 'MOBILE' | 'LOW' | 'MEDIUM' | 'HIGH' | 'ULTRA';
/** A feature that costs time only if you ask for it. Each one adds settings: see Lens. */
export type Extra = 'jitter' | 'catsEye' | 'lateral' | 'focusRange';

export interface Options {
  /** The method; `layered` by default */
  method?: Method;
  /** Number of sides of the polygon; 6 by default. With `paper`, only 6 and 8 are possible. */
  sides?: Sides;
  /** Number and spacing of samples; `MEDIUM` by default */
  preset?: Preset;
  /** true, the default: the result has an alpha of 1. false: its alpha is the circle of confusion as a fraction of the
   * image height, negative in front of the focus (with `paper`, it has no sign); a canvas would take it for opacity. */
  opaque?: boolean;
  /** The extras to use; none by default */
  extras?: readonly Extra[];
}

/** The settings, with their defaults. Those after `squeeze` exist only if the option `extras` names their extra. */
export interface Lens<T = number> {
  /** Diameter of the aperture in metres; `setLens` sets it. The default is 0.179: f/2.8 with a bokeh scale of 10. */
  apertureDiameter: T;
  /** Focal length in metres; 0.05 by default. `setLens` sets it. */
  focalLength: T;
  /** Focus distance along the view axis, in metres; 5 by default */
  focusDistance: T;
  /** Height of the camera's sensor in metres; 0.024 by default */
  sensorHeight: T;
  /** Largest circle of confusion, as a fraction of the image height; 0.1 by default */
  maxCoC: T;
  /** Rotation of the polygon in radians, clockwise on the screen; 0 by default */
  rotation: T;
  /** Width of the bokeh divided by its height, for anamorphic lenses; 1 by default */
  squeeze: T;
  /** `jitter`: amount of random offset of the samples, for TAA to average out, 0 to 1; 1 by default */
  jitter?: T;
  /** `jitter`: number of the frame, which changes the noise; the effect adds 1 in every frame */
  frame?: T;
  /**
   * `catsEye`: fraction of the bokeh's width that the lens barrel cuts off in the corners of the image, 0 to 0.9; 0.5
   * by default
   */
  catsEye?: T;
  /** `catsEye`, with 8 sides: how curved the blades are, from 0, a square, to 1, a regular octagon; 1 by default */
  roundness?: T;
  /** `lateral`: fraction by which the red image is larger and the blue image smaller, -0.1 to 0.1; 0.001 by default */
  lateral?: T;
  /** `focusRange`: how far in front of the focus distance objects stay sharp, in metres; 0 by default */
  frontRange?: T;
  /** `focusRange`: how far behind the focus distance objects stay sharp, in metres; 0 by default */
  backRange?: T;
  /** `focusRange`: factor of the circle of confusion in front of the focus; 1 by default */
  nearScale?: T;
  /** `focusRange`: factor of the circle of confusion behind the focus; 1 by default */
  farScale?: T;
  /**
   * `focusRange`: largest circle of confusion in front of the focus, as a fraction of the image height; 1 by default
   */
  nearMaxCoC?: T;
  /** `focusRange`: largest circle of confusion behind the focus, as a fraction of the image height; 1 by default */
  farMaxCoC?: T;
}

/** The methods for lens and focus that all classes have */
export interface LensControls {
  /**
   * Sets the focal length and the aperture diameter from the camera's field of view and an f-stop. Call it again after
   * a zoom. An orthographic camera has no field of view, so the focal length stays as it is. Throws an Error if an
   * argument is invalid.
   * @param fStop above 0; 2.8 by default
   * @param bokehScale how many times as wide the blur is as that of a real lens; 10 by default, 0 turns the blur off.
   * At 1 you get the real lens, which barely blurs at a game's field of view (docs/lens.md).
   */
  setLens(fStop?: number, bokehScale?: number): void;
  /**
   * Moves the focus smoothly to the nearest of several depths. Call it in every frame.
   * @param dt time since the last frame, in seconds
   * @param depths metres along the view axis
   * @param tau time constant of the movement, in seconds; 0.2 by default
   */
  pullFocus(dt: number, depths: number[], tau?: number): void;
}
