// SPDX-License-Identifier: MIT
//
// Layered depth of field with polygonal bokeh, WGSL. Version 0.3.0. Put it after bokeh.wgsl.
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
//   Presets: define one before bokeh.wgsl, or set the constants instead. In WGSL set
//   all four constants of this table.
//
//   preset                  rings      samples cubic  scale
//   BOKEH_PRESET_MOBILE     0          18      0      4
//   BOKEH_PRESET_LOW        1          11      0      2
//   BOKEH_PRESET_MEDIUM     2          11      1      2      the default
//   BOKEH_PRESET_HIGH       3          18      1      2
//   BOKEH_PRESET_ULTRA      4          18      1      2

override BOKEH_LAYER_RINGS: i32 = 2;
override BOKEH_LAYER_SAMPLES: i32 = 11;
override BOKEH_LAYER_CUBIC: i32 = 1;
override BOKEH_LAYER_SCALE: i32 = 2;
override BOKEH_LAYER_OUTLINES: i32 = 1;
const BOKEH_MIN_BRIGHTNESS: f32 = 0.00001;

// Tuned constants: each comment says what goes wrong with another value.
// docs/methods/layered-evidence.md has the measurements.

// The near layer appears while the largest near CoC in reach grows from START to FULL, pixels. With
// lower or higher limits, the edges of small blurs get worse.
const BOKEH_TUNED_NEAR_START: f32 = 6.0;
const BOKEH_TUNED_NEAR_FULL: f32 = 12.0;

// The far layer likewise. With lower limits, the half resolution shows; with higher ones, the
// gather has to reach farther.
const BOKEH_TUNED_FAR_START: f32 = 10.0;
const BOKEH_TUNED_FAR_FULL: f32 = 16.0;

// The near layer's ramp (BokehLayerWeight) grows with the largest near CoC in reach, but only up to
// this one, pixels. With a higher limit, the gather gets pixels of a large CoC, and its few samples
// show as dashes; with a lower one, the edges of large blurs get worse.
const BOKEH_TUNED_NEAR_LIMIT: f32 = 60.0;

// Standard deviation of the Gaussian that averages the CoC of a layer, tiles for each pixel of CoC:
// 0.3 CoC. If it is wider, a light takes its CoC from too far away; if it is narrower, the CoC
// changes within one light.
const BOKEH_TUNED_COC_SIGMA: f32 = 0.0375;

// The averages of 2 x 2 and the linear filter already blur a layer, so this is subtracted from its
// squared CoC, in texels of the half size. If it is lower, the near layer is too soft; if it is
// higher, too sharp.
const BOKEH_TUNED_NEAR_SELF_BLUR: f32 = 9.0;

// For the far layer, it is a fraction of the squared CoC, from MIN to MAX. A higher MIN makes small
// lights too small, and a lower MAX makes the edges of wide lights soft.
const BOKEH_TUNED_FAR_SELF_BLUR: f32 = 0.06;
const BOKEH_TUNED_FAR_SELF_BLUR_MIN: f32 = 7.5;
const BOKEH_TUNED_FAR_SELF_BLUR_MAX: f32 = 22.0;

// A layer is read at quarter size where its samples are farther apart than this, texels of the half
// size. With a lower value, edges get soft; with a higher one, dots show.
const BOKEH_TUNED_QUARTER: f32 = 1.25;

// The outer texels of the filter that makes the quarter size have the weight spacing / 4 - SIDE.
// With a lower value, edges get soft; with a higher one, dots show.
const BOKEH_TUNED_HEXAGON_SIDE: f32 = 0.4;
const BOKEH_TUNED_SQUARE_SIDE: f32 = 0.2;

// The gather has one more ring where its rings would be wider than this, pixels. With a higher
// value, a thin bright line shows as a row of copies; a lower one costs fetches.
const BOKEH_TUNED_RING_WIDTH: f32 = 2.75;

// Around a light that is this many times as bright as the mean around it, the gather reaches only
// as far as the light's blur does. With a higher value, a light beside something more blurred shows
// as a ring of copies; with a lower one, that blur is cut off in more places.
const BOKEH_TUNED_REACH_LIGHT: f32 = 16.0;

// A gather of a single ring reaches at most this far, pixels. With a higher value, an edge shows as
// a row of copies; with a lower one, blurs of pixels in neither layer get too small.
const BOKEH_TUNED_SINGLE_RADIUS: f32 = 6.0;

// Samples of the gather lie at POSITION - rings * STEP of the width of their ring: half-way with
// two rings. With more rings they lie farther in, or the rotated first ring would get too much
// weight.
const BOKEH_TUNED_RING_POSITION: f32 = 0.58;
const BOKEH_TUNED_RING_STEP: f32 = 0.04;

// Pixels and the linear filter blur already, so a CoC spreads as if its squared radius were smaller
// by about this, squared pixels. With a lower value, small blurs get too soft; with a higher one,
// they get too sharp, and dark dots show in them.
const BOKEH_TUNED_PIXEL_BLUR: f32 = 0.3;

// Half floats leave a pixel that the near layer covers at an alpha of 0.999, so alpha is multiplied
// by this. With a lower factor, a light behind the near layer shines through; with a higher one,
// edges get hard.
const BOKEH_TUNED_NEAR_ALPHA: f32 = 1.002;

// Layers: says where the image lies in textures of one size; everything in texels of that size
//   size          width and height of the image
//   origin        its first texel: 0, or that of the viewport
//   texel         1 / width and 1 / height of the textures
struct BokehGrid
{
    size: vec2f,
    origin: vec2f,
    texel: vec2f,
}

// Layers: holds what every pass needs to know of the image and of this pixel
//   uv            of this pixel in the image
//   size, origin, texel  as in BokehGrid, at full size; origin is a multiple of 8, and used only
//                 with BOKEH_VIEWPORT 1
//   largest       largest possible CoC, pixels: maxCoC of the map times the image height
//   jitter        from BokehNoise, times its amount; 0 = none
struct BokehLayerContext
{
    uv: vec2f,
    size: vec2f,
    origin: vec2f,
    texel: vec2f,
    largest: f32,
    jitter: f32,
}

// Layers: makes the context for an image that fills its textures, without jitter
//   imageSize     width and height, pixels
//   maxCoC        fraction of the image height, the same as in the CoC map
fn BokehMakeLayerContext(uv: vec2f, imageSize: vec2f, maxCoC: f32) -> BokehLayerContext
{
    var layers: BokehLayerContext;
    layers.uv = uv;
    layers.size = imageSize;
    layers.origin = vec2f(0.0, 0.0);
    layers.texel = 1.0 / imageSize;
    layers.largest = maxCoC * imageSize.y;
    layers.jitter = 0.0;
    return layers;
}

// Layers: returns the grid of textures of full size
fn BokehFullGrid(layers: BokehLayerContext) -> BokehGrid
{
    var grid: BokehGrid;
    grid.size = layers.size;
    grid.origin = layers.origin;
    grid.texel = layers.texel;
    return grid;
}

