// SPDX-License-Identifier: MIT
//
// Ready-made passes, WGSL. Version 0.3.0.
// A module is bokeh.wgsl, bokeh_paper.wgsl, bokeh_layers.wgsl, bokeh_lens.wgsl and this file.
//
//   pass                        reads                             writes
//   BokehLinearDepth_PS         DepthSamp                         depth in metres, to R32F
//   BokehSignedCoCMap_PS        ColorSamp, DepthSamp              colour, signed CoC
//   BokehConstantCoC_PS         ColorSamp                         colour, one CoC for all pixels
//   BokehSquareFirst_PS         ColorSamp                         1 target
//   BokehSquareSecond_PS        ColorSamp                         the result, from that target
//   BokehHexagonFirst_PS        ColorSamp                         2 targets
//   BokehHexagonSecond_PS       ColorSamp, ColorSampB             the result, from those
//   BokehOctagonFirst_PS        ColorSamp                         3 targets
//   BokehOctagonSecond_PS       ColorSamp, ColorSampB .. C        the result
//   BokehDecagonFirst_PS        ColorSamp                         4 targets
//   BokehDecagonSecond_PS       ColorSamp, ColorSampB .. D        the result
//   BokehExactEdge_PS           ColorSamp                         one target of these first passes
//   BokehDebug_PS               ColorSamp (with CoC), DepthSamp   debug view
//   BokehFullScreen_VS          -                                 one triangle
//
//   With bokeh_paper; DepthSamp has metres:
//   BokehCoCMap_PS              ColorSamp, DepthSamp              colour, CoC
//   BokehDepthOfField_PS        ColorSamp, DepthSamp              blur along a line
//   BokehDepthOfFieldFinal_PS   ColorSamp, DepthSamp, ColorSampB  ... then min or max with B
//   BokehAdaptive_PS            ColorSamp, DepthSamp              blur along any line
//   BokehAdaptiveFinal_PS       ColorSamp, DepthSamp, ColorSampB  ... then min or max with B
//   BokehNaiveGather_PS         ColorSamp, DepthSamp, KernelSamp  gather, from a table
//   BokehNaiveGrid_PS           ColorSamp, DepthSamp              gather, over a grid
//
//   With bokeh_lens. BOKEH_LENS_SHAPE 1 also gives apertures curved blades and a cat's eye:
//   BokehStableMap_PS           ColorSamp (map), ColorSampB .. C  steadier; B: history, C: velocity
//   BokehLateralColor_PS        ColorSamp (finished)              lateral colour
//
//   With bokeh_layers: the table of that file lists what each pass reads, in the order of the
//   slots, and what it writes. In addition:
//   * Square and hexagon blur both layers at once. Their first pass reads nearLayer, nearQuarter,
//     farLayer, farQuarter, layerCoC, and writes strip 2 of near and far, then strip 3 of both.
//   * Octagon and decagon have passes of their own for each layer, such as OctagonNearFirst.
//   * Second passes read layerCoC from ColorSampE.
//   * TileDilate has two passes, TileDilateRows, then TileDilateColumns.
//   * A pass whose name ends in One or Edge writes only target BOKEH_TARGET_INDEX.
//
//   Parameters: number i of the struct below is at byte offset 4 i; bind 192 bytes
//   (docs/reference/parameters.md has units, and the struct for C++, C#, Rust and JavaScript).
//   Unused slots: the layout 'auto' has only what a pass reads. With one layout for all passes,
//   bind any texture to the rest; DepthSamp and KernelSamp may be unfilterable-float there.

// -------------------------------------------------------------------------------------------------
// bindings

// the target that ..One and ..Edge write, 0 ..; whether BokehJitter acts, the aperture
// has the shape of a lens, the CoC map takes all parameters
override BOKEH_TARGET_INDEX: i32 = 0;
override BOKEH_JITTER: i32 = 0;
override BOKEH_LENS_SHAPE: i32 = 0;
override BOKEH_FOCUS_CONTROLS: i32 = 0;

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
    BokehCatsEye: f32,
    BokehRoundness: f32,
    BokehLateral: f32,
    BokehFrontRange: f32,
    BokehBackRange: f32,
    BokehNearScale: f32,
    BokehFarScale: f32,
    BokehNearMaxCoC: f32,
    BokehFarMaxCoC: f32,
    BokehDepthX: f32,
    BokehDepthY: f32,
    BokehDepthWidth: f32,
    BokehDepthHeight: f32,
    BokehStableBlend: f32,
}

