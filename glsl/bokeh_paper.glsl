// SPDX-License-Identifier: MIT
//
// The method of the paper, GLSL. Version 0.3.0. Put it after bokeh.glsl.
// McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures in a
// Post-Process Depth of Field Shader": Listings 2 to 4, and the gather that the paper compares them
// with. Listing 1 is in bokeh.glsl. docs/paper.md says where this code deviates, and why.
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

#ifndef BOKEH_VIEWPORT
#error put bokeh.glsl before bokeh_paper.glsl
#endif
#define BOKEH_PAPER 1

#ifndef BOKEH_PAPER_SAMPLES
#define BOKEH_PAPER_SAMPLES 13
#endif
#if BOKEH_PAPER_SAMPLES < 2
#error BOKEH_PAPER_SAMPLES must be 2 or more: a line has two ends
#endif

// -------------------------------------------------------------------------------------------------
// [6] Listing 1: the CoC map

// Listing 1: returns the depth of this pixel in metres, with invalid values replaced
float BokehPaperDepth(BOKEH_DEPTH_TEXTURE DepthSamp, vec2 uv)
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
vec4 BokehCoCMap(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp, vec2 uv, BokehLens lens)
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
vec2 BokehLineEnd(float angle, float aspectRatio)
{
    return BokehCosSin(angle) * vec2(0.5 / aspectRatio, 0.5);
}

