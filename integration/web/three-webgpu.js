// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGPURenderer: a node for RenderPipeline. It reads a scene pass, or any colour
// node and a depth texture. Use it before bloom and tone mapping. Its shaders call the functions of the library, in
// WGSL. The WebGL 2 backend does not accept WGSL, so the node shows its input without blur there.

import { FloatType, HalfFloatType, NoBlending, Raycaster, RedFormat, Vector2, Vector3 } from 'three/webgpu';
import { Node, NodeMaterial, NodeUpdateType, QuadMesh, RenderTarget, RendererUtils, VarNode } from 'three/webgpu';
import { nodeObject, outputStruct, passTexture, rtt, sampler, texture, uniform, uv, vec4, wgsl, wgslFn } from 'three/tsl';
import { uniformsOf } from './common.js';
import { METRES, UNBLURRED, declared, frame, inWgsl, library, views } from './frames.js';
import { WGSL } from './shaders.js';
import { THREE_CHOICES, drawLayer, withLens } from './three-common.js';

const CLASS = { name: 'PolygonBokehNode', choices: { ...THREE_CHOICES, sharpLayer: undefined } };
const TYPES = { depthKind: 'i32', imageSize: 'vec2f', uv: 'vec2f', Linear: 'sampler' };

const WEBGL =
  'polygonal-bokeh: nothing is blurred, because PolygonBokehNode needs WebGPU, and this renderer fell back to WebGL 2. ' +
  'For WebGL, use PolygonBokehPass with WebGLRenderer.';
const LOGARITHMIC =
  'polygonal-bokeh: PolygonBokehNode cannot read logarithmicDepthBuffer of WebGPURenderer, because bokeh.wgsl cannot ' +
  'convert its depth, log(metres / near) / log(far / near), to metres. Use reversedDepthBuffer instead.';

const INPUTS =
  'polygonal-bokeh: PolygonBokehNode takes (scenePass, options), or (color, depth, camera, options), where depth is the ' +
  "node of a depth texture, such as scenePass.getTextureNode('depth').";
const SHARP =
  'polygonal-bokeh: the option sharpLayer needs the arguments (scenePass, options). With (color, depth, camera, ' +
  'options), draw the glass after the bokeh.';

// Returns a material without blending: alpha is not opacity, but the circle of confusion or a layer's weight
const material = (fragmentNode) =>
  Object.assign(new NodeMaterial(), { fragmentNode, blending: NoBlending, depthTest: false, depthWrite: false });
let rendererState;

const targetOf = (renderer) => [renderer.getRenderTarget(), renderer.getActiveCubeFace(), renderer.getActiveMipmapLevel()];

// Renderer -> { calling: whether compileAsync is being called, target: the render target to restore afterwards }
const compiling = new WeakMap();

// Makes compileAsync restore the render target. New versions of three.js compile in pieces, between frames. For each
// piece, they set the target that was set when compileAsync was called, and do not reset it. A frame between two pieces
// would then be drawn into that target, instead of the canvas. Old versions have neither these methods nor this bug.
function compilingOf(renderer) {
  if (!compiling.has(renderer)) {
    const state = { calling: false, target: [null] };
    const { _beginPreCompile: begin, _finishPreCompile: finish } = renderer;
    if (begin && finish) {
      renderer._beginPreCompile = (...given) => {
        if (!state.calling) state.target = targetOf(renderer);
        begin.apply(renderer, given);
      };
      renderer._finishPreCompile = () => {
        finish.call(renderer);
        if (!state.calling) renderer.setRenderTarget(...state.target);
      };
    }
    compiling.set(renderer, state);
  }
  return compiling.get(renderer);
}

// Returns the node of a texture with the result of `node`. An expression is first drawn into a texture.
function textureOf(node) {
  const held = node.getTextureNode?.() ?? node;
  return held.isTextureNode && !held.uvNode && !held.levelNode ? held : rtt(held);
}

