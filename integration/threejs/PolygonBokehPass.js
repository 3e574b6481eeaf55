// SPDX-License-Identifier: MIT
//
// Polygonal bokeh for three.js with WebGLRenderer: a Pass for EffectComposer, made of the functions of bokeh.glsl.
// It stands directly after the RenderPass, before bloom and before OutputPass.

import { FloatType, GLSL3, HalfFloatType, NearestFilter, NoBlending, RedFormat } from 'three';
import { ShaderMaterial, Vector2, WebGLRenderTarget } from 'three';
import { FullScreenQuad, Pass } from 'three/addons/postprocessing/Pass.js';

// Angles of the lines in degrees: each pair is a parallelogram, and min of the two is the polygon (docs/apertures.md).
const LINES = {
  6: [[90, 30], [90, 150]],
  8: [[0, 90], [45, 135]],
};

const VERTEX = `
out vec2 bokehUv;
void main()
{
    bokehUv = uv;
    gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const INPUTS = `
uniform sampler2D ColorSamp, ColorSampB, ColorSampC, ColorSampD, DepthSamp;
uniform float apertureDiameter, focalLength, focusDistance, sensorHeight, maxCoC, rotation, squeeze, spacing;
uniform float cameraNear, cameraFar, lineAngle;
uniform vec2 imageSize;
uniform int depthKind, debugMode;
in vec2 bokehUv;

