// SPDX-License-Identifier: MIT
//
// Polygonal bokeh depth of field, WGSL. Version 0.2.0.
// After McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures
// in a Post-Process Depth of Field Shader", Listings 1-4. Sections and figures are of that paper.
//
// CONTRACT
//   This file holds functions only: no bindings, no entry points. bokeh_passes.wgsl beside it has
//   ready-made programs.
//   In    colour: linear, HDR, before bloom and tone mapping.
//         depth: along the view axis, metres.
//   Out   colour blurred by a polygonal aperture; alpha = CoC.
//   CoC   circle of confusion: a DIAMETER as a fraction of the image height. BokehSignedCoCMap
//         gives it a sign: below 0 the pixel is nearer than the focus.
//   uv    0 .. 1, v = 0 at the first row in memory. This file never flips.
//   Targets between the passes: RGBA16F, read with a linear filter and clamp; blending off, since
//   alpha is data. Depth: R32F, or whatever holds it; no filter is needed.
//
//   exact, for polygons with 4, 6, 8 or 10 sides: no min, no light lost, section [8]
//   colour + depth -> SignedCoCMap -> ExactFirst (1 to 4 targets) -> ExactSecond -> bloom
//
//   paper, Listings 1-4:
//   colour + depth -> CoCMap -> line passes (each reads the one before, and depth) -> combine
//
//   aperture   lines (degrees)                                passes   combine
//   square     0, then 90                                     2
//   diamond    0, then 45                                     2
//   hexagon    90, then 30 and, from the same, 150            3        min
//   octagon    0, then 90;  45, then 135                      4        min
//   star       as octagon                                     4        max
//
// PASTE: the whole effect as an exact hexagon, four passes. Each module is this file and one of
//   these blocks; the pipeline's layout may be 'auto'. Blending off in all of them. uv comes from
//   your vertex shader: 0 .. 1 over the target.
//
//   1. Linear depth. Depth: the depth buffer. Target: r32float.
//          struct Camera { zNear: f32, zFar: f32 }
//          @group(0) @binding(0) var<uniform> camera: Camera;
//          @group(0) @binding(1) var Depth: texture_2d<f32>;
//          @fragment fn linearDepth(@location(0) uv: vec2f) -> @location(0) f32
//          {
//              return BokehLinearDepth(BokehFetchNearest(Depth, uv).r, 1, camera.zNear,
//                  camera.zFar);
//          }
//
//   2. CoC map. Color: HDR colour. Depth: from 1. Target: rgba16float.
//          struct Lens { apertureDiameter: f32, focalLength: f32, focusDistance: f32 }
//          @group(0) @binding(0) var<uniform> lens: Lens;
//          @group(0) @binding(1) var Color: texture_2d<f32>;
//          @group(0) @binding(2) var Depth: texture_2d<f32>;
//          @fragment fn map(@location(0) uv: vec2f) -> @location(0) vec4f
//          {
//              return BokehSignedCoCMap(Color, Depth, uv, lens.apertureDiameter,
//                  lens.focalLength, lens.focusDistance, BOKEH_SENSOR_HEIGHT, BOKEH_MAX_COC);
//          }
//
//   3. First pass. Map: from 2. Linear: linear filter, clamp. Targets: two rgba16float.
//          struct Aperture { imageSize: vec2f, rotation: f32 }
//          struct Targets { @location(0) edge2: vec4f, @location(1) edge3: vec4f }
//          @group(0) @binding(0) var<uniform> aperture: Aperture;
//          @group(0) @binding(1) var Map: texture_2d<f32>;
//          @group(0) @binding(2) var Linear: sampler;
//          @fragment fn first(@location(0) uv: vec2f) -> Targets
//          {
//              let targets = BokehExactFirst(Map, Linear, uv,
//                  BokehMakePolygon(6, aperture.rotation, 1.0),
//                  BokehDefaultFilter(aperture.imageSize));
//              return Targets(targets.edge2, targets.edge3);
//          }
//
//   4. Second pass. Edge2, Edge3: from 3. Linear: linear filter, clamp. Target: rgba16float.
//          struct Aperture { imageSize: vec2f, rotation: f32 }
//          @group(0) @binding(0) var<uniform> aperture: Aperture;
//          @group(0) @binding(1) var Edge2: texture_2d<f32>;
//          @group(0) @binding(2) var Edge3: texture_2d<f32>;
//          @group(0) @binding(3) var Linear: sampler;
//          @fragment fn second(@location(0) uv: vec2f) -> @location(0) vec4f
//          {
//              return BokehExactSecond(Edge2, Linear, Edge3, Edge3, Edge3, uv,
//                  BokehMakePolygon(6, aperture.rotation, 1.0),
//                  BokehDefaultFilter(aperture.imageSize));
//          }
//
// CONTENTS
//   [1] configuration
//   [2] porting: BokehSetViewport, BokehFetch, BokehFetchNearest, BokehFetchTable
//   [3] circle of confusion: BokehCoC, BokehLinearDepth, BokehCoCMap, BokehSignedCoCMap
//   [4] sample offsets: BokehLineEnd, BokehMakeOffsets; adaptive: BokehFilter,
//       BokehDefaultFilter, BokehCells, BokehNoise, BokehSegment
//   [5] line filter: BokehDepthOfField; adaptive: BokehDepthOfFieldAdaptive
//   [6] combine: BokehCombine, BokehDepthOfFieldFinal
//   [7] naive gather: BokehNaiveGather, BokehNaiveGrid
//   [8] exact polygons: BokehMakePolygon, BokehExactFirst, BokehExactSecond; for one target at a
//       time: BokehExactEdge; cut by the lens barrel: BokehWithCatsEye
//   [9] finished picture: BokehLateralColor
//       debug views: BokehDebugDepth, BokehDebugCoC, BokehDebugFocus

// -------------------------------------------------------------------------------------------------
// [1] configuration
// -------------------------------------------------------------------------------------------------
//
//   name                    default    range   meaning
//   BOKEH_NUM_SAMPLES       13         2 ..    samples on a line (section 4.3), or the most of them
//                                              where their number is adaptive; see below
//   BOKEH_SPACING           1.0        >= 0    pixels between samples; 0: always BOKEH_NUM_SAMPLES
//   BOKEH_ADAPTIVE_SAMPLES  1          0, 1    0: always BOKEH_NUM_SAMPLES; faster than a spacing
//                                              of 0 at run time, which keeps the loop's exit
//   BOKEH_VIEWPORT          0          0, 1    1: the image is a part of its textures, see
//                                              BokehSetViewport
//   BOKEH_CHARACTER         0          0 .. 2  1: the ready-made passes have the character of a
//                                              lens, see BokehWithCatsEye; 2: `exact` has axial
//                                              colour too, see BokehExactFirst
//   BOKEH_SENSOR_HEIGHT     0.024      > 0     metres, 35 mm film (section 4.1)
//   BOKEH_MAX_COC           0.1        0 .. 1  clamp of the CoC; where it is too large, individual
//                                              samples become visible
//   BOKEH_BLEEDING_BIAS     0.02       0 .. 2  Listing 3; 2 turns the leakage test off
//   BOKEH_BLEEDING_MULT     30.0       > 0     Listing 3
//   BOKEH_MAX_COLOR         65504.0            brighter colour is cut off here: by default what a
//                                              half float holds; lower, it is the clamp against
//                                              fireflies, at the cost of the light of highlights
//   BOKEH_MIN_DEPTH         0.000001           metres, replaces zero and negative depth
//   BOKEH_MAX_DEPTH         1000000000.0       metres, replaces infinite depth, where the CoC is
//                                              A f / ((S1 - f) sensorHeight)
//
//   Presets for BOKEH_NUM_SAMPLES and BOKEH_SPACING: define one before this file; in WGSL set both
//   constants. The ready-made passes take their spacing from BokehSpacing. Fetches: of the exact
//   hexagon, both passes, a pixel. Smooth: the CoC in pixels up to which its samples are no farther
//   apart than the spacing.
//
//   preset                  samples    spacing  fetches  smooth
//   BOKEH_PRESET_LOW        5          2.0      22       20
//   BOKEH_PRESET_MEDIUM     9          1.5      38       27
//   BOKEH_PRESET_HIGH       17         1.0      70       34
//   BOKEH_PRESET_ULTRA      33         1.0      134      66

