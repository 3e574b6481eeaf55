// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.wgsl, WGSL. Version 0.2.0.
// Put this file after bokeh.wgsl and bokeh_layers.wgsl; the three are one module.
//
//   pass                        reads                             writes
//   BokehLinearDepth_PS         DepthSamp (any convention)        depth in metres, to R32F
//   BokehCoCMap_PS              ColorSamp, DepthSamp              colour, CoC: paper, naive
//   BokehSignedCoCMap_PS        ColorSamp, DepthSamp              colour, signed CoC: exact
//   BokehConstantCoC_PS         ColorSamp                         colour, the same CoC everywhere
//   BokehDepthOfField_PS        ColorSamp, DepthSamp              one line of the filter
//   BokehDepthOfFieldFinal_PS   ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BokehAdaptive_PS            ColorSamp, DepthSamp              a line of any length and place
//   BokehAdaptiveFinal_PS       ColorSamp, DepthSamp, ColorSampB  the same, min or max with B
//   BokehNaiveGather_PS         ColorSamp, DepthSamp, KernelSamp  a table of offsets
//   BokehNaiveGrid_PS           ColorSamp, DepthSamp              a grid of samples
//   BokehSquareFirst_PS         ColorSamp                         exact, first pass: 1 target
//   BokehSquareSecond_PS        ColorSamp                         exact, second pass: finished
//   BokehHexagonFirst_PS        ColorSamp                         2 targets
//   BokehHexagonSecond_PS       ColorSamp, ColorSampB             the targets in their order
//   BokehOctagonFirst_PS        ColorSamp                         3 targets
//   BokehOctagonSecond_PS       ColorSamp, ColorSampB .. C
//   BokehDecagonFirst_PS        ColorSamp                         4 targets
//   BokehDecagonSecond_PS       ColorSamp, ColorSampB .. D
//   BokehExactEdge_PS           ColorSamp                         one target of the first pass
//   BokehLateralColor_PS        ColorSamp (finished)              red larger, blue smaller
//   BokehDebug_PS               ColorSamp (with CoC), DepthSamp   debug view
//   BokehFullScreen_VS          -                                 one triangle
//
//   Layers, with bokeh_layers.wgsl: its table says what each reads, in the order of the slots; the
//   second pass over a layer has sizes in ColorSampE. BokehLayer: 0 near, 1 far.
//   BokehTileMax_PS             ColorSamp                         largest CoC of 8 x 8 pixels
//   BokehTileDilate_PS          ColorSamp                         twice: BokehAxis 0, 1
//   BokehPrefilter_PS           ColorSamp, ColorSampB             4 targets
//   BokehKernelReduce_PS        ColorSamp, ColorSampB             2 targets
//   BokehKernelRows_PS          ColorSamp, ColorSampB .. C        2 targets
//   BokehKernelColumns_PS       ColorSamp, ColorSampB .. C        2 targets
//   BokehHoleDownsample_PS      ColorSamp, ColorSampB             3 targets
//   BokehHoleFill_PS            ColorSamp, ColorSampB .. D        2 targets
//   BokehSquareLayerFirst_PS    ColorSamp, ColorSampB             1 target, as SquareFirst
//   BokehSquareLayerSecond_PS   ColorSamp, ColorSampE             a layer, finished
//   BokehHexagonLayerFirst_PS   ColorSamp, ColorSampB             2 targets
//   BokehHexagonLayerSecond_PS  ColorSamp, ColorSampB, E
//   BokehOctagonLayerFirst_PS   ColorSamp, ColorSampB             3 targets
//   BokehOctagonLayerSecond_PS  ColorSamp, ColorSampB .. C, E
//   BokehDecagonLayerFirst_PS   ColorSamp, ColorSampB             4 targets
//   BokehDecagonLayerSecond_PS  ColorSamp, ColorSampB .. E
//   BokehComposite_PS           ColorSamp, ColorSampB .. F        the picture
//   BokehPrefilterOne_PS        ColorSamp, ColorSampB             one target of Prefilter
//   BokehKernelReduceOne_PS     ColorSamp, ColorSampB             of KernelReduce
//   BokehKernelRowsOne_PS       ColorSamp, ColorSampB .. C        of KernelRows
//   BokehKernelColumnsOne_PS    ColorSamp, ColorSampB .. C        of KernelColumns
//   BokehHoleDownsampleOne_PS   ColorSamp, ColorSampB             of HoleDownsample
//   BokehHoleFillOne_PS         ColorSamp, ColorSampB .. D        of HoleFill
//   BokehLayerEdge_PS           ColorSamp, ColorSampB             of the first pass over a layer
//
//   Parameters: number i of the struct below is at byte offset 4 i; bind 160 bytes
//   (docs/parameters.md has the table with units, and the struct for C++, C#, Rust and JavaScript).
//   Unused slots: the layout 'auto' has only what a pass reads. With one layout for all passes,
//   bind any texture to the rest; DepthSamp and KernelSamp may be unfilterable-float there.

