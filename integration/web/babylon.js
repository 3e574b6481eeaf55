// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for Babylon.js: PolygonBokeh is a PostProcess, which attaches itself as the first one of its camera,
// and PolygonBokehTask is a task for frame graphs. Both must run before bloom and image processing. Their shaders call
// the functions of the library, in GLSL for WebGL 2 and in WGSL for WebGPU.

import { Constants } from '@babylonjs/core/Engines/constants.js';
import { FrameGraphTask } from '@babylonjs/core/FrameGraph/frameGraphTask.js';
import { EffectRenderer, EffectWrapper } from '@babylonjs/core/Materials/effectRenderer.js';
import { MultiRenderTarget } from '@babylonjs/core/Materials/Textures/multiRenderTarget.js';
import { ShaderLanguage } from '@babylonjs/core/Materials/shaderLanguage.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { PostProcess } from '@babylonjs/core/PostProcesses/postProcess.js';
import { DepthRenderer } from '@babylonjs/core/Rendering/depthRenderer.js';
import '@babylonjs/core/Engines/WebGPU/Extensions/engine.multiRender.js'; // MultiRenderTarget itself imports WebGL's
import { CHOICES, checked, diameter, pulled, uniformsOf } from './common.js';
import { clockwise, declared, frame, inWgsl, library, stored, views } from './frames.js';
import { GLSL, WGSL } from './shaders.js';

// Arguments of BokehLinearDepth (kind, near, far) for the texture of the depth renderer. It has view-space z: metres in
// a left-handed scene, and -1 times metres in a right-handed one. Kind 7 multiplies the stored value by far, here -1.
const DEPTH = { leftHanded: '0, 0.0, 0.0', rightHanded: '7, 0.0, -1.0' };

// The kind of depth, for BokehLinearDepth, that a frame graph's geometry renderer writes: [usual, reversed]
const SCREEN_DEPTH = { perspective: [1, 2], orthographic: [5, 6] };
const PLANES = ['nearPlane', 'farPlane'];

const VIEWS = ['depth', 'coc', 'focus'];
const OPTIONS = { ...CHOICES, method: ['layered', 'exact'], view: [undefined, ...VIEWS] };

// Returns the fragment shader of a pass in GLSL. It begins with `#version 300 es`, so that Babylon.js does not rewrite
// it.
//   text   the library
//   place  number of the pass in its frame
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

const output = (i, count) => `fragmentOutputs.${count > 1 ? `fragData${i}` : 'color'}`;

// Returns the same in WGSL. Together with a texture such as coc, Babylon.js binds the sampler with the name cocSampler.
// It generates the structs for main from the declarations in this text. It does not set pipeline constants, so
// library() writes their values into the text.
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

// Returns the passes of a frame, each with its shader
//   held   arguments of BokehLinearDepth for the texture `depth`: kind, near, far
//   names  names of the float uniforms
function passesOf(engine, options, held, names) {
  const { method, opaque, view } = options;
  const [map, ...others] = frame(options, held);
  const rows = [map, ...(view ? [views(method, held)[VIEWS.indexOf(view)]] : others)];
  const shader = engine.isWebGPU ? wgsl : glsl;
  const textures = [...new Set(['color', 'depth', ...rows.flatMap(([writes]) => writes)])];
  const text = library(engine.isWebGPU ? WGSL : GLSL, options);
  return rows.map((row, i) => {
    const [writes, scale, call] = row;
    // the textures, in the order in which the call names them
    const reads = [...new Set(call.match(/(?<!\.)\b\w+/g))].filter((name) => textures.includes(name));
    const pass = { row, writes, reads, scale, call, opaque: opaque && writes[0] === 'result' };
    pass.wrapper = new EffectWrapper({
      engine,
      name: `bokeh ${writes[0]}`,
      fragmentShader: shader(text, names, pass, i, options),
      shaderLanguage: languageOf(engine),
      uniforms: [...names, 'imageSize'],
      samplers: [...reads],
      useAsPostProcess: true, // Babylon.js then turns blending off, as `alphaMode` says by default
      allowEmptySourceTexture: true,
    });
    return pass;
  });
}

// Adds the methods for lens and focus, which the post process and the task share. They use this.camera.
const withLens = (Base) =>
  class extends Base {
    // common.d.ts describes this method, and pullFocus().
    setLens(fStop = 2.8, bokehScale = 10) {
      const { uniforms, camera } = this;
      if (camera.mode === Constants.PERSPECTIVE_CAMERA) {
        uniforms.focalLength = 0.5 * uniforms.sensorHeight * Math.abs(camera.getProjectionMatrix(true).m[5]);
      }
      uniforms.apertureDiameter = diameter(uniforms.focalLength, fStop, bokehScale);
    }

    // Focuses on a point of the scene: sets focusDistance to its depth along the view axis, not along the ray.
    focusOn(point) {
      this.uniforms.focusDistance = this.depthOf(point);
    }

    // Returns the depth of a point of the scene along the view axis, in metres.
    depthOf(point) {
      return Math.abs(Vector3.TransformCoordinates(point, this.camera.getViewMatrix(true)).z);
    }

    pullFocus(dt, depths, tau = 0.2) {
      this.uniforms.focusDistance = pulled(this.uniforms.focusDistance, dt, depths, tau);
    }
  };

