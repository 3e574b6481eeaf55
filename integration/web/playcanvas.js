// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for PlayCanvas: a CameraFrame whose depth of field is made of the functions of the
// library. It stands after TAA, before bloom and tone mapping.

import { CameraFrame, FramePass, FramePassCameraFrame, RenderPassShaderQuad, RenderTarget } from 'playcanvas';
import { ADDRESS_CLAMP_TO_EDGE, FILTER_LINEAR, PIXELFORMAT_RGBA16F, SEMANTIC_POSITION } from 'playcanvas';
import { PROJECTION_PERSPECTIVE, ShaderUtils, Texture } from 'playcanvas';
import { checked, diameter, pulled, uniformsOf } from './common.js';
import { clockwise, declared, frame, library, stored, views } from './frames.js';
import { GLSL, WGSL } from './shaders.js';

// What CameraFrame has as depth, as BokehLinearDepth reads it: metres from a prepass; 1 / metres from the scene pass
const DEPTH = { prepass: '0, 0.0, 0.0', scene: '3, 1.0, 0.0' };

// The names of uniforms and textures are common to all shaders of PlayCanvas: these get a prefix.
const own = (name) => `bokeh_${name}`;

// The two languages
const IN_GLSL = {
  vertex: `
attribute vec2 aPosition;
varying vec2 bokehUv;
void main()
{
    bokehUv = aPosition * 0.5 + 0.5;
    gl_Position = vec4(aPosition, 0.0, 1.0);
}`,

  // PlayCanvas evaluates #if by itself. It does not know GL_ES, by which the library sets the precision, and compares
  // numbers as text, in which 13 < 2: the errors of a wrong configuration go.
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

// 32-bit floats
const FLOAT = ['depth', 'metres'];
const filtered = (name) => `var ${name}: texture_2d<f32>;\nvar ${name}Sampler: sampler;\n`;
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

  // each on a line of its own; 'uff': a 32-bit float texture, which not every device filters
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

// What comes after the library in a pass that reads the textures `reads`
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
  // bokeh   the PolygonBokeh that it is a pass of
  // reads   the textures, by name
  // target  that it draws into, of 1 / scale of the size
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
    this.shader = null; // PlayCanvas keeps it for the next pass of that name
  }
}

// All passes from colour and depth to the result: textures.color, .depth and .metres are set before each frame
class PolygonBokeh extends FramePass {
  // held  a key of DEPTH: what textures.depth holds
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

  // Whether nothing is blurred, nor shown in place of the result
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

  // Before its passes are looked at: which of them draw
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
  // Depth as PlayCanvas has it for its own depth of field: from the scene pass, where Gaussian splats can be in it, or, with
  // multisampling and on devices that cannot blend targets apart, from a prepass. paper reads metres, which only that has.
  sanitizeOptions(options) {
    const paper = this.cameraFrame?.bokehOptions?.method === 'paper';
    const given = { ...options, dofEnabled: true, prepassEnabled: paper || options?.prepassEnabled };
    return { ...super.sanitizeOptions(given), dofEnabled: options?.dofEnabled ?? false };
  }

  createPasses(options) {
    super.createPasses(options);
    const { uniforms, bokehOptions } = this.cameraFrame;
    // CameraFrame makes its first passes before it is told of these
    const held = this.sceneDepthTexture ? 'scene' : 'prepass';
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
    if (this.bokeh.isOff) return; // PlayCanvas goes on with the scene as it is
    this.composePass.sceneTexture = textures.result;
    this.scenePassHalf?.setSourceTexture(textures.result);
  }
}

export class PolygonBokehFrame extends CameraFrame {
  // options, all of them checked:
  //   method   'layered': near objects spread over what is behind them; 'exact': each pixel by its own circle of
  //            confusion, fewer passes; 'paper': lines and min, a target less
  //   sides    6 or 8; layered and exact have 4 and 10 as well
  //   preset   'MOBILE', 'LOW', 'MEDIUM', 'HIGH' or 'ULTRA'
  //   opaque   false: alpha is the circle of confusion in the end too, signed but for paper. A canvas would take it for
  //            transparency.
  //   extras   common.js
  constructor(app, cameraComponent, options) {
    const bokehOptions = checked('PolygonBokehFrame', options);
    if (!app.graphicsDevice.textureFloatRenderable) {
      throw new Error('polygonal-bokeh, PolygonBokehFrame: this device cannot render to float textures.');
    }
    super(app, cameraComponent);
    // To be set from outside. Metres, but for maxCoC (fraction of the image height) and rotation (radians, clockwise on
    // the screen).
    this.uniforms = uniformsOf(bokehOptions);
    this.debugMode = 0; // 1 depth, 2 circle of confusion, 3 near and far field
    this.bokehOptions = bokehOptions;
    this.rendering.renderFormats = [PIXELFORMAT_RGBA16F];
    this.update();
  }

  createRenderPass() {
    return new BokehCameraFrame(this.app, this, this.cameraComponent, this.options);
  }

  // The lens of the camera's own field of view, at an f-stop; call it again where the camera zooms. bokehScale is how many
  // times wider the blur is than that lens's: 1 is the real lens, which hardly blurs at a game's field of view
  // (docs/lens.md), 0 is none. An orthographic camera has no field of view: focalLength stays.
  setLens(fStop = 2.8, bokehScale = 10) {
    const { projection, projectionMatrix } = this.cameraComponent;
    const { uniforms } = this;
    if (projection === PROJECTION_PERSPECTIVE) {
      uniforms.focalLength = 0.5 * uniforms.sensorHeight * projectionMatrix.data[5];
    }
    uniforms.apertureDiameter = diameter(uniforms.focalLength, fStop, bokehScale);
  }

  // Focus on a place in the world: focusDistance is the depth along the view axis, not the length of the ray.
  focusOn(point) {
    this.uniforms.focusDistance = -this.cameraComponent.viewMatrix.transformPoint(point).z;
  }

  // Autofocus, once a frame of dt seconds: towards the nearest of these depths, tau is its time constant in seconds.
  pullFocus(dt, depths, tau = 0.2) {
    this.uniforms.focusDistance = pulled(this.uniforms.focusDistance, dt, depths, tau);
  }
}
