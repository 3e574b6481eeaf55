// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGLRenderer, made of the functions of the GLSL library: what the passes for three.js's
// own EffectComposer and for pmndrs' share.

import { FloatType, GLSL3, Group, HalfFloatType, Mesh, NearestFilter, NoBlending, PlaneGeometry, RGFormat } from 'three';
import { Raycaster, RedFormat, ShaderMaterial, Vector2, Vector3, WebGLRenderTarget } from 'three';
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js';
import { checked, uniformsOf } from './common.js';
import { METRES, UNBLURRED, clockwise, declared, frame, library, stored, views } from './frames.js';
import { GLSL } from './shaders.js';
import { THREE_CHOICES, withLens } from './three-common.js';

const CHOICES = { ...THREE_CHOICES, depthTexture: undefined };

const VERTEX = `
out vec2 bokehUv;
void main()
{
    bokehUv = uv;
    gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const fragment = (textures, uniforms, row, place, options, opaque) => `
uniform sampler2D ${textures.join(', ')};
uniform float ${uniforms.join(', ')};
uniform float nearPlane, farPlane;
uniform vec2 imageSize;
uniform int depthKind;
in vec2 bokehUv;
${row[0].map((_, i) => `layout(location = ${i}) out vec4 written${i};`).join('\n')}