BokehFilter filterSettings()
{
    BokehFilter settings = BokehDefaultFilter(imageSize);
    settings.spacing = spacing;
    return settings;
}
`;

// Depth in metres, for the map of the circle of confusion; the paper's lines and the debug views read it too
const METRES = `
out float metres;
void main()
{
    metres = BokehLinearDepth(BokehFetchNearest(DepthSamp, bokehUv).r, depthKind, cameraNear, cameraFar);
}`;

// 'SignedCoCMap' for exact, whose passes read no depth; 'CoCMap' for paper
const cocMap = (name) => `
out vec4 result;
void main()
{
    result = Bokeh${name}(ColorSamp, DepthSamp, bokehUv, apertureDiameter, focalLength, focusDistance, sensorHeight,
        maxCoC);
}`;

// As many targets as there are edges less one: T2, T3 for the hexagon
const exactFirst = (sides, names = ['T2', 'T3', 'T4', 'T5'].slice(0, sides / 2 - 1)) => `
${names.map((name, i) => `layout(location = ${i}) out vec4 ${name};`).join('\n')}
void main()
{
    BokehPolygon polygon = BokehMakePolygon(${sides}, rotation, squeeze);
    BokehTargets targets = BokehExactFirst(ColorSamp, bokehUv, polygon, filterSettings());
    ${names.map((name) => `${name} = targets.${name};`).join('\n    ')}
}`;

const exactSecond = (sides, opaque) => `
out vec4 result;
void main()
{
    BokehPolygon polygon = BokehMakePolygon(${sides}, rotation, squeeze);
    result = BokehExactSecond(ColorSamp, ColorSampB, ColorSampC, ColorSampD, bokehUv, polygon, filterSettings());
    ${opaque ? 'result.a = 1.0;' : ''}
}`;

// One line of the paper's method; the last one is combined with the parallelogram that is finished
const line = (last, opaque) => `
out vec4 result;
void main()
{
    vec4 segment = BokehSegment(lineAngle + rotation, 1.0, vec2(0.0, 0.0), squeeze);
    result = BokehDepthOfFieldAdaptive(ColorSamp, DepthSamp, bokehUv, segment, filterSettings(), true);
    ${last ? 'result = BokehCombine(result, BokehFetch(ColorSampB, bokehUv), false);' : ''}
    ${opaque ? 'result.a = 1.0;' : ''}
}`;

const DEBUG = `
out vec4 result;
void main()
{
    float CoC = BokehFetch(ColorSamp, bokehUv).a;
    float S2 = BokehFetchNearest(DepthSamp, bokehUv).r;
    result = BokehDebugDepth(S2, focusDistance);
    if (debugMode == 2) { result = BokehDebugCoC(CoC, maxCoC); }
    if (debugMode == 3) { result = BokehDebugFocus(S2, focusDistance, CoC, maxCoC); }
}`;

export class PolygonBokehPass extends Pass {
  // library  the text of bokeh.glsl
  // camera   the camera that the scene is drawn with
  // method   'exact': two passes, light adds up; 'paper': lines and min, a target less
  // sides    6 or 8; exact has 4 and 10 as well
  // samples  at most so many on an edge or a line
  // opaque   false: alpha is the circle of confusion in the end too, signed for exact. A canvas would take it for
  //          transparency.
  constructor(library, camera, { method = 'exact', sides = 6, samples = 33, opaque = true } = {}) {
    super();
    this.camera = camera;
    this.method = method;
    this.sides = sides;

    // To be set from outside. Metres, but for maxCoC (fraction of the image height), rotation (radians) and spacing
    // (pixels between samples). debugMode: 0 off, 1 depth, 2 circle of confusion, 3 near and far field.
    this.uniforms = {
      apertureDiameter: { value: 0.05 },
      focalLength: { value: 0.05 },
      focusDistance: { value: 5 },
      sensorHeight: { value: 0.024 },
      maxCoC: { value: 0.1 },
      rotation: { value: 0 },
      squeeze: { value: 1 },
      spacing: { value: 1 },
      debugMode: { value: 0 },
      depthKind: { value: 1 },
      cameraNear: { value: 0 },
      cameraFar: { value: 0 },
      imageSize: { value: new Vector2(1, 1) },
      lineAngle: { value: 0 },
    };
    for (const name of ['ColorSamp', 'ColorSampB', 'ColorSampC', 'ColorSampD', 'DepthSamp']) {
      this.uniforms[name] = { value: null };
    }

    const material = (main) =>
      new ShaderMaterial({
        glslVersion: GLSL3,
        defines: { BOKEH_NUM_SAMPLES: samples },
        uniforms: this.uniforms, // the same ones in every pass
        vertexShader: VERTEX,
        fragmentShader: library + INPUTS + main,
        blending: NoBlending, // alpha is the circle of confusion
        depthTest: false,
        depthWrite: false,
      });
    this.materials = { metres: material(METRES), debug: material(DEBUG) };
    this.materials.cocMap = material(cocMap(method === 'exact' ? 'SignedCoCMap' : 'CoCMap'));
    if (method === 'exact') {
      this.materials.first = material(exactFirst(sides));
      this.materials.second = material(exactSecond(sides, opaque));
    } else {
      this.materials.line = material(line(false, false));
      this.materials.lastLine = material(line(true, opaque));
    }

    const half = { type: HalfFloatType, depthBuffer: false };
    // WebGL without extensions reads no 32-bit float texture that has another filter, not even texel by texel
    const nearest = { minFilter: NearestFilter, magFilter: NearestFilter };
    this.depth = new WebGLRenderTarget(1, 1, { type: FloatType, format: RedFormat, depthBuffer: false, ...nearest });
    this.coc = new WebGLRenderTarget(1, 1, half);
    this.targets =
      method === 'exact'
        ? [new WebGLRenderTarget(1, 1, { ...half, count: sides / 2 - 1 })]
        : [new WebGLRenderTarget(1, 1, half), new WebGLRenderTarget(1, 1, half)];
    this.quad = new FullScreenQuad();
  }

  // Focus on a place in the world: focusDistance is the depth along the view axis, not the length of the ray.
  focusOn(point) {
    this.uniforms.focusDistance.value = -this.camera.worldToLocal(point.clone()).z;
  }

  setSize(width, height) {
    for (const target of [this.depth, this.coc, ...this.targets]) target.setSize(width, height);
    this.uniforms.imageSize.value.set(width, height);
  }

  render(renderer, writeBuffer, readBuffer) {
    const { cocMap, debug, metres } = this.materials;
    const output = this.renderToScreen ? null : writeBuffer;
    this.uniforms.depthKind.value = this.depthKind(renderer);
    this.uniforms.cameraNear.value = this.camera.near;
    this.uniforms.cameraFar.value = this.camera.far;
    this.uniforms.DepthSamp.value = readBuffer.depthTexture;
    this.draw(renderer, metres, this.depth);
    this.uniforms.DepthSamp.value = this.depth.texture;
    this.draw(renderer, cocMap, this.coc, readBuffer.texture);
    if (this.uniforms.debugMode.value > 0) this.draw(renderer, debug, output, this.coc.texture);
    else if (this.method === 'exact') this.drawExact(renderer, output);
    else this.drawPaper(renderer, output);
  }

  // What the depth texture holds, as BokehLinearDepth counts. three.js itself leaves the logarithm of 1 + metres out
  // for an orthographic camera and for a reversed buffer; it sets reversedDepth.
  depthKind(renderer) {
    const { isOrthographicCamera, reversedDepth } = this.camera;
    if (isOrthographicCamera) return reversedDepth ? 6 : 5;
    if (renderer.capabilities.logarithmicDepthBuffer) return 8;
    return reversedDepth ? 2 : 1;
  }

  drawExact(renderer, output) {
    const { first, second } = this.materials;
    const [targets] = this.targets;
    this.draw(renderer, first, targets, this.coc.texture);
    this.draw(renderer, second, output, ...targets.textures);
  }

  drawPaper(renderer, output) {
    const { line, lastLine } = this.materials;
    const [one, finished] = this.targets;
    const [[a, b], [c, d]] = LINES[this.sides].map((pair) => pair.map((angle) => (angle * Math.PI) / 180));
    this.drawLine(renderer, line, a, one, this.coc.texture);
    this.drawLine(renderer, line, b, finished, one.texture);
    if (c !== a) this.drawLine(renderer, line, c, one, this.coc.texture);
    this.drawLine(renderer, lastLine, d, output, one.texture, finished.texture);
  }

  drawLine(renderer, material, angle, target, ...colors) {
    this.uniforms.lineAngle.value = angle;
    this.draw(renderer, material, target, ...colors);
  }

  // Where a pass reads fewer textures than there are uniforms, the rest gets the last one: it is not read.
  draw(renderer, material, target, ...colors) {
    ['ColorSamp', 'ColorSampB', 'ColorSampC', 'ColorSampD'].forEach((name, i) => {
      this.uniforms[name].value = colors[Math.min(i, colors.length - 1)] ?? null;
    });
    this.quad.material = material;
    renderer.setRenderTarget(target);
    this.quad.render(renderer);
  }

  dispose() {
    for (const target of [this.depth, this.coc, ...this.targets]) target.dispose();
    for (const material of Object.values(this.materials)) material.dispose();
    this.quad.dispose();
  }
}
