// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.wgsl, WGSL. Version 0.2.0.
// Put this file after bokeh.wgsl; the two are one module.
//
//   pass                       reads                             writes
//   BokehLinearDepth_PS        DepthSamp (any convention)        depth in metres, to R32F
//   BokehCoCMap_PS             ColorSamp, DepthSamp              colour, CoC: paper, naive
//   BokehSignedCoCMap_PS       ColorSamp, DepthSamp              colour, signed CoC: exact
//   BokehConstantCoC_PS        ColorSamp                         colour, the same CoC everywhere
//   BokehDepthOfField_PS       ColorSamp, DepthSamp              one line of the filter
//   BokehDepthOfFieldFinal_PS  ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BokehAdaptive_PS           ColorSamp, DepthSamp              a line of any length and place
//   BokehAdaptiveFinal_PS      ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BokehNaiveGather_PS        ColorSamp, DepthSamp, KernelSamp  a table of offsets
//   BokehNaiveGrid_PS          ColorSamp, DepthSamp              a grid of samples
//   BokehSquareFirst_PS        ColorSamp                         exact, first pass: 1 target
//   BokehSquareSecond_PS       ColorSamp                         exact, second pass: finished
//   BokehHexagonFirst_PS       ColorSamp                         2 targets
//   BokehHexagonSecond_PS      ColorSamp, ColorSampB             the targets in their order
//   BokehOctagonFirst_PS       ColorSamp                         3 targets
//   BokehOctagonSecond_PS      ColorSamp, ColorSampB .. C
//   BokehDecagonFirst_PS       ColorSamp                         4 targets
//   BokehDecagonSecond_PS      ColorSamp, ColorSampB .. D
//   BokehExactEdge_PS          ColorSamp                         target T(BokehEdge)
//   BokehDebug_PS              ColorSamp (with CoC), DepthSamp   debug view
//   BokehFullScreen_VS         -                                 one triangle
//
//   Parameters: number i of the struct below is at byte offset 4 i; bind 144 bytes (docs/inputs.md
//   has the table with units, and the struct for C++, C#, Rust and JavaScript).
//   Unused slots: the layout 'auto' has only what a pass reads. With one layout for all passes,
//   bind any texture to the rest; DepthSamp and KernelSamp may be unfilterable-float there.

// -------------------------------------------------------------------------------------------------
// bindings
// -------------------------------------------------------------------------------------------------

struct BokehParameters
{
    BokehApertureDiameter: f32,
    BokehFocalLength: f32,
    BokehFocusDistance: f32,
    BokehSensorHeight: f32,
    BokehMaxCoC: f32,
    BokehConstantCoC: f32,
    BokehAspectRatio: f32,
    BokehAngle: f32,
    BokehAngleB: f32,
    BokehBleedingBias: f32,
    BokehBleedingMult: f32,
    BokehBlurCoC: f32,
    BokehUseMax: f32,
    BokehDebugMode: f32,
    BokehLineLength: f32,
    BokehLineCenterX: f32,
    BokehLineCenterY: f32,
    BokehSqueeze: f32,
    BokehSpacing: f32,
    BokehImageWidth: f32,
    BokehImageHeight: f32,
    BokehJitter: f32,
    BokehFrame: f32,
    BokehSides: f32,
    BokehEdge: f32,
    BokehDepthKind: f32,
    BokehNear: f32,
    BokehFar: f32,
    BokehViewportX: f32,
    BokehViewportY: f32,
    BokehTextureWidth: f32,
    BokehTextureHeight: f32,
    BokehPassIndex: f32,
}

@group(0) @binding(0) var<uniform> bokehParameters: BokehParameters;
@group(0) @binding(1) var BokehColorSamp: texture_2d<f32>;
@group(0) @binding(2) var BokehDepthSamp: texture_2d<f32>;
@group(0) @binding(3) var BokehColorSampB: texture_2d<f32>;
@group(0) @binding(4) var BokehColorSampC: texture_2d<f32>;
@group(0) @binding(5) var BokehColorSampD: texture_2d<f32>;
@group(0) @binding(6) var BokehKernelSamp: texture_2d<f32>;
@group(0) @binding(7) var BokehLinearClamp: sampler;

// -------------------------------------------------------------------------------------------------
// vertex shader
// -------------------------------------------------------------------------------------------------