@group(0) @binding(0) var<uniform> bokehParameters: BokehParameters;
@group(0) @binding(1) var BokehColorSamp: texture_2d<f32>;
@group(0) @binding(2) var BokehDepthSamp: BokehDepthTexture;
@group(0) @binding(3) var BokehColorSampB: texture_2d<f32>;
@group(0) @binding(4) var BokehColorSampC: texture_2d<f32>;
@group(0) @binding(5) var BokehColorSampD: texture_2d<f32>;
@group(0) @binding(6) var BokehKernelSamp: texture_2d<f32>;
@group(0) @binding(7) var BokehLinearClamp: sampler;
@group(0) @binding(8) var BokehColorSampE: texture_2d<f32>;
@group(0) @binding(9) var BokehColorSampF: texture_2d<f32>;

struct BokehTargets2
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
}

struct BokehTargets3
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
    @location(2) target2: vec4f,
}

struct BokehTargets4
{
    @location(0) target0: vec4f,
    @location(1) target1: vec4f,
    @location(2) target2: vec4f,
    @location(3) target3: vec4f,
}

// -------------------------------------------------------------------------------------------------
// vertex shader

struct BokehVertex
{
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

// draws a triangle over the whole target: three vertices, without a buffer
//   Clip space has +y up and v = 0 is the first row: v runs against y.
@vertex fn BokehFullScreen_VS(@builtin(vertex_index) id: u32) -> BokehVertex
{
    let uv: vec2f = vec2f(select(0.0, 2.0, id == 1u), select(0.0, 2.0, id == 2u));
    return BokehVertex(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

// -------------------------------------------------------------------------------------------------
// fragment shaders

// sets the viewport, for passes without a filter
fn BokehUseViewport()
{
    let viewport: vec4f = vec4f(bokehParameters.BokehViewportX, bokehParameters.BokehViewportY,
        bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight);
    BokehSetViewport(viewport, vec2f(bokehParameters.BokehTextureWidth,
        bokehParameters.BokehTextureHeight));
}

// returns interleaved gradient noise (Jimenez 2014) for a pixel, frame and pass, -0.5 .. 0.5
//   In pass p each frame adds (8 p + 1) 33 / 64. Over 64 frames every pass takes 64 evenly spaced
//   values in each pixel, no two passes in the same order, so the mean of the frames converges.
//   passIndex     0, 1 ..; a pass needs another index than the pass that it reads
fn BokehNoise(uv: vec2f, imageSize: vec2f, frame: f32, passIndex: f32) -> f32
{
    let number: f32 = (8.0 * passIndex + 1.0) * (frame - 64.0 * floor(frame / 64.0)) + passIndex;
    let seed: f32 = dot(floor(uv * imageSize), vec2f(0.06711056, 0.00583715));
    let value: f32 = 52.9829189 * (seed - floor(seed)) + 0.515625 * number;
    return value - floor(value) - 0.5;
}

// returns the noise times BokehJitter; 0 without BOKEH_JITTER 1
fn BokehPassJitter(uv: vec2f, imageSize: vec2f, passIndex: f32) -> f32
{
    var jitter: f32 = 0.0;
    if (BOKEH_JITTER > 0)
    {
        jitter = bokehParameters.BokehJitter * BokehNoise(uv, imageSize, bokehParameters.BokehFrame,
            passIndex);
    }
    return jitter;
}

// sets the viewport and returns the settings of a filter pass; passIndex as in BokehNoise
fn BokehBegin(uv: vec2f, passIndex: f32) -> BokehSamplingSettings
{
    BokehUseViewport();
    var settings: BokehSamplingSettings;
    settings.aspectRatio = bokehParameters.BokehAspectRatio;
    settings.imageHeight = bokehParameters.BokehImageHeight;
    settings.spacing = bokehParameters.BokehSpacing;
    if (bokehParameters.BokehSpacing <= 0.0)
    {
        settings.spacing = BOKEH_SPACING;
    }
    settings.jitter = BokehPassJitter(uv, vec2f(bokehParameters.BokehImageWidth,
        bokehParameters.BokehImageHeight), passIndex);
    settings.bleedingBias = bokehParameters.BokehBleedingBias;
    settings.bleedingMult = bokehParameters.BokehBleedingMult;
    return settings;
}

// makes the aperture; with BOKEH_LENS_SHAPE 1 as the lens shows it at this pixel
fn BokehAperture(uv: vec2f, sides: i32) -> BokehPolygon
{
    var polygon: BokehPolygon = BokehMakePolygon(sides, bokehParameters.BokehAngle,
        bokehParameters.BokehSqueeze);
    if (BOKEH_LENS_SHAPE > 0)
    {
        polygon = BokehWithCatsEye(BokehWithRoundness(polygon, bokehParameters.BokehRoundness), uv,
            vec2f(bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight),
            bokehParameters.BokehCatsEye);
    }
    return polygon;
}

// makes the aperture with BOKEH_SIDES or else BokehSides sides; a hexagon if neither is set
fn BokehAnyAperture(uv: vec2f) -> BokehPolygon
{
    var sides: i32 = i32(bokehParameters.BokehSides + 0.5);
    if (BOKEH_SIDES > 0)
    {
        sides = BOKEH_SIDES;
    }
    if (sides == 0)
    {
        sides = 6;
    }
    return BokehAperture(uv, clamp(sides, 4, 10));
}

// returns the lens that the parameters describe
fn BokehPassLens() -> BokehLens
{
    var lens: BokehLens = BokehMakeLens(bokehParameters.BokehApertureDiameter,
        bokehParameters.BokehFocalLength, bokehParameters.BokehFocusDistance);
    lens.sensorHeight = bokehParameters.BokehSensorHeight;
    lens.maxCoC = bokehParameters.BokehMaxCoC;
    return lens;
}

// returns the signed CoC of a depth; with BOKEH_FOCUS_CONTROLS 1 as artists have bent the focus
fn BokehPassCoC(depth: f32) -> f32
{
    var CoC: f32 = BokehSignedCoC(depth, BokehPassLens());
    if (BOKEH_FOCUS_CONTROLS > 0)
    {
        var focus: BokehFocus;
        focus.sharpRange = vec2f(bokehParameters.BokehFrontRange, bokehParameters.BokehBackRange);
        focus.sideScale = vec2f(bokehParameters.BokehNearScale, bokehParameters.BokehFarScale);
        focus.sideMaxCoC = vec2f(bokehParameters.BokehNearMaxCoC, bokehParameters.BokehFarMaxCoC);
        CoC = BokehFocusedCoC(depth, BokehPassLens(), focus);
    }
    return CoC;
}

// returns the depth of this pixel in metres
fn BokehPassDepth(depthUV: vec2f) -> f32
{
    let stored: vec2f = BokehFetchDepth(BokehDepthSamp, depthUV);
    return BokehLinearDepth(stored, i32(bokehParameters.BokehDepthKind + 0.5),
        bokehParameters.BokehNear, bokehParameters.BokehFar);
}

// converts image uv to uv of the depth buffer, of which the image may fill a rectangle
fn BokehDepthUV(uv: vec2f) -> vec2f
{
    var depthUV: vec2f = BokehToTexture(uv);
    if (BOKEH_FOCUS_CONTROLS > 0)
    {
        depthUV = vec2f(bokehParameters.BokehDepthX, bokehParameters.BokehDepthY) + uv *
            vec2f(bokehParameters.BokehDepthWidth, bokehParameters.BokehDepthHeight);
    }
    return depthUV;
}

// selects target BOKEH_TARGET_INDEX, for passes that can write only one
fn BokehSelectTarget(first: vec4f, second: vec4f, third: vec4f, fourth: vec4f) -> vec4f
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

// blurs along one line of any length and position, with as many samples as the CoC needs
fn BokehAdaptiveLine(uv: vec2f) -> vec4f
{
    let settings: BokehSamplingSettings = BokehBegin(uv, bokehParameters.BokehPassIndex);
    let lineCenter: vec2f = vec2f(bokehParameters.BokehLineCenterX,
        bokehParameters.BokehLineCenterY);
    let segment: vec4f = BokehSegment(bokehParameters.BokehAngle, bokehParameters.BokehLineLength,
        lineCenter, bokehParameters.BokehSqueeze);
    return BokehDepthOfFieldAdaptive(BokehColorSamp, BokehDepthSamp, uv, segment, settings,
        bokehParameters.BokehBlurCoC > 0.5, BokehLinearClamp);
}

// sets the viewport and returns the context of a pass of `layered`
//   scale         size of the image / size of the target: 1, 2, 4 or 8
fn BokehBeginLayers(uv: vec2f, scale: f32, passIndex: f32) -> BokehLayerContext
{
    BokehUseViewport();
    let imageSize: vec2f = vec2f(bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight);
    var layers: BokehLayerContext = BokehMakeLayerContext(uv, imageSize,
        bokehParameters.BokehMaxCoC);
    if (BOKEH_VIEWPORT > 0)
    {
        layers.origin = vec2f(bokehParameters.BokehViewportX, bokehParameters.BokehViewportY);
        layers.texel = 1.0 / vec2f(bokehParameters.BokehTextureWidth,
            bokehParameters.BokehTextureHeight);
    }
    layers.jitter = BokehPassJitter(uv, ceil(imageSize / scale), passIndex);
    return layers;
}

// does the same for a pass in which jitter has no effect
fn BokehBeginTiles(uv: vec2f) -> BokehLayerContext
{
    return BokehBeginLayers(uv, 1.0, 0.0);
}

// blurs one layer, first pass
//   last          as in BokehExactFirst
fn BokehLayerPolygon(uv: vec2f, isFar: bool, last: i32, polygon: BokehPolygon) -> BokehTargets
{
    let layers: BokehLayerContext = BokehBeginLayers(uv, f32(BOKEH_LAYER_SCALE), 0.0);
    return BokehLayerFirst(BokehColorSamp, BokehColorSampB, BokehLayerCoC(BokehColorSampC, layers,
        BokehLinearClamp), isFar, last, polygon, layers, BokehLinearClamp);
}

// blurs one layer, second pass
fn BokehLayerResult(uv: vec2f, isFar: bool, Strip5Samp: texture_2d<f32>,
    polygon: BokehPolygon) -> vec4f
{
    let layers: BokehLayerContext = BokehBeginLayers(uv, f32(BOKEH_LAYER_SCALE), 1.0);
    return BokehLayerSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, Strip5Samp,
        BokehLayerCoC(BokehColorSampE, layers, BokehLinearClamp), isFar, polygon, layers,
        BokehLinearClamp);
}

// blurs both layers, first pass of a square or a hexagon
fn BokehBothPolygons(uv: vec2f, sides: i32) -> BokehLayersTargets
{
    let layers: BokehLayerContext = BokehBeginLayers(uv, f32(BOKEH_LAYER_SCALE), 0.0);
    return BokehLayersFirst(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehLayerCoC(BokehColorSampE, layers, BokehLinearClamp), BokehAperture(uv, sides),
        layers, BokehLinearClamp);
}

// blurs both layers, second pass
fn BokehBothResults(uv: vec2f, NearStrip3Samp: texture_2d<f32>, FarStrip3Samp: texture_2d<f32>,
    sides: i32) -> BokehBlurred
{
    let layers: BokehLayerContext = BokehBeginLayers(uv, f32(BOKEH_LAYER_SCALE), 1.0);
    return BokehLayersSecond(BokehColorSamp, BokehColorSampB, NearStrip3Samp, FarStrip3Samp,
        BokehLayerCoC(BokehColorSampE, layers, BokehLinearClamp), BokehAperture(uv, sides),
        layers, BokehLinearClamp);
}

// -------------------------------------------------------------------------------------------------
// entry points
//
//   An entry point sets up the parameters and calls the function that has its name. The comment of
//   that function says what the pass reads, what it writes and why it exists. An entry point has a
//   comment here if it does more than this, or if no function has its name:
//   * Square, Hexagon, Octagon and Decagon are the polygon.
//   * First and Second are the two blur passes of `exact`. First blurs along all edges of one half
//     of the outline but the last, Second along all but the first.
//   * LayerFirst and LayerSecond are the two blur passes of `layered`. For a square and a hexagon
//     they call BokehLayersFirst and BokehLayersSecond, for an octagon and a decagon
//     BokehLayerFirst and BokehLayerSecond.
//   * One and Edge are for GPUs and engines that can write only one target in a pass.

// writes depth in metres, which the passes of `paper` read instead of the depth buffer
@fragment fn BokehLinearDepth_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let depth: f32 = BokehPassDepth(BokehToTexture(input.uv));
    return vec4f(depth, depth, depth, 1.0);
}

// writes colour and signed CoC for `exact` and `layered`
//   It does the work of BokehSignedCoCMap, and also takes the parameters of BOKEH_FOCUS_CONTROLS. A
//   pixel beside a light may take the CoC of the light, see BokehLightCoC.
@fragment fn BokehSignedCoCMap_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let imageSize: vec2f = vec2f(bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight);
    var CoC: f32 = BokehPassCoC(BokehPassDepth(BokehDepthUV(input.uv)));
    let neighbor: vec4f = BokehBrightNeighbor(BokehColorSamp, input.uv, imageSize);
    if (max(neighbor.z, neighbor.w) > 0.0)
    {
        let lightUV: vec2f = BokehDepthUV(input.uv + neighbor.xy);
        CoC = BokehLightCoC(CoC, BokehPassCoC(BokehPassDepth(lightUV)), neighbor.zw, imageSize.y);
    }
    return BokehPackCoC(BokehFetchTexel(BokehColorSamp, BokehToTexture(input.uv)), CoC);
}