// Listing 2: makeOffsets, returns the offset of sample i of numSamples along the line
//   Samples are evenly spaced from end to end. t runs from -1 to +1, so that offsets are exact
//   negatives of each other and the middle one is 0.
//   lineEnd       from BokehLineEnd
//   returns       uv offset for a CoC of 1
vec2 BokehMakeOffsets(vec2 lineEnd, int i, int numSamples)
{
    int last = max(numSamples, 2) - 1;
    float t = float(2 * i - last) / float(last);
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
vec4 BokehSegment(float angle, float lineLength, vec2 lineCenter, float squeeze)
{
    vec2 halfLine = BokehCosSin(angle) * 0.5 * lineLength;
    return vec4(lineCenter, halfLine) * vec4(squeeze, 1.0, squeeze, 1.0);
}

// -------------------------------------------------------------------------------------------------
// [8] Listing 3: one pass of the line filter

// Listing 3: returns the weight of one sample against intensity leakage (section 2.1)
//   A sample that is nearer to the camera than this pixel and clearly sharper would leak onto it.
//   Its weight is its own CoC times bleedingMult: 0 in focus, 1 from a CoC of 1 / bleedingMult. The
//   weight of every other sample is 1.
//   sampleDepth, centerDepth  metres
//   sampleCoC, centerCoC  fractions of the image height, without a sign
float BokehLeakageWeight(float sampleDepth, float sampleCoC, float centerDepth, float centerCoC,
    BokehSamplingSettings settings)
{
    float weight = 1.0;
    if (sampleDepth < centerDepth && centerCoC > sampleCoC + settings.bleedingBias)
    {
        weight = clamp(sampleCoC * settings.bleedingMult, 0.0, 1.0);
    }
    return weight;
}

// Listing 3: divides a weighted sum by its weight; returns centerPixel if all weights are 0
//   With an even number of samples the middle of the line is not sampled, so all may be rejected.
//   blurCoC       true: the CoC is averaged too; false (Figure 7): this pixel keeps its CoC
vec4 BokehResolve(vec4 color, float totalWeight, vec4 centerPixel, bool blurCoC)
{
    vec4 result = centerPixel;
    if (totalWeight > 0.0)
    {
        result = color / totalWeight;
    }
    if (!blurCoC)
    {
        result = vec4(result.rgb, centerPixel.a);
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
vec4 BokehDepthOfField(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp, vec2 uv,
    vec2 lineEnd, BokehSamplingSettings settings, bool blurCoC)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    float centerDepth = BokehPaperDepth(DepthSamp, uv);
    vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    for (int i = 0; i < BOKEH_PAPER_SAMPLES; i++)
    {
        vec2 offset = BokehMakeOffsets(lineEnd, i, BOKEH_PAPER_SAMPLES);
        vec2 sampleCoords = uv + offset * centerPixel.a;
        vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
        float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
        float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
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
vec4 BokehDepthOfFieldAdaptive(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp, vec2 uv,
    vec4 segment, BokehSamplingSettings settings, bool blurCoC)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    vec4 result = centerPixel;
    float CoC = BokehFilterCoC(centerPixel.a, settings.imageHeight);
    if (CoC > 0.0)
    {
        float centerDepth = BokehPaperDepth(DepthSamp, uv);
        float lengthInPixels = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
        float samples = BokehSampleCount(lengthInPixels, settings.spacing);
        float phase = 0.5 + settings.jitter * clamp(lengthInPixels / samples - 1.0, 0.0, 1.0);
        vec2 scale = vec2(CoC / settings.aspectRatio, CoC);
        vec2 first = uv + (segment.xy - segment.zw) * scale;
        vec2 sampleStep = segment.zw * scale * (2.0 / samples);
        vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
        float totalWeight = 0.0;
        for (int i = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            if (BOKEH_SPACING > 0.0 && float(i) >= samples)
            {
                break;
            }
            float part = clamp(samples - float(i), 0.0, 1.0);
            vec2 sampleCoords = first + sampleStep * (float(i) + part * phase);
            vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
            float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
            float weight = part * BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
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
vec4 BokehCombine(vec4 a, vec4 b, bool useMax)
{
    vec4 result = min(a, b);
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
vec4 BokehDepthOfFieldFinal(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp,
    BOKEH_TEXTURE CompareSamp, vec2 uv, vec2 lineEnd, BokehSamplingSettings settings, bool blurCoC,
    bool useMax)
{
    vec4 a = BokehDepthOfField(ColorSamp, DepthSamp, uv, lineEnd, settings, blurCoC);
    return BokehCombine(a, BokehFetch(CompareSamp, uv), useMax);
}

// -------------------------------------------------------------------------------------------------
// [10] the naive gather that the paper compares with

// Section 3: gathers with a table of BOKEH_PAPER_SAMPLES offsets, for a bokeh of any shape
//   One pass after the CoC map, and as many fetches as the table has offsets. A gather mirrors the
//   shape at the pixel: negate a table that has the shape as the bokeh should look.
//   KernelSamp    BOKEH_PAPER_SAMPLES x 1 texels, rg = offset in units of the CoC; x to the right,
//                 y towards the last row
//   The other parameters are those of BokehDepthOfField.
vec4 BokehNaiveGather(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp,
    BOKEH_TEXTURE KernelSamp, vec2 uv, BokehSamplingSettings settings, bool blurCoC)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    float centerDepth = BokehPaperDepth(DepthSamp, uv);
    vec2 scale = vec2(centerPixel.a / settings.aspectRatio, centerPixel.a);
    vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    for (int i = 0; i < BOKEH_PAPER_SAMPLES; i++)
    {
        vec2 offset = BokehFetchTexel(KernelSamp, vec2((float(i) + 0.5) /
            float(BOKEH_PAPER_SAMPLES), 0.5)).rg;
        vec2 sampleCoords = uv + offset * scale;
        vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
        float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
        float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
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
vec4 BokehNaiveGrid(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp, vec2 uv, vec2 lineEndU,
    vec2 lineEndV, BokehSamplingSettings settings, bool blurCoC)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    float centerDepth = BokehPaperDepth(DepthSamp, uv);
    vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    for (int j = 0; j < BOKEH_PAPER_SAMPLES; j++)
    {
        vec2 rowOffset = BokehMakeOffsets(lineEndV, j, BOKEH_PAPER_SAMPLES);
        for (int i = 0; i < BOKEH_PAPER_SAMPLES; i++)
        {
            vec2 offset = rowOffset + BokehMakeOffsets(lineEndU, i, BOKEH_PAPER_SAMPLES);
            vec2 sampleCoords = uv + offset * centerPixel.a;
            vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
            float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords)).x;
            float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
                centerPixel.a, settings);
            color += samplePixel * weight;
            totalWeight += weight;
        }
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}