// Layers: returns the grid of textures of 1 / scale of the full size, rounded up
fn BokehReducedGrid(layers: BokehLayerContext, scale: f32) -> BokehGrid
{
    var grid: BokehGrid;
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
fn BokehLayerGrid(layers: BokehLayerContext) -> BokehGrid
{
    return BokehReducedGrid(layers, f32(BOKEH_LAYER_SCALE));
}

// Layers: converts a position in the image to texture uv
//   place         texels of the grid from the image's corner; the first centre is at 0.5, 0.5
fn BokehGridCoords(place: vec2f, grid: BokehGrid) -> vec2f
{
    var coords: vec2f = place;
    if (BOKEH_VIEWPORT > 0)
    {
        let inset: vec2f = min(vec2f(0.5078125, 0.5078125), grid.size * 0.5);
        coords = grid.origin + clamp(place, inset, grid.size - inset);
    }
    return coords * grid.texel;
}

// Layers: fetches with the filter, at a position in texels of the grid
fn BokehFetchGrid(tex: texture_2d<f32>, place: vec2f, grid: BokehGrid,
    BokehLinearClamp: sampler) -> vec4f
{
    return BokehFetchTexture(tex, BokehGridCoords(place, grid), BokehLinearClamp);
}

// Layers: fetches one texel, whatever filter the texture has
//   place         its centre, texels of the grid
fn BokehFetchGridTexel(tex: texture_2d<f32>, place: vec2f, grid: BokehGrid) -> vec4f
{
    return BokehFetchTexel(tex, BokehGridCoords(place, grid));
}

// Layers: fetches with the filter at an offset from the middle of a pixel
//   It divides, because grid.texel is rounded: in the middle of a dark texel, that error would show
//   0.00001 of a light beside it.
//   center        of the pixel, texels of the grid
//   offset        texels of the grid
fn BokehFetchAround(tex: texture_2d<f32>, center: vec2f, offset: vec2f, grid: BokehGrid,
    BokehLinearClamp: sampler) -> vec4f
{
    var coords: vec2f = (center + offset) / grid.size;
    if (BOKEH_VIEWPORT > 0)
    {
        coords = BokehGridCoords(center + offset, grid);
    }
    return BokehFetchTexture(tex, coords, BokehLinearClamp);
}

// Layers: returns the largest of the three channels
fn BokehBrightest(color: vec3f) -> f32
{
    return max(max(color.r, color.g), color.b);
}

// Layers: returns how fast the layer weight grows with the CoC, 1 / pixels, for BokehLayerWeight
//   largest       largest CoC that reaches this tile, pixels
//   startCoC, fullCoC  pixels: there is no layer up to startCoC, a complete one from fullCoC
fn BokehLayerSlope(largest: f32, startCoC: f32, fullCoC: f32) -> f32
{
    let gate: f32 = clamp((largest - startCoC) / (fullCoC - startCoC), 0.001, 1.0);
    return 5.0 / max(largest / gate, 2.0);
}

// Layers: returns the slope of the near layer
fn BokehNearSlope(largest: f32) -> f32
{
    return BokehLayerSlope(min(largest, BOKEH_TUNED_NEAR_LIMIT), BOKEH_TUNED_NEAR_START,
        BOKEH_TUNED_NEAR_FULL);
}

// Layers: returns the slope of the far layer
fn BokehFarSlope(largest: f32) -> f32
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
fn BokehLayerWeight(CoC: f32, slope: f32) -> f32
{
    return clamp(CoC * slope - 2.0, 0.0, 1.0);
}

// Layers: finds the largest near and far CoC of a tile of 8 x 8 pixels, and its mean brightness
//   Reads the CoC map, writes tiles. Later passes need the CoC to know how far blur reaches, and
//   the brightness to know what is bright: relative to the mean, so exposure does not change the
//   blur.
//   returns       r = near, g = far, both >= 0, pixels; b = mean log2 of brightness
fn BokehTileMax(MapSamp: texture_2d<f32>, layers: BokehLayerContext) -> vec4f
{
    let first: vec2f = floor(layers.uv * ceil(layers.size / 8.0)) * 8.0 + vec2f(0.5, 0.5);
    var found: vec3f = vec3f(0.0, 0.0, 0.0);
    for (var y: i32 = 0; y < 8; y++)
    {
        for (var x: i32 = 0; x < 8; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            let pixel: vec4f = BokehFetchGridTexel(MapSamp, place, BokehFullGrid(layers));
            let s: f32 = pixel.a * layers.size.y;
            let logBrightness: f32 = log2(max(BokehBrightest(pixel.rgb), BOKEH_MIN_BRIGHTNESS));
            found = vec3f(max(found.r, -s), max(found.g, s), found.b + logBrightness);
        }
    }
    return vec4f(min(found.r, BOKEH_MAX_COLOR), min(found.g, BOKEH_MAX_COLOR), found.b / 64.0, 1.0);
}

// Layers: returns how much of the CoC of another tile applies here, pixels
//   All of it within the reach of its blur plus a margin for the linear filter. It fades out over
//   one more tile, so that nothing jumps when a CoC changes.
//   tiles         distance of the other tile
fn BokehReaching(CoC: vec2f, tiles: f32) -> vec2f
{
    let weight: vec2f = CoC / 16.0 + 1.0 - max(tiles - 2.0, 0.0);
    return CoC * clamp(weight, vec2f(0.0, 0.0), vec2f(1.0, 1.0));
}

// Layers: returns how much of the gatherCoC of another tile applies here, pixels
//   As in BokehReaching, but that of a light only applies to the tiles that its blur covers.
//   tiles         distance of the other tile
fn BokehGatherReaching(CoC: vec4f, tiles: f32) -> vec4f
{
    let isCovered: vec2f = clamp((CoC.ba / 16.0 + 0.5 - tiles) * 1000000.0, vec2f(0.0, 0.0),
        vec2f(1.0, 1.0));
    return vec4f(BokehReaching(CoC.rg, tiles), CoC.ba * isCovered);
}

// Layers: returns how many tiles the largest possible CoC can reach, at most 127
fn BokehReachTiles(layers: BokehLayerContext) -> f32
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
fn BokehTileDilate(TilesSamp: texture_2d<f32>, axis: vec2f, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> vec4f
{
    let grid: BokehGrid = BokehReducedGrid(layers, 8.0);
    let radius: f32 = BokehReachTiles(layers);
    var found: vec2f = vec2f(0.0, 0.0);
    var logBrightness: f32 = 0.0;
    for (var i: i32 = 0; i < 255; i++)
    {
        let tiles: f32 = f32(i) - radius;
        if (tiles > radius)
        {
            break;
        }
        let tile: vec4f = BokehFetchGrid(TilesSamp, layers.uv * grid.size + axis * tiles, grid,
            BokehLinearClamp);
        found = max(found, BokehReaching(tile.rg, abs(tiles)));
        logBrightness += tile.b;
    }
    return vec4f(found, logBrightness / (2.0 * radius + 1.0), 1.0);
}

// Layers: returns the weights of four pixels in the mean CoC of their layer: bright pixels have
//   more
//   A lamp thus gets a polygon of its own size, even among many dark pixels with another CoC.
//   inverseBrightness  1 / mean brightness of the tiles around
//   maxWeight     at most 10000: this times the largest CoC / 8 must fit into a half float.
//                 BokehLayerCoCColumns accepts a weight down to 0.0001 with a CoC down to 6 pixels,
//                 and such a sum is still a normal half float; some GPUs flush subnormal ones to 0.
fn BokehBlurWeights(a: vec4f, b: vec4f, c: vec4f, d: vec4f, inverseBrightness: f32,
    maxWeight: f32) -> vec4f
{
    let brightest: vec4f = vec4f(BokehBrightest(a.rgb), BokehBrightest(b.rgb),
        BokehBrightest(c.rgb), BokehBrightest(d.rgb));
    return min(0.01 + brightest * inverseBrightness, vec4f(maxWeight, maxWeight, maxWeight,
        maxWeight));
}

// Layers: holds what BokehPrefilter writes
//   nearLayer, farLayer  rgb times layer weight, layer weight
//   layerCoCSums  for the mean CoC of both layers: CoC / 8 times weight, weight
//   gatherCoC     rg = largest near and far CoC of the pixels that are not completely in a layer,
//                 ba = those of lights alone; pixels
struct BokehPrefiltered
{
    nearLayer: vec4f,
    farLayer: vec4f,
    layerCoCSums: vec4f,
    gatherCoC: vec4f,
}

// Layers: returns BokehLayerWeight of four pixels
fn BokehLayerWeights(CoC: vec4f, slope: f32) -> vec4f
{
    return clamp(CoC * slope - 2.0, vec4f(0.0, 0.0, 0.0, 0.0), vec4f(1.0, 1.0, 1.0, 1.0));
}

// Layers: finds the darkest near colour around a near edge, and the brightest one behind it
//   found         of the pixels so far
//   pixel         one more
//   nearWeight    its layer weight; the pixel is near from half of maxNearWeight on
//   returns       rgb = darkest near colour, a = brightness of the brightest pixel behind
fn BokehSurroundings(found: vec4f, pixel: vec4f, nearWeight: f32, maxNearWeight: f32) -> vec4f
{
    var result: vec4f = vec4f(min(found.rgb, pixel.rgb), found.a);
    if (nearWeight < 0.5 * maxNearWeight)
    {
        result = vec4f(found.rgb, max(found.a, BokehBrightest(pixel.rgb)));
    }
    return result;
}

// Layers: removes from a near pixel the light from behind that antialiasing has mixed into it
//   around        from BokehSurroundings
//   returns       rgb = colour, a = layer weight
fn BokehNearPixel(pixel: vec4f, nearWeight: f32, around: vec4f) -> vec4f
{
    var result: vec4f = vec4f(pixel.rgb, nearWeight);
    let brightest: f32 = BokehBrightest(pixel.rgb);
    let limit: f32 = BokehBrightest(around.rgb);
    if (around.a > brightest)
    {
        result = vec4f(min(pixel.rgb, around.rgb), nearWeight);
        if (brightest > limit)
        {
            // the part of it that is not light from behind
            result = vec4f(result.rgb, nearWeight * (around.a - brightest) / (around.a - limit));
        }
    }
    return result;
}

// Layers: returns gatherCoC of one pixel
//   weights       near and far layer weight of the pixel
fn BokehGatherCoC(pixel: vec4f, weights: vec2f, inverseBrightness: f32, full: BokehGrid) -> vec4f
{
    let rest: vec2f = min(4.0 - 4.0 * weights, vec2f(1.0, 1.0));
    let CoC: vec2f = max(vec2f(-pixel.a, pixel.a) * full.size.y * rest, vec2f(0.0, 0.0));
    var gatherCoC: vec4f = vec4f(CoC, 0.0, 0.0);
    if (BokehBrightest(pixel.rgb) * inverseBrightness > BOKEH_TUNED_REACH_LIGHT)
    {
        gatherCoC = vec4f(CoC, CoC);
    }
    return gatherCoC;
}

// Layers: does the work of BokehPrefilter for 2 x 2 pixels
//   middle        the corner that the four pixels share, pixels
//   tile          texel of dilatedTiles that covers them
//   returns       their mean, and the maximum for gatherCoC
fn BokehPrefilterBlock(MapSamp: texture_2d<f32>, middle: vec2f, tile: vec4f,
    layers: BokehLayerContext) -> BokehPrefiltered
{
    let full: BokehGrid = BokehFullGrid(layers);
    let nearSlope: f32 = BokehNearSlope(tile.r);
    let farSlope: f32 = BokehFarSlope(tile.g);
    let inverseBrightness: f32 = exp2(-tile.b);
    let maxWeight: f32 = 500000.0 / max(layers.largest, 50.0);
    // the four pixels
    var a: vec4f = BokehFetchGridTexel(MapSamp, middle + vec2f(-0.5, -0.5), full);
    var b: vec4f = BokehFetchGridTexel(MapSamp, middle + vec2f(0.5, -0.5), full);
    var c: vec4f = BokehFetchGridTexel(MapSamp, middle + vec2f(-0.5, 0.5), full);
    var d: vec4f = BokehFetchGridTexel(MapSamp, middle + vec2f(0.5, 0.5), full);
    let s: vec4f = vec4f(a.a, b.a, c.a, d.a) * full.size.y;
    let nearWeights: vec4f = BokehLayerWeights(-s, nearSlope);
    let farWeights: vec4f = BokehLayerWeights(s, farSlope);
    let farSum: vec4f = vec4f(a.rgb, 1.0) * farWeights.x + vec4f(b.rgb, 1.0) * farWeights.y +
        vec4f(c.rgb, 1.0) * farWeights.z + vec4f(d.rgb, 1.0) * farWeights.w;
    var weights: vec4f = farWeights * BokehBlurWeights(a, b, c, d, inverseBrightness, maxWeight);
    let one: vec4f = vec4f(1.0, 1.0, 1.0, 1.0);
    var sums: vec4f = vec4f(0.0, 0.0, dot(weights, s) / 8.0, dot(weights, one));
    let gatherA: vec4f = BokehGatherCoC(a, vec2f(nearWeights.x, farWeights.x), inverseBrightness,
        full);
    let gatherB: vec4f = BokehGatherCoC(b, vec2f(nearWeights.y, farWeights.y), inverseBrightness,
        full);
    let gatherC: vec4f = BokehGatherCoC(c, vec2f(nearWeights.z, farWeights.z), inverseBrightness,
        full);
    let gatherD: vec4f = BokehGatherCoC(d, vec2f(nearWeights.w, farWeights.w), inverseBrightness,
        full);
    let gatherCoC: vec4f = max(max(gatherA, gatherB), max(gatherC, gatherD));
    let maxNearWeight: f32 = max(max(nearWeights.x, nearWeights.y), max(nearWeights.z,
        nearWeights.w));
    var nearSum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    if (maxNearWeight > 0.0)
    {
        // an antialiased pixel of a near edge holds light of the background: if that is
        // brighter, limit all near pixels to the darkest one around
        var around: vec4f = vec4f(BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, 0.0);
        around = BokehSurroundings(around, a, nearWeights.x, maxNearWeight);
        around = BokehSurroundings(around, b, nearWeights.y, maxNearWeight);
        around = BokehSurroundings(around, c, nearWeights.z, maxNearWeight);
        around = BokehSurroundings(around, d, nearWeights.w, maxNearWeight);
        for (var y: i32 = 0; y < 4; y++)
        {
            for (var x: i32 = 0; x < 4; x++)
            {
                let offset: vec2f = vec2f(f32(x) - 1.5, f32(y) - 1.5);
                // of the twelve pixels around the block, take four, one on each side
                if ((abs(offset.x) - abs(offset.y)) * offset.x * offset.y > 0.5)
                {
                    let pixel: vec4f = BokehFetchGridTexel(MapSamp, middle + offset, full);
                    around = BokehSurroundings(around, pixel, BokehLayerWeight(-pixel.a *
                        full.size.y, nearSlope), maxNearWeight);
                }
            }
        }
        a = BokehNearPixel(a, nearWeights.x, around);
        b = BokehNearPixel(b, nearWeights.y, around);
        c = BokehNearPixel(c, nearWeights.z, around);
        d = BokehNearPixel(d, nearWeights.w, around);
        nearSum = vec4f(a.rgb, 1.0) * a.a + vec4f(b.rgb, 1.0) * b.a + vec4f(c.rgb, 1.0) * c.a +
            vec4f(d.rgb, 1.0) * d.a;
        weights = vec4f(a.a, b.a, c.a, d.a) * BokehBlurWeights(a, b, c, d, inverseBrightness,
            maxWeight);
        sums = vec4f(-dot(weights, s) / 8.0, dot(weights, one), sums.z, sums.w);
    }
    var targets: BokehPrefiltered;
    targets.nearLayer = nearSum * 0.25;
    targets.farLayer = farSum * 0.25;
    let maxValue: f32 = BOKEH_MAX_COLOR;
    targets.layerCoCSums = min(sums * 0.25, vec4f(maxValue, maxValue, maxValue, maxValue));
    targets.gatherCoC = min(gatherCoC, vec4f(maxValue, maxValue, maxValue, maxValue));
    return targets;
}

// Layers: sorts the pixels into a near and a far layer, 1 / BOKEH_LAYER_SCALE as large as the image
//   Reads the CoC map and dilatedTiles. Writes both layers, and two targets for the passes after
//   it: layerCoCSums, from which the CoC of each layer follows, and gatherCoC, which says how far
//   the gather has to reach. Antialiased pixels of near edges hold light of the background; if that
//   is bright, it is removed first, or it would be blurred into a false rim.
fn BokehPrefilter(MapSamp: texture_2d<f32>, DilatedTilesSamp: texture_2d<f32>,
    layers: BokehLayerContext, BokehLinearClamp: sampler) -> BokehPrefiltered
{
    let grid: BokehGrid = BokehLayerGrid(layers);
    let center: vec2f = (floor(layers.uv * grid.size) + 0.5) * f32(BOKEH_LAYER_SCALE);
    let tile: vec4f = BokehFetchGrid(DilatedTilesSamp, center / 8.0, BokehReducedGrid(layers, 8.0),
        BokehLinearClamp);
    let first: vec2f = center + (1.0 - 0.5 * f32(BOKEH_LAYER_SCALE));
    var targets: BokehPrefiltered = BokehPrefilterBlock(MapSamp, first, tile,
        layers);
    if (BOKEH_LAYER_SCALE > 2)
    {
        // a texel covers 4 x 4 pixels, which are three more blocks
        for (var i: i32 = 1; i < 4; i++)
        {
            let row: f32 = floor(0.5 * f32(i));
            let middle: vec2f = first + 2.0 * vec2f(f32(i) - 2.0 * row, row);
            let block: BokehPrefiltered = BokehPrefilterBlock(MapSamp, middle, tile,
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
    gatherCoC: vec4f,
    sums: vec4f,
}

// Layers: reduces layerCoCSums and gatherCoC to tiles
//   Reads both at half size, writes the mean of the first and the maximum of the second for each
//   tile, so that the two passes after it have few texels to read.
fn BokehLayerCoCReduce(SumsSamp: texture_2d<f32>, GatherCoCSamp: texture_2d<f32>,
    layers: BokehLayerContext) -> BokehTileSums
{
    let grid: BokehGrid = BokehLayerGrid(layers);
    // along a tile
    let texels: i32 = 8 / BOKEH_LAYER_SCALE;
    let first: vec2f = floor(layers.uv * ceil(layers.size / 8.0)) * f32(texels) + vec2f(0.5, 0.5);
    var sums: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var gatherCoC: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var y: i32 = 0; y < texels; y++)
    {
        for (var x: i32 = 0; x < texels; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            sums += BokehFetchGridTexel(SumsSamp, place, grid);
            gatherCoC = max(gatherCoC, BokehFetchGridTexel(GatherCoCSamp, place, grid));
        }
    }
    var targets: BokehTileSums;
    targets.gatherCoC = gatherCoC;
    targets.sums = sums / f32(texels * texels);
    return targets;
}

// Layers: does the work of BokehLayerCoCRows along any axis
//   axis          (1, 0) or (0, 1)
fn BokehLayerCoCAlong(GatherCoCSamp: texture_2d<f32>, SumsSamp: texture_2d<f32>,
    DilatedTilesSamp: texture_2d<f32>, axis: vec2f, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> BokehTileSums
{
    let grid: BokehGrid = BokehReducedGrid(layers, 8.0);
    let tile: vec2f = BokehFetchGrid(DilatedTilesSamp, layers.uv * grid.size, grid,
        BokehLinearClamp).rg;
    let sigma: vec2f = max(tile * BOKEH_TUNED_COC_SIGMA, vec2f(0.6, 0.6));
    let radius: f32 = BokehReachTiles(layers);
    var sums: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var gatherCoC: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var total: vec2f = vec2f(0.0, 0.0);
    for (var i: i32 = 0; i < 255; i++)
    {
        let tiles: f32 = f32(i) - radius;
        if (tiles > radius)
        {
            break;
        }
        let place: vec2f = layers.uv * grid.size + axis * tiles;
        let weight: vec2f = exp(-0.5 * tiles * tiles / (sigma * sigma));
        sums += BokehFetchGrid(SumsSamp, place, grid, BokehLinearClamp) * vec4f(weight.x, weight.x,
            weight.y, weight.y);
        let found: vec4f = BokehFetchGrid(GatherCoCSamp, place, grid, BokehLinearClamp);
        gatherCoC = max(gatherCoC, BokehGatherReaching(found, abs(tiles)));
        total += weight;
    }
    var targets: BokehTileSums;
    targets.gatherCoC = gatherCoC;
    targets.sums = sums / vec4f(total.x, total.x, total.y, total.y);
    return targets;
}

// Layers: combines gatherCoC and sums of the tiles around, along rows
//   Reads what BokehLayerCoCReduce wrote, and dilatedTiles. Writes the largest gatherCoC that
//   reaches each tile, and a mean of the sums by a Gaussian with a standard deviation of 0.3 of the
//   CoC in reach.
fn BokehLayerCoCRows(GatherCoCSamp: texture_2d<f32>, SumsSamp: texture_2d<f32>,
    DilatedTilesSamp: texture_2d<f32>, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> BokehTileSums
{
    return BokehLayerCoCAlong(GatherCoCSamp, SumsSamp, DilatedTilesSamp, vec2f(1.0, 0.0), layers,
        BokehLinearClamp);
}

// Layers: holds what BokehLayerCoCColumns writes
//   gatherTiles   largest near and far CoC whose blur reaches this tile, then how far the gather
//                 has to reach: the largest near and far gatherCoC, or those of lights; pixels
//   layerCoC      rg = CoC to blur the near and the far layer with, pixels; 0 without a layer
struct BokehLayerCoCTargets
{
    gatherTiles: vec4f,
    layerCoC: vec4f,
}

// Layers: combines along columns, and divides: one CoC for each layer and tile
//   Reads what BokehLayerCoCRows wrote, and dilatedTiles. Writes gatherTiles for Composite and
//   layerCoC for the passes that blur the layers: a blur can be separated into two passes only
//   where all pixels around use one CoC.
fn BokehLayerCoCColumns(GatherCoCSamp: texture_2d<f32>, SumsSamp: texture_2d<f32>,
    DilatedTilesSamp: texture_2d<f32>, layers: BokehLayerContext,
        BokehLinearClamp: sampler) -> BokehLayerCoCTargets
{
    let grid: BokehGrid = BokehReducedGrid(layers, 8.0);
    let tile: vec2f = BokehFetchGrid(DilatedTilesSamp, layers.uv * grid.size, grid,
        BokehLinearClamp).rg;
    let tileSums: BokehTileSums = BokehLayerCoCAlong(GatherCoCSamp, SumsSamp, DilatedTilesSamp,
        vec2f(0.0, 1.0), layers, BokehLinearClamp);
    let sums: vec4f = tileSums.sums;
    var layerCoC: vec2f = vec2f(0.0, 0.0);
    if (sums.g > 0.0001 && tile.r > BOKEH_TUNED_NEAR_START)
    {
        layerCoC = vec2f(8.0 * sums.r / sums.g, 0.0);
    }
    if (sums.a > 0.0001 && tile.g > BOKEH_TUNED_FAR_START)
    {
        layerCoC = vec2f(layerCoC.x, 8.0 * sums.b / sums.a);
    }
    // a light comes first, but not the little of it that a linear filter leaks into the next tile
    let light: vec2f = tileSums.gatherCoC.ba;
    let isDark: vec2f = clamp(2.0 - light, vec2f(0.0, 0.0), vec2f(1.0, 1.0));
    var targets: BokehLayerCoCTargets;
    targets.gatherTiles = vec4f(tile, light + tileSums.gatherCoC.rg * isDark);
    targets.layerCoC = vec4f(layerCoC, 0.0, 1.0);
    return targets;
}

// -------------------------------------------------------------------------------------------------
// [12] quarter size: smooth copies of the layers, and the background that the near layer hides

// Layers: returns the CoC that the near and the far layer are blurred with here, pixels
fn BokehLayerCoC(LayerCoCSamp: texture_2d<f32>, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> vec2f
{
    let grid: BokehGrid = BokehLayerGrid(layers);
    let place: vec2f = layers.uv * grid.size * (f32(BOKEH_LAYER_SCALE) / 8.0);
    return BokehFetchGrid(LayerCoCSamp, place, BokehReducedGrid(layers, 8.0), BokehLinearClamp).rg;
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
    CoC: f32,
    spacing: f32,
    useQuarterLayer: bool,
    sideTap: f32,
}

// Layers: chooses how a layer is blurred from its CoC
//   layerCoC      from BokehLayerCoC
fn BokehLayerBlur(layerCoC: vec2f, isFar: bool, polygon: BokehPolygon) -> BokehBlur
{
    var CoC: f32 = layerCoC.r / f32(BOKEH_LAYER_SCALE);
    var selfBlur: f32 = BOKEH_TUNED_NEAR_SELF_BLUR;
    if (isFar)
    {
        CoC = layerCoC.g / f32(BOKEH_LAYER_SCALE);
        selfBlur = clamp(BOKEH_TUNED_FAR_SELF_BLUR * CoC * CoC, BOKEH_TUNED_FAR_SELF_BLUR_MIN,
            BOKEH_TUNED_FAR_SELF_BLUR_MAX);
    }
    // a square has only one line in each pass
    var spacing: f32 = 0.5 * CoC / f32(BOKEH_LAYER_SAMPLES);
    var hard: f32 = BOKEH_TUNED_HEXAGON_SIDE;
    if (polygon.sides < 6)
    {
        spacing = 0.354 * CoC / f32(BOKEH_LAYER_SAMPLES);
        hard = BOKEH_TUNED_SQUARE_SIDE;
    }
    var blur: BokehBlur;
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
fn BokehQuarterLayer(LayerSamp: texture_2d<f32>, center: vec2f, side: f32,
    layers: BokehLayerContext, BokehLinearClamp: sampler) -> vec4f
{
    let grid: BokehGrid = BokehLayerGrid(layers);
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    if (side > 0.0)
    {
        for (var y: i32 = 0; y < 3; y++)
        {
            for (var x: i32 = 0; x < 3; x++)
            {
                let offset: vec2f = vec2f(f32(x) - 1.0, f32(y) - 1.0);
                let weight: vec2f = 1.0 - (1.0 - side) * abs(offset);
                sum += BokehFetchGrid(LayerSamp, center + 2.0 * offset, grid, BokehLinearClamp) *
                    (weight.x * weight.y);
            }
        }
        sum = sum / ((1.0 + 2.0 * side) * (1.0 + 2.0 * side));
    }
    else
    {
        sum = BokehFetchGrid(LayerSamp, center, grid, BokehLinearClamp);
    }
    return sum;
}

// Layers: holds what BokehDownsample writes
//   midWithHoles, farWithHoles  pixels in neither layer, and those of the far layer: rgb times
//                 weight, weight
//   nearQuarter, farQuarter  smooth copies of the two layers
struct BokehDownsampled
{
    midWithHoles: vec4f,
    farWithHoles: vec4f,
    nearQuarter: vec4f,
    farQuarter: vec4f,
}

// Layers: makes smooth copies of the layers, and collects the background, all at quarter size
//   Reads the CoC map, dilatedTiles, both layers and layerCoC. Writes nearQuarter and farQuarter
//   for wide blurs, and midWithHoles and farWithHoles, which have holes where near objects are.
//   Bright pixels have less weight in the background, or one light would fill a whole hole.
fn BokehDownsample(MapSamp: texture_2d<f32>, DilatedTilesSamp: texture_2d<f32>,
    NearSamp: texture_2d<f32>, FarSamp: texture_2d<f32>, LayerCoCSamp: texture_2d<f32>,
    polygon: BokehPolygon, layers: BokehLayerContext, BokehLinearClamp: sampler) -> BokehDownsampled
{
    let full: BokehGrid = BokehFullGrid(layers);
    let first: vec2f = floor(layers.uv * ceil(layers.size / 4.0)) * 4.0 + vec2f(0.5, 0.5);
    let middlePlace: vec2f = first + vec2f(1.5, 1.5);
    let tile: vec4f = BokehFetchGrid(DilatedTilesSamp, middlePlace / 8.0, BokehReducedGrid(layers,
        8.0), BokehLinearClamp);
    let nearSlope: f32 = BokehNearSlope(tile.r);
    let farSlope: f32 = BokehFarSlope(tile.g);
    let inverseBrightness: f32 = exp2(-tile.b);
    var midColor: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var farColor: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var y: i32 = 0; y < 4; y++)
    {
        for (var x: i32 = 0; x < 4; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            let pixel: vec4f = BokehFetchGridTexel(MapSamp, place, full);
            let s: f32 = pixel.a * full.size.y;
            // a partly near pixel is hardly background, or a near light would shine through itself
            let nearWeight: f32 = BokehLayerWeight(-s, nearSlope);
            let notNear: f32 = max(1.0 - 2.0 * nearWeight, 0.0625 - 0.0625 * nearWeight);
            let farWeight: f32 = BokehLayerWeight(s, farSlope);
            let weight: f32 = notNear / (1.0 + BokehBrightest(pixel.rgb) * inverseBrightness);
            midColor += vec4f(pixel.rgb, 1.0) * (weight * (1.0 - farWeight));
            farColor += vec4f(pixel.rgb, 1.0) * (weight * farWeight);
        }
    }
    let center: vec2f = middlePlace / f32(BOKEH_LAYER_SCALE);
    let layerCoC: vec2f = BokehLayerCoC(LayerCoCSamp, layers, BokehLinearClamp);
    var targets: BokehDownsampled;
    targets.midWithHoles = midColor / 16.0;
    targets.farWithHoles = farColor / 16.0;
    let nearBlur: BokehBlur = BokehLayerBlur(layerCoC, false, polygon);
    let farBlur: BokehBlur = BokehLayerBlur(layerCoC, true, polygon);
    targets.nearQuarter = BokehQuarterLayer(NearSamp, center, nearBlur.sideTap, layers,
        BokehLinearClamp);
    targets.farQuarter = BokehQuarterLayer(FarSamp, center, farBlur.sideTap, layers,
        BokehLinearClamp);
    return targets;
}

// Layers: returns the direction of edge k, rotated but not squeezed
fn BokehEdgeDirection(k: i32, polygon: BokehPolygon) -> vec2f
{
    let outwards: vec2f = BokehTurn(f32(k), polygon);
    return BokehRotated(vec2f(-outwards.y, outwards.x), polygon.axis);
}

// Layers: returns how many samples of a ring lie on each edge of the polygon
//   There are 6 on the first ring, 12 on the second and so on, divided among the edges, so all
//   rings are sampled with the same density. A polygon with more sides than that has one on each.
fn BokehSamplesPerEdge(ring: i32, polygon: BokehPolygon) -> i32
{
    return i32(max(6.0 * f32(ring) / f32(polygon.sides) + 0.5, 1.0));
}

// Layers: returns the weights that a texel of midWithHoles and one of farWithHoles had before
//   BokehDownsample divided them by 1 + brightness / mean
fn BokehHoleWeights(midColor: vec4f, farColor: vec4f, inverseBrightness: f32) -> vec2f
{
    return vec2f(midColor.a + BokehBrightest(midColor.rgb) * inverseBrightness, farColor.a +
        BokehBrightest(farColor.rgb) * inverseBrightness);
}

// Layers: holds what BokehHoleFill writes
//   midFill       rgb = pixels in neither layer, a = their fraction of the background around
//   farFill       rgb = the far layer
struct BokehFilled
{
    midFill: vec4f,
    farFill: vec4f,
}

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
fn BokehHoleFill(MidSamp: texture_2d<f32>, FarSamp: texture_2d<f32>,
    DilatedTilesSamp: texture_2d<f32>, polygon: BokehPolygon, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> BokehFilled
{
    let grid: BokehGrid = BokehReducedGrid(layers, 4.0);
    let center: vec2f = layers.uv * grid.size;
    let tile: vec4f = BokehFetchGrid(DilatedTilesSamp, center / 2.0, BokehReducedGrid(layers, 8.0),
        BokehLinearClamp);
    let nearCoC: f32 = tile.r;
    let inverseBrightness: f32 = exp2(-tile.b);
    var corner: vec2f = BokehRotated(polygon.corner, polygon.axis);
    var direction: vec2f = BokehEdgeDirection(1, polygon);
    let turn: vec2f = BokehTurn(1.0, polygon);
    var midColor: vec4f = BokehFetchGrid(MidSamp, center, grid, BokehLinearClamp);
    var farColor: vec4f = BokehFetchGrid(FarSamp, center, grid, BokehLinearClamp);
    var weights: vec2f = BokehHoleWeights(midColor, farColor, inverseBrightness);
    for (var ring: i32 = 0; ring < 3; ring++)
    {
        // no near layer, no holes
        if (nearCoC < BOKEH_TUNED_NEAR_START)
        {
            break;
        }
        // diameter in texels: 1/8, 0.35 and 1 of the CoC
        let diameter: f32 = max(nearCoC / 8.0, 2.0) * exp2(1.5 * f32(ring) - 2.0);
        let weight: f32 = 1.0 / (1.0 + 4.0 * diameter * diameter * diameter);
        let scale: vec2f = vec2f(polygon.squeeze * diameter, diameter);
        let onEdge: i32 = BokehSamplesPerEdge(1, polygon);
        for (var edge: i32 = 1; edge <= polygon.sides; edge++)
        {
            let along: vec2f = direction * (BokehEdgeLength(edge, polygon) / f32(onEdge));
            for (var i: i32 = 0; i < onEdge; i++)
            {
                let place: vec2f = center + corner * scale;
                let midTexel: vec4f = BokehFetchGrid(MidSamp, place, grid, BokehLinearClamp);
                let farTexel: vec4f = BokehFetchGrid(FarSamp, place, grid, BokehLinearClamp);
                midColor += midTexel * weight;
                farColor += farTexel * weight;
                weights += BokehHoleWeights(midTexel, farTexel, inverseBrightness) * weight;
                corner += along;
            }
            direction = BokehRotated(direction, turn);
        }
    }
    let both: vec3f = (midColor.rgb + farColor.rgb) / max(midColor.a + farColor.a, 0.000001);
    let midWeight: f32 = weights.r / max(weights.r + weights.g, 0.000001);
    var targets: BokehFilled;
    targets.midFill = vec4f(both, midWeight);
    targets.farFill = vec4f(both, 1.0);
    if (midColor.a > 0.000001)
    {
        targets.midFill = vec4f(midColor.rgb / midColor.a, midWeight);
    }
    if (farColor.a > 0.000001)
    {
        targets.farFill = vec4f(farColor.rgb / farColor.a, 1.0);
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
fn BokehLayerSamples(tex: texture_2d<f32>, first: vec2f, sampleStep: vec2f, samples: f32,
    phase: f32, grid: BokehGrid, BokehLinearClamp: sampler) -> vec4f
{
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var i: i32 = 0; i < i32(ceil(samples)); i++)
    {
        let part: f32 = clamp(samples - f32(i), 0.0, 1.0);
        let place: vec2f = first + sampleStep * (f32(i) + part * phase);
        sum += part * BokehFetchGrid(tex, place, grid, BokehLinearClamp);
    }
    return sum;
}

// Layers: averages the samples along edge k, and in the second pass multiplies the mean by the area
//   of the edge's parallelograms
//   1.000001 keeps rounding from darkening an even layer, see BokehResolved.
//   tex           the layer, or a strip
//   QuarterSamp   the layer at quarter size, read if useQuarterLayer of blur is true
//   blur          from BokehLayerBlur
fn BokehLayerLine(tex: texture_2d<f32>, QuarterSamp: texture_2d<f32>, k: i32, polygon: BokehPolygon,
    secondPass: bool, blur: BokehBlur, layers: BokehLayerContext,
        BokehLinearClamp: sampler) -> vec4f
{
    var scale: f32 = f32(BOKEH_LAYER_SCALE);
    if (blur.useQuarterLayer)
    {
        scale = 4.0;
    }
    let grid: BokehGrid = BokehReducedGrid(layers, scale);
    let segment: vec4f = BokehEdgeLine(k, polygon, secondPass) * blur.CoC;
    let samples: f32 = max(2.0 * length(segment.zw) / blur.spacing, 2.0);
    let phase: f32 = 0.5 + layers.jitter * min(blur.spacing - 1.0, 1.0);
    let layerGrid: BokehGrid = BokehLayerGrid(layers);
    let first: vec2f = (layers.uv * layerGrid.size + segment.xy - segment.zw) *
        (f32(BOKEH_LAYER_SCALE) / scale);
    let sampleStep: vec2f = segment.zw * (2.0 * f32(BOKEH_LAYER_SCALE) / (scale * samples));
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    if (blur.useQuarterLayer)
    {
        sum = BokehLayerSamples(QuarterSamp, first, sampleStep, samples, phase,
            grid, BokehLinearClamp);
    }
    else
    {
        sum = BokehLayerSamples(tex, first, sampleStep, samples, phase, grid, BokehLinearClamp);
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
fn BokehLayerTarget(k: i32, polygon: BokehPolygon, L1: vec4f, L2: vec4f, L3: vec4f,
    L4: vec4f) -> vec4f
{
    let w: vec4f = BokehEdgeWeights(k, polygon);
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
fn BokehLayerFirst(LayerSamp: texture_2d<f32>, QuarterSamp: texture_2d<f32>, layerCoC: vec2f,
    isFar: bool, last: i32, polygon: BokehPolygon, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> BokehTargets
{
    let grid: BokehGrid = BokehLayerGrid(layers);
    let center: vec2f = layers.uv * grid.size;
    let zero: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var targets: BokehTargets;
    let blur: BokehBlur = BokehLayerBlur(layerCoC, isFar, polygon);
    if (blur.CoC > 0.51)
    {
        var L2: vec4f = zero;
        var L3: vec4f = zero;
        var L4: vec4f = zero;
        let L1: vec4f = BokehLayerLine(LayerSamp, QuarterSamp, 1, polygon, false, blur, layers,
            BokehLinearClamp);
        if (last > 2)
        {
            L2 = BokehLayerLine(LayerSamp, QuarterSamp, 2, polygon, false, blur, layers,
                BokehLinearClamp);
        }
        if (last > 3)
        {
            L3 = BokehLayerLine(LayerSamp, QuarterSamp, 3, polygon, false, blur, layers,
                BokehLinearClamp);
        }
        if (last > 4)
        {
            L4 = BokehLayerLine(LayerSamp, QuarterSamp, 4, polygon, false, blur, layers,
                BokehLinearClamp);
        }
        targets.strip2 = L1;
        targets.strip3 = BokehLayerTarget(3, polygon, L1, L2, zero, zero);
        targets.strip4 = BokehLayerTarget(4, polygon, L1, L2, L3, zero);
        targets.strip5 = BokehLayerTarget(5, polygon, L1, L2, L3, L4);
    }
    else
    {
        targets.strip2 = BokehFetchGrid(LayerSamp, center, grid, BokehLinearClamp);
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
fn BokehLayerSecond(Strip2Samp: texture_2d<f32>, Strip3Samp: texture_2d<f32>,
    Strip4Samp: texture_2d<f32>, Strip5Samp: texture_2d<f32>, layerCoC: vec2f, isFar: bool,
    polygon: BokehPolygon, layers: BokehLayerContext, BokehLinearClamp: sampler) -> vec4f
{
    let grid: BokehGrid = BokehLayerGrid(layers);
    let center: vec2f = layers.uv * grid.size;
    var result: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var blur: BokehBlur = BokehLayerBlur(layerCoC, isFar, polygon);
    blur.useQuarterLayer = false;
    if (blur.CoC > 0.51)
    {
        result = BokehLayerLine(Strip2Samp, Strip2Samp, 2, polygon, true, blur, layers,
            BokehLinearClamp);
        if (polygon.sides > 4)
        {
            result += BokehLayerLine(Strip3Samp, Strip3Samp, 3, polygon, true, blur, layers,
                BokehLinearClamp);
        }
        if (polygon.sides > 6)
        {
            result += BokehLayerLine(Strip4Samp, Strip4Samp, 4, polygon, true, blur, layers,
                BokehLinearClamp);
        }
        if (polygon.sides > 8)
        {
            result += BokehLayerLine(Strip5Samp, Strip5Samp, 5, polygon, true, blur, layers,
                BokehLinearClamp);
        }
        result = result / polygon.area;
    }
    else
    {
        result = BokehFetchGrid(Strip2Samp, center, grid, BokehLinearClamp);
    }
    return result;
}

// Layers: holds what BokehLayersFirst writes; only a hexagon uses the two strips 3
struct BokehLayersTargets
{
    nearStrip2: vec4f,
    farStrip2: vec4f,
    nearStrip3: vec4f,
    farStrip3: vec4f,
}

// Layers: blurs both layers of a square or a hexagon, first pass
//   Reads both layers, their quarter layers and layerCoC, and writes the strips of both. A square
//   or a hexagon has so few strips that those of both layers fit into four targets, so one pass
//   does the work of two.
fn BokehLayersFirst(NearSamp: texture_2d<f32>, NearQuarterSamp: texture_2d<f32>,
    FarSamp: texture_2d<f32>, FarQuarterSamp: texture_2d<f32>, layerCoC: vec2f,
        polygon: BokehPolygon, layers: BokehLayerContext,
        BokehLinearClamp: sampler) -> BokehLayersTargets
{
    let last: i32 = polygon.sides / 2;
    let nearTargets: BokehTargets = BokehLayerFirst(NearSamp, NearQuarterSamp, layerCoC, false,
        last, polygon, layers, BokehLinearClamp);
    let farTargets: BokehTargets = BokehLayerFirst(FarSamp, FarQuarterSamp, layerCoC, true,
        last, polygon, layers, BokehLinearClamp);
    var targets: BokehLayersTargets;
    targets.nearStrip2 = nearTargets.strip2;
    targets.farStrip2 = farTargets.strip2;
    targets.nearStrip3 = nearTargets.strip3;
    targets.farStrip3 = farTargets.strip3;
    return targets;
}

// Layers: holds the finished layers
struct BokehBlurred
{
    nearLayer: vec4f,
    farLayer: vec4f,
}

// Layers: blurs both layers of a square or a hexagon, second pass
//   Reads the strips of both layers and layerCoC, and writes both finished layers. As in
//   BokehLayersFirst, one pass does the work of two. For a square, pass any textures as strips 3:
//   they are not read.
fn BokehLayersSecond(NearStrip2Samp: texture_2d<f32>, FarStrip2Samp: texture_2d<f32>,
    NearStrip3Samp: texture_2d<f32>, FarStrip3Samp: texture_2d<f32>, layerCoC: vec2f,
        polygon: BokehPolygon, layers: BokehLayerContext, BokehLinearClamp: sampler) -> BokehBlurred
{
    var targets: BokehBlurred;
    targets.nearLayer = BokehLayerSecond(NearStrip2Samp, NearStrip3Samp,
        NearStrip3Samp, NearStrip3Samp, layerCoC, false, polygon, layers, BokehLinearClamp);
    targets.farLayer = BokehLayerSecond(FarStrip2Samp, FarStrip3Samp,
        FarStrip3Samp, FarStrip3Samp, layerCoC, true, polygon, layers, BokehLinearClamp);
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
fn BokehFetchLayer(LayerSamp: texture_2d<f32>, place: vec2f, grid: BokehGrid,
    BokehLinearClamp: sampler) -> vec4f
{
    var result: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    if (BOKEH_LAYER_CUBIC > 0)
    {
        let texel: vec2f = floor(place - 0.5) + 0.5;
        let f: vec2f = place - texel;
        let w0: vec2f = f * (f * (1.0 - 0.5 * f) - 0.5);
        let w2: vec2f = f * (f * (2.0 - 1.5 * f) + 0.5);
        let w3: vec2f = f * f * (0.5 * f - 0.5);
        let w12: vec2f = 1.0 - w0 - w3;
        let inner: vec2f = texel + w2 / w12;
        let c: vec4f = BokehFetchGrid(LayerSamp, inner, grid, BokehLinearClamp);
        let l: vec4f = BokehFetchGrid(LayerSamp, vec2f(texel.x - 1.0, inner.y), grid,
            BokehLinearClamp);
        let r: vec4f = BokehFetchGrid(LayerSamp, vec2f(texel.x + 2.0, inner.y), grid,
            BokehLinearClamp);
        let t: vec4f = BokehFetchGrid(LayerSamp, vec2f(inner.x, texel.y - 1.0), grid,
            BokehLinearClamp);
        let b: vec4f = BokehFetchGrid(LayerSamp, vec2f(inner.x, texel.y + 2.0), grid,
            BokehLinearClamp);
        let side: vec2f = w12.yx / (w12.x * w12.y + (w0.x + w3.x) * w12.y + (w0.y + w3.y) * w12.x);
        let sum: vec4f = c * (w12.x * side.x) + l * (w0.x * side.x) + r * (w3.x * side.x) + t *
            (w0.y * side.y) + b * (w3.y * side.y);
        result = clamp(sum, min(min(c, min(l, r)), min(t, b)), max(max(c, max(l, r)), max(t, b)));
    }
    else
    {
        result = BokehFetchGrid(LayerSamp, place, grid, BokehLinearClamp);
    }
    return result;
}

// Layers: returns 1 / radius^2 of the discs over which two CoC spread, pixels
//   With r = CoC / 2 it is (r^2 + BOKEH_TUNED_PIXEL_BLUR) / r^4.
fn BokehSpreadInverse(CoC: vec2f) -> vec2f
{
    let inverse: vec2f = 1.0 / max(CoC * CoC, vec2f(0.000001, 0.000001));
    return inverse * (inverse * (16.0 * BOKEH_TUNED_PIXEL_BLUR) + 4.0);
}

// Layers: describes how the gather of a pixel is divided into rings
//   radius        of the gather, pixels
//   spacing       between rings, pixels
//   narrowing     0: rings evenly spaced; 1: denser towards the centre, but never less than a pixel
//                 apart
struct BokehRingLayout
{
    radius: f32,
    spacing: f32,
    narrowing: f32,
}

// Layers: returns the outer border of a ring of the gather, pixels; ring 0 is the inner disc
fn BokehRingBorder(ring: i32, rings: BokehRingLayout) -> f32
{
    let even: f32 = rings.spacing * (f32(ring) + 0.5);
    return max(even + even * (even / rings.radius - 1.0) * rings.narrowing, min(even, f32(ring) +
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
    sum: BokehHalf4,
    front: BokehHalf4,
    farFound: f32,
    center: vec2f,
    s: f32,
    inverse: f32,
    nearWeight: f32,
    slopes: vec2f,
    snapping: f32,
    bounds: vec2f,
    inner: f32,
}

// Layers: converts a texel for the gather
//   In half precision it limits colours, so that their sum stays a finite half float: the weights
//   of a ring add up to 1 at most, and a gather has at most six rings and the centre.
fn BokehHalfTexel(texel: vec4f) -> BokehHalf4
{
    var converted: BokehHalf4 = BokehHalf4(texel);
    if (BOKEH_HALF_PRECISION > 0)
    {
        converted = min(converted, BokehHalf4(8000.0, 8000.0, 8000.0, 8000.0));
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
    index: i32,
    onEdge: i32,
    first: i32,
    end: i32,
    outer: f32,
}

// Layers: returns a ring of the gather with all its samples
//   density       number of the ring whose number of samples it takes
fn BokehMakeRing(index: i32, density: i32, rings: BokehRingLayout,
    polygon: BokehPolygon) -> BokehRing
{
    var ring: BokehRing;
    ring.index = index;
    ring.onEdge = BokehSamplesPerEdge(density, polygon);
    ring.first = 0;
    ring.end = ring.onEdge;
    ring.outer = min(BokehRingBorder(index, rings), rings.radius);
    return ring;
}

// Layers: gathers samples of a ring, which begins at `inner` of the gather
//   If first and end of the ring and the polygon's sides are literals, compilers unroll both loops.
fn BokehGatherRing(before: BokehGather, MapSamp: texture_2d<f32>, ring: BokehRing,
    polygon: BokehPolygon, layers: BokehLayerContext, BokehLinearClamp: sampler) -> BokehGather
{
    //   |-----|--.--|--.--|     weight of a sample: the part of its ring that its own disc covers,
    //   disc    1     2         divided by the area of that disc
    var gather: BokehGather = before;
    let full: BokehGrid = BokehFullGrid(layers);
    let zero: vec2f = vec2f(0.0, 0.0);
    let one: vec2f = vec2f(1.0, 1.0);
    let outwards: f32 = BOKEH_TUNED_RING_POSITION - BOKEH_TUNED_RING_STEP * f32(BOKEH_LAYER_RINGS);
    let current: f32 = gather.inner + (ring.outer - gather.inner) * outwards;
    let innerSquare: f32 = gather.inner * gather.inner;
    let area: f32 = ring.outer * ring.outer - innerSquare;
    // the part of the ring that this pixel's disc covers, for samples behind its surface
    let ownCovers: f32 = max(min(1.0 - innerSquare * gather.inverse, area * gather.inverse), 0.0);
    var phase: f32 = layers.jitter * clamp(current / f32(ring.index) - 1.0, 0.0, 1.0);
    if (ring.index != 2)
    {
        // all rings but the second are rotated by half a step, so that those beside it fill its
        // gaps
        phase += 0.5;
    }
    // axes of the upright polygon, in pixels: compilers can fold the arithmetic on its corners
    let right: vec2f = vec2f(polygon.axis.x * polygon.squeeze, polygon.axis.y) * current;
    let upwards: vec2f = vec2f(-polygon.axis.y * polygon.squeeze, polygon.axis.x) * current;
    var corner: vec2f = polygon.corner * 2.0;
    let turn: vec2f = BokehTurn(1.0, polygon);
    var direction: vec2f = vec2f(-turn.y, turn.x) * 2.0;
    // half of the edges: samples of the other half are opposite to these
    for (var edge: i32 = 1; edge <= polygon.sides / 2; edge++)
    {
        let alongEdge: vec2f = direction * BokehEdgeLength(edge, polygon);
        let along: vec2f = alongEdge / f32(ring.onEdge);
        // each edge represents the triangle from the centre to it
        let sampleArea: f32 = (corner.x * along.y - corner.y * along.x) / (8.0 * polygon.area);
        for (var i: i32 = ring.first; i < ring.end; i++)
        {
            let upright: vec2f = corner + along * (f32(i) + phase);
            let place: vec2f = right * upright.x + upwards * upright.y;
            let texel: vec2f = floor(place);
            // steeper between two texels than the linear filter is
            let offset: vec2f = texel + clamp((place - texel) * (gather.snapping + 1.0) - 0.5 *
                gather.snapping, zero, one);
            // this sample and the one opposite to it, both at once
            let pixel: BokehHalf4 = BokehHalfTexel(BokehFetchAround(MapSamp, gather.center, offset,
                full, BokehLinearClamp));
            let other: BokehHalf4 = BokehHalfTexel(BokehFetchAround(MapSamp, gather.center, -offset,
                full, BokehLinearClamp));
            let CoC: vec2f = vec2f(f32(pixel.a), f32(other.a)) * full.size.y;
            let isBehind: vec2f = clamp(CoC * 2.0 - 2.0 * gather.s, zero, one) * (1.0 -
                gather.nearWeight);
            let inverse: vec2f = clamp(BokehSpreadInverse(CoC), gather.bounds.xx,
                gather.bounds.yy);
            var covers: vec2f = max(min(1.0 - innerSquare * inverse, area * inverse), zero);
            covers = sampleArea * (covers + (ownCovers - covers) * isBehind);
            let inFar: vec2f = covers * clamp(CoC * gather.slopes.y - 2.0, zero, one);
            covers = covers * (1.0 - clamp(CoC * -gather.slopes.x - 2.0, zero, one)) - inFar;
            gather.farFound += inFar.x + inFar.y;
            let weights: BokehHalf2 = BokehHalf2(covers);
            gather.sum += BokehHalf4(pixel.rgb, 1.0) * weights.x;
            gather.sum += BokehHalf4(other.rgb, 1.0) * weights.y;
            let inFront: BokehHalf2 = BokehHalf2(covers * clamp(gather.s - 0.5 - CoC, zero, one));
            gather.front += BokehHalf4(pixel.rgb, 1.0) * inFront.x;
            gather.front += BokehHalf4(other.rgb, 1.0) * inFront.y;
        }
        corner += alongEdge;
        direction = BokehRotated(direction, turn);
    }
    return gather;
}

// Layers: gathers a ring before the last one, if the preset has it and it begins inside the gather
//   index         of the ring: 1 .. BOKEH_LAYER_RINGS
fn BokehGatherInnerRing(before: BokehGather, MapSamp: texture_2d<f32>, index: i32,
    rings: BokehRingLayout, polygon: BokehPolygon, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> BokehGather
{
    var gather: BokehGather = before;
    let ring: BokehRing = BokehMakeRing(index, index, rings, polygon);
    if (index <= BOKEH_LAYER_RINGS && gather.inner < ring.outer)
    {
        gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers, BokehLinearClamp);
        gather.inner = ring.outer;
    }
    return gather;
}

// Layers: gathers the last ring, number BOKEH_LAYER_RINGS + 1, if it begins inside the gather
//   isDense       true: it has as many samples as the ring before it; false: as few as ring 1
fn BokehGatherLastRing(before: BokehGather, MapSamp: texture_2d<f32>, isDense: bool,
    rings: BokehRingLayout, polygon: BokehPolygon, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> BokehGather
{
    var gather: BokehGather = before;
    var ring: BokehRing = BokehMakeRing(BOKEH_LAYER_RINGS + 1, 1, rings, polygon);
    let few: i32 = ring.onEdge;
    var many: i32 = few;
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
        gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers, BokehLinearClamp);
        if (isDense && many > few)
        {
            ring.first = few;
            ring.end = many;
            gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers, BokehLinearClamp);
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
fn BokehOutline(MapSamp: texture_2d<f32>, center: vec2f, pixel: vec4f, farColor: vec3f,
    farSlope: f32, layers: BokehLayerContext, BokehLinearClamp: sampler) -> vec3f
{
    let full: BokehGrid = BokehFullGrid(layers);
    var object: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var background: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var side: vec2f = vec2f(1.0, 0.0);
    for (var i: i32 = 0; i < 2; i++)
    {
        // the object is opposite to the background: pixels along the outline are mixed too
        let first: vec4f = BokehFetchAround(MapSamp, center, side, full, BokehLinearClamp);
        let opposite: vec4f = BokehFetchAround(MapSamp, center, -side, full, BokehLinearClamp);
        let CoC: vec2f = vec2f(first.a, opposite.a) * full.size.y;
        let change: vec2f = abs(CoC - pixel.a * full.size.y);
        let isFar: vec2f = vec2f(BokehLayerWeight(CoC.x, farSlope),
            BokehLayerWeight(CoC.y, farSlope));
        let isObject: vec2f = clamp(2.0 - change, vec2f(0.0, 0.0), vec2f(1.0, 1.0)) * isFar.yx;
        background += vec4f(first.rgb, 1.0) * isFar.x;
        background += vec4f(opposite.rgb, 1.0) * isFar.y;
        object += vec4f(first.rgb, 1.0) * isObject.x;
        object += vec4f(opposite.rgb, 1.0) * isObject.y;
        side = vec2f(0.0, 1.0);
    }
    let behind: vec3f = background.rgb / max(background.a, 0.000001);
    let contrast: vec3f = object.rgb / max(object.a, 0.000001) - behind;
    let ownContrast: vec3f = pixel.rgb - behind;
    // too little contrast says nothing of a mixture
    let square: f32 = max(dot(contrast, contrast), 0.001 * dot(pixel.rgb, pixel.rgb) +
        0.000000000001);
    let covered: f32 = clamp(dot(ownContrast, contrast) / square, 0.0, 1.0);
    // A pixel of another colour is no mixture of the two, and one that looks like the background
    // alone is a part of the object.
    let other: vec3f = ownContrast - contrast * covered;
    var isMixed: f32 = clamp(2.0 - 8.0 * dot(other, other) / square, 0.0, 1.0) * min(16.0 * covered,
        1.0);
    // Such a pixel is taken to be open by a quarter, which is the mean for an upright or a level
    // edge that leaves the middle of the pixel covered.
    let open: f32 = 0.25 + (0.75 - covered) * isMixed;
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
fn BokehComposite(MapSamp: texture_2d<f32>, GatherTilesSamp: texture_2d<f32>,
    NearSamp: texture_2d<f32>, FarSamp: texture_2d<f32>, MidFillSamp: texture_2d<f32>,
    FarFillSamp: texture_2d<f32>, polygon: BokehPolygon, layers: BokehLayerContext,
    BokehLinearClamp: sampler) -> vec4f
{
    let full: BokehGrid = BokehFullGrid(layers);
    // without the rounding of uv, see BokehFetchAround
    let center: vec2f = floor(layers.uv * full.size) + 0.5;
    let centerPixel: vec4f = BokehFetchTexel(MapSamp, BokehToTexture(layers.uv));
    let tile: vec4f = BokehFetchGrid(GatherTilesSamp, center / 8.0, BokehReducedGrid(layers, 8.0),
        BokehLinearClamp);
    var result: vec3f = centerPixel.rgb;
    let grid: BokehGrid = BokehLayerGrid(layers);
    var nearLayer: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    // only where BOKEH_SIDES is defined: shader model 3 has too few registers to keep the layer
    // during the gather
    if (BOKEH_SIDES > 0 && tile.r > BOKEH_TUNED_NEAR_START)
    {
        nearLayer = BokehFetchLayer(NearSamp, center / f32(BOKEH_LAYER_SCALE), grid,
            BokehLinearClamp);
    }
    // copy the input if nothing within reach is blurred by more than a pixel; a near layer may hide
    // everything else
    if (max(tile.r, tile.g) > 1.0 && nearLayer.a * BOKEH_TUNED_NEAR_ALPHA < 1.0)
    {
        var gather: BokehGather;
        let s: f32 = centerPixel.a * full.size.y;
        gather.center = center;
        gather.s = s;
        gather.slopes = vec2f(BokehNearSlope(tile.r), BokehFarSlope(tile.g));
        let nearWeight: f32 = BokehLayerWeight(-s, gather.slopes.x);
        let farWeight: f32 = BokehLayerWeight(s, gather.slopes.y);
        gather.nearWeight = nearWeight;
        gather.inverse = BokehSpreadInverse(vec2f(s, s)).x;
        // the gather reaches as far as the CoC of pixels in neither layer
        let restRadius: f32 = clamp(16.0 - 16.0 * farWeight, 0.0, 1.0) * (1.0 - nearWeight) /
            sqrt(gather.inverse);
        var radius: f32 = max(max(restRadius, 0.01), 0.5 * max(tile.b, tile.a * farWeight));
        if (BOKEH_LAYER_RINGS == 0)
        {
            radius = min(radius, BOKEH_TUNED_SINGLE_RADIUS);
        }
        var ringLayout: BokehRingLayout;
        ringLayout.radius = radius;
        ringLayout.narrowing = clamp(radius / max(restRadius, 1.0) - 1.0, 0.0, 1.0);
        // one number for both layers: the near one starts at a smaller CoC than the far one
        let layerReach: f32 = max(tile.g, tile.r + (BOKEH_TUNED_FAR_START -
            BOKEH_TUNED_NEAR_START));
        var denseRings: f32 = f32(BOKEH_LAYER_RINGS);
        // Where the far layer is not in reach, one more ring takes its fetches; a pixel of the near
        // layer does not need that ring. Without CUBIC a layer takes a single fetch, so the ring is
        // added only where both layers are small.
        var hasFreeFetches: bool = layerReach <= 14.0;
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
        var outline: f32 = clamp(2.0 - abs(s), 0.0, 1.0) * clamp(layerReach - 14.0 + 4.0 *
            f32(BOKEH_LAYER_CUBIC), 0.0, 1.0) * clamp(max(2.0 * BOKEH_TUNED_RING_WIDTH *
            denseRings, 1.0) - 2.0 * radius, 0.0, 1.0);
        var rings: f32 = denseRings;
        if (max(nearWeight, farWeight * tile.r * f32(BOKEH_LAYER_RINGS - 1)) <= 0.0)
        {
            // A gather that reaches far has one more ring, of few samples: with wider gaps between
            // the rings, a thin bright line would show as a row of copies. In a layer the gather
            // shows less; there, only a preset with a single ring has one more.
            rings = max(rings, min(radius / BOKEH_TUNED_RING_WIDTH,
                f32(BOKEH_LAYER_RINGS) + 1.0));
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
        gather.bounds = 1.0 / vec2f(radius * radius, gather.inner * gather.inner);
        let weight: f32 = (1.0 - nearWeight) * min(gather.inverse / gather.bounds.y, 1.0);
        // pixels of the far layer are replaced by that layer: a single one of them would be a
        // bright dot
        gather.farFound = weight * farWeight;
        gather.sum = BokehHalf4(vec4f(BokehHalfTexel(vec4f(centerPixel.rgb, 1.0))) *
            (weight - gather.farFound));
        gather.front = BokehHalf4(0.0, 0.0, 0.0, 0.0);
        // the wider a layer's blur here, the closer samples move to the nearest texel: between a
        // near light and the surface behind it, the linear filter would find a light in focus
        gather.snapping = max(tile.r, tile.g - 16.0);
        if (BOKEH_SIDES > 0)
        {
            // each ring has a call of its own: its number of samples is then known, and compilers
            // unroll its loops
            gather = BokehGatherInnerRing(gather, MapSamp, 1, ringLayout, polygon, layers,
                BokehLinearClamp);
            gather = BokehGatherInnerRing(gather, MapSamp, 2, ringLayout, polygon, layers,
                BokehLinearClamp);
            gather = BokehGatherInnerRing(gather, MapSamp, 3, ringLayout, polygon, layers,
                BokehLinearClamp);
            gather = BokehGatherInnerRing(gather, MapSamp, 4, ringLayout, polygon, layers,
                BokehLinearClamp);
            gather = BokehGatherLastRing(gather, MapSamp, hasFreeFetches, ringLayout, polygon,
                layers, BokehLinearClamp);
        }
        else
        {
            for (var index: i32 = 1; index <= BOKEH_LAYER_RINGS + 1; index++)
            {
                if (gather.inner >= radius)
                {
                    break;
                }
                var density: i32 = max(min(index, BOKEH_LAYER_RINGS), 1);
                if (f32(index) > denseRings)
                {
                    density = 1;
                }
                let ring: BokehRing = BokehMakeRing(index, density, ringLayout, polygon);
                gather = BokehGatherRing(gather, MapSamp, ring, polygon, layers,
                    BokehLinearClamp);
                gather.inner = ring.outer;
            }
        }

        var farLayer: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        // both layers at once where the near one has not been read yet: they share the arithmetic
        var farReach: f32 = tile.g;
        if (BOKEH_SIDES == 0)
        {
            farReach = layerReach;
        }
        if (farReach > BOKEH_TUNED_FAR_START)
        {
            if (BOKEH_SIDES == 0)
            {
                nearLayer = BokehFetchLayer(NearSamp, center / f32(BOKEH_LAYER_SCALE), grid,
                    BokehLinearClamp);
            }
            farLayer = BokehFetchLayer(FarSamp, center / f32(BOKEH_LAYER_SCALE), grid,
                BokehLinearClamp);
        }
        let quarters: BokehGrid = BokehReducedGrid(layers, 4.0);
        // 1 at near pixels; at far pixels it grows with the coverage of the blurred near layer
        let behindNear: f32 = clamp(2.0 * farWeight * nearLayer.a - 0.25 + 1000.0 * nearWeight,
            0.0, 1.0);
        var farColor: vec3f = farLayer.rgb / max(farLayer.a, 0.000001);
        if (behindNear > 0.0)
        {
            // Near pixels hide most of what a far polygon covers, so few far pixels represent all
            // of it. Where the far layer covers less than half, the fill supplies the rest.
            let farFill: vec4f = BokehFetchGrid(FarFillSamp, 0.25 * center, quarters,
                BokehLinearClamp);
            let missing: f32 = clamp(1.0 - 2.0 * farLayer.a, 0.0, 1.0) * behindNear;
            farColor += (farFill.rgb - farColor) * missing;
            farLayer = vec4f(farColor * farLayer.a, farLayer.a);
        }
        // at pixels of a layer, the layer itself is added below
        let sum: vec4f = vec4f(gather.sum) + farLayer * (gather.farFound * (1.0 - max(farWeight,
            nearWeight)) / max(farLayer.a, 0.001));
        let plain: vec4f = sum + farLayer * farWeight;
        let front: vec4f = vec4f(gather.front);
        if (plain.a >= 0.001)
        {
            // the weight of samples in front is their coverage; the rest shows through the gaps
            let rest: vec4f = plain - front;
            let shown: vec4f = front * max(rest.a, 0.1) + rest * clamp(1.0 - front.a, 0.0, 1.0);
            // 1.000001: see BokehResolved
            result = shown.rgb * (1.000001 / shown.a);
        }
        outline *= clamp(4.0 * farLayer.a, 0.0, 1.0);
        if (BOKEH_LAYER_OUTLINES > 0 && outline > 0.0)
        {
            let change: vec3f = BokehOutline(MapSamp, center, centerPixel, farColor,
                gather.slopes.y, layers, BokehLinearClamp);
            result = max(result + change * outline, vec3f(0.0, 0.0, 0.0));
        }
        if (nearWeight > 0.0)
        {
            // in depth order: the gather, the fill of its holes, the far layer, the fill of that
            let midFill: vec4f = BokehFetchGrid(MidFillSamp, 0.25 * center, quarters,
                BokehLinearClamp);
            let inNear: f32 = nearLayer.a * min(2.0 - 2.0 * nearWeight, 1.0);
            let empty: f32 = clamp(1.0 - sum.a - inNear, 0.0, 1.0);
            let cover: f32 = empty * clamp((midFill.a - 0.3) / 0.4, 0.0, 1.0);
            let stack: vec3f = (sum.rgb + midFill.rgb * cover + farColor * (empty - cover)) /
                max(sum.a + empty, 0.000001);
            result += (stack - result) * nearWeight;
        }
    }
    let alpha: f32 = clamp(nearLayer.a * BOKEH_TUNED_NEAR_ALPHA, 0.0, 1.0);
    // alpha / nearLayer.a, without a division by 0
    let opacity: f32 = min(BOKEH_TUNED_NEAR_ALPHA, 1.0 / max(nearLayer.a, 0.000001));
    result = result * (1.0 - alpha) + nearLayer.rgb * opacity;
    return vec4f(result, centerPixel.a);
}