// writes colour and the same CoC for all pixels: use it to look at the polygon without depth
@fragment fn BokehConstantCoC_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    let color: vec4f = BokehFetchTexel(BokehColorSamp, BokehToTexture(input.uv));
    return BokehPackCoC(color, clamp(bokehParameters.BokehConstantCoC, 0.0,
        bokehParameters.BokehMaxCoC));
}

@fragment fn BokehSquareFirst_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehSquareFirst(BokehColorSamp, input.uv, BokehAperture(input.uv, 4),
        BokehBegin(input.uv, 0.0), BokehLinearClamp).strip2;
}

@fragment fn BokehSquareSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehSquareSecond(BokehColorSamp, input.uv, BokehAperture(input.uv, 4),
        BokehBegin(input.uv, 1.0), BokehLinearClamp);
}

@fragment fn BokehHexagonFirst_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehTargets = BokehHexagonFirst(BokehColorSamp, input.uv, BokehAperture(input.uv,
        6), BokehBegin(input.uv, 0.0), BokehLinearClamp);
    return BokehTargets2(targets.strip2, targets.strip3);
}

@fragment fn BokehHexagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehHexagonSecond(BokehColorSamp, BokehColorSampB, input.uv, BokehAperture(input.uv, 6),
        BokehBegin(input.uv, 1.0), BokehLinearClamp);
}

