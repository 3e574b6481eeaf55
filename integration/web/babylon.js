// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for Babylon.js: a PostProcess, made of the functions of the library, in GLSL for WebGL 2 and in
// WGSL for WebGPU. It is the first of its camera's post processes, before bloom and image processing.

import { Constants } from '@babylonjs/core/Engines/constants.js';
import { EffectRenderer, EffectWrapper } from '@babylonjs/core/Materials/effectRenderer.js';
import { MultiRenderTarget } from '@babylonjs/core/Materials/Textures/multiRenderTarget.js';
import { ShaderLanguage } from '@babylonjs/core/Materials/shaderLanguage.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import { DepthRenderer } from '@babylonjs/core/Rendering/depthRenderer.js';
import '@babylonjs/core/Engines/WebGPU/Extensions/engine.multiRender.js'; // MultiRenderTarget brings that of WebGL
import { CHOICES, checked, diameter, pulled, uniformsOf } from './common.js';
import { declared, frame, inWgsl, library, stored, views } from './frames.js';
import { GLSL, WGSL } from './shaders.js';

// What the depth renderer writes, as BokehLinearDepth reads it: metres, in a right-handed scene times -1
const DEPTH = { leftHanded: '0, 0.0, 0.0', rightHanded: '7, 0.0, -1.0' };

const VIEWS = ['depth', 'coc', 'focus'];
const OPTIONS = { ...CHOICES, method: ['layered', 'exact'], view: [undefined, ...VIEWS] };

// `#version 300 es` keeps Babylon.js from rewriting what follows.
const glsl = (text, uniforms, { row, reads, opaque }, place, options) => `#version 300 es
${text}
${reads.map((name) => `uniform sampler2D ${name};`).join('\n')}
uniform float ${uniforms.join(', ')};
uniform vec2 imageSize;
in vec2 vUV;
${row[0].map((_, i) => `layout(location = ${i}) out vec4 written${i};`).join('\n')}

void main()
{
    vec2 uv = vUV;
    ${declared(row, options, place)}
    ${stored(row, (i) => `written${i}`)}
    ${opaque ? 'written0.a = 1.0;' : ''}
}`;

// Babylon.js binds what is called cocSampler with coc, makes the struct around main of what it finds here, and hands no
// pipeline constants on.
const output = (i, count) => `fragmentOutputs.${count > 1 ? `fragData${i}` : 'color'}`;
const wgsl = (text, uniforms, { row, reads, opaque }, place, options) => `
varying vUV: vec2f;
${uniforms.map((name) => `uniform ${name}: f32;`).join('\n')}
uniform imageSize: vec2f;
${reads.map((name) => `var ${name}: texture_2d<f32>;`).join('\n')}
${inWgsl(row[2], 'SAMPLER').includes('SAMPLER') ? `var ${reads[0]}Sampler: sampler;` : ''}
${text}

@fragment
fn main(input: FragmentInputs) -> FragmentOutputs
{
    let uv = input.vUV;
    let imageSize = uniforms.imageSize;
    ${uniforms.map((name) => `let ${name} = uniforms.${name};`).join('\n    ')}
    ${declared(row, options, place, true)}
    ${stored(row, (i) => output(i, row[0].length), `${reads[0]}Sampler`)}
    ${opaque ? 'fragmentOutputs.color.a = 1.0;' : ''}
}`;

