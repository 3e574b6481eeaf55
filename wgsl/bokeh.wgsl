// SPDX-License-Identifier: MIT
//
// Polygonal bokeh depth of field, WGSL. Version 0.3.0.
// After McIntosh, Riecke, DiPaola 2012, "Efficiently Simulating the Bokeh of Polygonal Apertures
// in a Post-Process Depth of Field Shader". Sections, listings and figures are of that paper.
//
// CONTRACT
//   Functions only: no bindings, no entry points. Each of bokeh_paper.wgsl, bokeh_layers.wgsl and
//   bokeh_lens.wgsl needs only this file before it; bokeh_passes.wgsl has ready-made programs for
//   the functions of the files before it.
//   In    colour: linear, HDR, before bloom and tone mapping; the engine's depth buffer.
//   Out   colour blurred by a polygonal aperture; alpha = signed CoC.
//   CoC   circle of confusion: a DIAMETER, as a fraction of the image height; negative in front of
//         the focus.
//   uv    0 .. 1, v = 0 at the first row in memory. This file never flips.
//   Targets between the passes: RGBA16F, linear filter, clamp. Blending off, since alpha is data.
//
// PASTE: the whole effect as an exact hexagon, three passes. Each module is this file, the vertex
//   shader, and one of these blocks; the pipeline's layout may be 'auto'. Blending off in all of
//   them. A lens to begin with: apertureDiameter 0.036, focalLength 0.05, focusDistance 2.0, which
//   is 50 mm at f/1.4, makes distant lights 41 pixels wide at 1920 x 1080.
//
//   Vertex shader of all three: three vertices without a buffer.
//          struct Corner { @builtin(position) position: vec4f, @location(0) uv: vec2f }
//          @vertex fn fullScreen(@builtin(vertex_index) id: u32) -> Corner
//          {
//              let uv = vec2f(select(0.0, 2.0, id == 1u), select(0.0, 2.0, id == 2u));
//              return Corner(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
//          }
//
//   1. CoC map. Color: HDR colour. Depth: the depth buffer. Target: rgba16float.
//          struct Camera { imageSize: vec2f, nearPlane: f32, farPlane: f32,
//              apertureDiameter: f32, focalLength: f32, focusDistance: f32 }
//          @group(0) @binding(0) var<uniform> camera: Camera;
//          @group(0) @binding(1) var Color: texture_2d<f32>;
//          @group(0) @binding(2) var Depth: texture_2d<f32>;
//          @fragment fn map(@location(0) uv: vec2f) -> @location(0) vec4f
//          {
//              return BokehSignedCoCMap(Color, Depth, uv, uv, camera.imageSize,
//                  BokehMakeLens(camera.apertureDiameter, camera.focalLength,
//                  camera.focusDistance), 1, // standard depth, not reversed
//                  vec2f(camera.nearPlane, camera.farPlane));
//          }
//
//   2. First blur pass. Map: from 1. Linear: linear filter, clamp. Targets: two rgba16float.
//          struct Aperture { imageSize: vec2f, rotation: f32 }
//          struct Targets { @location(0) strip2: vec4f, @location(1) strip3: vec4f }
//          @group(0) @binding(0) var<uniform> aperture: Aperture;
//          @group(0) @binding(1) var Map: texture_2d<f32>;
//          @group(0) @binding(2) var Linear: sampler;
//          @fragment fn first(@location(0) uv: vec2f) -> Targets
//          {
//              let targets = BokehHexagonFirst(Map, uv,
//                  BokehMakePolygon(6, aperture.rotation, 1.0),
//                  BokehDefaultSampling(aperture.imageSize), Linear);
//              return Targets(targets.strip2, targets.strip3);
//          }
//
//   3. Second blur pass. Strip2, Strip3: from 2. Linear: as above. Target: rgba16float.
//          struct Aperture { imageSize: vec2f, rotation: f32 }
//          @group(0) @binding(0) var<uniform> aperture: Aperture;
//          @group(0) @binding(1) var Strip2: texture_2d<f32>;
//          @group(0) @binding(2) var Strip3: texture_2d<f32>;
//          @group(0) @binding(3) var Linear: sampler;
//          @fragment fn second(@location(0) uv: vec2f) -> @location(0) vec4f
//          {
//              return BokehHexagonSecond(Strip2, Strip3, uv,
//                  BokehMakePolygon(6, aperture.rotation, 1.0),
//                  BokehDefaultSampling(aperture.imageSize), Linear);
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

override BOKEH_NUM_SAMPLES: i32 = 9;
override BOKEH_SPACING: f32 = 1.5;
override BOKEH_VIEWPORT: i32 = 0;
override BOKEH_SIDES: i32 = 0;
override BOKEH_HALF_PRECISION: i32 = 0;
const BOKEH_MAX_COLOR: f32 = 65504.0;
// metres: BOKEH_MIN_DEPTH replaces zero and negative depth, BOKEH_MAX_DEPTH infinite depth
const BOKEH_MIN_DEPTH: f32 = 0.000001;
const BOKEH_MAX_DEPTH: f32 = 1000000000.0;