override BOKEH_NUM_SAMPLES: i32 = 13;
override BOKEH_SPACING: f32 = 1.0;
override BOKEH_ADAPTIVE_SAMPLES: i32 = 1;
override BOKEH_VIEWPORT: i32 = 0;
override BOKEH_CHARACTER: i32 = 0;
const BOKEH_SENSOR_HEIGHT: f32 = 0.024;
const BOKEH_MAX_COC: f32 = 0.1;
const BOKEH_BLEEDING_BIAS: f32 = 0.02;
const BOKEH_BLEEDING_MULT: f32 = 30.0;
const BOKEH_MAX_COLOR: f32 = 65504.0;
const BOKEH_MIN_DEPTH: f32 = 0.000001;
const BOKEH_MAX_DEPTH: f32 = 1000000000.0;

// -------------------------------------------------------------------------------------------------
// [2] porting: the one place where the three languages differ
// -------------------------------------------------------------------------------------------------
//
//   A filtered texture and its sampler are two parameters, Name and NameSampler; where a function
//   reads several, they share the sampler of the first. Depth has none: it is loaded, so that its
//   texture may be of a format that cannot be filtered (r32float, depth32float).

// where the image lies in its textures, in their uv: xy = its corner, zw = its size; then the
// bounds of the fetches
var<private> BokehViewport: vec4f = vec4f(0.0, 0.0, 1.0, 1.0);
var<private> BokehViewportBounds: vec4f = vec4f(0.0, 0.0, 1.0, 1.0);

// Porting: the image is a part of its textures (dynamic resolution); call it first
//   It needs BOKEH_VIEWPORT 1.
//   Every texture but the kernel is laid out like this. What is around the image is not read: it
//   may hold anything. The bounds are 1/128 texel inside the centres of the outermost texels, since
//   bilinear filtering reads texels of zero weight too, and 0 times NaN is NaN; 1/256 is how
//   exactly devices place a sample (Direct3D 11, Vulkan).
//   viewport      x, y of its first pixel, width, height; pixels, 2 x 2 or more
//   textureSize   width, height; pixels
fn BokehSetViewport(viewport: vec4f, textureSize: vec2f)
{
    if (BOKEH_VIEWPORT > 0)
    {
        let inset: vec2f = min(vec2f(0.5078125, 0.5078125), viewport.zw * 0.5);
        BokehViewport = viewport / textureSize.xyxy;
        BokehViewportBounds = vec4f(viewport.xy + inset, viewport.xy + viewport.zw - inset) /
            textureSize.xyxy;
    }
}

// Porting: image uv to texture uv
fn BokehToTexture(uv: vec2f) -> vec2f
{
    var coords: vec2f = uv;
    if (BOKEH_VIEWPORT > 0)
    {
        coords = clamp(BokehViewport.xy + uv * BokehViewport.zw, BokehViewportBounds.xy,
            BokehViewportBounds.zw);
    }
    return coords;
}

// Porting: one filtered fetch at level 0, without gradients: it may be in a loop or a branch
//   coords        texture uv
fn BokehFetchTexture(tex: texture_2d<f32>, texSampler: sampler, coords: vec2f) -> vec4f
{
    return textureSampleLevel(tex, texSampler, coords, 0.0);
}

// Porting: the same at image uv
fn BokehFetch(tex: texture_2d<f32>, texSampler: sampler, uv: vec2f) -> vec4f
{
    return BokehFetchTexture(tex, texSampler, BokehToTexture(uv));
}

// Porting: the texel at a place, whatever filter the texture has; depth is read this way
fn BokehFetchNearest(tex: texture_2d<f32>, uv: vec2f) -> vec4f
{
    let size: vec2i = vec2i(textureDimensions(tex));
    let texel: vec2i = vec2i(saturate(BokehToTexture(uv)) * vec2f(size));
    return textureLoad(tex, min(texel, size - vec2i(1, 1)), 0);
}

// Porting: entry i of a table, a texture of count x 1 texels; no viewport applies to it
fn BokehFetchTable(tex: texture_2d<f32>, i: i32, count: i32) -> vec4f
{
    return textureLoad(tex, vec2i(min(i, count - 1), 0), 0);
}

// -------------------------------------------------------------------------------------------------
// [3] Listing 1: circle of confusion
// -------------------------------------------------------------------------------------------------

// Listing 1: CoC of a thin lens (section 4.1)
//   S2            depth of the pixel along the view axis, metres, > 0 (planar depth, not the length
//                 of the ray)
//   A             diameter of the aperture, metres
//   f             focal length, metres
//   S1            focus distance, metres, > f; a lens cannot focus nearer: everything but S2 = S1
//                 gets MaxCoC then. Infinity, and 3.4e38 in its place, become BOKEH_MAX_DEPTH
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

// Listing 1: one colour channel made safe: NaN and negative become 0, infinite becomes the largest
//   half float
//   NaN fails this comparison; max() may return either operand. It has to be >=: fxc compiles > for
//   shader model 3 to the opposite comparison with its results swapped, and NaN passes that.
fn BokehSafeChannel(value: f32) -> f32
{
    var safe: f32 = 0.0;
    if (value >= 0.0)
    {
        safe = min(value, BOKEH_MAX_COLOR);
    }
    return safe;
}

// Listing 1: depth made safe: NaN, zero and negative become the smallest, infinite the largest
fn BokehSafeDepth(S2: f32) -> f32
{
    var safe: f32 = BOKEH_MIN_DEPTH;
    if (S2 >= BOKEH_MIN_DEPTH)
    {
        safe = min(S2, BOKEH_MAX_DEPTH);
    }
    return safe;
}

// Depth: window depth 0 (near) .. 1 (far) of a perspective camera to metres
//   Direct3D, Vulkan and WebGPU have it so, and OpenGL's depth textures.
//   zNear, zFar   the camera's planes, metres, 0 < zNear < zFar
//   returns       depth along the view axis, for the CoC maps and all passes that read depth; the
//                 sky is at zFar, or infinite where zNear is less than zFar / 2^24, which
//                 BokehSafeDepth takes care of
fn BokehDepthFromWindow(depth: f32, zNear: f32, zFar: f32) -> f32
{
    return zNear * zFar / (zFar - depth * (zFar - zNear));
}

// Depth: reversed window depth, 1 (near) .. 0 (far), of a perspective camera to metres
fn BokehDepthFromReversed(depth: f32, zNear: f32, zFar: f32) -> f32
{
    return zNear * zFar / (zNear + depth * (zFar - zNear));
}

// Depth: reversed window depth without a far plane, 1 (near) .. 0 (infinite), to metres
//   The sky is at BOKEH_MAX_DEPTH.
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

