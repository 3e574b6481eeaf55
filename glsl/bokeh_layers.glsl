// SPDX-License-Identifier: MIT
//
// Layered depth of field with polygonal bokeh, GLSL. Version 0.3.0. Put it after bokeh.glsl.
//
//   `exact` blurs each pixel by its own CoC, so near objects keep a hard outline. Here near objects
//   spread over the background, and the parts that they hide are filled. docs/methods/layered.md
//   has the frame graph and the derivations, layered-evidence.md the evidence for the tuned
//   constants.
//
// CONTRACT
//   Functions only: no bindings, no entry points.
//   In    the map of BokehSignedCoCMap: linear HDR colour, signed CoC in alpha.
//   Out   rgb = the finished image, a = signed CoC.
//   Targets have the size of the image, or 1/2, 1/4, 1/8 of it, rounded up; linear filter, clamp,
//   blending off. RGBA16F; a target that uses two channels may be RG16F.
//   Positions and CoC are in pixels here. s is a signed CoC, below 0 in front of the focus.
//
//   function         size  reads                            writes
//   TileMax          1/8   map                              tiles: largest near and far CoC, mean
//                                                           log brightness of 8 x 8 pixels
//   TileDilate       1/8   tiles, then its own target       dilatedTiles: largest CoC among tiles
//                                                           whose blur reaches this tile
//   Prefilter        1/2   map, dilatedTiles                nearLayer, farLayer, layerCoCSums,
//                                                           gatherCoC
//   LayerCoCReduce   1/8   layerCoCSums, gatherCoC          gatherCoC and sums of each tile
//   LayerCoCRows     1/8   both, dilatedTiles               both, combined along rows of tiles
//   LayerCoCColumns  1/8   both, dilatedTiles               gatherTiles: dilatedTiles, gatherCoC;
//                                                           layerCoC (RG): CoC of both layers
//   Downsample       1/4   map, dilatedTiles, both layers,  midWithHoles, farWithHoles: background;
//                          layerCoC                         nearQuarter, farQuarter: both layers
//   HoleFill         1/4   midWithHoles, farWithHoles,      midFill, farFill: without holes
//                          dilatedTiles
//   LayerFirst       1/2   a layer, its quarter, layerCoC   strips: exact polygon, first pass
//   LayerSecond      1/2   strips, layerCoC                 the blurred layer: second pass
//   Composite        1     map, gatherTiles, both blurred   the finished image
//                          layers, midFill, farFill
//
//   With BOKEH_LAYER_SCALE 4, the targets of Prefilter, LayerFirst and LayerSecond have 1/4 of the
//   image's size instead of 1/2.
//
//   TileDilate runs twice, along rows, then along columns. LayerFirst and LayerSecond run for the
//   near layer, then for the far one; LayersFirst and LayersSecond blur both layers of a square or
//   hexagon.

// -------------------------------------------------------------------------------------------------
// [11] layers
//
//   name                    default    range   meaning
//   BOKEH_LAYER_RINGS       2          0 .. 4  rings of the small gather at full size. It takes one
//                                              more where the far layer is not in reach (with CUBIC
//                                              0: where the CoC of both layers is small), and where
//                                              it reaches far
//   BOKEH_LAYER_SAMPLES     11         2 ..    maximum number of samples on an edge of a layer's
//                                              hexagon; a square has twice as many, a short edge
//                                              fewer
//   BOKEH_LAYER_CUBIC       1          0, 1    1: layers are enlarged by five fetches, not by one
//   BOKEH_LAYER_SCALE       2          2, 4    size of the image / size of a layer; comments that
//                                              say half size mean the layers' size
//   BOKEH_MIN_BRIGHTNESS    0.00001    > 0     darker pixels are raised to it in the mean of their
//                                              tile
//   BOKEH_LAYER_OUTLINES    1          0, 1    1: outlines of objects in focus are blended with the
//                                              blurred background behind them. HLSL's shader
//                                              model 3 has no room for it: always 0
//
//   Presets: define one before bokeh.glsl, or set the constants instead. In WGSL set
//   all four constants of this table.
//
//   preset                  rings      samples cubic  scale
//   BOKEH_PRESET_MOBILE     0          18      0      4
//   BOKEH_PRESET_LOW        1          11      0      2
//   BOKEH_PRESET_MEDIUM     2          11      1      2      the default
//   BOKEH_PRESET_HIGH       3          18      1      2
//   BOKEH_PRESET_ULTRA      4          18      1      2

#ifndef BOKEH_VIEWPORT
#error put bokeh.glsl before bokeh_layers.glsl
#endif
#define BOKEH_LAYERS 1

#if defined(BOKEH_PRESET_MOBILE)
#define BOKEH_PRESET_RINGS 0
#define BOKEH_PRESET_LAYER_SAMPLES 18
#define BOKEH_PRESET_CUBIC 0
#define BOKEH_PRESET_SCALE 4
#elif defined(BOKEH_PRESET_LOW)
#define BOKEH_PRESET_RINGS 1
#define BOKEH_PRESET_LAYER_SAMPLES 11
#define BOKEH_PRESET_CUBIC 0
#define BOKEH_PRESET_SCALE 2
#elif defined(BOKEH_PRESET_HIGH)
#define BOKEH_PRESET_RINGS 3
#define BOKEH_PRESET_LAYER_SAMPLES 18
#define BOKEH_PRESET_CUBIC 1
#define BOKEH_PRESET_SCALE 2
#elif defined(BOKEH_PRESET_ULTRA)
#define BOKEH_PRESET_RINGS 4
#define BOKEH_PRESET_LAYER_SAMPLES 18
#define BOKEH_PRESET_CUBIC 1
#define BOKEH_PRESET_SCALE 2
#else
#define BOKEH_PRESET_RINGS 2
#define BOKEH_PRESET_LAYER_SAMPLES 11
#define BOKEH_PRESET_CUBIC 1
#define BOKEH_PRESET_SCALE 2
#endif

#ifndef BOKEH_PRESET_DEFAULT
#if defined(BOKEH_LAYER_RINGS) || defined(BOKEH_LAYER_SAMPLES) || defined(BOKEH_LAYER_CUBIC)
#error a preset sets BOKEH_LAYER_RINGS, _SAMPLES and _CUBIC: define it or them, not both
#elif defined(BOKEH_LAYER_SCALE)
#error a preset sets BOKEH_LAYER_SCALE: define it or them, not both
#endif
#endif

#ifndef BOKEH_LAYER_RINGS
#define BOKEH_LAYER_RINGS BOKEH_PRESET_RINGS
#endif
#ifndef BOKEH_LAYER_SAMPLES
#define BOKEH_LAYER_SAMPLES BOKEH_PRESET_LAYER_SAMPLES
#endif
#ifndef BOKEH_LAYER_CUBIC
#define BOKEH_LAYER_CUBIC BOKEH_PRESET_CUBIC
#endif
#ifndef BOKEH_LAYER_SCALE
#define BOKEH_LAYER_SCALE BOKEH_PRESET_SCALE
#endif
#ifndef BOKEH_LAYER_OUTLINES
#define BOKEH_LAYER_OUTLINES 1
#endif
#ifndef BOKEH_MIN_BRIGHTNESS
#define BOKEH_MIN_BRIGHTNESS 0.00001
#endif

// Tuned constants: each comment says what goes wrong with another value.
// docs/methods/layered-evidence.md has the measurements.

// The near layer appears while the largest near CoC in reach grows from START to FULL, pixels. With
// lower or higher limits, the edges of small blurs get worse.
#define BOKEH_TUNED_NEAR_START 6.0
#define BOKEH_TUNED_NEAR_FULL 12.0

// The far layer likewise. With lower limits, the half resolution shows; with higher ones, the
// gather has to reach farther.
#define BOKEH_TUNED_FAR_START 10.0
#define BOKEH_TUNED_FAR_FULL 16.0

// The near layer's ramp (BokehLayerWeight) grows with the largest near CoC in reach, but only up to
// this one, pixels. With a higher limit, the gather gets pixels of a large CoC, and its few samples
// show as dashes; with a lower one, the edges of large blurs get worse.
#define BOKEH_TUNED_NEAR_LIMIT 60.0

// Standard deviation of the Gaussian that averages the CoC of a layer, tiles for each pixel of CoC:
// 0.3 CoC. If it is wider, a light takes its CoC from too far away; if it is narrower, the CoC
// changes within one light.
#define BOKEH_TUNED_COC_SIGMA 0.0375

// The averages of 2 x 2 and the linear filter already blur a layer, so this is subtracted from its
// squared CoC, in texels of the half size. If it is lower, the near layer is too soft; if it is
// higher, too sharp.
#define BOKEH_TUNED_NEAR_SELF_BLUR 9.0

// For the far layer, it is a fraction of the squared CoC, from MIN to MAX. A higher MIN makes small
// lights too small, and a lower MAX makes the edges of wide lights soft.
#define BOKEH_TUNED_FAR_SELF_BLUR 0.06
#define BOKEH_TUNED_FAR_SELF_BLUR_MIN 7.5
#define BOKEH_TUNED_FAR_SELF_BLUR_MAX 22.0

// A layer is read at quarter size where its samples are farther apart than this, texels of the half
// size. With a lower value, edges get soft; with a higher one, dots show.
#define BOKEH_TUNED_QUARTER 1.25

// The outer texels of the filter that makes the quarter size have the weight spacing / 4 - SIDE.
// With a lower value, edges get soft; with a higher one, dots show.
#define BOKEH_TUNED_HEXAGON_SIDE 0.4
#define BOKEH_TUNED_SQUARE_SIDE 0.2

// The gather has one more ring where its rings would be wider than this, pixels. With a higher
// value, a thin bright line shows as a row of copies; a lower one costs fetches.
#define BOKEH_TUNED_RING_WIDTH 2.75

// Around a light that is this many times as bright as the mean around it, the gather reaches only
// as far as the light's blur does. With a higher value, a light beside something more blurred shows
// as a ring of copies; with a lower one, that blur is cut off in more places.
#define BOKEH_TUNED_REACH_LIGHT 16.0

// A gather of a single ring reaches at most this far, pixels. With a higher value, an edge shows as
// a row of copies; with a lower one, blurs of pixels in neither layer get too small.
#define BOKEH_TUNED_SINGLE_RADIUS 6.0

// Samples of the gather lie at POSITION - rings * STEP of the width of their ring: half-way with
// two rings. With more rings they lie farther in, or the rotated first ring would get too much
// weight.
#define BOKEH_TUNED_RING_POSITION 0.58
#define BOKEH_TUNED_RING_STEP 0.04

// Pixels and the linear filter blur already, so a CoC spreads as if its squared radius were smaller
// by about this, squared pixels. With a lower value, small blurs get too soft; with a higher one,
// they get too sharp, and dark dots show in them.
#define BOKEH_TUNED_PIXEL_BLUR 0.3

