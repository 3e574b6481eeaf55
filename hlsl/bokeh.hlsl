// SPDX-License-Identifier: MIT
//
// Polygonal bokeh depth of field, HLSL. Version 0.3.0.
// After McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures
// in a Post-Process Depth of Field Shader". Sections, listings and figures are of that paper.
//
// CONTRACT
//   Functions only: no bindings, no entry points. Each of bokeh_paper.hlsl, bokeh_layers.hlsl and
//   bokeh_lens.hlsl needs only this file before it; bokeh_passes.hlsl has ready-made programs for
//   the functions of the files before it.
//   In    colour: linear, HDR, before bloom and tone mapping; the engine's depth buffer.
//   Out   colour blurred by a polygonal aperture; alpha = signed CoC.
//   CoC   circle of confusion: a DIAMETER, as a fraction of the image height; negative in front of
//         the focus.
//   uv    0 .. 1, v = 0 at the first row in memory. This file never flips.
//   Targets between the passes: RGBA16F, linear filter, clamp. Blending off, since alpha is data.
//
// PASTE: the whole effect as an exact hexagon, three passes, for shader model 4 to 6 (for 3 see
//   integration/direct3d9/README.md). Each program is #define BOKEH_HLSL_SM 5 (or 4, 6), this file,
//   and one of these blocks. Blending off. A lens to begin with: apertureDiameter 0.036,
//   focalLength 0.05, focusDistance 2.0 (50 mm at f/1.4). It makes distant lights 41 pixels wide
//   at 1920 x 1080.
//
//   Vertex shader of all three: three vertices without a buffer.
//          void fullScreen(uint id : SV_VertexID, out float4 position : SV_Position,
//              out float2 uv : TEXCOORD0)
//          {
//              uv = float2(id == 1 ? 2.0 : 0.0, id == 2 ? 2.0 : 0.0);
//              position = float4(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0);
//          }
//
//   1. CoC map. Color: HDR colour. Depth: the depth buffer. Target: RGBA16F.
//          Texture2D Color : register(t0);
//          Texture2D Depth : register(t1);
//          float2 imageSize;
//          float nearPlane, farPlane;
//          float apertureDiameter, focalLength, focusDistance;
//          float4 map(float4 position : SV_Position, float2 uv : TEXCOORD0) : SV_Target
//          {
//              return BokehSignedCoCMap(Color, Depth, uv, uv, imageSize,
//                  BokehMakeLens(apertureDiameter, focalLength, focusDistance),
//                  1, float2(nearPlane, farPlane)); // 1: standard depth, not reversed
//          }
//
//   2. First blur pass. Map: from 1. Linear: linear filter, clamp. Targets: two RGBA16F.
//          Texture2D Map : register(t0);
//          SamplerState Linear : register(s0);
//          float2 imageSize;
//          float rotation;
//          void first(float4 position : SV_Position, float2 uv : TEXCOORD0,
//              out float4 strip2 : SV_Target0, out float4 strip3 : SV_Target1)
//          {
//              BokehTargets targets = BokehHexagonFirst(Map, uv,
//                  BokehMakePolygon(6, rotation, 1.0), BokehDefaultSampling(imageSize), Linear);
//              strip2 = targets.strip2;
//              strip3 = targets.strip3;
//          }
//
//   3. Second blur pass. Strip2, Strip3: from 2. Linear: as above. Target: RGBA16F.
//          Texture2D Strip2 : register(t0);
//          Texture2D Strip3 : register(t1);
//          SamplerState Linear : register(s0);
//          float2 imageSize;
//          float rotation;
//          float4 second(float4 position : SV_Position, float2 uv : TEXCOORD0) : SV_Target
//          {
//              return BokehHexagonSecond(Strip2, Strip3, uv,
//                  BokehMakePolygon(6, rotation, 1.0), BokehDefaultSampling(imageSize), Linear);
//          }
//
// CONTENTS
//   [1] configuration   [2] porting   [3] circle of confusion: BokehMakeLens, BokehSignedCoCMap
//   [4] samples along a line: BokehDefaultSampling   [5] exact polygons: BokehMakePolygon,
//   BokehHexagonFirst, BokehHexagonSecond, and of Square, Octagon, Decagon

// -------------------------------------------------------------------------------------------------
// [1] configuration
//
//   name                     default   range   meaning
//   BOKEH_NUM_SAMPLES        9         2 ..    most samples on a line; the preset sets it
//   BOKEH_SPACING            1.5       >= 0    pixels between samples; the preset sets it; with 0.0
//                                              every line has all BOKEH_NUM_SAMPLES
//   BOKEH_VIEWPORT           0         0, 1    1: the image fills only a part of its textures
//   BOKEH_SIDES              0         0, 4 .. number of sides, instead of BokehSides: `layered` is
//                                              faster if compilers know it; 0: any number
//   BOKEH_DEPTH_MULTISAMPLED 0         0, 1    1: depth is multisampled; its first sample is read
//   BOKEH_HALF_PRECISION     0         0, 1    1: `layered` gathers in half precision, which some
//                                              mobile GPUs do faster; see [2] for what it needs
//   BOKEH_MAX_COLOR          65504.0           brighter colours are limited to this, the largest
//                                              half float; a lower limit removes fireflies
//
//   Presets: define one before this file; in WGSL set both constants. `fetches` are those of colour
//   and depth per pixel, in the three passes of an exact hexagon; a pixel beside a light takes one
//   more of depth. `smooth` is the CoC in pixels up to which samples are as close as the spacing.
//   MOBILE differs from LOW in `layered` only.
//
//   preset                  samples    spacing  fetches  smooth
//   BOKEH_PRESET_MOBILE     5          2.0      28       20
//   BOKEH_PRESET_LOW        5          2.0      28       20
//   BOKEH_PRESET_MEDIUM     9          1.5      44       27      the default
//   BOKEH_PRESET_HIGH       17         1.0      76       34
//   BOKEH_PRESET_ULTRA      33         1.0      140      66

#if defined(BOKEH_PRESET_MOBILE)
#define BOKEH_PRESET_SAMPLES 5
#define BOKEH_PRESET_SPACING 2.0
#elif defined(BOKEH_PRESET_LOW)
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
#define BOKEH_PRESET_SAMPLES 9
#define BOKEH_PRESET_SPACING 1.5
#define BOKEH_PRESET_DEFAULT 1
#endif

#if defined(BOKEH_PRESET_MOBILE) && defined(BOKEH_PRESET_LOW)
#error two presets are defined: keep one
#elif defined(BOKEH_PRESET_MEDIUM) && BOKEH_PRESET_SAMPLES < 9
#error two presets are defined: keep one
#elif defined(BOKEH_PRESET_HIGH) && BOKEH_PRESET_SAMPLES < 17
#error two presets are defined: keep one
#elif defined(BOKEH_PRESET_ULTRA) && BOKEH_PRESET_SAMPLES < 33
#error two presets are defined: keep one
#endif
#if !defined(BOKEH_PRESET_DEFAULT) && (defined(BOKEH_NUM_SAMPLES) || defined(BOKEH_SPACING))
#error a preset sets BOKEH_NUM_SAMPLES and BOKEH_SPACING: define it or them, not both
#endif