// Depth: window depth 0 (near) .. 1 (far) of an orthographic camera to metres
//   Pass 1 - depth where it is reversed.
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
//   kind          0 metres already, 1 window, 2 reversed, 3 reversed infinite, 4 clip,
//                 5 orthographic, 6 orthographic reversed, 7 fraction of zFar, 8 logarithmic
fn BokehLinearDepth(depth: f32, kind: i32, zNear: f32, zFar: f32) -> f32
{
    var S2: f32 = depth;
    if (kind == 1)
    {
        S2 = BokehDepthFromWindow(depth, zNear, zFar);
    }
    else if (kind == 2)
    {
        S2 = BokehDepthFromReversed(depth, zNear, zFar);
    }
    else if (kind == 3)
    {
        S2 = BokehDepthFromInfinite(depth, zNear);
    }
    else if (kind == 4)
    {
        S2 = BokehDepthFromClip(depth, zNear, zFar);
    }
    else if (kind == 5)
    {
        S2 = BokehDepthFromOrthographic(depth, zNear, zFar);
    }
    else if (kind == 6)
    {
        S2 = BokehDepthFromOrthographic(1.0 - depth, zNear, zFar);
    }
    else if (kind == 7)
    {
        S2 = BokehDepthFromFraction(depth, zFar);
    }
    else if (kind == 8)
    {
        S2 = BokehDepthFromLogarithmic(depth, zFar);
    }
    return BokehSafeDepth(S2);
}

// Listing 1: colour as it is, CoC beside it in alpha
//   color         linear HDR colour; its alpha is not used
//   CoC           fraction of the image height
//   returns       what every later pass reads: rgb finite and >= 0, a = CoC
fn BokehPackCoC(color: vec4f, CoC: f32) -> vec4f
{
    return vec4f(BokehSafeChannel(color.r), BokehSafeChannel(color.g), BokehSafeChannel(color.b),
        CoC);
}

// Listing 1: CoCMap, the first pass of `paper` and `naive`
//   No later pass sees the engine's raw colour.
//   ColorSamp     linear HDR scene colour, read texel by texel
//   DepthSamp     r = depth along the view axis, metres (docs/inputs.md has the depth conventions)
//   uv            centre of this pixel, 0 .. 1, v = 0 at the first row in memory
//   A .. MaxCoC   as in BokehCoC
//   returns       rgb = colour, a = CoC
fn BokehCoCMap(ColorSamp: texture_2d<f32>, DepthSamp: texture_2d<f32>, uv: vec2f, A: f32, f: f32,
    S1: f32, sensorHeight: f32, MaxCoC: f32) -> vec4f
{
    let S2: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    let CoC: f32 = BokehCoC(S2, A, f, S1, sensorHeight, MaxCoC);
    return BokehPackCoC(BokehFetchNearest(ColorSamp, uv), CoC);
}

// Listing 1, signed: the CoC with a sign: below 0 the pixel is nearer than the focus distance
//   It grows with depth, so it is all that the leakage test needs to know of depth.
//
//      +MaxCoC            ,--------     far field: > 0, also in a CoC map painted by hand
//            0 - - - - -/- - - - - -> depth
//      -MaxCoC --------' S1             near field: < 0
//
//   Parameters as in BokehCoC.
fn BokehSignedCoC(S2: f32, A: f32, f: f32, S1: f32, sensorHeight: f32, MaxCoC: f32) -> f32
{
    var CoC: f32 = BokehCoC(S2, A, f, S1, sensorHeight, MaxCoC);
    if (S2 < S1)
    {
        CoC = -CoC;
    }
    return CoC;
}

// Listing 1, signed: the first pass of `exact`, whose later passes read no depth
//   Parameters as in BokehCoCMap.
//   returns       rgb = colour, a = signed CoC
fn BokehSignedCoCMap(ColorSamp: texture_2d<f32>, DepthSamp: texture_2d<f32>, uv: vec2f, A: f32,
    f: f32, S1: f32, sensorHeight: f32, MaxCoC: f32) -> vec4f
{
    let S2: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    let CoC: f32 = BokehSignedCoC(S2, A, f, S1, sensorHeight, MaxCoC);
    return BokehPackCoC(BokehFetchNearest(ColorSamp, uv), CoC);
}

// -------------------------------------------------------------------------------------------------
// [4] Listing 2: sample offsets
// -------------------------------------------------------------------------------------------------
//
//      u ->      angle = 0: along +u;  90 degrees: along +v, towards the last row in memory
//    v           -lineEnd  o--o--o--o--o--o--o  +lineEnd      length 1, in units of the CoC
//    |                              ^ this pixel
//    v

// Listing 2: how a line is sampled, and the leakage test of Listing 3
//   aspectRatio   width / height of the image
//   imageHeight   pixels
//   spacing       pixels between samples, 1 is right for most; 0: exactly BOKEH_NUM_SAMPLES
//   jitter        from BokehNoise, times its amount; 0 = none. It acts where samples are farther
//                 apart than a pixel.
//   bleedingBias  CoC difference that still passes, fraction of the image height; 2 or more turns
//                 the test off
//   bleedingMult  weight for each unit of CoC of a sample that does not pass
struct BokehFilter
{
    aspectRatio: f32,
    imageHeight: f32,
    spacing: f32,
    jitter: f32,
    bleedingBias: f32,
    bleedingMult: f32,
}

// Listing 2: the settings that [1] configures, without jitter
//   imageSize     width, height; pixels
fn BokehDefaultFilter(imageSize: vec2f) -> BokehFilter
{
    var settings: BokehFilter;
    settings.aspectRatio = imageSize.x / imageSize.y;
    settings.imageHeight = imageSize.y;
    settings.spacing = BOKEH_SPACING;
    settings.jitter = 0.0;
    settings.bleedingBias = BOKEH_BLEEDING_BIAS;
    settings.bleedingMult = BOKEH_BLEEDING_MULT;
    return settings;
}

// Listing 2: the end of a line of length 1 centred on this pixel
//   angle         radians
//   aspectRatio   width / height of the image: offsets are in uv, so x shrinks by it and a
//                 highlight is not stretched
//   returns       uv offset for a CoC of 1; the other end of the line is the negative of it
fn BokehLineEnd(angle: f32, aspectRatio: f32) -> vec2f
{
    return vec2f(0.5 * cos(angle) / aspectRatio, 0.5 * sin(angle));
}

// Listing 2: makeOffsets, sample i of numSamples evenly spaced from end to end of the line
//   t runs from -1 to +1, so that the offsets are exact negatives of each other and the middle one
//   is 0.
//   returns       uv offset for a CoC of 1
fn BokehMakeOffsets(lineEnd: vec2f, i: i32, numSamples: i32) -> vec2f
{
    let last: i32 = max(numSamples, 2) - 1;
    let t: f32 = f32(2 * i - last) / f32(last);
    return lineEnd * t;
}

// Listing 2, adaptive: the CoC that the filter uses, 0 where the pixel is in focus
//   Below half a pixel nothing is left to blur; up to one pixel it fades in, so that no contour
//   shows.
//   Written (x - 0.5) * 2: from 2 - 2 abs(x) fxc drops the abs in shader model 3.
//   CoC           without a sign
//   spacing       as in BokehFilter; 0 or less: the CoC as it is
//   returns       fraction of the image height
fn BokehFilterCoC(CoC: f32, imageHeight: f32, spacing: f32) -> f32
{
    var filterCoC: f32 = CoC;
    if (BOKEH_ADAPTIVE_SAMPLES > 0 && spacing > 0.0)
    {
        filterCoC = CoC * clamp((CoC * imageHeight - 0.5) * 2.0, 0.0, 1.0);
    }
    return filterCoC;
}