// Half floats leave a pixel that the near layer covers at an alpha of 0.999, so alpha is multiplied
// by this. With a lower factor, a light behind the near layer shines through; with a higher one,
// edges get hard.
#define BOKEH_TUNED_NEAR_ALPHA 1.002

// Layers: says where the image lies in textures of one size; everything in texels of that size
//   size          width and height of the image
//   origin        its first texel: 0, or that of the viewport
//   texel         1 / width and 1 / height of the textures
struct BokehGrid
{
    vec2 size;
    vec2 origin;
    vec2 texel;
};

// Layers: holds what every pass needs to know of the image and of this pixel
//   uv            of this pixel in the image
//   size, origin, texel  as in BokehGrid, at full size; origin is a multiple of 8, and used only
//                 with BOKEH_VIEWPORT 1
//   largest       largest possible CoC, pixels: maxCoC of the map times the image height
//   jitter        from BokehNoise, times its amount; 0 = none
struct BokehLayerContext
{
    vec2 uv;
    vec2 size;
    vec2 origin;
    vec2 texel;
    float largest;
    float jitter;
};

// Layers: makes the context for an image that fills its textures, without jitter
//   imageSize     width and height, pixels
//   maxCoC        fraction of the image height, the same as in the CoC map
BokehLayerContext BokehMakeLayerContext(vec2 uv, vec2 imageSize, float maxCoC)
{
    BokehLayerContext layers;
    layers.uv = uv;
    layers.size = imageSize;
    layers.origin = vec2(0.0, 0.0);
    layers.texel = 1.0 / imageSize;
    layers.largest = maxCoC * imageSize.y;
    layers.jitter = 0.0;
    return layers;
}

// Layers: returns the grid of textures of full size
BokehGrid BokehFullGrid(BokehLayerContext layers)
{
    BokehGrid grid;
    grid.size = layers.size;
    grid.origin = layers.origin;
    grid.texel = layers.texel;
    return grid;
}

// Layers: returns the grid of textures of 1 / scale of the full size, rounded up
BokehGrid BokehReducedGrid(BokehLayerContext layers, float scale)
{
    BokehGrid grid;
    grid.size = ceil(layers.size / scale);
    grid.origin = layers.origin / scale;
    grid.texel = 1.0 / grid.size;
    if (BOKEH_VIEWPORT > 0)
    {
        grid.texel = 1.0 / ceil(floor(1.0 / layers.texel + 0.5) / scale);
    }
    return grid;
}

// Layers: returns the grid of the layers' textures
BokehGrid BokehLayerGrid(BokehLayerContext layers)
{
    return BokehReducedGrid(layers, float(BOKEH_LAYER_SCALE));
}

// Layers: converts a position in the image to texture uv
//   place         texels of the grid from the image's corner; the first centre is at 0.5, 0.5
vec2 BokehGridCoords(vec2 place, BokehGrid grid)
{
    vec2 coords = place;
    if (BOKEH_VIEWPORT > 0)
    {
        vec2 inset = min(vec2(0.5078125, 0.5078125), grid.size * 0.5);
        coords = grid.origin + clamp(place, inset, grid.size - inset);
    }
    return coords * grid.texel;
}

// Layers: fetches with the filter, at a position in texels of the grid
vec4 BokehFetchGrid(BOKEH_TEXTURE tex, vec2 place, BokehGrid grid)
{
    return BokehFetchTexture(tex, BokehGridCoords(place, grid));
}

// Layers: fetches one texel, whatever filter the texture has
//   place         its centre, texels of the grid
vec4 BokehFetchGridTexel(BOKEH_TEXTURE tex, vec2 place, BokehGrid grid)
{
    return BokehFetchTexel(tex, BokehGridCoords(place, grid));
}

// Layers: fetches with the filter at an offset from the middle of a pixel
//   It divides, because grid.texel is rounded: in the middle of a dark texel, that error would show
//   0.00001 of a light beside it.
//   center        of the pixel, texels of the grid
//   offset        texels of the grid
vec4 BokehFetchAround(BOKEH_TEXTURE tex, vec2 center, vec2 offset, BokehGrid grid)
{
    vec2 coords = (center + offset) / grid.size;
    if (BOKEH_VIEWPORT > 0)
    {
        coords = BokehGridCoords(center + offset, grid);
    }
    return BokehFetchTexture(tex, coords);
}

// Layers: returns the largest of the three channels
float BokehBrightest(vec3 color)
{
    return max(max(color.r, color.g), color.b);
}

// Layers: returns how fast the layer weight grows with the CoC, 1 / pixels, for BokehLayerWeight
//   largest       largest CoC that reaches this tile, pixels
//   startCoC, fullCoC  pixels: there is no layer up to startCoC, a complete one from fullCoC
float BokehLayerSlope(float largest, float startCoC, float fullCoC)
{
    float gate = clamp((largest - startCoC) / (fullCoC - startCoC), 0.001, 1.0);
    return 5.0 / max(largest / gate, 2.0);
}

// Layers: returns the slope of the near layer
float BokehNearSlope(float largest)
{
    return BokehLayerSlope(min(largest, BOKEH_TUNED_NEAR_LIMIT), BOKEH_TUNED_NEAR_START,
        BOKEH_TUNED_NEAR_FULL);
}

// Layers: returns the slope of the far layer
float BokehFarSlope(float largest)
{
    return BokehLayerSlope(largest, BOKEH_TUNED_FAR_START, BOKEH_TUNED_FAR_FULL);
}

// Layers: returns the weight of a pixel in a layer: a ramp from 0 to 1 between 0.4 and 0.6 of the
//   largest CoC that reaches it
//
//      1 |          ____
//        |         /         Ramp lower: half the largest CoC is blurred like the largest.
//      0 |________/          Ramp higher: more is left to the gather, which is grainy.
//        0       .4 .6   1   CoC / largest
//   CoC           pixels: -s for the near layer, s for the far one
//   slope         from BokehNearSlope or BokehFarSlope
float BokehLayerWeight(float CoC, float slope)
{
    return clamp(CoC * slope - 2.0, 0.0, 1.0);
}

// Layers: finds the largest near and far CoC of a tile of 8 x 8 pixels, and its mean brightness
//   Reads the CoC map, writes tiles. Later passes need the CoC to know how far blur reaches, and
//   the brightness to know what is bright: relative to the mean, so exposure does not change the
//   blur.
//   returns       r = near, g = far, both >= 0, pixels; b = mean log2 of brightness
vec4 BokehTileMax(BOKEH_TEXTURE MapSamp, BokehLayerContext layers)
{
    vec2 first = floor(layers.uv * ceil(layers.size / 8.0)) * 8.0 + vec2(0.5, 0.5);
    vec3 found = vec3(0.0, 0.0, 0.0);
    for (int y = 0; y < 8; y++)
    {
        for (int x = 0; x < 8; x++)
        {
            vec2 place = first + vec2(float(x), float(y));
            vec4 pixel = BokehFetchGridTexel(MapSamp, place, BokehFullGrid(layers));
            float s = pixel.a * layers.size.y;
            float logBrightness = log2(max(BokehBrightest(pixel.rgb), BOKEH_MIN_BRIGHTNESS));
            found = vec3(max(found.r, -s), max(found.g, s), found.b + logBrightness);
        }
    }
    return vec4(min(found.r, BOKEH_MAX_COLOR), min(found.g, BOKEH_MAX_COLOR), found.b / 64.0, 1.0);
}

// Layers: returns how much of the CoC of another tile applies here, pixels
//   All of it within the reach of its blur plus a margin for the linear filter. It fades out over
//   one more tile, so that nothing jumps when a CoC changes.
//   tiles         distance of the other tile
vec2 BokehReaching(vec2 CoC, float tiles)
{
    vec2 weight = CoC / 16.0 + 1.0 - max(tiles - 2.0, 0.0);
    return CoC * clamp(weight, vec2(0.0, 0.0), vec2(1.0, 1.0));
}

// Layers: returns how much of the gatherCoC of another tile applies here, pixels
//   As in BokehReaching, but that of a light only applies to the tiles that its blur covers.
//   tiles         distance of the other tile
vec4 BokehGatherReaching(vec4 CoC, float tiles)
{
    vec2 isCovered = clamp((CoC.ba / 16.0 + 0.5 - tiles) * 1000000.0, vec2(0.0, 0.0),
        vec2(1.0, 1.0));
    return vec4(BokehReaching(CoC.rg, tiles), CoC.ba * isCovered);
}

// Layers: returns how many tiles the largest possible CoC can reach, at most 127
float BokehReachTiles(BokehLayerContext layers)
{
    return min(ceil(layers.largest / 16.0) + 2.0, 127.0);
}

// Layers: finds the largest near and far CoC among the tiles whose blur reaches this tile
//   Reads tiles, then its own target: it runs twice, along rows and along columns. Writes
//   dilatedTiles, from which later passes know whether a layer can be here.
//
//      . . K . .   -->  K K K K K      if a CoC of K reaches two tiles in each direction
//   axis          (1, 0), then (0, 1)
//   returns       r = near, g = far, pixels; b = mean log2 of brightness of the tiles around
vec4 BokehTileDilate(BOKEH_TEXTURE TilesSamp, vec2 axis, BokehLayerContext layers)
{
    BokehGrid grid = BokehReducedGrid(layers, 8.0);
    float radius = BokehReachTiles(layers);
    vec2 found = vec2(0.0, 0.0);
    float logBrightness = 0.0;
    for (int i = 0; i < 255; i++)
    {
        float tiles = float(i) - radius;
        if (tiles > radius)
        {
            break;
        }
        vec4 tile = BokehFetchGrid(TilesSamp, layers.uv * grid.size + axis * tiles, grid);
        found = max(found, BokehReaching(tile.rg, abs(tiles)));
        logBrightness += tile.b;
    }
    return vec4(found, logBrightness / (2.0 * radius + 1.0), 1.0);
}

// Layers: returns the weights of four pixels in the mean CoC of their layer: bright pixels have
//   more
//   A lamp thus gets a polygon of its own size, even among many dark pixels with another CoC.
//   inverseBrightness  1 / mean brightness of the tiles around
//   maxWeight     at most 10000: this times the largest CoC / 8 must fit into a half float.
//                 BokehLayerCoCColumns accepts a weight down to 0.0001 with a CoC down to 6 pixels,
//                 and such a sum is still a normal half float; some GPUs flush subnormal ones to 0.
vec4 BokehBlurWeights(vec4 a, vec4 b, vec4 c, vec4 d, float inverseBrightness, float maxWeight)
{
    vec4 brightest = vec4(BokehBrightest(a.rgb), BokehBrightest(b.rgb), BokehBrightest(c.rgb),
        BokehBrightest(d.rgb));
    return min(0.01 + brightest * inverseBrightness, vec4(maxWeight, maxWeight, maxWeight,
        maxWeight));
}

