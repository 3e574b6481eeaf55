// SPDX-License-Identifier: MIT
//
// The method of the paper, GLSL. Version 0.3.0. Put it after bokeh.glsl.
// McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures in a
// Post-Process Depth of Field Shader": Listings 2-4 and the gather that they are compared with.
// Listing 1 is in bokeh.glsl. docs/paper.md says where this deviates, and why.
//
// CONTRACT
//   Functions only: no bindings, no entry points.
//   In    colour: linear, HDR. depth: metres along the view axis, in a texture of its own, R32F.
//   Out   colour blurred by a polygonal aperture; alpha = CoC, without a sign.
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
//   BOKEH_PAPER_SAMPLES     13         2 ..    samples on a line (section 4.3), always as many; the
//                                              adaptive functions take those of the preset

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
// [6] Listing 1: the map

// Listing 1: depth of this pixel, made safe
float BokehPaperDepth(BOKEH_DEPTH_TEXTURE DepthSamp, vec2 uv)
{
    return BokehSanitize(BokehFetchDepth(DepthSamp, BokehToTexture(uv)), BOKEH_MIN_DEPTH,
        BOKEH_MAX_DEPTH);
}

// Listing 1: CoCMap, the first pass: no later pass sees the engine's raw colour
//   ColorSamp     linear HDR scene colour, read texel by texel
//   returns       rgb = colour, a = CoC
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

// Listing 2: the end of a line of length 1 centred on this pixel
//   angle         radians
//   aspectRatio   width / height of the image: offsets are in uv, so x shrinks by it and a
//                 highlight is not stretched
//   returns       uv offset for a CoC of 1; the other end of the line is the negative of it
vec2 BokehLineEnd(float angle, float aspectRatio)
{
    return vec2(0.5 * cos(angle) / aspectRatio, 0.5 * sin(angle));
}

// Listing 2: makeOffsets, sample i of numSamples evenly spaced from end to end of the line
//   t runs from -1 to +1, so that the offsets are exact negatives of each other and the middle one
//   is 0.
//   returns       uv offset for a CoC of 1
vec2 BokehMakeOffsets(vec2 lineEnd, int i, int numSamples)
{
    int last = max(numSamples, 2) - 1;
    float t = float(2 * i - last) / float(last);
    return lineEnd * t;
}

// Listing 2, adaptive: a line of any length and place, for BokehDepthOfFieldAdaptive
//   angle         radians
//   lineLength    in units of the CoC
//   lineCenter    its middle, in units of the CoC from this pixel, x to the right, y towards the
//                 last row; a highlight shows the line on the other side
//   squeeze       width of the bokeh / its height, 1 = round
//   returns       xy = middle, zw = from the middle to the end, in units of the CoC;
//                 BokehEdgeLine returns the same
vec4 BokehSegment(float angle, float lineLength, vec2 lineCenter, float squeeze)
{
    vec2 halfLine = vec2(cos(angle), sin(angle)) * 0.5 * lineLength;
    return vec4(lineCenter, halfLine) * vec4(squeeze, 1.0, squeeze, 1.0);
}

// -------------------------------------------------------------------------------------------------
// [8] Listing 3: one pass of the line filter

// Listing 3: weight of one sample against intensity leakage (section 2.1)
//   A sample that is nearer to the camera and clearly sharper than this pixel would leak onto it.
//   Its weight is its own CoC then, times bleedingMult: 0 in focus, 1 from a CoC of
//   1 / bleedingMult up. All other samples have the weight 1.
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

// Listing 3: the weighted average, or centerPixel where all weights are 0
//   With an even number of samples the middle of the line is not sampled, so all may be rejected.
//   blurCoC       true: the CoC is averaged, too; false (Figure 7): this pixel keeps its CoC
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

// Listing 3: DepthOfField, the mean of the samples along one line
//   ColorSamp     rgb = linear HDR colour, a = CoC: from BokehCoCMap or from an earlier pass;
//                 linear filter, clamp
//   DepthSamp     r = depth, the same as in BokehCoCMap
//   lineEnd       from BokehLineEnd
//   settings      of which the leakage test is used; there are always BOKEH_PAPER_SAMPLES samples,
//                 in shader model 3 254 at most
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
        float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords));
        float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            settings);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Listing 3, adaptive: DepthOfField with as many samples as the local CoC needs
//   The paper's future work; along a line of any length and place.
//   segment       from BokehSegment
//   The other parameters as in BokehDepthOfField. In focus it costs one fetch.
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
            float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords));
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
// [9] Listing 4: combine by min / max

// Listing 4: intersection (min) or union (max) of two parallelogram blurs, CoC too (section 4.5)
vec4 BokehCombine(vec4 a, vec4 b, bool useMax)
{
    vec4 result = min(a, b);
    if (useMax)
    {
        result = max(a, b);
    }
    return result;
}

// Listing 4: DepthOfFieldFinal, the last line of the second parallelogram, combined with the first
//   CompareSamp   the finished first parallelogram
//   useMax        false: intersection (hexagon, octagon); true: union (star)
vec4 BokehDepthOfFieldFinal(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp,
    BOKEH_TEXTURE CompareSamp, vec2 uv, vec2 lineEnd, BokehSamplingSettings settings, bool blurCoC,
    bool useMax)
{
    vec4 a = BokehDepthOfField(ColorSamp, DepthSamp, uv, lineEnd, settings, blurCoC);
    return BokehCombine(a, BokehFetch(CompareSamp, uv), useMax);
}

// -------------------------------------------------------------------------------------------------
// [10] naive gather

// Section 3: gather with a table of BOKEH_PAPER_SAMPLES offsets, any shape
//   The bokeh is their point reflection: negate a table that is drawn as the bokeh looks.
//   KernelSamp    BOKEH_PAPER_SAMPLES x 1 texels, rg = offset in units of the CoC, x to the right,
//                 y towards the last row
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
        float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords));
        float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            settings);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Section 3: gather over a parallelogram grid, offsets computed instead of read (Table 1)
//   BOKEH_PAPER_SAMPLES is the number along a side: 4, 8, 12, 16, 20, 24 for the counts of Table 1.
//   lineEndU, lineEndV  the two sides, from BokehLineEnd
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
            float sampleDepth = BokehFetchDepth(DepthSamp, BokehToTexture(sampleCoords));
            float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
                centerPixel.a, settings);
            color += samplePixel * weight;
            totalWeight += weight;
        }
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}