// Tuned constants: each comment says what goes wrong with another value.
// docs/methods/exact.md explains them.

// A pixel takes the CoC of a light beside it while the light is START to FULL times as bright. With
// lower limits, texture changes the CoC; with higher ones, a keyhole shows in the light's polygon.
const BOKEH_TUNED_LIGHT_START: f32 = 4.0;
const BOKEH_TUNED_LIGHT_FULL: f32 = 8.0;

// A pixel is the rim of a light while it is START to FULL times as bright as its darkest neighbour.
// With lower limits, texture is taken for rims; with higher ones, rims stay behind as dots.
const BOKEH_TUNED_RIM_START: f32 = 1.3;
const BOKEH_TUNED_RIM_FULL: f32 = 1.5;

// The rim of a near light is blurred even in focus if the light is this many times as bright as the
// darkest neighbour of the rim; above it, this fades in up to twice as many. With a lower limit,
// texture in focus gets blurred beside near objects; with a higher one, more rims stay sharp.
const BOKEH_TUNED_RIM_LIGHT: f32 = 64.0;

// `exact` gives a sharp sample this weight if the pixel is in front of the focus. With a lower one,
// a near light is denser on its own pixels than beside them; with a higher one, sharp objects leak.
const BOKEH_TUNED_SHARP_WEIGHT: f32 = 0.5;

// `exact` makes a light denser down to this ratio of its CoC to the pixel's. With a lower one, the
// few samples that are left show as dots; with a higher one, small lights lose energy.
const BOKEH_TUNED_DENSE_RATIO: f32 = 0.25;

// With squares, octagons and decagons, `exact` blurs a sample onto other pixels from START on, and
// completely from FULL, as a ratio of its CoC to the pixel's. With lower limits, outlines of sharp
// objects show again beside them; with higher ones, lights much smaller than the blur vanish.
const BOKEH_TUNED_REACH_START: f32 = 0.2;
const BOKEH_TUNED_REACH_FULL: f32 = 0.5;

// If the samples of `exact` have less weight than this, the pixel itself supplies the rest. With a
// lower one, some pixels between sharp objects differ from GPU to GPU; with a higher one, less
// of the surroundings of a light is blurred.
const BOKEH_TUNED_LEAST_WEIGHT: f32 = 0.0625;

// -------------------------------------------------------------------------------------------------
// [2] porting: the one place where the three languages differ
//
//   A function that filters has the sampler as its last parameter. All other fetches load a texel,
//   so their textures may have a format that cannot be filtered (r32float, depth32float). To fetch
//   in another way, from texture arrays for stereo for example, change this section.

// type of the engine's depth buffer; texture_depth_2d works too, and for multisampled depth
// texture_multisampled_2d<f32> or texture_depth_multisampled_2d: the first sample is read
alias BokehDepthTexture = texture_2d<f32>;

// BokehHalf2 and BokehHalf4 hold what `layered` gathers. For half precision, set
// BOKEH_HALF_PRECISION to 1, write f16 instead of f32 here, and put 'enable f16;' in the program's
// first line.
alias BokehHalf = f32;
alias BokehHalf2 = vec2<BokehHalf>;
alias BokehHalf4 = vec4<BokehHalf>;

// Porting: fetches with the filter from mip level 0, without gradients: allowed in loops, branches
//   coords        texture uv
fn BokehFetchTexture(tex: texture_2d<f32>, coords: vec2f, BokehLinearClamp: sampler) -> vec4f
{
    return textureSampleLevel(tex, BokehLinearClamp, coords, 0.0);
}

// Porting: fetches one texel, whatever filter the texture has
fn BokehFetchTexel(tex: texture_2d<f32>, coords: vec2f) -> vec4f
{
    let size: vec2i = vec2i(textureDimensions(tex));
    let texel: vec2i = vec2i(saturate(coords) * vec2f(size));
    return textureLoad(tex, min(texel, size - vec2i(1, 1)), 0);
}

// Porting: fetches red and green of one texel of the engine's depth buffer; of a multisampled one
//   the first sample
fn BokehFetchDepth(tex: BokehDepthTexture, coords: vec2f) -> vec2f
{
    let size: vec2i = vec2i(textureDimensions(tex));
    let texel: vec2i = vec2i(saturate(coords) * vec2f(size));
    return vec4f(textureLoad(tex, min(texel, size - vec2i(1, 1)), 0)).rg;
}

// Porting: returns whether a value is NaN, by its bits
//   With fast math, a compiler assumes that no value is NaN, and may turn a comparison that NaN
//   fails into one that NaN passes.
fn BokehIsNaN(value: f32) -> bool
{
    return (bitcast<u32>(value) & 0x7fffffffu) > 0x7f800000u;
}