// Layers: holds what BokehPrefilter writes
//   nearLayer, farLayer  rgb times layer weight, layer weight
//   layerCoCSums  for the mean CoC of both layers: CoC / 8 times weight, weight
//   gatherCoC     rg = largest near and far CoC of the pixels that are not completely in a layer,
//                 ba = those of lights alone; pixels
struct BokehPrefiltered
{
    vec4 nearLayer;
    vec4 farLayer;
    vec4 layerCoCSums;
    vec4 gatherCoC;
};

// Layers: returns BokehLayerWeight of four pixels
vec4 BokehLayerWeights(vec4 CoC, float slope)
{
    return clamp(CoC * slope - 2.0, vec4(0.0, 0.0, 0.0, 0.0), vec4(1.0, 1.0, 1.0, 1.0));
}

// Layers: finds the darkest near colour around a near edge, and the brightest one behind it
//   found         of the pixels so far
//   pixel         one more
//   nearWeight    its layer weight; the pixel is near from half of maxNearWeight on
//   returns       rgb = darkest near colour, a = brightness of the brightest pixel behind
vec4 BokehSurroundings(vec4 found, vec4 pixel, float nearWeight, float maxNearWeight)
{
    vec4 result = vec4(min(found.rgb, pixel.rgb), found.a);
    if (nearWeight < 0.5 * maxNearWeight)
    {
        result = vec4(found.rgb, max(found.a, BokehBrightest(pixel.rgb)));
    }
    return result;
}

// Layers: removes from a near pixel the light from behind that antialiasing has mixed into it
//   around        from BokehSurroundings
//   returns       rgb = colour, a = layer weight
vec4 BokehNearPixel(vec4 pixel, float nearWeight, vec4 around)
{
    vec4 result = vec4(pixel.rgb, nearWeight);
    float brightest = BokehBrightest(pixel.rgb);
    float limit = BokehBrightest(around.rgb);
    if (around.a > brightest)
    {
        result = vec4(min(pixel.rgb, around.rgb), nearWeight);
        if (brightest > limit)
        {
            // the part of it that is not light from behind
            result = vec4(result.rgb, nearWeight * (around.a - brightest) / (around.a - limit));
        }
    }
    return result;
}

// Layers: returns gatherCoC of one pixel
//   weights       near and far layer weight of the pixel
vec4 BokehGatherCoC(vec4 pixel, vec2 weights, float inverseBrightness, BokehGrid full)
{
    vec2 rest = min(4.0 - 4.0 * weights, vec2(1.0, 1.0));
    vec2 CoC = max(vec2(-pixel.a, pixel.a) * full.size.y * rest, vec2(0.0, 0.0));
    vec4 gatherCoC = vec4(CoC, 0.0, 0.0);
    if (BokehBrightest(pixel.rgb) * inverseBrightness > BOKEH_TUNED_REACH_LIGHT)
    {
        gatherCoC = vec4(CoC, CoC);
    }
    return gatherCoC;
}

// Layers: does the work of BokehPrefilter for 2 x 2 pixels
//   middle        the corner that the four pixels share, pixels
//   tile          texel of dilatedTiles that covers them
//   returns       their mean, and the maximum for gatherCoC
BokehPrefiltered BokehPrefilterBlock(BOKEH_TEXTURE MapSamp, vec2 middle, vec4 tile,
    BokehLayerContext layers)
{
    BokehGrid full = BokehFullGrid(layers);
    float nearSlope = BokehNearSlope(tile.r);
    float farSlope = BokehFarSlope(tile.g);
    float inverseBrightness = exp2(-tile.b);
    float maxWeight = 500000.0 / max(layers.largest, 50.0);
    // the four pixels
    vec4 a = BokehFetchGridTexel(MapSamp, middle + vec2(-0.5, -0.5), full);
    vec4 b = BokehFetchGridTexel(MapSamp, middle + vec2(0.5, -0.5), full);
    vec4 c = BokehFetchGridTexel(MapSamp, middle + vec2(-0.5, 0.5), full);
    vec4 d = BokehFetchGridTexel(MapSamp, middle + vec2(0.5, 0.5), full);
    vec4 s = vec4(a.a, b.a, c.a, d.a) * full.size.y;
    vec4 nearWeights = BokehLayerWeights(-s, nearSlope);
    vec4 farWeights = BokehLayerWeights(s, farSlope);
    vec4 farSum = vec4(a.rgb, 1.0) * farWeights.x + vec4(b.rgb, 1.0) * farWeights.y + vec4(c.rgb,
        1.0) * farWeights.z + vec4(d.rgb, 1.0) * farWeights.w;
    vec4 weights = farWeights * BokehBlurWeights(a, b, c, d, inverseBrightness, maxWeight);
    vec4 one = vec4(1.0, 1.0, 1.0, 1.0);
    vec4 sums = vec4(0.0, 0.0, dot(weights, s) / 8.0, dot(weights, one));
    vec4 gatherA = BokehGatherCoC(a, vec2(nearWeights.x, farWeights.x), inverseBrightness, full);
    vec4 gatherB = BokehGatherCoC(b, vec2(nearWeights.y, farWeights.y), inverseBrightness, full);
    vec4 gatherC = BokehGatherCoC(c, vec2(nearWeights.z, farWeights.z), inverseBrightness, full);
    vec4 gatherD = BokehGatherCoC(d, vec2(nearWeights.w, farWeights.w), inverseBrightness, full);
    vec4 gatherCoC = max(max(gatherA, gatherB), max(gatherC, gatherD));
    float maxNearWeight = max(max(nearWeights.x, nearWeights.y), max(nearWeights.z, nearWeights.w));
    vec4 nearSum = vec4(0.0, 0.0, 0.0, 0.0);
    if (maxNearWeight > 0.0)
    {
        // an antialiased pixel of a near edge holds light of the background: if that is
        // brighter, limit all near pixels to the darkest one around
        vec4 around = vec4(BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, 0.0);
        around = BokehSurroundings(around, a, nearWeights.x, maxNearWeight);
        around = BokehSurroundings(around, b, nearWeights.y, maxNearWeight);
        around = BokehSurroundings(around, c, nearWeights.z, maxNearWeight);
        around = BokehSurroundings(around, d, nearWeights.w, maxNearWeight);
        for (int y = 0; y < 4; y++)
        {
            for (int x = 0; x < 4; x++)
            {
                vec2 offset = vec2(float(x) - 1.5, float(y) - 1.5);
                // of the twelve pixels around the block, take four, one on each side
                if ((abs(offset.x) - abs(offset.y)) * offset.x * offset.y > 0.5)
                {
                    vec4 pixel = BokehFetchGridTexel(MapSamp, middle + offset, full);
                    around = BokehSurroundings(around, pixel, BokehLayerWeight(-pixel.a *
                        full.size.y, nearSlope), maxNearWeight);
                }
            }
        }
        a = BokehNearPixel(a, nearWeights.x, around);
        b = BokehNearPixel(b, nearWeights.y, around);
        c = BokehNearPixel(c, nearWeights.z, around);
        d = BokehNearPixel(d, nearWeights.w, around);
        nearSum = vec4(a.rgb, 1.0) * a.a + vec4(b.rgb, 1.0) * b.a + vec4(c.rgb, 1.0) * c.a +
            vec4(d.rgb, 1.0) * d.a;
        weights = vec4(a.a, b.a, c.a, d.a) * BokehBlurWeights(a, b, c, d, inverseBrightness,
            maxWeight);
        sums = vec4(-dot(weights, s) / 8.0, dot(weights, one), sums.z, sums.w);
    }
    BokehPrefiltered targets;
    targets.nearLayer = nearSum * 0.25;
    targets.farLayer = farSum * 0.25;
    float maxValue = BOKEH_MAX_COLOR;
    targets.layerCoCSums = min(sums * 0.25, vec4(maxValue, maxValue, maxValue, maxValue));
    targets.gatherCoC = min(gatherCoC, vec4(maxValue, maxValue, maxValue, maxValue));
    return targets;
}

// Layers: sorts the pixels into a near and a far layer, 1 / BOKEH_LAYER_SCALE as large as the image
//   Reads the CoC map and dilatedTiles. Writes both layers, and two targets for the passes after
//   it: layerCoCSums, from which the CoC of each layer follows, and gatherCoC, which says how far
//   the gather has to reach. Antialiased pixels of near edges hold light of the background; if that
//   is bright, it is removed first, or it would be blurred into a false rim.
BokehPrefiltered BokehPrefilter(BOKEH_TEXTURE MapSamp, BOKEH_TEXTURE DilatedTilesSamp,
    BokehLayerContext layers)
{
    BokehGrid grid = BokehLayerGrid(layers);
    vec2 center = (floor(layers.uv * grid.size) + 0.5) * float(BOKEH_LAYER_SCALE);
    vec4 tile = BokehFetchGrid(DilatedTilesSamp, center / 8.0, BokehReducedGrid(layers, 8.0));
    vec2 first = center + (1.0 - 0.5 * float(BOKEH_LAYER_SCALE));
    BokehPrefiltered targets = BokehPrefilterBlock(MapSamp, first, tile, layers);
    if (BOKEH_LAYER_SCALE > 2)
    {
        // a texel covers 4 x 4 pixels, which are three more blocks
        for (int i = 1; i < 4; i++)
        {
            float row = floor(0.5 * float(i));
            vec2 middle = first + 2.0 * vec2(float(i) - 2.0 * row, row);
            BokehPrefiltered block = BokehPrefilterBlock(MapSamp, middle, tile,
                layers);
            targets.nearLayer += block.nearLayer;
            targets.farLayer += block.farLayer;
            targets.layerCoCSums += block.layerCoCSums;
            targets.gatherCoC = max(targets.gatherCoC, block.gatherCoC);
        }
        targets.nearLayer *= 0.25;
        targets.farLayer *= 0.25;
        targets.layerCoCSums *= 0.25;
    }
    return targets;
}

// Layers: holds what is known of the CoC of a tile, and later of the tiles around it
//   gatherCoC     the largest
//   sums          the mean of layerCoCSums
struct BokehTileSums
{
    vec4 gatherCoC;
    vec4 sums;
};

// Layers: reduces layerCoCSums and gatherCoC to tiles
//   Reads both at half size, writes the mean of the first and the maximum of the second for each
//   tile, so that the two passes after it have few texels to read.
BokehTileSums BokehLayerCoCReduce(BOKEH_TEXTURE SumsSamp, BOKEH_TEXTURE GatherCoCSamp,
    BokehLayerContext layers)
{
    BokehGrid grid = BokehLayerGrid(layers);
    // along a tile
    int texels = 8 / BOKEH_LAYER_SCALE;
    vec2 first = floor(layers.uv * ceil(layers.size / 8.0)) * float(texels) + vec2(0.5, 0.5);
    vec4 sums = vec4(0.0, 0.0, 0.0, 0.0);
    vec4 gatherCoC = vec4(0.0, 0.0, 0.0, 0.0);
    for (int y = 0; y < texels; y++)
    {
        for (int x = 0; x < texels; x++)
        {
            vec2 place = first + vec2(float(x), float(y));
            sums += BokehFetchGridTexel(SumsSamp, place, grid);
            gatherCoC = max(gatherCoC, BokehFetchGridTexel(GatherCoCSamp, place, grid));
        }
    }
    BokehTileSums targets;
    targets.gatherCoC = gatherCoC;
    targets.sums = sums / float(texels * texels);
    return targets;
}

