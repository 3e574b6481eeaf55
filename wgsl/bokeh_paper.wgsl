// SPDX-License-Identifier: MIT
//
// The method of the paper, WGSL. Version 0.3.0. Put it after bokeh.wgsl.
// McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures in a
// Post-Process Depth of Field Shader": Listings 2 to 4, and the gather that the paper compares them
// with. Listing 1 is in bokeh.wgsl. docs/paper.md says where this code deviates, and why.
//
// CONTRACT
//   Functions only: no bindings, no entry points.
//   In    colour: linear, HDR. Depth: metres along the view axis, in an R32F texture.
//   Out   colour, blurred by a polygonal aperture; alpha = CoC, without a sign.
//
//   colour + depth -> CoCMap -> line passes (each reads the one before, and depth) -> combine
//
//   aperture   lines (degrees)                                passes   combine
//   square     0, then 90                                     2
//   diamond    0, then 45                                     2
//   hexagon    90, then 30 and, from the same, 150            3        min
//   octagon    0, then 90;  45, then 135                      4        min
//   star       as octagon                                     4        max
//
//   name                    default    range   meaning
//   BOKEH_PAPER_SAMPLES     13         2 ..    samples on a line (section 4.3), whatever its
//                                              length; the adaptive functions take the preset's

override BOKEH_PAPER_SAMPLES: i32 = 13;

// -------------------------------------------------------------------------------------------------
// [6] Listing 1: the CoC map

// Listing 1: returns the depth of this pixel in metres, with invalid values replaced
fn BokehPaperDepth(DepthSamp: BokehDepthTexture, uv: vec2f) -> f32
{
    return BokehSanitize(BokehFetchDepth(DepthSamp, BokehToTexture(uv)).x, BOKEH_MIN_DEPTH,
        BOKEH_MAX_DEPTH);
}

// Listing 1: writes colour and CoC into one texture: CoCMap, the first pass of `paper`
//   Reads the engine's colour, and depth in metres. All later passes read its target instead of the
//   engine's colour, so only this pass has to replace invalid colours. A pixel and its CoC then
//   take one fetch.
//   ColorSamp     linear HDR scene colour, read texel by texel
//   DepthSamp     r = metres along the view axis
//   returns       rgb = colour, a = CoC without a sign
fn BokehCoCMap(ColorSamp: texture_2d<f32>, DepthSamp: BokehDepthTexture, uv: vec2f,
    lens: BokehLens) -> vec4f
{
    return BokehPackCoC(BokehFetchTexel(ColorSamp, BokehToTexture(uv)),
        abs(BokehSignedCoC(BokehPaperDepth(DepthSamp, uv), lens)));
}

// -------------------------------------------------------------------------------------------------
// [7] Listing 2: sample offsets
//
//      u ->      angle = 0: along +u;  90 degrees: along +v, towards the last row in memory
//    v           -lineEnd  o--o--o--o--o--o--o  +lineEnd      length 1, in units of the CoC
//    |                              ^ this pixel
//    v

// Listing 2: computes the end of a line of length 1 that is centred on this pixel
//   angle         radians
//   aspectRatio   width / height of the image; offsets are in uv, so x is divided by it, or
//                 highlights would be stretched
//   returns       uv offset for a CoC of 1; the other end of the line is its negative
fn BokehLineEnd(angle: f32, aspectRatio: f32) -> vec2f
{
    return BokehCosSin(angle) * vec2f(0.5 / aspectRatio, 0.5);
}

// Listing 2: makeOffsets, returns the offset of sample i of numSamples along the line
//   Samples are evenly spaced from end to end. t runs from -1 to +1, so that offsets are exact
//   negatives of each other and the middle one is 0.
//   lineEnd       from BokehLineEnd
//   returns       uv offset for a CoC of 1
fn BokehMakeOffsets(lineEnd: vec2f, i: i32, numSamples: i32) -> vec2f
{
    let last: i32 = max(numSamples, 2) - 1;
    let t: f32 = f32(2 * i - last) / f32(last);
    return lineEnd * t;
}

// Listing 2, adaptive: makes a line of any length and position, for BokehDepthOfFieldAdaptive
//   angle         radians
//   lineLength    in units of the CoC
//   lineCenter    its middle, offset from this pixel in units of the CoC; x to the right, y towards
//                 the last row; a highlight shows the line on the opposite side
//   squeeze       width of the bokeh / its height, 1 = round
//   returns       xy = middle, zw = from the middle to the end, in units of the CoC, as
//                 BokehEdgeLine returns it
fn BokehSegment(angle: f32, lineLength: f32, lineCenter: vec2f, squeeze: f32) -> vec4f
{
    let halfLine: vec2f = BokehCosSin(angle) * 0.5 * lineLength;
    return vec4f(lineCenter, halfLine) * vec4f(squeeze, 1.0, squeeze, 1.0);
}

// -------------------------------------------------------------------------------------------------
// [8] Listing 3: one pass of the line filter

