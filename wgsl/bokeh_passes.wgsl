// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.wgsl, WGSL. Version 0.1.0. Put this file after bokeh.wgsl; the two are one module.
//
//   pass                       reads                                    writes
//   BokehCoCMap_PS             ColorSamp, DepthSamp                     colour, CoC in alpha
//   BokehConstantCoC_PS        ColorSamp                                colour, the same CoC everywhere
//   BokehDepthOfField_PS       ColorSamp, DepthSamp                     one line of the filter
//   BokehDepthOfFieldFinal_PS  ColorSamp, DepthSamp, ColorSampB         the same, min or max with ColorSampB
//   BokehNaiveGather_PS        ColorSamp, DepthSamp, KernelSamp         a table of BOKEH_NUM_SAMPLES offsets
//   BokehNaiveGrid_PS          ColorSamp, DepthSamp                     BOKEH_NUM_SAMPLES x BOKEH_NUM_SAMPLES grid
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
}

@group(0) @binding(0) var<uniform> bokehParameters: BokehParameters;
@group(0) @binding(1) var BokehColorSamp: texture_2d<f32>;
@group(0) @binding(2) var BokehDepthSamp: texture_2d<f32>;
@group(0) @binding(3) var BokehColorSampB: texture_2d<f32>;
@group(0) @binding(4) var BokehKernelSamp: texture_2d<f32>;
@group(0) @binding(5) var BokehLinearClamp: sampler;
@group(0) @binding(6) var BokehNearestClamp: sampler;

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

@fragment fn BokehCoCMap_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehCoCMap(BokehColorSamp, BokehNearestClamp, BokehDepthSamp, BokehNearestClamp, input.uv,
        bokehParameters.BokehApertureDiameter, bokehParameters.BokehFocalLength, bokehParameters.BokehFocusDistance,
        bokehParameters.BokehSensorHeight, bokehParameters.BokehMaxCoC);
}

@fragment fn BokehConstantCoC_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehPackCoC(BokehFetch(BokehColorSamp, BokehNearestClamp, input.uv),
        clamp(bokehParameters.BokehConstantCoC, 0.0, bokehParameters.BokehMaxCoC));
}

@fragment fn BokehDepthOfField_PS(input: BokehVertex) -> @location(0) vec4f
{
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio);
    return BokehDepthOfField(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, lineEnd,
        BOKEH_NUM_SAMPLES, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehDepthOfFieldFinal_PS(input: BokehVertex) -> @location(0) vec4f
{
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio);
    return BokehDepthOfFieldFinal(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv,
        lineEnd, BOKEH_NUM_SAMPLES, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5, BokehColorSampB, BokehLinearClamp, bokehParameters.BokehUseMax > 0.5);
}

@fragment fn BokehNaiveGather_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehNaiveGather(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, BokehKernelSamp,
        BokehNearestClamp, input.uv, bokehParameters.BokehAspectRatio, BOKEH_NUM_SAMPLES,
        bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult, bokehParameters.BokehBlurCoC > 0.5);
}

@fragment fn BokehNaiveGrid_PS(input: BokehVertex) -> @location(0) vec4f
{
    let lineEndU: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio);
    let lineEndV: vec2f = BokehLineEnd(bokehParameters.BokehAngleB, bokehParameters.BokehAspectRatio);
    return BokehNaiveGrid(BokehColorSamp, BokehLinearClamp, BokehDepthSamp, BokehNearestClamp, input.uv, lineEndU,
        lineEndV, BOKEH_NUM_SAMPLES, bokehParameters.BokehBleedingBias, bokehParameters.BokehBleedingMult,
        bokehParameters.BokehBlurCoC > 0.5);
}

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
@fragment fn BokehDebug_PS(input: BokehVertex) -> @location(0) vec4f
{
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