@fragment fn BokehOctagonFirst_PS(input: BokehVertex) -> BokehTargets3
{
    let targets: BokehTargets = BokehOctagonFirst(BokehColorSamp, input.uv, BokehAperture(input.uv,
        8), BokehBegin(input.uv, 0.0), BokehLinearClamp);
    return BokehTargets3(targets.strip2, targets.strip3, targets.strip4);
}

@fragment fn BokehOctagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehOctagonSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, input.uv,
        BokehAperture(input.uv, 8), BokehBegin(input.uv, 1.0), BokehLinearClamp);
}

@fragment fn BokehDecagonFirst_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehTargets = BokehDecagonFirst(BokehColorSamp, input.uv, BokehAperture(input.uv,
        10), BokehBegin(input.uv, 0.0), BokehLinearClamp);
    return BokehTargets4(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

@fragment fn BokehDecagonSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehDecagonSecond(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        input.uv, BokehAperture(input.uv, 10), BokehBegin(input.uv, 1.0), BokehLinearClamp);
}

// writes one target of the first pass of any polygon of `exact`
@fragment fn BokehExactEdge_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehTargets = BokehExactFirst(BokehColorSamp, input.uv, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(input.uv), BokehBegin(input.uv, 0.0), BokehLinearClamp);
    return BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

