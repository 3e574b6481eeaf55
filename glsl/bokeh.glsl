// SPDX-License-Identifier: MIT
//
// Polygonal bokeh depth of field, GLSL. Version 0.1.0.
// After McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures in a Post-Process
// Depth of Field Shader", Listings 1-4. Sections and figures named below are of that paper.
//
// CONTRACT
//   This file holds functions only: no bindings, no entry points. bokeh_passes.glsl beside it has those, ready made.
//   In    colour: linear, HDR, before bloom and tone mapping.   depth: along the view axis, metres.
//   Out   colour blurred by a polygonal aperture, alpha = CoC after the passes.
//   CoC   circle of confusion: a DIAMETER as a fraction of the image height.
//   uv    0 .. 1, v = 0 at the first row in memory. This file never flips.
//   Targets between the passes: RGBA16F, linear filter, clamp. Depth: nearest filter, clamp; it need not be filterable.
//
//   colour + depth -> CoCMap -> line passes (each reads the one before, and depth) -> combine -> bloom, tone mapping
//
//   aperture   lines (degrees)                                passes   combine
//   square     0, then 90                                     2
//   diamond    0, then 45                                     2
//   hexagon    90, then 30 and, from the same, 150            3        min
//   octagon    0, then 90;  45, then 135                      4        min
//   star       as octagon                                     4        max
//
//   Better, for polygons with 4, 6, 8 or 10 sides: exact, two passes, no min, no light lost, section [8]
//   colour + depth -> CoCMap -> ExactFirst (1 to 4 targets) -> ExactSecond -> bloom, tone mapping
//
// PASTE: put this file after your #version line (330, 300 es or 450, or later of the same kind), then for one line pass
//           uniform sampler2D ColorSamp, DepthSamp;  in vec2 uv;  out vec4 result;
//           void main() {
//               result = BokehDepthOfField(ColorSamp, DepthSamp, uv, BokehLineEnd(angle, aspectRatio),
//                                          BOKEH_NUM_SAMPLES, BOKEH_BLEEDING_BIAS, BOKEH_BLEEDING_MULT, true); }
//
// CONTENTS
//   [1] configuration
//   [2] porting: BokehSetViewport, BokehFetch
//   [3] circle of confusion: BokehCoC, BokehLinearDepth, BokehCoCMap
//   [4] sample offsets: BokehLineEnd, BokehMakeOffsets; adaptive: BokehCells, BokehNoise, BokehSegment
//   [5] line filter: BokehDepthOfField; adaptive: BokehLineMean, BokehDepthOfFieldAdaptive
//   [6] combine: BokehCombine, BokehDepthOfFieldFinal
//   [7] naive gather: BokehNaiveGather, BokehNaiveGrid
//   [8] exact polygons: BokehExactFirst, BokehExactSecond; one target: BokehExactEdge
//   [9] debug views: BokehDebugDepth, BokehDebugCoC, BokehDebugFocus

// ---------------------------------------------------------------------------------------------------------------------
// [1] configuration
// ---------------------------------------------------------------------------------------------------------------------
//
//   name                  default    range     meaning
//   BOKEH_NUM_SAMPLES     13         2 ..      samples on a line (section 4.3); define it before this file
//   BOKEH_ADAPTIVE_SAMPLES  1.0     0.0, 1.0  0.0: the ready-made passes always take BOKEH_NUM_SAMPLES, faster; they do
//                                             not read BokehSpacing and BokehJitter then
//   BOKEH_VIEWPORT        0.0        0.0, 1.0  1.0: the image is a part of its textures, see BokehSetViewport
//   BOKEH_SENSOR_HEIGHT   0.024      > 0       metres, 35 mm film (section 4.1)
//   BOKEH_MAX_COC         0.1        0 .. 1    clamp of the CoC; the samples on a line show singly when it is too large
//   BOKEH_BLEEDING_BIAS   0.02       0 .. 1    Listing 3; 1 turns the leakage test off
//   BOKEH_BLEEDING_MULT   30.0       > 0       Listing 3
//   BOKEH_MAX_COLOR       65504.0              largest half float
//   BOKEH_MIN_DEPTH       0.000001             metres, stands for zero and negative depth
//   BOKEH_MAX_DEPTH       1000000000.0         metres, stands for infinite depth: the CoC is A f / (S1 - f) there

#ifndef BOKEH_NUM_SAMPLES
#define BOKEH_NUM_SAMPLES 13
#endif
#ifndef BOKEH_ADAPTIVE_SAMPLES
#define BOKEH_ADAPTIVE_SAMPLES 1.0
#endif
#ifndef BOKEH_VIEWPORT
#define BOKEH_VIEWPORT 0.0
#endif
#ifndef BOKEH_SENSOR_HEIGHT
#define BOKEH_SENSOR_HEIGHT 0.024
#endif
#ifndef BOKEH_MAX_COC
#define BOKEH_MAX_COC 0.1
#endif
#ifndef BOKEH_BLEEDING_BIAS
#define BOKEH_BLEEDING_BIAS 0.02
#endif
#ifndef BOKEH_BLEEDING_MULT
#define BOKEH_BLEEDING_MULT 30.0
#endif
#ifndef BOKEH_MAX_COLOR
#define BOKEH_MAX_COLOR 65504.0
#endif
#ifndef BOKEH_MIN_DEPTH
#define BOKEH_MIN_DEPTH 0.000001
#endif
#ifndef BOKEH_MAX_DEPTH
#define BOKEH_MAX_DEPTH 1000000000.0
#endif