// Listing 2, adaptive: number of cells on a line, one sample each; not a whole number
//   Cells are `spacing` pixels long, or longer where BOKEH_NUM_SAMPLES of them would not fill the
//   line. Cell i weighs clamp(cells - i, 0, 1):
//
//      |---|---|---|---|-|     4.2 cells, 5 samples: the last cell grows from nothing as the line
//        ^   ^   ^   ^  ^      does, so that the result does not jump where the sample count does
//
fn BokehCells(lengthInPixels: f32, spacing: f32) -> f32
{
    var cells: f32 = f32(BOKEH_NUM_SAMPLES);
    if (BOKEH_ADAPTIVE_SAMPLES > 0 && spacing > 0.0)
    {
        cells = clamp(lengthInPixels / spacing, 1.0, f32(BOKEH_NUM_SAMPLES));
    }
    return cells;
}

// Listing 2, adaptive: interleaved gradient noise (Jimenez 2014) for each pixel, frame and pass
//   In pass p each frame adds (8 p + 1) 33 / 64. So over 64 frames every pass takes 64 evenly
//   spaced values in each pixel, and no two passes take theirs in the same order: the mean of the
//   frames converges.
//   imageSize     width, height; pixels
//   frame         number of the frame, a whole number
//   passIndex     0, 1 ..: of the pass within the frame; a pass that reads another one needs
//                 another index
//   returns       -0.5 .. 0.5
fn BokehNoise(uv: vec2f, imageSize: vec2f, frame: f32, passIndex: f32) -> f32
{
    let number: f32 = (8.0 * passIndex + 1.0) * (frame - 64.0 * floor(frame / 64.0)) + passIndex;
    let seed: f32 = dot(floor(uv * imageSize), vec2f(0.06711056, 0.00583715));
    let value: f32 = 52.9829189 * (seed - floor(seed)) + 0.515625 * number;
    return value - floor(value) - 0.5;
}

// Listing 2, adaptive: a line of any length and place, for BokehDepthOfFieldAdaptive
//   angle         radians
//   lineLength    in units of the CoC
//   lineCenter    its middle, in units of the CoC from this pixel, x to the right, y towards the
//                 last row; a highlight shows the line on the other side
//   squeeze       width of the bokeh / its height, 1 = round
//   returns       xy = middle, zw = from the middle to the end, in units of the CoC;
//                 BokehPolygonEdge returns the same
fn BokehSegment(angle: f32, lineLength: f32, lineCenter: vec2f, squeeze: f32) -> vec4f
{
    let segment: vec4f = vec4f(lineCenter, 0.5 * lineLength * cos(angle), 0.5 * lineLength *
        sin(angle));
    return segment * vec4f(squeeze, 1.0, squeeze, 1.0);
}

// -------------------------------------------------------------------------------------------------
// [5] Listing 3: one pass of the line filter
// -------------------------------------------------------------------------------------------------

// Listing 3: weight of one sample against intensity leakage (section 2.1)
//   A sample that is nearer to the camera and clearly sharper than this pixel would leak onto it.
//   Its weight is its own CoC then, times bleedingMult: 0 in focus, 1 from a CoC of
//   1 / bleedingMult up. All other samples have the weight 1.
fn BokehLeakageWeight(sampleDepth: f32, sampleCoC: f32, centerDepth: f32, centerCoC: f32,
    settings: BokehFilter) -> f32
{
    var weight: f32 = 1.0;
    if (sampleDepth < centerDepth && centerCoC > sampleCoC + settings.bleedingBias)
    {
        weight = clamp(sampleCoC * settings.bleedingMult, 0.0, 1.0);
    }
    return weight;
}

// Listing 3, signed: the same test from signed CoC alone; the weight is the square of Listing 3's
//   Behind the focus a sharper sample is a nearer one; in front of it centerCoC is below 0, and
//   every sample counts. The test sets in from half of the bias to one and a half: a step would
//   make outlines pop as the focus is pulled. In the second pass a rejected sample also displaces
//   what its own line would have gathered; squared weights make up for that.
//   0.001: a bias of 0 must not divide, and a half float's rounding not reject a surface's own
//   samples.
fn BokehSignedLeakageWeight(sampleCoC: f32, centerCoC: f32, settings: BokehFilter) -> f32
{
    let scale: f32 = 1.0 / max(settings.bleedingBias, 0.001);
    let rejected: f32 = clamp((centerCoC * scale - 0.5) - abs(sampleCoC) * scale, 0.0, 1.0);
    let weight: f32 = clamp(abs(sampleCoC) * settings.bleedingMult, 0.0, 1.0);
    return 1.0 - rejected * (1.0 - weight * weight);
}

// Listing 3: the weighted average, or centerPixel where all weights are 0
//   With an even number of samples the middle of the line is not sampled, so all may be rejected.
//   blurCoC       true: the CoC is averaged with the colour; false: this pixel keeps its CoC
//                 (Figure 7)
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
//   ColorSamp     rgb = linear HDR colour, a = CoC: from BokehCoCMap or from an earlier pass;
//                 linear filter, clamp
//   DepthSamp     r = depth, the same as in BokehCoCMap
//   lineEnd       from BokehLineEnd
//   settings      of which the leakage test is used; there are always BOKEH_NUM_SAMPLES samples, in
//                 shader model 3 254 at most
fn BokehDepthOfField(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler,
    DepthSamp: texture_2d<f32>, uv: vec2f, lineEnd: vec2f, settings: BokehFilter,
    blurCoC: bool) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var i: i32 = 0; i < BOKEH_NUM_SAMPLES; i++)
    {
        let offset: vec2f = BokehMakeOffsets(lineEnd, i, BOKEH_NUM_SAMPLES);
        let sampleCoords: vec2f = uv + offset * centerPixel.a;
        let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
        let sampleDepth: f32 = BokehFetchNearest(DepthSamp, sampleCoords).r;
        let weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
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
fn BokehDepthOfFieldAdaptive(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler,
    DepthSamp: texture_2d<f32>, uv: vec2f, segment: vec4f, settings: BokehFilter,
    blurCoC: bool) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    var result: vec4f = centerPixel;
    let CoC: f32 = BokehFilterCoC(centerPixel.a, settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
        let lengthInPixels: f32 = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
        let cells: f32 = BokehCells(lengthInPixels, settings.spacing);
        let phase: f32 = 0.5 + settings.jitter * clamp(lengthInPixels / cells - 1.0, 0.0, 1.0);
        let scale: vec2f = vec2f(CoC / settings.aspectRatio, CoC);
        let first: vec2f = uv + (segment.xy - segment.zw) * scale;
        let cellLength: vec2f = segment.zw * scale * (2.0 / cells);
        var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        var totalWeight: f32 = 0.0;
        for (var i: i32 = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            if (BOKEH_ADAPTIVE_SAMPLES > 0 && f32(i) >= cells)
            {
                break;
            }
            let cell: f32 = clamp(cells - f32(i), 0.0, 1.0);
            let sampleCoords: vec2f = first + cellLength * (f32(i) + cell * phase);
            let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
            let sampleDepth: f32 = BokehFetchNearest(DepthSamp, sampleCoords).r;
            let weight: f32 = cell * BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
                centerPixel.a, settings);
            color += samplePixel * weight;
            totalWeight += weight;
        }
        result = BokehResolve(color, totalWeight, centerPixel, blurCoC);
    }
    return result;
}

// -------------------------------------------------------------------------------------------------
// [6] Listing 4: combine by min / max
// -------------------------------------------------------------------------------------------------

// Listing 4: intersection (min) or union (max) of two parallelogram blurs, CoC too (section 4.5)
fn BokehCombine(a: vec4f, b: vec4f, useMax: bool) -> vec4f
{
    var result: vec4f = min(a, b);
    if (useMax)
    {
        result = max(a, b);
    }
    return result;
}

