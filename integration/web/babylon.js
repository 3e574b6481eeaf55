// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for Babylon.js, made of the functions of the library, in GLSL for WebGL 2 and in WGSL for WebGPU: a
// PostProcess, the first of its camera's, and a task for frame graphs. Both come before bloom and image processing.

import { Constants } from '@babylonjs/core/Engines/constants.js';
import { FrameGraphTask } from '@babylonjs/core/FrameGraph/frameGraphTask.js';
import { EffectRenderer, EffectWrapper } from '@babylonjs/core/Materials/effectRenderer.js';
import { MultiRenderTarget } from '@babylonjs/core/Materials/Textures/multiRenderTarget.js';
import { ShaderLanguage } from '@babylonjs/core/Materials/shaderLanguage.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import { DepthRenderer } from '@babylonjs/core/Rendering/depthRenderer.js';
import '@babylonjs/core/Engines/WebGPU/Extensions/engine.multiRender.js'; // MultiRenderTarget brings that of WebGL
import { CHOICES, checked, diameter, pulled, uniformsOf } from './common.js';
import { clockwise, declared, frame, inWgsl, library, stored, views } from './frames.js';
import { GLSL, WGSL } from './shaders.js';

// What the depth renderer writes, as BokehLinearDepth reads it: metres, in a right-handed scene times -1
const DEPTH = { leftHanded: '0, 0.0, 0.0', rightHanded: '7, 0.0, -1.0' };