// Layers: does the work of BokehLayerCoCRows along any axis
//   axis          (1, 0) or (0, 1)
BokehTileSums BokehLayerCoCAlong(BOKEH_TEXTURE GatherCoCSamp, BOKEH_TEXTURE SumsSamp,
    BOKEH_TEXTURE DilatedTilesSamp, vec2 axis, BokehLayerContext layers)
{
    BokehGrid grid = BokehReducedGrid(layers, 8.0);
    vec2 tile = BokehFetchGrid(DilatedTilesSamp, layers.uv * grid.size, grid).rg;
    vec2 sigma = max(tile * BOKEH_TUNED_COC_SIGMA, vec2(0.6, 0.6));
    float radius = BokehReachTiles(layers);
    vec4 sums = vec4(0.0, 0.0, 0.0, 0.0);
    vec4 gatherCoC = vec4(0.0, 0.0, 0.0, 0.0);
    vec2 total = vec2(0.0, 0.0);
    for (int i = 0; i < 255; i++)
    {
        float tiles = float(i) - radius;
        if (tiles > radius)
        {
            break;
        }
        vec2 place = layers.uv * grid.size + axis * tiles;
        vec2 weight = exp(-0.5 * tiles * tiles / (sigma * sigma));
        sums += BokehFetchGrid(SumsSamp, place, grid) * vec4(weight.x, weight.x, weight.y,
            weight.y);
        vec4 found = BokehFetchGrid(GatherCoCSamp, place, grid);
        gatherCoC = max(gatherCoC, BokehGatherReaching(found, abs(tiles)));
        total += weight;
    }
    BokehTileSums targets;
    targets.gatherCoC = gatherCoC;
    targets.sums = sums / vec4(total.x, total.x, total.y, total.y);
    return targets;
}

// Layers: combines gatherCoC and sums of the tiles around, along rows
//   Reads what BokehLayerCoCReduce wrote, and dilatedTiles. Writes the largest gatherCoC that
//   reaches each tile, and a mean of the sums by a Gaussian with a standard deviation of 0.3 of the
//   CoC in reach.
BokehTileSums BokehLayerCoCRows(BOKEH_TEXTURE GatherCoCSamp, BOKEH_TEXTURE SumsSamp,
    BOKEH_TEXTURE DilatedTilesSamp, BokehLayerContext layers)
{
    return BokehLayerCoCAlong(GatherCoCSamp, SumsSamp, DilatedTilesSamp, vec2(1.0, 0.0), layers);
}

// Layers: holds what BokehLayerCoCColumns writes
//   gatherTiles   largest near and far CoC whose blur reaches this tile, then how far the gather
//                 has to reach: the largest near and far gatherCoC, or those of lights; pixels
//   layerCoC      rg = CoC to blur the near and the far layer with, pixels; 0 without a layer
struct BokehLayerCoCTargets
{
    vec4 gatherTiles;
    vec4 layerCoC;
};

// Layers: combines along columns, and divides: one CoC for each layer and tile
//   Reads what BokehLayerCoCRows wrote, and dilatedTiles. Writes gatherTiles for Composite and
//   layerCoC for the passes that blur the layers: a blur can be separated into two passes only
//   where all pixels around use one CoC.
BokehLayerCoCTargets BokehLayerCoCColumns(BOKEH_TEXTURE GatherCoCSamp, BOKEH_TEXTURE SumsSamp,
    BOKEH_TEXTURE DilatedTilesSamp, BokehLayerContext layers)
{
    BokehGrid grid = BokehReducedGrid(layers, 8.0);
    vec2 tile = BokehFetchGrid(DilatedTilesSamp, layers.uv * grid.size, grid).rg;
    BokehTileSums tileSums = BokehLayerCoCAlong(GatherCoCSamp, SumsSamp, DilatedTilesSamp, vec2(0.0,
        1.0), layers);
    vec4 sums = tileSums.sums;
    vec2 layerCoC = vec2(0.0, 0.0);
    if (sums.g > 0.0001 && tile.r > BOKEH_TUNED_NEAR_START)
    {
        layerCoC = vec2(8.0 * sums.r / sums.g, 0.0);
    }
    if (sums.a > 0.0001 && tile.g > BOKEH_TUNED_FAR_START)
    {
        layerCoC = vec2(layerCoC.x, 8.0 * sums.b / sums.a);
    }
    // a light comes first, but not the little of it that a linear filter leaks into the next tile
    vec2 light = tileSums.gatherCoC.ba;
    vec2 isDark = clamp(2.0 - light, vec2(0.0, 0.0), vec2(1.0, 1.0));
    BokehLayerCoCTargets targets;
    targets.gatherTiles = vec4(tile, light + tileSums.gatherCoC.rg * isDark);
    targets.layerCoC = vec4(layerCoC, 0.0, 1.0);
    return targets;
}

// -------------------------------------------------------------------------------------------------
// [12] quarter size: smooth copies of the layers, and the background that the near layer hides

// Layers: returns the CoC that the near and the far layer are blurred with here, pixels
vec2 BokehLayerCoC(BOKEH_TEXTURE LayerCoCSamp, BokehLayerContext layers)
{
    BokehGrid grid = BokehLayerGrid(layers);
    vec2 place = layers.uv * grid.size * (float(BOKEH_LAYER_SCALE) / 8.0);
    return BokehFetchGrid(LayerCoCSamp, place, BokehReducedGrid(layers, 8.0)).rg;
}

// Layers: says how a layer is blurred at one point
//   CoC           texels of the half size; 0.5 if there is no layer or nothing to do (compare with
//                 0.51: on a GPU, sqrt(0.25) may come out slightly above 0.5)
//   spacing       between samples on an edge, texels, at least 1; an edge of a hexagon has at most
//                 BOKEH_LAYER_SAMPLES samples
//   useQuarterLayer  true: the first pass reads the layer at quarter size, because samples are too
//                 far apart for the half size
//   sideTap       weight of the texels beside the middle one in the quarter-size filter, chosen so
//                 that the filter removes detail of the size of the spacing; more makes edges soft,
//                 less leaves dots
struct BokehBlur
{
    float CoC;
    float spacing;
    bool useQuarterLayer;
    float sideTap;
};

// Layers: chooses how a layer is blurred from its CoC
//   layerCoC      from BokehLayerCoC
BokehBlur BokehLayerBlur(vec2 layerCoC, bool isFar, BokehPolygon polygon)
{
    float CoC = layerCoC.r / float(BOKEH_LAYER_SCALE);
    float selfBlur = BOKEH_TUNED_NEAR_SELF_BLUR;
    if (isFar)
    {
        CoC = layerCoC.g / float(BOKEH_LAYER_SCALE);
        selfBlur = clamp(BOKEH_TUNED_FAR_SELF_BLUR * CoC * CoC, BOKEH_TUNED_FAR_SELF_BLUR_MIN,
            BOKEH_TUNED_FAR_SELF_BLUR_MAX);
    }
    // a square has only one line in each pass
    float spacing = 0.5 * CoC / float(BOKEH_LAYER_SAMPLES);
    float hard = BOKEH_TUNED_HEXAGON_SIDE;
    if (polygon.sides < 6)
    {
        spacing = 0.354 * CoC / float(BOKEH_LAYER_SAMPLES);
        hard = BOKEH_TUNED_SQUARE_SIDE;
    }
    BokehBlur blur;
    blur.useQuarterLayer = spacing > BOKEH_TUNED_QUARTER;
    blur.sideTap = 0.0;
    if (blur.useQuarterLayer)
    {
        blur.sideTap = clamp(0.25 * spacing - hard, 0.0, 0.6);
        selfBlur += 14.0 + 154.0 * blur.sideTap / (1.0 + 2.0 * blur.sideTap);
    }
    blur.CoC = sqrt(max(CoC * CoC - selfBlur, 0.25));
    blur.spacing = max(spacing, 1.0);
    return blur;
}

// Layers: samples a layer for its copy at quarter size, smoothed over about the distance between
//   two samples of the blur
//   center        texels of the half size
//   side          sideTap of BokehBlur
vec4 BokehQuarterLayer(BOKEH_TEXTURE LayerSamp, vec2 center, float side, BokehLayerContext layers)
{
    BokehGrid grid = BokehLayerGrid(layers);
    vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
    if (side > 0.0)
    {
        for (int y = 0; y < 3; y++)
        {
            for (int x = 0; x < 3; x++)
            {
                vec2 offset = vec2(float(x) - 1.0, float(y) - 1.0);
                vec2 weight = 1.0 - (1.0 - side) * abs(offset);
                sum += BokehFetchGrid(LayerSamp, center + 2.0 * offset, grid) * (weight.x *
                    weight.y);
            }
        }
        sum = sum / ((1.0 + 2.0 * side) * (1.0 + 2.0 * side));
    }
    else
    {
        sum = BokehFetchGrid(LayerSamp, center, grid);
    }
    return sum;
}

// Layers: holds what BokehDownsample writes
//   midWithHoles, farWithHoles  pixels in neither layer, and those of the far layer: rgb times
//                 weight, weight
//   nearQuarter, farQuarter  smooth copies of the two layers
struct BokehDownsampled
{
    vec4 midWithHoles;
    vec4 farWithHoles;
    vec4 nearQuarter;
    vec4 farQuarter;
};