#if BOKEH_NUM_SAMPLES < 2
#error BOKEH_NUM_SAMPLES must be 2 or more: a line has two ends
#endif

// ---------------------------------------------------------------------------------------------------------------------
// [2] porting: the one place where the three languages differ
// ---------------------------------------------------------------------------------------------------------------------
//
//   A texture and its sampler are one parameter, a sampler2D. OpenGL ES has no default precision for float in fragment
//   shaders; half precision can neither address a 4K image nor hold a sum of HDR colours, hence highp throughout.

#ifdef GL_ES
#if __VERSION__ < 300
#error bokeh.glsl needs GLSL ES 3.00 or later: put '#version 300 es' first
#endif
precision highp float;
precision highp int;
precision highp sampler2D;
#else
#if __VERSION__ < 330
#error bokeh.glsl needs GLSL 3.30 or later: put '#version 330' first
#endif
#endif

// where the image lies in its textures, in their uv: xy = its corner, zw = its size; then the bounds of the fetches
vec4 BokehViewport = vec4(0.0, 0.0, 1.0, 1.0);
vec4 BokehViewportBounds = vec4(0.0, 0.0, 1.0, 1.0);

// Porting: the image is a part of its textures (dynamic resolution); call it before all else, with BOKEH_VIEWPORT 1.0
//   Every texture but the kernel is laid out like this. What is around the image is not read: it may hold anything.
//   The bounds are 1/128 texel inside of the centres of the outermost texels, since a linear filter counts a texel
//   with a weight of 0 in, and 0 times NaN is NaN; 1/256 is how exactly devices place a sample (Direct3D 11, Vulkan).
//   viewport      x, y of its first pixel, width, height; pixels, 2 x 2 or more
//   textureSize   width, height; pixels
void BokehSetViewport(vec4 viewport, vec2 textureSize)
{
    if (BOKEH_VIEWPORT > 0.5)
    {
        vec2 inset = min(vec2(0.5078125, 0.5078125), viewport.zw * 0.5);
        BokehViewport = viewport / textureSize.xyxy;
        BokehViewportBounds = vec4(viewport.xy + inset, viewport.xy + viewport.zw - inset) / textureSize.xyxy;
    }
}

// Porting: place in the image to place in its textures
vec2 BokehToTexture(vec2 uv)
{
    vec2 coords = uv;
    if (BOKEH_VIEWPORT > 0.5)
    {
        coords = clamp(BokehViewport.xy + uv * BokehViewport.zw, BokehViewportBounds.xy, BokehViewportBounds.zw);
    }
    return coords;
}

// Porting: one texel fetch at level 0, without gradients, so that it may stand in a loop or a branch
vec4 BokehFetch(sampler2D tex, vec2 uv)
{
    return textureLod(tex, BokehToTexture(uv), 0.0);
}

// Porting: the same for textures with a nearest filter, which is depth
//   A function of its own, since WebGPU may take every texture that a function is given to meet every sampler.
vec4 BokehFetchNearest(sampler2D tex, vec2 uv)
{
    return textureLod(tex, BokehToTexture(uv), 0.0);
}

// Porting: the same for tables, which no viewport applies to
vec4 BokehFetchTable(sampler2D tex, vec2 uv)
{
    return textureLod(tex, uv, 0.0);
}

// ---------------------------------------------------------------------------------------------------------------------
// [3] Listing 1: circle of confusion
// ---------------------------------------------------------------------------------------------------------------------

// Listing 1: CoC of a thin lens (section 4.1)
//   S2            depth of the pixel along the view axis, metres, > 0 (planar depth, not the length of the ray)
//   A             diameter of the aperture, metres
//   f             focal length, metres
//   S1            focus distance, metres, > f; a lens cannot focus nearer, and all but S2 = S1 gets MaxCoC then.
//                 Infinity, however it is spelt, is BOKEH_MAX_DEPTH
//   sensorHeight  height of the image sensor, metres
//   MaxCoC        largest CoC allowed, fraction of the image height
//   returns       diameter of the circle of confusion, fraction of the image height, 0 .. MaxCoC
float BokehCoC(float S2, float A, float f, float S1, float sensorHeight, float MaxCoC)
{
    float focus = min(S1, BOKEH_MAX_DEPTH);
    float magnification = f / max(focus - f, BOKEH_MIN_DEPTH);
    float c = A * magnification * (abs(S2 - focus) / S2);
    return clamp(c / max(sensorHeight, BOKEH_MIN_DEPTH), 0.0, MaxCoC);
}

