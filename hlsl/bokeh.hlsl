// SPDX-License-Identifier: MIT
//
// Polygonal bokeh depth of field, HLSL. Version 0.2.0.
// After McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures
// in a Post-Process Depth of Field Shader", Listings 1-4. Sections and figures are of that paper.
//
// CONTRACT
//   This file holds functions only: no bindings, no entry points. bokeh_passes.hlsl beside it has
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
// PASTE: the whole effect as an exact hexagon, four passes. Each program is this file and one of
//   these blocks. Blending off in all of them. uv comes from your vertex shader: 0 .. 1 over the
//   target, in Direct3D 9 moved by half a pixel as BokehFullScreen_VS does it. Shader model 4 to 6:
//   put #define BOKEH_HLSL_SM 4 (or 5, 6) first, and take the blocks further down.
//
//   1. Linear depth. DepthSamp: the depth buffer, nearest filter, clamp. Target: R32F.
//          sampler2D DepthSamp : register(s0);
//          float zNear, zFar;
//          float4 linearDepth(float2 uv : TEXCOORD0) : COLOR
//          {
//              return BokehLinearDepth(BokehFetchNearest(DepthSamp, uv).r, 1, zNear, zFar);
//          }
//
//   2. CoC map. ColorSamp: HDR colour, DepthSamp: from 1; both nearest, clamp. Target: RGBA16F.
//          sampler2D ColorSamp : register(s0);
//          sampler2D DepthSamp : register(s1);
//          float apertureDiameter, focalLength, focusDistance;
//          float4 map(float2 uv : TEXCOORD0) : COLOR
//          {
//              return BokehSignedCoCMap(ColorSamp, DepthSamp, uv, apertureDiameter, focalLength,
//                  focusDistance, BOKEH_SENSOR_HEIGHT, BOKEH_MAX_COC);
//          }
//
//   3. First pass. MapSamp: from 2, linear filter, clamp. Targets: two RGBA16F.
//          sampler2D MapSamp : register(s0);
//          float2 imageSize;
//          float rotation;
//          void first(float2 uv : TEXCOORD0, out float4 edge2 : COLOR0, out float4 edge3 : COLOR1)
//          {
//              BokehTargets targets = BokehExactFirst(MapSamp, uv,
//                  BokehMakePolygon(6, rotation, 1.0), BokehDefaultFilter(imageSize));
//              edge2 = targets.edge2;
//              edge3 = targets.edge3;
//          }
//
//   4. Second pass. Edge2Samp, Edge3Samp: from 3, linear filter, clamp. Target: RGBA16F.
//          sampler2D Edge2Samp : register(s0);
//          sampler2D Edge3Samp : register(s1);
//          float2 imageSize;
//          float rotation;
//          float4 second(float2 uv : TEXCOORD0) : COLOR
//          {
//              return BokehExactSecond(Edge2Samp, Edge3Samp, Edge3Samp, Edge3Samp, uv,
//                  BokehMakePolygon(6, rotation, 1.0), BokehDefaultFilter(imageSize));
//          }
//
//   Shader model 4 to 6. Linear: a sampler with a linear filter and clamp. Depth needs none.
//
//   1. Linear depth. Depth: the depth buffer. Target: R32F.
//          Texture2D Depth : register(t0);
//          float zNear, zFar;
//          float linearDepth(float4 position : SV_Position, float2 uv : TEXCOORD0) : SV_Target
//          {
//              return BokehLinearDepth(BokehFetchNearest(Depth, uv).r, 1, zNear, zFar);
//          }
//
//   2. CoC map. Color: HDR colour. Depth: from 1. Target: RGBA16F.
//          Texture2D Color : register(t0);
//          Texture2D Depth : register(t1);
//          float apertureDiameter, focalLength, focusDistance;
//          float4 map(float4 position : SV_Position, float2 uv : TEXCOORD0) : SV_Target
//          {
//              return BokehSignedCoCMap(Color, Depth, uv, apertureDiameter, focalLength,
//                  focusDistance, BOKEH_SENSOR_HEIGHT, BOKEH_MAX_COC);
//          }
//
//   3. First pass. Map: from 2. Targets: two RGBA16F.
//          Texture2D Map : register(t0);
//          SamplerState Linear : register(s0);
//          float2 imageSize;
//          float rotation;
//          void first(float4 position : SV_Position, float2 uv : TEXCOORD0,
//              out float4 edge2 : SV_Target0, out float4 edge3 : SV_Target1)
//          {
//              BokehTargets targets = BokehExactFirst(Map, Linear, uv,
//                  BokehMakePolygon(6, rotation, 1.0), BokehDefaultFilter(imageSize));
//              edge2 = targets.edge2;
//              edge3 = targets.edge3;
//          }
//
//   4. Second pass. Edge2, Edge3: from 3. Target: RGBA16F.
//          Texture2D Edge2 : register(t0);
//          Texture2D Edge3 : register(t1);
//          SamplerState Linear : register(s0);
//          float2 imageSize;
//          float rotation;
//          float4 second(float4 position : SV_Position, float2 uv : TEXCOORD0) : SV_Target
//          {
//              return BokehExactSecond(Edge2, Linear, Edge3, Edge3, Edge3, uv,
//                  BokehMakePolygon(6, rotation, 1.0), BokehDefaultFilter(imageSize));
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

#if defined(BOKEH_PRESET_LOW)
#define BOKEH_PRESET_SAMPLES 5
#define BOKEH_PRESET_SPACING 2.0
#elif defined(BOKEH_PRESET_MEDIUM)
#define BOKEH_PRESET_SAMPLES 9
#define BOKEH_PRESET_SPACING 1.5
#elif defined(BOKEH_PRESET_HIGH)
#define BOKEH_PRESET_SAMPLES 17
#define BOKEH_PRESET_SPACING 1.0
#elif defined(BOKEH_PRESET_ULTRA)
#define BOKEH_PRESET_SAMPLES 33
#define BOKEH_PRESET_SPACING 1.0
#else
#define BOKEH_PRESET_SAMPLES 13
#define BOKEH_PRESET_SPACING 1.0
#endif

