// SPDX-License-Identifier: MIT
//
// Polygonal bokeh depth of field, WGSL. Version 0.1.0.
// After McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures in a Post-Process
// Depth of Field Shader", Listings 1-4. Sections and figures named below are of that paper.
//
// CONTRACT
//   This file holds functions only: no bindings, no entry points. bokeh_passes.wgsl beside it has those, ready made.
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
// PASTE: put this file before your shader; each texture is followed by its sampler. For one line pass write
//           @fragment fn main(@location(0) uv: vec2f) -> @location(0) vec4f {
//               return BokehDepthOfField(ColorTex, LinearClamp, DepthTex, NearestClamp, uv,
//                   BokehLineEnd(angle, aspectRatio), BOKEH_NUM_SAMPLES, BOKEH_BLEEDING_BIAS, BOKEH_BLEEDING_MULT,
//                   true); }
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
//   BOKEH_NUM_SAMPLES     13         2 ..      samples on a line (section 4.3); an override constant
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

override BOKEH_NUM_SAMPLES: i32 = 13;
override BOKEH_ADAPTIVE_SAMPLES: f32 = 1.0;
override BOKEH_VIEWPORT: f32 = 0.0;
const BOKEH_SENSOR_HEIGHT: f32 = 0.024;
const BOKEH_MAX_COC: f32 = 0.1;
const BOKEH_BLEEDING_BIAS: f32 = 0.02;
const BOKEH_BLEEDING_MULT: f32 = 30.0;
const BOKEH_MAX_COLOR: f32 = 65504.0;
const BOKEH_MIN_DEPTH: f32 = 0.000001;
const BOKEH_MAX_DEPTH: f32 = 1000000000.0;

// ---------------------------------------------------------------------------------------------------------------------
// [2] porting: the one place where the three languages differ
// ---------------------------------------------------------------------------------------------------------------------
//
//   A texture and its sampler travel as two parameters, Name and NameSampler.

// where the image lies in its textures, in their uv: xy = its corner, zw = its size; then the bounds of the fetches
var<private> BokehViewport: vec4f = vec4f(0.0, 0.0, 1.0, 1.0);
var<private> BokehViewportBounds: vec4f = vec4f(0.0, 0.0, 1.0, 1.0);

// Porting: the image is a part of its textures (dynamic resolution); call it before all else, with BOKEH_VIEWPORT 1.0
//   Every texture but the kernel is laid out like this. What is around the image is not read: it may hold anything.
//   The bounds are 1/128 texel inside of the centres of the outermost texels, since a linear filter counts a texel
//   with a weight of 0 in, and 0 times NaN is NaN; 1/256 is how exactly devices place a sample (Direct3D 11, Vulkan).
//   viewport      x, y of its first pixel, width, height; pixels, 2 x 2 or more
//   textureSize   width, height; pixels
fn BokehSetViewport(viewport: vec4f, textureSize: vec2f)
{
    if (BOKEH_VIEWPORT > 0.5)
    {
        let inset: vec2f = min(vec2f(0.5078125, 0.5078125), viewport.zw * 0.5);
        BokehViewport = viewport / textureSize.xyxy;
        BokehViewportBounds = vec4f(viewport.xy + inset, viewport.xy + viewport.zw - inset) / textureSize.xyxy;
    }
}

// Porting: place in the image to place in its textures
fn BokehToTexture(uv: vec2f) -> vec2f
{
    var coords: vec2f = uv;
    if (BOKEH_VIEWPORT > 0.5)
    {
        coords = clamp(BokehViewport.xy + uv * BokehViewport.zw, BokehViewportBounds.xy, BokehViewportBounds.zw);
    }
    return coords;
}

// Porting: one texel fetch at level 0, without gradients, so that it may stand in a loop or a branch
fn BokehFetch(tex: texture_2d<f32>, texSampler: sampler, uv: vec2f) -> vec4f
{
    return textureSampleLevel(tex, texSampler, BokehToTexture(uv), 0.0);
}