// Listing 1: one colour channel made safe: NaN and negative become 0, infinite becomes the largest half float
//   NaN fails this comparison; max() may return either operand. It is >= since shader model 3 has no other: > there
//   is the opposite comparison with its two results swapped, and NaN passes that.
float BokehSafeChannel(float value)
{
    float safe = 0.0;
    if (value >= 0.0)
    {
        safe = min(value, BOKEH_MAX_COLOR);
    }
    return safe;
}

// Listing 1: depth made safe: NaN, zero and negative become the smallest depth, infinite the largest
float BokehSafeDepth(float S2)
{
    float safe = BOKEH_MIN_DEPTH;
    if (S2 >= BOKEH_MIN_DEPTH)
    {
        safe = min(S2, BOKEH_MAX_DEPTH);
    }
    return safe;
}

// Depth: window depth 0 (near) .. 1 (far) of a perspective camera to metres (Direct3D, Vulkan, WebGPU, GL's textures)
//   zNear, zFar   the camera's planes, metres, 0 < zNear < zFar
//   returns       depth along the view axis, for BokehCoCMap and all later passes; the sky is at zFar, or
//                 infinite where zNear is less than zFar / 2^24: BokehSafeDepth catches that
float BokehDepthFromWindow(float depth, float zNear, float zFar)
{
    return zNear * zFar / (zFar - depth * (zFar - zNear));
}

// Depth: reversed window depth, 1 (near) .. 0 (far), of a perspective camera to metres
float BokehDepthFromReversed(float depth, float zNear, float zFar)
{
    return zNear * zFar / (zNear + depth * (zFar - zNear));
}

// Depth: reversed window depth without a far plane, 1 (near) .. 0 (infinite), to metres; the sky is at BOKEH_MAX_DEPTH
float BokehDepthFromInfinite(float depth, float zNear)
{
    float stored = zNear / BOKEH_MAX_DEPTH;
    if (depth >= stored)
    {
        stored = depth;
    }
    return zNear / stored;
}

// Depth: depth of clip space, -1 (near) .. 1 (far), z / w in OpenGL, to metres
float BokehDepthFromClip(float depth, float zNear, float zFar)
{
    return 2.0 * zNear * zFar / (zFar + zNear - depth * (zFar - zNear));
}

// Depth: window depth 0 (near) .. 1 (far) of an orthographic camera to metres; give 1 - depth where it is reversed
float BokehDepthFromOrthographic(float depth, float zNear, float zFar)
{
    return zNear + depth * (zFar - zNear);
}

// Depth: a fraction of the far plane's distance to metres, as Listing 1 has it
float BokehDepthFromFraction(float depth, float zFar)
{
    return depth * zFar;
}

// Depth: logarithmic depth, log(1 + metres) / log(1 + zFar), to metres (three.js's WebGLRenderer)
float BokehDepthFromLogarithmic(float depth, float zFar)
{
    float stored = 0.0;
    if (depth >= 0.0)
    {
        stored = depth;
    }
    return exp2(stored * log2(zFar + 1.0)) - 1.0;
}

// Depth: any of the above to metres, made safe, for one pass that makes depth linear
//   kind          0 metres already, 1 window, 2 reversed, 3 reversed infinite, 4 clip, 5 orthographic,
//                 6 orthographic reversed, 7 fraction of zFar, 8 logarithmic
float BokehLinearDepth(float depth, float kind, float zNear, float zFar)
{
    float S2 = depth;
    if (kind > 7.5)
    {
        S2 = BokehDepthFromLogarithmic(depth, zFar);
    }
    else if (kind > 6.5)
    {
        S2 = BokehDepthFromFraction(depth, zFar);
    }
    else if (kind > 5.5)
    {
        S2 = BokehDepthFromOrthographic(1.0 - depth, zNear, zFar);
    }
    else if (kind > 4.5)
    {
        S2 = BokehDepthFromOrthographic(depth, zNear, zFar);
    }
    else if (kind > 3.5)
    {
        S2 = BokehDepthFromClip(depth, zNear, zFar);
    }
    else if (kind > 2.5)
    {
        S2 = BokehDepthFromInfinite(depth, zNear);
    }
    else if (kind > 1.5)
    {
        S2 = BokehDepthFromReversed(depth, zNear, zFar);
    }
    else if (kind > 0.5)
    {
        S2 = BokehDepthFromWindow(depth, zNear, zFar);
    }
    return BokehSafeDepth(S2);
}

// Listing 1: colour as it is, CoC beside it in alpha
//   color         linear HDR colour; its alpha is not used
//   CoC           fraction of the image height
//   returns       what every later pass reads: rgb finite and >= 0, a = CoC
vec4 BokehPackCoC(vec4 color, float CoC)
{
    return vec4(BokehSafeChannel(color.r), BokehSafeChannel(color.g), BokehSafeChannel(color.b), CoC);
}