// Listing 4: DepthOfFieldFinal, the last line of the second parallelogram, combined with the first
//   CompareSamp   the finished first parallelogram
//   useMax        false: intersection (hexagon, octagon); true: union (star)
fn BokehDepthOfFieldFinal(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler,
    DepthSamp: texture_2d<f32>, CompareSamp: texture_2d<f32>, uv: vec2f, lineEnd: vec2f,
    settings: BokehFilter, blurCoC: bool, useMax: bool) -> vec4f
{
    let a: vec4f = BokehDepthOfField(ColorSamp, ColorSampSampler, DepthSamp, uv, lineEnd, settings,
        blurCoC);
    return BokehCombine(a, BokehFetch(CompareSamp, ColorSampSampler, uv), useMax);
}

// -------------------------------------------------------------------------------------------------
// [7] naive gather
// -------------------------------------------------------------------------------------------------

// Section 3: gather with a table of BOKEH_NUM_SAMPLES offsets, any shape
//   The bokeh is their point reflection: negate a table that is drawn as the bokeh looks.
//   KernelSamp    BOKEH_NUM_SAMPLES x 1 texels, rg = offset in units of the CoC, x to the right, y
//                 towards the last row
fn BokehNaiveGather(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler,
    DepthSamp: texture_2d<f32>, KernelSamp: texture_2d<f32>, uv: vec2f, settings: BokehFilter,
    blurCoC: bool) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    let scale: vec2f = vec2f(centerPixel.a / settings.aspectRatio, centerPixel.a);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var i: i32 = 0; i < BOKEH_NUM_SAMPLES; i++)
    {
        let offset: vec2f = BokehFetchTable(KernelSamp, i, BOKEH_NUM_SAMPLES).rg;
        let sampleCoords: vec2f = uv + offset * scale;
        let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
        let sampleDepth: f32 = BokehFetchNearest(DepthSamp, sampleCoords).r;
        let weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            settings);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Section 3: gather over a parallelogram grid, offsets computed instead of read (Table 1)
//   BOKEH_NUM_SAMPLES is the number along a side: 4, 8, 12, 16, 20, 24 for the counts of Table 1.
//   lineEndU, lineEndV  the two sides, from BokehLineEnd
fn BokehNaiveGrid(ColorSamp: texture_2d<f32>, ColorSampSampler: sampler, DepthSamp: texture_2d<f32>,
    uv: vec2f, lineEndU: vec2f, lineEndV: vec2f, settings: BokehFilter, blurCoC: bool) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, uv);
    let centerDepth: f32 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    var color: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var totalWeight: f32 = 0.0;
    for (var j: i32 = 0; j < BOKEH_NUM_SAMPLES; j++)
    {
        let rowOffset: vec2f = BokehMakeOffsets(lineEndV, j, BOKEH_NUM_SAMPLES);
        for (var i: i32 = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            let offset: vec2f = rowOffset + BokehMakeOffsets(lineEndU, i, BOKEH_NUM_SAMPLES);
            let sampleCoords: vec2f = uv + offset * centerPixel.a;
            let samplePixel: vec4f = BokehFetch(ColorSamp, ColorSampSampler, sampleCoords);
            let sampleDepth: f32 = BokehFetchNearest(DepthSamp, sampleCoords).r;
            let weight: f32 = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
                centerPixel.a, settings);
            color += samplePixel * weight;
            totalWeight += weight;
        }
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// -------------------------------------------------------------------------------------------------
// [8] exact polygons
// -------------------------------------------------------------------------------------------------
//
//   A regular polygon with an even number of sides is cut into parallelograms that do not overlap.
//   Their blurs are ADDED: no light is lost as by min, and highlights that overlap add up. The
//   first pass blurs along all edges of one half of the outline but the last, the second pass along
//   all but the first. docs/apertures.md has the proof.
//
//           edge 2            edges 1, 2, 3 of a hexagon; the other half of the outline is the
//          ,-' '-,  edge 1    same, turned.
//   edge 3 |     |            first pass   edge2 = blur along 1; edge3 = along 1 and 2, weighted
//          '-, ,-'            second pass  edge2 blurred along 2, edge3 along 3: 1/3 + 2/3
//
//   sides       targets of the first pass, textures of the second
//   4           edge2
//   6           edge2, edge3
//   8           edge2 .. edge4
//   10          edge2 .. edge5
//
//   Where a pass can write one target only, BokehExactEdge makes them one at a time.
//   Corners lie on the circle of confusion. Rotation 0 has an upright edge at the right, as `paper`
//   has it.

// Exact: the aperture
//   sides         4, 6, 8 or 10, a literal: what it does not need is then compiled away
//   rotation      radians
//   squeeze       width of the bokeh / its height: 1, or 0.5 for the oval of an anamorphic lens
//   lengths       of edges 1 to 4, units of the CoC, before the squeeze; fifth: of edge 5. They
//                 count with BOKEH_CHARACTER 1 only: BokehWithCatsEye changes them.
//   roundness     curved blades, of an octagon: 0 a square, 1 regular, between them a square with
//                 corners cut off; set it before BokehWithCatsEye
//   axial         axial colour, with BOKEH_CHARACTER 2 only: what red (x) and blue (y) have more of
//                 signed CoC than green; fraction of image height
struct BokehPolygon
{
    sides: i32,
    rotation: f32,
    squeeze: f32,
    lengths: vec4f,
    fifth: f32,
    roundness: f32,
    axial: vec2f,
}

// Exact: what the first pass writes: what the second one blurs along edges 2 to 5; those that the
//   polygon does not have hold the unblurred pixel
struct BokehTargets
{
    edge2: vec4f,
    edge3: vec4f,
    edge4: vec4f,
    edge5: vec4f,
}

// Exact: a BokehPolygon in one expression
fn BokehMakePolygon(sides: i32, rotation: f32, squeeze: f32) -> BokehPolygon
{
    var polygon: BokehPolygon;
    polygon.sides = sides;
    polygon.rotation = rotation;
    polygon.squeeze = squeeze;
    polygon.lengths = vec4f(0.0, 0.0, 0.0, 0.0);
    polygon.fifth = 0.0;
    polygon.roundness = 1.0;
    polygon.axial = vec2f(0.0, 0.0);
    if (BOKEH_CHARACTER > 0)
    {
        polygon.fifth = sin(3.14159265 / f32(sides));
        polygon.lengths = vec4f(polygon.fifth, polygon.fifth, polygon.fifth, polygon.fifth);
    }
    return polygon;
}

// Exact: a vector rotated, from +x towards +y
//   axis          (cos, sin) of the angle
fn BokehRotated(direction: vec2f, axis: vec2f) -> vec2f
{
    return vec2f(direction.x * axis.x - direction.y * axis.y,
        direction.x * axis.y + direction.y * axis.x);
}

// Exact: length of edge k of a polygon that is cut
//   k             1 .. sides / 2
fn BokehEdgeLength(k: i32, polygon: BokehPolygon) -> f32
{
    var edgeLength: f32 = polygon.lengths.x;
    if (k == 2)
    {
        edgeLength = polygon.lengths.y;
    }
    else if (k == 3)
    {
        edgeLength = polygon.lengths.z;
    }
    else if (k == 4)
    {
        edgeLength = polygon.lengths.w;
    }
    else if (k == 5)
    {
        edgeLength = polygon.fifth;
    }
    return edgeLength;
}

// Exact: edge k of a polygon that is cut, from its beginning to its end; not rotated, not squeezed
fn BokehEdgeVector(k: i32, polygon: BokehPolygon) -> vec2f
{
    let angle: f32 = 6.28318531 / f32(polygon.sides) * f32(k);
    return vec2f(-sin(angle), cos(angle)) * BokehEdgeLength(k, polygon);
}