#ifndef BOKEH_NUM_SAMPLES
#define BOKEH_NUM_SAMPLES BOKEH_PRESET_SAMPLES
#endif
#ifndef BOKEH_SPACING
#define BOKEH_SPACING BOKEH_PRESET_SPACING
#endif
#ifndef BOKEH_VIEWPORT
#define BOKEH_VIEWPORT 0
#endif
#ifndef BOKEH_SIDES
#define BOKEH_SIDES 0
#endif
#ifndef BOKEH_HALF_PRECISION
#define BOKEH_HALF_PRECISION 0
#endif
#ifndef BOKEH_MAX_COLOR
#define BOKEH_MAX_COLOR 65504.0
#endif
// metres: BOKEH_MIN_DEPTH replaces zero and negative depth, BOKEH_MAX_DEPTH infinite depth
#define BOKEH_MIN_DEPTH 0.000001
#define BOKEH_MAX_DEPTH 1000000000.0

// Tuned constants: each comment says what goes wrong with another value.
// docs/methods/exact.md explains them.

// A pixel takes the CoC of a light beside it while the light is START to FULL times as bright. With
// lower limits, texture changes the CoC; with higher ones, a keyhole shows in the light's polygon.
#define BOKEH_TUNED_LIGHT_START 4.0
#define BOKEH_TUNED_LIGHT_FULL 8.0

// A pixel is the rim of a light while it is START to FULL times as bright as its darkest neighbour.
// With lower limits, texture is taken for rims; with higher ones, rims stay behind as dots.
#define BOKEH_TUNED_RIM_START 1.3
#define BOKEH_TUNED_RIM_FULL 1.5

// The rim of a near light is blurred even in focus if the light is this many times as bright as the
// darkest neighbour of the rim; above it, this fades in up to twice as many. With a lower limit,
// texture in focus gets blurred beside near objects; with a higher one, more rims stay sharp.
#define BOKEH_TUNED_RIM_LIGHT 64.0

// `exact` gives a sharp sample this weight if the pixel is in front of the focus. With a lower one,
// a near light is denser on its own pixels than beside them; with a higher one, sharp objects leak.
#define BOKEH_TUNED_SHARP_WEIGHT 0.5

// `exact` makes a light denser down to this ratio of its CoC to the pixel's. With a lower one, the
// few samples that are left show as dots; with a higher one, small lights lose energy.
#define BOKEH_TUNED_DENSE_RATIO 0.25

// With squares, octagons and decagons, `exact` blurs a sample onto other pixels from START on, and
// completely from FULL, as a ratio of its CoC to the pixel's. With lower limits, outlines of sharp
// objects show again beside them; with higher ones, lights much smaller than the blur vanish.
#define BOKEH_TUNED_REACH_START 0.2
#define BOKEH_TUNED_REACH_FULL 0.5

// If the samples of `exact` have less weight than this, the pixel itself supplies the rest. With a
// lower one, some pixels between sharp objects differ from GPU to GPU; with a higher one, less
// of the surroundings of a light is blurred.
#define BOKEH_TUNED_LEAST_WEIGHT 0.0625

#if BOKEH_NUM_SAMPLES < 2
#error BOKEH_NUM_SAMPLES must be 2 or more: a line has two ends
#endif

// -------------------------------------------------------------------------------------------------
// [2] porting: the one place where the three languages differ
//
//   BOKEH_HLSL_SM: 3 (sampler2D, tex2Dlod) or 4, 5, 6 (Texture2D, SamplerState). Unset: 6 under
//   DXC and Slang, else 3. From 4 on a function that filters has the sampler as its last parameter.
//   To fetch in another way (texture arrays for stereo, bindless textures), define
//   BOKEH_CUSTOM_FETCH before this file, and supply the types and fetch functions that it guards
//   below.

#ifndef BOKEH_HLSL_SM
#if defined(__hlsl_dx_compiler) || defined(__SLANG__)
#define BOKEH_HLSL_SM 6
#else
#define BOKEH_HLSL_SM 3
#endif
#endif
#if BOKEH_HLSL_SM < 3 || BOKEH_HLSL_SM > 6
#error BOKEH_HLSL_SM must be 3, 4, 5 or 6
#endif

// Shader model 3 has no room for unrolled loops, so it always reads BokehSides; and none for the
// code that blends outlines
#if BOKEH_HLSL_SM == 3
#undef BOKEH_SIDES
#define BOKEH_SIDES 0
#undef BOKEH_LAYER_OUTLINES
#define BOKEH_LAYER_OUTLINES 0
#endif

// BOKEH_LOOP marks a loop whose count is large, or known only at run time. Without [loop], fxc
//   would unroll it. Under DXC it is empty: [loop] would forbid the driver to unroll
//   (RADV: 2 to 16 times the latency)
#if BOKEH_HLSL_SM == 4 || BOKEH_HLSL_SM == 5
#define BOKEH_LOOP [loop]
#else
#define BOKEH_LOOP
#endif

// BOKEH_HALF2 and BOKEH_HALF4 hold what `layered` gathers. A driver may make a float of
// min16float; with -enable-16bit-types, DXC makes a half float of it. Slang has half only.
#if BOKEH_HALF_PRECISION == 0
#define BOKEH_HALF2 float2
#define BOKEH_HALF4 float4
#elif BOKEH_HLSL_SM == 3 || defined(__SLANG__)
#define BOKEH_HALF2 half2
#define BOKEH_HALF4 half4
#else
#define BOKEH_HALF2 min16float2
#define BOKEH_HALF4 min16float4
#endif
#define BOKEH_TO_HALF2 BOKEH_HALF2
#define BOKEH_TO_HALF4 BOKEH_HALF4

#ifndef BOKEH_DEPTH_MULTISAMPLED
#define BOKEH_DEPTH_MULTISAMPLED 0
#endif
#ifndef BOKEH_CUSTOM_FETCH

// BOKEH_TEXTURE is the type of a texture, BOKEH_DEPTH_TEXTURE that of the engine's depth buffer
// BOKEH_SAMPLER is the last parameter of a function that filters, BOKEH_LINEAR its argument
#if BOKEH_HLSL_SM == 3
#define BOKEH_TEXTURE sampler2D
#define BOKEH_SAMPLER
#define BOKEH_LINEAR
#else
#define BOKEH_TEXTURE Texture2D
#define BOKEH_SAMPLER , SamplerState BokehLinearClamp
#define BOKEH_LINEAR , BokehLinearClamp
#endif
#if BOKEH_DEPTH_MULTISAMPLED > 0
#define BOKEH_DEPTH_TEXTURE Texture2DMS<float4>
#else
#define BOKEH_DEPTH_TEXTURE BOKEH_TEXTURE
#endif

// Porting: fetches with the filter from mip level 0, without gradients: allowed in loops, branches
//   coords        texture uv
float4 BokehFetchTexture(BOKEH_TEXTURE tex, float2 coords BOKEH_SAMPLER)
{
#if BOKEH_HLSL_SM == 3
    return tex2Dlod(tex, float4(coords, 0.0, 0.0));
#else
    return tex.SampleLevel(BokehLinearClamp, coords, 0.0);
#endif
}

// Porting: fetches one texel, whatever filter the texture has
//   Shader model 3 cannot: there the sampler must have a nearest filter.
float4 BokehFetchTexel(BOKEH_TEXTURE tex, float2 coords)
{
#if BOKEH_HLSL_SM == 3
    return tex2Dlod(tex, float4(coords, 0.0, 0.0));
#else
    int2 size;
    tex.GetDimensions(size.x, size.y);
    int2 texel = int2(saturate(coords) * float2(size));
    return tex.Load(int3(min(texel, size - int2(1, 1)), 0));
#endif
}