// shows what the effect reads, by BokehDebugMode
//   0             colour
//   1             depth: black at the camera, 0.5 at the focus distance, white far away
//   2             CoC: black in focus, white at BokehMaxCoC
//   3             near field orange, far field blue, in focus black; brighter as the CoC grows
@fragment fn BokehDebug_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    var result: vec4f = BokehFetch(BokehColorSamp, input.uv, BokehLinearClamp);
    let depth: f32 = BokehPassDepth(BokehToTexture(input.uv));
    var grey: f32 = clamp(abs(result.a) / max(bokehParameters.BokehMaxCoC, BOKEH_MIN_DEPTH), 0.0,
        1.0);
    var weights: vec3f = vec3f(1.0, 1.0, 1.0);
    if (bokehParameters.BokehDebugMode > 2.5)
    {
        weights = vec3f(0.1, 0.4, 1.0);
        if (depth < bokehParameters.BokehFocusDistance)
        {
            weights = vec3f(1.0, 0.5, 0.0);
        }
    }
    else if (bokehParameters.BokehDebugMode < 1.5)
    {
        grey = depth / (depth + bokehParameters.BokehFocusDistance);
    }
    if (bokehParameters.BokehDebugMode > 0.5)
    {
        result = vec4f(weights * grey, 1.0);
    }
    return result;
}