// Porting: returns the sines of four angles
//   The sin of a GPU may be wrong by 0.0005 (Vulkan and WebGPU allow that), which moves samples in
//   a wide blur, so GPUs would draw different pictures. These sines are exact to 0.000001 for
//   angles up to a turn: a triangle wave, bent by a polynomial.
//   turns         angles, 1 is a full turn
fn BokehTurnSines(turns: vec4f) -> vec4f
{
    var wave: vec4f = turns + 0.25;
    wave = 4.0 * abs(wave - floor(wave + 0.46)) - 1.0;
    let square: vec4f = wave * wave;
    return wave * (1.57079615 - square * (0.645961552 - square * (0.079682161 - square *
        (0.00466415239 - square * 0.000147407686))));
}

// Porting: returns the sines of four angles, see BokehTurnSines
//   angles        radians
fn BokehSines(angles: vec4f) -> vec4f
{
    return BokehTurnSines(angles * 0.159154943);
}

// Porting: returns cos and sin of an angle, see BokehTurnSines
//   angle         radians
fn BokehCosSin(angle: f32) -> vec2f
{
    let turns: f32 = angle * 0.159154943;
    return BokehTurnSines(vec4f(turns + 0.25, turns, 0.0, 0.0)).xy;
}

// where the image lies in its textures, in texture uv: corner and size; the bounds of fetches
var<private> BokehViewport: vec4f = vec4f(0.0, 0.0, 1.0, 1.0);
var<private> BokehViewportBounds: vec4f = vec4f(0.0, 0.0, 1.0, 1.0);

// Porting: tells the library that the image fills only a part of its textures; call it first
//   For dynamic resolution and split screen. Texels around the image are never read, so they may
//   hold anything. The bounds lie 1/128 texel inside the centres of the outermost texels: filtering
//   also reads texels of zero weight, 0 times NaN is NaN, and devices place a sample only to within
//   1/256 texel.
//   viewport      x, y of its first pixel, width, height; pixels, at least 2 x 2
//   textureSize   width and height of the textures, pixels
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

// Porting: converts image uv to texture uv
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

// Porting: fetches with the filter, at image uv
fn BokehFetch(tex: texture_2d<f32>, uv: vec2f, BokehLinearClamp: sampler) -> vec4f
{
    return BokehFetchTexture(tex, BokehToTexture(uv), BokehLinearClamp);
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
    apertureDiameter: f32,
    focalLength: f32,
    focusDistance: f32,
    sensorHeight: f32,
    maxCoC: f32,
}