// -------------------------------------------------------------------------------------------------
// bindings
// -------------------------------------------------------------------------------------------------

// ...One and ...Edge: the target that is written, 0 ..
override BOKEH_TARGET_INDEX: i32 = 0;

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
    BokehDepthKind: f32,
    BokehNear: f32,
    BokehFar: f32,
    BokehViewportX: f32,
    BokehViewportY: f32,
    BokehTextureWidth: f32,
    BokehTextureHeight: f32,
    BokehPassIndex: f32,
    BokehAxis: f32,
    BokehLayer: f32,
    BokehCatsEye: f32,
    BokehRoundness: f32,
    BokehLateral: f32,
    BokehAxialRed: f32,
    BokehAxialBlue: f32,
}

@group(0) @binding(0) var<uniform> bokehParameters: BokehParameters;
@group(0) @binding(1) var BokehColorSamp: texture_2d<f32>;
@group(0) @binding(2) var BokehDepthSamp: texture_2d<f32>;
@group(0) @binding(3) var BokehColorSampB: texture_2d<f32>;
@group(0) @binding(4) var BokehColorSampC: texture_2d<f32>;
@group(0) @binding(5) var BokehColorSampD: texture_2d<f32>;
@group(0) @binding(6) var BokehKernelSamp: texture_2d<f32>;
@group(0) @binding(7) var BokehLinearClamp: sampler;
@group(0) @binding(8) var BokehColorSampE: texture_2d<f32>;
@group(0) @binding(9) var BokehColorSampF: texture_2d<f32>;

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

// BokehSides; a parameter that nobody has set is a hexagon
fn BokehSidesOrSix() -> i32
{
    var sides: i32 = i32(bokehParameters.BokehSides + 0.5);
    if (sides == 0)
    {
        sides = 6;
    }
    return sides;
}

// the aperture; with BOKEH_CHARACTER 1 as the lens shows it at this pixel
fn BokehAperture(uv: vec2f, sides: i32) -> BokehPolygon
{
    var polygon: BokehPolygon = BokehMakePolygon(sides, bokehParameters.BokehAngle,
        bokehParameters.BokehSqueeze);
    if (BOKEH_CHARACTER > 0)
    {
        let imageSize: vec2f = vec2f(bokehParameters.BokehImageWidth,
            bokehParameters.BokehImageHeight);
        polygon.roundness = bokehParameters.BokehRoundness;
        let cut: BokehPolygon = BokehWithCatsEye(polygon, uv, imageSize,
            bokehParameters.BokehCatsEye);
        polygon.lengths = cut.lengths;
        polygon.fifth = cut.fifth;
        polygon.axial = vec2f(bokehParameters.BokehAxialRed, bokehParameters.BokehAxialBlue);
    }
    return polygon;
}

// exact, first pass
fn BokehFirst(uv: vec2f, sides: i32) -> BokehTargets
{
    let settings: BokehFilter = BokehBegin(uv, 0.0);
    let polygon: BokehPolygon = BokehAperture(uv, sides);
    return BokehExactFirst(BokehColorSamp, BokehLinearClamp, uv, polygon, settings);
}

// exact, second pass
fn BokehSecond(Edge2Samp: texture_2d<f32>, Edge2SampSampler: sampler, Edge3Samp: texture_2d<f32>,
    Edge4Samp: texture_2d<f32>, Edge5Samp: texture_2d<f32>, uv: vec2f, sides: i32) -> vec4f
{
    let settings: BokehFilter = BokehBegin(uv, 1.0);
    let polygon: BokehPolygon = BokehAperture(uv, sides);
    return BokehExactSecond(Edge2Samp, Edge2SampSampler, Edge3Samp, Edge4Samp, Edge5Samp, uv,
        polygon, settings);
}

// target BOKEH_TARGET_INDEX of several, where a pass can write only one
fn BokehPickTarget(first: vec4f, second: vec4f, third: vec4f, fourth: vec4f) -> vec4f
{
    var picked: vec4f = first;
    if (BOKEH_TARGET_INDEX == 1)
    {
        picked = second;
    }
    else if (BOKEH_TARGET_INDEX == 2)
    {
        picked = third;
    }
    else if (BOKEH_TARGET_INDEX == 3)
    {
        picked = fourth;
    }
    return picked;
}

