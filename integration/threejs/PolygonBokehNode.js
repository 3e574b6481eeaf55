// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGPURenderer: a node for RenderPipeline, made of the functions of the WGSL
// library. It reads the scene's pass, before bloom and tone mapping. WebGPU only: the WebGL 2 backend does not take WGSL.

import { FloatType, HalfFloatType, MathUtils, NoBlending, RedFormat, Vector2 } from 'three/webgpu';
import { Node, NodeMaterial, NodeUpdateType, QuadMesh, RenderTarget, RendererUtils, VarNode } from 'three/webgpu';
import { outputStruct, passTexture, sampler, texture, uniform, uv, vec4, wgsl, wgslFn } from 'three/tsl';
import { declared, frame, inWgsl, views, withPreset } from './frames.js';

// For paper: depth in metres, in a texture of its own
const METRES = [['metres'], 1, 'vec4(BokehLinearDepth(BokehFetchDepth(depth, uv), depthKind, nearPlane, farPlane))'];

const TYPES = { depthKind: 'i32', imageSize: 'vec2f', uv: 'vec2f', Linear: 'sampler' };

const LOGARITHMIC =
  'PolygonBokehNode cannot read logarithmicDepthBuffer of WebGPURenderer: log(metres / near) / log(far / near) is none ' +
  "of bokeh.wgsl's kinds of depth. Use reversedDepthBuffer.";

// no blending: alpha is the circle of confusion, or a layer's share
const material = (fragmentNode) => Object.assign(new NodeMaterial(), { fragmentNode, blending: NoBlending });
const quad = new QuadMesh();
let rendererState;

export class PolygonBokehNode extends Node {
  static get type() {
    return 'PolygonBokehNode';
  }

