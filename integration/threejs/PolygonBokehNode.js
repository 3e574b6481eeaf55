// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGPURenderer: a node for RenderPipeline, made of the functions of bokeh.wgsl.
// It reads the scene's pass, before bloom and tone mapping. WebGPU only: the WebGL 2 backend does not take WGSL.

import { FloatType, HalfFloatType, NoBlending, RedFormat, Vector2 } from 'three/webgpu';
import { Node, NodeMaterial, NodeUpdateType, QuadMesh, RenderTarget, RendererUtils } from 'three/webgpu';
import { outputStruct, passTexture, sampler, texture, uniform, uv, vec4, wgsl, wgslFn } from 'three/tsl';

// Angles of the lines in degrees: each pair is a parallelogram, and min of the two is the polygon (docs/apertures.md).
const LINES = {
  6: [[90, 30], [90, 150]],
  8: [[0, 90], [45, 135]],
};

// three.js reads the names and types of the parameters out of these texts, and fills them by name.
const METRES = `
fn bokehMetres(depth: f32, depthKind: i32, cameraNear: f32, cameraFar: f32) -> vec4f
{
    return vec4f(BokehLinearDepth(depth, depthKind, cameraNear, cameraFar), 0.0, 0.0, 1.0);
}`;

// 'SignedCoCMap' for exact, whose passes read no depth; 'CoCMap' for paper
const cocMap = (name) => `
fn bokehMap(Color: texture_2d<f32>, Depth: texture_2d<f32>, uv: vec2f, apertureDiameter: f32, focalLength: f32,
    focusDistance: f32, sensorHeight: f32, maxCoC: f32) -> vec4f
{
    return Bokeh${name}(Color, Depth, uv, apertureDiameter, focalLength, focusDistance, sensorHeight, maxCoC);
}`;

const SETTINGS = `
fn bokehSettings(imageSize: vec2f, spacing: f32) -> BokehFilter
{
    var settings = BokehDefaultFilter(imageSize);
    settings.spacing = spacing;
    return settings;
}`;

// A matrix, since three.js does not know the library's structs; of its columns as many are targets as there are edges
// less one
const exactFirst = (sides) => `
fn bokehExactFirst(Color: texture_2d<f32>, Linear: sampler, uv: vec2f, rotation: f32, squeeze: f32, imageSize: vec2f,
    spacing: f32) -> mat4x4f
{
    let polygon = BokehMakePolygon(${sides}, rotation, squeeze);
    let targets = BokehExactFirst(Color, Linear, uv, polygon, bokehSettings(imageSize, spacing));
    return mat4x4f(targets.T2, targets.T3, targets.T4, targets.T5);
}`;

const exactSecond = (sides) => `
fn bokehExactSecond(Color: texture_2d<f32>, Linear: sampler, ColorB: texture_2d<f32>, ColorC: texture_2d<f32>,
    ColorD: texture_2d<f32>, uv: vec2f, rotation: f32, squeeze: f32, imageSize: vec2f, spacing: f32) -> vec4f
{
    let polygon = BokehMakePolygon(${sides}, rotation, squeeze);
    return BokehExactSecond(Color, Linear, ColorB, ColorC, ColorD, uv, polygon, bokehSettings(imageSize, spacing));
}`;

const LINE = `
fn bokehLine(Color: texture_2d<f32>, Linear: sampler, Depth: texture_2d<f32>, uv: vec2f, lineAngle: f32, rotation: f32,
    squeeze: f32, imageSize: vec2f, spacing: f32) -> vec4f
{
    let segment = BokehSegment(lineAngle + rotation, 1.0, vec2f(0.0, 0.0), squeeze);
    return BokehDepthOfFieldAdaptive(Color, Linear, Depth, uv, segment, bokehSettings(imageSize, spacing), true);
}`;

const COMBINE = `
fn bokehCombine(lineBlur: vec4f, ColorB: texture_2d<f32>, Linear: sampler, uv: vec2f) -> vec4f
{
    return BokehCombine(lineBlur, BokehFetch(ColorB, Linear, uv), false);
}`;