// Exact: the line of edge k of a polygon that is cut, as in BokehPolygonEdge; not rotated, not
//   squeezed
//   The polygon is the sum of its edges: it begins at minus half of all of them.
fn BokehCutEdge(k: i32, polygon: BokehPolygon, secondPass: bool) -> vec4f
{
    var corner: vec2f = vec2f(0.0, 0.0);
    for (var i: i32 = 1; i <= polygon.sides / 2; i++)
    {
        corner -= BokehEdgeVector(i, polygon) * 0.5;
    }
    var begin: vec2f = corner;
    var middle: vec2f = vec2f(0.0, 0.0);
    var meanOfFirst: vec2f = vec2f(0.0, 0.0);
    for (var j: i32 = 1; j <= polygon.sides / 2; j++)
    {
        let edge: vec2f = BokehEdgeVector(j, polygon);
        if (j == k)
        {
            middle = begin + edge * 0.5;
        }
        if (j < polygon.sides / 2)
        {
            meanOfFirst += (begin + edge * 0.5) / (0.5 * f32(polygon.sides) - 1.0);
        }
        begin += edge;
    }
    middle -= meanOfFirst;
    if (secondPass)
    {
        middle = -middle - corner;
    }
    return vec4f(middle, BokehEdgeVector(k, polygon) * 0.5);
}

// Exact: the line of edge k in one of the two passes
//   If both passes put their lines on the outline, every sample of the first pass would be on one
//   side of the pixel. So the first pass is moved by the mean of its lines to the middle, and the
//   second pass back. All but the last statements are constants where sides is a literal.
//   k             1 .. sides / 2
//   secondPass    false: first pass
//   returns       xy = middle, zw = from the middle to the end; in units of the CoC, x to the right
fn BokehPolygonEdge(k: i32, polygon: BokehPolygon, secondPass: bool) -> vec4f
{
    let halfStep: f32 = 3.14159265 / f32(polygon.sides);
    let angle: f32 = 2.0 * halfStep * f32(k);
    let outwards: vec2f = vec2f(cos(angle), sin(angle));
    let meanOfFirst: f32 = 0.5 * cos(halfStep) * cos(halfStep) /
        (sin(halfStep) * (0.5 * f32(polygon.sides) - 1.0));
    var middle: vec2f = outwards * (0.5 * cos(halfStep)) - vec2f(0.0, meanOfFirst);
    if (secondPass)
    {
        middle = -middle - vec2f(0.5 * cos(halfStep), 0.5 * sin(halfStep));
    }
    var halfEdge: vec2f = vec2f(-outwards.y, outwards.x) * (0.5 * sin(halfStep));
    if (BOKEH_CHARACTER > 0)
    {
        let edge: vec4f = BokehCutEdge(k, polygon, secondPass);
        middle = edge.xy;
        halfEdge = edge.zw;
    }
    let axis: vec2f = vec2f(cos(polygon.rotation), sin(polygon.rotation));
    let segment: vec4f = vec4f(BokehRotated(middle, axis), BokehRotated(halfEdge, axis));
    return segment * vec4f(polygon.squeeze, 1.0, polygon.squeeze, 1.0);
}

// Exact: area of the parallelograms of edge k with edges 1 .. k - 1; of a polygon that is not cut,
//   for edges of length 1
fn BokehExactWeight(k: i32, polygon: BokehPolygon) -> f32
{
    let halfStep: f32 = 3.14159265 / f32(polygon.sides);
    var area: f32 = sin(f32(k) * halfStep) * sin((f32(k) - 1.0) * halfStep) / sin(halfStep);
    if (BOKEH_CHARACTER > 0)
    {
        area = 0.0;
        for (var i: i32 = 1; i < k; i++)
        {
            area += sin(2.0 * halfStep * f32(k - i)) * BokehEdgeLength(i, polygon);
        }
        area *= BokehEdgeLength(k, polygon);
    }
    return area;
}

// Exact: distance of edge k from the middle of a polygon that is cut, units of the CoC
//   cut           xy = along which, z = the mean of two neighbours' distances before the cut, w =
//                 half of how much more it is where k is even
fn BokehHalfWidth(k: i32, sides: i32, cut: vec4f) -> f32
{
    let angle: f32 = 6.28318531 / f32(sides) * f32(k);
    let whole: f32 = cut.z + cut.w * cos(3.14159265 * f32(k));
    return whole * (1.0 - abs(cut.x * cos(angle) + cut.y * sin(angle)));
}

// Exact: length of edge k between the lines of all other edges
//
//      before after
//      ,---+---,   edge k is on a line half a width from the middle; on both sides it ends where
//     /    |    '  the nearest of the other lines crosses that one
//
//   returns       units of the CoC; 0.001 where nothing is left, so that no weights add up to 0
fn BokehCutLength(k: i32, sides: i32, cut: vec4f) -> f32
{
    let halfWidth: f32 = BokehHalfWidth(k, sides, cut);
    // before and after
    var ends: vec2f = vec2f(1.0, 1.0);
    for (var i: i32 = 1; i < sides / 2; i++)
    {
        let angle: f32 = 6.28318531 / f32(sides) * f32(i);
        let others: vec2f = vec2f(BokehHalfWidth(k - i, sides, cut),
            BokehHalfWidth(k + i, sides, cut));
        ends = min(ends, (others - halfWidth * cos(angle)) / sin(angle));
    }
    return max(ends.x + ends.y, 0.001);
}

// Exact: cat's eye: the polygon cut by the lens barrel, more towards the corners of the image
//   The front rim of the barrel cuts one side of the bokeh, the rear rim the other. Both are taken
//   for the polygon itself, moved: so the middle stays where it is, near and far are alike, and
//   what is left has the same edges, some of them shorter.
//   uv            of this pixel
//   imageSize     width, height; pixels
//   amount        0 .. 0.9: share of the width, from the middle of the image outwards, that is gone
//                 in its corners; half-way to them half as much
fn BokehWithCatsEye(polygon: BokehPolygon, uv: vec2f, imageSize: vec2f, amount: f32) -> BokehPolygon
{
    let place: vec2f = (uv * 2.0 - 1.0) * imageSize / length(imageSize);
    let axis: vec2f = vec2f(cos(polygon.rotation), -sin(polygon.rotation));
    let along: vec2f = BokehRotated(place, axis) * clamp(amount, 0.0, 0.9);
    var result: BokehPolygon = polygon;
    let sides: i32 = clamp(polygon.sides, 4, 10);
    result.sides = sides;
    var even: f32 = 0.5 * cos(3.14159265 / f32(sides));
    var odd: f32 = even;
    if (sides == 8)
    {
        // corners stay on the circle: what an edge has less of it, its neighbours have more
        let corner: f32 = 0.39269908 * clamp(polygon.roundness, 0.0, 1.0);
        even = 0.5 * cos(0.78539816 - corner);
        odd = 0.5 * cos(corner);
    }
    let cut: vec4f = vec4f(along, 0.5 * (even + odd), 0.5 * (even - odd));
    result.lengths = vec4f(BokehCutLength(1, sides, cut), BokehCutLength(2, sides, cut),
        BokehCutLength(3, sides, cut), BokehCutLength(4, sides, cut));
    result.fifth = BokehCutLength(5, sides, cut);
    return result;
}

// Exact: signed CoC of a colour channel
//   shift         axial colour: how much more of it the channel has than green; fraction of image
//                 height
fn BokehChannelCoC(signedCoC: f32, shift: f32) -> f32
{
    var CoC: f32 = signedCoC;
    if (BOKEH_CHARACTER > 1)
    {
        CoC += shift;
    }
    return CoC;
}