@fragment fn BokehCoCMap_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehCoCMap(BokehColorSamp, BokehDepthSamp, input.uv, BokehPassLens());
}

@fragment fn BokehDepthOfField_PS(input: BokehVertex) -> @location(0) vec4f
{
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio /
        bokehParameters.BokehSqueeze);
    return BokehDepthOfField(BokehColorSamp, BokehDepthSamp, input.uv, lineEnd,
        BokehBegin(input.uv, 0.0), bokehParameters.BokehBlurCoC > 0.5, BokehLinearClamp);
}

@fragment fn BokehDepthOfFieldFinal_PS(input: BokehVertex) -> @location(0) vec4f
{
    let lineEnd: vec2f = BokehLineEnd(bokehParameters.BokehAngle, bokehParameters.BokehAspectRatio /
        bokehParameters.BokehSqueeze);
    return BokehDepthOfFieldFinal(BokehColorSamp, BokehDepthSamp, BokehColorSampB, input.uv,
        lineEnd, BokehBegin(input.uv, 0.0), bokehParameters.BokehBlurCoC > 0.5,
        bokehParameters.BokehUseMax > 0.5, BokehLinearClamp);
}

// blurs along one line, whose angle, length and centre are parameters: a star has several lines
@fragment fn BokehAdaptive_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehAdaptiveLine(input.uv);
}

// blurs along one line, then combines the result with that of an earlier pass
//   It takes the maximum of both if BokehUseMax is 1, otherwise the minimum.
@fragment fn BokehAdaptiveFinal_PS(input: BokehVertex) -> @location(0) vec4f
{
    let a: vec4f = BokehAdaptiveLine(input.uv);
    return BokehCombine(a, BokehFetch(BokehColorSampB, input.uv, BokehLinearClamp),
        bokehParameters.BokehUseMax > 0.5);
}

@fragment fn BokehNaiveGather_PS(input: BokehVertex) -> @location(0) vec4f
{
    var settings: BokehSamplingSettings = BokehBegin(input.uv, 0.0);
    settings.aspectRatio = bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze;
    return BokehNaiveGather(BokehColorSamp, BokehDepthSamp, BokehKernelSamp, input.uv, settings,
        bokehParameters.BokehBlurCoC > 0.5, BokehLinearClamp);
}