struct BokehVertex
{
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

// Three vertices without a buffer. Clip space has +y up and v = 0 is the first row: v runs against
// y.
@vertex fn BokehFullScreen_VS(@builtin(vertex_index) id: u32) -> BokehVertex
{
    let uv: vec2f = vec2f(select(0.0, 2.0, id == 1u), select(0.0, 2.0, id == 2u));
    return BokehVertex(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

// -------------------------------------------------------------------------------------------------
// fragment shaders
// -------------------------------------------------------------------------------------------------

// what a pass without a filter begins with
fn BokehUseViewport()
{
    let viewport: vec4f = vec4f(bokehParameters.BokehViewportX, bokehParameters.BokehViewportY,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight);
    BokehSetViewport(viewport, vec2f(bokehParameters.BokehTextureWidth,
        bokehParameters.BokehTextureHeight));
}

// what a filter pass begins with: the viewport set, and its settings; passIndex as in BokehNoise
fn BokehBegin(uv: vec2f, passIndex: f32) -> BokehFilter
{
    BokehUseViewport();
    let imageSize: vec2f = vec2f(bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight);
    let noise: f32 = BokehNoise(uv, imageSize, bokehParameters.BokehFrame, passIndex);
    var settings: BokehFilter;
    settings.aspectRatio = bokehParameters.BokehAspectRatio;
    settings.imageHeight = bokehParameters.BokehImageHeight;
    settings.spacing = bokehParameters.BokehSpacing;
    settings.jitter = bokehParameters.BokehJitter * noise * f32(BOKEH_ADAPTIVE_SAMPLES);
    settings.bleedingBias = bokehParameters.BokehBleedingBias;
    settings.bleedingMult = bokehParameters.BokehBleedingMult;
    return settings;
}

// one line of the filter, adaptive
fn BokehAdaptiveLine(uv: vec2f) -> vec4f
{
    let settings: BokehFilter = BokehBegin(uv, bokehParameters.BokehPassIndex);
    let lineCenter: vec2f = vec2f(bokehParameters.BokehLineCenterX,
        bokehParameters.BokehLineCenterY);
    let segment: vec4f = BokehSegment(bokehParameters.BokehAngle, bokehParameters.BokehLineLength,
        lineCenter, bokehParameters.BokehSqueeze);
    return BokehDepthOfFieldAdaptive(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, uv, segment,
        settings, bokehParameters.BokehBlurCoC > 0.5);
}

// exact, first pass
fn BokehFirst(uv: vec2f, sides: i32) -> BokehTargets
{
    let settings: BokehFilter = BokehBegin(uv, 0.0);
    let polygon: BokehPolygon = BokehMakePolygon(sides, bokehParameters.BokehAngle,
        bokehParameters.BokehSqueeze);
    return BokehExactFirst(BokehColorSamp, BokehLinearClamp, uv, polygon, settings);
}

// exact, second pass
fn BokehSecond(T2Samp: texture_2d<f32>, T2SampSampler: sampler, T3Samp: texture_2d<f32>,
    T4Samp: texture_2d<f32>, T5Samp: texture_2d<f32>, uv: vec2f, sides: i32) -> vec4f
{
    let settings: BokehFilter = BokehBegin(uv, 1.0);
    let polygon: BokehPolygon = BokehMakePolygon(sides, bokehParameters.BokehAngle,
        bokehParameters.BokehSqueeze);
    return BokehExactSecond(T2Samp, T2SampSampler, T3Samp, T4Samp, T5Samp, uv, polygon, settings);
}

@fragment fn BokehLinearDepth_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let depth: f32 = BokehFetchNearest(BokehDepthSamp, input.uv).r;
    let S2: f32 = BokehLinearDepth(depth, i32(bokehParameters.BokehDepthKind + 0.5),
        bokehParameters.BokehNear, bokehParameters.BokehFar);
    return vec4f(S2, S2, S2, 1.0);
}

@fragment fn BokehCoCMap_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehCoCMap(BokehColorSamp, BokehDepthSamp, input.uv,
        bokehParameters.BokehApertureDiameter, bokehParameters.BokehFocalLength,
        bokehParameters.BokehFocusDistance, bokehParameters.BokehSensorHeight,
        bokehParameters.BokehMaxCoC);
}

@fragment fn BokehSignedCoCMap_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehSignedCoCMap(BokehColorSamp, BokehDepthSamp, input.uv,
        bokehParameters.BokehApertureDiameter, bokehParameters.BokehFocalLength,
        bokehParameters.BokehFocusDistance, bokehParameters.BokehSensorHeight,
        bokehParameters.BokehMaxCoC);
}

@fragment fn BokehConstantCoC_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let color: vec4f = BokehFetchNearest(BokehColorSamp, input.uv);
    return BokehPackCoC(color, clamp(bokehParameters.BokehConstantCoC, 0.0,
        bokehParameters.BokehMaxCoC));
}