void main()
{
    vec2 uv = bokehUv;
    ${clockwise(declared(row, options, place))}
    ${clockwise(stored(row, (i) => `written${i}`))}
    ${opaque ? 'written0.a = 1.0;' : ''}
}`;

// WebGL without extensions reads no 32-bit float texture that has another filter, not even texel by texel
export const FLOAT = { type: FloatType, format: RedFormat, minFilter: NearestFilter, magFilter: NearestFilter };

export const withPasses = (Base) =>
  class extends withLens(Base, { Raycaster, Vector2, Vector3 }) {
    // camera        the camera that the scene is drawn with
    // options, all of them checked:
    //   method        'layered': near objects spread over what is behind them; 'exact': each pixel by its own circle of
    //                 confusion, fewer passes; 'paper': lines and min, a target less
    //   sides         6 or 8; layered and exact have 4 and 10 as well
    //   preset        'MOBILE', 'LOW', 'MEDIUM', 'HIGH' or 'ULTRA'
    //   opaque        false: alpha is the circle of confusion in the end too, signed but for paper. A canvas would take it
    //                 for transparency.
    //   extras, alpha, depthTexture: common.js, three-common.js
    constructor(camera, options) {
      super('PolygonBokehPass');
      this.camera = camera;
      this.options = checked('PolygonBokehPass', options, CHOICES);

      // To be set from outside. Metres, but for maxCoC (fraction of the image height) and rotation (radians, clockwise on
      // the screen).
      // debugMode: 0 off, 1 depth, 2 circle of confusion, 3 near and far field.
      this.uniforms = {
        debugMode: { value: 0 },
        depthKind: { value: 1 },
        nearPlane: { value: 0 },
        farPlane: { value: 0 },
        imageSize: { value: new Vector2(1, 1) },
      };
      this.quad = new FullScreenQuad();
      Object.assign(this, this.made(this.options));
    }

    // Passes and textures of a frame
    made(options) {
      for (const [name, value] of Object.entries(uniformsOf(options))) this.uniforms[name] ??= { value };
      const rows = [...(options.method === 'paper' ? [METRES] : []), ...frame(options)];
      const textures = { color: { value: null }, depth: { value: null } };
      const targets = {};
      for (const [writes] of rows.slice(0, -1)) {
        if (targets[writes]) continue;
        const type = writes[0] === 'metres' ? FLOAT : { type: HalfFloatType };
        targets[writes] = new WebGLRenderTarget(1, 1, { ...type, depthBuffer: false, count: writes.length });
        writes.forEach((name, i) => (textures[name] = { value: targets[writes].textures[i] }));
      }
      const text = library(GLSL, options);
      const uniforms = Object.keys(uniformsOf(options));
      const material = (row, place) => {
        const opaque = options.opaque && !options.alpha && row[0][0] === 'result';
        const reads = Object.keys(textures).filter((name) => new RegExp(`(?<!\\.)\\b${name}\\b`).test(row[2]));
        return new ShaderMaterial({
          glslVersion: GLSL3,
          uniforms: { ...this.uniforms, ...textures }, // the same ones in every pass
          vertexShader: VERTEX,
          fragmentShader: text + fragment(reads, uniforms, row, place, options, opaque),
          blending: NoBlending, // alpha is the circle of confusion, or a layer's share
          depthTest: false,
          depthWrite: false,
        });
      };
      const passes = rows.map((row, i) => {
        const [writes, scale] = row;
        return { writes, scale, target: targets[writes], material: material(row, i) };
      });
      const shown = views(options.method).map((row) => ({ material: material(row, 0) }));
      const beforeView = passes.slice(0, 1 + passes.findIndex(({ writes }) => writes[0] === 'coc'));
      const copy = { material: material(UNBLURRED, 0) };
      return { options, textures, passes, views: shown, beforeView, copy };
    }

    // Other options, of those of the constructor. It resolves when the next frame is drawn with them: until then the
    // frames are as before, and the shaders are compiled beside them.
    async change(options) {
      const made = this.made(checked('PolygonBokehPass', { ...this.options, ...options }, CHOICES));
      this.resize(made.passes);
      const { renderer } = this;
      this.changing = made;
      if (renderer) {
        const quads = new Group();
        // as a FullScreenQuad's: a geometry with normals would be another program
        const geometry = new PlaneGeometry(2, 2).deleteAttribute('normal');
        for (const { material } of made.passes) quads.add(new Mesh(geometry, material));
        const before = renderer.getRenderTarget();
        renderer.setRenderTarget(made.passes[0].target); // colour space and tone mapping are those of a target
        const compiled = renderer.compileAsync(quads, this.camera);
        renderer.setRenderTarget(before);
        await compiled;
      }
      // a later change is not undone by an earlier one whose shaders took longer
      this.discard(this.changing === made ? this : made);
      if (this.changing === made) Object.assign(this, made);
    }

    setSize(width, height) {
      this.uniforms.imageSize.value.set(width, height);
      this.resize(this.passes);
    }

    resize(passes) {
      const { x, y } = this.uniforms.imageSize.value;
      for (const { target, scale } of passes) target?.setSize(Math.ceil(x / scale), Math.ceil(y / scale));
    }

    // Draws the frame into a target, null for the canvas; without depth nothing is blurred.
    draw(renderer, output, color, depth) {
      const { uniforms, textures } = this;
      this.renderer = renderer;
      uniforms.depthKind.value = this.depthKind(renderer, depth);
      uniforms.nearPlane.value = this.camera.near;
      uniforms.farPlane.value = this.camera.far;
      if (uniforms.frame) uniforms.frame.value += 1;
      textures.color.value = color;
      textures.depth.value = depth;
      const { autoClearDepth } = renderer;
      renderer.autoClearDepth = false; // in old versions of three.js the composer's two targets share depth: SharpPass
      const view = depth && this.views[uniforms.debugMode.value - 1];
      const blurs = depth && uniforms.apertureDiameter.value > 0;
      // A chain of passes goes on with the colour as it is, but the screen needs it copied.
      this.needsSwap = Boolean(view || blurs);
      const unblurred = this.renderToScreen ? [this.copy] : [];
      for (const { material, target = output } of view ? [...this.beforeView, view] : blurs ? this.passes : unblurred) {
        this.quad.material = material;
        renderer.setRenderTarget(target);
        this.quad.render(renderer);
      }
      renderer.autoClearDepth = autoClearDepth;
    }

    // What the depth texture holds, as BokehLinearDepth counts: two channels are depth weighted by opacity. three.js leaves the logarithm of 1 + metres out
    // for an orthographic camera and for a reversed buffer; it sets reversedDepth.
    depthKind(renderer, depth) {
      if (depth?.format === RGFormat) return 9;
      const { isOrthographicCamera, reversedDepth } = this.camera;
      if (isOrthographicCamera) return reversedDepth ? 6 : 5;
      if (renderer.capabilities.logarithmicDepthBuffer) return 8;
      return reversedDepth ? 2 : 1;
    }

    discard({ passes, views, copy }) {
      for (const { target, material } of [...passes, ...views, copy]) {
        target?.dispose();
        material.dispose();
      }
    }

    dispose() {
      this.discard(this);
      this.quad.dispose();
    }
  };