// Porting: fetches red and green of one texel of the engine's depth buffer; of a multisampled one
//   the first sample
float2 BokehFetchDepth(BOKEH_DEPTH_TEXTURE tex, float2 coords)
{
#if BOKEH_DEPTH_MULTISAMPLED > 0
    int3 size;
    tex.GetDimensions(size.x, size.y, size.z);
    int2 texel = int2(saturate(coords) * float2(size.xy));
    return tex.Load(min(texel, size.xy - int2(1, 1)), 0).rg;
#else
    return BokehFetchTexel(tex, coords).rg;
#endif
}

#endif

// Porting: returns whether a value is NaN, by its bits
//   With fast math, a compiler assumes that no value is NaN, and may turn a comparison that NaN
//   fails into one that NaN passes.
//   Shader model 3 cannot read bits. There, the comparison in BokehSanitize has to be enough.
bool BokehIsNaN(float value)
{
#if BOKEH_HLSL_SM == 3
    return false;
#else
    return (asuint(value) & 0x7fffffffu) > 0x7f800000u;
#endif
}

// Porting: returns the sines of four angles
//   The sin of a GPU may be wrong by 0.0005 (Vulkan and WebGPU allow that), which moves samples in
//   a wide blur, so GPUs would draw different pictures. These sines are exact to 0.000001 for
//   angles up to a turn: a triangle wave, bent by a polynomial.
//   turns         angles, 1 is a full turn
float4 BokehTurnSines(float4 turns)
{
    float4 wave = turns + 0.25;
    wave = 4.0 * abs(wave - floor(wave + 0.46)) - 1.0;
    float4 square = wave * wave;
    return wave * (1.57079615 - square * (0.645961552 - square * (0.079682161 - square *
        (0.00466415239 - square * 0.000147407686))));
}

// Porting: returns the sines of four angles, see BokehTurnSines
//   Shader model 3 has no room for that function.
//   angles        radians
float4 BokehSines(float4 angles)
{
#if BOKEH_HLSL_SM == 3
    return sin(angles);
#else
    return BokehTurnSines(angles * 0.159154943);
#endif
}

// Porting: returns cos and sin of an angle, see BokehTurnSines
//   angle         radians
float2 BokehCosSin(float angle)
{
#if BOKEH_HLSL_SM == 3
    return float2(cos(angle), sin(angle));
#else
    float turns = angle * 0.159154943;
    return BokehTurnSines(float4(turns + 0.25, turns, 0.0, 0.0)).xy;
#endif
}

// where the image lies in its textures, in texture uv: corner and size; the bounds of fetches
static float4 BokehViewport = float4(0.0, 0.0, 1.0, 1.0);
static float4 BokehViewportBounds = float4(0.0, 0.0, 1.0, 1.0);

// Porting: tells the library that the image fills only a part of its textures; call it first
//   For dynamic resolution and split screen. Texels around the image are never read, so they may
//   hold anything. The bounds lie 1/128 texel inside the centres of the outermost texels: filtering
//   also reads texels of zero weight, 0 times NaN is NaN, and devices place a sample only to within
//   1/256 texel.
//   viewport      x, y of its first pixel, width, height; pixels, at least 2 x 2
//   textureSize   width and height of the textures, pixels
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

// Porting: converts image uv to texture uv
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

// Porting: fetches with the filter, at image uv
float4 BokehFetch(BOKEH_TEXTURE tex, float2 uv BOKEH_SAMPLER)
{
    return BokehFetchTexture(tex, BokehToTexture(uv) BOKEH_LINEAR);
}

// -------------------------------------------------------------------------------------------------
// [3] Listing 1: circle of confusion

// Listing 1: describes the lens and the sensor (section 4.1); metres unless it says otherwise
//   apertureDiameter  A, the focal length f / the f-stop
//   focusDistance  S1, more than f, because no lens can focus nearer; with a smaller S1, everything
//                 but S1 gets maxCoC
//   sensorHeight  height of the sensor or film
//   maxCoC        largest CoC allowed, fraction of the image height
struct BokehLens
{
    float apertureDiameter;
    float focalLength;
    float focusDistance;
    float sensorHeight;
    float maxCoC;
};

// Listing 1: makes a BokehLens with a 35 mm sensor (0.024 m high) and a maxCoC of 0.1; metres
BokehLens BokehMakeLens(float apertureDiameter, float focalLength, float focusDistance)
{
    BokehLens lens;
    lens.apertureDiameter = apertureDiameter;
    lens.focalLength = focalLength;
    lens.focusDistance = focusDistance;
    lens.sensorHeight = 0.024;
    lens.maxCoC = 0.1;
    return lens;
}

// Listing 1: computes the CoC of a thin lens, negative where the pixel is nearer than the focus
//   The signed CoC grows with depth, so later passes need nothing else to compare depths.
//
//      +maxCoC            ,--------     far field: > 0, also in a CoC map painted by hand
//            0 - - - - -/- - - - - -> depth
//      -maxCoC --------'  focus         near field: < 0
//   depth         S2, metres, > 0
//   returns       fraction of the image height; an infinite focus distance acts as BOKEH_MAX_DEPTH
float BokehSignedCoC(float depth, BokehLens lens)
{
    float focus = min(lens.focusDistance, BOKEH_MAX_DEPTH);
    float magnification = lens.focalLength / max(focus - lens.focalLength, BOKEH_MIN_DEPTH);
    float c = lens.apertureDiameter * magnification * (abs(depth - focus) / depth);
    float CoC = clamp(c / max(lens.sensorHeight, BOKEH_MIN_DEPTH), 0.0, lens.maxCoC);
    if (depth < focus)
    {
        CoC = -CoC;
    }
    return CoC;
}

// Listing 1: limits a value to minimum .. maximum, and replaces NaN by the minimum
//   max() could return either operand if one is NaN. In shader model 3, NaN fails the comparison
//   below. It has to be >=, since fxc would turn > into its opposite, which NaN passes.
float BokehSanitize(float value, float minimum, float maximum)
{
    float safe = minimum;
    if (!BokehIsNaN(value) && value >= minimum)
    {
        safe = min(value, maximum);
    }
    return safe;
}