#ifndef BOKEH_NUM_SAMPLES
#define BOKEH_NUM_SAMPLES BOKEH_PRESET_SAMPLES
#endif
#ifndef BOKEH_SPACING
#define BOKEH_SPACING BOKEH_PRESET_SPACING
#endif
#ifndef BOKEH_ADAPTIVE_SAMPLES
#define BOKEH_ADAPTIVE_SAMPLES 1
#endif
#ifndef BOKEH_VIEWPORT
#define BOKEH_VIEWPORT 0
#endif
#ifndef BOKEH_CHARACTER
#define BOKEH_CHARACTER 0
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
#if BOKEH_CHARACTER < 0 || BOKEH_CHARACTER > 2
#error BOKEH_CHARACTER must be 0, 1 or 2
#endif

// -------------------------------------------------------------------------------------------------
// [2] porting: the one place where the three languages differ
// -------------------------------------------------------------------------------------------------
//
//   BOKEH_HLSL_SM: 3 (sampler2D, tex2Dlod) or 4, 5, 6 (Texture2D, SamplerState). Unset: 6 under
//   DXC, else 3. From 4 up a filtered texture and its sampler are two parameters, Name and
//   NameSampler; where a function reads several, they share the sampler of the first. Depth has
//   none.

#ifndef BOKEH_HLSL_SM
#ifdef __hlsl_dx_compiler
#define BOKEH_HLSL_SM 6
#else
#define BOKEH_HLSL_SM 3
#endif
#endif

#if BOKEH_HLSL_SM == 3 && BOKEH_CHARACTER > 1
#error BOKEH_CHARACTER 2 needs shader model 4: fxc compiles its loops wrongly for 3
#endif

// BOKEH_TEXTURE, BOKEH_TEXELS: a parameter with a sampler, and one without
// BOKEH_ARGUMENT, BOKEH_SHARED: a texture handed to BokehFetch with its own sampler, or another's
// BOKEH_LOOP: before a loop whose count is known at run time only, or large: fxc would write it out
//   all the same, and DXC's [loop] forbids the driver to (RADV: 2 to 16 times the latency)
// BOKEH_LOOP_LIMIT: the most iterations that one loop may have
#if BOKEH_HLSL_SM == 3
#define BOKEH_TEXTURE(name) sampler2D name
#define BOKEH_TEXELS(name) sampler2D name
#define BOKEH_ARGUMENT(name) name
#define BOKEH_SHARED(name, other) name
#define BOKEH_LOOP
#define BOKEH_LOOP_LIMIT 128
#elif BOKEH_HLSL_SM == 4 || BOKEH_HLSL_SM == 5 || BOKEH_HLSL_SM == 6
#define BOKEH_TEXTURE(name) Texture2D name, SamplerState name##Sampler
#define BOKEH_TEXELS(name) Texture2D name
#define BOKEH_ARGUMENT(name) name, name##Sampler
#define BOKEH_SHARED(name, other) name, other##Sampler
#if BOKEH_HLSL_SM == 6
#define BOKEH_LOOP
#else
#define BOKEH_LOOP [loop]
#endif
#define BOKEH_LOOP_LIMIT BOKEH_NUM_SAMPLES
#else
#error BOKEH_HLSL_SM must be 3, 4, 5 or 6
#endif

// where the image lies in its textures, in their uv: xy = its corner, zw = its size; then the
// bounds of the fetches
static float4 BokehViewport = float4(0.0, 0.0, 1.0, 1.0);
static float4 BokehViewportBounds = float4(0.0, 0.0, 1.0, 1.0);

// Porting: the image is a part of its textures (dynamic resolution); call it first
//   It needs BOKEH_VIEWPORT 1.
//   Every texture but the kernel is laid out like this. What is around the image is not read: it
//   may hold anything. The bounds are 1/128 texel inside the centres of the outermost texels, since
//   bilinear filtering reads texels of zero weight too, and 0 times NaN is NaN; 1/256 is how
//   exactly devices place a sample (Direct3D 11, Vulkan).
//   viewport      x, y of its first pixel, width, height; pixels, 2 x 2 or more
//   textureSize   width, height; pixels
void BokehSetViewport(float4 viewport, float2 textureSize)
{
    if (BOKEH_VIEWPORT > 0)
    {
        float2 inset = min(float2(0.5078125, 0.5078125), viewport.zw * 0.5);
        BokehViewport = viewport / textureSize.xyxy;
        BokehViewportBounds = float4(viewport.xy + inset, viewport.xy + viewport.zw - inset) /
            textureSize.xyxy;
    }
}

// Porting: image uv to texture uv
float2 BokehToTexture(float2 uv)
{
    float2 coords = uv;
    if (BOKEH_VIEWPORT > 0)
    {
        coords = clamp(BokehViewport.xy + uv * BokehViewport.zw, BokehViewportBounds.xy,
            BokehViewportBounds.zw);
    }
    return coords;
}

// Porting: one filtered fetch at level 0, without gradients: it may be in a loop or a branch
//   coords        texture uv
float4 BokehFetchTexture(BOKEH_TEXTURE(tex), float2 coords)
{
#if BOKEH_HLSL_SM == 3
    return tex2Dlod(tex, float4(coords, 0.0, 0.0));
#else
    return tex.SampleLevel(texSampler, coords, 0.0);
#endif
}

// Porting: the same at image uv
float4 BokehFetch(BOKEH_TEXTURE(tex), float2 uv)
{
    return BokehFetchTexture(BOKEH_ARGUMENT(tex), BokehToTexture(uv));
}

// Porting: the texel at a place, whatever filter the texture has; depth is read this way
//   Shader model 3 cannot: there the sampler must have a nearest filter.
float4 BokehFetchNearest(BOKEH_TEXELS(tex), float2 uv)
{
#if BOKEH_HLSL_SM == 3
    return tex2Dlod(tex, float4(BokehToTexture(uv), 0.0, 0.0));
#else
    int2 size;
    tex.GetDimensions(size.x, size.y);
    int2 texel = int2(saturate(BokehToTexture(uv)) * float2(size));
    return tex.Load(int3(min(texel, size - int2(1, 1)), 0));
#endif
}