// Listing 1: CoCMap, the first pass and the only one that sees the engine's raw colour
//   ColorSamp     linear HDR scene colour
//   DepthSamp     r = depth along the view axis, metres (docs/inputs.md has the depth conventions)
//   uv            centre of this pixel, 0 .. 1, v = 0 at the first row in memory
//   returns       rgb = colour, a = CoC
vec4 BokehCoCMap(sampler2D ColorSamp, sampler2D DepthSamp, vec2 uv, float A, float f, float S1, float sensorHeight,
    float MaxCoC)
{
    float S2 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    float CoC = BokehCoC(S2, A, f, S1, sensorHeight, MaxCoC);
    return BokehPackCoC(BokehFetch(ColorSamp, uv), CoC);
}

// ---------------------------------------------------------------------------------------------------------------------
// [4] Listing 2: sample offsets
// ---------------------------------------------------------------------------------------------------------------------
//
//      u ->      angle = 0: along +u;  90 degrees: along +v, which is towards the last row in memory
//    v           -lineEnd  o--o--o--o--o--o--o  +lineEnd      length 1, in units of the CoC
//    |                              ^ this pixel
//    v

// Listing 2: the end of a line of length 1 centred on this pixel
//   angle         radians
//   aspectRatio   width / height of the image: offsets are in uv, so x shrinks by it and a highlight is not stretched
//   returns       uv offset for a CoC of 1; the other end of the line is the negative of it
vec2 BokehLineEnd(float angle, float aspectRatio)
{
    return vec2(0.5 * cos(angle) / aspectRatio, 0.5 * sin(angle));
}

// Listing 2: makeOffsets, sample i of numSamples evenly spaced from one end of the line to the other
//   Counted from the middle (-1 .. +1), so that the offsets are exact negatives of each other and the middle one is 0.
//   returns       uv offset for a CoC of 1
vec2 BokehMakeOffsets(vec2 lineEnd, int i, int numSamples)
{
    int last = max(numSamples, 2) - 1;
    float t = float(2 * i - last) / float(last);
    return lineEnd * t;
}

// Listing 2, adaptive: the CoC that the filter uses, 0 where the pixel is in focus
//   Below half a pixel nothing is left to blur; up to one pixel it fades in, so that no contour shows.
//   spacing       pixels between samples; 0 or less: a fixed number of samples, and the CoC as it is
//   returns       fraction of the image height
float BokehFilterCoC(float CoC, float imageHeight, float spacing)
{
    float filterCoC = CoC;
    if (spacing > 0.0)
    {
        filterCoC = CoC * (1.0 - clamp(2.0 - 2.0 * CoC * imageHeight, 0.0, 1.0));
    }
    return filterCoC;
}

// Listing 2, adaptive: number of cells on a line, one sample each; not a whole number
//   Cells are `spacing` pixels long, or longer where maxSamples of them would not fill the line.
//
//      |---|---|---|---|-|     4.2 cells, 5 samples: the last cell grows from nothing as the line does, so that the
//        ^   ^   ^   ^  ^      result has no step where the number of samples has one
//
float BokehCells(float lengthInPixels, float spacing, int maxSamples)
{
    float cells = float(maxSamples);
    if (spacing > 0.0)
    {
        cells = clamp(lengthInPixels / spacing, 1.0, float(maxSamples));
    }
    return cells;
}

// Listing 2, adaptive: sample i of a line of so many cells
//   phase         place in the cell, 0.5 = in its middle
//   returns       x = place on the line, in cells from its middle; y = length of the cell, which is the sample's weight
//                 A cell behind the end has the length 0: fxc has been seen to lose the break of the loop around it.
vec2 BokehCell(float cells, int i, float phase)
{
    float low = min(float(i), cells);
    float high = min(low + 1.0, cells);
    return vec2(low + (high - low) * phase - 0.5 * cells, high - low);
}

// Listing 2, adaptive: interleaved gradient noise (Jimenez 2014), another number for each pixel and frame
//   imageWidth, imageHeight  pixels
//   frame         number of the frame; give each pass of a frame a number of its own
//   returns       -0.5 .. 0.5
float BokehNoise(vec2 uv, float imageWidth, float imageHeight, float frame)
{
    float shift = 5.588238 * (frame - 64.0 * floor(frame / 64.0));
    vec2 pixel = floor(uv * vec2(imageWidth, imageHeight)) + vec2(shift, shift);
    float seed = dot(pixel, vec2(0.06711056, 0.00583715));
    float value = 52.9829189 * (seed - floor(seed));
    return value - floor(value) - 0.5;
}

// Listing 2, adaptive: a line of any length, off the pixel as well, for BokehDepthOfFieldAdaptive
//   angle         radians
//   lineLength    in units of the CoC
//   lineCenter    its middle, in units of the CoC from this pixel, x to the right, y towards the last row
//   squeeze       width of the bokeh / its height, 1 = round
//   returns       xy = middle, zw = from the middle to the end, in units of the CoC; BokehPolygonEdge returns the same
vec4 BokehSegment(float angle, float lineLength, vec2 lineCenter, float squeeze)
{
    vec4 segment = vec4(lineCenter, 0.5 * lineLength * cos(angle), 0.5 * lineLength * sin(angle));
    return segment * vec4(squeeze, 1.0, squeeze, 1.0);
}