// what a pass of the layers begins with: the viewport set, and its settings
//   sides         4, 6, 8 or 10
//   scale         of its target
fn BokehBeginLayers(uv: vec2f, sides: i32, scale: f32, passIndex: f32) -> BokehLayers
{
    BokehUseViewport();
    let imageSize: vec2f = vec2f(bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight);
    let polygon: BokehPolygon = BokehAperture(uv, clamp(sides, 4, 10));
    var layers: BokehLayers = BokehMakeLayers(imageSize, polygon, bokehParameters.BokehMaxCoC);
    layers.full = BokehMakeGrid(vec4f(bokehParameters.BokehViewportX,
        bokehParameters.BokehViewportY, imageSize), vec2f(bokehParameters.BokehTextureWidth,
        bokehParameters.BokehTextureHeight));
    let noise: f32 = BokehNoise(uv, ceil(imageSize / scale), bokehParameters.BokehFrame, passIndex);
    layers.jitter = bokehParameters.BokehJitter * noise * f32(BOKEH_ADAPTIVE_SAMPLES);
    return layers;
}

// the same for a pass without samples of its own
fn BokehBeginTiles(uv: vec2f) -> BokehLayers
{
    return BokehBeginLayers(uv, 6, 1.0, 0.0);
}

// the polygon of a layer, first pass
fn BokehLayerPolygon(uv: vec2f, sides: i32) -> BokehTargets
{
    let layers: BokehLayers = BokehBeginLayers(uv, sides, 2.0, 0.0);
    return BokehLayerFirst(BokehColorSamp, BokehLinearClamp, BokehColorSampB, uv,
        bokehParameters.BokehLayer > 0.5, layers);
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
    return BokehFirst(input.uv, 4).edge2;
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
    return BokehTargets2(targets.edge2, targets.edge3);
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
    return BokehTargets3(targets.edge2, targets.edge3, targets.edge4);
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
    return BokehTargets4(targets.edge2, targets.edge3, targets.edge4, targets.edge5);
}

@fragment fn BokehDecagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, input.uv, 10);
}

@fragment fn BokehExactEdge_PS(input: BokehVertex) -> @location(0) vec4f
{
    let settings: BokehFilter = BokehBegin(input.uv, 0.0);
    let polygon: BokehPolygon = BokehAperture(input.uv, BokehSidesOrSix());
    return BokehExactEdge(BokehColorSamp, BokehLinearClamp, input.uv,
        BOKEH_TARGET_INDEX + 2, polygon, settings);
}

// the last pass
@fragment fn BokehLateralColor_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehLateralColor(BokehColorSamp, BokehLinearClamp, input.uv,
        bokehParameters.BokehLateral);
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

@fragment fn BokehTileMax_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehTileMax(BokehColorSamp, BokehLinearClamp, input.uv, BokehBeginTiles(input.uv));
}

@fragment fn BokehTileDilate_PS(input: BokehVertex) -> @location(0) vec4f
{
    let axis: vec2f = vec2f(1.0 - bokehParameters.BokehAxis, bokehParameters.BokehAxis);
    return BokehTileDilate(BokehColorSamp, BokehLinearClamp, input.uv, axis,
        BokehBeginTiles(input.uv));
}

@fragment fn BokehPrefilter_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehPrefiltered = BokehPrefilter(BokehColorSamp, BokehLinearClamp,
        BokehColorSampB, input.uv, BokehBeginTiles(input.uv));
    return BokehTargets4(targets.nearLayer, targets.farLayer, targets.kernelSums,
        targets.leftovers);
}

@fragment fn BokehKernelReduce_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehKernels = BokehKernelReduce(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        input.uv, BokehBeginTiles(input.uv));
    return BokehTargets2(targets.leftovers, targets.sums);
}

@fragment fn BokehKernelRows_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehKernels = BokehKernelRows(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        BokehColorSampC, input.uv, BokehBeginTiles(input.uv));
    return BokehTargets2(targets.leftovers, targets.sums);
}

@fragment fn BokehKernelColumns_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehSizes = BokehKernelColumns(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        BokehColorSampC, input.uv, BokehBeginTiles(input.uv));
    return BokehTargets2(targets.reach, targets.sizes);
}

@fragment fn BokehHoleDownsample_PS(input: BokehVertex) -> BokehTargets3
{
    let targets: BokehHoles = BokehHoleDownsample(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        input.uv, BokehBeginTiles(input.uv));
    return BokehTargets3(targets.middle, targets.far, targets.shares);
}

