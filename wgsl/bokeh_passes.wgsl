// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.wgsl, WGSL. Version 0.1.0. Put this file after bokeh.wgsl; the two are one module.
//
//   pass                       reads                                    writes
//   BokehLinearDepth_PS        DepthSamp (any convention)               depth in metres, to an R32F target
//   BokehCoCMap_PS             ColorSamp, DepthSamp                     colour, CoC in alpha
//   BokehConstantCoC_PS        ColorSamp                                colour, the same CoC everywhere
//   BokehDepthOfField_PS       ColorSamp, DepthSamp                     one line of the filter
//   BokehDepthOfFieldFinal_PS  ColorSamp, DepthSamp, ColorSampB         the same, min or max with ColorSampB
//   BokehAdaptive_PS           ColorSamp, DepthSamp                     a line of any length and place, adaptive
//   BokehAdaptiveFinal_PS      ColorSamp, DepthSamp, ColorSampB         the same, min or max with ColorSampB
//   BokehNaiveGather_PS        ColorSamp, DepthSamp, KernelSamp         a table of BOKEH_NUM_SAMPLES offsets
//   BokehNaiveGrid_PS          ColorSamp, DepthSamp                     BOKEH_NUM_SAMPLES x BOKEH_NUM_SAMPLES grid
//   BokehSquareFirst_PS        ColorSamp, DepthSamp                     exact, first pass: 1 target
//   BokehSquareSecond_PS       ColorSamp, DepthSamp                     exact, second pass: the finished square
//   BokehHexagonFirst_PS       ColorSamp, DepthSamp                     2 targets
//   BokehHexagonSecond_PS      ColorSamp, DepthSamp, ColorSampB         ColorSamp and so on: the targets in their order
//   BokehOctagonFirst_PS       ColorSamp, DepthSamp                     3 targets
//   BokehOctagonSecond_PS      ColorSamp, DepthSamp, ColorSampB .. C
//   BokehDecagonFirst_PS       ColorSamp, DepthSamp                     4 targets
//   BokehDecagonSecond_PS      ColorSamp, DepthSamp, ColorSampB .. D
//   BokehExactEdge_PS          ColorSamp, DepthSamp, ColorSampB .. C    one target of the first pass, without MRT;
//                                                                       B, C: the target before, the one before that
//   BokehDebug_PS              ColorSamp (with CoC), DepthSamp          debug view
//   BokehFullScreen_VS         -                                        one triangle over the target
//
//   Parameters: number i of the struct below is at byte offset 4 i. docs/inputs.md has the table with units.
//   DepthSamp and KernelSamp may be bound as unfilterable-float and BokehNearestClamp as non-filtering.

// ---------------------------------------------------------------------------------------------------------------------
// bindings
// ---------------------------------------------------------------------------------------------------------------------

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
}

@group(0) @binding(0) var<uniform> bokehParameters: BokehParameters;
@group(0) @binding(1) var BokehColorSamp: texture_2d<f32>;
@group(0) @binding(2) var BokehDepthSamp: texture_2d<f32>;
@group(0) @binding(3) var BokehColorSampB: texture_2d<f32>;
@group(0) @binding(4) var BokehColorSampC: texture_2d<f32>;
@group(0) @binding(5) var BokehColorSampD: texture_2d<f32>;
@group(0) @binding(6) var BokehKernelSamp: texture_2d<f32>;
@group(0) @binding(7) var BokehLinearClamp: sampler;
@group(0) @binding(8) var BokehNearestClamp: sampler;

// ---------------------------------------------------------------------------------------------------------------------
// vertex shader
// ---------------------------------------------------------------------------------------------------------------------

struct BokehVertex
{
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

// Three vertices without a buffer. Clip space has +y up and v = 0 is the first row: v runs against y.
@vertex fn BokehFullScreen_VS(@builtin(vertex_index) id: u32) -> BokehVertex
{
    let uv: vec2f = vec2f(select(0.0, 2.0, id == 1u), select(0.0, 2.0, id == 2u));
    return BokehVertex(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

// ---------------------------------------------------------------------------------------------------------------------
// fragment shaders
// ---------------------------------------------------------------------------------------------------------------------

// what every pass begins with
fn BokehUseViewport()
{
    let viewport: vec4f = vec4f(bokehParameters.BokehViewportX, bokehParameters.BokehViewportY,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight);
    BokehSetViewport(viewport, vec2f(bokehParameters.BokehTextureWidth, bokehParameters.BokehTextureHeight));
}

@fragment fn BokehLinearDepth_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let depth: f32 = BokehFetchNearest(BokehDepthSamp, BokehNearestClamp, input.uv).r;
    let S2: f32 = BokehLinearDepth(depth, bokehParameters.BokehDepthKind, bokehParameters.BokehNear,
        bokehParameters.BokehFar);
    return vec4f(S2, S2, S2, 1.0);
}

@fragment fn BokehCoCMap_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehCoCMap(BokehColorSamp, BokehNearestClamp, BokehDepthSamp, BokehNearestClamp, input.uv,
        bokehParameters.BokehApertureDiameter, bokehParameters.BokehFocalLength, bokehParameters.BokehFocusDistance,
        bokehParameters.BokehSensorHeight, bokehParameters.BokehMaxCoC);
}

@fragment fn BokehConstantCoC_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehPackCoC(BokehFetch(BokehColorSamp, BokehNearestClamp, input.uv),
        clamp(bokehParameters.BokehConstantCoC, 0.0, bokehParameters.BokehMaxCoC));
}

