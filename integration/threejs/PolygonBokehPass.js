// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGLRenderer: a Pass for EffectComposer, made of the functions of the GLSL
// library. It stands directly after the RenderPass, before bloom and before OutputPass.

import { FloatType, GLSL3, HalfFloatType, MathUtils, NearestFilter, NoBlending, RedFormat } from 'three';
import { ShaderMaterial, Vector2, WebGLRenderTarget } from 'three';
import { FullScreenQuad, Pass } from 'three/addons/postprocessing/Pass.js';
import { declared, frame, stored, views } from './frames.js';

// For paper: depth in metres, in a texture of its own
const METRES = [['metres'], 1, 'vec4(BokehLinearDepth(BokehFetchDepth(depth, uv), depthKind, nearPlane, farPlane))'];

const VERTEX = `
out vec2 bokehUv;
void main()
{
    bokehUv = uv;
    gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const fragment = (textures, [writes, , call, returned], sides, opaque) => `
uniform sampler2D ${textures.join(', ')};
uniform float apertureDiameter, focalLength, focusDistance, sensorHeight, maxCoC, rotation, squeeze;
uniform float nearPlane, farPlane;
uniform vec2 imageSize;
uniform int depthKind;
in vec2 bokehUv;
${writes.map((_, i) => `layout(location = ${i}) out vec4 written${i};`).join('\n')}

void main()
{
    vec2 uv = bokehUv;
    ${declared(call, sides)}
    ${stored(call, returned, (i) => `written${i}`)}
    ${opaque ? 'written0.a = 1.0;' : ''}
}`;

export class PolygonBokehPass extends Pass {
  // library  the text of bokeh.glsl, and after it bokeh_layers.glsl for layered, bokeh_paper.glsl for paper
  // camera   the camera that the scene is drawn with
  // method   'layered': near objects spread over what is behind them; 'exact': each pixel by its own circle of
  //          confusion, fewer passes; 'paper': lines and min, a target less
  // sides    6 or 8; layered and exact have 4 and 10 as well
  // preset   'LOW', 'MEDIUM', 'HIGH' or 'ULTRA'
  // opaque   false: alpha is the circle of confusion in the end too, signed but for paper. A canvas would take it for
  //          transparency.
  constructor(library, camera, { method = 'layered', sides = 6, preset = 'MEDIUM', opaque = true } = {}) {
    super();
    this.camera = camera;

    // To be set from outside. Metres, but for maxCoC (fraction of the image height) and rotation (radians).
    // debugMode: 0 off, 1 depth, 2 circle of confusion, 3 near and far field.
    this.uniforms = {
      apertureDiameter: { value: 0.05 },
      focalLength: { value: 0.05 },
      focusDistance: { value: 5 },
      sensorHeight: { value: 0.024 },
      maxCoC: { value: 0.1 },
      rotation: { value: 0 },
      squeeze: { value: 1 },
      debugMode: { value: 0 },
      depthKind: { value: 1 },
      nearPlane: { value: 0 },
      farPlane: { value: 0 },
      imageSize: { value: new Vector2(1, 1) },
    };

    const inputs = method === 'paper' ? [METRES] : [];
    const rows = [...inputs, ...frame(method, sides)];
    // WebGL without extensions reads no 32-bit float texture that has another filter, not even texel by texel
    const float = { type: FloatType, format: RedFormat, minFilter: NearestFilter, magFilter: NearestFilter };
    this.textures = { color: { value: null }, depth: { value: null } };
    const made = rows.slice(0, -1).map(([writes, scale]) => {
      const type = writes[0] === 'metres' ? float : { type: HalfFloatType };
      const target = new WebGLRenderTarget(1, 1, { ...type, depthBuffer: false, count: writes.length });
      writes.forEach((name, i) => (this.textures[name] = { value: target.textures[i] }));
      return { writes, scale, target };
    });
    const material = (row) =>
      new ShaderMaterial({
        glslVersion: GLSL3,
        defines: { [`BOKEH_PRESET_${preset}`]: 1 },
        uniforms: { ...this.uniforms, ...this.textures }, // the same ones in every pass
        vertexShader: VERTEX,
        fragmentShader: library + fragment(Object.keys(this.textures), row, sides, opaque && row[0][0] === 'result'),
        blending: NoBlending, // alpha is the circle of confusion, or a layer's share
        depthTest: false,
        depthWrite: false,
      });
    this.passes = rows.map((row, i) => ({ ...made[i], material: material(row) }));
    this.views = views(method).map((row) => ({ material: material(row) }));
    this.beforeView = this.passes.slice(0, inputs.length + 1);
    this.quad = new FullScreenQuad();
  }

  // The lens of the camera's own field of view, at an f-stop; call it again where the camera zooms. Smaller stops than
  // those of real lenses blur more (docs/lens.md). An orthographic camera has no field of view: focalLength stays.
  setLens(fStop) {
    const { apertureDiameter, focalLength, sensorHeight } = this.uniforms;
    if (this.camera.isPerspectiveCamera) {
      const fovy = MathUtils.degToRad(this.camera.getEffectiveFOV());
      focalLength.value = sensorHeight.value / (2 * Math.tan(fovy / 2));
    }
    apertureDiameter.value = focalLength.value / fStop;
  }

  // Focus on a place in the world: focusDistance is the depth along the view axis, not the length of the ray.
  focusOn(point) {
    this.uniforms.focusDistance.value = -this.camera.worldToLocal(point.clone()).z;
  }

  // Autofocus, once a frame of dt seconds: towards the nearest of these depths. 1 / distance goes the way, and tau is its
  // time constant (docs/lens.md).
  pullFocus(dt, depths, tau = 0.2) {
    const { focusDistance } = this.uniforms;
    const k = 1 - Math.exp(-dt / tau);
    focusDistance.value = 1 / ((1 - k) / focusDistance.value + k / Math.min(...depths));
  }

  setSize(width, height) {
    for (const { target, scale } of this.passes) target?.setSize(Math.ceil(width / scale), Math.ceil(height / scale));
    this.uniforms.imageSize.value.set(width, height);
  }

  render(renderer, writeBuffer, readBuffer) {
    this.uniforms.depthKind.value = this.depthKind(renderer);
    this.uniforms.nearPlane.value = this.camera.near;
    this.uniforms.farPlane.value = this.camera.far;
    this.textures.color.value = readBuffer.texture;
    this.textures.depth.value = readBuffer.depthTexture;
    const output = this.renderToScreen ? null : writeBuffer;
    const view = this.views[this.uniforms.debugMode.value - 1];
    for (const { material, target = output } of view ? [...this.beforeView, view] : this.passes) {
      this.quad.material = material;
      renderer.setRenderTarget(target);
      this.quad.render(renderer);
    }
  }

  // What the depth texture holds, as BokehLinearDepth counts. three.js itself leaves the logarithm of 1 + metres out
  // for an orthographic camera and for a reversed buffer; it sets reversedDepth.
  depthKind(renderer) {
    const { isOrthographicCamera, reversedDepth } = this.camera;
    if (isOrthographicCamera) return reversedDepth ? 6 : 5;
    if (renderer.capabilities.logarithmicDepthBuffer) return 8;
    return reversedDepth ? 2 : 1;
  }

  dispose() {
    for (const { target, material } of [...this.passes, ...this.views]) {
      target?.dispose();
      material.dispose();
    }
    this.quad.dispose();
  }
}