// What the screen depth of a frame graph's geometry renderer holds
const SCREEN_DEPTH = { perspective: [1, 2], orthographic: [5, 6] }; // of them: usual, reversed
const PLANES = ['nearPlane', 'farPlane'];

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
    ${clockwise(declared(row, options, place))}
    ${clockwise(stored(row, (i) => `written${i}`))}
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
    ${clockwise(declared(row, options, place, true))}
    ${stored(row, (i) => output(i, row[0].length), `${reads[0]}Sampler`)}
    ${opaque ? 'fragmentOutputs.color.a = 1.0;' : ''}
}`;

const languageOf = ({ isWebGPU }) => (isWebGPU ? ShaderLanguage.WGSL : ShaderLanguage.GLSL);

// The passes of a frame, each with its shader
//
// held   how BokehLinearDepth reads the texture depth: kind, near, far
// names  of the floats that the shaders get
function passesOf(engine, options, held, names) {
  const { method, opaque, view } = options;
  const [map, ...others] = frame(options, held);
  const rows = [map, ...(view ? [views(method, held)[VIEWS.indexOf(view)]] : others)];
  const shader = engine.isWebGPU ? wgsl : glsl;
  const textures = [...new Set(['color', 'depth', ...rows.flatMap(([writes]) => writes)])];
  const text = library(engine.isWebGPU ? WGSL : GLSL, options);
  return rows.map((row, i) => {
    const [writes, scale, call] = row;
    // in the order of the call
    const reads = [...new Set(call.match(/(?<!\.)\b\w+/g))].filter((name) => textures.includes(name));
    const pass = { row, writes, reads, scale, call, opaque: opaque && writes[0] === 'result' };
    pass.wrapper = new EffectWrapper({
      engine,
      name: `bokeh ${writes[0]}`,
      fragmentShader: shader(text, names, pass, i, options),
      shaderLanguage: languageOf(engine),
      uniforms: [...names, 'imageSize'],
      samplers: [...reads],
      useAsPostProcess: true, // for blending off, which is its default
      allowEmptySourceTexture: true,
    });
    return pass;
  });
}

// What the post process and the task share: the lens and the focus, of this.camera
const withLens = (Base) =>
  class extends Base {
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
  };

export class PolygonBokeh extends withLens(PostProcess) {
  // camera   the camera whose picture is blurred
  // options, all of them checked:
  //   method   'layered': near objects spread over what is behind them; 'exact': each pixel by its own circle of
  //            confusion, fewer passes
  //   sides    4, 6, 8 or 10
  //   preset   'MOBILE', 'LOW', 'MEDIUM', 'HIGH' or 'ULTRA'
  //   opaque   false: alpha is the signed circle of confusion in the end too. A canvas would take it for transparency.
  //   extras   common.js
  //   view     'depth', 'coc' (circle of confusion) or 'focus' (near and far field), to look at in place of the result
  constructor(camera, given) {
    const options = checked('PolygonBokeh', given, OPTIONS);
    const scene = camera.getScene();
    const engine = scene.getEngine();

    // To be set from outside. Metres, but for maxCoC (fraction of the image height) and rotation (radians, clockwise on
    // the screen).
    const uniforms = uniformsOf(options);

    const rightHanded = scene.useRightHandedSystem;
    const held = rightHanded ? DEPTH.rightHanded : DEPTH.leftHanded;
    const passes = passesOf(engine, options, held, Object.keys(uniforms));

    // The last pass is the post process itself, and writes into the input of the next one. Its input is the scene.
    const last = passes.at(-1);
    const textureType = Constants.TEXTURETYPE_HALF_FLOAT;
    const shaderLanguage = languageOf(engine);
    super('polygonBokeh', '', { size: 1, camera, textureType, shaderLanguage, effectWrapper: last.wrapper });
    camera.detachPostProcess(this);
    camera.attachPostProcess(this, 0);
    this.externalTextureSamplerBinding = true; // the scene's texture is called color here
    Object.assign(this, { camera, uniforms, passes, isAttached: true, isView: Boolean(options.view) });
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
    this.switching = scene.onBeforeRenderObservable.add(() => this.attach());
    this.drawing = scene.postProcessManager.onBeforeRenderObservable.add(() => {
      if (scene.activeCamera === camera && this.isAttached) this.draw();
    });
    this.resizing = engine.onResizeObservable.add(() => {
      depth.resize({ width: engine.getRenderWidth(), height: engine.getRenderHeight() });
    });
  }

  // Whether all shaders are compiled
  isReady() {
    return this.textures.depth.isReadyForRendering() && this.passes.every(({ wrapper }) => wrapper.isReady());
  }

  // Where nothing is blurred, the camera is as without this: no pass, and no depth drawn
  attach() {
    const { camera, uniforms, isView } = this;
    const wanted = isView || uniforms.apertureDiameter > 0;
    if (wanted === this.isAttached) return;
    this.isAttached = wanted;
    const { customRenderTargets } = camera;
    const { depth } = this.textures;
    if (wanted) {
      camera.attachPostProcess(this, 0);
      customRenderTargets.push(depth);
    } else {
      camera.detachPostProcess(this);
      customRenderTargets.splice(customRenderTargets.indexOf(depth), 1);
    }
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
    scene.onBeforeRenderObservable.remove(this.switching);
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

// The same as a task of a frame graph, which knows the scene's depth already: nothing is drawn twice.
//
// sourceTexture  handle of the scene's colours, linear
// depthTexture   handle of their depth: geometryScreenDepthTexture of a FrameGraphGeometryRendererTask, 32-bit floats
// targetTexture  handle of what is written; left out, it is a texture of its own
// outputTexture  handle of the result, for the tasks after it
export class PolygonBokehTask extends withLens(FrameGraphTask) {
  // name, frameGraph  as of every task
  // camera            that the scene is drawn with; another one only of the same kind, perspective or orthographic
  // options           those of PolygonBokeh
  constructor(name, frameGraph, camera, given) {
    super(name, frameGraph);
    const options = checked('PolygonBokehTask', given, OPTIONS);
    const { engine } = frameGraph;
    const kinds = SCREEN_DEPTH[camera.mode === Constants.PERSPECTIVE_CAMERA ? 'perspective' : 'orthographic'];
    const held = [kinds[engine.useReverseDepthBuffer ? 1 : 0], ...PLANES].join(', ');
    // To be set from outside, as those of PolygonBokeh
    this.uniforms = uniformsOf(options);
    this.camera = camera;
    this.isView = Boolean(options.view);
    this.bokehPasses = passesOf(engine, options, held, [...Object.keys(this.uniforms), ...PLANES]);
    this.outputTexture = frameGraph.textureManager.createDanglingHandle();
  }

  getClassName() {
    return 'PolygonBokehTask';
  }

  isReady() {
    return this.bokehPasses.every(({ wrapper }) => wrapper.isReady());
  }

  // Babylon.js calls it when the graph is built, and again after a resize.
  record(skipCreationOfDisabledPasses = false) {
    const { sourceTexture, depthTexture, _frameGraph: graph } = this;
    const { textureManager } = graph;
    if (sourceTexture === undefined || depthTexture === undefined) {
      throw new Error('polygonal-bokeh, PolygonBokehTask: set sourceTexture and depthTexture before the graph is built.');
    }
    const { width, height } = textureManager.getTextureDescription(sourceTexture).size;
    const size = [width, height];
    const handles = { color: sourceTexture, depth: depthTexture };
    this.handles = handles;
    for (const pass of this.bokehPasses) {
      const { writes, reads, scale } = pass;
      for (const name of writes) {
        const options = halfFloats(name, size.map((side) => Math.ceil(side / scale)));
        if (name === 'result') textureManager.resolveDanglingHandle(this.outputTexture, this.targetTexture, name, options);
        handles[name] = name === 'result' ? this.outputTexture : textureManager.createRenderTargetTexture(name, options);
      }
      const added = graph.addRenderPass(`${this.name} ${writes[0]}`);
      added.addDependencies(reads.map((name) => handles[name]));
      added.setRenderTarget(writes.map((name) => handles[name]));
      added.setExecuteFunc((context) => this.draw(context, pass, handles, size));
    }
    if (skipCreationOfDisabledPasses) return;
    const disabled = graph.addRenderPass(`${this.name}_disabled`, true);
    disabled.addDependencies(sourceTexture);
    disabled.setRenderTarget(this.outputTexture);
    disabled.setExecuteFunc((context) => context.copyTexture(sourceTexture));
  }

  draw(context, pass, handles, size) {
    const { wrapper, writes, reads } = pass;
    const { engine } = this._frameGraph;
    if (!this.isView && !(this.uniforms.apertureDiameter > 0)) {
      // nothing is blurred: the colours as they came
      if (pass === this.bokehPasses.at(-1)) context.copyTexture(handles.color);
      return;
    }
    if (pass === this.bokehPasses[0] && 'frame' in this.uniforms) this.uniforms.frame += 1;
    if (writes.length > 1) context.bindAttachments(engine.buildTextureLayout(writes.map(() => true)));
    context.applyFullScreenEffect(wrapper.drawWrapper, () => {
      const { effect } = wrapper;
      wrapper.bind();
      const { minZ: nearPlane, maxZ: farPlane } = this.camera;
      for (const [name, value] of Object.entries({ ...this.uniforms, nearPlane, farPlane })) effect.setFloat(name, value);
      effect.setFloat2('imageSize', ...size);
      for (const name of reads) {
        if (!['color', 'depth'].includes(name)) {
          context.setTextureSamplingMode(handles[name], Constants.TEXTURE_BILINEAR_SAMPLINGMODE);
        }
        context.bindTextureHandle(effect, name, handles[name]);
      }
    });
  }

  dispose() {
    for (const { wrapper } of this.bokehPasses) wrapper.dispose();
    super.dispose();
  }
}

// How a frame graph makes a texture of 16-bit floats
const halfFloats = (label, [width, height]) => ({
  size: { width, height },
  sizeIsPercentage: false,
  options: {
    createMipMaps: false,
    types: [Constants.TEXTURETYPE_HALF_FLOAT],
    formats: [Constants.TEXTUREFORMAT_RGBA],
    samples: 1,
    useSRGBBuffers: [false],
    labels: [label],
  },
});