// ---------------------------------------------------------------------------------------------------------------------
// [5] Listing 3: one pass of the line filter
// ---------------------------------------------------------------------------------------------------------------------

// Listing 3: weight of one sample against intensity leakage (section 2.1)
//   A sample that is nearer to the camera and clearly sharper than this pixel would leak onto it. It counts by its own
//   CoC then: not at all when in focus, fully from a CoC of 1 / bleedingMult up. All other samples count fully.
//   bleedingBias  CoC difference that is still let pass, fraction of the image height; 1 or more turns the test off
//   bleedingMult  weight for each unit of CoC
//   returns       0 .. 1
float BokehLeakageWeight(float sampleDepth, float sampleCoC, float centerDepth, float centerCoC, float bleedingBias,
    float bleedingMult)
{
    float weight = 1.0;
    if (sampleDepth < centerDepth && centerCoC > sampleCoC + bleedingBias)
    {
        weight = clamp(sampleCoC * bleedingMult, 0.0, 1.0);
    }
    return weight;
}

// Listing 3: the weighted average, or this pixel where there is none
//   Every sample may have been rejected when their number is even: the middle of the line is not sampled then.
//   blurCoC       true: the CoC is averaged with the colour; false: this pixel keeps its CoC (Figure 7)
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
//   ColorSamp     rgb = linear HDR colour, a = CoC: from BokehCoCMap or from an earlier pass; linear filter, clamp
//   DepthSamp     r = depth, the same as in BokehCoCMap; nearest filter, clamp
//   lineEnd       from BokehLineEnd
//   numSamples    samples on the line, 2 or more; 254 at most in shader model 3
vec4 BokehDepthOfField(sampler2D ColorSamp, sampler2D DepthSamp, vec2 uv, vec2 lineEnd, int numSamples,
    float bleedingBias, float bleedingMult, bool blurCoC)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    for (int i = 0; i < numSamples; i++)
    {
        vec2 sampleCoords = uv + BokehMakeOffsets(lineEnd, i, numSamples) * centerPixel.a;
        vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
        float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
        float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a, bleedingBias,
            bleedingMult);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Listing 3, adaptive: the mean along one segment, as many samples as it needs
//   CoC           from BokehFilterCoC, > 0
//   centerPixel   this pixel, which the leakage test compares with
//   segment       from BokehSegment or BokehPolygonEdge
//   aspectRatio   width / height of the image
//   imageHeight   pixels
//   spacing       pixels between samples, 1 is right for most; 0: exactly maxSamples
//   maxSamples    2 or more; 254 at most in shader model 3
//   jitter        from BokehNoise, times its amount; 0 = none. It acts where samples are farther apart than a pixel.
vec4 BokehLineMean(sampler2D ColorSamp, sampler2D DepthSamp, vec2 uv, vec4 segment, float CoC,
    vec4 centerPixel, float centerDepth, float aspectRatio, float imageHeight, float spacing, int maxSamples,
    float jitter, float bleedingBias, float bleedingMult)
{
    float lengthInPixels = 2.0 * length(segment.zw) * CoC * imageHeight;
    float cells = BokehCells(lengthInPixels, spacing, maxSamples);
    int count = min(int(ceil(cells)), maxSamples);
    float phase = 0.5 + jitter * clamp(lengthInPixels / cells - 1.0, 0.0, 1.0);
    vec2 scale = vec2(CoC / aspectRatio, CoC);
    vec2 middle = uv + segment.xy * scale;
    vec2 cellLength = segment.zw * scale * (2.0 / cells);
    vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    for (int i = 0; i < maxSamples; i++)
    {
        if (i >= count)
        {
            break;
        }
        vec2 cell = BokehCell(cells, i, phase);
        vec2 sampleCoords = middle + cellLength * cell.x;
        vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
        float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
        float leakageWeight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            bleedingBias, bleedingMult);
        float weight = cell.y * leakageWeight;
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, true);
}

