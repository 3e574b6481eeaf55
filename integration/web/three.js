// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGLRenderer: a Pass for EffectComposer. Add it after the RenderPass, and before
// bloom and OutputPass.

import { AlwaysDepth, HalfFloatType, ShaderMaterial, WebGLRenderTarget } from 'three';
import { FullScreenQuad, Pass } from 'three/addons/postprocessing/Pass.js';
import { drawLayer } from './three-common.js';
import { drawnAfter } from './three-opacity.js';
import { FLOAT, withPasses } from './three-passes.js';

const GIVE_DEPTH =
  'Create the EffectComposer with a render target that has a depthTexture, or set the option depthTexture. If another ' +
  'pass runs between RenderPass and the bokeh, set the option to depthOf(renderPass).';
const NO_DEPTH = `polygonal-bokeh: there is no depth, so nothing is blurred. ${GIVE_DEPTH}`;
const EMPTY_DEPTH = `polygonal-bokeh: the depth is empty, so everything is blurred as if it were far away. ${GIVE_DEPTH}`;
// Number of the frame in which the pass checks whether the depth is empty: by then, most scenes show something
const LOOK = 30;

// Returns a quad that copies depth into colour. If the options of its material allow, it also copies into a depth
// buffer.
const copier = (options) =>
  new FullScreenQuad(
    new ShaderMaterial({
      uniforms: { depth: { value: null } },
      vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: `uniform highp sampler2D depth; varying vec2 at;
        void main() { gl_FragDepth = texture2D(depth, at).r; gl_FragColor = vec4(gl_FragDepth); }`,
      ...options,
    }),
  );

// Returns a texture for the option depthTexture, with a copy of the depth that a RenderPass draws. You need it if there
// are passes between the RenderPass and the bokeh, because they clear the depth.
export function depthOf(renderPass) {
  const target = new WebGLRenderTarget(1, 1, { ...FLOAT, depthBuffer: false });
  const quad = copier({ depthTest: false });
  const draw = (renderer, { depthTexture }) => {
    quad.material.uniforms.depth.value = depthTexture;
    quad.render(renderer);
  };
  return drawnAfter(renderPass, target, draw, () => [quad.material, quad]);
}

export { depthWithOpacity } from './three-opacity.js';

export class PolygonBokehPass extends withPasses(Pass) {
  render(renderer, writeBuffer, readBuffer) {
    const { depthTexture } = this.options;
    const depth = depthTexture ?? readBuffer.depthTexture;
    this.frames = (this.frames ?? 0) + 1;
    if (!depth && this.frames === 1) console.warn(NO_DEPTH);
    this.draw(renderer, this.renderToScreen ? null : writeBuffer, readBuffer.texture, depth);
    if (depth && !depthTexture && this.frames === LOOK) this.look(renderer);
  }

  // Warns if the depth buffer has the same value everywhere. It reads back 16 x 16 points, while the next frames are
  // drawn.
  async look(renderer) {
    const target = new WebGLRenderTarget(16, 16, { type: HalfFloatType, depthBuffer: false });
    this.quad.material = this.views[0].material;
    renderer.setRenderTarget(target);
    this.quad.render(renderer);
    const seen = await renderer.readRenderTargetPixelsAsync(target, 0, 0, 16, 16, new Uint16Array(4 * 16 * 16));
    if (seen.every((value, i) => value === seen[i % 4])) console.warn(EMPTY_DEPTH);
    target.dispose();
  }
}

// Draws the objects of a layer sharp, and hidden by nearer objects. Use it for glass and other transparent objects that
// write no depth. Add it after the bokeh.
export class SharpPass extends Pass {
  // bokeh  the PolygonBokehPass, whose depth decides what is hidden
  // layer  the layer of the objects: call object.layers.set(layer). The pass also puts the lights of the scene on it.
  constructor(bokeh, scene, layer = 1) {
    super();
    Object.assign(this, { bokeh, scene, layer, needsSwap: false });
    this.quad = copier({ colorWrite: false, depthFunc: AlwaysDepth });
  }

  render(renderer, writeBuffer, readBuffer) {
    const { scene, layer, bokeh } = this;
    const { autoClear } = renderer;
    const depth = bokeh.textures.depth.value;
    this.quad.material.uniforms.depth.value = depth;
    renderer.setRenderTarget(readBuffer);
    renderer.autoClear = false;
    if (readBuffer.depthTexture?.source !== depth.source) this.quad.render(renderer);
    drawLayer(renderer, scene, bokeh.camera, layer);
    renderer.autoClear = autoClear;
  }

  dispose() {
    this.quad.material.dispose();
    this.quad.dispose();
  }
}