// Layers: makes smooth copies of the layers, and collects the background, all at quarter size
//   Reads the CoC map, dilatedTiles, both layers and layerCoC. Writes nearQuarter and farQuarter
//   for wide blurs, and midWithHoles and farWithHoles, which have holes where near objects are.
//   Bright pixels have less weight in the background, or one light would fill a whole hole.
BokehDownsampled BokehDownsample(BOKEH_TEXTURE MapSamp, BOKEH_TEXTURE DilatedTilesSamp,
    BOKEH_TEXTURE NearSamp, BOKEH_TEXTURE FarSamp, BOKEH_TEXTURE LayerCoCSamp, BokehPolygon polygon,
    BokehLayerContext layers)
{
    BokehGrid full = BokehFullGrid(layers);
    vec2 first = floor(layers.uv * ceil(layers.size / 4.0)) * 4.0 + vec2(0.5, 0.5);
    vec2 middlePlace = first + vec2(1.5, 1.5);
    vec4 tile = BokehFetchGrid(DilatedTilesSamp, middlePlace / 8.0, BokehReducedGrid(layers, 8.0));
    float nearSlope = BokehNearSlope(tile.r);
    float farSlope = BokehFarSlope(tile.g);
    float inverseBrightness = exp2(-tile.b);
    vec4 midColor = vec4(0.0, 0.0, 0.0, 0.0);
    vec4 farColor = vec4(0.0, 0.0, 0.0, 0.0);
    for (int y = 0; y < 4; y++)
    {
        for (int x = 0; x < 4; x++)
        {
            vec2 place = first + vec2(float(x), float(y));
            vec4 pixel = BokehFetchGridTexel(MapSamp, place, full);
            float s = pixel.a * full.size.y;
            // a partly near pixel is hardly background, or a near light would shine through itself
            float nearWeight = BokehLayerWeight(-s, nearSlope);
            float notNear = max(1.0 - 2.0 * nearWeight, 0.0625 - 0.0625 * nearWeight);
            float farWeight = BokehLayerWeight(s, farSlope);
            float weight = notNear / (1.0 + BokehBrightest(pixel.rgb) * inverseBrightness);
            midColor += vec4(pixel.rgb, 1.0) * (weight * (1.0 - farWeight));
            farColor += vec4(pixel.rgb, 1.0) * (weight * farWeight);
        }
    }
    vec2 center = middlePlace / float(BOKEH_LAYER_SCALE);
    vec2 layerCoC = BokehLayerCoC(LayerCoCSamp, layers);
    BokehDownsampled targets;
    targets.midWithHoles = midColor / 16.0;
    targets.farWithHoles = farColor / 16.0;
    BokehBlur nearBlur = BokehLayerBlur(layerCoC, false, polygon);
    BokehBlur farBlur = BokehLayerBlur(layerCoC, true, polygon);
    targets.nearQuarter = BokehQuarterLayer(NearSamp, center, nearBlur.sideTap, layers);
    targets.farQuarter = BokehQuarterLayer(FarSamp, center, farBlur.sideTap, layers);
    return targets;
}

// Layers: returns the direction of edge k, rotated but not squeezed
vec2 BokehEdgeDirection(int k, BokehPolygon polygon)
{
    vec2 outwards = BokehTurn(float(k), polygon);
    return BokehRotated(vec2(-outwards.y, outwards.x), polygon.axis);
}

// Layers: returns how many samples of a ring lie on each edge of the polygon
//   There are 6 on the first ring, 12 on the second and so on, divided among the edges, so all
//   rings are sampled with the same density. A polygon with more sides than that has one on each.
int BokehSamplesPerEdge(int ring, BokehPolygon polygon)
{
    return int(max(6.0 * float(ring) / float(polygon.sides) + 0.5, 1.0));
}

// Layers: returns the weights that a texel of midWithHoles and one of farWithHoles had before
//   BokehDownsample divided them by 1 + brightness / mean
vec2 BokehHoleWeights(vec4 midColor, vec4 farColor, float inverseBrightness)
{
    return vec2(midColor.a + BokehBrightest(midColor.rgb) * inverseBrightness, farColor.a +
        BokehBrightest(farColor.rgb) * inverseBrightness);
}

// Layers: holds what BokehHoleFill writes
//   midFill       rgb = pixels in neither layer, a = their fraction of the background around
//   farFill       rgb = the far layer
struct BokehFilled
{
    vec4 midFill;
    vec4 farFill;
};

// Layers: fills the holes that near objects leave in the background, from their surroundings
//   Reads midWithHoles, farWithHoles and dilatedTiles, and writes both without holes. Around each
//   texel lie three rings, and the nearest background has by far the highest weight:
//
//      o    o    o      ring diameters are 1/8, 0.35 and 1 of the largest near CoC in reach;
//        o o o          a texel at a ring's diameter d has the weight 1 / (1 + 4 d^3),
//      o o x o o        times its own weight, which is 0 in a hole
//        o o o
//      o    o    o
//   MidSamp, FarSamp  midWithHoles and farWithHoles of BokehDownsample
BokehFilled BokehHoleFill(BOKEH_TEXTURE MidSamp, BOKEH_TEXTURE FarSamp,
    BOKEH_TEXTURE DilatedTilesSamp, BokehPolygon polygon, BokehLayerContext layers)
{
    BokehGrid grid = BokehReducedGrid(layers, 4.0);
    vec2 center = layers.uv * grid.size;
    vec4 tile = BokehFetchGrid(DilatedTilesSamp, center / 2.0, BokehReducedGrid(layers, 8.0));
    float nearCoC = tile.r;
    float inverseBrightness = exp2(-tile.b);
    vec2 corner = BokehRotated(polygon.corner, polygon.axis);
    vec2 direction = BokehEdgeDirection(1, polygon);
    vec2 turn = BokehTurn(1.0, polygon);
    vec4 midColor = BokehFetchGrid(MidSamp, center, grid);
    vec4 farColor = BokehFetchGrid(FarSamp, center, grid);
    vec2 weights = BokehHoleWeights(midColor, farColor, inverseBrightness);
    for (int ring = 0; ring < 3; ring++)
    {
        // no near layer, no holes
        if (nearCoC < BOKEH_TUNED_NEAR_START)
        {
            break;
        }
        // diameter in texels: 1/8, 0.35 and 1 of the CoC
        float diameter = max(nearCoC / 8.0, 2.0) * exp2(1.5 * float(ring) - 2.0);
        float weight = 1.0 / (1.0 + 4.0 * diameter * diameter * diameter);
        vec2 scale = vec2(polygon.squeeze * diameter, diameter);
        int onEdge = BokehSamplesPerEdge(1, polygon);
        for (int edge = 1; edge <= polygon.sides; edge++)
        {
            vec2 along = direction * (BokehEdgeLength(edge, polygon) / float(onEdge));
            for (int i = 0; i < onEdge; i++)
            {
                vec2 place = center + corner * scale;
                vec4 midTexel = BokehFetchGrid(MidSamp, place, grid);
                vec4 farTexel = BokehFetchGrid(FarSamp, place, grid);
                midColor += midTexel * weight;
                farColor += farTexel * weight;
                weights += BokehHoleWeights(midTexel, farTexel, inverseBrightness) * weight;
                corner += along;
            }
            direction = BokehRotated(direction, turn);
        }
    }
    vec3 both = (midColor.rgb + farColor.rgb) / max(midColor.a + farColor.a, 0.000001);
    float midWeight = weights.r / max(weights.r + weights.g, 0.000001);
    BokehFilled targets;
    targets.midFill = vec4(both, midWeight);
    targets.farFill = vec4(both, 1.0);
    if (midColor.a > 0.000001)
    {
        targets.midFill = vec4(midColor.rgb / midColor.a, midWeight);
    }
    if (farColor.a > 0.000001)
    {
        targets.farFill = vec4(farColor.rgb / farColor.a, 1.0);
    }
    return targets;
}

// -------------------------------------------------------------------------------------------------
// [13] polygons at half size
//
//   The parallelograms of [5], without weights and without a leakage test, because a layer holds
//   nothing that must not spread. All four channels are blurred, so alpha becomes the coverage.

// Layers: adds up the samples of a line
//   The caller chooses between a layer and its quarter-size copy. If this loop chose, a renderer
//   that runs on the CPU would fetch from both for every sample.
//   first         position of the line's start, in texels of `grid`
//   sampleStep    from one sample to the next
//   samples       how many, with a fraction: the last sample has this fraction as its weight
//   phase         position of the last sample within its step, 0.5: the middle
vec4 BokehLayerSamples(BOKEH_TEXTURE tex, vec2 first, vec2 sampleStep, float samples, float phase,
    BokehGrid grid)
{
    vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
    for (int i = 0; i < int(ceil(samples)); i++)
    {
        float part = clamp(samples - float(i), 0.0, 1.0);
        vec2 place = first + sampleStep * (float(i) + part * phase);
        sum += part * BokehFetchGrid(tex, place, grid);
    }
    return sum;
}

// Layers: averages the samples along edge k, and in the second pass multiplies the mean by the area
//   of the edge's parallelograms
//   1.000001 keeps rounding from darkening an even layer, see BokehResolved.
//   tex           the layer, or a strip
//   QuarterSamp   the layer at quarter size, read if useQuarterLayer of blur is true
//   blur          from BokehLayerBlur
vec4 BokehLayerLine(BOKEH_TEXTURE tex, BOKEH_TEXTURE QuarterSamp, int k, BokehPolygon polygon,
    bool secondPass, BokehBlur blur, BokehLayerContext layers)
{
    float scale = float(BOKEH_LAYER_SCALE);
    if (blur.useQuarterLayer)
    {
        scale = 4.0;
    }
    BokehGrid grid = BokehReducedGrid(layers, scale);
    vec4 segment = BokehEdgeLine(k, polygon, secondPass) * blur.CoC;
    float samples = max(2.0 * length(segment.zw) / blur.spacing, 2.0);
    float phase = 0.5 + layers.jitter * min(blur.spacing - 1.0, 1.0);
    BokehGrid layerGrid = BokehLayerGrid(layers);
    vec2 first = (layers.uv * layerGrid.size + segment.xy - segment.zw) *
        (float(BOKEH_LAYER_SCALE) / scale);
    vec2 sampleStep = segment.zw * (2.0 * float(BOKEH_LAYER_SCALE) / (scale * samples));
    vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
    if (blur.useQuarterLayer)
    {
        sum = BokehLayerSamples(QuarterSamp, first, sampleStep, samples, phase, grid);
    }
    else
    {
        sum = BokehLayerSamples(tex, first, sampleStep, samples, phase, grid);
    }
    sum *= 1.000001 / samples;
    if (secondPass)
    {
        sum *= BokehEdgeArea(k, polygon);
    }
    return sum;
}

// Layers: computes strip k of the first pass: the lines along the edges before it, weighted by the
//   areas of their parallelograms
vec4 BokehLayerTarget(int k, BokehPolygon polygon, vec4 L1, vec4 L2, vec4 L3, vec4 L4)
{
    vec4 w = BokehEdgeWeights(k, polygon);
    return (L1 * w.x + L2 * w.y + L3 * w.z + L4 * w.w) / (w.x + w.y + w.z + w.w);
}