// Porting: the same for textures with a nearest filter, which is depth
//   A function of its own, since WebGPU may take every texture that a function is given to meet every sampler.
fn BokehFetchNearest(tex: texture_2d<f32>, texSampler: sampler, uv: vec2f) -> vec4f
{
    return textureSampleLevel(tex, texSampler, BokehToTexture(uv), 0.0);
}

// Porting: the same for tables, which no viewport applies to
fn BokehFetchTable(tex: texture_2d<f32>, texSampler: sampler, uv: vec2f) -> vec4f
{
    return textureSampleLevel(tex, texSampler, uv, 0.0);
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
fn BokehCoC(S2: f32, A: f32, f: f32, S1: f32, sensorHeight: f32, MaxCoC: f32) -> f32
{
    let focus: f32 = min(S1, BOKEH_MAX_DEPTH);
    let magnification: f32 = f / max(focus - f, BOKEH_MIN_DEPTH);
    let c: f32 = A * magnification * (abs(S2 - focus) / S2);
    return clamp(c / max(sensorHeight, BOKEH_MIN_DEPTH), 0.0, MaxCoC);
}

// Listing 1: one colour channel made safe: NaN and negative become 0, infinite becomes the largest half float
//   NaN fails this comparison; max() may return either operand. It is >= since shader model 3 has no other: > there
//   is the opposite comparison with its two results swapped, and NaN passes that.
fn BokehSafeChannel(value: f32) -> f32
{
    var safe: f32 = 0.0;
    if (value >= 0.0)
    {
        safe = min(value, BOKEH_MAX_COLOR);
    }
    return safe;
}

// Listing 1: depth made safe: NaN, zero and negative become the smallest depth, infinite the largest
fn BokehSafeDepth(S2: f32) -> f32
{
    var safe: f32 = BOKEH_MIN_DEPTH;
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
fn BokehDepthFromWindow(depth: f32, zNear: f32, zFar: f32) -> f32
{
    return zNear * zFar / (zFar - depth * (zFar - zNear));
}

// Depth: reversed window depth, 1 (near) .. 0 (far), of a perspective camera to metres
fn BokehDepthFromReversed(depth: f32, zNear: f32, zFar: f32) -> f32
{
    return zNear * zFar / (zNear + depth * (zFar - zNear));
}

// Depth: reversed window depth without a far plane, 1 (near) .. 0 (infinite), to metres; the sky is at BOKEH_MAX_DEPTH
fn BokehDepthFromInfinite(depth: f32, zNear: f32) -> f32
{
    var stored: f32 = zNear / BOKEH_MAX_DEPTH;
    if (depth >= stored)
    {
        stored = depth;
    }
    return zNear / stored;
}

// Depth: depth of clip space, -1 (near) .. 1 (far), z / w in OpenGL, to metres
fn BokehDepthFromClip(depth: f32, zNear: f32, zFar: f32) -> f32
{
    return 2.0 * zNear * zFar / (zFar + zNear - depth * (zFar - zNear));
}

// Depth: window depth 0 (near) .. 1 (far) of an orthographic camera to metres; give 1 - depth where it is reversed
fn BokehDepthFromOrthographic(depth: f32, zNear: f32, zFar: f32) -> f32
{
    return zNear + depth * (zFar - zNear);
}

// Depth: a fraction of the far plane's distance to metres, as Listing 1 has it
fn BokehDepthFromFraction(depth: f32, zFar: f32) -> f32
{
    return depth * zFar;
}

// Depth: logarithmic depth, log(1 + metres) / log(1 + zFar), to metres (three.js's WebGLRenderer)
fn BokehDepthFromLogarithmic(depth: f32, zFar: f32) -> f32
{
    var stored: f32 = 0.0;
    if (depth >= 0.0)
    {
        stored = depth;
    }
    return exp2(stored * log2(zFar + 1.0)) - 1.0;
}

// Depth: any of the above to metres, made safe, for one pass that makes depth linear
//   kind          0 metres already, 1 window, 2 reversed, 3 reversed infinite, 4 clip, 5 orthographic,
//                 6 orthographic reversed, 7 fraction of zFar, 8 logarithmic
fn BokehLinearDepth(depth: f32, kind: f32, zNear: f32, zFar: f32) -> f32
{
    var S2: f32 = depth;
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
fn BokehPackCoC(color: vec4f, CoC: f32) -> vec4f
{
    return vec4f(BokehSafeChannel(color.r), BokehSafeChannel(color.g), BokehSafeChannel(color.b), CoC);
}

// Listing 1: CoCMap, the first pass and the only one that sees the engine's raw colour
//   ColorSamp     linear HDR scene colour
//   DepthSamp     r = depth along the view axis, metres (docs/inputs.md has the depth conventions)
//   uv            centre of this pixel, 0 .. 1, v = 0 at the first row in memory
//   returns       rgb = colour, a = CoC
fn BokehCoCMap(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, uv: vec2f, A: f32, f: f32, S1: f32, sensorHeight: f32, MaxCoC: f32) -> vec4f
{
    let S2: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
    let CoC: f32 = BokehCoC(S2, A, f, S1, sensorHeight, MaxCoC);
    return BokehPackCoC(BokehFetch(ColorSamp, ColorSampSampler, uv), CoC);
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
fn BokehLineEnd(angle: f32, aspectRatio: f32) -> vec2f
{
    return vec2f(0.5 * cos(angle) / aspectRatio, 0.5 * sin(angle));
}

// Listing 2: makeOffsets, sample i of numSamples evenly spaced from one end of the line to the other
//   Counted from the middle (-1 .. +1), so that the offsets are exact negatives of each other and the middle one is 0.
//   returns       uv offset for a CoC of 1
fn BokehMakeOffsets(lineEnd: vec2f, i: i32, numSamples: i32) -> vec2f
{
    let last: i32 = max(numSamples, 2) - 1;
    let t: f32 = f32(2 * i - last) / f32(last);
    return lineEnd * t;
}

// Listing 2, adaptive: the CoC that the filter uses, 0 where the pixel is in focus
//   Below half a pixel nothing is left to blur; up to one pixel it fades in, so that no contour shows.
//   spacing       pixels between samples; 0 or less: a fixed number of samples, and the CoC as it is
//   returns       fraction of the image height
fn BokehFilterCoC(CoC: f32, imageHeight: f32, spacing: f32) -> f32
{
    var filterCoC: f32 = CoC;
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
fn BokehCells(lengthInPixels: f32, spacing: f32, maxSamples: i32) -> f32
{
    var cells: f32 = f32(maxSamples);
    if (spacing > 0.0)
    {
        cells = clamp(lengthInPixels / spacing, 1.0, f32(maxSamples));
    }
    return cells;
}

// Listing 2, adaptive: sample i of a line of so many cells
//   phase         place in the cell, 0.5 = in its middle
//   returns       x = place on the line, in cells from its middle; y = length of the cell, which is the sample's weight
//                 A cell behind the end has the length 0: fxc has been seen to lose the break of the loop around it.
fn BokehCell(cells: f32, i: i32, phase: f32) -> vec2f
{
    let low: f32 = min(f32(i), cells);
    let high: f32 = min(low + 1.0, cells);
    return vec2f(low + (high - low) * phase - 0.5 * cells, high - low);
}

// Listing 2, adaptive: interleaved gradient noise (Jimenez 2014), another number for each pixel and frame
//   imageWidth, imageHeight  pixels
//   frame         number of the frame; give each pass of a frame a number of its own
//   returns       -0.5 .. 0.5
fn BokehNoise(uv: vec2f, imageWidth: f32, imageHeight: f32, frame: f32) -> f32
{
    let shift: f32 = 5.588238 * (frame - 64.0 * floor(frame / 64.0));
    let pixel: vec2f = floor(uv * vec2f(imageWidth, imageHeight)) + vec2f(shift, shift);
    let seed: f32 = dot(pixel, vec2f(0.06711056, 0.00583715));
    let value: f32 = 52.9829189 * (seed - floor(seed));
    return value - floor(value) - 0.5;
}

// Listing 2, adaptive: a line of any length, off the pixel as well, for BokehDepthOfFieldAdaptive
//   angle         radians
//   lineLength    in units of the CoC
//   lineCenter    its middle, in units of the CoC from this pixel, x to the right, y towards the last row
//   squeeze       width of the bokeh / its height, 1 = round
//   returns       xy = middle, zw = from the middle to the end, in units of the CoC; BokehPolygonEdge returns the same
fn BokehSegment(angle: f32, lineLength: f32, lineCenter: vec2f, squeeze: f32) -> vec4f
{
    let segment: vec4f = vec4f(lineCenter, 0.5 * lineLength * cos(angle), 0.5 * lineLength * sin(angle));
    return segment * vec4f(squeeze, 1.0, squeeze, 1.0);
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
fn BokehLeakageWeight(sampleDepth: f32, sampleCoC: f32, centerDepth: f32, centerCoC: f32, bleedingBias: f32,
    bleedingMult: f32) -> f32
{
    var weight: f32 = 1.0;
    if (sampleDepth < centerDepth && centerCoC > sampleCoC + bleedingBias)
    {
        weight = clamp(sampleCoC * bleedingMult, 0.0, 1.0);
    }
    return weight;
}

// Listing 3: the weighted average, or this pixel where there is none
//   Every sample may have been rejected when their number is even: the middle of the line is not sampled then.
//   blurCoC       true: the CoC is averaged with the colour; false: this pixel keeps its CoC (Figure 7)
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

// Listing 3: DepthOfField, the mean of the samples along one line
//   ColorSamp     rgb = linear HDR colour, a = CoC: from BokehCoCMap or from an earlier pass; linear filter, clamp
//   DepthSamp     r = depth, the same as in BokehCoCMap; nearest filter, clamp
//   lineEnd       from BokehLineEnd
//   numSamples    samples on the line, 2 or more; 254 at most in shader model 3
fn BokehDepthOfField(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, uv: vec2f, lineEnd: vec2f, numSamples: i32, bleedingBias: f32, bleedingMult: f32,
    blurCoC: bool) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var i: i32 = 0; i < numSamples; i++)
    {
        let sampleCoords: vec2f = uv + BokehMakeOffsets(lineEnd, i, numSamples) * centerPixel.a;
        let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
        let sampleDepth: f32 = BokehFetchNearest(DepthSamp, DepthSampSampler, sampleCoords).r;
        var weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a, bleedingBias,
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
fn BokehLineMean(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, uv: vec2f, segment: vec4f, CoC: f32, centerPixel: vec4f, centerDepth: f32,
    aspectRatio: f32, imageHeight: f32, spacing: f32, maxSamples: i32, jitter: f32, bleedingBias: f32,
    bleedingMult: f32) -> vec4f
{
    let lengthInPixels: f32 = 2.0 * length(segment.zw) * CoC * imageHeight;
    let cells: f32 = BokehCells(lengthInPixels, spacing, maxSamples);
    let count: i32 = min(i32(ceil(cells)), maxSamples);
    let phase: f32 = 0.5 + jitter * clamp(lengthInPixels / cells - 1.0, 0.0, 1.0);
    let scale: vec2f = vec2f(CoC / aspectRatio, CoC);
    let middle: vec2f = uv + segment.xy * scale;
    let cellLength: vec2f = segment.zw * scale * (2.0 / cells);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var i: i32 = 0; i < maxSamples; i++)
    {
        if (i >= count)
        {
            break;
        }
        let cell: vec2f = BokehCell(cells, i, phase);
        let sampleCoords: vec2f = middle + cellLength * cell.x;
        let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
        let sampleDepth: f32 = BokehFetchNearest(DepthSamp, DepthSampSampler, sampleCoords).r;
        let leakageWeight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            bleedingBias, bleedingMult);
        let weight: f32 = cell.y * leakageWeight;
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, true);
}

// Listing 3, adaptive: DepthOfField with as many samples as the local CoC needs (the paper's future work)
//   Parameters as in BokehLineMean and BokehDepthOfField. In focus it costs one fetch of each texture.
fn BokehDepthOfFieldAdaptive(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, uv: vec2f, segment: vec4f, aspectRatio: f32, imageHeight: f32, spacing: f32,
    maxSamples: i32, jitter: f32, bleedingBias: f32, bleedingMult: f32, blurCoC: bool) -> vec4f
{
    var result: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    let CoC: f32 = BokehFilterCoC(result.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
        let mean: vec4f = BokehLineMean(ColorSamp, ColorSampSampler, DepthSamp, DepthSampSampler, uv, segment, CoC,
            result, centerDepth, aspectRatio, imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        result = BokehResolve(mean, 1.0, result, blurCoC);
    }
    return result;
}

// ---------------------------------------------------------------------------------------------------------------------
// [6] Listing 4: combine by min / max
// ---------------------------------------------------------------------------------------------------------------------

// Listing 4: intersection (min) or union (max) of two parallelogram blurs, CoC included (section 4.5)
fn BokehCombine(a: vec4f, b: vec4f, useMax: bool) -> vec4f
{
    var result: vec4f = min(a, b);
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
fn BokehDepthOfFieldFinal(ColorSampA: texture_2d<f32>, ColorSampASampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, uv: vec2f, lineEnd: vec2f, numSamples: i32, bleedingBias: f32, bleedingMult: f32,
    blurCoC: bool, ColorSampB: texture_2d<f32>, ColorSampBSampler: sampler, useMax: bool) -> vec4f
{
    let a: vec4f = BokehDepthOfField(ColorSampA, ColorSampASampler, DepthSamp, DepthSampSampler, uv, lineEnd,
        numSamples, bleedingBias, bleedingMult, blurCoC);
    let b: vec4f = BokehFetch(ColorSampB, ColorSampBSampler, uv);
    return BokehCombine(a, b, useMax);
}

// ---------------------------------------------------------------------------------------------------------------------
// [7] naive gather
// ---------------------------------------------------------------------------------------------------------------------

// Section 3: gather with any table of 2D offsets
//   KernelSamp    numSamples x 1 texels: rg = offset in units of the CoC, x to the right, y towards the last row;
//                 32-bit float, nearest filter. A texture, since SM3 pixel shaders cannot index their constants.
//   aspectRatio   width / height of the image
fn BokehNaiveGather(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, KernelSamp: texture_2d<f32>, KernelSampSampler: sampler, uv: vec2f, aspectRatio: f32,
    numSamples: i32, bleedingBias: f32, bleedingMult: f32, blurCoC: bool) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
    let scale: vec2f = vec2f(centerPixel.a / aspectRatio, centerPixel.a);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    // Two loops, since a loop of shader model 3 ends after 255 turns.
    for (var start: i32 = 0; start < numSamples; start += 128)
    {
        for (var i: i32 = start; i < min(start + 128, numSamples); i++)
        {
            let kernelCoords: vec2f = vec2f((f32(i) + 0.5) / f32(numSamples), 0.5);
            let sampleCoords: vec2f = uv + BokehFetchTable(KernelSamp, KernelSampSampler, kernelCoords).rg * scale;
            let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
            let sampleDepth: f32 = BokehFetchNearest(DepthSamp, DepthSampSampler, sampleCoords).r;
            var weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a, bleedingBias,
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
fn BokehNaiveGrid(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, uv: vec2f, lineEndU: vec2f, lineEndV: vec2f, side: i32, bleedingBias: f32,
    bleedingMult: f32, blurCoC: bool) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var j: i32 = 0; j < side; j++)
    {
        let rowCoords: vec2f = uv + BokehMakeOffsets(lineEndV, j, side) * centerPixel.a;
        for (var i: i32 = 0; i < side; i++)
        {
            let sampleCoords: vec2f = rowCoords + BokehMakeOffsets(lineEndU, i, side) * centerPixel.a;
            let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
            let sampleDepth: f32 = BokehFetchNearest(DepthSamp, DepthSampSampler, sampleCoords).r;
            var weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a, bleedingBias,
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
fn BokehTurned(direction: vec2f, angle: f32) -> vec2f
{
    let c: f32 = cos(angle);
    let s: f32 = sin(angle);
    return vec2f(direction.x * c - direction.y * s, direction.x * s + direction.y * c);
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
fn BokehPolygonEdge(k: f32, sides: f32, axis: vec2f, squeeze: f32, secondPass: bool) -> vec4f
{
    let halfStep: f32 = 3.14159265 / sides;
    let outwards: vec2f = BokehTurned(axis, 2.0 * halfStep * k);
    let meanOfFirst: vec2f = vec2f(-axis.y, axis.x) * (0.5 * cos(halfStep) * cos(halfStep) / (sin(halfStep) *
        (0.5 * sides - 1.0)));
    var middle: vec2f = outwards * (0.5 * cos(halfStep)) - meanOfFirst;
    if (secondPass)
    {
        middle = -middle - BokehTurned(axis, halfStep) * 0.5;
    }
    let halfEdge: vec2f = vec2f(-outwards.y, outwards.x) * (0.5 * sin(halfStep));
    return vec4f(middle, halfEdge) * vec4f(squeeze, 1.0, squeeze, 1.0);
}

// Exact: area of all parallelograms between edge k and the edges before it, in units of a rhombus with a right angle
fn BokehExactWeight(k: f32, sides: f32) -> f32
{
    let halfStep: f32 = 3.14159265 / sides;
    return sin(k * halfStep) * sin((k - 1.0) * halfStep) / sin(halfStep);
}

// Exact: what the first pass writes for edge k: the blurs along the edges before it, weighed by their parallelograms
//   B1 .. B4      blurs along edges 1 to 4; those from k on count nothing
//   CoC           of this pixel, which goes to the alpha: the second pass blurs by the unblurred CoC
fn BokehExactTarget(k: f32, sides: f32, B1: vec4f, B2: vec4f, B3: vec4f, B4: vec4f, CoC: f32) -> vec4f
{
    let turn: f32 = 6.28318531 / sides;
    let w1: f32 = sin((k - 1.0) * turn);
    let w2: f32 = max(sin((k - 2.0) * turn), 0.0);
    let w3: f32 = max(sin((k - 3.0) * turn), 0.0);
    let w4: f32 = max(sin((k - 4.0) * turn), 0.0);
    let mean: vec4f = (B1 * w1 + B2 * w2 + B3 * w3 + B4 * w4) / (w1 + w2 + w3 + w4);
    return vec4f(mean.rgb, CoC);
}

// Exact: first pass
//   ColorSamp     from BokehCoCMap; linear filter, clamp
//   DepthSamp     r = depth, the same as in BokehCoCMap; nearest filter, clamp
//   sides         4, 6, 8 or 10, a literal
//   rotation      radians
//   squeeze       width of the bokeh / its height: 1, or 0.5 for the oval of an anamorphic lens
//   aspectRatio, imageHeight, spacing, maxSamples, jitter  as in BokehLineMean
//   returns       T[0] .. T[3]: what targets 0 to 3 get, as many as the table above says
fn BokehExactFirst(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, uv: vec2f, sides: f32, rotation: f32, squeeze: f32, aspectRatio: f32, imageHeight: f32,
    spacing: f32, maxSamples: i32, jitter: f32, bleedingBias: f32, bleedingMult: f32) -> mat4x4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    var result: mat4x4f = mat4x4f(centerPixel, centerPixel, centerPixel, centerPixel);
    let CoC: f32 = BokehFilterCoC(centerPixel.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
        let axis: vec2f = vec2f(cos(rotation), sin(rotation));
        let B1: vec4f = BokehLineMean(ColorSamp, ColorSampSampler, DepthSamp, DepthSampSampler, uv,
            BokehPolygonEdge(1.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
            imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        let T2: vec4f = vec4f(B1.rgb, centerPixel.a);
        var B2: vec4f = centerPixel;
        var B3: vec4f = centerPixel;
        var T3: vec4f = centerPixel;
        var T4: vec4f = centerPixel;
        var T5: vec4f = centerPixel;
        if (sides > 5.0)
        {
            B2 = BokehLineMean(ColorSamp, ColorSampSampler, DepthSamp, DepthSampSampler, uv,
                BokehPolygonEdge(2.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
            T3 = BokehExactTarget(3.0, sides, B1, B2, B3, B3, centerPixel.a);
        }
        if (sides > 7.0)
        {
            B3 = BokehLineMean(ColorSamp, ColorSampSampler, DepthSamp, DepthSampSampler, uv,
                BokehPolygonEdge(3.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
            T4 = BokehExactTarget(4.0, sides, B1, B2, B3, B3, centerPixel.a);
        }
        if (sides > 9.0)
        {
            let B4: vec4f = BokehLineMean(ColorSamp, ColorSampSampler, DepthSamp, DepthSampSampler, uv,
                BokehPolygonEdge(4.0, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
            T5 = BokehExactTarget(5.0, sides, B1, B2, B3, B4, centerPixel.a);
        }
        result = mat4x4f(T2, T3, T4, T5);
    }
    return result;
}

// Exact: second pass, the finished polygon
//   ColorSamp .. ColorSampD  targets 0 to 3 of the first pass; linear filter, clamp. Where there are fewer, give any
//                            texture for the rest: it is not read.
//   The other parameters as in BokehExactFirst.
//   returns       rgb = colour, a = CoC of this pixel, as BokehCoCMap made it
fn BokehExactSecond(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, ColorSampB: texture_2d<f32>,
    ColorSampBSampler: sampler, ColorSampC: texture_2d<f32>, ColorSampCSampler: sampler, ColorSampD: texture_2d<f32>,
    ColorSampDSampler: sampler, DepthSamp: texture_2d<f32>, DepthSampSampler: sampler, uv: vec2f, sides: f32,
    rotation: f32, squeeze: f32, aspectRatio: f32, imageHeight: f32, spacing: f32, maxSamples: i32, jitter: f32,
    bleedingBias: f32, bleedingMult: f32) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    var result: vec4f = centerPixel;
    let CoC: f32 = BokehFilterCoC(centerPixel.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
        let axis: vec2f = vec2f(cos(rotation), sin(rotation));
        var weight: f32 = BokehExactWeight(2.0, sides);
        var totalWeight: f32 = weight;
        var sum: vec4f = weight * BokehLineMean(ColorSamp, ColorSampSampler, DepthSamp, DepthSampSampler, uv,
            BokehPolygonEdge(2.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
            imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        if (sides > 5.0)
        {
            weight = BokehExactWeight(3.0, sides);
            totalWeight += weight;
            sum += weight * BokehLineMean(ColorSampB, ColorSampBSampler, DepthSamp, DepthSampSampler, uv,
                BokehPolygonEdge(3.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        }
        if (sides > 7.0)
        {
            weight = BokehExactWeight(4.0, sides);
            totalWeight += weight;
            sum += weight * BokehLineMean(ColorSampC, ColorSampCSampler, DepthSamp, DepthSampSampler, uv,
                BokehPolygonEdge(4.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        }
        if (sides > 9.0)
        {
            weight = BokehExactWeight(5.0, sides);
            totalWeight += weight;
            sum += weight * BokehLineMean(ColorSampD, ColorSampDSampler, DepthSamp, DepthSampSampler, uv,
                BokehPolygonEdge(5.0, sides, axis, squeeze, true), CoC, centerPixel, centerDepth, aspectRatio,
                imageHeight, spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        }
        result = vec4f(sum.rgb / totalWeight, centerPixel.a);
    }
    return result;
}

// Exact: one target of the first pass, where a pass can write but one
//   Call it for k = 1 .. sides / 2 - 1: it makes the target of edge k + 1 by blurring along edge k. The blurs before
//   that one are not blurred again, since sin((m + 1) a) = 2 cos(a) sin(m a) - sin((m - 1) a).
//   PreviousSamp  what k - 1 made; not read for k = 1
//   EarlierSamp   what k - 2 made; not read for k = 1 and 2
//   The other parameters as in BokehExactFirst.
fn BokehExactEdge(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    DepthSampSampler: sampler, PreviousSamp: texture_2d<f32>, PreviousSampSampler: sampler,
    EarlierSamp: texture_2d<f32>, EarlierSampSampler: sampler, uv: vec2f, k: f32, sides: f32, rotation: f32,
    squeeze: f32, aspectRatio: f32, imageHeight: f32, spacing: f32, maxSamples: i32, jitter: f32, bleedingBias: f32,
    bleedingMult: f32) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    var result: vec4f = centerPixel;
    let CoC: f32 = BokehFilterCoC(centerPixel.a, imageHeight, spacing);
    if (CoC > 0.0)
    {
        let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, DepthSampSampler, uv).r);
        let axis: vec2f = vec2f(cos(rotation), sin(rotation));
        let turn: f32 = 6.28318531 / sides;
        var sum: vec4f = sin(turn) * BokehLineMean(ColorSamp, ColorSampSampler, DepthSamp, DepthSampSampler, uv,
            BokehPolygonEdge(k, sides, axis, squeeze, false), CoC, centerPixel, centerDepth, aspectRatio, imageHeight,
            spacing, maxSamples, jitter, bleedingBias, bleedingMult);
        if (k > 1.5)
        {
            sum += 2.0 * cos(turn) * BokehExactWeight(k, sides) * BokehFetch(PreviousSamp, PreviousSampSampler, uv);
        }
        if (k > 2.5)
        {
            sum -= BokehExactWeight(k - 1.0, sides) * BokehFetch(EarlierSamp, EarlierSampSampler, uv);
        }
        let most: vec4f = vec4f(BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR);
        sum = clamp(sum / BokehExactWeight(k + 1.0, sides), vec4f(0.0, 0.0, 0.0, 0.0), most);
        result = vec4f(sum.rgb, centerPixel.a);
    }
    return result;
}

// ---------------------------------------------------------------------------------------------------------------------
// [9] debug views
// ---------------------------------------------------------------------------------------------------------------------

// Debug: linear depth as grey: black at the camera, 0.5 at the focus distance, white at infinity
fn BokehDebugDepth(S2: f32, S1: f32) -> vec4f
{
    let grey: f32 = S2 / (S2 + S1);
    return vec4f(grey, grey, grey, 1.0);
}

// Debug: CoC as grey: black in focus, white at MaxCoC
fn BokehDebugCoC(CoC: f32, MaxCoC: f32) -> vec4f
{
    let grey: f32 = clamp(CoC / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    return vec4f(grey, grey, grey, 1.0);
}

// Debug: which side of the focus: near field orange, far field blue, in focus black; brighter with the CoC
fn BokehDebugFocus(S2: f32, S1: f32, CoC: f32, MaxCoC: f32) -> vec4f
{
    let amount: f32 = clamp(CoC / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    var result: vec4f = vec4f(0.1 * amount, 0.4 * amount, amount, 1.0);
    if (S2 < S1)
    {
        result = vec4f(amount, 0.5 * amount, 0.0, 1.0);
    }
    return result;
}
