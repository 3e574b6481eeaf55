// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGLRenderer: the code that the passes for three.js's EffectComposer and for
// pmndrs' EffectComposer share. Its shaders call the functions of the library, in GLSL.

import { FloatType, GLSL3, Group, HalfFloatType, Mesh, NearestFilter, NoBlending, PlaneGeometry, RGFormat } from 'three';
import { Raycaster, RedFormat, ShaderMaterial, Vector2, Vector3, WebGLRenderTarget } from 'three';
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js';
import { uniformsOf } from './common.js';
import { METRES, UNBLURRED, clockwise, declared, frame, library, stored, views } from './frames.js';
import { GLSL } from './shaders.js';
import { THREE_CHOICES, withLens } from './three-common.js';

const CLASS = { name: 'PolygonBokehPass', choices: { ...THREE_CHOICES, depthTexture: undefined } };

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

// Without extensions, WebGL can read a texture of 32-bit floats only if its filter is nearest, even to fetch single
// texels
export const FLOAT = { type: FloatType, format: RedFormat, minFilter: NearestFilter, magFilter: NearestFilter };

export const withPasses = (Base) =>
  class extends withLens(Base, CLASS, { Raycaster, Vector2, Vector3 }) {
    // camera          the camera that draws the scene
    // options         see common.d.ts; throws an Error if one of them is invalid. Two more options:
    //   alpha         see three-common.js
    //   depthTexture  depth of the scene, if it is not the depth of the composer's target
    constructor(camera, options) {
      super('PolygonBokehPass');
      this.camera = camera;
      this.options = this.checked(options);

      // The settings, which you may change in every frame: lengths in metres, maxCoC as a fraction of the image height,
      // and rotation in radians, clockwise on the screen. common.d.ts describes all of them.
      // debugMode: 0 result, 1 depth, 2 circle of confusion, 3 near and far field
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

    // Creates the passes and textures of a frame with these options.
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
          uniforms: { ...this.uniforms, ...textures }, // all passes share them
          vertexShader: VERTEX,
          fragmentShader: text + fragment(reads, uniforms, row, place, options, opaque),
          blending: NoBlending, // alpha is not opacity, but the circle of confusion or a layer's weight
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

    // Compiles the shaders of passes.
    async compile({ passes }) {
      const { renderer } = this;
      const quads = new Group();
      // without normals, like the geometry of FullScreenQuad: with normals, three.js would compile another program
      const geometry = new PlaneGeometry(2, 2).deleteAttribute('normal');
      for (const { material } of passes) quads.add(new Mesh(geometry, material));
      const before = renderer.getRenderTarget();
      renderer.setRenderTarget(passes[0].target); // a program for a target has no tone mapping and no sRGB
      const compiled = renderer.compileAsync(quads, this.camera);
      renderer.setRenderTarget(before);
      await compiled;
    }

    setSize(width, height) {
      this.uniforms.imageSize.value.set(width, height);
      this.resize(this.passes);
    }

    resize(passes) {
      const { x, y } = this.uniforms.imageSize.value;
      for (const { target, scale } of passes) target?.setSize(Math.ceil(x / scale), Math.ceil(y / scale));
    }

    // Draws the passes into a target, or for null into the canvas. Without depth, nothing is blurred.
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
      // SharpPass needs the depth later, and in old versions of three.js, both targets of the composer share it
      renderer.autoClearDepth = false;
      const view = depth && this.views[uniforms.debugMode.value - 1];
      const blurs = depth && uniforms.apertureDiameter.value > 0;
      // If nothing is blurred, the next pass reads the input of this one. Only the screen needs a copy.
      this.needsSwap = Boolean(view || blurs);
      const unblurred = this.renderToScreen ? [this.copy] : [];
      for (const { material, target = output } of view ? [...this.beforeView, view] : blurs ? this.passes : unblurred) {
        this.quad.material = material;
        renderer.setRenderTarget(target);
        this.quad.render(renderer);
      }
      renderer.autoClearDepth = autoClearDepth;
    }

    // Returns the kind of depth in the texture, for BokehLinearDepth. A texture with two channels has depth weighted by
    // opacity. three.js sets reversedDepth. It writes no logarithmic depth for an orthographic camera, or if depth is
    // reversed.
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