// Listing 1: converts a value of the engine's depth buffer to metres along the view axis
//   stored        red and green of the depth buffer; only kind 9 uses green
//   kind          0  metres along the view axis, not along the ray
//                 1  window depth, 0 (near) .. 1 (far), as depth textures store it
//                 2  reversed, 1 (near) .. 0 (far)
//                 3  reversed without a far plane, 1 (near) .. 0 (infinite)
//                 4  clip space, z / w in OpenGL, -1 (near) .. 1 (far)
//                 5  window depth of an orthographic camera
//                 6  the same reversed
//                 7  a fraction of the far plane, as in Listing 1
//                 8  logarithmic, log(1 + metres) / log(1 + far) (three.js's WebGLRenderer)
//                 9  weighted by opacity: metres times opacity in red, opacity in green
//   nearPlane, farPlane  planes of the camera, metres; 0 < near < far in kinds 1, 2 and 4, 0 < near
//                 in kind 3
//   returns       finite and > 0. The sky is at the far plane. It is at BOKEH_MAX_DEPTH instead in
//                 kind 3, in kind 1 if near < far / 2^24, and in kind 9 where opacity is below 0.5.
float BokehLinearDepth(float2 stored, int kind, float nearPlane, float farPlane)
{
    float value = stored.x;
    float depth = value;
    if (kind == 1)
    {
        depth = nearPlane * farPlane / (farPlane - value * (farPlane - nearPlane));
    }
    else if (kind == 2)
    {
        depth = nearPlane * farPlane / (nearPlane + value * (farPlane - nearPlane));
    }
    else if (kind == 3)
    {
        depth = BOKEH_MAX_DEPTH;
        if (value >= nearPlane / BOKEH_MAX_DEPTH)
        {
            depth = nearPlane / value;
        }
    }
    else if (kind == 4)
    {
        depth = 2.0 * nearPlane * farPlane / (farPlane + nearPlane - value * (farPlane -
            nearPlane));
    }
    else if (kind == 5)
    {
        depth = nearPlane + value * (farPlane - nearPlane);
    }
    else if (kind == 6)
    {
        depth = nearPlane + (1.0 - value) * (farPlane - nearPlane);
    }
    else if (kind == 7)
    {
        depth = value * farPlane;
    }
    else if (kind == 8)
    {
        depth = 0.0;
        if (value >= 0.0)
        {
            depth = exp2(value * log2(farPlane + 1.0)) - 1.0;
        }
    }
    else if (kind == 9)
    {
        depth = BOKEH_MAX_DEPTH;
        if (stored.y >= 0.5)
        {
            depth = value / stored.y;
        }
    }
    return BokehSanitize(depth, BOKEH_MIN_DEPTH, BOKEH_MAX_DEPTH);
}

// Listing 1: puts a CoC into the alpha of a colour, and replaces invalid channels
//   returns       what every later pass reads: rgb finite and >= 0, a = CoC
float4 BokehPackCoC(float4 color, float CoC)
{
    return float4(BokehSanitize(color.r, 0.0, BOKEH_MAX_COLOR), BokehSanitize(color.g, 0.0,
        BOKEH_MAX_COLOR), BokehSanitize(color.b, 0.0, BOKEH_MAX_COLOR), CoC);
}

// Listing 1: returns the sum of the channels of a colour; 0 if that is NaN or negative
float BokehBrightness(float4 color)
{
    return BokehSanitize(color.r + color.g + color.b, 0.0, 3.0 * BOKEH_MAX_COLOR);
}

// Listing 1: returns the brighter of two neighbours of this pixel
//   brightest     xy = direction of the brightest neighbour so far, pixels; z = its brightness
//   brightness    of the next neighbour
//   direction     of the next neighbour, pixels
float3 BokehBrighter(float3 brightest, float brightness, float2 direction)
{
    float3 result = brightest;
    if (brightness > brightest.z)
    {
        result = float3(direction, brightness);
    }
    return result;
}

// Listing 1: finds the light beside a pixel, among its four neighbours
//   Two kinds of pixel take the CoC of a light beside them, see BokehLightCoC. One kind is much
//   darker than the light: later passes filter the map, and between a light and its surroundings
//   they get a mixture that is almost all light, so it needs the light's CoC. The other kind is the
//   rim of the light: antialiasing has put light into its colour, while its depth may be the
//   background's.
//
//      . . # O      The rim # is darker than the light O and brighter than the background.
//      . # O O
//
//   color         of this pixel
//   right, left, below, above  colours of the neighbours; below is the next row in memory; for a
//                 neighbour outside the image, give the colour of this pixel
//   returns       xy = direction of the light, pixels; zw = weights for BokehLightCoC: z for a dark
//                 pixel; w for a rim, up to 2 if the light is bright enough to blur one in focus
float4 BokehLightBeside(float4 color, float4 right, float4 left, float4 below, float4 above)
{
    float brightness = max(BokehBrightness(color), 0.0000001);
    float4 beside = float4(BokehBrightness(right), BokehBrightness(left), BokehBrightness(below),
        BokehBrightness(above));
    float darkest = min(min(beside.x, beside.y), min(beside.z, beside.w));
    float3 brightest = float3(0.0, 0.0, brightness);
    brightest = BokehBrighter(brightest, beside.x, float2(1.0, 0.0));
    brightest = BokehBrighter(brightest, beside.y, float2(-1.0, 0.0));
    brightest = BokehBrighter(brightest, beside.z, float2(0.0, 1.0));
    brightest = BokehBrighter(brightest, beside.w, float2(0.0, -1.0));
    float ratio = brightest.z / brightness;
    float dark = clamp((ratio - BOKEH_TUNED_LIGHT_START) / (BOKEH_TUNED_LIGHT_FULL -
        BOKEH_TUNED_LIGHT_START), 0.0, 1.0);
    float overDarkest = 1.0 / max(darkest, 0.0000001);
    float rim = clamp((brightness * overDarkest - BOKEH_TUNED_RIM_START) /
        (BOKEH_TUNED_RIM_FULL - BOKEH_TUNED_RIM_START), 0.0, 1.0) *
        clamp(10.0 * ratio - 10.0, 0.0, 1.0);
    float light = clamp(brightest.z * overDarkest / BOKEH_TUNED_RIM_LIGHT - 1.0, 0.0, 1.0);
    return float4(brightest.xy, dark, rim + rim * light);
}

// Listing 1: finds the light beside a pixel in a texture, see BokehLightBeside
//   ColorSamp     linear HDR colour, read texel by texel
//   imageSize     width and height, pixels
//   returns       xy = offset of the light, uv; zw = weights for BokehLightCoC
float4 BokehBrightNeighbor(BOKEH_TEXTURE ColorSamp, float2 uv, float2 imageSize)
{
    float2 pixel = 1.0 / max(imageSize, float2(1.0, 1.0));
    float2 right = float2(pixel.x, 0.0);
    float2 below = float2(0.0, pixel.y);
    float4 brightest = BokehLightBeside(BokehFetchTexel(ColorSamp, BokehToTexture(uv)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv + right)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv - right)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv + below)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv - below)));
    return float4(brightest.xy * pixel, brightest.zw);
}

// Listing 1: returns the CoC of a pixel beside a light: the light's, if that is nearer to the
//   camera
//   A dark pixel and a light keep their own CoC if one of them is in focus, so that nothing sharp
//   gets blurred and nothing blurred gets sharp. A rim takes the CoC of a light in focus, because
//   it shows the light's colour. If the rim has the depth of an object in focus, it takes only the
//   CoC of a bright light in front of the focus, inside whose blur it would show as a sharp line.
//   The change fades in while a CoC grows from one pixel to two: the smaller of both CoC for a dark
//   pixel, the own CoC for a rim, the light's for the rim of a bright near light. Between a
//   pixel behind the focus and a light in front of it, the CoC switches instead of fading.
//   CoC, lightCoC  signed, fractions of the image height
//   weights       zw of BokehLightBeside or BokehBrightNeighbor
//   imageHeight   pixels
float BokehLightCoC(float CoC, float lightCoC, float2 weights, float imageHeight)
{
    float sharper = min(abs(CoC), abs(lightCoC));
    float dark = weights.x * clamp(sharper * imageHeight - 1.0, 0.0, 1.0);
    float rim = min(weights.y, 1.0) * clamp(abs(CoC) * imageHeight - 1.0, 0.0, 1.0);
    float bright = (weights.y - 1.0) * clamp(max(-lightCoC, 0.0) * imageHeight - 1.0,
        0.0, 1.0);
    float weight = max(dark, max(rim, bright));
    if (lightCoC < 0.0 && CoC > 0.0)
    {
        // in between lies a CoC of 0: a mixture would be sharp
        weight = floor(weight + 0.5);
    }
    return CoC + (min(lightCoC, CoC) - CoC) * weight;
}