@fragment fn BokehNaiveGrid_PS(input: BokehVertex) -> @location(0) vec4f
{
    let lineEndU: vec2f = BokehLineEnd(bokehParameters.BokehAngle,
        bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze);
    let lineEndV: vec2f = BokehLineEnd(bokehParameters.BokehAngleB,
        bokehParameters.BokehAspectRatio / bokehParameters.BokehSqueeze);
    return BokehNaiveGrid(BokehColorSamp, BokehDepthSamp, input.uv, lineEndU, lineEndV,
        BokehBegin(input.uv, 0.0), bokehParameters.BokehBlurCoC > 0.5, BokehLinearClamp);
}

@fragment fn BokehStableMap_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehStableMap(BokehColorSamp, BokehColorSampB, BokehColorSampC, input.uv,
        vec2f(bokehParameters.BokehImageWidth, bokehParameters.BokehImageHeight),
        bokehParameters.BokehStableBlend, BokehLinearClamp);
}

@fragment fn BokehLateralColor_PS(input: BokehVertex) -> @location(0) vec4f
{
    BokehUseViewport();
    return BokehLateralColor(BokehColorSamp, input.uv, bokehParameters.BokehLateral,
        BokehLinearClamp);
}

@fragment fn BokehTileMax_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehTileMax(BokehColorSamp, BokehBeginTiles(input.uv));
}

@fragment fn BokehTileDilateRows_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehTileDilate(BokehColorSamp, vec2f(1.0, 0.0), BokehBeginTiles(input.uv),
        BokehLinearClamp);
}

@fragment fn BokehTileDilateColumns_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehTileDilate(BokehColorSamp, vec2f(0.0, 1.0), BokehBeginTiles(input.uv),
        BokehLinearClamp);
}

@fragment fn BokehPrefilter_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehPrefiltered = BokehPrefilter(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehTargets4(targets.nearLayer, targets.farLayer, targets.layerCoCSums,
        targets.gatherCoC);
}

@fragment fn BokehLayerCoCReduce_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehTileSums = BokehLayerCoCReduce(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(input.uv));
    return BokehTargets2(targets.gatherCoC, targets.sums);
}

@fragment fn BokehLayerCoCRows_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehTileSums = BokehLayerCoCRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehTargets2(targets.gatherCoC, targets.sums);
}

@fragment fn BokehLayerCoCColumns_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehLayerCoCTargets = BokehLayerCoCColumns(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehTargets2(targets.gatherTiles, targets.layerCoC);
}

@fragment fn BokehDownsample_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehDownsampled = BokehDownsample(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehColorSampD, BokehColorSampE, BokehAnyAperture(input.uv),
        BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehTargets4(targets.midWithHoles, targets.farWithHoles, targets.nearQuarter,
        targets.farQuarter);
}

@fragment fn BokehHoleFill_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehFilled = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehAnyAperture(input.uv), BokehBeginLayers(input.uv, 4.0, 0.0), BokehLinearClamp);
    return BokehTargets2(targets.midFill, targets.farFill);
}

@fragment fn BokehSquareLayerFirst_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehLayersTargets = BokehBothPolygons(input.uv, 4);
    return BokehTargets2(targets.nearStrip2, targets.farStrip2);
}

@fragment fn BokehSquareLayerSecond_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehBlurred = BokehBothResults(input.uv, BokehColorSamp, BokehColorSampB, 4);
    return BokehTargets2(targets.nearLayer, targets.farLayer);
}

@fragment fn BokehHexagonLayerFirst_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehLayersTargets = BokehBothPolygons(input.uv, 6);
    return BokehTargets4(targets.nearStrip2, targets.farStrip2, targets.nearStrip3,
        targets.farStrip3);
}

@fragment fn BokehHexagonLayerSecond_PS(input: BokehVertex) -> BokehTargets2
{
    let targets: BokehBlurred = BokehBothResults(input.uv, BokehColorSampC, BokehColorSampD, 6);
    return BokehTargets2(targets.nearLayer, targets.farLayer);
}

@fragment fn BokehOctagonNearFirst_PS(input: BokehVertex) -> BokehTargets3
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, false, 4, BokehAperture(input.uv, 8));
    return BokehTargets3(targets.strip2, targets.strip3, targets.strip4);
}

@fragment fn BokehOctagonNearSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehLayerResult(input.uv, false, BokehColorSampC, BokehAperture(input.uv, 8));
}