export class PolygonBokeh extends PostProcess {
  // camera   the camera whose picture is blurred
  // options, all of them checked:
  //   method   'layered': near objects spread over what is behind them; 'exact': each pixel by its own circle of
  //            confusion, fewer passes
  //   sides    4, 6, 8 or 10
  //   preset   'LOW', 'MEDIUM', 'HIGH' or 'ULTRA'
  //   opaque   false: alpha is the signed circle of confusion in the end too. A canvas would take it for transparency.
  //   extras   common.js
  //   view     'depth', 'coc' (circle of confusion) or 'focus' (near and far field), to look at in place of the result
  constructor(camera, given) {
    const options = checked('PolygonBokeh', given, OPTIONS);
    const { method, opaque, view } = options;
    const scene = camera.getScene();
    const engine = scene.getEngine();

    // To be set from outside. Metres, but for maxCoC (fraction of the image height) and rotation (radians).
    const uniforms = uniformsOf(options);

    const rightHanded = scene.useRightHandedSystem;
    const held = rightHanded ? DEPTH.rightHanded : DEPTH.leftHanded;
    const [map, ...others] = frame(options, held);
    const rows = [map, ...(view ? [views(method, held)[VIEWS.indexOf(view)]] : others)];
    const [language, shader] = engine.isWebGPU ? [ShaderLanguage.WGSL, wgsl] : [ShaderLanguage.GLSL, glsl];
    const names = [...new Set(['color', 'depth', ...rows.flatMap(([writes]) => writes)])];
    const text = library(engine.isWebGPU ? WGSL : GLSL, options);
    const passes = rows.map((row, i) => {
      const [writes, scale, call] = row;
      // in the order of the call
      const reads = [...new Set(call.match(/\w+/g))].filter((name) => names.includes(name));
      const pass = { row, writes, reads, scale, call, opaque: opaque && writes[0] === 'result' };
      pass.wrapper = new EffectWrapper({
        engine,
        name: `bokeh ${writes[0]}`,
        fragmentShader: shader(text, Object.keys(uniforms), pass, i, options),
        shaderLanguage: language,
        uniforms: [...Object.keys(uniforms), 'imageSize'],
        samplers: [...reads],
        useAsPostProcess: true, // for blending off, which is its default
        allowEmptySourceTexture: true,
      });
      return pass;
    });

    // The last pass is the post process itself, and writes into the input of the next one. Its input is the scene.
    const last = passes.at(-1);
    const textureType = Constants.TEXTURETYPE_HALF_FLOAT;
    super('polygonBokeh', '', { size: 1, camera, textureType, shaderLanguage: language, effectWrapper: last.wrapper });
    camera.detachPostProcess(this);
    camera.attachPostProcess(this, 0);
    this.externalTextureSamplerBinding = true; // the scene's texture is called color here
    Object.assign(this, { camera, uniforms, passes });
    this.onApplyObservable.add((effect) => this.bind(effect, last));

    // Depth along the view axis: a pass of Babylon.js that draws the scene once more, into R32F. Where nothing is
    // drawn, it would be 0 without a clearColor: at the camera.
    const [float, nearest] = [Constants.TEXTURETYPE_FLOAT, Constants.TEXTURE_NEAREST_SAMPLINGMODE];
    this.depth = new DepthRenderer(scene, float, camera, false, nearest, true, 'bokeh depth');
    this.depth.clearColor = new Color4(rightHanded ? -camera.maxZ : camera.maxZ, 0, 0, 1);
    const depth = this.depth.getDepthMap();
    camera.customRenderTargets.push(depth); // those of the scene are drawn with the meshes that the last frame showed
    this.textures = { depth };

    for (const pass of passes.slice(0, -1)) {
      const options = { defaultType: textureType, generateDepthBuffer: false };
      pass.target = new MultiRenderTarget(pass.writes[0], 1, pass.writes.length, scene, options);
      pass.target.textures.forEach((texture, i) => {
        texture.wrapU = texture.wrapV = Constants.TEXTURE_CLAMP_ADDRESSMODE;
        this.textures[pass.writes[i]] = texture;
      });
      pass.wrapper.onApplyObservable.add(() => this.bind(pass.wrapper.effect, pass));
    }
    this.quad = new EffectRenderer(engine);
    this.drawing = scene.postProcessManager.onBeforeRenderObservable.add(() => {
      if (scene.activeCamera === camera) this.draw();
    });
    this.resizing = engine.onResizeObservable.add(() => {
      depth.resize({ width: engine.getRenderWidth(), height: engine.getRenderHeight() });
    });
  }

  // The lens of the camera's own field of view, at an f-stop; call it again where the camera zooms. bokehScale is how many
  // times wider the blur is than that lens's: 1 is the real lens, which hardly blurs at a game's field of view
  // (docs/lens.md), 0 is none. An orthographic camera has no field of view: focalLength stays.
  setLens(fStop = 2.8, bokehScale = 10) {
    const { uniforms, camera } = this;
    if (camera.mode === Constants.PERSPECTIVE_CAMERA) {
      uniforms.focalLength = 0.5 * uniforms.sensorHeight * Math.abs(camera.getProjectionMatrix(true).m[5]);
    }
    uniforms.apertureDiameter = diameter(uniforms.focalLength, fStop, bokehScale);
  }

  // Focus on a place in the world: focusDistance is the depth along the view axis, not the length of the ray.
  focusOn(point) {
    this.uniforms.focusDistance = this.depthOf(point);
  }

  depthOf(point) {
    return Math.abs(Vector3.TransformCoordinates(point, this.camera.getViewMatrix(true)).z);
  }

  // Autofocus, once a frame of dt seconds: towards the nearest of these depths, tau is its time constant in seconds.
  pullFocus(dt, depths, tau = 0.2) {
    this.uniforms.focusDistance = pulled(this.uniforms.focusDistance, dt, depths, tau);
  }

  // Whether all shaders are compiled
  isReady() {
    return this.textures.depth.isReadyForRendering() && this.passes.every(({ wrapper }) => wrapper.isReady());
  }

  // All passes but the last, after the scene was drawn
  draw() {
    if ('frame' in this.uniforms) this.uniforms.frame += 1;
    const { width, height } = this.inputTexture;
    for (const { target, scale, wrapper } of this.passes.slice(0, -1)) {
      const size = { width: Math.ceil(width / scale), height: Math.ceil(height / scale) };
      if (target.getRenderWidth() !== size.width || target.getRenderHeight() !== size.height) target.resize(size);
      this.quad.render(wrapper, target);
    }
  }

  bind(effect, { reads }) {
    const { width, height } = this.inputTexture;
    for (const [name, value] of Object.entries(this.uniforms)) effect.setFloat(name, value);
    effect.setFloat2('imageSize', width, height);
    for (const name of reads) {
      if (name === 'color') effect.setTextureFromPostProcess(name, this);
      else effect.setTexture(name, this.textures[name]);
    }
  }

  dispose() {
    const scene = this.camera.getScene();
    scene.postProcessManager.onBeforeRenderObservable.remove(this.drawing);
    scene.getEngine().onResizeObservable.remove(this.resizing);
    for (const { target, wrapper } of this.passes) {
      target?.dispose();
      wrapper.dispose();
    }
    this.quad.dispose();
    this.depth.dispose();
    super.dispose(this.camera);
  }
}