@fragment fn BokehDepthOfField_PS(input: BokehVertex) -> @location(0) vec4f
{
    let settings: BokehFilter = BokehBegin(input.uv, 0.0);
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle,
        bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze);
    return BokehDepthOfField(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, input.uv, lineEnd,
        settings, bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehDepthOfFieldFinal_PS(input: BokehVertex) -> @location(0) vec4f
{
    let settings: BokehFilter = BokehBegin(input.uv, 0.0);
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle,
        bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze);
    return BokehDepthOfFieldFinal(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehColorSampB,
        input.uv, lineEnd, settings, bokehParameters.BokehBlurCoC > 0.5,
        bokehParameters.BokehUseMax > 0.5);
}

@fragment fn BokehAdaptive_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehAdaptiveLine(input.uv);
}

@fragment fn BokehAdaptiveFinal_PS(input: BokehVertex) -> @location(0) vec4f
{
    let a: vec4f = BokehAdaptiveLine(input.uv);
    return BokehCombine(a, BokehFetch(BokehColorSampB, BokehLinearClamp, input.uv),
        bokehParameters.BokehUseMax > 0.5);
}

@fragment fn BokehNaiveGather_PS(input: BokehVertex) -> @location(0) vec4f
{
    var settings: BokehFilter = BokehBegin(input.uv, 0.0);
    settings.aspectRatio = bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze;
    return BokehNaiveGather(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehKernelSamp,
        input.uv, settings, bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehNaiveGrid_PS(input: BokehVertex) -> @location(0) vec4f
{
    let settings: BokehFilter = BokehBegin(input.uv, 0.0);
    let lineEndU: vec2f = BokehLineEnd(bokehParameters.BokehAngle,
        bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze);
    let lineEndV: vec2f = BokehLineEnd(bokehParameters.BokehAngleB,
        bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze);
    return BokehNaiveGrid(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, input.uv, lineEndU,
        lineEndV, settings, bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehSquareFirst_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehFirst(input.uv, 4).T2;
}

@fragment fn BokehSquareSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehSecond(BokehColorSamp, BokehLinearClamp, BokehColorSamp, BokehColorSamp,
        BokehColorSamp, input.uv, 4);
}

struct BokehTargets2
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
}

@fragment fn BokehHexagonFirst_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehTargets = BokehFirst(input.uv, 6);
    return BokehTargets2(targets.T2, targets.T3);
}

@fragment fn BokehHexagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampB,
        BokehColorSampB, input.uv, 6);
}

struct BokehTargets3
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
    @location(2) target2: vec4f,
}

@fragment fn BokehOctagonFirst_PS(input: BokehVertex) -> BokehTargets3
{
    let targets: BokehTargets = BokehFirst(input.uv, 8);
    return BokehTargets3(targets.T2, targets.T3, targets.T4);
}

@fragment fn BokehOctagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampC, input.uv, 8);
}

struct BokehTargets4
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
    @location(2) target2: vec4f,
    @location(3) target3: vec4f,
}

@fragment fn BokehDecagonFirst_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehTargets = BokehFirst(input.uv, 10);
    return BokehTargets4(targets.T2, targets.T3, targets.T4, targets.T5);
}

@fragment fn BokehDecagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, input.uv, 10);
}

@fragment fn BokehExactEdge_PS(input: BokehVertex) -> @location(0) vec4f
{
    let settings: BokehFilter = BokehBegin(input.uv, 0.0);
    let polygon: BokehPolygon = BokehMakePolygon(i32(bokehParameters.BokehSides + 0.5),
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze);
    return BokehExactEdge(BokehColorSamp, BokehLinearClamp, input.uv,
        i32(bokehParameters.BokehEdge + 0.5), polygon, settings);
}

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
@fragment fn BokehDebug_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    var result: vec4f = BokehFetch(BokehColorSamp, BokehLinearClamp, input.uv);
    let S2: f32 = BokehSafeDepth(BokehFetchNearest(BokehDepthSamp, input.uv).r);
    if (bokehParameters.BokehDebugMode > 2.5)
    {
        result = BokehDebugFocus(S2, bokehParameters.BokehFocusDistance, result.a,
            bokehParameters.BokehMaxCoC);
    }
    else if (bokehParameters.BokehDebugMode > 1.5)
    {
        result = BokehDebugCoC(result.a, bokehParameters.BokehMaxCoC);
    }
    else if (bokehParameters.BokehDebugMode > 0.5)
    {
        result = BokehDebugDepth(S2, bokehParameters.BokehFocusDistance);
    }
    return result;
}