// Listing 1: makes the CoC map, first pass of `exact` and `layered`
//   The only pass that reads the engine's textures. It writes colour and signed CoC into one
//   texture, so that no later pass reads depth or has to replace invalid values. Beside a small
//   light it takes the light's CoC, see BokehLightBeside.
//   ColorSamp     linear HDR colour, before bloom and tone mapping; read texel by texel
//   DepthSamp     the engine's depth buffer, read texel by texel
//   uv            centre of this pixel, 0 .. 1, v = 0 at the first row in memory
//   depthUV       this pixel in the depth buffer: uv, or BokehToTexture(uv) with BOKEH_VIEWPORT 1.
//                 If temporal anti-aliasing has resolved colour while depth is jittered, add the
//                 camera's jitter. If depth fills another rectangle, use the pass of bokeh_passes.
//   imageSize     width and height, pixels
//   kind          what the depth buffer holds, see BokehLinearDepth
//   planes        near and far plane of the camera, metres
//   returns       rgb = colour, a = signed CoC
float4 BokehSignedCoCMap(BOKEH_TEXTURE ColorSamp, BOKEH_DEPTH_TEXTURE DepthSamp, float2 uv,
    float2 depthUV, float2 imageSize, BokehLens lens, int kind, float2 planes)
{
    float depth = BokehLinearDepth(BokehFetchDepth(DepthSamp, depthUV), kind, planes.x, planes.y);
    float CoC = BokehSignedCoC(depth, lens);
    float4 neighbor = BokehBrightNeighbor(ColorSamp, uv, imageSize);
    if (max(neighbor.z, neighbor.w) > 0.0)
    {
        float2 offset = BokehToTexture(uv + neighbor.xy) - BokehToTexture(uv);
        depth = BokehLinearDepth(BokehFetchDepth(DepthSamp, depthUV + offset), kind, planes.x,
            planes.y);
        CoC = BokehLightCoC(CoC, BokehSignedCoC(depth, lens), neighbor.zw, imageSize.y);
    }
    return BokehPackCoC(BokehFetchTexel(ColorSamp, BokehToTexture(uv)), CoC);
}

// -------------------------------------------------------------------------------------------------
// [4] samples along a line

// Lines: says how a line is sampled, and what the leakage test of `paper` lets pass
//   aspectRatio   width / height of the image
//   imageHeight   pixels
//   spacing       pixels between samples, > 0; ignored with BOKEH_SPACING 0.0
//   jitter        noise, -0.5 .. 0.5, for samples that are more than a pixel apart; 0 = none
//   bleedingBias  for the leakage test of `paper` and `naive`: CoC difference that still passes,
//                 fraction of the image height; 2 turns the test off
//   bleedingMult  for the same test: weight per unit of CoC of a sample that does not pass
struct BokehSamplingSettings
{
    float aspectRatio;
    float imageHeight;
    float spacing;
    float jitter;
    float bleedingBias;
    float bleedingMult;
};

// Lines: makes settings without jitter
//   imageSize     width and height, pixels
BokehSamplingSettings BokehDefaultSampling(float2 imageSize)
{
    BokehSamplingSettings settings;
    settings.aspectRatio = imageSize.x / imageSize.y;
    settings.imageHeight = imageSize.y;
    settings.spacing = BOKEH_SPACING;
    settings.jitter = 0.0;
    settings.bleedingBias = 0.02;
    settings.bleedingMult = 30.0;
    return settings;
}

// Lines: returns the CoC to filter with: 0 in focus, that is below half a pixel
//   It fades in up to one pixel, so that no contour shows where the blur begins.
//   CoC           fraction of the image height, without a sign
//   imageHeight   pixels
//   (fxc for shader model 3 drops the abs of 2 - 2 abs(x).)
float BokehFilterCoC(float CoC, float imageHeight)
{
    float filterCoC = CoC;
    if (BOKEH_SPACING > 0.0)
    {
        filterCoC = CoC * clamp((CoC * imageHeight - 0.5) * 2.0, 0.0, 1.0);
    }
    return filterCoC;
}

// Lines: returns the number of samples on a line, which need not be a whole number
//   A sample represents `spacing` pixels, or more if BOKEH_NUM_SAMPLES of them would not fill
//   the line. Sample i has the weight clamp(samples - i, 0, 1):
//
//      |---|---|---|---|-|     4.2: five samples. The last piece grows from nothing as the line
//        ^   ^   ^   ^  ^      grows, so the result does not jump when a sample is added.
//   lengthInPixels, spacing  pixels
float BokehSampleCount(float lengthInPixels, float spacing)
{
    float samples = float(BOKEH_NUM_SAMPLES);
    if (BOKEH_SPACING > 0.0)
    {
        samples = clamp(lengthInPixels / spacing, 1.0, float(BOKEH_NUM_SAMPLES));
    }
    return samples;
}

// Lines: divides a weighted sum by its weight; what a small weight lacks, centerPixel supplies
//   Without that, rounding would decide the colour of a pixel between sharp objects: the only
//   sample with a weight could have one of 0.000001.
//   1.000001 keeps rounding from darkening an even colour, because a driver that truncates would
//   then store the next smaller half float.
//   sum           rgb = colour times weight, a = weight
//   returns       rgb = colour, a = CoC of centerPixel
float4 BokehResolved(float4 sum, float4 centerPixel)
{
    float missing = max(BOKEH_TUNED_LEAST_WEIGHT - sum.a, 0.0);
    return float4((sum.rgb * 1.000001 + centerPixel.rgb * missing) / max(sum.a,
        BOKEH_TUNED_LEAST_WEIGHT), centerPixel.a);
}

// -------------------------------------------------------------------------------------------------
// [5] exact polygons
//
//   A polygon is cut into parallelograms that do not overlap, and their blurs are ADDED, so that no
//   light is lost (min loses some). The first pass blurs along all edges of one half of the outline
//   but the last, the second pass along all but the first: docs/methods/exact.md.
//
//           edge 2            edges 1, 2, 3 of a hexagon; the other half of the outline is the
//          ,-' '-,  edge 1    same, rotated.
//   edge 3 |     |            first pass   strip2 = blur along 1; strip3 = along 1 and 2, weighted
//          '-, ,-'            second pass  strip2 blurred along 2, strip3 along 3: 1/3 + 2/3
//
//   A polygon of 4, 6, 8 or 10 sides has 1, 2, 3 or 4 such targets.

// Exact: describes the aperture by one half of its outline, for a CoC of 1
//   Edge k points along 360 k / sides + 90 degrees, before axis and squeeze.
//   sides         4, 6, 8 or 10; if it is a literal, compilers remove the code of other polygons
//   axis          cos and sin of the rotation
//   squeeze       width of the bokeh / its height: 1, or 0.5 for the oval of an anamorphic lens
//   lengths       of edges 1 to 4, of which sides / 2 are used
//   fifth         length of edge 5
//   corner        where edge 1 begins
//   mean          mean of the middles of all edges but the last
//   area          of the polygon; corner, mean and area follow from the lengths, see
//                 BokehUpdatePolygon of bokeh_lens
struct BokehPolygon
{
    int sides;
    float2 axis;
    float squeeze;
    float4 lengths;
    float fifth;
    float2 corner;
    float2 mean;
    float area;
};

