import type { ReactElement, Ref, RefObject } from 'react';
import type { Object3D, Vector3 } from 'three';
import type { Lens } from './common.js';
import type { PolygonBokehPass } from './postprocessing.js';
import type { ThreeOptions } from './three-common.js';

type Set = Omit<Lens, 'apertureDiameter' | 'focalLength' | 'focusDistance'>;

export interface PolygonBokehProps extends ThreeOptions, Partial<Set> {
  /** Of the lens: 2.8 */
  fStop?: number;
  /** How many times wider the blur is than that lens's: 10; 1 is the real lens, 0 is none */
  bokehScale?: number;
  /** Metres along the view axis, or what is in focus: 5 */
  focus?: number | Vector3 | Object3D | RefObject<Object3D | null>;
  /** Seconds: the time constant of a pull to another focus; 0, the default: at once */
  tau?: number;
  /** 0 the picture, 1 depth, 2 circle of confusion, 3 near and far field */
  debugMode?: number;
  ref?: Ref<PolygonBokehPass>;
}

/** In the EffectComposer of @react-three/postprocessing, before <Bloom /> and <ToneMapping /> */
export function PolygonBokeh(props: PolygonBokehProps): ReactElement;