// Layers: blurs a layer, first pass
//   Reads a layer and layerCoC, and writes its strips, as the first pass of `exact` does but
//   without weights. A wide blur reads the smooth copy at quarter size, so that polygons stay flat.
//   LayerSamp     nearLayer or farLayer of BokehPrefilter
//   QuarterSamp   nearQuarter or farQuarter of BokehDownsample
//   layerCoC      from BokehLayerCoC
//   isFar         false: the near layer
//   last          as in BokehExactFirst
BokehTargets BokehLayerFirst(BOKEH_TEXTURE LayerSamp, BOKEH_TEXTURE QuarterSamp, vec2 layerCoC,
    bool isFar, int last, BokehPolygon polygon, BokehLayerContext layers)
{
    BokehGrid grid = BokehLayerGrid(layers);
    vec2 center = layers.uv * grid.size;
    vec4 zero = vec4(0.0, 0.0, 0.0, 0.0);
    BokehTargets targets;
    BokehBlur blur = BokehLayerBlur(layerCoC, isFar, polygon);
    if (blur.CoC > 0.51)
    {
        vec4 L2 = zero;
        vec4 L3 = zero;
        vec4 L4 = zero;
        vec4 L1 = BokehLayerLine(LayerSamp, QuarterSamp, 1, polygon, false, blur, layers);
        if (last > 2)
        {
            L2 = BokehLayerLine(LayerSamp, QuarterSamp, 2, polygon, false, blur, layers);
        }
        if (last > 3)
        {
            L3 = BokehLayerLine(LayerSamp, QuarterSamp, 3, polygon, false, blur, layers);
        }
        if (last > 4)
        {
            L4 = BokehLayerLine(LayerSamp, QuarterSamp, 4, polygon, false, blur, layers);
        }
        targets.strip2 = L1;
        targets.strip3 = BokehLayerTarget(3, polygon, L1, L2, zero, zero);
        targets.strip4 = BokehLayerTarget(4, polygon, L1, L2, L3, zero);
        targets.strip5 = BokehLayerTarget(5, polygon, L1, L2, L3, L4);
    }
    else
    {
        targets.strip2 = BokehFetchGrid(LayerSamp, center, grid);
        targets.strip3 = targets.strip2;
        targets.strip4 = targets.strip2;
        targets.strip5 = targets.strip2;
    }
    return targets;
}

// Layers: blurs a layer, second pass
//   Reads the strips and layerCoC, blurs each strip along the edge of its number, adds them up, and
//   writes the finished layer. It is a pass of its own because each texel reads a line of strips,
//   which must be complete.
//   Strip2Samp, Strip3Samp, Strip4Samp, Strip5Samp  from the first pass; pass any texture for a
//                 strip that the polygon does not have, since it is not read
//   returns       rgb times coverage, coverage
vec4 BokehLayerSecond(BOKEH_TEXTURE Strip2Samp, BOKEH_TEXTURE Strip3Samp, BOKEH_TEXTURE Strip4Samp,
    BOKEH_TEXTURE Strip5Samp, vec2 layerCoC, bool isFar, BokehPolygon polygon,
        BokehLayerContext layers)
{
    BokehGrid grid = BokehLayerGrid(layers);
    vec2 center = layers.uv * grid.size;
    vec4 result = vec4(0.0, 0.0, 0.0, 0.0);
    BokehBlur blur = BokehLayerBlur(layerCoC, isFar, polygon);
    blur.useQuarterLayer = false;
    if (blur.CoC > 0.51)
    {
        result = BokehLayerLine(Strip2Samp, Strip2Samp, 2, polygon, true, blur, layers);
        if (polygon.sides > 4)
        {
            result += BokehLayerLine(Strip3Samp, Strip3Samp, 3, polygon, true, blur, layers);
        }
        if (polygon.sides > 6)
        {
            result += BokehLayerLine(Strip4Samp, Strip4Samp, 4, polygon, true, blur, layers);
        }
        if (polygon.sides > 8)
        {
            result += BokehLayerLine(Strip5Samp, Strip5Samp, 5, polygon, true, blur, layers);
        }
        result = result / polygon.area;
    }
    else
    {
        result = BokehFetchGrid(Strip2Samp, center, grid);
    }
    return result;
}

// Layers: holds what BokehLayersFirst writes; only a hexagon uses the two strips 3
struct BokehLayersTargets
{
    vec4 nearStrip2;
    vec4 farStrip2;
    vec4 nearStrip3;
    vec4 farStrip3;
};

// Layers: blurs both layers of a square or a hexagon, first pass
//   Reads both layers, their quarter layers and layerCoC, and writes the strips of both. A square
//   or a hexagon has so few strips that those of both layers fit into four targets, so one pass
//   does the work of two.
BokehLayersTargets BokehLayersFirst(BOKEH_TEXTURE NearSamp, BOKEH_TEXTURE NearQuarterSamp,
    BOKEH_TEXTURE FarSamp, BOKEH_TEXTURE FarQuarterSamp, vec2 layerCoC, BokehPolygon polygon,
    BokehLayerContext layers)
{
    int last = polygon.sides / 2;
    BokehTargets nearTargets = BokehLayerFirst(NearSamp, NearQuarterSamp, layerCoC, false,
        last, polygon, layers);
    BokehTargets farTargets = BokehLayerFirst(FarSamp, FarQuarterSamp, layerCoC, true,
        last, polygon, layers);
    BokehLayersTargets targets;
    targets.nearStrip2 = nearTargets.strip2;
    targets.farStrip2 = farTargets.strip2;
    targets.nearStrip3 = nearTargets.strip3;
    targets.farStrip3 = farTargets.strip3;
    return targets;
}

// Layers: holds the finished layers
struct BokehBlurred
{
    vec4 nearLayer;
    vec4 farLayer;
};

// Layers: blurs both layers of a square or a hexagon, second pass
//   Reads the strips of both layers and layerCoC, and writes both finished layers. As in
//   BokehLayersFirst, one pass does the work of two. For a square, pass any textures as strips 3:
//   they are not read.
BokehBlurred BokehLayersSecond(BOKEH_TEXTURE NearStrip2Samp, BOKEH_TEXTURE FarStrip2Samp,
    BOKEH_TEXTURE NearStrip3Samp, BOKEH_TEXTURE FarStrip3Samp, vec2 layerCoC, BokehPolygon polygon,
    BokehLayerContext layers)
{
    BokehBlurred targets;
    targets.nearLayer = BokehLayerSecond(NearStrip2Samp, NearStrip3Samp,
        NearStrip3Samp, NearStrip3Samp, layerCoC, false, polygon, layers);
    targets.farLayer = BokehLayerSecond(FarStrip2Samp, FarStrip3Samp,
        FarStrip3Samp, FarStrip3Samp, layerCoC, true, polygon, layers);
    return targets;
}

// -------------------------------------------------------------------------------------------------
// [14] the finished image

// Layers: enlarges a half-size layer, at one position
//   Catmull-Rom without its corners, in five fetches; bilinear would make the edges of polygons
//   ragged. It overshoots, so the result is clamped to the five fetches, or lights would have dark
//   rims and too much light.
//
//            t          w0     weights, from the texel before to the second one after;
//          l c r      w1 + w2  c, the middle fetch, covers two by two texels
//            b          w3
//
//   place         texels of the half size
vec4 BokehFetchLayer(BOKEH_TEXTURE LayerSamp, vec2 place, BokehGrid grid)
{
    vec4 result = vec4(0.0, 0.0, 0.0, 0.0);
    if (BOKEH_LAYER_CUBIC > 0)
    {
        vec2 texel = floor(place - 0.5) + 0.5;
        vec2 f = place - texel;
        vec2 w0 = f * (f * (1.0 - 0.5 * f) - 0.5);
        vec2 w2 = f * (f * (2.0 - 1.5 * f) + 0.5);
        vec2 w3 = f * f * (0.5 * f - 0.5);
        vec2 w12 = 1.0 - w0 - w3;
        vec2 inner = texel + w2 / w12;
        vec4 c = BokehFetchGrid(LayerSamp, inner, grid);
        vec4 l = BokehFetchGrid(LayerSamp, vec2(texel.x - 1.0, inner.y), grid);
        vec4 r = BokehFetchGrid(LayerSamp, vec2(texel.x + 2.0, inner.y), grid);
        vec4 t = BokehFetchGrid(LayerSamp, vec2(inner.x, texel.y - 1.0), grid);
        vec4 b = BokehFetchGrid(LayerSamp, vec2(inner.x, texel.y + 2.0), grid);
        vec2 side = w12.yx / (w12.x * w12.y + (w0.x + w3.x) * w12.y + (w0.y + w3.y) * w12.x);
        vec4 sum = c * (w12.x * side.x) + l * (w0.x * side.x) + r * (w3.x * side.x) + t * (w0.y *
            side.y) + b * (w3.y * side.y);
        result = clamp(sum, min(min(c, min(l, r)), min(t, b)), max(max(c, max(l, r)), max(t, b)));
    }
    else
    {
        result = BokehFetchGrid(LayerSamp, place, grid);
    }
    return result;
}

// Layers: returns 1 / radius^2 of the discs over which two CoC spread, pixels
//   With r = CoC / 2 it is (r^2 + BOKEH_TUNED_PIXEL_BLUR) / r^4.
vec2 BokehSpreadInverse(vec2 CoC)
{
    vec2 inverse = 1.0 / max(CoC * CoC, vec2(0.000001, 0.000001));
    return inverse * (inverse * (16.0 * BOKEH_TUNED_PIXEL_BLUR) + 4.0);
}

// Layers: describes how the gather of a pixel is divided into rings
//   radius        of the gather, pixels
//   spacing       between rings, pixels
//   narrowing     0: rings evenly spaced; 1: denser towards the centre, but never less than a pixel
//                 apart
struct BokehRingLayout
{
    float radius;
    float spacing;
    float narrowing;
};

// Layers: returns the outer border of a ring of the gather, pixels; ring 0 is the inner disc
float BokehRingBorder(int ring, BokehRingLayout rings)
{
    float even = rings.spacing * (float(ring) + 0.5);
    return max(even + even * (even / rings.radius - 1.0) * rings.narrowing, min(even, float(ring) +
        0.5));
}

// Layers: holds the gather around a pixel, as far as it has come
//   sum           colour times weight and weight of everything found
//   front         the part of sum that was found in front of this pixel
//   farFound      weight of what was found in the far layer
//   center        middle of this pixel, texels
//   s, inverse, nearWeight  of this pixel: signed CoC in pixels, BokehSpreadInverse, near layer
//                 weight
//   slopes        of the near and the far layer
//   snapping      0: linear filter; the larger, the closer to the nearest texel
//   bounds        lower and upper limit of a sample's 1 / radius^2: the values for the gather's
//                 radius and for the inner disc
//   inner         where the next ring begins, pixels
struct BokehGather
{
    BOKEH_HALF4 sum;
    BOKEH_HALF4 front;
    float farFound;
    vec2 center;
    float s;
    float inverse;
    float nearWeight;
    vec2 slopes;
    float snapping;
    vec2 bounds;
    float inner;
};

// Layers: converts a texel for the gather
//   In half precision it limits colours, so that their sum stays a finite half float: the weights
//   of a ring add up to 1 at most, and a gather has at most six rings and the centre.
BOKEH_HALF4 BokehHalfTexel(vec4 texel)
{
    BOKEH_HALF4 converted = BOKEH_TO_HALF4(texel);
    if (BOKEH_HALF_PRECISION > 0)
    {
        converted = min(converted, BOKEH_TO_HALF4(8000.0, 8000.0, 8000.0, 8000.0));
    }
    return converted;
}