// Returns the number of samples per pixel of a depth texture. For a scene pass, it comes from the options, because a
// pass sets the samples of its target only when it is drawn.
function samplesOf({ passNode, value }, renderer) {
  if (passNode?.isPassNode) return passNode.options.samples ?? renderer.samples;
  return value.renderTarget?.samples ?? 0;
}

export class PolygonBokehNode extends withLens(Node, CLASS, { Raycaster, Vector2, Vector3 }) {
  static get type() {
    return 'PolygonBokehNode';
  }

  // The arguments are (scenePass, options) or (color, depth, camera, options):
  //
  // scenePass  pass(scene, camera)
  // color      the node to blur: any node, such as a scene pass times ambient occlusion, or the result of TRAA
  // depth      node of the depth texture that belongs to it: scenePass.getTextureNode('depth')
  // camera     the camera that the depth was drawn with
  // options    the options of PolygonBokehPass except depthTexture, and
  //   sharpLayer  a layer whose objects are drawn sharp after the bokeh, and hidden by nearer objects: for glass and
  //               other transparent objects that write no depth. Call object.layers.set(1), and give 1 here. It needs a
  //               scene pass. The objects appear one frame late, in the beginning and after a resize, because three.js
  //               then creates the target that shares the depth again.
  // Throws an Error if an argument or an option is invalid.
  constructor(color, ...others) {
    super('vec4');
    const isPass = Boolean(color?.isPassNode && !others[0]?.isNode);
    const [depth, camera, options] = isPass ? [color.getTextureNode('depth'), color.camera, others[0]] : others;
    if (!color?.isNode || !depth?.value?.isDepthTexture || !camera?.isCamera) throw new Error(INPUTS);
    this.updateBeforeType = NodeUpdateType.FRAME;
    this.scenePass = isPass ? color : null;
    this.source = { color: textureOf(color), depth };
    this.ownCamera = camera;
    this.options = this.checked(options);
    if (!isPass && this.options.sharpLayer !== undefined) throw new Error(SHARP);

    // The settings, which you may change in every frame: lengths in metres, maxCoC as a fraction of the image height,
    // and rotation in radians, clockwise on the screen. common.d.ts describes all of them.
    // debugMode: 0 result, 1 depth, 2 circle of confusion, 3 near and far field
    this.uniforms = {
      debugMode: uniform(0, 'int'),
      depthKind: uniform(1, 'int'),
      nearPlane: uniform(0),
      farPlane: uniform(0),
      imageSize: uniform(new Vector2(1, 1)),
    };
    // later nodes read this target, so change() keeps it
    this.result = new RenderTarget(1, 1, { type: HalfFloatType, depthBuffer: false });
    this.sharp = this.options.sharpLayer === undefined ? null : new RenderTarget(1, 1, { type: HalfFloatType });
    this.underSharp = new QuadMesh(material(texture(this.result.texture)));
    Object.assign(this, this.made(this.options));
  }

  get camera() {
    return this.scenePass?.camera ?? this.ownCamera;
  }

  set camera(camera) {
    if (this.scenePass) this.scenePass.camera = camera;
    else this.ownCamera = camera;
  }

  // Creates the passes of a frame with these options, still without materials.
  made(options) {
    for (const [name, value] of Object.entries(uniformsOf(options))) this.uniforms[name] ??= uniform(value);
    const rows = [...(options.method === 'paper' ? [METRES] : []), ...frame(options)];
    const targets = { result: this.result };
    const passes = rows.map((row) => {
      const [writes, scale] = row;
      const type = writes[0] === 'metres' ? { type: FloatType, format: RedFormat } : { type: HalfFloatType };
      targets[writes] ??= new RenderTarget(1, 1, { ...type, depthBuffer: false, count: writes.length });
      return { row, writes, scale, target: targets[writes] };
    });
    const shown = views(options.method).map((row) => ({ row, writes: row[0], target: this.result }));
    const beforeView = passes.slice(0, 1 + passes.findIndex(({ writes }) => writes[0] === 'coc'));
    const copy = { row: UNBLURRED, writes: UNBLURRED[0], target: this.result };
    return { options, passes, views: shown, beforeView, copy };
  }

