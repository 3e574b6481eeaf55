// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for pmndrs' postprocessing: a Pass for its EffectComposer, which passes it the depth. Add it after
// the RenderPass. An EffectPass after it applies tone mapping and encodes the image as sRGB.

import { Pass } from 'postprocessing';
import { HalfFloatType } from 'three';
import { withPasses } from './three-passes.js';

export class PolygonBokehPass extends withPasses(Pass) {
  constructor(camera, options) {
    super(camera, options);
    this.needsDepthTexture = !this.options.depthTexture;
    this.needsSwap = true;
  }

  set mainCamera(camera) {
    this.camera = camera;
  }

  initialize(renderer, alpha, frameBufferType) {
    if (frameBufferType === HalfFloatType) return;
    console.warn(
      'polygonal-bokeh: no light is brighter than white, so blurred lights become grey. Create the ' +
        'EffectComposer with frameBufferType: HalfFloatType.',
    );
  }

  setDepthTexture(depthTexture) {
    this.depthTexture = depthTexture;
  }

  getDepthTexture() {
    return this.depthTexture;
  }

  render(renderer, inputBuffer, outputBuffer) {
    const depth = this.options.depthTexture ?? this.depthTexture;
    this.draw(renderer, this.renderToScreen ? null : outputBuffer, inputBuffer.texture, depth);
  }
}