// Layers: says which samples of a ring are gathered
//   index         of the ring; ring 1 lies around the inner disc
//   onEdge        samples that the ring has on each edge of the polygon
//   first, end    the samples of each edge that are gathered: from first to end - 1
//   outer         where the ring ends, pixels
struct BokehRing
{
    int index;
    int onEdge;
    int first;
    int end;
    float outer;
};

// Layers: returns a ring of the gather with all its samples
//   density       number of the ring whose number of samples it takes
BokehRing BokehMakeRing(int index, int density, BokehRingLayout rings, BokehPolygon polygon)
{
    BokehRing ring;
    ring.index = index;
    ring.onEdge = BokehSamplesPerEdge(density, polygon);
    ring.first = 0;
    ring.end = ring.onEdge;
    ring.outer = min(BokehRingBorder(index, rings), rings.radius);
    return ring;
}

// Layers: gathers samples of a ring, which begins at `inner` of the gather
//   If first and end of the ring and the polygon's sides are literals, compilers unroll both loops.
BokehGather BokehGatherRing(BokehGather before, BOKEH_TEXTURE MapSamp, BokehRing ring,
    BokehPolygon polygon, BokehLayerContext layers)
{
    //   |-----|--.--|--.--|     weight of a sample: the part of its ring that its own disc covers,
    //   disc    1     2         divided by the area of that disc
    BokehGather gather = before;
    BokehGrid full = BokehFullGrid(layers);
    vec2 zero = vec2(0.0, 0.0);
    vec2 one = vec2(1.0, 1.0);
    float outwards = BOKEH_TUNED_RING_POSITION - BOKEH_TUNED_RING_STEP * float(BOKEH_LAYER_RINGS);
    float current = gather.inner + (ring.outer - gather.inner) * outwards;
    float innerSquare = gather.inner * gather.inner;
    float area = ring.outer * ring.outer - innerSquare;
    // the part of the ring that this pixel's disc covers, for samples behind its surface
    float ownCovers = max(min(1.0 - innerSquare * gather.inverse, area * gather.inverse), 0.0);
    float phase = layers.jitter * clamp(current / float(ring.index) - 1.0, 0.0, 1.0);
    if (ring.index != 2)
    {
        // all rings but the second are rotated by half a step, so that those beside it fill its
        // gaps
        phase += 0.5;
    }
    // axes of the upright polygon, in pixels: compilers can fold the arithmetic on its corners
    vec2 right = vec2(polygon.axis.x * polygon.squeeze, polygon.axis.y) * current;
    vec2 upwards = vec2(-polygon.axis.y * polygon.squeeze, polygon.axis.x) * current;
    vec2 corner = polygon.corner * 2.0;
    vec2 turn = BokehTurn(1.0, polygon);
    vec2 direction = vec2(-turn.y, turn.x) * 2.0;
    // half of the edges: samples of the other half are opposite to these
    for (int edge = 1; edge <= polygon.sides / 2; edge++)
    {
        vec2 alongEdge = direction * BokehEdgeLength(edge, polygon);
        vec2 along = alongEdge / float(ring.onEdge);
        // each edge represents the triangle from the centre to it
        float sampleArea = (corner.x * along.y - corner.y * along.x) / (8.0 * polygon.area);
        for (int i = ring.first; i < ring.end; i++)
        {
            vec2 upright = corner + along * (float(i) + phase);
            vec2 place = right * upright.x + upwards * upright.y;
            vec2 texel = floor(place);
            // steeper between two texels than the linear filter is
            vec2 offset = texel + clamp((place - texel) * (gather.snapping + 1.0) - 0.5 *
                gather.snapping, zero, one);
            // this sample and the one opposite to it, both at once
            BOKEH_HALF4 pixel = BokehHalfTexel(BokehFetchAround(MapSamp, gather.center, offset,
                full));
            BOKEH_HALF4 other = BokehHalfTexel(BokehFetchAround(MapSamp, gather.center, -offset,
                full));
            vec2 CoC = vec2(float(pixel.a), float(other.a)) * full.size.y;
            vec2 isBehind = clamp(CoC * 2.0 - 2.0 * gather.s, zero, one) * (1.0 -
                gather.nearWeight);
            vec2 inverse = clamp(BokehSpreadInverse(CoC), gather.bounds.xx,
                gather.bounds.yy);
            vec2 covers = max(min(1.0 - innerSquare * inverse, area * inverse), zero);
            covers = sampleArea * (covers + (ownCovers - covers) * isBehind);
            vec2 inFar = covers * clamp(CoC * gather.slopes.y - 2.0, zero, one);
            covers = covers * (1.0 - clamp(CoC * -gather.slopes.x - 2.0, zero, one)) - inFar;
            gather.farFound += inFar.x + inFar.y;
            BOKEH_HALF2 weights = BOKEH_TO_HALF2(covers);
            gather.sum += BOKEH_TO_HALF4(pixel.rgb, 1.0) * weights.x;
            gather.sum += BOKEH_TO_HALF4(other.rgb, 1.0) * weights.y;
            BOKEH_HALF2 inFront = BOKEH_TO_HALF2(covers * clamp(gather.s - 0.5 - CoC, zero, one));
            gather.front += BOKEH_TO_HALF4(pixel.rgb, 1.0) * inFront.x;
            gather.front += BOKEH_TO_HALF4(other.rgb, 1.0) * inFront.y;
        }
        corner += alongEdge;
        direction = BokehRotated(direction, turn);
    }
    return gather;
}

// Layers: gathers a ring before the last one, if the preset has it and it begins inside the gather
//   index         of the ring: 1 .. BOKEH_LAYER_RINGS
BokehGather BokehGatherInnerRing(BokehGather before, BOKEH_TEXTURE MapSamp, int index,
    BokehRingLayout rings, BokehPolygon polygon, BokehLayerContext layers)
{
    BokehGather gather = before;
    BokehRing ring = BokehMakeRing(index, index, rings, polygon);
    if (index <= BOKEH_LAYER_RINGS && gather.inner < ring.outer)
    {
        gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers);
        gather.inner = ring.outer;
    }
    return gather;
}

// Layers: gathers the last ring, number BOKEH_LAYER_RINGS + 1, if it begins inside the gather
//   isDense       true: it has as many samples as the ring before it; false: as few as ring 1
BokehGather BokehGatherLastRing(BokehGather before, BOKEH_TEXTURE MapSamp, bool isDense,
    BokehRingLayout rings, BokehPolygon polygon, BokehLayerContext layers)
{
    BokehGather gather = before;
    BokehRing ring = BokehMakeRing(BOKEH_LAYER_RINGS + 1, 1, rings, polygon);
    int few = ring.onEdge;
    int many = few;
    if (BOKEH_LAYER_RINGS > 1)
    {
        many = BokehSamplesPerEdge(BOKEH_LAYER_RINGS, polygon);
    }
    if (gather.inner < ring.outer)
    {
        // A dense ring takes its samples in two calls. A sparse one shares the first of them, so
        // that the program does not contain the code of both rings.
        if (isDense)
        {
            ring.onEdge = many;
        }
        gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers);
        if (isDense && many > few)
        {
            ring.first = few;
            ring.end = many;
            gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers);
        }
    }
    return gather;
}

// Layers: finds what the blurred background changes in a pixel of an outline in focus
//   The input has mixed this pixel from an object and the sharp background behind it. Through a
//   lens, the blurred background is there. Without the change, the outline of an object in front of
//   a blurred light is a dark line.
//
//      pixel = object * covered + background * (1 - covered)
//      shown = object * covered + farColor   * (1 - covered)
//
//   center        middle of this pixel, texels
//   pixel         its colour and signed CoC
//   farColor      colour of the blurred far layer
//   farSlope      from BokehFarSlope
//   returns       the difference between the two; 0 if this is no outline
vec3 BokehOutline(BOKEH_TEXTURE MapSamp, vec2 center, vec4 pixel, vec3 farColor,
    float farSlope, BokehLayerContext layers)
{
    BokehGrid full = BokehFullGrid(layers);
    vec4 object = vec4(0.0, 0.0, 0.0, 0.0);
    vec4 background = vec4(0.0, 0.0, 0.0, 0.0);
    vec2 side = vec2(1.0, 0.0);
    for (int i = 0; i < 2; i++)
    {
        // the object is opposite to the background: pixels along the outline are mixed too
        vec4 first = BokehFetchAround(MapSamp, center, side, full);
        vec4 opposite = BokehFetchAround(MapSamp, center, -side, full);
        vec2 CoC = vec2(first.a, opposite.a) * full.size.y;
        vec2 change = abs(CoC - pixel.a * full.size.y);
        vec2 isFar = vec2(BokehLayerWeight(CoC.x, farSlope), BokehLayerWeight(CoC.y, farSlope));
        vec2 isObject = clamp(2.0 - change, vec2(0.0, 0.0), vec2(1.0, 1.0)) * isFar.yx;
        background += vec4(first.rgb, 1.0) * isFar.x;
        background += vec4(opposite.rgb, 1.0) * isFar.y;
        object += vec4(first.rgb, 1.0) * isObject.x;
        object += vec4(opposite.rgb, 1.0) * isObject.y;
        side = vec2(0.0, 1.0);
    }
    vec3 behind = background.rgb / max(background.a, 0.000001);
    vec3 contrast = object.rgb / max(object.a, 0.000001) - behind;
    vec3 ownContrast = pixel.rgb - behind;
    // too little contrast says nothing of a mixture
    float square = max(dot(contrast, contrast), 0.001 * dot(pixel.rgb, pixel.rgb) +
        0.000000000001);
    float covered = clamp(dot(ownContrast, contrast) / square, 0.0, 1.0);
    // A pixel of another colour is no mixture of the two, and one that looks like the background
    // alone is a part of the object.
    vec3 other = ownContrast - contrast * covered;
    float isMixed = clamp(2.0 - 8.0 * dot(other, other) / square, 0.0, 1.0) * min(16.0 * covered,
        1.0);
    // Such a pixel is taken to be open by a quarter, which is the mean for an upright or a level
    // edge that leaves the middle of the pixel covered.
    float open = 0.25 + (0.75 - covered) * isMixed;
    return (farColor - behind) * (open * min(background.a, 1.0) * min(object.a, 1.0));
}