// Exact: axial colour: what a channel of the blur writes: 0 red, 1 green and the CoC, 2 blue
fn BokehChannelMask(channel: i32) -> vec4f
{
    return vec4f(f32(channel == 0), f32(channel == 1), f32(channel == 2), f32(channel == 1));
}

// Exact: the samples along one line, as many as it needs
//   They are not divided by their weights here: a line that lies wholly on a sharp object, almost
//   all of it rejected, must not come back at full strength (docs/apertures.md).
//   MapSamp       a = signed CoC; linear filter, clamp
//   segment       from BokehPolygonEdge
//   CoC           from BokehFilterCoC, > 0
//   centerCoC     signed, of this pixel
//   shift         as in BokehChannelCoC; centerCoC has it already
//   returns       rgb = mean of colour times weight, a = mean weight
fn BokehLineSum(MapSamp: texture_2d<f32>, MapSampSampler: sampler, uv: vec2f, segment: vec4f,
    CoC: f32, centerCoC: f32, shift: f32, settings: BokehFilter) -> vec4f
{
    let lengthInPixels: f32 = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
    let cells: f32 = BokehCells(lengthInPixels, settings.spacing);
    let phase: f32 = 0.5 + settings.jitter * clamp(lengthInPixels / cells - 1.0, 0.0, 1.0);
    let scale: vec2f = vec2f(CoC / settings.aspectRatio, CoC);
    let first: vec2f = uv + (segment.xy - segment.zw) * scale;
    let cellLength: vec2f = segment.zw * scale * (2.0 / cells);
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var i: i32 = 0; i < BOKEH_NUM_SAMPLES; i++)
    {
        if (BOKEH_ADAPTIVE_SAMPLES > 0 && f32(i) >= cells)
        {
            break;
        }
        let cell: f32 = clamp(cells - f32(i), 0.0, 1.0);
        let samplePixel: vec4f = BokehFetch(MapSamp, MapSampSampler,
            first + cellLength * (f32(i) + cell * phase));
        let sampleCoC: f32 = BokehChannelCoC(samplePixel.a, shift);
        let weight: f32 = cell * BokehSignedLeakageWeight(sampleCoC, centerCoC, settings);
        sum += vec4f(samplePixel.rgb, 1.0) * weight;
    }
    return sum / cells;
}

// Exact: what the first pass writes for edge k: the blurs along the edges before it, weighted by
//   their parallelograms and divided once, by the sum of all weights
//   L1 .. L4      from BokehLineSum, along edges 1 to 4; only those before edge k count
//   returns       rgb = colour, a = CoC of this pixel: the second pass blurs by the unblurred CoC
fn BokehExactTarget(k: i32, polygon: BokehPolygon, L1: vec4f, L2: vec4f, L3: vec4f, L4: vec4f,
    centerPixel: vec4f) -> vec4f
{
    let angle: f32 = 6.28318531 / f32(polygon.sides);
    var w1: f32 = sin((f32(k) - 1.0) * angle);
    var w2: f32 = max(sin((f32(k) - 2.0) * angle), 0.0);
    var w3: f32 = max(sin((f32(k) - 3.0) * angle), 0.0);
    var w4: f32 = max(sin((f32(k) - 4.0) * angle), 0.0);
    if (BOKEH_CHARACTER > 0)
    {
        w1 *= polygon.lengths.x;
        w2 *= polygon.lengths.y;
        w3 *= polygon.lengths.z;
        w4 *= polygon.lengths.w;
    }
    let sum: vec4f = L1 * w1 + L2 * w2 + L3 * w3 + L4 * w4;
    return BokehResolve(sum, sum.a, centerPixel, false);
}

// Exact: BokehExactFirst with one CoC for all channels
//   shift         as in BokehChannelCoC
fn BokehChannelFirst(MapSamp: texture_2d<f32>, MapSampSampler: sampler, uv: vec2f,
    polygon: BokehPolygon, settings: BokehFilter, shift: f32) -> BokehTargets
{
    let centerPixel: vec4f = BokehFetch(MapSamp, MapSampSampler, uv);
    var targets: BokehTargets;
    targets.edge2 = centerPixel;
    targets.edge3 = centerPixel;
    targets.edge4 = centerPixel;
    targets.edge5 = centerPixel;
    let centerCoC: f32 = BokehChannelCoC(centerPixel.a, shift);
    let CoC: f32 = BokehFilterCoC(abs(centerCoC), settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        // the targets come last: until then only the lines take registers
        let L1: vec4f = BokehLineSum(MapSamp, MapSampSampler, uv, BokehPolygonEdge(1, polygon,
            false), CoC, centerCoC, shift, settings);
        var L2: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        var L3: vec4f = L2;
        var L4: vec4f = L2;
        if (polygon.sides > 4)
        {
            L2 = BokehLineSum(MapSamp, MapSampSampler, uv, BokehPolygonEdge(2, polygon, false), CoC,
                centerCoC, shift, settings);
        }
        if (polygon.sides > 6)
        {
            L3 = BokehLineSum(MapSamp, MapSampSampler, uv, BokehPolygonEdge(3, polygon, false), CoC,
                centerCoC, shift, settings);
        }
        if (polygon.sides > 8)
        {
            L4 = BokehLineSum(MapSamp, MapSampSampler, uv, BokehPolygonEdge(4, polygon, false), CoC,
                centerCoC, shift, settings);
        }
        targets.edge2 = BokehExactTarget(2, polygon, L1, L2, L3, L4, centerPixel);
        if (polygon.sides > 4)
        {
            targets.edge3 = BokehExactTarget(3, polygon, L1, L2, L3, L4, centerPixel);
        }
        if (polygon.sides > 6)
        {
            targets.edge4 = BokehExactTarget(4, polygon, L1, L2, L3, L4, centerPixel);
        }
        if (polygon.sides > 8)
        {
            targets.edge5 = BokehExactTarget(5, polygon, L1, L2, L3, L4, centerPixel);
        }
    }
    return targets;
}

// Exact: first pass
//   With BOKEH_CHARACTER 2 red, green and blue are blurred one after the other, each by its own
//   CoC: three times the fetches.
//   MapSamp       from BokehSignedCoCMap; linear filter, clamp
//   returns       as many as the table above says
fn BokehExactFirst(MapSamp: texture_2d<f32>, MapSampSampler: sampler, uv: vec2f,
    polygon: BokehPolygon, settings: BokehFilter) -> BokehTargets
{
    var targets: BokehTargets;
    if (BOKEH_CHARACTER > 1)
    {
        targets.edge2 = vec4f(0.0, 0.0, 0.0, 0.0);
        targets.edge3 = vec4f(0.0, 0.0, 0.0, 0.0);
        targets.edge4 = vec4f(0.0, 0.0, 0.0, 0.0);
        targets.edge5 = vec4f(0.0, 0.0, 0.0, 0.0);
        for (var channel: i32 = 0; channel < 3; channel++)
        {
            let mask: vec4f = BokehChannelMask(channel);
            let shift: f32 = dot(mask.rb, polygon.axial);
            let one: BokehTargets = BokehChannelFirst(MapSamp, MapSampSampler, uv, polygon,
                settings, shift);
            targets.edge2 += one.edge2 * mask;
            targets.edge3 += one.edge3 * mask;
            targets.edge4 += one.edge4 * mask;
            targets.edge5 += one.edge5 * mask;
        }
    }
    else
    {
        targets = BokehChannelFirst(MapSamp, MapSampSampler, uv, polygon, settings, 0.0);
    }
    return targets;
}

