import type { ReactElement, Ref, RefObject } from 'react';
import type { Object3D, Vector3 } from 'three';
import type { Lens } from './common.js';
import type { PolygonBokehPass } from './postprocessing.js';
import type { ThreeOptions } from './three-common.js';

type Set = Omit<Lens, 'apertureDiameter' | 'focalLength' | 'focusDistance'>;

export interface PolygonBokehProps extends ThreeOptions, Partial<Set> {
  /** f-stop of the lens; 2.8 by default */
  fStop?: number;
  /** How many times as wide the blur is as that of a real lens; 10 by default, 0 turns the blur off */
  bokehScale?: number;
  /** Focus distance along the view axis in metres (5 by default), or the point or object in focus */
  focus?: number | Vector3 | Object3D | RefObject<Object3D | null>;
  /** Time constant of the movement to another focus, in seconds; with 0, the default, the focus jumps */
  tau?: number;
  /** What is shown: 0 the result, 1 depth, 2 circle of confusion, 3 near and far field */
  debugMode?: number;
  ref?: Ref<PolygonBokehPass>;
}

/**
 * Depth of field. Put it into <EffectComposer> of @react-three/postprocessing, before <Bloom /> and <ToneMapping />.
 */
export function PolygonBokeh(props: PolygonBokehProps): ReactElement;
