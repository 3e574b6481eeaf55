// This package's pass for three.js, as npm installs it.

import { DepthTexture, FloatType } from "three";
import { PolygonBokehPass } from "polygonal-bokeh/three.js";
import { composed } from "./three_webgl.js";

export const polygonBokeh = (method, preset) => (handed) =>
  composed(
    handed,
    ({ camera }) => new PolygonBokehPass(camera, { method, preset }),
    new DepthTexture(handed.width, handed.height, FloatType),
  );