  // Creates the materials of a frame.
  fill({ options, passes, views: shown, copy }) {
    const { given, depthType } = this;
    const inputs = { ...this.uniforms, ...given };
    for (const { writes, target } of passes) {
      writes.forEach((name, i) => (inputs[name] = texture(target.textures[i])));
    }
    inputs.Linear = sampler(inputs.coc);
    const text = library(WGSL, options);
    const ofDepth = text.replace(/(?<=alias BokehDepthTexture = )[^;]+/, depthType);
    const libraries = [wgsl(text), wgsl(ofDepth)];
    [...passes, ...shown, copy].forEach((drawn, i) => {
      drawn.quad ??= new QuadMesh(material(this.fragment(drawn.row, i, options, inputs, libraries, depthType)));
    });
  }

  // Creates the materials of a frame, and compiles the shaders of its passes.
  async compile(made) {
    this.fill(made);
    for (const { target, quad } of made.passes) await this.compileOne(target, quad); // three.js compiles one at a time
  }

  compileOne(target, quad) {
    const { renderer } = this;
    const state = compilingOf(renderer);
    Object.assign(state, { calling: true, target: targetOf(renderer) });
    rendererState = RendererUtils.resetRendererState(renderer, rendererState);
    renderer.setRenderTarget(target);
    const { depth } = renderer;
    renderer.depth = false; // compileAsync reads this instead of the target's own setting
    const compiled = renderer.compileAsync(quad, quad.camera);
    renderer.depth = depth;
    RendererUtils.restoreRendererState(renderer, rendererState);
    state.calling = false;
    return compiled;
  }

  // Returns why the node cannot draw, or ''. updateBefore() throws it: three.js only logs what setup() throws.
  refused({ logarithmicDepthBuffer }) {
    // for an orthographic camera, three.js does not write logarithmic depth
    return logarithmicDepthBuffer && !this.camera.isOrthographicCamera ? LOGARITHMIC : '';
  }

  // three.js calls this when the node is first used.
  setup(builder) {
    const { color, depth } = this.source;
    Object.assign(builder.getNodeProperties(this), { color, depth }); // so that they are drawn before this node
    this.stepsAside = !builder.renderer.backend.isWebGPUBackend;
    if (this.stepsAside) {
      console.warn(WEBGL);
      return color;
    }
    if (!this.refused(builder.renderer)) {
      // The passes get new nodes of the textures. If they read the node of an expression, three.js would draw the
      // expression again for each pass.
      this.given ??= { uv: uv(), color: texture(color.value), depth: texture(depth.value) };
      this.depthType = samplesOf(depth, builder.renderer) > 1 ? 'texture_depth_multisampled_2d' : 'texture_depth_2d';
      this.fill(this);
    }
    return passTexture(this, (this.sharp ?? this.result).texture);
  }