// Exact: holds what the first pass writes; the second pass blurs strip k along edge k
struct BokehTargets
{
    float4 strip2;
    float4 strip3;
    float4 strip4;
    float4 strip5;
};

// Exact: makes a regular polygon with its corners on the circle of confusion
//   sides         4, 6, 8 or 10
//   rotation      radians; 0: one edge is upright at the right, as in `paper`
//   squeeze       width of the bokeh / its height
BokehPolygon BokehMakePolygon(int sides, float rotation, float squeeze)
{
    float2 halfStep = BokehCosSin(3.14159265 / float(sides));
    float edge = halfStep.y;
    BokehPolygon polygon;
    polygon.sides = sides;
    polygon.axis = BokehCosSin(rotation);
    polygon.squeeze = squeeze;
    polygon.lengths = float4(edge, edge, edge, edge);
    polygon.fifth = edge;
    polygon.corner = halfStep * 0.5;
    polygon.mean = float2(0.0, 0.5 * halfStep.x * halfStep.x / (edge * (0.5 * float(sides) -
        1.0)));
    polygon.area = 0.25 * float(sides) * edge * halfStep.x;
    return polygon;
}

// Exact: rotates a vector from +x towards +y
//   axis          cos and sin of the angle
float2 BokehRotated(float2 direction, float2 axis)
{
    return float2(direction.x * axis.x - direction.y * axis.y, direction.x * axis.y + direction.y *
        axis.x);
}

// Exact: returns cos and sin of k times the angle from one edge to the next
float2 BokehTurn(float k, BokehPolygon polygon)
{
    return BokehCosSin(6.28318531 / float(polygon.sides) * k);
}

// Exact: returns the length of edge k, in units of the CoC
//   k             1 .. sides; edges from sides / 2 + 1 on are opposite to those of the first half
float BokehEdgeLength(int k, BokehPolygon polygon)
{
    int edge = k;
    if (k > polygon.sides / 2)
    {
        edge = k - polygon.sides / 2;
    }
    float edgeLength = polygon.lengths.x;
    if (edge == 2)
    {
        edgeLength = polygon.lengths.y;
    }
    else if (edge == 3)
    {
        edgeLength = polygon.lengths.z;
    }
    else if (edge == 4)
    {
        edgeLength = polygon.lengths.w;
    }
    else if (edge == 5)
    {
        edgeLength = polygon.fifth;
    }
    return edgeLength;
}

// Exact: returns edge k from its beginning to its end, before rotation and squeeze
float2 BokehEdge(int k, BokehPolygon polygon)
{
    float2 outwards = BokehTurn(float(k), polygon);
    return float2(-outwards.y, outwards.x) * BokehEdgeLength(k, polygon);
}

// Exact: returns the line along which edge k is blurred in one of the two passes
//   With lines on the outline, all samples of the first pass would lie on one side of the pixel.
//   The first pass is therefore shifted by the mean of its lines, and the second pass back again.
//   returns       xy = middle, zw = from the middle to the end, units of the CoC
float4 BokehEdgeLine(int k, BokehPolygon polygon, bool secondPass)
{
    float2 halfEdge = BokehEdge(k, polygon) * 0.5;
    float2 middle = polygon.corner - polygon.mean + halfEdge;
    // plus the edges before it
    float4 before = clamp(float(k) - float4(1.0, 2.0, 3.0, 4.0), float4(0.0, 0.0, 0.0, 0.0),
        float4(1.0, 1.0, 1.0, 1.0));
    middle += BokehEdge(1, polygon) * before.x + BokehEdge(2, polygon) * before.y + BokehEdge(3,
        polygon) * before.z + BokehEdge(4, polygon) * before.w;
    if (secondPass)
    {
        middle = -middle - polygon.corner;
    }
    float4 segment = float4(BokehRotated(middle, polygon.axis), BokehRotated(halfEdge,
        polygon.axis));
    return segment * float4(polygon.squeeze, 1.0, polygon.squeeze, 1.0);
}

// Exact: returns the cross products of edges 1 to 4 with edge k, per unit of the length of edge k
//   returns       0 for edge k and those after it
float4 BokehEdgeWeights(int k, BokehPolygon polygon)
{
    float angle = 6.28318531 / float(polygon.sides);
    float4 steps = max(float4(float(k) - 1.0, float(k) - 2.0, float(k) - 3.0, float(k) - 4.0),
        float4(0.0, 0.0, 0.0, 0.0));
    return max(BokehSines(steps * angle), float4(0.0, 0.0, 0.0, 0.0)) * polygon.lengths;
}

// Exact: returns the area of the parallelograms of edge k with the edges before it
float BokehEdgeArea(int k, BokehPolygon polygon)
{
    return dot(BokehEdgeWeights(k, polygon), float4(1.0, 1.0, 1.0, 1.0)) * BokehEdgeLength(k,
        polygon);
}

// Exact: returns the line along which edge k of a hexagon is blurred, a ray from the pixel
//   The three parallelograms of a hexagon share a corner in its centre. Drawn from there, all lines
//   start at the pixel, and a light lies on the same ray whatever its CoC is. So the weight of a
//   sample follows from its distance and its CoC. If a cat's eye cuts the hexagon or its edges
//   differ in length, the shared corner is not the centre, and the second pass shifts the image by
//   the difference.
//
//          ,-' '-,      the three parallelograms, and the corner o that they share
//         |'-, ,-'|
//         |   o   |
//          '-,|,-'
//   returns       as BokehEdgeLine; sample 0 is the one next to the pixel
float4 BokehRay(int k, BokehPolygon polygon, bool secondPass)
{
    float2 halfEdge = BokehEdge(k, polygon) * -0.5;
    // edge 2 runs towards the shared corner, edges 1 and 3 away from it
    if (k == 2)
    {
        halfEdge = -halfEdge;
    }
    float2 middle = halfEdge;
    if (secondPass)
    {
        middle -= polygon.corner + BokehEdge(2, polygon);
    }
    float4 segment = float4(BokehRotated(middle, polygon.axis), BokehRotated(halfEdge,
        polygon.axis));
    return segment * float4(polygon.squeeze, 1.0, polygon.squeeze, 1.0);
}

// Exact: returns the weight of a sample in front of the focus: does its blur reach this pixel?
//   The blur of every sample does. A sample that is sharp or behind the focus has a lower weight:
//   -ratio, but at least a half, so that a near light is as dense on its own pixels as beside them.
//   The lower weight fades in over an eighth of this pixel's CoC, because a step would show while
//   the focus is pulled.
//   ratio         the sample's CoC / this pixel's; negative on the other side of the focus
float BokehNearWeight(float ratio)
{
    return clamp(max(BOKEH_TUNED_SHARP_WEIGHT + 4.0 * ratio, -ratio), BOKEH_TUNED_SHARP_WEIGHT,
        1.0);
}

// Exact: returns the place of the line along edge k that is nearest to the pixel
//   For squares, whose lines have the pixel in the middle, octagons and decagons. There, the first
//   lines of the first pass end next to the pixel, and the last ones begin there; in the second
//   pass, all begin there but the last. The formulas are close to the places in regular polygons.
//   returns       0: the beginning of the line, 1: its end
float BokehNearestOnLine(int k, BokehPolygon polygon, bool secondPass)
{
    float edges = 0.5 * float(polygon.sides);
    float nearest = 0.5 + 0.69 * (0.5 * edges - float(k));
    if (secondPass)
    {
        nearest = float(k) - edges + 1.0;
    }
    if (polygon.sides < 6)
    {
        nearest = 0.5;
    }
    return clamp(nearest, 0.0, 1.0);
}