@fragment fn BokehDepthOfField_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio /
        bokehParameters.BokehSqueeze);
    return BokehDepthOfField(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, lineEnd,
        BOKEH_NUM_SAMPLES, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehDepthOfFieldFinal_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio /
        bokehParameters.BokehSqueeze);
    return BokehDepthOfFieldFinal(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv,
        lineEnd, BOKEH_NUM_SAMPLES, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5, BokehColorSampB, BokehLinearClamp, bokehParameters.BokehUseMax > 0.5);
}

@fragment fn BokehAdaptive_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let lineCenter: vec2f = vec2f(bokehParameters.BokehLineCenterX, bokehParameters.BokehLineCenterY);
    let segment: vec4f = BokehSegment(bokehParameters.BokehAngle, bokehParameters.BokehLineLength, lineCenter,
        bokehParameters.BokehSqueeze);
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    return BokehDepthOfFieldAdaptive(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv,
        segment, bokehParameters.BokehAspectRatio, bokehParameters.BokehImageHeight, spacing,
        BOKEH_NUM_SAMPLES, jitter, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehAdaptiveFinal_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let lineCenter: vec2f = vec2f(bokehParameters.BokehLineCenterX, bokehParameters.BokehLineCenterY);
    let segment: vec4f = BokehSegment(bokehParameters.BokehAngle, bokehParameters.BokehLineLength, lineCenter,
        bokehParameters.BokehSqueeze);
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    let a: vec4f = BokehDepthOfFieldAdaptive(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp,
        input.uv, segment, bokehParameters.BokehAspectRatio, bokehParameters.BokehImageHeight,
        spacing, BOKEH_NUM_SAMPLES, jitter, bokehParameters.BokehBleedingBias,
        bokehParameters.BokehBleedingMult, bokehParameters.BokehBlurCoC > 0.5);
    return BokehCombine(a, BokehFetch(BokehColorSampB, BokehLinearClamp, input.uv), bokehParameters.BokehUseMax > 0.5);
}

@fragment fn BokehNaiveGather_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehNaiveGather(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, BokehKernelSamp,
        BokehNearestClamp, input.uv, bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze,
        BOKEH_NUM_SAMPLES, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehNaiveGrid_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let lineEndU: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio /
        bokehParameters.BokehSqueeze);
    let lineEndV: vec2f = BokehLineEnd(bokehParameters.BokehAngleB, bokehParameters.BokehAspectRatio /
        bokehParameters.BokehSqueeze);
    return BokehNaiveGrid(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, lineEndU,
        lineEndV, BOKEH_NUM_SAMPLES, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehSquareFirst_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    let T: mat4x4f = BokehExactFirst(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, 4.0,
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
    return T[0];
}

@fragment fn BokehSquareSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    return BokehExactSecond(BokehColorSamp, BokehLinearClamp, BokehColorSamp, BokehLinearClamp, BokehColorSamp,
        BokehLinearClamp, BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, 4.0,
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
}

struct BokehTargets2
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
}

@fragment fn BokehHexagonFirst_PS(input: BokehVertex) -> BokehTargets2
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    let T: mat4x4f = BokehExactFirst(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, 6.0,
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
    return BokehTargets2(T[0], T[1]);
}

@fragment fn BokehHexagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    return BokehExactSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehLinearClamp, BokehColorSampB,
        BokehLinearClamp, BokehColorSampB, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, 6.0,
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
}

struct BokehTargets3
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
    @location(2) target2: vec4f,
}

@fragment fn BokehOctagonFirst_PS(input: BokehVertex) -> BokehTargets3
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    let T: mat4x4f = BokehExactFirst(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, 8.0,
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
    return BokehTargets3(T[0], T[1], T[2]);
}

@fragment fn BokehOctagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    return BokehExactSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehLinearClamp, BokehColorSampC,
        BokehLinearClamp, BokehColorSampC, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, 8.0,
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
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
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    let T: mat4x4f = BokehExactFirst(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv,
        10.0, bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
    return BokehTargets4(T[0], T[1], T[2], T[3]);
}

@fragment fn BokehDecagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    return BokehExactSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehLinearClamp, BokehColorSampC,
        BokehLinearClamp, BokehColorSampD, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, 10.0,
        bokehParameters.BokehAngle, bokehParameters.BokehSqueeze, bokehParameters.BokehAspectRatio,
        bokehParameters.BokehImageHeight, spacing, BOKEH_NUM_SAMPLES, jitter,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
}

@fragment fn BokehExactEdge_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let spacing: f32 = bokehParameters.BokehSpacing * BOKEH_ADAPTIVE_SAMPLES;
    let jitter: f32 = bokehParameters.BokehJitter * BOKEH_ADAPTIVE_SAMPLES * BokehNoise(input.uv,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight, bokehParameters.BokehFrame);
    return BokehExactEdge(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, BokehColorSampB,
        BokehLinearClamp, BokehColorSampC, BokehLinearClamp, input.uv, bokehParameters.BokehEdge,
        bokehParameters.BokehSides, bokehParameters.BokehAngle, bokehParameters.BokehSqueeze,
        bokehParameters.BokehAspectRatio, bokehParameters.BokehImageHeight, spacing,
        BOKEH_NUM_SAMPLES, jitter, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult);
}

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
@fragment fn BokehDebug_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    var result: vec4f = BokehFetch(BokehColorSamp, BokehLinearClamp, input.uv);
    let S2: f32 = BokehSafeDepth(BokehFetchNearest(BokehDepthSamp, BokehNearestClamp, input.uv).r);
    if (bokehParameters.BokehDebugMode > 2.5)
    {
        result = BokehDebugFocus(S2, bokehParameters.BokehFocusDistance, result.a, bokehParameters.BokehMaxCoC);
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