  // Returns a pass as a node: a function in WGSL around the call of the library. three.js finds the names and types of
  // the function's parameters in its text, and passes arguments by name. It does not know the library's structs, so a
  // pass with several targets returns them as the columns of a matrix.
  fragment(row, place, options, inputs, [library, libraryOfDepth], depthType) {
    const [writes, , call, returned] = row;
    const several = writes.length > 1;
    const members = (returned ?? '').split(' ').slice(1);
    // a column for each target; if there are only two or three targets, the last one fills the rest
    const columns = [0, 1, 2, 3].map((i) => `targets.${members[Math.min(i, members.length - 1)]}`);
    const body = `
    ${declared(row, options, place, true)}
    let targets = ${inWgsl(call, 'Linear')};
    return ${several ? `mat4x4f(${columns.join(', ')})` : 'targets'};
`;
    const types = { ...TYPES, depth: depthType };
    const type = (name) => types[name] ?? (name in this.uniforms ? 'f32' : 'texture_2d<f32>');
    const named = Object.keys(inputs).filter((name) => new RegExp(`(?<![.\\w])${name}\\b`).test(body));
    const parameters = named.map((name) => `${name}: ${type(name)}`).join(', ');
    const code = `fn bokehPass(${parameters}) -> ${several ? 'mat4x4f' : 'vec4f'}\n{${body}}`;
    // only those that the body names: three.js binds everything it gets, and a pass may read at most 16 textures
    const given = Object.fromEntries(named.map((name) => [name, inputs[name]]));
    // toVar() would also add the call to the shader of the canvas, because setup() runs there
    const value = nodeObject(new VarNode(wgslFn(code, ['depth' in given ? libraryOfDepth : library])(given)));
    if (several) return outputStruct(...writes.map((_, i) => value.element(i)));
    return options.opaque && !options.alpha && writes[0] === 'result' ? vec4(value.rgb, 1) : value;
  }

  // Draws the passes. three.js calls this once per frame, after it has drawn the scene.
  updateBefore({ renderer }) {
    if (this.stepsAside) return;
    const problem = this.refused(renderer);
    if (problem) throw new Error(problem);
    const { color, depth } = this.source;
    const { depthKind, nearPlane, farPlane, imageSize, debugMode, apertureDiameter, frame: number } = this.uniforms;
    this.renderer = renderer;
    // 1 perspective, 2 reversed perspective, 5 orthographic, 6 reversed orthographic; the renderer sets reversedDepth
    depthKind.value = (this.camera.isOrthographicCamera ? 5 : 1) + (this.camera.reversedDepth ? 1 : 0);
    nearPlane.value = this.camera.near;
    farPlane.value = this.camera.far;
    imageSize.value.set(...this.size);
    this.given.color.value = color.value; // it may be another texture in each frame
    this.given.depth.value = depth.value;
    if (number) number.value += 1;
    this.resize(this.passes);

    rendererState = RendererUtils.resetRendererState(renderer, rendererState);
    const view = this.views[debugMode.value - 1];
    // Later nodes read the result. If nothing is blurred, the colour is therefore copied into it.
    const drawn = apertureDiameter.value > 0 ? this.passes : [this.copy];
    for (const { quad, target } of view ? [...this.beforeView, view] : drawn) {
      renderer.setRenderTarget(target);
      renderer.render(quad, quad.camera); // quad.render would need a vertex shader that was not compiled
    }
    if (this.sharp) this.drawSharp(renderer);
    RendererUtils.restoreRendererState(renderer, rendererState);
  }

  // Copies the result, and draws the objects of the sharp layer over it, with the depth of the scene.
  drawSharp(renderer) {
    const { sharp, underSharp, camera } = this;
    const { scene, renderTarget } = this.scenePass;
    const { depthTexture, width, height } = renderTarget;
    sharp.setSize(width, height);
    if (sharp.depthTexture !== depthTexture) {
      sharp.depthTexture = depthTexture;
      depthTexture.renderTarget = renderTarget; // which remains its owner
    }
    renderer.setRenderTarget(sharp);
    renderer.autoClear = false;
    renderer.render(underSharp, underSharp.camera);
    drawLayer(renderer, scene, camera, this.options.sharpLayer);
  }

  // Size of the input: [width, height]
  get size() {
    const { width, height } = this.source.color.value.image;
    return [width, height];
  }

  resize(passes) {
    const [width, height] = this.size;
    for (const { target, scale } of passes) target.setSize(Math.ceil(width / scale), Math.ceil(height / scale));
  }

  discard({ passes, views: shown, copy }) {
    for (const { target, quad } of [...passes, ...shown, copy]) {
      if (target !== this.result) target.dispose();
      quad?.material.dispose();
    }
  }

  dispose() {
    this.discard(this);
    for (const own of [this.result, this.sharp, this.underSharp.material]) own?.dispose();
    super.dispose();
  }
}