@fragment fn BokehHoleFill_PS(input: BokehVertex) -> BokehTargets2
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, BokehSidesOrSix(), 4.0, 0.0);
    let targets: BokehFilled = BokehHoleFill(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        BokehColorSampC, BokehColorSampD, input.uv, layers);
    return BokehTargets2(targets.middle, targets.back);
}

@fragment fn BokehSquareLayerFirst_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehLayerPolygon(input.uv, 4).edge2;
}

@fragment fn BokehSquareLayerSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, 4, 2.0, 1.0);
    return BokehLayerSecond(BokehColorSamp, BokehLinearClamp, BokehColorSamp, BokehColorSamp,
        BokehColorSamp, BokehColorSampE, input.uv, bokehParameters.BokehLayer > 0.5, layers);
}

@fragment fn BokehHexagonLayerFirst_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, 6);
    return BokehTargets2(targets.edge2, targets.edge3);
}

@fragment fn BokehHexagonLayerSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, 6, 2.0, 1.0);
    return BokehLayerSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampB,
        BokehColorSampB, BokehColorSampE, input.uv, bokehParameters.BokehLayer > 0.5, layers);
}

@fragment fn BokehOctagonLayerFirst_PS(input: BokehVertex) -> BokehTargets3
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, 8);
    return BokehTargets3(targets.edge2, targets.edge3, targets.edge4);
}

@fragment fn BokehOctagonLayerSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, 8, 2.0, 1.0);
    return BokehLayerSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampC, BokehColorSampE, input.uv, bokehParameters.BokehLayer > 0.5, layers);
}

@fragment fn BokehDecagonLayerFirst_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, 10);
    return BokehTargets4(targets.edge2, targets.edge3, targets.edge4, targets.edge5);
}

@fragment fn BokehDecagonLayerSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, 10, 2.0, 1.0);
    return BokehLayerSecond(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, input.uv, bokehParameters.BokehLayer > 0.5, layers);
}

@fragment fn BokehComposite_PS(input: BokehVertex) -> @location(0) vec4f
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, BokehSidesOrSix(), 1.0, 2.0);
    return BokehComposite(BokehColorSamp, BokehLinearClamp, BokehColorSampB, BokehColorSampC,
        BokehColorSampD, BokehColorSampE, BokehColorSampF, input.uv, layers);
}

@fragment fn BokehPrefilterOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehPrefiltered = BokehPrefilter(BokehColorSamp, BokehLinearClamp,
        BokehColorSampB, input.uv, BokehBeginTiles(input.uv));
    return BokehPickTarget(targets.nearLayer, targets.farLayer, targets.kernelSums,
        targets.leftovers);
}

@fragment fn BokehKernelReduceOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehKernels = BokehKernelReduce(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        input.uv, BokehBeginTiles(input.uv));
    return BokehPickTarget(targets.leftovers, targets.sums, targets.sums, targets.sums);
}

@fragment fn BokehKernelRowsOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehKernels = BokehKernelRows(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        BokehColorSampC, input.uv, BokehBeginTiles(input.uv));
    return BokehPickTarget(targets.leftovers, targets.sums, targets.sums, targets.sums);
}

@fragment fn BokehKernelColumnsOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehSizes = BokehKernelColumns(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        BokehColorSampC, input.uv, BokehBeginTiles(input.uv));
    return BokehPickTarget(targets.reach, targets.sizes, targets.sizes, targets.sizes);
}

@fragment fn BokehHoleDownsampleOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehHoles = BokehHoleDownsample(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        input.uv, BokehBeginTiles(input.uv));
    return BokehPickTarget(targets.middle, targets.far, targets.shares, targets.shares);
}

@fragment fn BokehHoleFillOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, BokehSidesOrSix(), 4.0, 0.0);
    let targets: BokehFilled = BokehHoleFill(BokehColorSamp, BokehLinearClamp, BokehColorSampB,
        BokehColorSampC, BokehColorSampD, input.uv, layers);
    return BokehPickTarget(targets.middle, targets.back, targets.back, targets.back);
}

@fragment fn BokehLayerEdge_PS(input: BokehVertex) -> @location(0) vec4f
{
    let layers: BokehLayers = BokehBeginLayers(input.uv, BokehSidesOrSix(), 2.0, 0.0);
    return BokehLayerEdge(BokehColorSamp, BokehLinearClamp, BokehColorSampB, input.uv,
        bokehParameters.BokehLayer > 0.5, BOKEH_TARGET_INDEX + 2, layers);
}