const DEBUG = `
fn bokehDebug(Color: texture_2d<f32>, Depth: texture_2d<f32>, uv: vec2f, focusDistance: f32, maxCoC: f32,
    debugMode: i32) -> vec4f
{
    let CoC = BokehFetchNearest(Color, uv).a;
    let S2 = BokehFetchNearest(Depth, uv).r;
    if (debugMode == 3) { return BokehDebugFocus(S2, focusDistance, CoC, maxCoC); }
    if (debugMode == 2) { return BokehDebugCoC(CoC, maxCoC); }
    return BokehDebugDepth(S2, focusDistance);
}`;

const LOGARITHMIC =
  'PolygonBokehNode cannot read logarithmicDepthBuffer of WebGPURenderer: log(metres / near) / log(far / near) is none ' +
  "of bokeh.wgsl's kinds of depth. Use reversedDepthBuffer.";

// no blending: alpha is the circle of confusion
const material = (fragmentNode) => Object.assign(new NodeMaterial(), { fragmentNode, blending: NoBlending });
const quad = new QuadMesh();
let rendererState;

export class PolygonBokehNode extends Node {
  static get type() {
    return 'PolygonBokehNode';
  }

  // library    the text of bokeh.wgsl
  // scenePass  pass(scene, camera)
  // method     'exact': two passes, light adds up; 'paper': lines and min, a target less
  // sides      6 or 8; exact has 4 and 10 as well
  // samples    at most so many on an edge or a line
  // opaque     false: alpha is the circle of confusion in the end too, signed for exact. A canvas would take it for
  //            transparency.
  constructor(library, scenePass, { method = 'exact', sides = 6, samples = 33, opaque = true } = {}) {
    super('vec4');
    this.updateBeforeType = NodeUpdateType.FRAME;
    // three.js hands no pipeline constants on to WebGPU, so the override gets its value here
    const count = /(?<=override BOKEH_NUM_SAMPLES: i32 = )\d+/;
    this.library = wgsl(library.replace(count, samples) + SETTINGS);
    this.scenePass = scenePass;
    this.camera = scenePass.camera;
    Object.assign(this, { method, sides, opaque });

    // To be set from outside. Metres, but for maxCoC (fraction of the image height), rotation (radians) and spacing
    // (pixels between samples). debugMode: 0 off, 1 depth, 2 circle of confusion, 3 near and far field.
    this.uniforms = {
      apertureDiameter: uniform(0.05),
      focalLength: uniform(0.05),
      focusDistance: uniform(5),
      sensorHeight: uniform(0.024),
      maxCoC: uniform(0.1),
      rotation: uniform(0),
      squeeze: uniform(1),
      spacing: uniform(1),
      debugMode: uniform(0, 'int'),
      depthKind: uniform(1, 'int'),
      cameraNear: uniform(0),
      cameraFar: uniform(0),
      imageSize: uniform(new Vector2(1, 1)),
    };

    const half = { type: HalfFloatType, depthBuffer: false };
    this.depth = new RenderTarget(1, 1, { type: FloatType, format: RedFormat, depthBuffer: false });
    this.coc = new RenderTarget(1, 1, half);
    this.result = new RenderTarget(1, 1, half);
    this.targets =
      method === 'exact'
        ? [new RenderTarget(1, 1, { ...half, count: sides / 2 - 1 })]
        : [new RenderTarget(1, 1, half), new RenderTarget(1, 1, half)];
    this.before = this.debug = this.passes = []; // [material, target] each; setup() makes them
  }

  // Focus on a place in the world: focusDistance is the depth along the view axis, not the length of the ray.
  focusOn(point) {
    this.uniforms.focusDistance.value = -this.camera.worldToLocal(point.clone()).z;
  }

