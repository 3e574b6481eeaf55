// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for PlayCanvas: a CameraFrame with depth of field, which runs after TAA, and before bloom and tone
// mapping. Its shaders call the functions of the library, in GLSL for WebGL 2 and in WGSL for WebGPU.

import { CameraFrame, FramePass, FramePassCameraFrame, RenderPassShaderQuad, RenderTarget } from 'playcanvas';
import { ADDRESS_CLAMP_TO_EDGE, FILTER_LINEAR, PIXELFORMAT_RGBA16F, SEMANTIC_POSITION } from 'playcanvas';
import { PROJECTION_PERSPECTIVE, ShaderUtils, Texture } from 'playcanvas';
import { checked, diameter, pulled, uniformsOf } from './common.js';
import { clockwise, declared, frame, library, stored, views } from './frames.js';
import { GLSL, WGSL } from './shaders.js';

// Arguments of BokehLinearDepth (kind, near, far) for the depth of CameraFrame: a prepass writes metres, and the scene
// pass 1 / metres
const DEPTH = { prepass: '0, 0.0, 0.0', scene: '3, 1.0, 0.0' };

// All shaders of PlayCanvas share the names of uniforms and textures, so ours get a prefix.
const own = (name) => `bokeh_${name}`;

// How the parts of a shader are written in GLSL
const IN_GLSL = {
  vertex: `
attribute vec2 aPosition;
varying vec2 bokehUv;
void main()
{
    bokehUv = aPosition * 0.5 + 0.5;
    gl_Position = vec4(aPosition, 0.0, 1.0);
}`,

  // PlayCanvas has a preprocessor of its own. It does not define GL_ES, for which the library sets the precision, so
  // the precision is added here. And it compares numbers as text, so that 13 < 2. The library's #error lines, which
  // reject a wrong configuration, are therefore removed.
  library(options) {
    const precision = ['float', 'int', 'sampler2D'].map((type) => `precision highp ${type};\n`);
    return [...precision, library(GLSL, options).replace(/^#error.*$/gm, '')].join('');
  },

  declarations: (textures, uniforms) => `
uniform sampler2D ${textures.map(own).join(', ')};
uniform float ${uniforms.map(own).join(', ')};
uniform vec2 bokeh_imageSize;
varying vec2 bokehUv;
`,
  uniform: own,
  main: (declarations, renamed, sampled, opaque) => `
void main()
{
    vec2 uv = bokehUv;
    ${clockwise(declarations)}
    ${clockwise(stored(renamed, (i) => `pcFragColor${i}`))}
    ${opaque ? 'pcFragColor0.a = 1.0;' : ''}
}`,
};

// Textures of 32-bit floats
const FLOAT = ['depth', 'metres'];
const filtered = (name) => `var ${name}: texture_2d<f32>;\nvar ${name}Sampler: sampler;\n`;
// The same parts in WGSL
const IN_WGSL = {
  vertex: `
attribute aPosition: vec2f;
varying bokehUv: vec2f;
@vertex fn vertexMain(input: VertexInput) -> VertexOutput
{
    var output: VertexOutput;
    output.bokehUv = input.aPosition * vec2f(0.5, -0.5) + 0.5;
    output.position = vec4f(input.aPosition, 0.0, 1.0);
    return output;
}`,

  library: (options) => library(WGSL, options),

  // PlayCanvas needs every declaration on a line of its own. 'uff' means a texture of 32-bit floats without a filter,
  // because not every device can filter such a texture.
  declarations: (textures, uniforms) => `
${textures.map((name) => (FLOAT.includes(name) ? `var ${own(name)}: texture_2d<uff>;\n` : filtered(own(name)))).join('')}
${uniforms.map((name) => `uniform ${own(name)}: f32;\n`).join('')}
uniform bokeh_imageSize: vec2f;
varying bokehUv: vec2f;
`,
  uniform: (name) => `uniform.${own(name)}`,
  main: (declarations, renamed, sampled, opaque) => `
@fragment fn fragmentMain(input: FragmentInput) -> FragmentOutput
{
    var output: FragmentOutput;
    let uv = input.bokehUv;
    ${declarations}
    ${stored(renamed, (i) => `output.color${i || ''}`, `${own(sampled)}Sampler`)}
    ${opaque ? 'output.color.a = 1.0;' : ''}
    return output;
}`,
};

function replaced(text, names, by) {
  return text.replace(new RegExp(`(?<![.\\w])(${names.join('|')})\\b`, 'g'), (name) => by(name));
}

// Returns the part of a pass's shader that follows the library
//   reads  names of the textures that the pass reads
//   place  number of the pass in its frame
function fragment(language, reads, row, place, options, opaque) {
  const uniforms = Object.keys(uniformsOf(options));
  const sampled = reads.find((name) => !FLOAT.includes(name));
  const [writes, scale, call, ...returned] = row;
  const renamed = [writes, scale, replaced(call, reads, own), ...returned];
  const declarations = replaced(declared(row, options, place, language === IN_WGSL), reads, own);
  const main = language.main(declarations, renamed, sampled, opaque);
  return language.declarations(reads, uniforms) + replaced(main, [...uniforms, 'imageSize'], language.uniform);
}

class BokehPass extends RenderPassShaderQuad {
  // bokeh   the PolygonBokeh that the pass belongs to
  // scale   the target has 1 / scale of the size of the image
  // reads   names of the textures that the pass reads
  // target  the render target that the pass draws into
  constructor(bokeh, shader, scale, reads, target) {
    super(bokeh.device);
    Object.assign(this, { bokeh, shader, reads, scale });
    this.init(target);
  }

  frameUpdate() {
    const { width, height } = this.bokeh.textures.color;
    this.renderTarget.resize(Math.ceil(width / this.scale), Math.ceil(height / this.scale));
  }

  execute() {
    const { textures, uniforms } = this.bokeh;
    const { width, height } = textures.color;
    const set = (name, value) => this.device.scope.resolve(own(name)).setValue(value);
    for (const name of this.reads) set(name, textures[name]);
    for (const name in uniforms) set(name, uniforms[name]);
    set('imageSize', [width, height]);
    super.execute();
  }

  destroy() {
    this.shader = null; // frees the quad; PlayCanvas caches the shader for the next pass with the same name
  }
}

// All passes from colour and depth to the result. textures.color, .depth and .metres must be set before each frame.
class PolygonBokeh extends FramePass {
  // held  which kind of depth is in textures.depth: a key of DEPTH
  constructor(device, uniforms, options, held) {
    super(device);
    this.uniforms = uniforms;
    this.textures = { color: null, depth: null, metres: null };
    const { method, sides, preset, opaque, extras } = options;
    const language = device.isWebGPU ? IN_WGSL : IN_GLSL;
    const text = language.library(options);
    const rows = frame(options, DEPTH[held]);
    this.targets = rows.map(([writes]) => {
      const colorBuffers = writes.map((name) => (this.textures[name] = this.texture(name)));
      return new RenderTarget({ name: writes[0], colorBuffers, depth: false });
    });

    const pass = (row, place, target) => {
      const [, scale, call] = row;
      const last = opaque && target === this.targets.at(-1);
      const reads = Object.keys(this.textures).filter((name) => new RegExp(`(?<!\\.)\\b${name}\\b`).test(call));
      const shader = ShaderUtils.createShader(device, {
        uniqueName: ['bokeh', method, sides, preset, ...extras, held, last, place].join('-'),
        attributes: { aPosition: SEMANTIC_POSITION },
        vertexGLSL: IN_GLSL.vertex,
        vertexWGSL: IN_WGSL.vertex,
        [device.isWebGPU ? 'fragmentWGSL' : 'fragmentGLSL']: text + fragment(language, reads, row, Number(place) || 0, options, last),
      });
      return new BokehPass(this, shader, scale, reads, target);
    };
    this.passes = rows.map((row, i) => pass(row, i, this.targets[i]));
    this.views = views(method, DEPTH[held]).map((row, i) => pass(row, `view${i}`, this.targets.at(-1)));
    this.beforePasses.push(...this.passes, ...this.views);
  }

  // Whether no pass has to be drawn: nothing is blurred, and no debug view is shown
  get isOff() {
    return !(this.uniforms.apertureDiameter > 0) && this.debugMode === 0;
  }

  texture(name) {
    return new Texture(this.device, {
      name: own(name),
      width: 1,
      height: 1,
      format: PIXELFORMAT_RGBA16F,
      mipmaps: false,
      minFilter: FILTER_LINEAR,
      magFilter: FILTER_LINEAR,
      addressU: ADDRESS_CLAMP_TO_EDGE,
      addressV: ADDRESS_CLAMP_TO_EDGE,
    });
  }

  // Enables the passes that have to be drawn. PlayCanvas calls this before it collects the enabled passes.
  frameUpdate() {
    super.frameUpdate();
    if ('frame' in this.uniforms) this.uniforms.frame += 1;
    this.passes.forEach((pass, i) => (pass.enabled = !this.isOff && (i === 0 || this.debugMode === 0)));
    this.views.forEach((pass, i) => (pass.enabled = i + 1 === this.debugMode));
  }

  destroy() {
    this.beforePasses.forEach((pass) => pass.destroy());
    for (const target of this.targets) {
      target.destroyTextureBuffers();
      target.destroy();
    }
  }
}

class BokehCameraFrame extends FramePassCameraFrame {
  // Makes PlayCanvas provide depth as it does for its own depth of field, without turning that on. The depth comes from
  // the scene pass, which can include Gaussian splats. With multisampling, and on devices that cannot blend each target
  // differently, it comes from a prepass. paper needs metres, which only the prepass writes.
  sanitizeOptions(options) {
    const paper = this.cameraFrame?.bokehOptions?.method === 'paper';
    const given = { ...options, dofEnabled: true, prepassEnabled: paper || options?.prepassEnabled };
    return { ...super.sanitizeOptions(given), dofEnabled: options?.dofEnabled ?? false };
  }

  createPasses(options) {
    super.createPasses(options);
    const { uniforms, bokehOptions } = this.cameraFrame;
    const held = this.sceneDepthTexture ? 'scene' : 'prepass';
    // the constructor of CameraFrame creates its first passes before `uniforms` is set
    this.bokeh = uniforms && new PolygonBokeh(this.device, uniforms, bokehOptions, held);
  }

  collectPasses() {
    const passes = super.collectPasses();
    passes.splice(passes.indexOf(this.scenePassHalf ?? this.composePass), 0, this.bokeh);
    return passes;
  }

  frameUpdate() {
    super.frameUpdate();
    const { textures } = this.bokeh;
    this.bokeh.debugMode = this.cameraFrame.debugMode;
    textures.color = this.composePass.sceneTexture;
    textures.metres = this.prePass?.linearDepthTexture;
    textures.depth = this.sceneDepthTexture ?? textures.metres;
    if (this.bokeh.isOff) return; // the later effects of PlayCanvas read the sharp scene
    this.composePass.sceneTexture = textures.result;
    this.scenePassHalf?.setSourceTexture(textures.result);
  }
}

export class PolygonBokehFrame extends CameraFrame {
  // app, cameraComponent  as for CameraFrame
  // options               see common.d.ts; throws an Error if one of them is invalid
  // Also throws an Error if the device cannot draw into textures of 32-bit floats.
  constructor(app, cameraComponent, options) {
    const bokehOptions = checked('PolygonBokehFrame', options);
    if (!app.graphicsDevice.textureFloatRenderable) {
      throw new Error('polygonal-bokeh, PolygonBokehFrame: this device cannot render to float textures.');
    }
    super(app, cameraComponent);
    // The settings, which you may change in every frame: lengths in metres, maxCoC as a fraction of the image height,
    // and rotation in radians, clockwise on the screen. common.d.ts describes all of them.
    this.uniforms = uniformsOf(bokehOptions);
    this.debugMode = 0; // 0 result, 1 depth, 2 circle of confusion, 3 near and far field
    this.bokehOptions = bokehOptions;
    this.rendering.renderFormats = [PIXELFORMAT_RGBA16F];
    this.update();
  }

  createRenderPass() {
    return new BokehCameraFrame(this.app, this, this.cameraComponent, this.options);
  }

  // common.d.ts describes this method, and pullFocus().
  setLens(fStop = 2.8, bokehScale = 10) {
    const { projection, projectionMatrix } = this.cameraComponent;
    const { uniforms } = this;
    if (projection === PROJECTION_PERSPECTIVE) {
      uniforms.focalLength = 0.5 * uniforms.sensorHeight * projectionMatrix.data[5];
    }
    uniforms.apertureDiameter = diameter(uniforms.focalLength, fStop, bokehScale);
  }

  // Focuses on a point of the scene: sets focusDistance to its depth along the view axis, not along the ray.
  focusOn(point) {
    this.uniforms.focusDistance = -this.cameraComponent.viewMatrix.transformPoint(point).z;
  }

  pullFocus(dt, depths, tau = 0.2) {
    this.uniforms.focusDistance = pulled(this.uniforms.focusDistance, dt, depths, tau);
  }
}