// Listing 3: returns the weight of one sample against intensity leakage (section 2.1)
//   A sample that is nearer to the camera than this pixel and clearly sharper would leak onto it.
//   Its weight is its own CoC times bleedingMult: 0 in focus, 1 from a CoC of 1 / bleedingMult. The
//   weight of every other sample is 1.
//   sampleDepth, centerDepth  metres
//   sampleCoC, centerCoC  fractions of the image height, without a sign
fn BokehLeakageWeight(sampleDepth: f32, sampleCoC: f32, centerDepth: f32, centerCoC: f32,
    settings: BokehSamplingSettings) -> f32
{
    var weight: f32 = 1.0;
    if (sampleDepth < centerDepth && centerCoC > sampleCoC + settings.bleedingBias)
    {
        weight = clamp(sampleCoC * settings.bleedingMult, 0.0, 1.0);
    }
    return weight;
}

// Listing 3: divides a weighted sum by its weight; returns centerPixel if all weights are 0
//   With an even number of samples the middle of the line is not sampled, so all may be rejected.
//   blurCoC       true: the CoC is averaged too; false (Figure 7): this pixel keeps its CoC
fn BokehResolve(color: vec4f, totalWeight: f32, centerPixel: vec4f, blurCoC: bool) -> vec4f
{
    var result: vec4f = centerPixel;
    if (totalWeight > 0.0)
    {
        result = color / totalWeight;
    }
    if (!blurCoC)
    {
        result = vec4f(result.rgb, centerPixel.a);
    }
    return result;
}

// Listing 3: DepthOfField, a line pass: returns the weighted mean of the samples along one line
//   Reads the CoC map or an earlier line pass, and depth. Two such passes along different lines
//   blur over a parallelogram.
//
//      CoC map --> pass 1: o-o-o-o-o  --> pass 2: along another line   =  parallelogram
//   ColorSamp     rgb = linear HDR colour, a = CoC, from BokehCoCMap or from an earlier pass;
//                 linear filter, clamp
//   DepthSamp     r = metres, the same texture as in BokehCoCMap
//   lineEnd       from BokehLineEnd
//   settings      only its leakage test is used; a line always has BOKEH_PAPER_SAMPLES samples, at
//                 most 254 in shader model 3
//   blurCoC       as in BokehResolve
fn BokehDepthOfField(ColorSamp: texture_2d<f32>, DepthSamp: BokehDepthTexture, uv: vec2f,
    lineEnd: vec2f, settings: BokehSamplingSettings, blurCoC: bool,
        BokehLinearClamp: sampler) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, uv, BokehLinearClamp);
    let centerDepth: f32 = BokehPaperDepth(DepthSamp, uv);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var i: i32 = 0; i < BOKEH_PAPER_SAMPLES; i++)
    {
        let offset: vec2f = BokehMakeOffsets(lineEnd, i, BOKEH_PAPER_SAMPLES);
        let sampleCoords: vec2f = uv + offset * centerPixel.a;
        let samplePixel: vec4f = BokehFetch(ColorSamp, sampleCoords, BokehLinearClamp);
        let sampleDepth: f32 = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
        let weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            settings);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Listing 3, adaptive: blurs along one line, with only as many samples as the local CoC needs
//   The paper's future work, along a line of any length and position. A pixel in focus costs one
//   fetch.
//   segment       from BokehSegment
//   settings      spacing, jitter and the leakage test are used
//   The other parameters are those of BokehDepthOfField.
fn BokehDepthOfFieldAdaptive(ColorSamp: texture_2d<f32>, DepthSamp: BokehDepthTexture, uv: vec2f,
    segment: vec4f, settings: BokehSamplingSettings, blurCoC: bool,
        BokehLinearClamp: sampler) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, uv, BokehLinearClamp);
    var result: vec4f = centerPixel;
    let CoC: f32 = BokehFilterCoC(centerPixel.a, settings.imageHeight);
    if (CoC > 0.0)
    {
        let centerDepth: f32 = BokehPaperDepth(DepthSamp, uv);
        let lengthInPixels: f32 = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
        let samples: f32 = BokehSampleCount(lengthInPixels, settings.spacing);
        let phase: f32 = 0.5 + settings.jitter * clamp(lengthInPixels / samples - 1.0, 0.0, 1.0);
        let scale: vec2f = vec2f(CoC / settings.aspectRatio, CoC);
        let first: vec2f = uv + (segment.xy - segment.zw) * scale;
        let sampleStep: vec2f = segment.zw * scale * (2.0 / samples);
        var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        var totalWeight: f32 = 0.0;
        for (var i: i32 = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            if (BOKEH_SPACING > 0.0 && f32(i) >= samples)
            {
                break;
            }
            let part: f32 = clamp(samples - f32(i), 0.0, 1.0);
            let sampleCoords: vec2f = first + sampleStep * (f32(i) + part * phase);
            let samplePixel: vec4f = BokehFetch(ColorSamp, sampleCoords, BokehLinearClamp);
            let sampleDepth: f32 = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
            let weight: f32 = part * BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
                centerPixel.a, settings);
            color += samplePixel * weight;
            totalWeight += weight;
        }
        result = BokehResolve(color, totalWeight, centerPixel, blurCoC);
    }
    return result;
}