// Layers: gathers the pixels in neither layer, and composites everything; the last pass
//   Reads the CoC map, gatherTiles, both blurred layers and both fills. A gathered sample spreads
//   over its own disc, or over this pixel's disc if it lies behind this pixel's surface. Pixels of
//   a layer are left out of the gather. From back to front:
//
//      farFill, far layer, midFill   (midFill behind near pixels, farFill also at far pixels that
//                                    a blurred near object covers)
//      gathered pixels
//      near layer
//   returns       rgb = the finished image, a = signed CoC of this pixel
vec4 BokehComposite(BOKEH_TEXTURE MapSamp, BOKEH_TEXTURE GatherTilesSamp, BOKEH_TEXTURE NearSamp,
    BOKEH_TEXTURE FarSamp, BOKEH_TEXTURE MidFillSamp, BOKEH_TEXTURE FarFillSamp,
        BokehPolygon polygon, BokehLayerContext layers)
{
    BokehGrid full = BokehFullGrid(layers);
    // without the rounding of uv, see BokehFetchAround
    vec2 center = floor(layers.uv * full.size) + 0.5;
    vec4 centerPixel = BokehFetchTexel(MapSamp, BokehToTexture(layers.uv));
    vec4 tile = BokehFetchGrid(GatherTilesSamp, center / 8.0, BokehReducedGrid(layers, 8.0));
    vec3 result = centerPixel.rgb;
    BokehGrid grid = BokehLayerGrid(layers);
    vec4 nearLayer = vec4(0.0, 0.0, 0.0, 0.0);
    // only where BOKEH_SIDES is defined: shader model 3 has too few registers to keep the layer
    // during the gather
    if (BOKEH_SIDES > 0 && tile.r > BOKEH_TUNED_NEAR_START)
    {
        nearLayer = BokehFetchLayer(NearSamp, center / float(BOKEH_LAYER_SCALE), grid);
    }
    // copy the input if nothing within reach is blurred by more than a pixel; a near layer may hide
    // everything else
    if (max(tile.r, tile.g) > 1.0 && nearLayer.a * BOKEH_TUNED_NEAR_ALPHA < 1.0)
    {
        BokehGather gather;
        float s = centerPixel.a * full.size.y;
        gather.center = center;
        gather.s = s;
        gather.slopes = vec2(BokehNearSlope(tile.r), BokehFarSlope(tile.g));
        float nearWeight = BokehLayerWeight(-s, gather.slopes.x);
        float farWeight = BokehLayerWeight(s, gather.slopes.y);
        gather.nearWeight = nearWeight;
        gather.inverse = BokehSpreadInverse(vec2(s, s)).x;
        // the gather reaches as far as the CoC of pixels in neither layer
        float restRadius = clamp(16.0 - 16.0 * farWeight, 0.0, 1.0) * (1.0 - nearWeight) /
            sqrt(gather.inverse);
        float radius = max(max(restRadius, 0.01), 0.5 * max(tile.b, tile.a * farWeight));
        if (BOKEH_LAYER_RINGS == 0)
        {
            radius = min(radius, BOKEH_TUNED_SINGLE_RADIUS);
        }
        BokehRingLayout ringLayout;
        ringLayout.radius = radius;
        ringLayout.narrowing = clamp(radius / max(restRadius, 1.0) - 1.0, 0.0, 1.0);
        // one number for both layers: the near one starts at a smaller CoC than the far one
        float layerReach = max(tile.g, tile.r + (BOKEH_TUNED_FAR_START -
            BOKEH_TUNED_NEAR_START));
        float denseRings = float(BOKEH_LAYER_RINGS);
        // Where the far layer is not in reach, one more ring takes its fetches; a pixel of the near
        // layer does not need that ring. Without CUBIC a layer takes a single fetch, so the ring is
        // added only where both layers are small.
        bool hasFreeFetches = layerReach <= 14.0;
        if (BOKEH_LAYER_CUBIC > 0)
        {
            hasFreeFetches = tile.g <= BOKEH_TUNED_FAR_START && nearWeight <= 0.0;
        }
        if (hasFreeFetches)
        {
            denseRings += 1.0;
        }
        // Outlines of objects in focus are changed where the far layer is, and where the gather has
        // no additional ring, so that the two together take no more fetches than that ring.
        float outline = clamp(2.0 - abs(s), 0.0, 1.0) * clamp(layerReach - 14.0 + 4.0 *
            float(BOKEH_LAYER_CUBIC), 0.0, 1.0) * clamp(max(2.0 * BOKEH_TUNED_RING_WIDTH *
            denseRings, 1.0) - 2.0 * radius, 0.0, 1.0);
        float rings = denseRings;
        if (max(nearWeight, farWeight * tile.r * float(BOKEH_LAYER_RINGS - 1)) <= 0.0)
        {
            // A gather that reaches far has one more ring, of few samples: with wider gaps between
            // the rings, a thin bright line would show as a row of copies. In a layer the gather
            // shows less; there, only a preset with a single ring has one more.
            rings = max(rings, min(radius / BOKEH_TUNED_RING_WIDTH,
                float(BOKEH_LAYER_RINGS) + 1.0));
        }
        // rings closer than a pixel find nothing new; .499: the last ends at the radius
        ringLayout.spacing = max(min(radius / 1.499, 1.0), radius / (rings + 0.499));
        gather.inner = BokehRingBorder(0, ringLayout);
        // Samples within half a pixel are this pixel again: no ring.
        if (radius < 0.5)
        {
            gather.inner = radius;
        }
        // a disc smaller than the inner one reaches no other pixel
        gather.bounds = 1.0 / vec2(radius * radius, gather.inner * gather.inner);
        float weight = (1.0 - nearWeight) * min(gather.inverse / gather.bounds.y, 1.0);
        // pixels of the far layer are replaced by that layer: a single one of them would be a
        // bright dot
        gather.farFound = weight * farWeight;
        gather.sum = BOKEH_TO_HALF4(vec4(BokehHalfTexel(vec4(centerPixel.rgb, 1.0))) *
            (weight - gather.farFound));
        gather.front = BOKEH_TO_HALF4(0.0, 0.0, 0.0, 0.0);
        // the wider a layer's blur here, the closer samples move to the nearest texel: between a
        // near light and the surface behind it, the linear filter would find a light in focus
        gather.snapping = max(tile.r, tile.g - 16.0);
        if (BOKEH_SIDES > 0)
        {
            // each ring has a call of its own: its number of samples is then known, and compilers
            // unroll its loops
            gather = BokehGatherInnerRing(gather, MapSamp, 1, ringLayout, polygon, layers);
            gather = BokehGatherInnerRing(gather, MapSamp, 2, ringLayout, polygon, layers);
            gather = BokehGatherInnerRing(gather, MapSamp, 3, ringLayout, polygon, layers);
            gather = BokehGatherInnerRing(gather, MapSamp, 4, ringLayout, polygon, layers);
            gather = BokehGatherLastRing(gather, MapSamp, hasFreeFetches, ringLayout, polygon,
                layers);
        }
        else
        {
            for (int index = 1; index <= BOKEH_LAYER_RINGS + 1; index++)
            {
                if (gather.inner >= radius)
                {
                    break;
                }
                int density = max(min(index, BOKEH_LAYER_RINGS), 1);
                if (float(index) > denseRings)
                {
                    density = 1;
                }
                BokehRing ring = BokehMakeRing(index, density, ringLayout, polygon);
                gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers);
                gather.inner = ring.outer;
            }
        }

        vec4 farLayer = vec4(0.0, 0.0, 0.0, 0.0);
        // both layers at once where the near one has not been read yet: they share the arithmetic
        float farReach = tile.g;
        if (BOKEH_SIDES == 0)
        {
            farReach = layerReach;
        }
        if (farReach > BOKEH_TUNED_FAR_START)
        {
            if (BOKEH_SIDES == 0)
            {
                nearLayer = BokehFetchLayer(NearSamp, center / float(BOKEH_LAYER_SCALE), grid);
            }
            farLayer = BokehFetchLayer(FarSamp, center / float(BOKEH_LAYER_SCALE), grid);
        }
        BokehGrid quarters = BokehReducedGrid(layers, 4.0);
        // 1 at near pixels; at far pixels it grows with the coverage of the blurred near layer
        float behindNear = clamp(2.0 * farWeight * nearLayer.a - 0.25 + 1000.0 * nearWeight,
            0.0, 1.0);
        vec3 farColor = farLayer.rgb / max(farLayer.a, 0.000001);
        if (behindNear > 0.0)
        {
            // Near pixels hide most of what a far polygon covers, so few far pixels represent all
            // of it. Where the far layer covers less than half, the fill supplies the rest.
            vec4 farFill = BokehFetchGrid(FarFillSamp, 0.25 * center, quarters);
            float missing = clamp(1.0 - 2.0 * farLayer.a, 0.0, 1.0) * behindNear;
            farColor += (farFill.rgb - farColor) * missing;
            farLayer = vec4(farColor * farLayer.a, farLayer.a);
        }
        // at pixels of a layer, the layer itself is added below
        vec4 sum = vec4(gather.sum) + farLayer * (gather.farFound * (1.0 - max(farWeight,
            nearWeight)) / max(farLayer.a, 0.001));
        vec4 plain = sum + farLayer * farWeight;
        vec4 front = vec4(gather.front);
        if (plain.a >= 0.001)
        {
            // the weight of samples in front is their coverage; the rest shows through the gaps
            vec4 rest = plain - front;
            vec4 shown = front * max(rest.a, 0.1) + rest * clamp(1.0 - front.a, 0.0, 1.0);
            // 1.000001: see BokehResolved
            result = shown.rgb * (1.000001 / shown.a);
        }
        outline *= clamp(4.0 * farLayer.a, 0.0, 1.0);
        if (BOKEH_LAYER_OUTLINES > 0 && outline > 0.0)
        {
            vec3 change = BokehOutline(MapSamp, center, centerPixel, farColor,
                gather.slopes.y, layers);
            result = max(result + change * outline, vec3(0.0, 0.0, 0.0));
        }
        if (nearWeight > 0.0)
        {
            // in depth order: the gather, the fill of its holes, the far layer, the fill of that
            vec4 midFill = BokehFetchGrid(MidFillSamp, 0.25 * center, quarters);
            float inNear = nearLayer.a * min(2.0 - 2.0 * nearWeight, 1.0);
            float empty = clamp(1.0 - sum.a - inNear, 0.0, 1.0);
            float cover = empty * clamp((midFill.a - 0.3) / 0.4, 0.0, 1.0);
            vec3 stack = (sum.rgb + midFill.rgb * cover + farColor * (empty - cover)) /
                max(sum.a + empty, 0.000001);
            result += (stack - result) * nearWeight;
        }
    }
    float alpha = clamp(nearLayer.a * BOKEH_TUNED_NEAR_ALPHA, 0.0, 1.0);
    // alpha / nearLayer.a, without a division by 0
    float opacity = min(BOKEH_TUNED_NEAR_ALPHA, 1.0 / max(nearLayer.a, 0.000001));
    result = result * (1.0 - alpha) + nearLayer.rgb * opacity;
    return vec4(result, centerPixel.a);
}