// Exact: returns the weight of sample i on a line behind the focus: does its blur reach this pixel?
//   A sample with a smaller CoC is nearer to the camera. Its blur reaches only a part of the line,
//   the ratio of its CoC to this pixel's, and is denser there. So a light keeps its own size and
//   its energy, and a sharp object in front does not leak. The density stops growing below a ratio
//   of 1/4, where the few samples left would show as dots.
//
//      |-------|####o####|----|     the part that samples with a ratio of 0.4 reach; o: nearest
//
//   ratio         the sample's CoC / this pixel's; negative on the other side of the focus
//   samples       number of samples on the line, from BokehSampleCount
//   nearest       0 on a ray, otherwise from BokehNearestOnLine
//   returns       x = weight; y = weight without the density
float2 BokehFarWeight(float ratio, float samples, int i, float nearest)
{
    float part = min(abs(ratio), 1.0);
    float begin = nearest * (1.0 - part) * samples;
    float end = begin + part * samples;
    float reached = clamp(min(end, float(i) + 1.0) - max(begin, float(i)), 0.0, 1.0);
    return float2(reached / max(part, BOKEH_TUNED_DENSE_RATIO), reached);
}

// Exact: holds the sum of the samples along one line
//   sum           rgb = mean of colour times weight, a = mean weight; in the second pass times the
//                 area of the edge's parallelograms; 0 if the pixel is in focus
//   reached       behind the focus: brightness of the sum without the density of BokehFarWeight
struct BokehLine
{
    float4 sum;
    float reached;
};

// Exact: sums the samples along edge k, as many as the CoC of this pixel needs
//   The sum is not divided by its weights here. A line that lies on a sharp object, and is
//   therefore almost completely rejected, would come back at full strength (docs/methods/exact.md).
//   The density can make the weights add up to more than one per sample. Dividing by them would
//   darken the light. Instead the excess is subtracted, in the colour of the surface that the
//   light covers: the colour of this pixel, or the mean of all samples if that is darker.
//   rays          true: the lines are those of BokehRay, false: those of BokehEdgeLine
//   centerPixel   colour and signed CoC of this pixel, in the map or in strip 2
BokehLine BokehLineSum(BOKEH_TEXTURE tex, float2 uv, int k, BokehPolygon polygon, bool secondPass,
    bool rays, float4 centerPixel, BokehSamplingSettings settings BOKEH_SAMPLER)
{
    float4 sum = float4(0.0, 0.0, 0.0, 0.0);
    float reached = 0.0;
    float centerCoC = centerPixel.a;
    float CoC = BokehFilterCoC(abs(centerCoC), settings.imageHeight);
    if (CoC > 0.0)
    {
        float4 segment = BokehEdgeLine(k, polygon, secondPass);
        float nearest = BokehNearestOnLine(k, polygon, secondPass);
        if (rays)
        {
            segment = BokehRay(k, polygon, secondPass);
            nearest = 0.0;
        }
        float lengthInPixels = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
        float samples = BokehSampleCount(lengthInPixels, settings.spacing);
        float phase = 0.5 + settings.jitter * clamp(lengthInPixels / samples - 1.0, 0.0, 1.0);
        float2 scale = float2(CoC / settings.aspectRatio, CoC);
        float2 first = uv + (segment.xy - segment.zw) * scale;
        float2 sampleStep = segment.zw * scale * (2.0 / samples);
        // sample CoC * inverseCoC + reachesAll is the ratio of both CoC, or 1 for any sample
        float inverseCoC = 1.0 / centerCoC;
        float reachesAll = 0.0;
        if (!rays && centerCoC < 0.0)
        {
            inverseCoC = 0.0;
            reachesAll = 1.0;
        }
        BOKEH_LOOP for (int i = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            if (BOKEH_SPACING > 0.0 && float(i) >= samples)
            {
                break;
            }
            float part = clamp(samples - float(i), 0.0, 1.0);
            float4 samplePixel = BokehFetch(tex, first + sampleStep * (float(i) + part *
                phase) BOKEH_LINEAR);
            float ratio = samplePixel.a * inverseCoC + reachesAll;
            float2 weights = BokehFarWeight(ratio, samples, i, nearest);
            if (!rays)
            {
                weights *= clamp((abs(ratio) - BOKEH_TUNED_REACH_START) / (BOKEH_TUNED_REACH_FULL -
                    BOKEH_TUNED_REACH_START), 0.0, 1.0);
            }
            else if (centerCoC < 0.0)
            {
                weights = float2(part * BokehNearWeight(ratio), 0.0);
            }
            sum += float4(samplePixel.rgb, 1.0) * weights.x;
            reached += (samplePixel.r + samplePixel.g + samplePixel.b) * weights.y;
        }
        if (rays)
        {
            float excess = max(sum.a - samples, 0.0);
            float4 mean = sum / max(sum.a, samples);
            float4 removed = min(float4(centerPixel.rgb, 1.0), mean) * excess;
            sum -= removed;
            reached = reached - removed.r - removed.g - removed.b;
        }
        sum = sum / samples;
        reached = reached / samples;
        if (secondPass)
        {
            sum *= BokehEdgeArea(k, polygon);
        }
    }
    BokehLine result;
    result.sum = sum;
    result.reached = reached;
    return result;
}

// Exact: computes strip k of the first pass from the lines along edges 1 to k - 1
//   The lines are weighted by the areas of their parallelograms and divided once, by the sum of all
//   weights. The second pass spreads the result by the CoC in alpha. If, behind the focus, most of
//   the light came from a nearer pixel with a smaller CoC, alpha has to be that pixel's CoC: this
//   pixel's, times the fraction of the brightness that remains without the density. Elsewhere alpha
//   is the CoC of this pixel; the factor 1.001 keeps rounding from changing it where all pixels
//   have the same CoC.
//   returns       rgb = colour, a = signed CoC
float4 BokehExactTarget(int k, BokehPolygon polygon, BokehLine L1, BokehLine L2,
    BokehLine L3, BokehLine L4, float4 centerPixel)
{
    float4 weights = BokehEdgeWeights(k, polygon);
    float4 sum = L1.sum * weights.x + L2.sum * weights.y + L3.sum * weights.z + L4.sum * weights.w;
    float4 result = BokehResolved(sum, centerPixel);
    // as much of this pixel as in BokehResolved
    float missing = max(BOKEH_TUNED_LEAST_WEIGHT - sum.a, 0.0) * (centerPixel.r + centerPixel.g +
        centerPixel.b);
    float gathered = sum.r + sum.g + sum.b + missing;
    if (centerPixel.a > 0.0 && gathered > 0.0)
    {
        float reached = missing + dot(float4(L1.reached, L2.reached, L3.reached, L4.reached),
            weights);
        result = float4(result.rgb, result.a * clamp(reached / gathered * 1.001, 0.0, 1.0));
    }
    return result;
}