// Listing 1: makes a BokehLens with a 35 mm sensor (0.024 m high) and a maxCoC of 0.1; metres
fn BokehMakeLens(apertureDiameter: f32, focalLength: f32, focusDistance: f32) -> BokehLens
{
    var lens: BokehLens;
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
fn BokehSignedCoC(depth: f32, lens: BokehLens) -> f32
{
    let focus: f32 = min(lens.focusDistance, BOKEH_MAX_DEPTH);
    let magnification: f32 = lens.focalLength / max(focus - lens.focalLength, BOKEH_MIN_DEPTH);
    let c: f32 = lens.apertureDiameter * magnification * (abs(depth - focus) / depth);
    var CoC: f32 = clamp(c / max(lens.sensorHeight, BOKEH_MIN_DEPTH), 0.0, lens.maxCoC);
    if (depth < focus)
    {
        CoC = -CoC;
    }
    return CoC;
}

// Listing 1: limits a value to minimum .. maximum, and replaces NaN by the minimum
//   max() could return either operand if one is NaN. In shader model 3, NaN fails the comparison
//   below. It has to be >=, since fxc would turn > into its opposite, which NaN passes.
fn BokehSanitize(value: f32, minimum: f32, maximum: f32) -> f32
{
    var safe: f32 = minimum;
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
fn BokehLinearDepth(stored: vec2f, kind: i32, nearPlane: f32, farPlane: f32) -> f32
{
    let value: f32 = stored.x;
    var depth: f32 = value;
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
fn BokehPackCoC(color: vec4f, CoC: f32) -> vec4f
{
    return vec4f(BokehSanitize(color.r, 0.0, BOKEH_MAX_COLOR), BokehSanitize(color.g, 0.0,
        BOKEH_MAX_COLOR), BokehSanitize(color.b, 0.0, BOKEH_MAX_COLOR), CoC);
}

// Listing 1: returns the sum of the channels of a colour; 0 if that is NaN or negative
fn BokehBrightness(color: vec4f) -> f32
{
    return BokehSanitize(color.r + color.g + color.b, 0.0, 3.0 * BOKEH_MAX_COLOR);
}

// Listing 1: returns the brighter of two neighbours of this pixel
//   brightest     xy = direction of the brightest neighbour so far, pixels; z = its brightness
//   brightness    of the next neighbour
//   direction     of the next neighbour, pixels
fn BokehBrighter(brightest: vec3f, brightness: f32, direction: vec2f) -> vec3f
{
    var result: vec3f = brightest;
    if (brightness > brightest.z)
    {
        result = vec3f(direction, brightness);
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
fn BokehLightBeside(color: vec4f, right: vec4f, left: vec4f, below: vec4f, above: vec4f) -> vec4f
{
    let brightness: f32 = max(BokehBrightness(color), 0.0000001);
    let beside: vec4f = vec4f(BokehBrightness(right), BokehBrightness(left), BokehBrightness(below),
        BokehBrightness(above));
    let darkest: f32 = min(min(beside.x, beside.y), min(beside.z, beside.w));
    var brightest: vec3f = vec3f(0.0, 0.0, brightness);
    brightest = BokehBrighter(brightest, beside.x, vec2f(1.0, 0.0));
    brightest = BokehBrighter(brightest, beside.y, vec2f(-1.0, 0.0));
    brightest = BokehBrighter(brightest, beside.z, vec2f(0.0, 1.0));
    brightest = BokehBrighter(brightest, beside.w, vec2f(0.0, -1.0));
    let ratio: f32 = brightest.z / brightness;
    let dark: f32 = clamp((ratio - BOKEH_TUNED_LIGHT_START) / (BOKEH_TUNED_LIGHT_FULL -
        BOKEH_TUNED_LIGHT_START), 0.0, 1.0);
    let overDarkest: f32 = 1.0 / max(darkest, 0.0000001);
    let rim: f32 = clamp((brightness * overDarkest - BOKEH_TUNED_RIM_START) /
        (BOKEH_TUNED_RIM_FULL - BOKEH_TUNED_RIM_START), 0.0, 1.0) *
        clamp(10.0 * ratio - 10.0, 0.0, 1.0);
    let light: f32 = clamp(brightest.z * overDarkest / BOKEH_TUNED_RIM_LIGHT - 1.0, 0.0, 1.0);
    return vec4f(brightest.xy, dark, rim + rim * light);
}

// Listing 1: finds the light beside a pixel in a texture, see BokehLightBeside
//   ColorSamp     linear HDR colour, read texel by texel
//   imageSize     width and height, pixels
//   returns       xy = offset of the light, uv; zw = weights for BokehLightCoC
fn BokehBrightNeighbor(ColorSamp: texture_2d<f32>, uv: vec2f, imageSize: vec2f) -> vec4f
{
    let pixel: vec2f = 1.0 / max(imageSize, vec2f(1.0, 1.0));
    let right: vec2f = vec2f(pixel.x, 0.0);
    let below: vec2f = vec2f(0.0, pixel.y);
    let brightest: vec4f = BokehLightBeside(BokehFetchTexel(ColorSamp, BokehToTexture(uv)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv + right)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv - right)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv + below)),
        BokehFetchTexel(ColorSamp, BokehToTexture(uv - below)));
    return vec4f(brightest.xy * pixel, brightest.zw);
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
fn BokehLightCoC(CoC: f32, lightCoC: f32, weights: vec2f, imageHeight: f32) -> f32
{
    let sharper: f32 = min(abs(CoC), abs(lightCoC));
    let dark: f32 = weights.x * clamp(sharper * imageHeight - 1.0, 0.0, 1.0);
    let rim: f32 = min(weights.y, 1.0) * clamp(abs(CoC) * imageHeight - 1.0, 0.0, 1.0);
    let bright: f32 = (weights.y - 1.0) * clamp(max(-lightCoC, 0.0) * imageHeight - 1.0,
        0.0, 1.0);
    var weight: f32 = max(dark, max(rim, bright));
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
fn BokehSignedCoCMap(ColorSamp: texture_2d<f32>, DepthSamp: BokehDepthTexture, uv: vec2f,
    depthUV: vec2f, imageSize: vec2f, lens: BokehLens, kind: i32, planes: vec2f) -> vec4f
{
    var depth: f32 = BokehLinearDepth(BokehFetchDepth(DepthSamp, depthUV), kind, planes.x,
        planes.y);
    var CoC: f32 = BokehSignedCoC(depth, lens);
    let neighbor: vec4f = BokehBrightNeighbor(ColorSamp, uv, imageSize);
    if (max(neighbor.z, neighbor.w) > 0.0)
    {
        let offset: vec2f = BokehToTexture(uv + neighbor.xy) - BokehToTexture(uv);
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
    aspectRatio: f32,
    imageHeight: f32,
    spacing: f32,
    jitter: f32,
    bleedingBias: f32,
    bleedingMult: f32,
}

// Lines: makes settings without jitter
//   imageSize     width and height, pixels
fn BokehDefaultSampling(imageSize: vec2f) -> BokehSamplingSettings
{
    var settings: BokehSamplingSettings;
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
fn BokehFilterCoC(CoC: f32, imageHeight: f32) -> f32
{
    var filterCoC: f32 = CoC;
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
fn BokehSampleCount(lengthInPixels: f32, spacing: f32) -> f32
{
    var samples: f32 = f32(BOKEH_NUM_SAMPLES);
    if (BOKEH_SPACING > 0.0)
    {
        samples = clamp(lengthInPixels / spacing, 1.0, f32(BOKEH_NUM_SAMPLES));
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
fn BokehResolved(sum: vec4f, centerPixel: vec4f) -> vec4f
{
    let missing: f32 = max(BOKEH_TUNED_LEAST_WEIGHT - sum.a, 0.0);
    return vec4f((sum.rgb * 1.000001 + centerPixel.rgb * missing) / max(sum.a,
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
    sides: i32,
    axis: vec2f,
    squeeze: f32,
    lengths: vec4f,
    fifth: f32,
    corner: vec2f,
    mean: vec2f,
    area: f32,
}

// Exact: holds what the first pass writes; the second pass blurs strip k along edge k
struct BokehTargets
{
    strip2: vec4f,
    strip3: vec4f,
    strip4: vec4f,
    strip5: vec4f,
}

// Exact: makes a regular polygon with its corners on the circle of confusion
//   sides         4, 6, 8 or 10
//   rotation      radians; 0: one edge is upright at the right, as in `paper`
//   squeeze       width of the bokeh / its height
fn BokehMakePolygon(sides: i32, rotation: f32, squeeze: f32) -> BokehPolygon
{
    let halfStep: vec2f = BokehCosSin(3.14159265 / f32(sides));
    let edge: f32 = halfStep.y;
    var polygon: BokehPolygon;
    polygon.sides = sides;
    polygon.axis = BokehCosSin(rotation);
    polygon.squeeze = squeeze;
    polygon.lengths = vec4f(edge, edge, edge, edge);
    polygon.fifth = edge;
    polygon.corner = halfStep * 0.5;
    polygon.mean = vec2f(0.0, 0.5 * halfStep.x * halfStep.x / (edge * (0.5 * f32(sides) -
        1.0)));
    polygon.area = 0.25 * f32(sides) * edge * halfStep.x;
    return polygon;
}

// Exact: rotates a vector from +x towards +y
//   axis          cos and sin of the angle
fn BokehRotated(direction: vec2f, axis: vec2f) -> vec2f
{
    return vec2f(direction.x * axis.x - direction.y * axis.y, direction.x * axis.y + direction.y *
        axis.x);
}

// Exact: returns cos and sin of k times the angle from one edge to the next
fn BokehTurn(k: f32, polygon: BokehPolygon) -> vec2f
{
    return BokehCosSin(6.28318531 / f32(polygon.sides) * k);
}

// Exact: returns the length of edge k, in units of the CoC
//   k             1 .. sides; edges from sides / 2 + 1 on are opposite to those of the first half
fn BokehEdgeLength(k: i32, polygon: BokehPolygon) -> f32
{
    var edge: i32 = k;
    if (k > polygon.sides / 2)
    {
        edge = k - polygon.sides / 2;
    }
    var edgeLength: f32 = polygon.lengths.x;
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
fn BokehEdge(k: i32, polygon: BokehPolygon) -> vec2f
{
    let outwards: vec2f = BokehTurn(f32(k), polygon);
    return vec2f(-outwards.y, outwards.x) * BokehEdgeLength(k, polygon);
}

// Exact: returns the line along which edge k is blurred in one of the two passes
//   With lines on the outline, all samples of the first pass would lie on one side of the pixel.
//   The first pass is therefore shifted by the mean of its lines, and the second pass back again.
//   returns       xy = middle, zw = from the middle to the end, units of the CoC
fn BokehEdgeLine(k: i32, polygon: BokehPolygon, secondPass: bool) -> vec4f
{
    let halfEdge: vec2f = BokehEdge(k, polygon) * 0.5;
    var middle: vec2f = polygon.corner - polygon.mean + halfEdge;
    // plus the edges before it
    let before: vec4f = clamp(f32(k) - vec4f(1.0, 2.0, 3.0, 4.0), vec4f(0.0, 0.0, 0.0, 0.0),
        vec4f(1.0, 1.0, 1.0, 1.0));
    middle += BokehEdge(1, polygon) * before.x + BokehEdge(2, polygon) * before.y + BokehEdge(3,
        polygon) * before.z + BokehEdge(4, polygon) * before.w;
    if (secondPass)
    {
        middle = -middle - polygon.corner;
    }
    let segment: vec4f = vec4f(BokehRotated(middle, polygon.axis), BokehRotated(halfEdge,
        polygon.axis));
    return segment * vec4f(polygon.squeeze, 1.0, polygon.squeeze, 1.0);
}

// Exact: returns the cross products of edges 1 to 4 with edge k, per unit of the length of edge k
//   returns       0 for edge k and those after it
fn BokehEdgeWeights(k: i32, polygon: BokehPolygon) -> vec4f
{
    let angle: f32 = 6.28318531 / f32(polygon.sides);
    let steps: vec4f = max(vec4f(f32(k) - 1.0, f32(k) - 2.0, f32(k) - 3.0, f32(k) - 4.0), vec4f(0.0,
        0.0, 0.0, 0.0));
    return max(BokehSines(steps * angle), vec4f(0.0, 0.0, 0.0, 0.0)) * polygon.lengths;
}

// Exact: returns the area of the parallelograms of edge k with the edges before it
fn BokehEdgeArea(k: i32, polygon: BokehPolygon) -> f32
{
    return dot(BokehEdgeWeights(k, polygon), vec4f(1.0, 1.0, 1.0, 1.0)) * BokehEdgeLength(k,
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
fn BokehRay(k: i32, polygon: BokehPolygon, secondPass: bool) -> vec4f
{
    var halfEdge: vec2f = BokehEdge(k, polygon) * -0.5;
    // edge 2 runs towards the shared corner, edges 1 and 3 away from it
    if (k == 2)
    {
        halfEdge = -halfEdge;
    }
    var middle: vec2f = halfEdge;
    if (secondPass)
    {
        middle -= polygon.corner + BokehEdge(2, polygon);
    }
    let segment: vec4f = vec4f(BokehRotated(middle, polygon.axis), BokehRotated(halfEdge,
        polygon.axis));
    return segment * vec4f(polygon.squeeze, 1.0, polygon.squeeze, 1.0);
}

// Exact: returns the weight of a sample in front of the focus: does its blur reach this pixel?
//   The blur of every sample does. A sample that is sharp or behind the focus has a lower weight:
//   -ratio, but at least a half, so that a near light is as dense on its own pixels as beside them.
//   The lower weight fades in over an eighth of this pixel's CoC, because a step would show while
//   the focus is pulled.
//   ratio         the sample's CoC / this pixel's; negative on the other side of the focus
fn BokehNearWeight(ratio: f32) -> f32
{
    return clamp(max(BOKEH_TUNED_SHARP_WEIGHT + 4.0 * ratio, -ratio), BOKEH_TUNED_SHARP_WEIGHT,
        1.0);
}

// Exact: returns the place of the line along edge k that is nearest to the pixel
//   For squares, whose lines have the pixel in the middle, octagons and decagons. There, the first
//   lines of the first pass end next to the pixel, and the last ones begin there; in the second
//   pass, all begin there but the last. The formulas are close to the places in regular polygons.
//   returns       0: the beginning of the line, 1: its end
fn BokehNearestOnLine(k: i32, polygon: BokehPolygon, secondPass: bool) -> f32
{
    let edges: f32 = 0.5 * f32(polygon.sides);
    var nearest: f32 = 0.5 + 0.69 * (0.5 * edges - f32(k));
    if (secondPass)
    {
        nearest = f32(k) - edges + 1.0;
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
fn BokehFarWeight(ratio: f32, samples: f32, i: i32, nearest: f32) -> vec2f
{
    let part: f32 = min(abs(ratio), 1.0);
    let begin: f32 = nearest * (1.0 - part) * samples;
    let end: f32 = begin + part * samples;
    let reached: f32 = clamp(min(end, f32(i) + 1.0) - max(begin, f32(i)), 0.0, 1.0);
    return vec2f(reached / max(part, BOKEH_TUNED_DENSE_RATIO), reached);
}

// Exact: holds the sum of the samples along one line
//   sum           rgb = mean of colour times weight, a = mean weight; in the second pass times the
//                 area of the edge's parallelograms; 0 if the pixel is in focus
//   reached       behind the focus: brightness of the sum without the density of BokehFarWeight
struct BokehLine
{
    sum: vec4f,
    reached: f32,
}

// Exact: sums the samples along edge k, as many as the CoC of this pixel needs
//   The sum is not divided by its weights here. A line that lies on a sharp object, and is
//   therefore almost completely rejected, would come back at full strength (docs/methods/exact.md).
//   The density can make the weights add up to more than one per sample. Dividing by them would
//   darken the light. Instead the excess is subtracted, in the colour of the surface that the
//   light covers: the colour of this pixel, or the mean of all samples if that is darker.
//   rays          true: the lines are those of BokehRay, false: those of BokehEdgeLine
//   centerPixel   colour and signed CoC of this pixel, in the map or in strip 2
fn BokehLineSum(tex: texture_2d<f32>, uv: vec2f, k: i32, polygon: BokehPolygon, secondPass: bool,
    rays: bool, centerPixel: vec4f, settings: BokehSamplingSettings,
        BokehLinearClamp: sampler) -> BokehLine
{
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var reached: f32 = 0.0;
    let centerCoC: f32 = centerPixel.a;
    let CoC: f32 = BokehFilterCoC(abs(centerCoC), settings.imageHeight);
    if (CoC > 0.0)
    {
        var segment: vec4f = BokehEdgeLine(k, polygon, secondPass);
        var nearest: f32 = BokehNearestOnLine(k, polygon, secondPass);
        if (rays)
        {
            segment = BokehRay(k, polygon, secondPass);
            nearest = 0.0;
        }
        let lengthInPixels: f32 = 2.0 * length(segment.zw) * CoC * settings.imageHeight;
        let samples: f32 = BokehSampleCount(lengthInPixels, settings.spacing);
        let phase: f32 = 0.5 + settings.jitter * clamp(lengthInPixels / samples - 1.0, 0.0, 1.0);
        let scale: vec2f = vec2f(CoC / settings.aspectRatio, CoC);
        let first: vec2f = uv + (segment.xy - segment.zw) * scale;
        let sampleStep: vec2f = segment.zw * scale * (2.0 / samples);
        // sample CoC * inverseCoC + reachesAll is the ratio of both CoC, or 1 for any sample
        var inverseCoC: f32 = 1.0 / centerCoC;
        var reachesAll: f32 = 0.0;
        if (!rays && centerCoC < 0.0)
        {
            inverseCoC = 0.0;
            reachesAll = 1.0;
        }
        for (var i: i32 = 0; i < BOKEH_NUM_SAMPLES; i++)
        {
            if (BOKEH_SPACING > 0.0 && f32(i) >= samples)
            {
                break;
            }
            let part: f32 = clamp(samples - f32(i), 0.0, 1.0);
            let samplePixel: vec4f = BokehFetch(tex, first + sampleStep * (f32(i) + part * phase),
                BokehLinearClamp);
            let ratio: f32 = samplePixel.a * inverseCoC + reachesAll;
            var weights: vec2f = BokehFarWeight(ratio, samples, i, nearest);
            if (!rays)
            {
                weights *= clamp((abs(ratio) - BOKEH_TUNED_REACH_START) / (BOKEH_TUNED_REACH_FULL -
                    BOKEH_TUNED_REACH_START), 0.0, 1.0);
            }
            else if (centerCoC < 0.0)
            {
                weights = vec2f(part * BokehNearWeight(ratio), 0.0);
            }
            sum += vec4f(samplePixel.rgb, 1.0) * weights.x;
            reached += (samplePixel.r + samplePixel.g + samplePixel.b) * weights.y;
        }
        if (rays)
        {
            let excess: f32 = max(sum.a - samples, 0.0);
            let mean: vec4f = sum / max(sum.a, samples);
            let removed: vec4f = min(vec4f(centerPixel.rgb, 1.0), mean) * excess;
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
    var result: BokehLine;
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
fn BokehExactTarget(k: i32, polygon: BokehPolygon, L1: BokehLine, L2: BokehLine,
    L3: BokehLine, L4: BokehLine, centerPixel: vec4f) -> vec4f
{
    let weights: vec4f = BokehEdgeWeights(k, polygon);
    let sum: vec4f = L1.sum * weights.x + L2.sum * weights.y + L3.sum * weights.z + L4.sum *
        weights.w;
    var result: vec4f = BokehResolved(sum, centerPixel);
    // as much of this pixel as in BokehResolved
    let missing: f32 = max(BOKEH_TUNED_LEAST_WEIGHT - sum.a, 0.0) * (centerPixel.r + centerPixel.g +
        centerPixel.b);
    let gathered: f32 = sum.r + sum.g + sum.b + missing;
    if (centerPixel.a > 0.0 && gathered > 0.0)
    {
        let reached: f32 = missing + dot(vec4f(L1.reached, L2.reached, L3.reached, L4.reached),
            weights);
        result = vec4f(result.rgb, result.a * clamp(reached / gathered * 1.001, 0.0, 1.0));
    }
    return result;
}

// Exact: draws the first pass of any polygon
//   Reads the CoC map and blurs it along all edges of one half of the outline but the last.
//   last          sides / 2; if a pass can write only one target, the number of the strip to write
fn BokehExactFirst(MapSamp: texture_2d<f32>, uv: vec2f, last: i32, polygon: BokehPolygon,
    settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> BokehTargets
{
    let centerPixel: vec4f = BokehFetch(MapSamp, uv, BokehLinearClamp);
    // a hexagon has no edge 4, so a program for that edge needs no code for rays
    var rays: bool = false;
    if (last < 4)
    {
        rays = polygon.sides == 6;
    }
    let L1: BokehLine = BokehLineSum(MapSamp, uv, 1, polygon, false, rays, centerPixel, settings,
        BokehLinearClamp);
    var L2: BokehLine;
    L2.sum = vec4f(0.0, 0.0, 0.0, 0.0);
    L2.reached = 0.0;
    var L3: BokehLine = L2;
    var L4: BokehLine = L2;
    if (last > 2)
    {
        L2 = BokehLineSum(MapSamp, uv, 2, polygon, false, rays, centerPixel, settings,
            BokehLinearClamp);
    }
    if (last > 3)
    {
        L3 = BokehLineSum(MapSamp, uv, 3, polygon, false, rays, centerPixel, settings,
            BokehLinearClamp);
    }
    if (last > 4)
    {
        L4 = BokehLineSum(MapSamp, uv, 4, polygon, false, rays, centerPixel, settings,
            BokehLinearClamp);
    }
    var targets: BokehTargets;
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
fn BokehSquareFirst(MapSamp: texture_2d<f32>, uv: vec2f, polygon: BokehPolygon,
    settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> BokehTargets
{
    return BokehExactFirst(MapSamp, uv, 2, polygon, settings, BokehLinearClamp);
}

// Exact: draws the second pass of a square
//   Reads strip 2, blurs it along edge 2, and divides the sum by its weight. A line that is blurred
//   along another line becomes a parallelogram, which is the whole square here.
//   Strip2Samp    from the first pass; linear filter, clamp
//   returns       rgb = colour, a = signed CoC, here and in the second passes below
fn BokehSquareSecond(Strip2Samp: texture_2d<f32>, uv: vec2f, polygon: BokehPolygon,
    settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> vec4f
{
    let pixel: vec4f = BokehFetch(Strip2Samp, uv, BokehLinearClamp);
    let L2: BokehLine = BokehLineSum(Strip2Samp, uv, 2, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    return BokehResolved(L2.sum, pixel);
}

// Exact: draws the first pass of a hexagon
//   Reads the CoC map, blurs it along edges 1 and 2, and writes strips 2 and 3, one for each edge
//   of the second pass. Strip 3 is a mean of both lines, so the second pass makes two of the three
//   parallelograms of a hexagon from one texture.
fn BokehHexagonFirst(MapSamp: texture_2d<f32>, uv: vec2f, polygon: BokehPolygon,
    settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> BokehTargets
{
    return BokehExactFirst(MapSamp, uv, 3, polygon, settings, BokehLinearClamp);
}

// Exact: draws the second pass of a hexagon
//   Reads the strips, blurs each along the edge of its number, and adds them up. Each line becomes
//   a parallelogram. They do not overlap, so the sum is a hexagon that loses no light.
fn BokehHexagonSecond(Strip2Samp: texture_2d<f32>, Strip3Samp: texture_2d<f32>, uv: vec2f,
    polygon: BokehPolygon, settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> vec4f
{
    let pixel: vec4f = BokehFetch(Strip2Samp, uv, BokehLinearClamp);
    let L2: BokehLine = BokehLineSum(Strip2Samp, uv, 2, polygon, true, true, pixel, settings,
        BokehLinearClamp);
    let L3: BokehLine = BokehLineSum(Strip3Samp, uv, 3, polygon, true, true, pixel, settings,
        BokehLinearClamp);
    return BokehResolved(L2.sum + L3.sum, pixel);
}

// Exact: draws the first pass of an octagon
//   Reads the CoC map, blurs it along edges 1 to 3, and writes strips 2 to 4, one for each edge of
//   the second pass. An octagon consists of six parallelograms: one from strip 2, two from strip 3,
//   three from strip 4.
fn BokehOctagonFirst(MapSamp: texture_2d<f32>, uv: vec2f, polygon: BokehPolygon,
    settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> BokehTargets
{
    return BokehExactFirst(MapSamp, uv, 4, polygon, settings, BokehLinearClamp);
}

// Exact: draws the second pass of an octagon
//   Reads the strips, blurs each along the edge of its number, and adds them up. The sum of the six
//   parallelograms is an octagon that loses no light.
fn BokehOctagonSecond(Strip2Samp: texture_2d<f32>, Strip3Samp: texture_2d<f32>,
    Strip4Samp: texture_2d<f32>, uv: vec2f, polygon: BokehPolygon, settings: BokehSamplingSettings,
    BokehLinearClamp: sampler) -> vec4f
{
    let pixel: vec4f = BokehFetch(Strip2Samp, uv, BokehLinearClamp);
    let L2: BokehLine = BokehLineSum(Strip2Samp, uv, 2, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    let L3: BokehLine = BokehLineSum(Strip3Samp, uv, 3, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    let L4: BokehLine = BokehLineSum(Strip4Samp, uv, 4, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    return BokehResolved(L2.sum + L3.sum + L4.sum, pixel);
}

// Exact: draws the first pass of a decagon
//   Reads the CoC map, blurs it along edges 1 to 4, and writes strips 2 to 5, one for each edge of
//   the second pass. A decagon consists of ten parallelograms: one from strip 2, two from strip 3,
//   three from strip 4, four from strip 5.
fn BokehDecagonFirst(MapSamp: texture_2d<f32>, uv: vec2f, polygon: BokehPolygon,
    settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> BokehTargets
{
    return BokehExactFirst(MapSamp, uv, 5, polygon, settings, BokehLinearClamp);
}

// Exact: draws the second pass of a decagon
//   Reads the strips, blurs each along the edge of its number, and adds them up. The sum of the ten
//   parallelograms is a decagon that loses no light.
fn BokehDecagonSecond(Strip2Samp: texture_2d<f32>, Strip3Samp: texture_2d<f32>,
    Strip4Samp: texture_2d<f32>, Strip5Samp: texture_2d<f32>, uv: vec2f, polygon: BokehPolygon,
    settings: BokehSamplingSettings, BokehLinearClamp: sampler) -> vec4f
{
    let pixel: vec4f = BokehFetch(Strip2Samp, uv, BokehLinearClamp);
    let L2: BokehLine = BokehLineSum(Strip2Samp, uv, 2, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    let L3: BokehLine = BokehLineSum(Strip3Samp, uv, 3, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    let L4: BokehLine = BokehLineSum(Strip4Samp, uv, 4, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    let L5: BokehLine = BokehLineSum(Strip5Samp, uv, 5, polygon, true, false, pixel, settings,
        BokehLinearClamp);
    return BokehResolved(L2.sum + L3.sum + L4.sum + L5.sum, pixel);
}