export class PolygonBokeh extends withLens(PostProcess) {
  // camera   the camera whose image is blurred
  // given    the options, which common.d.ts describes, but without paper; throws an Error if one of them is invalid.
  //          One more option:
  //   view     a debug view to show instead of the result: 'depth', 'coc' (circle of confusion) or 'focus' (near and
  //            far field)
  constructor(camera, given) {
    const options = checked('PolygonBokeh', given, OPTIONS);
    const scene = camera.getScene();
    const engine = scene.getEngine();

    // The settings, which you may change in every frame: lengths in metres, maxCoC as a fraction of the image height,
    // and rotation in radians, clockwise on the screen. common.d.ts describes all of them.
    const uniforms = uniformsOf(options);

    const rightHanded = scene.useRightHandedSystem;
    const held = rightHanded ? DEPTH.rightHanded : DEPTH.leftHanded;
    const passes = passesOf(engine, options, held, Object.keys(uniforms));

    // This post process itself draws the last pass, into the input of the next post process. Its own input is the
    // scene.
    const last = passes.at(-1);
    const textureType = Constants.TEXTURETYPE_HALF_FLOAT;
    const shaderLanguage = languageOf(engine);
    super('polygonBokeh', '', { size: 1, camera, textureType, shaderLanguage, effectWrapper: last.wrapper });
    camera.detachPostProcess(this);
    camera.attachPostProcess(this, 0);
    this.externalTextureSamplerBinding = true; // bind() binds the scene's texture, as `color`
    Object.assign(this, { camera, uniforms, passes, isAttached: true, isView: Boolean(options.view) });
    this.onApplyObservable.add((effect) => this.bind(effect, last));

    // Babylon.js's depth renderer draws the scene a second time, and writes depth along the view axis into an R32F
    // texture. The clearColor puts the sky at the far plane; without it, the depth of the sky would be 0, at the
    // camera.
    const [float, nearest] = [Constants.TEXTURETYPE_FLOAT, Constants.TEXTURE_NEAREST_SAMPLINGMODE];
    this.depth = new DepthRenderer(scene, float, camera, false, nearest, true, 'bokeh depth');
    this.depth.clearColor = new Color4(rightHanded ? -camera.maxZ : camera.maxZ, 0, 0, 1);
    const depth = this.depth.getDepthMap();
    // in scene.customRenderTargets, it would be drawn with the meshes that were visible in the last frame
    camera.customRenderTargets.push(depth);
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

  // Returns true as soon as all shaders are compiled.
  isReady() {
    return this.textures.depth.isReadyForRendering() && this.passes.every(({ wrapper }) => wrapper.isReady());
  }

  // Detaches the effect from its camera while nothing is blurred and no debug view is shown, so that neither passes nor
  // depth are drawn, and attaches it again afterwards.
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

  // Draws all passes except the last one. It is called after the scene has been drawn.
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

// Does the same as a task of a frame graph. The graph already has the depth of the scene, so the scene is drawn only
// once.
//
// sourceTexture  handle of the scene's linear colour
// depthTexture   handle of its depth: geometryScreenDepthTexture of a FrameGraphGeometryRendererTask, in 32-bit floats
// targetTexture  handle of the texture to draw into; if you leave it out, the task creates one
// outputTexture  handle of the result, for the tasks after this one
export class PolygonBokehTask extends withLens(FrameGraphTask) {
  // name, frameGraph  as for every task
  // camera            the camera that draws the scene. You may set another one later, with the same kind of projection,
  //                   perspective or orthographic.
  // given             the options, as for PolygonBokeh
  constructor(name, frameGraph, camera, given) {
    super(name, frameGraph);
    const options = checked('PolygonBokehTask', given, OPTIONS);
    const { engine } = frameGraph;
    const kinds = SCREEN_DEPTH[camera.mode === Constants.PERSPECTIVE_CAMERA ? 'perspective' : 'orthographic'];
    const held = [kinds[engine.useReverseDepthBuffer ? 1 : 0], ...PLANES].join(', ');
    // The settings, as in PolygonBokeh
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

  // Adds the passes to the graph. Babylon.js calls this when it builds the graph, and again after a resize. Throws an
  // Error if sourceTexture or depthTexture is not set.
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
      // nothing is blurred: the last pass copies the input
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

// Returns the options with which a frame graph creates a texture of 16-bit floats
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