// Listing 3, adaptive: DepthOfField with as many samples as the local CoC needs (the paper's future work)
//   Parameters as in BokehLineMean and BokehDepthOfField. In focus it costs one fetch of each texture.
vec4 BokehDepthOfFieldAdaptive(sampler2D ColorSamp, sampler2D DepthSamp, vec2 uv, vec4 segment,
    float aspectRatio, float imageHeight, float spacing, int maxSamples, float jitter, float bleedingBias,
    float bleedingMult, bool blurCoC)
{
    vec4 result = BokehFetch(ColorSamp, uv);
    float CoC = BokehFilterCoC(result.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
        vec4 mean = BokehLineMean(ColorSamp, DepthSamp, uv, segment, CoC,
            result, centerDepth, aspectRatio, imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        result = BokehResolve(mean, 1.0, result, blurCoC);
    }
    return result;
}

// ---------------------------------------------------------------------------------------------------------------------
// [6] Listing 4: combine by min / max
// ---------------------------------------------------------------------------------------------------------------------

// Listing 4: intersection (min) or union (max) of two parallelogram blurs, CoC included (section 4.5)
vec4 BokehCombine(vec4 a, vec4 b, bool useMax)
{
    vec4 result = min(a, b);
    if (useMax)
    {
        result = max(a, b);
    }
    return result;
}

// Listing 4: DepthOfFieldFinal, the last line pass of the second parallelogram, combined with the first
//   ColorSampA    input of this line pass, as ColorSamp of BokehDepthOfField
//   ColorSampB    the finished first parallelogram
//   useMax        false: min, polygons; true: max, stars
vec4 BokehDepthOfFieldFinal(sampler2D ColorSampA, sampler2D DepthSamp, vec2 uv, vec2 lineEnd, int numSamples,
    float bleedingBias, float bleedingMult, bool blurCoC, sampler2D ColorSampB, bool useMax)
{
    vec4 a = BokehDepthOfField(ColorSampA, DepthSamp, uv, lineEnd, numSamples, bleedingBias, bleedingMult, blurCoC);
    vec4 b = BokehFetch(ColorSampB, uv);
    return BokehCombine(a, b, useMax);
}

// ---------------------------------------------------------------------------------------------------------------------
// [7] naive gather
// ---------------------------------------------------------------------------------------------------------------------

// Section 3: gather with any table of 2D offsets
//   KernelSamp    numSamples x 1 texels: rg = offset in units of the CoC, x to the right, y towards the last row;
//                 32-bit float, nearest filter. A texture, since SM3 pixel shaders cannot index their constants.
//   aspectRatio   width / height of the image
vec4 BokehNaiveGather(sampler2D ColorSamp, sampler2D DepthSamp, sampler2D KernelSamp, vec2 uv, float aspectRatio,
    int numSamples, float bleedingBias, float bleedingMult, bool blurCoC)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    vec2 scale = vec2(centerPixel.a / aspectRatio, centerPixel.a);
    vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    // Two loops, since a loop of shader model 3 ends after 255 turns.
    for (int start = 0; start < numSamples; start += 128)
    {
        for (int i = start; i < min(start + 128, numSamples); i++)
        {
            vec2 kernelCoords = vec2((float(i) + 0.5) / float(numSamples), 0.5);
            vec2 sampleCoords = uv + BokehFetchTable(KernelSamp, kernelCoords).rg * scale;
            vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
            float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
            float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a, bleedingBias,
                bleedingMult);
            color += samplePixel * weight;
            totalWeight += weight;
        }
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Section 3: gather over a parallelogram grid of side x side samples, offsets computed instead of read (Table 1)
//   lineEndU, lineEndV  the two sides, from BokehLineEnd
//   side                samples along a side, 2 or more; 4, 8, 12, 16, 20, 24 for the counts of Table 1
vec4 BokehNaiveGrid(sampler2D ColorSamp, sampler2D DepthSamp, vec2 uv, vec2 lineEndU, vec2 lineEndV, int side,
    float bleedingBias, float bleedingMult, bool blurCoC)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    vec4 color = vec4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    for (int j = 0; j < side; j++)
    {
        vec2 rowCoords = uv + BokehMakeOffsets(lineEndV, j, side) * centerPixel.a;
        for (int i = 0; i < side; i++)
        {
            vec2 sampleCoords = rowCoords + BokehMakeOffsets(lineEndU, i, side) * centerPixel.a;
            vec4 samplePixel = BokehFetch(ColorSamp, sampleCoords);
            float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
            float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a, bleedingBias,
                bleedingMult);
            color += samplePixel * weight;
            totalWeight += weight;
        }
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// ---------------------------------------------------------------------------------------------------------------------
// [8] exact polygons
// ---------------------------------------------------------------------------------------------------------------------
//
//   A regular polygon with an even number of sides is cut into parallelograms that do not overlap. Their blurs are
//   ADDED: no light is lost as by min, and highlights that overlap add up. The first pass blurs along all edges of one
//   half of the outline but the last, the second pass along all but the first. docs/apertures.md has the proof.
//
//           edge 2                  edges 1, 2, 3 of a hexagon; the other half of the outline is the same, turned.
//          ,-' '-,  edge 1          first pass   T2 = blur along 1;  T3 = blurs along 1 and 2, weighed
//   edge 3 |     |                  second pass  T2 blurred along 2, T3 along 3, weighed: 1/3 + 2/3
//          '-, ,-'
//
//   sides       targets of the first pass   textures of the second
//   4           1                           ColorSamp
//   6           2                           ColorSamp, ColorSampB
//   8           3                           ColorSamp .. ColorSampC
//   10          4                           ColorSamp .. ColorSampD
//
//   Give `sides` as a literal: what it does not need is then compiled away. Without several targets, BokehExactEdge
//   makes them one by one, each from the two before it.
//   Corners lie on the circle of confusion. Rotation 0 has an edge upright at the right, as `paper` has it.

// Exact: a vector turned by an angle, from +x towards +y
vec2 BokehTurned(vec2 direction, float angle)
{
    float c = cos(angle);
    float s = sin(angle);
    return vec2(direction.x * c - direction.y * s, direction.x * s + direction.y * c);
}

// Exact: the line of edge k in one of the two passes
//   Where both passes put it on the outline, every sample of the first pass is on one side of the pixel. So the first
//   pass is moved by the mean of its lines to the middle, and the second pass back.
//   k             1 .. sides / 2
//   sides         4, 6, 8 or 10
//   axis          (cos, sin) of the rotation
//   squeeze       width of the bokeh / its height, 1 = round
//   secondPass    false: first pass
//   returns       xy = middle, zw = from the middle to the end; in units of the CoC, x to the right
vec4 BokehPolygonEdge(float k, float sides, vec2 axis, float squeeze, bool secondPass)
{
    float halfStep = 3.14159265 / sides;
    vec2 outwards = BokehTurned(axis, 2.0 * halfStep * k);
    vec2 meanOfFirst = vec2(-axis.y, axis.x) * (0.5 * cos(halfStep) * cos(halfStep) / (sin(halfStep) *
        (0.5 * sides - 1.0)));
    vec2 middle = outwards * (0.5 * cos(halfStep)) - meanOfFirst;
    if (secondPass)
    {
        middle = -middle - BokehTurned(axis, halfStep) * 0.5;
    }
    vec2 halfEdge = vec2(-outwards.y, outwards.x) * (0.5 * sin(halfStep));
    return vec4(middle, halfEdge) * vec4(squeeze, 1.0, squeeze, 1.0);
}

// Exact: area of all parallelograms between edge k and the edges before it, in units of a rhombus with a right angle
float BokehExactWeight(float k, float sides)
{
    float halfStep = 3.14159265 / sides;
    return sin(k * halfStep) * sin((k - 1.0) * halfStep) / sin(halfStep);
}

// Exact: what the first pass writes for edge k: the blurs along the edges before it, weighed by their parallelograms
//   B1 .. B4      blurs along edges 1 to 4; those from k on count nothing
//   CoC           of this pixel, which goes to the alpha: the second pass blurs by the unblurred CoC
vec4 BokehExactTarget(float k, float sides, vec4 B1, vec4 B2, vec4 B3, vec4 B4, float CoC)
{
    float turn = 6.28318531 / sides;
    float w1 = sin((k - 1.0) * turn);
    float w2 = max(sin((k - 2.0) * turn), 0.0);
    float w3 = max(sin((k - 3.0) * turn), 0.0);
    float w4 = max(sin((k - 4.0) * turn), 0.0);
    vec4 mean = (B1 * w1 + B2 * w2 + B3 * w3 + B4 * w4) / (w1 + w2 + w3 + w4);
    return vec4(mean.rgb, CoC);
}

// Exact: first pass
//   ColorSamp     from BokehCoCMap; linear filter, clamp
//   DepthSamp     r = depth, the same as in BokehCoCMap; nearest filter, clamp
//   sides         4, 6, 8 or 10, a literal
//   rotation      radians
//   squeeze       width of the bokeh / its height: 1, or 0.5 for the oval of an anamorphic lens
//   aspectRatio, imageHeight, spacing, maxSamples, jitter  as in BokehLineMean
//   returns       T[0] .. T[3]: what targets 0 to 3 get, as many as the table above says
mat4 BokehExactFirst(sampler2D ColorSamp, sampler2D DepthSamp, vec2 uv, float sides, float rotation,
    float squeeze, float aspectRatio, float imageHeight, float spacing, int maxSamples, float jitter,
    float bleedingBias, float bleedingMult)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    mat4 result = mat4(centerPixel, centerPixel, centerPixel, centerPixel);
    float CoC = BokehFilterCoC(centerPixel.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
        vec2 axis = vec2(cos(rotation), sin(rotation));
        vec4 B1 = BokehLineMean(ColorSamp, DepthSamp, uv,
            BokehPolygonEdge(1.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
            imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        vec4 T2 = vec4(B1.rgb, centerPixel.a);
        vec4 B2 = centerPixel;
        vec4 B3 = centerPixel;
        vec4 T3 = centerPixel;
        vec4 T4 = centerPixel;
        vec4 T5 = centerPixel;
        if (sides > 5.0)
        {
            B2 = BokehLineMean(ColorSamp, DepthSamp, uv,
                BokehPolygonEdge(2.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
            T3 = BokehExactTarget(3.0, sides, B1, B2, B3, B3, centerPixel.a);
        }
        if (sides > 7.0)
        {
            B3 = BokehLineMean(ColorSamp, DepthSamp, uv,
                BokehPolygonEdge(3.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
            T4 = BokehExactTarget(4.0, sides, B1, B2, B3, B3, centerPixel.a);
        }
        if (sides > 9.0)
        {
            vec4 B4 = BokehLineMean(ColorSamp, DepthSamp, uv,
                BokehPolygonEdge(4.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
            T5 = BokehExactTarget(5.0, sides, B1, B2, B3, B4, centerPixel.a);
        }
        result = mat4(T2, T3, T4, T5);
    }
    return result;
}

// Exact: second pass, the finished polygon
//   ColorSamp .. ColorSampD  targets 0 to 3 of the first pass; linear filter, clamp. Where there are fewer, give any
//                            texture for the rest: it is not read.
//   The other parameters as in BokehExactFirst.
//   returns       rgb = colour, a = CoC of this pixel, as BokehCoCMap made it
vec4 BokehExactSecond(sampler2D ColorSamp, sampler2D ColorSampB, sampler2D ColorSampC,
    sampler2D ColorSampD, sampler2D DepthSamp, vec2 uv, float sides, float rotation, float squeeze,
    float aspectRatio, float imageHeight, float spacing, int maxSamples, float jitter, float bleedingBias,
    float bleedingMult)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    vec4 result = centerPixel;
    float CoC = BokehFilterCoC(centerPixel.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
        vec2 axis = vec2(cos(rotation), sin(rotation));
        float weight = BokehExactWeight(2.0, sides);
        float totalWeight = weight;
        vec4 sum = weight * BokehLineMean(ColorSamp, DepthSamp, uv,
            BokehPolygonEdge(2.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
            imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        if (sides > 5.0)
        {
            weight = BokehExactWeight(3.0, sides);
            totalWeight += weight;
            sum += weight * BokehLineMean(ColorSampB, DepthSamp, uv,
                BokehPolygonEdge(3.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        }
        if (sides > 7.0)
        {
            weight = BokehExactWeight(4.0, sides);
            totalWeight += weight;
            sum += weight * BokehLineMean(ColorSampC, DepthSamp, uv,
                BokehPolygonEdge(4.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        }
        if (sides > 9.0)
        {
            weight = BokehExactWeight(5.0, sides);
            totalWeight += weight;
            sum += weight * BokehLineMean(ColorSampD, DepthSamp, uv,
                BokehPolygonEdge(5.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        }
        result = vec4(sum.rgb / totalWeight, centerPixel.a);
    }
    return result;
}

// Exact: one target of the first pass, where a pass can write but one
//   Call it for k = 1 .. sides / 2 - 1: it makes the target of edge k + 1 by blurring along edge k. The blurs before
//   that one are not blurred again, since sin((m + 1) a) = 2 cos(a) sin(m a) - sin((m - 1) a).
//   PreviousSamp  what k - 1 made; not read for k = 1
//   EarlierSamp   what k - 2 made; not read for k = 1 and 2
//   The other parameters as in BokehExactFirst.
vec4 BokehExactEdge(sampler2D ColorSamp, sampler2D DepthSamp, sampler2D PreviousSamp,
    sampler2D EarlierSamp, vec2 uv, float k, float sides, float rotation, float squeeze, float aspectRatio,
    float imageHeight, float spacing, int maxSamples, float jitter, float bleedingBias, float bleedingMult)
{
    vec4 centerPixel = BokehFetch(ColorSamp, uv);
    vec4 result = centerPixel;
    float CoC = BokehFilterCoC(centerPixel.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
        vec2 axis = vec2(cos(rotation), sin(rotation));
        float turn = 6.28318531 / sides;
        vec4 sum = sin(turn) * BokehLineMean(ColorSamp, DepthSamp, uv,
            BokehPolygonEdge(k, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio, imageHeight,
            spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        if (k > 1.5)
        {
            sum += 2.0 * cos(turn) * BokehExactWeight(k, sides) * BokehFetch(PreviousSamp, uv);
        }
        if (k > 2.5)
        {
            sum -= BokehExactWeight(k - 1.0, sides) * BokehFetch(EarlierSamp, uv);
        }
        vec4 most = vec4(BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR);
        sum = clamp(sum / BokehExactWeight(k + 1.0, sides), vec4(0.0, 0.0, 0.0, 0.0), most);
        result = vec4(sum.rgb, centerPixel.a);
    }
    return result;
}

// ---------------------------------------------------------------------------------------------------------------------
// [9] debug views
// ---------------------------------------------------------------------------------------------------------------------

// Debug: linear depth as grey: black at the camera, 0.5 at the focus distance, white at infinity
vec4 BokehDebugDepth(float S2, float S1)
{
    float grey = S2 / (S2 + S1);
    return vec4(grey, grey, grey, 1.0);
}

// Debug: CoC as grey: black in focus, white at MaxCoC
vec4 BokehDebugCoC(float CoC, float MaxCoC)
{
    float grey = clamp(CoC / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    return vec4(grey, grey, grey, 1.0);
}

// Debug: which side of the focus: near field orange, far field blue, in focus black; brighter with the CoC
vec4 BokehDebugFocus(float S2, float S1, float CoC, float MaxCoC)
{
    float amount = clamp(CoC / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    vec4 result = vec4(0.1 * amount, 0.4 * amount, amount, 1.0);
    if (S2 < S1)
    {
        result = vec4(amount, 0.5 * amount, 0.0, 1.0);
    }
    return result;
}