// Porting: entry i of a table, a texture of count x 1 texels; no viewport applies to it
float4 BokehFetchTable(BOKEH_TEXELS(tex), int i, int count)
{
#if BOKEH_HLSL_SM == 3
    return tex2Dlod(tex, float4((float(i) + 0.5) / float(count), 0.5, 0.0, 0.0));
#else
    return tex.Load(int3(min(i, count - 1), 0, 0));
#endif
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
float BokehCoC(float S2, float A, float f, float S1, float sensorHeight, float MaxCoC)
{
    float focus = min(S1, BOKEH_MAX_DEPTH);
    float magnification = f / max(focus - f, BOKEH_MIN_DEPTH);
    float c = A * magnification * (abs(S2 - focus) / S2);
    return clamp(c / max(sensorHeight, BOKEH_MIN_DEPTH), 0.0, MaxCoC);
}

// Listing 1: one colour channel made safe: NaN and negative become 0, infinite becomes the largest
//   half float
//   NaN fails this comparison; max() may return either operand. It has to be >=: fxc compiles > for
//   shader model 3 to the opposite comparison with its results swapped, and NaN passes that.
float BokehSafeChannel(float value)
{
    float safe = 0.0;
    if (value >= 0.0)
    {
        safe = min(value, BOKEH_MAX_COLOR);
    }
    return safe;
}

// Listing 1: depth made safe: NaN, zero and negative become the smallest, infinite the largest
float BokehSafeDepth(float S2)
{
    float safe = BOKEH_MIN_DEPTH;
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
float BokehDepthFromWindow(float depth, float zNear, float zFar)
{
    return zNear * zFar / (zFar - depth * (zFar - zNear));
}

// Depth: reversed window depth, 1 (near) .. 0 (far), of a perspective camera to metres
float BokehDepthFromReversed(float depth, float zNear, float zFar)
{
    return zNear * zFar / (zNear + depth * (zFar - zNear));
}

// Depth: reversed window depth without a far plane, 1 (near) .. 0 (infinite), to metres
//   The sky is at BOKEH_MAX_DEPTH.
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

// Depth: window depth 0 (near) .. 1 (far) of an orthographic camera to metres
//   Pass 1 - depth where it is reversed.
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
//   kind          0 metres already, 1 window, 2 reversed, 3 reversed infinite, 4 clip,
//                 5 orthographic, 6 orthographic reversed, 7 fraction of zFar, 8 logarithmic
float BokehLinearDepth(float depth, int kind, float zNear, float zFar)
{
    float S2 = depth;
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
float4 BokehPackCoC(float4 color, float CoC)
{
    return float4(BokehSafeChannel(color.r), BokehSafeChannel(color.g), BokehSafeChannel(color.b),
        CoC);
}

// Listing 1: CoCMap, the first pass of `paper` and `naive`
//   No later pass sees the engine's raw colour.
//   ColorSamp     linear HDR scene colour, read texel by texel
//   DepthSamp     r = depth along the view axis, metres (docs/inputs.md has the depth conventions)
//   uv            centre of this pixel, 0 .. 1, v = 0 at the first row in memory
//   A .. MaxCoC   as in BokehCoC
//   returns       rgb = colour, a = CoC
float4 BokehCoCMap(BOKEH_TEXELS(ColorSamp), BOKEH_TEXELS(DepthSamp), float2 uv, float A, float f,
    float S1, float sensorHeight, float MaxCoC)
{
    float S2 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    float CoC = BokehCoC(S2, A, f, S1, sensorHeight, MaxCoC);
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
float BokehSignedCoC(float S2, float A, float f, float S1, float sensorHeight, float MaxCoC)
{
    float CoC = BokehCoC(S2, A, f, S1, sensorHeight, MaxCoC);
    if (S2 < S1)
    {
        CoC = -CoC;
    }
    return CoC;
}

// Listing 1, signed: the first pass of `exact`, whose later passes read no depth
//   Parameters as in BokehCoCMap.
//   returns       rgb = colour, a = signed CoC
float4 BokehSignedCoCMap(BOKEH_TEXELS(ColorSamp), BOKEH_TEXELS(DepthSamp), float2 uv, float A,
    float f, float S1, float sensorHeight, float MaxCoC)
{
    float S2 = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    float CoC = BokehSignedCoC(S2, A, f, S1, sensorHeight, MaxCoC);
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
    float aspectRatio;
    float imageHeight;
    float spacing;
    float jitter;
    float bleedingBias;
    float bleedingMult;
};

// Listing 2: the settings that [1] configures, without jitter
//   imageSize     width, height; pixels
BokehFilter BokehDefaultFilter(float2 imageSize)
{
    BokehFilter settings;
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
float2 BokehLineEnd(float angle, float aspectRatio)
{
    return float2(0.5 * cos(angle) / aspectRatio, 0.5 * sin(angle));
}

// Listing 2: makeOffsets, sample i of numSamples evenly spaced from end to end of the line
//   t runs from -1 to +1, so that the offsets are exact negatives of each other and the middle one
//   is 0.
//   returns       uv offset for a CoC of 1
float2 BokehMakeOffsets(float2 lineEnd, int i, int numSamples)
{
    int last = max(numSamples, 2) - 1;
    float t = float(2 * i - last) / float(last);
    return lineEnd * t;
}

// Listing 2, adaptive: the CoC that the filter uses, 0 where the pixel is in focus
//   Below half a pixel nothing is left to blur; up to one pixel it fades in, so that no contour
//   shows.
//   Written (x - 0.5) * 2: from 2 - 2 abs(x) fxc drops the abs in shader model 3.
//   CoC           without a sign
//   spacing       as in BokehFilter; 0 or less: the CoC as it is
//   returns       fraction of the image height
float BokehFilterCoC(float CoC, float imageHeight, float spacing)
{
    float filterCoC = CoC;
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
float BokehCells(float lengthInPixels, float spacing)
{
    float cells = float(BOKEH_NUM_SAMPLES);
    if (BOKEH_ADAPTIVE_SAMPLES > 0 && spacing > 0.0)
    {
        cells = clamp(lengthInPixels / spacing, 1.0, float(BOKEH_NUM_SAMPLES));
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
float BokehNoise(float2 uv, float2 imageSize, float frame, float passIndex)
{
    float number = (8.0 * passIndex + 1.0) * (frame - 64.0 * floor(frame / 64.0)) + passIndex;
    float seed = dot(floor(uv * imageSize), float2(0.06711056, 0.00583715));
    float value = 52.9829189 * (seed - floor(seed)) + 0.515625 * number;
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
float4 BokehSegment(float angle, float lineLength, float2 lineCenter, float squeeze)
{
    float4 segment = float4(lineCenter, 0.5 * lineLength * cos(angle), 0.5 * lineLength *
        sin(angle));
    return segment * float4(squeeze, 1.0, squeeze, 1.0);
}

// -------------------------------------------------------------------------------------------------
// [5] Listing 3: one pass of the line filter
// -------------------------------------------------------------------------------------------------

// Listing 3: weight of one sample against intensity leakage (section 2.1)
//   A sample that is nearer to the camera and clearly sharper than this pixel would leak onto it.
//   Its weight is its own CoC then, times bleedingMult: 0 in focus, 1 from a CoC of
//   1 / bleedingMult up. All other samples have the weight 1.
float BokehLeakageWeight(float sampleDepth, float sampleCoC, float centerDepth, float centerCoC,
    BokehFilter settings)
{
    float weight = 1.0;
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
float BokehSignedLeakageWeight(float sampleCoC, float centerCoC, BokehFilter settings)
{
    float scale = 1.0 / max(settings.bleedingBias, 0.001);
    float rejected = clamp((centerCoC * scale - 0.5) - abs(sampleCoC) * scale, 0.0, 1.0);
    float weight = clamp(abs(sampleCoC) * settings.bleedingMult, 0.0, 1.0);
    return 1.0 - rejected * (1.0 - weight * weight);
}

// Listing 3: the weighted average, or centerPixel where all weights are 0
//   With an even number of samples the middle of the line is not sampled, so all may be rejected.
//   blurCoC       true: the CoC is averaged with the colour; false: this pixel keeps its CoC
//                 (Figure 7)
float4 BokehResolve(float4 color, float totalWeight, float4 centerPixel, bool blurCoC)
{
    float4 result = centerPixel;
    if (totalWeight > 0.0)
    {
        result = color / totalWeight;
    }
    if (!blurCoC)
    {
        result = float4(result.rgb, centerPixel.a);
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
float4 BokehDepthOfField(BOKEH_TEXTURE(ColorSamp), BOKEH_TEXELS(DepthSamp), float2 uv,
    float2 lineEnd, BokehFilter settings, bool blurCoC)
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), uv);
    float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    float4 color = float4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    BOKEH_LOOP for (int i = 0; i < BOKEH_NUM_SAMPLES; i++)
    {
        float2 offset = BokehMakeOffsets(lineEnd, i, BOKEH_NUM_SAMPLES);
        float2 sampleCoords = uv + offset * centerPixel.a;
        float4 samplePixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), sampleCoords);
        float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
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
float4 BokehDepthOfFieldAdaptive(BOKEH_TEXTURE(ColorSamp), BOKEH_TEXELS(DepthSamp), float2 uv,
    float4 segment, BokehFilter settings, bool blurCoC)
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), uv);
    float4 result = centerPixel;
    float CoC = BokehFilterCoC(centerPixel.a, settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
        float lengthInPixels = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
        float cells = BokehCells(lengthInPixels, settings.spacing);
        float phase = 0.5 + settings.jitter * clamp(lengthInPixels / cells - 1.0, 0.0, 1.0);
        float2 scale = float2(CoC / settings.aspectRatio, CoC);
        float2 first = uv + (segment.xy - segment.zw) * scale;
        float2 cellLength = segment.zw * scale * (2.0 / cells);
        float4 color = float4(0.0, 0.0, 0.0, 0.0);
        float totalWeight = 0.0;
        BOKEH_LOOP for (int i = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            if (BOKEH_ADAPTIVE_SAMPLES > 0 && float(i) >= cells)
            {
                break;
            }
            float cell = clamp(cells - float(i), 0.0, 1.0);
            float2 sampleCoords = first + cellLength * (float(i) + cell * phase);
            float4 samplePixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), sampleCoords);
            float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
            float weight = cell * BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
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
float4 BokehCombine(float4 a, float4 b, bool useMax)
{
    float4 result = min(a, b);
    if (useMax)
    {
        result = max(a, b);
    }
    return result;
}

// Listing 4: DepthOfFieldFinal, the last line of the second parallelogram, combined with the first
//   CompareSamp   the finished first parallelogram
//   useMax        false: intersection (hexagon, octagon); true: union (star)
float4 BokehDepthOfFieldFinal(BOKEH_TEXTURE(ColorSamp), BOKEH_TEXELS(DepthSamp),
    BOKEH_TEXELS(CompareSamp), float2 uv, float2 lineEnd, BokehFilter settings, bool blurCoC,
    bool useMax)
{
    float4 a = BokehDepthOfField(BOKEH_ARGUMENT(ColorSamp), DepthSamp, uv, lineEnd, settings,
        blurCoC);
    return BokehCombine(a, BokehFetch(BOKEH_SHARED(CompareSamp, ColorSamp), uv), useMax);
}

// -------------------------------------------------------------------------------------------------
// [7] naive gather
// -------------------------------------------------------------------------------------------------

// Section 3: gather with a table of BOKEH_NUM_SAMPLES offsets, any shape
//   The bokeh is their point reflection: negate a table that is drawn as the bokeh looks.
//   KernelSamp    BOKEH_NUM_SAMPLES x 1 texels, rg = offset in units of the CoC, x to the right, y
//                 towards the last row
float4 BokehNaiveGather(BOKEH_TEXTURE(ColorSamp), BOKEH_TEXELS(DepthSamp), BOKEH_TEXELS(KernelSamp),
    float2 uv, BokehFilter settings, bool blurCoC)
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), uv);
    float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    float2 scale = float2(centerPixel.a / settings.aspectRatio, centerPixel.a);
    float4 color = float4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    BOKEH_LOOP for (int j = 0; j < BOKEH_NUM_SAMPLES; j += BOKEH_LOOP_LIMIT) // differs: 255 loops
    BOKEH_LOOP for (int i = j; i < min(j + BOKEH_LOOP_LIMIT, BOKEH_NUM_SAMPLES); i++)
    {
        float2 offset = BokehFetchTable(KernelSamp, i, BOKEH_NUM_SAMPLES).rg;
        float2 sampleCoords = uv + offset * scale;
        float4 samplePixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), sampleCoords);
        float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
        float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth, centerPixel.a,
            settings);
        color += samplePixel * weight;
        totalWeight += weight;
    }
    return BokehResolve(color, totalWeight, centerPixel, blurCoC);
}

// Section 3: gather over a parallelogram grid, offsets computed instead of read (Table 1)
//   BOKEH_NUM_SAMPLES is the number along a side: 4, 8, 12, 16, 20, 24 for the counts of Table 1.
//   lineEndU, lineEndV  the two sides, from BokehLineEnd
float4 BokehNaiveGrid(BOKEH_TEXTURE(ColorSamp), BOKEH_TEXELS(DepthSamp), float2 uv, float2 lineEndU,
    float2 lineEndV, BokehFilter settings, bool blurCoC)
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), uv);
    float centerDepth = BokehSafeDepth(BokehFetchNearest(DepthSamp, uv).r);
    float4 color = float4(0.0, 0.0, 0.0, 0.0);
    float totalWeight = 0.0;
    BOKEH_LOOP for (int j = 0; j < BOKEH_NUM_SAMPLES; j++)
    {
        float2 rowOffset = BokehMakeOffsets(lineEndV, j, BOKEH_NUM_SAMPLES);
        BOKEH_LOOP for (int i = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            float2 offset = rowOffset + BokehMakeOffsets(lineEndU, i, BOKEH_NUM_SAMPLES);
            float2 sampleCoords = uv + offset * centerPixel.a;
            float4 samplePixel = BokehFetch(BOKEH_ARGUMENT(ColorSamp), sampleCoords);
            float sampleDepth = BokehFetchNearest(DepthSamp, sampleCoords).r;
            float weight = BokehLeakageWeight(sampleDepth, samplePixel.a, centerDepth,
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
    int sides;
    float rotation;
    float squeeze;
    float4 lengths;
    float fifth;
    float roundness;
    float2 axial;
};

// Exact: what the first pass writes: what the second one blurs along edges 2 to 5; those that the
//   polygon does not have hold the unblurred pixel
struct BokehTargets
{
    float4 edge2;
    float4 edge3;
    float4 edge4;
    float4 edge5;
};

// Exact: a BokehPolygon in one expression
BokehPolygon BokehMakePolygon(int sides, float rotation, float squeeze)
{
    BokehPolygon polygon;
    polygon.sides = sides;
    polygon.rotation = rotation;
    polygon.squeeze = squeeze;
    polygon.lengths = float4(0.0, 0.0, 0.0, 0.0);
    polygon.fifth = 0.0;
    polygon.roundness = 1.0;
    polygon.axial = float2(0.0, 0.0);
    if (BOKEH_CHARACTER > 0)
    {
        polygon.fifth = sin(3.14159265 / float(sides));
        polygon.lengths = float4(polygon.fifth, polygon.fifth, polygon.fifth, polygon.fifth);
    }
    return polygon;
}

// Exact: a vector rotated, from +x towards +y
//   axis          (cos, sin) of the angle
float2 BokehRotated(float2 direction, float2 axis)
{
    return float2(direction.x * axis.x - direction.y * axis.y,
        direction.x * axis.y + direction.y * axis.x);
}

// Exact: length of edge k of a polygon that is cut
//   k             1 .. sides / 2
float BokehEdgeLength(int k, BokehPolygon polygon)
{
    float edgeLength = polygon.lengths.x;
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
float2 BokehEdgeVector(int k, BokehPolygon polygon)
{
    float angle = 6.28318531 / float(polygon.sides) * float(k);
    return float2(-sin(angle), cos(angle)) * BokehEdgeLength(k, polygon);
}

// Exact: the line of edge k of a polygon that is cut, as in BokehPolygonEdge; not rotated, not
//   squeezed
//   The polygon is the sum of its edges: it begins at minus half of all of them.
float4 BokehCutEdge(int k, BokehPolygon polygon, bool secondPass)
{
    float2 corner = float2(0.0, 0.0);
    for (int i = 1; i <= polygon.sides / 2; i++)
    {
        corner -= BokehEdgeVector(i, polygon) * 0.5;
    }
    float2 begin = corner;
    float2 middle = float2(0.0, 0.0);
    float2 meanOfFirst = float2(0.0, 0.0);
    for (int j = 1; j <= polygon.sides / 2; j++)
    {
        float2 edge = BokehEdgeVector(j, polygon);
        if (j == k)
        {
            middle = begin + edge * 0.5;
        }
        if (j < polygon.sides / 2)
        {
            meanOfFirst += (begin + edge * 0.5) / (0.5 * float(polygon.sides) - 1.0);
        }
        begin += edge;
    }
    middle -= meanOfFirst;
    if (secondPass)
    {
        middle = -middle - corner;
    }
    return float4(middle, BokehEdgeVector(k, polygon) * 0.5);
}

// Exact: the line of edge k in one of the two passes
//   If both passes put their lines on the outline, every sample of the first pass would be on one
//   side of the pixel. So the first pass is moved by the mean of its lines to the middle, and the
//   second pass back. All but the last statements are constants where sides is a literal.
//   k             1 .. sides / 2
//   secondPass    false: first pass
//   returns       xy = middle, zw = from the middle to the end; in units of the CoC, x to the right
float4 BokehPolygonEdge(int k, BokehPolygon polygon, bool secondPass)
{
    float halfStep = 3.14159265 / float(polygon.sides);
    float angle = 2.0 * halfStep * float(k);
    float2 outwards = float2(cos(angle), sin(angle));
    float meanOfFirst = 0.5 * cos(halfStep) * cos(halfStep) /
        (sin(halfStep) * (0.5 * float(polygon.sides) - 1.0));
    float2 middle = outwards * (0.5 * cos(halfStep)) - float2(0.0, meanOfFirst);
    if (secondPass)
    {
        middle = -middle - float2(0.5 * cos(halfStep), 0.5 * sin(halfStep));
    }
    float2 halfEdge = float2(-outwards.y, outwards.x) * (0.5 * sin(halfStep));
    if (BOKEH_CHARACTER > 0)
    {
        float4 edge = BokehCutEdge(k, polygon, secondPass);
        middle = edge.xy;
        halfEdge = edge.zw;
    }
    float2 axis = float2(cos(polygon.rotation), sin(polygon.rotation));
    float4 segment = float4(BokehRotated(middle, axis), BokehRotated(halfEdge, axis));
    return segment * float4(polygon.squeeze, 1.0, polygon.squeeze, 1.0);
}

// Exact: area of the parallelograms of edge k with edges 1 .. k - 1; of a polygon that is not cut,
//   for edges of length 1
float BokehExactWeight(int k, BokehPolygon polygon)
{
    float halfStep = 3.14159265 / float(polygon.sides);
    float area = sin(float(k) * halfStep) * sin((float(k) - 1.0) * halfStep) / sin(halfStep);
    if (BOKEH_CHARACTER > 0)
    {
        area = 0.0;
        for (int i = 1; i < k; i++)
        {
            area += sin(2.0 * halfStep * float(k - i)) * BokehEdgeLength(i, polygon);
        }
        area *= BokehEdgeLength(k, polygon);
    }
    return area;
}

// Exact: distance of edge k from the middle of a polygon that is cut, units of the CoC
//   cut           xy = along which, z = the mean of two neighbours' distances before the cut, w =
//                 half of how much more it is where k is even
float BokehHalfWidth(int k, int sides, float4 cut)
{
    float angle = 6.28318531 / float(sides) * float(k);
    float whole = cut.z + cut.w * cos(3.14159265 * float(k));
    return whole * (1.0 - abs(cut.x * cos(angle) + cut.y * sin(angle)));
}

// Exact: length of edge k between the lines of all other edges
//
//      before after
//      ,---+---,   edge k is on a line half a width from the middle; on both sides it ends where
//     /    |    '  the nearest of the other lines crosses that one
//
//   returns       units of the CoC; 0.001 where nothing is left, so that no weights add up to 0
float BokehCutLength(int k, int sides, float4 cut)
{
    float halfWidth = BokehHalfWidth(k, sides, cut);
    // before and after
    float2 ends = float2(1.0, 1.0);
    for (int i = 1; i < sides / 2; i++)
    {
        float angle = 6.28318531 / float(sides) * float(i);
        float2 others = float2(BokehHalfWidth(k - i, sides, cut),
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
BokehPolygon BokehWithCatsEye(BokehPolygon polygon, float2 uv, float2 imageSize, float amount)
{
    float2 place = (uv * 2.0 - 1.0) * imageSize / length(imageSize);
    float2 axis = float2(cos(polygon.rotation), -sin(polygon.rotation));
    float2 along = BokehRotated(place, axis) * clamp(amount, 0.0, 0.9);
    BokehPolygon result = polygon;
    int sides = clamp(polygon.sides, 4, 10);
    result.sides = sides;
    float even = 0.5 * cos(3.14159265 / float(sides));
    float odd = even;
    if (sides == 8)
    {
        // corners stay on the circle: what an edge has less of it, its neighbours have more
        float corner = 0.39269908 * clamp(polygon.roundness, 0.0, 1.0);
        even = 0.5 * cos(0.78539816 - corner);
        odd = 0.5 * cos(corner);
    }
    float4 cut = float4(along, 0.5 * (even + odd), 0.5 * (even - odd));
    result.lengths = float4(BokehCutLength(1, sides, cut), BokehCutLength(2, sides, cut),
        BokehCutLength(3, sides, cut), BokehCutLength(4, sides, cut));
    result.fifth = BokehCutLength(5, sides, cut);
    return result;
}

// Exact: signed CoC of a colour channel
//   shift         axial colour: how much more of it the channel has than green; fraction of image
//                 height
float BokehChannelCoC(float signedCoC, float shift)
{
    float CoC = signedCoC;
    if (BOKEH_CHARACTER > 1)
    {
        CoC += shift;
    }
    return CoC;
}

// Exact: axial colour: what a channel of the blur writes: 0 red, 1 green and the CoC, 2 blue
float4 BokehChannelMask(int channel)
{
    return float4(float(channel == 0), float(channel == 1), float(channel == 2),
        float(channel == 1));
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
float4 BokehLineSum(BOKEH_TEXTURE(MapSamp), float2 uv, float4 segment, float CoC, float centerCoC,
    float shift, BokehFilter settings)
{
    float lengthInPixels = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
    float cells = BokehCells(lengthInPixels, settings.spacing);
    float phase = 0.5 + settings.jitter * clamp(lengthInPixels / cells - 1.0, 0.0, 1.0);
    float2 scale = float2(CoC / settings.aspectRatio, CoC);
    float2 first = uv + (segment.xy - segment.zw) * scale;
    float2 cellLength = segment.zw * scale * (2.0 / cells);
    float4 sum = float4(0.0, 0.0, 0.0, 0.0);
    BOKEH_LOOP for (int i = 0; i < BOKEH_NUM_SAMPLES; i++)
    {
        if (BOKEH_ADAPTIVE_SAMPLES > 0 && float(i) >= cells)
        {
            break;
        }
        float cell = clamp(cells - float(i), 0.0, 1.0);
        float4 samplePixel = BokehFetch(BOKEH_ARGUMENT(MapSamp),
            first + cellLength * (float(i) + cell * phase));
        float sampleCoC = BokehChannelCoC(samplePixel.a, shift);
        float weight = cell * BokehSignedLeakageWeight(sampleCoC, centerCoC, settings);
        sum += float4(samplePixel.rgb, 1.0) * weight;
    }
    return sum / cells;
}

// Exact: what the first pass writes for edge k: the blurs along the edges before it, weighted by
//   their parallelograms and divided once, by the sum of all weights
//   L1 .. L4      from BokehLineSum, along edges 1 to 4; only those before edge k count
//   returns       rgb = colour, a = CoC of this pixel: the second pass blurs by the unblurred CoC
float4 BokehExactTarget(int k, BokehPolygon polygon, float4 L1, float4 L2, float4 L3, float4 L4,
    float4 centerPixel)
{
    float angle = 6.28318531 / float(polygon.sides);
    float w1 = sin((float(k) - 1.0) * angle);
    float w2 = max(sin((float(k) - 2.0) * angle), 0.0);
    float w3 = max(sin((float(k) - 3.0) * angle), 0.0);
    float w4 = max(sin((float(k) - 4.0) * angle), 0.0);
    if (BOKEH_CHARACTER > 0)
    {
        w1 *= polygon.lengths.x;
        w2 *= polygon.lengths.y;
        w3 *= polygon.lengths.z;
        w4 *= polygon.lengths.w;
    }
    float4 sum = L1 * w1 + L2 * w2 + L3 * w3 + L4 * w4;
    return BokehResolve(sum, sum.a, centerPixel, false);
}

// Exact: BokehExactFirst with one CoC for all channels
//   shift         as in BokehChannelCoC
BokehTargets BokehChannelFirst(BOKEH_TEXTURE(MapSamp), float2 uv, BokehPolygon polygon,
    BokehFilter settings, float shift)
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(MapSamp), uv);
    BokehTargets targets;
    targets.edge2 = centerPixel;
    targets.edge3 = centerPixel;
    targets.edge4 = centerPixel;
    targets.edge5 = centerPixel;
    float centerCoC = BokehChannelCoC(centerPixel.a, shift);
    float CoC = BokehFilterCoC(abs(centerCoC), settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        // the targets come last: until then only the lines take registers
        float4 L1 = BokehLineSum(BOKEH_ARGUMENT(MapSamp), uv, BokehPolygonEdge(1, polygon, false),
            CoC, centerCoC, shift, settings);
        float4 L2 = float4(0.0, 0.0, 0.0, 0.0);
        float4 L3 = L2;
        float4 L4 = L2;
        if (polygon.sides > 4)
        {
            L2 = BokehLineSum(BOKEH_ARGUMENT(MapSamp), uv, BokehPolygonEdge(2, polygon, false), CoC,
                centerCoC, shift, settings);
        }
        if (polygon.sides > 6)
        {
            L3 = BokehLineSum(BOKEH_ARGUMENT(MapSamp), uv, BokehPolygonEdge(3, polygon, false), CoC,
                centerCoC, shift, settings);
        }
        if (polygon.sides > 8)
        {
            L4 = BokehLineSum(BOKEH_ARGUMENT(MapSamp), uv, BokehPolygonEdge(4, polygon, false), CoC,
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
BokehTargets BokehExactFirst(BOKEH_TEXTURE(MapSamp), float2 uv, BokehPolygon polygon,
    BokehFilter settings)
{
    BokehTargets targets;
    if (BOKEH_CHARACTER > 1)
    {
        targets.edge2 = float4(0.0, 0.0, 0.0, 0.0);
        targets.edge3 = float4(0.0, 0.0, 0.0, 0.0);
        targets.edge4 = float4(0.0, 0.0, 0.0, 0.0);
        targets.edge5 = float4(0.0, 0.0, 0.0, 0.0);
        BOKEH_LOOP for (int channel = 0; channel < 3; channel++)
        {
            float4 mask = BokehChannelMask(channel);
            float shift = dot(mask.rb, polygon.axial);
            BokehTargets one = BokehChannelFirst(BOKEH_ARGUMENT(MapSamp), uv, polygon, settings,
                shift);
            targets.edge2 += one.edge2 * mask;
            targets.edge3 += one.edge3 * mask;
            targets.edge4 += one.edge4 * mask;
            targets.edge5 += one.edge5 * mask;
        }
    }
    else
    {
        targets = BokehChannelFirst(BOKEH_ARGUMENT(MapSamp), uv, polygon, settings, 0.0);
    }
    return targets;
}

// Exact: BokehExactSecond with one CoC for all channels
//   shift         as in BokehChannelCoC
float4 BokehChannelSecond(BOKEH_TEXTURE(Edge2Samp), BOKEH_TEXELS(Edge3Samp),
    BOKEH_TEXELS(Edge4Samp), BOKEH_TEXELS(Edge5Samp), float2 uv, BokehPolygon polygon,
    BokehFilter settings, float shift)
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(Edge2Samp), uv);
    float4 result = centerPixel;
    float centerCoC = BokehChannelCoC(centerPixel.a, shift);
    float CoC = BokehFilterCoC(abs(centerCoC), settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        float4 sum = BokehExactWeight(2, polygon) * BokehLineSum(BOKEH_ARGUMENT(Edge2Samp), uv,
            BokehPolygonEdge(2, polygon, true), CoC, centerCoC, shift, settings);
        if (polygon.sides > 4)
        {
            sum += BokehExactWeight(3, polygon) * BokehLineSum(BOKEH_SHARED(Edge3Samp, Edge2Samp),
                uv, BokehPolygonEdge(3, polygon, true), CoC, centerCoC, shift, settings);
        }
        if (polygon.sides > 6)
        {
            sum += BokehExactWeight(4, polygon) * BokehLineSum(BOKEH_SHARED(Edge4Samp, Edge2Samp),
                uv, BokehPolygonEdge(4, polygon, true), CoC, centerCoC, shift, settings);
        }
        if (polygon.sides > 8)
        {
            sum += BokehExactWeight(5, polygon) * BokehLineSum(BOKEH_SHARED(Edge5Samp, Edge2Samp),
                uv, BokehPolygonEdge(5, polygon, true), CoC, centerCoC, shift, settings);
        }
        result = BokehResolve(sum, sum.a, centerPixel, false);
    }
    return result;
}

// Exact: second pass, the finished polygon
//   Edge2Samp ..  what the first pass wrote; linear filter, clamp. Where there are fewer, pass any
//                 of them for the rest: it is not read.
//   returns       rgb = colour, a = signed CoC of this pixel, as BokehSignedCoCMap made it
float4 BokehExactSecond(BOKEH_TEXTURE(Edge2Samp), BOKEH_TEXELS(Edge3Samp), BOKEH_TEXELS(Edge4Samp),
    BOKEH_TEXELS(Edge5Samp), float2 uv, BokehPolygon polygon, BokehFilter settings)
{
    float4 result;
    if (BOKEH_CHARACTER > 1)
    {
        result = float4(0.0, 0.0, 0.0, 0.0);
        BOKEH_LOOP for (int channel = 0; channel < 3; channel++)
        {
            float4 mask = BokehChannelMask(channel);
            float shift = dot(mask.rb, polygon.axial);
            float4 one = BokehChannelSecond(BOKEH_ARGUMENT(Edge2Samp), Edge3Samp, Edge4Samp,
                Edge5Samp, uv, polygon, settings, shift);
            result += one * mask;
        }
    }
    else
    {
        result = BokehChannelSecond(BOKEH_ARGUMENT(Edge2Samp), Edge3Samp, Edge4Samp, Edge5Samp, uv,
            polygon, settings, 0.0);
    }
    return result;
}

// Exact: BokehExactEdge with one CoC for all channels
//   shift         as in BokehChannelCoC
float4 BokehChannelEdge(BOKEH_TEXTURE(MapSamp), float2 uv, int k, BokehPolygon polygon,
    BokehFilter settings, float shift)
{
    float4 centerPixel = BokehFetch(BOKEH_ARGUMENT(MapSamp), uv);
    float4 result = centerPixel;
    float centerCoC = BokehChannelCoC(centerPixel.a, shift);
    float CoC = BokehFilterCoC(abs(centerCoC), settings.imageHeight, settings.spacing);
    if (CoC > 0.0)
    {
        float angle = 6.28318531 / float(polygon.sides);
        float4 sum = float4(0.0, 0.0, 0.0, 0.0);
        BOKEH_LOOP for (int i = 1; i < min(k, 5); i++)
        {
            float area = max(sin(float(k - i) * angle), 0.0);
            if (BOKEH_CHARACTER > 0)
            {
                area *= BokehEdgeLength(i, polygon);
            }
            sum += area * BokehLineSum(BOKEH_ARGUMENT(MapSamp), uv,
                BokehPolygonEdge(i, polygon, false), CoC, centerCoC, shift, settings);
        }
        result = BokehResolve(sum, sum.a, centerPixel, false);
    }
    return result;
}

// Exact: one target of the first pass, where a pass can write only one
//   Call it for k = 2 .. sides / 2: it makes that target from the lines along edges 1 .. k - 1,
//   as BokehExactFirst does. For a hexagon that is one line more than with two targets.
float4 BokehExactEdge(BOKEH_TEXTURE(MapSamp), float2 uv, int k, BokehPolygon polygon,
    BokehFilter settings)
{
    float4 result;
    if (BOKEH_CHARACTER > 1)
    {
        result = float4(0.0, 0.0, 0.0, 0.0);
        BOKEH_LOOP for (int channel = 0; channel < 3; channel++)
        {
            float4 mask = BokehChannelMask(channel);
            float shift = dot(mask.rb, polygon.axial);
            float4 one = BokehChannelEdge(BOKEH_ARGUMENT(MapSamp), uv, k, polygon, settings, shift);
            result += one * mask;
        }
    }
    else
    {
        result = BokehChannelEdge(BOKEH_ARGUMENT(MapSamp), uv, k, polygon, settings, 0.0);
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
float4 BokehLateralColor(BOKEH_TEXTURE(PictureSamp), float2 uv, float amount)
{
    float larger = clamp(amount, -0.1, 0.1);
    float2 place = uv - 0.5;
    float4 green = BokehFetch(BOKEH_ARGUMENT(PictureSamp), uv);
    float red = BokehFetch(BOKEH_ARGUMENT(PictureSamp), place / (1.0 + larger) + 0.5).r;
    float blue = BokehFetch(BOKEH_ARGUMENT(PictureSamp), place / (1.0 - larger) + 0.5).b;
    return float4(red, green.g, blue, green.a);
}

// Debug: linear depth as grey: black at the camera, 0.5 at the focus distance, white at infinity
float4 BokehDebugDepth(float S2, float S1)
{
    float grey = S2 / (S2 + S1);
    return float4(grey, grey, grey, 1.0);
}

// Debug: CoC as grey, with or without a sign: black in focus, white at MaxCoC
float4 BokehDebugCoC(float CoC, float MaxCoC)
{
    float grey = clamp(abs(CoC) / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    return float4(grey, grey, grey, 1.0);
}

// Debug: which side of the focus: near field orange, far field blue, in focus black; brighter with
//   the CoC
float4 BokehDebugFocus(float S2, float S1, float CoC, float MaxCoC)
{
    float amount = clamp(abs(CoC) / max(MaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
    float4 result = float4(0.1 * amount, 0.4 * amount, amount, 1.0);
    if (S2 < S1)
    {
        result = float4(amount, 0.5 * amount, 0.0, 1.0);
    }
    return result;
}