// Exact: draws the first pass of any polygon
//   Reads the CoC map and blurs it along all edges of one half of the outline but the last.
//   last          sides / 2; if a pass can write only one target, the number of the strip to write
BokehTargets BokehExactFirst(BOKEH_TEXTURE MapSamp, float2 uv, int last, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    float4 centerPixel = BokehFetch(MapSamp, uv BOKEH_LINEAR);
    // a hexagon has no edge 4, so a program for that edge needs no code for rays
    bool rays = false;
    if (last < 4)
    {
        rays = polygon.sides == 6;
    }
    BokehLine L1 = BokehLineSum(MapSamp, uv, 1, polygon, false, rays, centerPixel,
        settings BOKEH_LINEAR);
    BokehLine L2;
    L2.sum = float4(0.0, 0.0, 0.0, 0.0);
    L2.reached = 0.0;
    BokehLine L3 = L2;
    BokehLine L4 = L2;
    if (last > 2)
    {
        L2 = BokehLineSum(MapSamp, uv, 2, polygon, false, rays, centerPixel, settings BOKEH_LINEAR);
    }
    if (last > 3)
    {
        L3 = BokehLineSum(MapSamp, uv, 3, polygon, false, rays, centerPixel, settings BOKEH_LINEAR);
    }
    if (last > 4)
    {
        L4 = BokehLineSum(MapSamp, uv, 4, polygon, false, rays, centerPixel, settings BOKEH_LINEAR);
    }
    BokehTargets targets;
    targets.strip2 = BokehExactTarget(2, polygon, L1, L2, L3, L4, centerPixel);
    targets.strip3 = BokehExactTarget(3, polygon, L1, L2, L3, L4, centerPixel);
    targets.strip4 = BokehExactTarget(4, polygon, L1, L2, L3, L4, centerPixel);
    targets.strip5 = BokehExactTarget(5, polygon, L1, L2, L3, L4, centerPixel);
    return targets;
}

// Exact: draws the first pass of a square
//   Reads the CoC map, blurs it along edge 1, and writes the result as strip 2, which the second
//   pass blurs along edge 2. With n samples on an edge, the two passes take 2 n fetches; a single
//   pass would take n * n.
//   MapSamp       from BokehSignedCoCMap; linear filter, clamp
//   polygon       from BokehMakePolygon(4, ..); for the passes below with 6, 8 and 10
//   returns       strip2; other polygons also strip3 and so on
BokehTargets BokehSquareFirst(BOKEH_TEXTURE MapSamp, float2 uv, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    return BokehExactFirst(MapSamp, uv, 2, polygon, settings BOKEH_LINEAR);
}

// Exact: draws the second pass of a square
//   Reads strip 2, blurs it along edge 2, and divides the sum by its weight. A line that is blurred
//   along another line becomes a parallelogram, which is the whole square here.
//   Strip2Samp    from the first pass; linear filter, clamp
//   returns       rgb = colour, a = signed CoC, here and in the second passes below
float4 BokehSquareSecond(BOKEH_TEXTURE Strip2Samp, float2 uv, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    float4 pixel = BokehFetch(Strip2Samp, uv BOKEH_LINEAR);
    BokehLine L2 = BokehLineSum(Strip2Samp, uv, 2, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    return BokehResolved(L2.sum, pixel);
}

// Exact: draws the first pass of a hexagon
//   Reads the CoC map, blurs it along edges 1 and 2, and writes strips 2 and 3, one for each edge
//   of the second pass. Strip 3 is a mean of both lines, so the second pass makes two of the three
//   parallelograms of a hexagon from one texture.
BokehTargets BokehHexagonFirst(BOKEH_TEXTURE MapSamp, float2 uv, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    return BokehExactFirst(MapSamp, uv, 3, polygon, settings BOKEH_LINEAR);
}

// Exact: draws the second pass of a hexagon
//   Reads the strips, blurs each along the edge of its number, and adds them up. Each line becomes
//   a parallelogram. They do not overlap, so the sum is a hexagon that loses no light.
float4 BokehHexagonSecond(BOKEH_TEXTURE Strip2Samp, BOKEH_TEXTURE Strip3Samp, float2 uv,
    BokehPolygon polygon, BokehSamplingSettings settings BOKEH_SAMPLER)
{
    float4 pixel = BokehFetch(Strip2Samp, uv BOKEH_LINEAR);
    BokehLine L2 = BokehLineSum(Strip2Samp, uv, 2, polygon, true, true, pixel, settings
        BOKEH_LINEAR);
    BokehLine L3 = BokehLineSum(Strip3Samp, uv, 3, polygon, true, true, pixel, settings
        BOKEH_LINEAR);
    return BokehResolved(L2.sum + L3.sum, pixel);
}

// Exact: draws the first pass of an octagon
//   Reads the CoC map, blurs it along edges 1 to 3, and writes strips 2 to 4, one for each edge of
//   the second pass. An octagon consists of six parallelograms: one from strip 2, two from strip 3,
//   three from strip 4.
BokehTargets BokehOctagonFirst(BOKEH_TEXTURE MapSamp, float2 uv, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    return BokehExactFirst(MapSamp, uv, 4, polygon, settings BOKEH_LINEAR);
}

// Exact: draws the second pass of an octagon
//   Reads the strips, blurs each along the edge of its number, and adds them up. The sum of the six
//   parallelograms is an octagon that loses no light.
float4 BokehOctagonSecond(BOKEH_TEXTURE Strip2Samp, BOKEH_TEXTURE Strip3Samp,
    BOKEH_TEXTURE Strip4Samp, float2 uv, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    float4 pixel = BokehFetch(Strip2Samp, uv BOKEH_LINEAR);
    BokehLine L2 = BokehLineSum(Strip2Samp, uv, 2, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    BokehLine L3 = BokehLineSum(Strip3Samp, uv, 3, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    BokehLine L4 = BokehLineSum(Strip4Samp, uv, 4, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    return BokehResolved(L2.sum + L3.sum + L4.sum, pixel);
}

// Exact: draws the first pass of a decagon
//   Reads the CoC map, blurs it along edges 1 to 4, and writes strips 2 to 5, one for each edge of
//   the second pass. A decagon consists of ten parallelograms: one from strip 2, two from strip 3,
//   three from strip 4, four from strip 5.
BokehTargets BokehDecagonFirst(BOKEH_TEXTURE MapSamp, float2 uv, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    return BokehExactFirst(MapSamp, uv, 5, polygon, settings BOKEH_LINEAR);
}

// Exact: draws the second pass of a decagon
//   Reads the strips, blurs each along the edge of its number, and adds them up. The sum of the ten
//   parallelograms is a decagon that loses no light.
float4 BokehDecagonSecond(BOKEH_TEXTURE Strip2Samp, BOKEH_TEXTURE Strip3Samp,
    BOKEH_TEXTURE Strip4Samp, BOKEH_TEXTURE Strip5Samp, float2 uv, BokehPolygon polygon,
    BokehSamplingSettings settings BOKEH_SAMPLER)
{
    float4 pixel = BokehFetch(Strip2Samp, uv BOKEH_LINEAR);
    BokehLine L2 = BokehLineSum(Strip2Samp, uv, 2, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    BokehLine L3 = BokehLineSum(Strip3Samp, uv, 3, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    BokehLine L4 = BokehLineSum(Strip4Samp, uv, 4, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    BokehLine L5 = BokehLineSum(Strip5Samp, uv, 5, polygon, true, false, pixel, settings
        BOKEH_LINEAR);
    return BokehResolved(L2.sum + L3.sum + L4.sum + L5.sum, pixel);
}