  // Makes the materials, once. three.js calls it when the node is first used.
  setup(builder) {
    if (!builder.renderer.backend.isWebGPUBackend) throw new Error('PolygonBokehNode needs WebGPU: it is WGSL');
    // For an orthographic camera three.js leaves the logarithm out.
    if (builder.renderer.logarithmicDepthBuffer && !this.camera.isOrthographicCamera) throw new Error(LOGARITHMIC);
    const inputs = { ...this.uniforms, uv: uv(), Depth: texture(this.depth.texture) };
    const use = (code) => wgslFn(code, [this.library]);
    // parameters of a pass that reads these textures; what has fewer gets the last one for the rest, and reads it not
    const reading = (...textures) => {
      const [Color, ColorB = Color, ColorC = ColorB, ColorD = ColorC] = textures.map((map) => texture(map));
      return { ...inputs, Linear: sampler(Color), Color, ColorB, ColorC, ColorD };
    };
    const scene = this.scenePass.getTextureNode();
    const metres = use(METRES)({ ...inputs, depth: this.scenePass.getTextureNode('depth').r });
    const map = cocMap(this.method === 'exact' ? 'SignedCoCMap' : 'CoCMap');
    this.before = [
      [material(metres), this.depth],
      [material(use(map)({ ...inputs, Color: scene })), this.coc],
    ];
    this.debug = [[material(use(DEBUG)(reading(this.coc.texture))), this.result]];
    this.passes = this.method === 'exact' ? this.exact(use, reading) : this.paper(use, reading);

    builder.getNodeProperties(this).scene = scene; // so that the scene is drawn before this node
    return passTexture(this, this.result.texture);
  }

  exact(use, reading) {
    const [targets] = this.targets;
    const T = use(exactFirst(this.sides))(reading(this.coc.texture)).toVar();
    const columns = targets.textures.map((_, i) => T.element(i));
    const second = use(exactSecond(this.sides))(reading(...targets.textures));
    return [
      [material(columns.length > 1 ? outputStruct(...columns) : columns[0]), targets],
      [this.last(second), this.result],
    ];
  }

  paper(use, reading) {
    const [one, finished] = this.targets;
    const [[a, b], [c, d]] = LINES[this.sides];
    const blur = use(LINE);
    const along = (degrees, from) => blur({ ...reading(from.texture), lineAngle: uniform((degrees * Math.PI) / 180) });
    const combined = use(COMBINE)({ ...reading(one.texture, finished.texture), lineBlur: along(d, one) });
    return [
      [material(along(a, this.coc)), one],
      [material(along(b, one)), finished],
      ...(c === a ? [] : [[material(along(c, this.coc)), one]]),
      [this.last(combined), this.result],
    ];
  }

  last(node) {
    return material(this.opaque ? vec4(node.rgb, 1) : node);
  }

  // Draws the passes. three.js calls it once in a frame, after the scene.
  updateBefore({ renderer }) {
    const { width, height } = this.scenePass.renderTarget;
    const { depthKind, cameraNear, cameraFar, imageSize, debugMode } = this.uniforms;
    for (const target of [this.depth, this.coc, this.result, ...this.targets]) target.setSize(width, height);
    // 1 perspective, 2 perspective reversed, 5 orthographic, 6 orthographic reversed; the renderer sets reversedDepth
    depthKind.value = (this.camera.isOrthographicCamera ? 5 : 1) + (this.camera.reversedDepth ? 1 : 0);
    cameraNear.value = this.camera.near;
    cameraFar.value = this.camera.far;
    imageSize.value.set(width, height);

    rendererState = RendererUtils.resetRendererState(renderer, rendererState);
    for (const [drawn, target] of [...this.before, ...(debugMode.value > 0 ? this.debug : this.passes)]) {
      quad.material = drawn;
      renderer.setRenderTarget(target);
      quad.render(renderer);
    }
    RendererUtils.restoreRendererState(renderer, rendererState);
  }

  dispose() {
    for (const target of [this.depth, this.coc, this.result, ...this.targets]) target.dispose();
    for (const [drawn] of [...this.before, ...this.debug, ...this.passes]) drawn.dispose();
    super.dispose();
  }
}