// -------------------------------------------------------------------------------------------------
// [9] Listing 4: combining by min or max

// Listing 4: intersects (min) or unites (max) two parallelogram blurs and their CoC (section 4.5)
fn BokehCombine(a: vec4f, b: vec4f, useMax: bool) -> vec4f
{
    var result: vec4f = min(a, b);
    if (useMax)
    {
        result = max(a, b);
    }
    return result;
}

// Listing 4: DepthOfFieldFinal, blurs along the last line and combines it with another blur
//   The last pass of a hexagon, octagon or star: it finishes the second parallelogram, and takes
//   the minimum or maximum of that and the first one.
//   CompareSamp   the finished first parallelogram
//   useMax        false: intersection (hexagon, octagon); true: union (star)
//   The other parameters are those of BokehDepthOfField.
fn BokehDepthOfFieldFinal(ColorSamp: texture_2d<f32>, DepthSamp: BokehDepthTexture,
    CompareSamp: texture_2d<f32>, uv: vec2f, lineEnd: vec2f, settings: BokehSamplingSettings,
        blurCoC: bool, useMax: bool, BokehLinearClamp: sampler) -> vec4f
{
    let a: vec4f = BokehDepthOfField(ColorSamp, DepthSamp, uv, lineEnd, settings, blurCoC,
        BokehLinearClamp);
    return BokehCombine(a, BokehFetch(CompareSamp, uv, BokehLinearClamp), useMax);
}

// -------------------------------------------------------------------------------------------------
// [10] the naive gather that the paper compares with

// Section 3: gathers with a table of BOKEH_PAPER_SAMPLES offsets, for a bokeh of any shape
//   One pass after the CoC map, and as many fetches as the table has offsets. A gather mirrors the
//   shape at the pixel: negate a table that has the shape as the bokeh should look.
//   KernelSamp    BOKEH_PAPER_SAMPLES x 1 texels, rg = offset in units of the CoC; x to the right,
//                 y towards the last row
//   The other parameters are those of BokehDepthOfField.
fn BokehNaiveGather(ColorSamp: texture_2d<f32>, DepthSamp: BokehDepthTexture,
    KernelSamp: texture_2d<f32>, uv: vec2f, settings: BokehSamplingSettings, blurCoC: bool,
    BokehLinearClamp: sampler) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, uv, BokehLinearClamp);
    let centerDepth: f32 = BokehPaperDepth(DepthSamp, uv);
    let scale: vec2f = vec2f(centerPixel.a / settings.aspectRatio, centerPixel.a);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var i: i32 = 0; i < BOKEH_PAPER_SAMPLES; i++)
    {
        let offset: vec2f = BokehFetchTexel(KernelSamp, vec2f((f32(i) + 0.5) /
            f32(BOKEH_PAPER_SAMPLES), 0.5)).rg;
        let sampleCoords: vec2f = uv + offset * scale;
        let samplePixel: vec4f = BokehFetch(ColorSamp, sampleCoords, BokehLinearClamp);
        let sampleDepth: f32 = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
        let weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            settings);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Section 3: gathers over a grid in a parallelogram, with computed offsets (Table 1)
//   BOKEH_PAPER_SAMPLES is the number of samples along a side: 4, 8, 12, 16, 20, 24 for the counts
//   of Table 1.
//   lineEndU, lineEndV  the two sides, from BokehLineEnd
//   The other parameters are those of BokehDepthOfField.
fn BokehNaiveGrid(ColorSamp: texture_2d<f32>, DepthSamp: BokehDepthTexture, uv: vec2f,
    lineEndU: vec2f, lineEndV: vec2f, settings: BokehSamplingSettings, blurCoC: bool,
    BokehLinearClamp: sampler) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, uv, BokehLinearClamp);
    let centerDepth: f32 = BokehPaperDepth(DepthSamp, uv);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var j: i32 = 0; j < BOKEH_PAPER_SAMPLES; j++)
    {
        let rowOffset: vec2f = BokehMakeOffsets(lineEndV, j, BOKEH_PAPER_SAMPLES);
        for (var i: i32 = 0; i < BOKEH_PAPER_SAMPLES; i++)
        {
            let offset: vec2f = rowOffset + BokehMakeOffsets(lineEndU, i, BOKEH_PAPER_SAMPLES);
            let sampleCoords: vec2f = uv + offset * centerPixel.a;
            let samplePixel: vec4f = BokehFetch(ColorSamp, sampleCoords, BokehLinearClamp);
            let sampleDepth: f32 = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
            let weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
                centerPixel.a, settings);
            color += samplePixel * weight;
            totalWeight += weight;
        }
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}