  // library    the text of bokeh.wgsl, and after it bokeh_layers.wgsl for layered, bokeh_paper.wgsl for paper
  // scenePass  pass(scene, camera)
  // method     'layered': near objects spread over what is behind them; 'exact': each pixel by its own circle of
  //            confusion, fewer passes; 'paper': lines and min, a target less
  // sides      6 or 8; layered and exact have 4 and 10 as well
  // preset     'LOW', 'MEDIUM', 'HIGH' or 'ULTRA'
  // opaque     false: alpha is the circle of confusion in the end too, signed but for paper. A canvas would take it for
  //            transparency.
  constructor(library, scenePass, { method = 'layered', sides = 6, preset = 'MEDIUM', opaque = true } = {}) {
    super('vec4');
    this.updateBeforeType = NodeUpdateType.FRAME;
    this.library = withPreset(library, preset);
    this.scenePass = scenePass;
    this.camera = scenePass.camera;
    Object.assign(this, { sides, opaque });

    // To be set from outside. Metres, but for maxCoC (fraction of the image height) and rotation (radians).
    // debugMode: 0 off, 1 depth, 2 circle of confusion, 3 near and far field.
    this.uniforms = {
      apertureDiameter: uniform(0.05),
      focalLength: uniform(0.05),
      focusDistance: uniform(5),
      sensorHeight: uniform(0.024),
      maxCoC: uniform(0.1),
      rotation: uniform(0),
      squeeze: uniform(1),
      debugMode: uniform(0, 'int'),
      depthKind: uniform(1, 'int'),
      nearPlane: uniform(0),
      farPlane: uniform(0),
      imageSize: uniform(new Vector2(1, 1)),
    };

    const inputs = method === 'paper' ? [METRES] : [];
    this.passes = [...inputs, ...frame(method, sides)].map((row) => {
      const [writes, scale] = row;
      const type = writes[0] === 'metres' ? { type: FloatType, format: RedFormat } : { type: HalfFloatType };
      const target = new RenderTarget(1, 1, { ...type, depthBuffer: false, count: writes.length });
      return { row, writes, scale, target };
    });
    this.views = views(method).map((row) => ({ ...this.passes.at(-1), row }));
    this.beforeView = this.passes.slice(0, inputs.length + 1);
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

  // Makes the materials, once. three.js calls it when the node is first used.
  setup(builder) {
    if (!builder.renderer.backend.isWebGPUBackend) throw new Error('PolygonBokehNode needs WebGPU: it is WGSL');
    // For an orthographic camera three.js leaves the logarithm out.
    if (builder.renderer.logarithmicDepthBuffer && !this.camera.isOrthographicCamera) throw new Error(LOGARITHMIC);
    const scene = this.scenePass.getTextureNode();
    const inputs = { ...this.uniforms, uv: uv(), color: scene, depth: this.scenePass.getTextureNode('depth') };
    for (const { writes, target } of this.passes) {
      writes.forEach((name, i) => (inputs[name] = texture(target.textures[i])));
    }
    inputs.Linear = sampler(inputs.coc);
    const { samples = builder.renderer.samples } = this.scenePass.options;
    const depthType = samples > 1 ? 'texture_depth_multisampled_2d' : 'texture_depth_2d';
    const ofDepth = this.library.replace(/(?<=alias BokehDepthTexture = )[^;]+/, depthType);
    const libraries = [wgsl(this.library), wgsl(ofDepth)];
    for (const drawn of [...this.passes, ...this.views]) {
      drawn.material ??= material(this.fragment(drawn.row, inputs, libraries, depthType));
    }

    builder.getNodeProperties(this).scene = scene; // so that the scene is drawn before this node
    return passTexture(this, this.passes.at(-1).target.texture);
  }

  // A pass as a node: a function around its call. three.js reads the names and types of the parameters out of the text,
  // and fills them by name. It does not know the library's structs, but matrices.
  fragment([writes, , call, returned], inputs, [library, libraryOfDepth], depthType) {
    const several = writes.length > 1;
    const members = (returned ?? '').split(' ').slice(1);
    // a column for each; of two or three, the last one again
    const columns = [0, 1, 2, 3].map((i) => `targets.${members[Math.min(i, members.length - 1)]}`);
    const body = `
    ${declared(call, this.sides, true)}
    let targets = ${inWgsl(call, 'Linear')};
    return ${several ? `mat4x4f(${columns.join(', ')})` : 'targets'};
`;
    const types = { ...TYPES, depth: depthType };
    const type = (name) => types[name] ?? (name in this.uniforms ? 'f32' : 'texture_2d<f32>');
    const named = Object.keys(inputs).filter((name) => new RegExp(`(?<![.\\w])${name}\\b`).test(body));
    const parameters = named.map((name) => `${name}: ${type(name)}`).join(', ');
    const code = `fn bokehPass(${parameters}) -> ${several ? 'mat4x4f' : 'vec4f'}\n{${body}}`;
    // only what is named: three.js binds all that it gets, and a pass may read 16 textures
    const given = Object.fromEntries(named.map((name) => [name, inputs[name]]));
    // toVar() would call it in the shader of the canvas as well, where setup() runs
    const value = new VarNode(wgslFn(code, ['depth' in given ? libraryOfDepth : library])(given));
    if (several) return outputStruct(...writes.map((_, i) => value.element(i)));
    return this.opaque && writes[0] === 'result' ? vec4(value.rgb, 1) : value;
  }

  // Draws the passes. three.js calls it once in a frame, after the scene.
  updateBefore({ renderer }) {
    const { width, height } = this.scenePass.renderTarget;
    const { depthKind, nearPlane, farPlane, imageSize, debugMode } = this.uniforms;
    for (const { target, scale } of this.passes) target.setSize(Math.ceil(width / scale), Math.ceil(height / scale));
    // 1 perspective, 2 perspective reversed, 5 orthographic, 6 orthographic reversed; the renderer sets reversedDepth
    depthKind.value = (this.camera.isOrthographicCamera ? 5 : 1) + (this.camera.reversedDepth ? 1 : 0);
    nearPlane.value = this.camera.near;
    farPlane.value = this.camera.far;
    imageSize.value.set(width, height);

    rendererState = RendererUtils.resetRendererState(renderer, rendererState);
    const view = this.views[debugMode.value - 1];
    for (const { material, target } of view ? [...this.beforeView, view] : this.passes) {
      quad.material = material;
      renderer.setRenderTarget(target);
      quad.render(renderer);
    }
    RendererUtils.restoreRendererState(renderer, rendererState);
  }

  dispose() {
    for (const { target, material } of [...this.passes, ...this.views]) {
      target.dispose();
      material?.dispose();
    }
    super.dispose();
  }
}