@fragment fn BokehOctagonFarFirst_PS(input: BokehVertex) -> BokehTargets3
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, true, 4, BokehAperture(input.uv, 8));
    return BokehTargets3(targets.strip2, targets.strip3, targets.strip4);
}

@fragment fn BokehOctagonFarSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehLayerResult(input.uv, true, BokehColorSampC, BokehAperture(input.uv, 8));
}

@fragment fn BokehDecagonNearFirst_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, false, 5, BokehAperture(input.uv, 10));
    return BokehTargets4(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

@fragment fn BokehDecagonNearSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehLayerResult(input.uv, false, BokehColorSampD, BokehAperture(input.uv, 10));
}

@fragment fn BokehDecagonFarFirst_PS(input: BokehVertex) -> BokehTargets4
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, true, 5, BokehAperture(input.uv, 10));
    return BokehTargets4(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

@fragment fn BokehDecagonFarSecond_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehLayerResult(input.uv, true, BokehColorSampD, BokehAperture(input.uv, 10));
}

@fragment fn BokehComposite_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehComposite(BokehColorSamp, BokehColorSampB, BokehColorSampC, BokehColorSampD,
        BokehColorSampE, BokehColorSampF, BokehAnyAperture(input.uv), BokehBeginLayers(input.uv,
        1.0, 2.0), BokehLinearClamp);
}

// writes one target of BokehPrefilter; the entry points below do so for other passes
@fragment fn BokehPrefilterOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehPrefiltered = BokehPrefilter(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehSelectTarget(targets.nearLayer, targets.farLayer, targets.layerCoCSums,
        targets.gatherCoC);
}

@fragment fn BokehLayerCoCReduceOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehTileSums = BokehLayerCoCReduce(BokehColorSamp, BokehColorSampB,
        BokehBeginTiles(input.uv));
    return BokehSelectTarget(targets.gatherCoC, targets.sums, targets.sums, targets.sums);
}

@fragment fn BokehLayerCoCRowsOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehTileSums = BokehLayerCoCRows(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehSelectTarget(targets.gatherCoC, targets.sums, targets.sums, targets.sums);
}

@fragment fn BokehLayerCoCColumnsOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehLayerCoCTargets = BokehLayerCoCColumns(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehSelectTarget(targets.gatherTiles, targets.layerCoC, targets.layerCoC,
        targets.layerCoC);
}

@fragment fn BokehDownsampleOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehDownsampled = BokehDownsample(BokehColorSamp, BokehColorSampB,
        BokehColorSampC, BokehColorSampD, BokehColorSampE, BokehAnyAperture(input.uv),
        BokehBeginTiles(input.uv), BokehLinearClamp);
    return BokehSelectTarget(targets.midWithHoles, targets.farWithHoles, targets.nearQuarter,
        targets.farQuarter);
}

@fragment fn BokehHoleFillOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehFilled = BokehHoleFill(BokehColorSamp, BokehColorSampB, BokehColorSampC,
        BokehAnyAperture(input.uv), BokehBeginLayers(input.uv, 4.0, 0.0), BokehLinearClamp);
    return BokehSelectTarget(targets.midFill, targets.farFill, targets.farFill, targets.farFill);
}

// writes one target of the first blur pass of one layer, for any polygon
@fragment fn BokehNearEdge_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, false, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(input.uv));
    return BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

@fragment fn BokehFarEdge_PS(input: BokehVertex) -> @location(0) vec4f
{
    let targets: BokehTargets = BokehLayerPolygon(input.uv, true, BOKEH_TARGET_INDEX + 2,
        BokehAnyAperture(input.uv));
    return BokehSelectTarget(targets.strip2, targets.strip3, targets.strip4, targets.strip5);
}

// writes one blurred layer, for any polygon: the second blur pass
@fragment fn BokehNearSecondOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehLayerResult(input.uv, false, BokehColorSampD, BokehAnyAperture(input.uv));
}

@fragment fn BokehFarSecondOne_PS(input: BokehVertex) -> @location(0) vec4f
{
    return BokehLayerResult(input.uv, true, BokehColorSampD, BokehAnyAperture(input.uv));
}
