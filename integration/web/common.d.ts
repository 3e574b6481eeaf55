/** How the picture is blurred: `layered` spreads near objects over what is behind them, `exact` blurs each pixel by its
 * own circle of confusion in fewer passes, `paper` is McIntosh's own. */
export type Method = 'layered' | 'exact' | 'paper';
export type Sides = 4 | 6 | 8 | 10;
export type Preset = 'MOBILE' | 'LOW' | 'MEDIUM' | 'HIGH' | 'ULTRA';
/** What costs something only where it is asked for, each with its uniforms. */
export type Extra = 'jitter' | 'catsEye' | 'lateral' | 'focusRange';

export interface Options {
  /** `layered` */
  method?: Method;
  /** Of the aperture: 6; `paper` has 6 and 8 */
  sides?: Sides;
  /** Samples: `MEDIUM` */
  preset?: Preset;
  /** true: alpha is 1. false: it is the signed circle of confusion, fraction of the image height. */
  opaque?: boolean;
  /** none */
  extras?: readonly Extra[];
}

/** What is to be set from outside, with its default. Those after `squeeze` are there where `extras` has them. */
export interface Lens<T = number> {
  /** Metres: 0.179, f/2.8 and ten times as wide. `setLens` sets it. */
  apertureDiameter: T;
  /** Metres: 0.05. `setLens` sets it. */
  focalLength: T;
  /** Metres along the view axis: 5 */
  focusDistance: T;
  /** Metres: 0.024 */
  sensorHeight: T;
  /** The largest circle of confusion, fraction of the image height: 0.1 */
  maxCoC: T;
  /** Of the polygon, clockwise on the screen, radians: 0 */
  rotation: T;
  /** Anamorphic: its width over its height: 1 */
  squeeze: T;
  /** `jitter`: noise on the samples' places, 0 to 1: 1 */
  jitter?: T;
  /** `jitter`: the number of the frame; it counts up by itself */
  frame?: T;
  /** `catsEye`: what the barrel cuts off in the corners, 0 to 0.9: 0.5 */
  catsEye?: T;
  /** `catsEye`: curved blades, 8 sides: 0 a square to 1 regular, its default */
  roundness?: T;
  /** `lateral`: the share of its size that red is larger by, -0.1 to 0.1: 0.001 */
  lateral?: T;
  /** `focusRange`: metres before the focus that stay sharp: 0 */
  frontRange?: T;
  /** `focusRange`: metres behind it: 0 */
  backRange?: T;
  /** `focusRange`: factor of the circle of confusion before the focus: 1 */
  nearScale?: T;
  /** `focusRange`: behind it: 1 */
  farScale?: T;
  /** `focusRange`: limit before the focus, fraction of the image height: 1 */
  nearMaxCoC?: T;
  /** `focusRange`: behind it: 1 */
  farMaxCoC?: T;
}