// Exact: BokehExactSecond with one CoC for all channels
//   shift         as in BokehChannelCoC
fn BokehChannelSecond(Edge2Samp: texture_2d<f32>, Edge2SampSampler: sampler,
    Edge3Samp: texture_2d<f32>, Edge4Samp: texture_2d<f32>, Edge5Samp: texture_2d<f32>, uv: vec2f,
    polygon: BokehPolygon, settings: BokehFilter, shift: f32) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(Edge2Samp, Edge2SampSampler, uv);
    var result: vec4f = centerPixel;
    let centerCoC: f32 = BokehChannelCoC(centerPixel.a, shift);
    let CoC: f32 = BokehFilterCoC(abs(centerCoC), settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        var sum: vec4f = BokehExactWeight(2, polygon) * BokehLineSum(Edge2Samp, Edge2SampSampler,
            uv, BokehPolygonEdge(2, polygon, true), CoC, centerCoC, shift, settings);
        if (polygon.sides > 4)
        {
            sum += BokehExactWeight(3, polygon) * BokehLineSum(Edge3Samp, Edge2SampSampler, uv,
                BokehPolygonEdge(3, polygon, true), CoC, centerCoC, shift, settings);
        }
        if (polygon.sides > 6)
        {
            sum += BokehExactWeight(4, polygon) * BokehLineSum(Edge4Samp, Edge2SampSampler, uv,
                BokehPolygonEdge(4, polygon, true), CoC, centerCoC, shift, settings);
        }
        if (polygon.sides > 8)
        {
            sum += BokehExactWeight(5, polygon) * BokehLineSum(Edge5Samp, Edge2SampSampler, uv,
                BokehPolygonEdge(5, polygon, true), CoC, centerCoC, shift, settings);
        }
        result = BokehResolve(sum, sum.a, centerPixel, false);
    }
    return result;
}

// Exact: second pass, the finished polygon
//   Edge2Samp ..  what the first pass wrote; linear filter, clamp. Where there are fewer, pass any
//                 of them for the rest: it is not read.
//   returns       rgb = colour, a = signed CoC of this pixel, as BokehSignedCoCMap made it
fn BokehExactSecond(Edge2Samp: texture_2d<f32>, Edge2SampSampler: sampler,
    Edge3Samp: texture_2d<f32>, Edge4Samp: texture_2d<f32>, Edge5Samp: texture_2d<f32>, uv: vec2f,
    polygon: BokehPolygon, settings: BokehFilter) -> vec4f
{
    var result: vec4f;
    if (BOKEH_CHARACTER > 1)
    {
        result = vec4f(0.0, 0.0, 0.0, 0.0);
        for (var channel: i32 = 0; channel < 3; channel++)
        {
            let mask: vec4f = BokehChannelMask(channel);
            let shift: f32 = dot(mask.rb, polygon.axial);
            let one: vec4f = BokehChannelSecond(Edge2Samp, Edge2SampSampler, Edge3Samp, Edge4Samp,
                Edge5Samp, uv, polygon, settings, shift);
            result += one * mask;
        }
    }
    else
    {
        result = BokehChannelSecond(Edge2Samp, Edge2SampSampler, Edge3Samp, Edge4Samp, Edge5Samp,
            uv, polygon, settings, 0.0);
    }
    return result;
}

// Exact: BokehExactEdge with one CoC for all channels
//   shift         as in BokehChannelCoC
fn BokehChannelEdge(MapSamp: texture_2d<f32>, MapSampSampler: sampler, uv: vec2f, k: i32,
    polygon: BokehPolygon, settings: BokehFilter, shift: f32) -> vec4f
{
    let centerPixel: vec4f = BokehFetch(MapSamp, MapSampSampler, uv);
    var result: vec4f = centerPixel;
    let centerCoC: f32 = BokehChannelCoC(centerPixel.a, shift);
    let CoC: f32 = BokehFilterCoC(abs(centerCoC), settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        let angle: f32 = 6.28318531 / f32(polygon.sides);
        var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        for (var i: i32 = 1; i < min(k, 5); i++)
        {
            var area: f32 = max(sin(f32(k - i) * angle), 0.0);
            if (BOKEH_CHARACTER > 0)
            {
                area *= BokehEdgeLength(i, polygon);
            }
            sum += area * BokehLineSum(MapSamp, MapSampSampler, uv,
                BokehPolygonEdge(i, polygon, false), CoC, centerCoC, shift, settings);
        }
        result = BokehResolve(sum, sum.a, centerPixel, false);
    }
    return result;
}

// Exact: one target of the first pass, where a pass can write only one
//   Call it for k = 2 .. sides / 2: it makes that target from the lines along edges 1 .. k - 1,
//   as BokehExactFirst does. For a hexagon that is one line more than with two targets.
fn BokehExactEdge(MapSamp: texture_2d<f32>, MapSampSampler: sampler, uv: vec2f, k: i32,
    polygon: BokehPolygon, settings: BokehFilter) -> vec4f
{
    var result: vec4f;
    if (BOKEH_CHARACTER > 1)
    {
        result = vec4f(0.0, 0.0, 0.0, 0.0);
        for (var channel: i32 = 0; channel < 3; channel++)
        {
            let mask: vec4f = BokehChannelMask(channel);
            let shift: f32 = dot(mask.rb, polygon.axial);
            let one: vec4f = BokehChannelEdge(MapSamp, MapSampSampler, uv, k, polygon, settings,
                shift);
            result += one * mask;
        }
    }
    else
    {
        result = BokehChannelEdge(MapSamp, MapSampSampler, uv, k, polygon, settings, 0.0);
    }
    return result;
}

// -------------------------------------------------------------------------------------------------
// [9] finished picture: lateral colour; debug views
// -------------------------------------------------------------------------------------------------

// Lateral colour: the red of a finished picture drawn larger than the green, the blue smaller
//   The last pass after any method; bloom and tone mapping come after it.
//   PictureSamp   linear filter, clamp
//   amount        -0.1 .. 0.1: share of its size that red is larger by, and blue smaller; below 0
//                 the reverse. 0.001 is about a pixel in the corners of 1920 x 1080.
//   returns       green and a are those of this pixel
fn BokehLateralColor(PictureSamp: texture_2d<f32>, PictureSampSampler: sampler, uv: vec2f,
    amount: f32) -> vec4f
{
    let larger: f32 = clamp(amount, -0.1, 0.1);
    let place: vec2f = uv - 0.5;
    let green: vec4f = BokehFetch(PictureSamp, PictureSampSampler, uv);
    let red: f32 = BokehFetch(PictureSamp, PictureSampSampler, place / (1.0 + larger) + 0.5).r;
    let blue: f32 = BokehFetch(PictureSamp, PictureSampSampler, place / (1.0 - larger) + 0.5).b;
    return vec4f(red, green.g, blue, green.a);
}

// Debug: linear depth as grey: black at the camera, 0.5 at the focus distance, white at infinity
fn BokehDebugDepth(S2: f32, S1: f32) -> vec4f
{
    let grey: f32 = S2 / (S2 + S1);
    return vec4f(grey, grey, grey, 1.0);
}

// Debug: CoC as grey, with or without a sign: black in focus, white at MaxCoC
fn BokehDebugCoC(CoC: f32, MaxCoC: f32) -> vec4f
{
    let grey: f32 = clamp(abs(CoC) / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    return vec4f(grey, grey, grey, 1.0);
}

// Debug: which side of the focus: near field orange, far field blue, in focus black; brighter with
//   the CoC
fn BokehDebugFocus(S2: f32, S1: f32, CoC: f32, MaxCoC: f32) -> vec4f
{
    let amount: f32 = clamp(abs(CoC) / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    var result: vec4f = vec4f(0.1 * amount, 0.4 * amount, amount, 1.0);
    if (S2 < S1)
    {
        result = vec4f(amount, 0.5 * amount, 0.0, 1.0);
    }
    return result;
}
