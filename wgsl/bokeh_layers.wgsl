// SPDX-License-Identifier: MIT
//
// Layered depth of field with polygonal bokeh, WGSL. Version 0.3.0. Put it after bokeh.wgsl.
//
//   `exact` blurs each pixel by its own CoC, so near objects keep a hard outline. Here they spread
//   over what is behind them, and what they hide is filled: docs/methods/layered.md.
//
// CONTRACT
//   Functions only: no bindings, no entry points.
//   In    the map of BokehSignedCoCMap: linear HDR colour, signed CoC in alpha.
//   Out   rgb = the picture, a = signed CoC.
//   Targets have the size of the image, or 1/2, 1/4, 1/8 of it, rounded up; linear filter, clamp,
//   blending off. RGBA16F; what uses two channels may be RG16F.
//   Places and CoC are in pixels here. s is a signed CoC: below 0 nearer than the focus.
//
//   function        size  reads                             writes
//   TileMax         1/8   map                               largest near and far CoC, light level
//   TileDilate      1/8   TileMax; then itself              the same of all tiles that reach here
//   Prefilter       1/2   map, tiles                        nearLayer, farLayer, kernelSums,
//                                                           leftovers (RG)
//   KernelReduce    1/8   kernelSums, leftovers             leftovers (RG), sums: of a tile
//   KernelRows      1/8   both, tiles                       the same of the tiles in its row
//   KernelColumns   1/8   both, tiles                       reach: tiles and leftovers; sizes (RG):
//                                                           CoC of the layers
//   Downsample      1/4   map, tiles, both layers, sizes   middle, far; nearLevel, farLevel: for
//                                                           wide lines of LayerFirst
//   HoleFill        1/4   middle, far, tiles                middle, back: without holes
//   LayerFirst      1/2   a layer, its level, sizes         exact polygon, first pass
//   LayerSecond     1/2   what that wrote, sizes            exact polygon, second pass
//   Composite       1     map, reach, both layers,          the picture
//                         middle, back
//
//   TileDilate runs twice, along rows, then along columns; LayerFirst and LayerSecond for the near
//   layer, then for the far one. LayersFirst and LayersSecond do both, of a square or a hexagon.

// -------------------------------------------------------------------------------------------------
// [11] layers
//
//   name                    default    range   meaning
//   BOKEH_LAYER_RINGS       2          1 .. 6  rings of the small gather at full size; one more
//                                              where no layer is, or with CUBIC 0 small ones
//   BOKEH_LAYER_CELLS       11         2 ..    most samples on an edge of a layer's hexagon; twice
//                                              as many on a square's, fewer on shorter edges
//   BOKEH_LAYER_CUBIC       1          0, 1    1: layers are enlarged by five fetches, not by one
//   BOKEH_MIN_LEVEL         0.00001    > 0     colour that is as good as black: what is darker does
//                                              not lower the level of light
//
//   Presets: define one before bokeh.wgsl, or set the constants instead; in WGSL set all three.
//
//   preset                  rings      cells   cubic
//   BOKEH_PRESET_LOW        1          11      0
//   BOKEH_PRESET_MEDIUM     2          11      1      the default
//   BOKEH_PRESET_HIGH       3          18      1
//   BOKEH_PRESET_ULTRA      4          18      1

override BOKEH_LAYER_RINGS: i32 = 2;
override BOKEH_LAYER_CELLS: i32 = 11;
override BOKEH_LAYER_CUBIC: i32 = 1;
const BOKEH_MIN_LEVEL: f32 = 0.00001;

// Layers: where the image lies in textures of one size, all in their texels
//   size          of the image
//   origin        its first texel: 0, or the viewport's
//   texel         1 / size of the textures
struct BokehGrid
{
    size: vec2f,
    origin: vec2f,
    texel: vec2f,
}

// Layers: what all passes need to know of the image and of this pixel
//   uv            of this pixel
//   size ..       as in BokehGrid; origin in multiples of 8, it counts with BOKEH_VIEWPORT 1
//   largest       possible CoC: maxCoC of the map times the image height, pixels
//   jitter        from BokehNoise, times its amount; 0 = none
struct BokehLayers
{
    uv: vec2f,
    size: vec2f,
    origin: vec2f,
    texel: vec2f,
    largest: f32,
    jitter: f32,
}

// Layers: settings for an image that fills its textures, without jitter
//   maxCoC        fraction of the image height, as in the CoC map
fn BokehMakeLayers(uv: vec2f, imageSize: vec2f, maxCoC: f32) -> BokehLayers
{
    var layers: BokehLayers;
    layers.uv = uv;
    layers.size = imageSize;
    layers.origin = vec2f(0.0, 0.0);
    layers.texel = 1.0 / imageSize;
    layers.largest = maxCoC * imageSize.y;
    layers.jitter = 0.0;
    return layers;
}

// Layers: the grid of the full size
fn BokehFullGrid(layers: BokehLayers) -> BokehGrid
{
    var grid: BokehGrid;
    grid.size = layers.size;
    grid.origin = layers.origin;
    grid.texel = layers.texel;
    return grid;
}

// Layers: the grid of textures of 1 / scale of the full size
fn BokehReducedGrid(layers: BokehLayers, scale: f32) -> BokehGrid
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

// Layers: texture uv of a place
//   place         texels of the grid, from the image's corner; the centre of the first is 0.5, 0.5
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

// Layers: one filtered fetch
fn BokehFetchGrid(tex: texture_2d<f32>, place: vec2f, grid: BokehGrid,
    BokehLinearClamp: sampler) -> vec4f
{
    return BokehFetchTexture(tex, BokehGridCoords(place, grid), BokehLinearClamp);
}

// Layers: the same at a distance from a pixel, with fewer instructions
//   uv            of the pixel in the image
//   offset        texels of the grid
fn BokehFetchAround(tex: texture_2d<f32>, uv: vec2f, offset: vec2f, grid: BokehGrid,
    BokehLinearClamp: sampler) -> vec4f
{
    var coords: vec2f = uv + offset * grid.texel;
    if (BOKEH_VIEWPORT > 0)
    {
        coords = BokehGridCoords(uv * grid.size + offset, grid);
    }
    return BokehFetchTexture(tex, coords, BokehLinearClamp);
}

// Layers: largest of the three channels
fn BokehBrightest(color: vec3f) -> f32
{
    return max(max(color.r, color.g), color.b);
}

// Layers: how fast a share grows with the CoC, for BokehLayerShare; 1 / pixels
//   largest       CoC of a neighbourhood, pixels: where it is `none` or less there is no layer,
//                 from `whole` up all of it
fn BokehLayerSlope(largest: f32, none: f32, whole: f32) -> f32
{
    let gate: f32 = clamp((largest - none) / (whole - none), 0.001, 1.0);
    return 5.0 / max(largest / gate, 2.0);
}

// Layers: the slope of the near layer
//   It sets in from 6 to 12 pixels. From 3 to 6, or 12 to 24, canopy_12 is worse (FLIP .138 for
//   .135): the gather is at full size, and has too few samples for more.
fn BokehNearSlope(largest: f32) -> f32
{
    return BokehLayerSlope(largest, 6.0, 12.0);
}

// Layers: the slope of the far layer
//   It sets in from 10 to 16 pixels. From 5 to 8 the half size shows (canopy_12: .147 for .135);
//   from 20 to 32 no scene is worse, but the gather has to reach farther.
fn BokehFarSlope(largest: f32) -> f32
{
    return BokehLayerSlope(largest, 10.0, 16.0);
}

// Layers: how much of a pixel is in a layer: none up to 0.4 of the largest CoC around, all from 0.6
//   From 0.2 to 0.4, what is half as near is blurred as the nearest (market_7: FLIP .184 for .180);
//   from 0.6 to 0.8, more of it is left to the gather, and grainy (.181).
//   CoC           pixels: -s for the near layer, s for the far one
fn BokehLayerShare(CoC: f32, slope: f32) -> f32
{
    return clamp(CoC * slope - 2.0, 0.0, 1.0);
}

// Layers: largest near and far CoC of 8 x 8 pixels; the mean logarithm of their brightness
//   returns       r = near, g = far, both >= 0, pixels; b = level
fn BokehTileMax(MapSamp: texture_2d<f32>, layers: BokehLayers, BokehLinearClamp: sampler) -> vec4f
{
    let first: vec2f = floor(layers.uv * ceil(layers.size / 8.0)) * 8.0 + vec2f(0.5, 0.5);
    var found: vec3f = vec3f(0.0, 0.0, 0.0);
    for (var y: i32 = 0; y < 8; y++)
    {
        for (var x: i32 = 0; x < 8; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            let pixel: vec4f = BokehFetchGrid(MapSamp, place, BokehFullGrid(layers),
                BokehLinearClamp);
            let s: f32 = pixel.a * layers.size.y;
            let level: f32 = log2(max(BokehBrightest(pixel.rgb), BOKEH_MIN_LEVEL));
            found = vec3f(max(found.r, -s), max(found.g, s), found.b + level);
        }
    }
    return vec4f(min(found.r, BOKEH_MAX_COLOR), min(found.g, BOKEH_MAX_COLOR), found.b / 64.0, 1.0);
}

// Layers: what a CoC of another tile counts for here
//   All of it where it reaches, with a margin for the linear filter; it fades out over one tile
//   more, so that nothing jumps as CoC change.
fn BokehReaching(CoC: vec2f, tiles: f32) -> vec2f
{
    let share: vec2f = CoC / 16.0 + 1.0 - max(tiles - 2.0, 0.0);
    return CoC * clamp(share, vec2f(0.0, 0.0), vec2f(1.0, 1.0));
}

// Layers: how many tiles the largest CoC reaches, with BokehReaching's margin; 127 at most
fn BokehReachTiles(layers: BokehLayers) -> f32
{
    return min(ceil(layers.largest / 16.0) + 2.0, 127.0);
}

// Layers: the largest CoC of any neighbouring tile that reaches this one; rows first, then columns
//   axis          (1, 0), then (0, 1)
fn BokehTileDilate(TilesSamp: texture_2d<f32>, axis: vec2f, layers: BokehLayers,
    BokehLinearClamp: sampler) -> vec4f
{
    let grid: BokehGrid = BokehReducedGrid(layers, 8.0);
    let radius: f32 = BokehReachTiles(layers);
    var found: vec2f = vec2f(0.0, 0.0);
    var level: f32 = 0.0;
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
        level += tile.b;
    }
    return vec4f(found, level / (2.0 * radius + 1.0), 1.0);
}

// Layers: what four pixels count for in their layer's CoC: bokeh comes from bright pixels
//   unit          1 / the level around
//   heaviest      10000 at most; times the largest CoC / 8 it has to fit into a half float. The
//                 least that BokehKernelColumns takes for a layer, 0.0001 of 6 pixels, is then no
//                 subnormal half either, which some GPUs flush to 0.
fn BokehBlurWeights(a: vec4f, b: vec4f, c: vec4f, d: vec4f, unit: f32, heaviest: f32) -> vec4f
{
    let brightest: vec4f = vec4f(BokehBrightest(a.rgb), BokehBrightest(b.rgb),
        BokehBrightest(c.rgb), BokehBrightest(d.rgb));
    return min(0.01 + brightest * unit, vec4f(heaviest, heaviest, heaviest, heaviest));
}

// Layers: what BokehPrefilter writes
//   nearLayer, farLayer  rgb times share, share
//   kernelSums    for the mean CoC of both layers: CoC / 8 times weight, weight
//   leftovers     rg = largest near and far CoC that is not wholly in its layer, pixels
struct BokehPrefiltered
{
    nearLayer: vec4f,
    farLayer: vec4f,
    kernelSums: vec4f,
    leftovers: vec4f,
}

// Layers: BokehLayerShare of four pixels
fn BokehLayerShares(CoC: vec4f, slope: f32) -> vec4f
{
    return clamp(CoC * slope - 2.0, vec4f(0.0, 0.0, 0.0, 0.0), vec4f(1.0, 1.0, 1.0, 1.0));
}

// Layers: what is around a near edge: rgb = darkest near colour, a = brightest of what is behind
//   found         of the pixels before this one
//   nearest       largest share: from a half of it a pixel is near
fn BokehSurroundings(found: vec4f, pixel: vec4f, nearShare: f32, nearest: f32) -> vec4f
{
    var result: vec4f = vec4f(min(found.rgb, pixel.rgb), found.a);
    if (nearShare < 0.5 * nearest)
    {
        result = vec4f(found.rgb, max(found.a, BokehBrightest(pixel.rgb)));
    }
    return result;
}

// Layers: a near pixel without the light from behind that antialiasing has put into it
//   around        from BokehSurroundings
//   returns       colour, share
fn BokehNearPixel(pixel: vec4f, nearShare: f32, around: vec4f) -> vec4f
{
    var result: vec4f = vec4f(pixel.rgb, nearShare);
    let brightest: f32 = BokehBrightest(pixel.rgb);
    let limit: f32 = BokehBrightest(around.rgb);
    if (around.a > brightest)
    {
        result = vec4f(min(pixel.rgb, around.rgb), nearShare);
        if (brightest > limit)
        {
            // the part of it that is not light from behind
            result = vec4f(result.rgb, nearShare * (around.a - brightest) / (around.a - limit));
        }
    }
    return result;
}

// Layers: near and far layer at half size, and what is known of their CoC
fn BokehPrefilter(MapSamp: texture_2d<f32>, ReachSamp: texture_2d<f32>, layers: BokehLayers,
    BokehLinearClamp: sampler) -> BokehPrefiltered
{
    let full: BokehGrid = BokehFullGrid(layers);
    let middle: vec2f = floor(layers.uv * ceil(layers.size / 2.0)) * 2.0 + vec2f(1.0, 1.0);
    let reach: vec4f = BokehFetchGrid(ReachSamp, middle / 8.0, BokehReducedGrid(layers, 8.0),
        BokehLinearClamp);
    let nearSlope: f32 = BokehNearSlope(reach.r);
    let farSlope: f32 = BokehFarSlope(reach.g);
    let unit: f32 = exp2(-reach.b);
    let heaviest: f32 = 500000.0 / max(layers.largest, 50.0);
    // the four pixels of this texel
    var a: vec4f = BokehFetchGrid(MapSamp, middle + vec2f(-0.5, -0.5), full, BokehLinearClamp);
    var b: vec4f = BokehFetchGrid(MapSamp, middle + vec2f(0.5, -0.5), full, BokehLinearClamp);
    var c: vec4f = BokehFetchGrid(MapSamp, middle + vec2f(-0.5, 0.5), full, BokehLinearClamp);
    var d: vec4f = BokehFetchGrid(MapSamp, middle + vec2f(0.5, 0.5), full, BokehLinearClamp);
    let s: vec4f = vec4f(a.a, b.a, c.a, d.a) * full.size.y;
    let nearShares: vec4f = BokehLayerShares(-s, nearSlope);
    let farShares: vec4f = BokehLayerShares(s, farSlope);
    let far: vec4f = vec4f(a.rgb, 1.0) * farShares.x + vec4f(b.rgb, 1.0) * farShares.y +
        vec4f(c.rgb, 1.0) * farShares.z + vec4f(d.rgb, 1.0) * farShares.w;
    var weights: vec4f = farShares * BokehBlurWeights(a, b, c, d, unit, heaviest);
    let one: vec4f = vec4f(1.0, 1.0, 1.0, 1.0);
    var sums: vec4f = vec4f(0.0, 0.0, dot(weights, s) / 8.0, dot(weights, one));
    let nearLeft: vec4f = -s * min(4.0 - 4.0 * nearShares, one);
    let farLeft: vec4f = s * min(4.0 - 4.0 * farShares, one);
    let left: vec2f = max(max(vec2f(nearLeft.x, farLeft.x), vec2f(nearLeft.y, farLeft.y)),
        max(vec2f(nearLeft.z, farLeft.z), vec2f(nearLeft.w, farLeft.w)));
    let nearest: f32 = max(max(nearShares.x, nearShares.y), max(nearShares.z, nearShares.w));
    var near: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    if (nearest > 0.0)
    {
        // an antialiased pixel of a near edge holds light of what is behind it: where that is
        // brighter, no near pixel stays brighter than the darkest one around
        var around: vec4f = vec4f(BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, 0.0);
        around = BokehSurroundings(around, a, nearShares.x, nearest);
        around = BokehSurroundings(around, b, nearShares.y, nearest);
        around = BokehSurroundings(around, c, nearShares.z, nearest);
        around = BokehSurroundings(around, d, nearShares.w, nearest);
        for (var y: i32 = 0; y < 4; y++)
        {
            for (var x: i32 = 0; x < 4; x++)
            {
                let offset: vec2f = vec2f(f32(x) - 1.5, f32(y) - 1.5);
                // but those four
                if (max(abs(offset.x), abs(offset.y)) > 1.0)
                {
                    let pixel: vec4f = BokehFetchGrid(MapSamp, middle + offset, full,
                        BokehLinearClamp);
                    around = BokehSurroundings(around, pixel, BokehLayerShare(-pixel.a *
                        full.size.y, nearSlope), nearest);
                }
            }
        }
        a = BokehNearPixel(a, nearShares.x, around);
        b = BokehNearPixel(b, nearShares.y, around);
        c = BokehNearPixel(c, nearShares.z, around);
        d = BokehNearPixel(d, nearShares.w, around);
        near = vec4f(a.rgb, 1.0) * a.a + vec4f(b.rgb, 1.0) * b.a + vec4f(c.rgb, 1.0) * c.a +
            vec4f(d.rgb, 1.0) * d.a;
        weights = vec4f(a.a, b.a, c.a, d.a) * BokehBlurWeights(a, b, c, d, unit, heaviest);
        sums = vec4f(-dot(weights, s) / 8.0, dot(weights, one), sums.z, sums.w);
    }
    var targets: BokehPrefiltered;
    targets.nearLayer = near * 0.25;
    targets.farLayer = far * 0.25;
    let most: f32 = BOKEH_MAX_COLOR;
    targets.kernelSums = min(sums * 0.25, vec4f(most, most, most, most));
    targets.leftovers = vec4f(clamp(left, vec2f(0.0, 0.0), vec2f(most, most)), 0.0, 1.0);
    return targets;
}

// Layers: what is known of the CoC of a tile, and of those around
//   leftovers     rg = the largest
//   sums          the mean of kernelSums
struct BokehKernels
{
    leftovers: vec4f,
    sums: vec4f,
}

// Layers: kernelSums and leftovers of BokehPrefilter for each tile
fn BokehKernelReduce(SumsSamp: texture_2d<f32>, LeftSamp: texture_2d<f32>, layers: BokehLayers,
    BokehLinearClamp: sampler) -> BokehKernels
{
    let halves: BokehGrid = BokehReducedGrid(layers, 2.0);
    let first: vec2f = floor(layers.uv * ceil(layers.size / 8.0)) * 4.0 + vec2f(0.5, 0.5);
    var sums: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var left: vec2f = vec2f(0.0, 0.0);
    for (var y: i32 = 0; y < 4; y++)
    {
        for (var x: i32 = 0; x < 4; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            sums += BokehFetchGrid(SumsSamp, place, halves, BokehLinearClamp);
            left = max(left, BokehFetchGrid(LeftSamp, place, halves, BokehLinearClamp).rg);
        }
    }
    var targets: BokehKernels;
    targets.leftovers = vec4f(left, 0.0, 1.0);
    targets.sums = sums / 16.0;
    return targets;
}

// Layers: BokehKernelRows along any axis
//   axis          (1, 0) or (0, 1)
fn BokehKernelAlong(LeftSamp: texture_2d<f32>, SumsSamp: texture_2d<f32>,
    ReachSamp: texture_2d<f32>, axis: vec2f, layers: BokehLayers,
    BokehLinearClamp: sampler) -> BokehKernels
{
    let grid: BokehGrid = BokehReducedGrid(layers, 8.0);
    let reach: vec2f = BokehFetchGrid(ReachSamp, layers.uv * grid.size, grid, BokehLinearClamp).rg;
    // in tiles; twice as wide, a blur takes its size from too far away (market_7: FLIP .193 for
    // .180), half as wide, the kernel changes within one light
    let sigma: vec2f = max(reach * 0.0375, vec2f(0.6, 0.6));
    let radius: f32 = BokehReachTiles(layers);
    var sums: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var left: vec2f = vec2f(0.0, 0.0);
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
        left = max(left, BokehReaching(BokehFetchGrid(LeftSamp, place, grid, BokehLinearClamp).rg,
            abs(tiles)));
        total += weight;
    }
    var targets: BokehKernels;
    targets.leftovers = vec4f(left, 0.0, 1.0);
    targets.sums = sums / vec4f(total.x, total.x, total.y, total.y);
    return targets;
}

// Layers: leftovers and sums of the tiles around, along rows
//   LeftSamp, SumsSamp  what BokehKernelReduce wrote
//   returns       leftovers: the largest that reach here; sums: their mean, by a Gaussian as wide
//                 as the CoC that reach here
fn BokehKernelRows(LeftSamp: texture_2d<f32>, SumsSamp: texture_2d<f32>, ReachSamp: texture_2d<f32>,
    layers: BokehLayers, BokehLinearClamp: sampler) -> BokehKernels
{
    return BokehKernelAlong(LeftSamp, SumsSamp, ReachSamp, vec2f(1.0, 0.0), layers,
        BokehLinearClamp);
}

// Layers: what BokehKernelColumns writes
//   reach         near and far CoC that reach here, near and far leftovers that do; pixels
//   sizes         rg = CoC that the near and the far layer are blurred by, 0 where there is none;
//                 pixels
struct BokehSizes
{
    reach: vec4f,
    sizes: vec4f,
}

// Layers: the same along columns, and the CoC that the layers are blurred by
//   One kernel for a neighbourhood and layer is what makes its blur separable.
//   LeftSamp, SumsSamp  what BokehKernelRows wrote
fn BokehKernelColumns(LeftSamp: texture_2d<f32>, SumsSamp: texture_2d<f32>,
    ReachSamp: texture_2d<f32>, layers: BokehLayers, BokehLinearClamp: sampler) -> BokehSizes
{
    let grid: BokehGrid = BokehReducedGrid(layers, 8.0);
    let reach: vec2f = BokehFetchGrid(ReachSamp, layers.uv * grid.size, grid, BokehLinearClamp).rg;
    let kernels: BokehKernels = BokehKernelAlong(LeftSamp, SumsSamp, ReachSamp, vec2f(0.0, 1.0),
        layers, BokehLinearClamp);
    let sums: vec4f = kernels.sums;
    var sizes: vec2f = vec2f(0.0, 0.0);
    if (sums.g > 0.0001 && reach.r > 6.0)
    {
        sizes = vec2f(8.0 * sums.r / sums.g, 0.0);
    }
    if (sums.a > 0.0001 && reach.g > 10.0)
    {
        sizes = vec2f(sizes.x, 8.0 * sums.b / sums.a);
    }
    var targets: BokehSizes;
    targets.reach = vec4f(reach, kernels.leftovers.rg);
    targets.sizes = vec4f(sizes, 0.0, 1.0);
    return targets;
}

// -------------------------------------------------------------------------------------------------
// [12] quarter size: levels of the layers, and what the near layer hides

// Layers: CoC that the near and the far layer are blurred by here, pixels
fn BokehLayerSizes(SizesSamp: texture_2d<f32>, layers: BokehLayers,
    BokehLinearClamp: sampler) -> vec2f
{
    let place: vec2f = layers.uv * ceil(layers.size / 2.0) / 4.0;
    return BokehFetchGrid(SizesSamp, place, BokehReducedGrid(layers, 8.0), BokehLinearClamp).rg;
}

// Layers: what a layer is blurred by
//   Averaging 2 x 2 pixels and the linear filter blur by themselves: 9 is their share of the
//   squared CoC, 14 more that of a level. With 0 layers are too soft (market_7: FLIP .186 for
//   .180), with 16 near ones too sharp (street_11: .044 for .041). Far lights: small ones keep
//   their size by less (overlap with a decagon of 20 pixels: .89 for .87), wide ones have edges
//   as hard as the truth's by more (market_7: .179 for .180).
//   sizes         from BokehLayerSizes
//   returns       x = CoC, texels of the half size; 0.5 where there is no layer, or nothing to do
//                 (compare with 0.51: a GPU's root of 0.25 may be a little more)
//                 y = spacing of the samples on an edge: an edge of a hexagon has at most
//                 BOKEH_LAYER_CELLS; 1 or more
//                 z = -1, or where the first pass reads the layer's level: weight of the texels
//                 beside the middle one of that, so that it has a zero near 1 / spacing. More
//                 makes edges soft, less leaves dots (hexagon, 216 pixels: ripple .16 with 1, .24
//                 with 0, .05 so). Near lights have harder edges: from 1.15 on market_7 has .182
//                 for .179, from 2 on dots show.
fn BokehLayerBlur(sizes: vec2f, isFar: bool, polygon: BokehPolygon) -> vec3f
{
    var CoC: f32 = 0.5 * sizes.r;
    var least: f32 = 1.5;
    var own: f32 = 9.0;
    if (isFar)
    {
        CoC = 0.5 * sizes.g;
        least = 1.15;
        own = clamp(0.06 * CoC * CoC, 7.5, 22.0);
    }
    // a square has one line where others have more
    var spacing: f32 = 0.5 * CoC / f32(BOKEH_LAYER_CELLS);
    var hard: f32 = 0.4;
    if (polygon.sides < 6)
    {
        spacing = 0.354 * CoC / f32(BOKEH_LAYER_CELLS);
        hard = 0.2;
    }
    var side: f32 = -1.0;
    if (spacing > least)
    {
        side = clamp(0.25 * spacing - hard, 0.0, 0.6);
        own += 14.0 + 154.0 * side / (1.0 + 2.0 * side);
    }
    return vec3f(sqrt(max(CoC * CoC - own, 0.25)), max(spacing, 1.0), side);
}

// Layers: a texel of a layer's level
//   center        texels of the half size
//   side          z of BokehLayerBlur
fn BokehLevel(LayerSamp: texture_2d<f32>, center: vec2f, side: f32, layers: BokehLayers,
    BokehLinearClamp: sampler) -> vec4f
{
    let halves: BokehGrid = BokehReducedGrid(layers, 2.0);
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    if (side > 0.0)
    {
        for (var y: i32 = 0; y < 3; y++)
        {
            for (var x: i32 = 0; x < 3; x++)
            {
                let offset: vec2f = vec2f(f32(x) - 1.0, f32(y) - 1.0);
                let weight: vec2f = 1.0 - (1.0 - side) * abs(offset);
                sum += BokehFetchGrid(LayerSamp, center + 2.0 * offset, halves, BokehLinearClamp) *
                    (weight.x * weight.y);
            }
        }
        sum = sum / ((1.0 + 2.0 * side) * (1.0 + 2.0 * side));
    }
    else
    {
        sum = BokehFetchGrid(LayerSamp, center, halves, BokehLinearClamp);
    }
    return sum;
}

// Layers: what BokehDownsample writes
//   middle, far   what is between the layers, and the far layer: rgb times weight, weight
//   nearLevel, farLevel  the layers, as BokehPrefilter has them
struct BokehLevels
{
    middle: vec4f,
    far: vec4f,
    nearLevel: vec4f,
    farLevel: vec4f,
}

// Layers: levels of the layers; and what is not near, as weighted sums
//   Bright pixels weigh less: a light would fill the whole hole.
fn BokehDownsample(MapSamp: texture_2d<f32>, ReachSamp: texture_2d<f32>, NearSamp: texture_2d<f32>,
    FarSamp: texture_2d<f32>, SizesSamp: texture_2d<f32>, polygon: BokehPolygon,
    layers: BokehLayers, BokehLinearClamp: sampler) -> BokehLevels
{
    let full: BokehGrid = BokehFullGrid(layers);
    let first: vec2f = floor(layers.uv * ceil(layers.size / 4.0)) * 4.0 + vec2f(0.5, 0.5);
    let middlePlace: vec2f = first + vec2f(1.5, 1.5);
    let reach: vec4f = BokehFetchGrid(ReachSamp, middlePlace / 8.0, BokehReducedGrid(layers, 8.0),
        BokehLinearClamp);
    let nearSlope: f32 = BokehNearSlope(reach.r);
    let farSlope: f32 = BokehFarSlope(reach.g);
    let unit: f32 = exp2(-reach.b);
    var middle: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var far: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var y: i32 = 0; y < 4; y++)
    {
        for (var x: i32 = 0; x < 4; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            let pixel: vec4f = BokehFetchGrid(MapSamp, place, full, BokehLinearClamp);
            let s: f32 = pixel.a * full.size.y;
            // what is partly near is hardly background: a near light would shine through itself
            let nearShare: f32 = BokehLayerShare(-s, nearSlope);
            let notNear: f32 = max(1.0 - 2.0 * nearShare, 0.0625 - 0.0625 * nearShare);
            let farShare: f32 = BokehLayerShare(s, farSlope);
            let weight: f32 = notNear / (1.0 + BokehBrightest(pixel.rgb) * unit);
            middle += vec4f(pixel.rgb, 1.0) * (weight * (1.0 - farShare));
            far += vec4f(pixel.rgb, 1.0) * (weight * farShare);
        }
    }
    let center: vec2f = 0.5 * middlePlace;
    let sizes: vec2f = BokehLayerSizes(SizesSamp, layers, BokehLinearClamp);
    var targets: BokehLevels;
    targets.middle = middle / 16.0;
    targets.far = far / 16.0;
    targets.nearLevel = BokehLevel(NearSamp, center, BokehLayerBlur(sizes, false, polygon).z,
        layers, BokehLinearClamp);
    targets.farLevel = BokehLevel(FarSamp, center, BokehLayerBlur(sizes, true, polygon).z, layers,
        BokehLinearClamp);
    return targets;
}

// Layers: direction of edge k, as drawn, but not squeezed
fn BokehEdgeDirection(k: i32, polygon: BokehPolygon) -> vec2f
{
    let outwards: vec2f = BokehTurn(f32(k), polygon);
    return BokehRotated(vec2f(-outwards.y, outwards.x), polygon.axis);
}

// Layers: how many samples of a ring are on each edge of the polygon
//   6 on the first ring, 12 on the second and so on, shared out among the sides: all rings are
//   sampled as densely. A polygon of more sides than that has one a side.
fn BokehOnEdge(ring: i32, polygon: BokehPolygon) -> i32
{
    return i32(max(6.0 * f32(ring) / f32(polygon.sides) + 0.5, 1.0));
}

// Layers: shares of what is between the layers and of the far layer: the weights of BokehDownsample
//   without those of brightness
fn BokehHoleShares(middle: vec4f, far: vec4f, unit: f32) -> vec2f
{
    return vec2f(middle.a + BokehBrightest(middle.rgb) * unit, far.a + BokehBrightest(far.rgb) *
        unit);
}

// Layers: what BokehHoleFill writes
//   middle        what is between the layers; a = its share in what is around
//   back          the far layer
struct BokehFilled
{
    middle: vec4f,
    back: vec4f,
}

// Layers: holes filled with what is around; the nearest counts most
//   MiddleSamp, FarSamp  what BokehDownsample wrote
fn BokehHoleFill(MiddleSamp: texture_2d<f32>, FarSamp: texture_2d<f32>, ReachSamp: texture_2d<f32>,
    polygon: BokehPolygon, layers: BokehLayers, BokehLinearClamp: sampler) -> BokehFilled
{
    let grid: BokehGrid = BokehReducedGrid(layers, 4.0);
    let center: vec2f = layers.uv * grid.size;
    let tile: vec4f = BokehFetchGrid(ReachSamp, center / 2.0, BokehReducedGrid(layers, 8.0),
        BokehLinearClamp);
    let reach: f32 = tile.r;
    let unit: f32 = exp2(-tile.b);
    var corner: vec2f = BokehRotated(polygon.corner, polygon.axis);
    var direction: vec2f = BokehEdgeDirection(1, polygon);
    let turn: vec2f = BokehTurn(1.0, polygon);
    var middle: vec4f = BokehFetchGrid(MiddleSamp, center, grid, BokehLinearClamp);
    var far: vec4f = BokehFetchGrid(FarSamp, center, grid, BokehLinearClamp);
    var shares: vec2f = BokehHoleShares(middle, far, unit);
    for (var ring: i32 = 1; ring < 3; ring++)
    {
        // no near layer, no holes
        if (reach < 6.0)
        {
            break;
        }
        // diameter in quarter pixels; the rings reach half the CoC
        let diameter: f32 = max(reach / 8.0, 2.0) * f32(ring);
        let weight: f32 = 1.0 / (1.0 + 4.0 * diameter * diameter);
        let scale: vec2f = vec2f(polygon.squeeze * diameter, diameter);
        let onEdge: i32 = BokehOnEdge(ring, polygon);
        for (var edge: i32 = 1; edge <= polygon.sides; edge++)
        {
            let along: vec2f = direction * (BokehEdgeLength(edge, polygon) / f32(onEdge));
            for (var i: i32 = 0; i < onEdge; i++)
            {
                let place: vec2f = center + corner * scale;
                let middleTexel: vec4f = BokehFetchGrid(MiddleSamp, place, grid, BokehLinearClamp);
                let farTexel: vec4f = BokehFetchGrid(FarSamp, place, grid, BokehLinearClamp);
                middle += middleTexel * weight;
                far += farTexel * weight;
                shares += BokehHoleShares(middleTexel, farTexel, unit) * weight;
                corner += along;
            }
            direction = BokehRotated(direction, turn);
        }
    }
    let both: vec3f = (middle.rgb + far.rgb) / max(middle.a + far.a, 0.000001);
    let share: f32 = shares.r / max(shares.r + shares.g, 0.000001);
    var targets: BokehFilled;
    targets.middle = vec4f(both, share);
    targets.back = vec4f(both, 1.0);
    if (middle.a > 0.000001)
    {
        targets.middle = vec4f(middle.rgb / middle.a, share);
    }
    if (far.a > 0.000001)
    {
        targets.back = vec4f(far.rgb / far.a, 1.0);
    }
    return targets;
}

// -------------------------------------------------------------------------------------------------
// [13] polygons at half size
//
//   The parallelograms of [5], without weights and without a leakage test: a layer has nothing in
//   it that must not spread. All four channels are blurred alike.

// Layers: mean of the samples along edge k; in the second pass times its parallelograms' area
//   blur          from BokehLayerBlur; LevelSamp is read where its z says so
fn BokehLayerLine(tex: texture_2d<f32>, LevelSamp: texture_2d<f32>, k: i32, polygon: BokehPolygon,
    secondPass: bool, blur: vec3f, layers: BokehLayers, BokehLinearClamp: sampler) -> vec4f
{
    var scale: f32 = 2.0;
    if (blur.z > -0.5)
    {
        scale = 4.0;
    }
    let grid: BokehGrid = BokehReducedGrid(layers, scale);
    let segment: vec4f = BokehEdgeLine(k, polygon, secondPass) * blur.x;
    let cells: f32 = max(2.0 * length(segment.zw) / blur.y, 2.0);
    let phase: f32 = 0.5 + layers.jitter * min(blur.y - 1.0, 1.0);
    let first: vec2f = (layers.uv * ceil(layers.size / 2.0) + segment.xy - segment.zw) * (2.0 /
        scale);
    let cellLength: vec2f = segment.zw * (4.0 / (scale * cells));
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var i: i32 = 0; i < i32(ceil(cells)); i++)
    {
        let cell: f32 = clamp(cells - f32(i), 0.0, 1.0);
        let place: vec2f = first + cellLength * (f32(i) + cell * phase);
        var texel: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        if (blur.z > -0.5)
        {
            texel = BokehFetchGrid(LevelSamp, place, grid, BokehLinearClamp);
        }
        else
        {
            texel = BokehFetchGrid(tex, place, grid, BokehLinearClamp);
        }
        sum += cell * texel;
    }
    sum = sum / cells;
    if (secondPass)
    {
        sum *= BokehEdgeArea(k, polygon);
    }
    return sum;
}

// Layers: what the first pass writes for edge k: the lines along the edges before it, weighted by
//   their parallelograms
fn BokehLayerTarget(k: i32, polygon: BokehPolygon, L1: vec4f, L2: vec4f, L3: vec4f,
    L4: vec4f) -> vec4f
{
    let w: vec4f = BokehEdgeWeights(k, polygon);
    return (L1 * w.x + L2 * w.y + L3 * w.z + L4 * w.w) / (w.x + w.y + w.z + w.w);
}

// Layers: first pass over a layer
//   LayerSamp     nearLayer or farLayer of BokehPrefilter
//   LevelSamp     nearLevel or farLevel of BokehDownsample
//   sizes         from BokehLayerSizes
//   isFar         false: the near layer
//   last, returns as of BokehExactFirst
fn BokehLayerFirst(LayerSamp: texture_2d<f32>, LevelSamp: texture_2d<f32>, sizes: vec2f,
    isFar: bool, last: i32, polygon: BokehPolygon, layers: BokehLayers,
    BokehLinearClamp: sampler) -> BokehTargets
{
    let center: vec2f = layers.uv * ceil(layers.size / 2.0);
    let none: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var targets: BokehTargets;
    let blur: vec3f = BokehLayerBlur(sizes, isFar, polygon);
    if (blur.x > 0.51)
    {
        var L2: vec4f = none;
        var L3: vec4f = none;
        var L4: vec4f = none;
        let L1: vec4f = BokehLayerLine(LayerSamp, LevelSamp, 1, polygon, false, blur, layers,
            BokehLinearClamp);
        if (last > 2)
        {
            L2 = BokehLayerLine(LayerSamp, LevelSamp, 2, polygon, false, blur, layers,
                BokehLinearClamp);
        }
        if (last > 3)
        {
            L3 = BokehLayerLine(LayerSamp, LevelSamp, 3, polygon, false, blur, layers,
                BokehLinearClamp);
        }
        if (last > 4)
        {
            L4 = BokehLayerLine(LayerSamp, LevelSamp, 4, polygon, false, blur, layers,
                BokehLinearClamp);
        }
        targets.edge2 = L1;
        targets.edge3 = BokehLayerTarget(3, polygon, L1, L2, none, none);
        targets.edge4 = BokehLayerTarget(4, polygon, L1, L2, L3, none);
        targets.edge5 = BokehLayerTarget(5, polygon, L1, L2, L3, L4);
    }
    else
    {
        targets.edge2 = BokehFetchGrid(LayerSamp, center, BokehReducedGrid(layers, 2.0),
            BokehLinearClamp);
        targets.edge3 = targets.edge2;
        targets.edge4 = targets.edge2;
        targets.edge5 = targets.edge2;
    }
    return targets;
}

// Layers: second pass: the finished layer
//   Edge2Samp ..  what the first pass wrote; where there are fewer, any of them: it is not read
//   returns       rgb times share, share
fn BokehLayerSecond(Edge2Samp: texture_2d<f32>, Edge3Samp: texture_2d<f32>,
    Edge4Samp: texture_2d<f32>, Edge5Samp: texture_2d<f32>, sizes: vec2f, isFar: bool,
    polygon: BokehPolygon, layers: BokehLayers, BokehLinearClamp: sampler) -> vec4f
{
    let center: vec2f = layers.uv * ceil(layers.size / 2.0);
    var result: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    let blur: vec3f = BokehLayerBlur(sizes, isFar, polygon);
    let own: vec3f = vec3f(blur.x, blur.y, -1.0);
    if (blur.x > 0.51)
    {
        result = BokehLayerLine(Edge2Samp, Edge2Samp, 2, polygon, true, own, layers,
            BokehLinearClamp);
        if (polygon.sides > 4)
        {
            result += BokehLayerLine(Edge3Samp, Edge3Samp, 3, polygon, true, own, layers,
                BokehLinearClamp);
        }
        if (polygon.sides > 6)
        {
            result += BokehLayerLine(Edge4Samp, Edge4Samp, 4, polygon, true, own, layers,
                BokehLinearClamp);
        }
        if (polygon.sides > 8)
        {
            result += BokehLayerLine(Edge5Samp, Edge5Samp, 5, polygon, true, own, layers,
                BokehLinearClamp);
        }
        result = result / polygon.area;
    }
    else
    {
        result = BokehFetchGrid(Edge2Samp, center, BokehReducedGrid(layers, 2.0), BokehLinearClamp);
    }
    return result;
}

// Layers: what BokehLayersFirst writes; the two of edge 3 are of a hexagon
struct BokehLayersTargets
{
    near2: vec4f,
    far2: vec4f,
    near3: vec4f,
    far3: vec4f,
}

// Layers: BokehLayerFirst of both layers, for a square or a hexagon
fn BokehLayersFirst(NearSamp: texture_2d<f32>, NearLevelSamp: texture_2d<f32>,
    FarSamp: texture_2d<f32>, FarLevelSamp: texture_2d<f32>, sizes: vec2f, polygon: BokehPolygon,
    layers: BokehLayers, BokehLinearClamp: sampler) -> BokehLayersTargets
{
    let last: i32 = polygon.sides / 2;
    let near: BokehTargets = BokehLayerFirst(NearSamp, NearLevelSamp, sizes, false, last, polygon,
        layers, BokehLinearClamp);
    let far: BokehTargets = BokehLayerFirst(FarSamp, FarLevelSamp, sizes, true, last, polygon,
        layers, BokehLinearClamp);
    var targets: BokehLayersTargets;
    targets.near2 = near.edge2;
    targets.far2 = far.edge2;
    targets.near3 = near.edge3;
    targets.far3 = far.edge3;
    return targets;
}

// Layers: the finished layers
struct BokehBlurred
{
    near: vec4f,
    far: vec4f,
}

// Layers: BokehLayerSecond of both; of a square the two of edge 3 are any textures: not read
fn BokehLayersSecond(Near2Samp: texture_2d<f32>, Far2Samp: texture_2d<f32>,
    Near3Samp: texture_2d<f32>, Far3Samp: texture_2d<f32>, sizes: vec2f, polygon: BokehPolygon,
    layers: BokehLayers, BokehLinearClamp: sampler) -> BokehBlurred
{
    var targets: BokehBlurred;
    targets.near = BokehLayerSecond(Near2Samp, Near3Samp, Near3Samp, Near3Samp, sizes, false,
        polygon, layers, BokehLinearClamp);
    targets.far = BokehLayerSecond(Far2Samp, Far3Samp, Far3Samp, Far3Samp, sizes, true, polygon,
        layers, BokehLinearClamp);
    return targets;
}

// -------------------------------------------------------------------------------------------------
// [14] the picture

// Layers: a half-size layer at a place of the full size
//   Catmull-Rom without its corners, five fetches: bilinear makes the edges of polygons ragged. It
//   overshoots, so it is clamped to its five fetches, or lights had dark rims and too much light.
//
//            t          w0     weights from the texel before to the second one after;
//          l c r      w1 + w2  c, the middle fetch, takes two by two texels
//            b          w3
//
//   place         texels of the half size
fn BokehFetchLayer(LayerSamp: texture_2d<f32>, place: vec2f, halves: BokehGrid,
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
        let c: vec4f = BokehFetchGrid(LayerSamp, inner, halves, BokehLinearClamp);
        let l: vec4f = BokehFetchGrid(LayerSamp, vec2f(texel.x - 1.0, inner.y), halves,
            BokehLinearClamp);
        let r: vec4f = BokehFetchGrid(LayerSamp, vec2f(texel.x + 2.0, inner.y), halves,
            BokehLinearClamp);
        let t: vec4f = BokehFetchGrid(LayerSamp, vec2f(inner.x, texel.y - 1.0), halves,
            BokehLinearClamp);
        let b: vec4f = BokehFetchGrid(LayerSamp, vec2f(inner.x, texel.y + 2.0), halves,
            BokehLinearClamp);
        let side: vec2f = w12.yx / (w12.x * w12.y + (w0.x + w3.x) * w12.y + (w0.y + w3.y) * w12.x);
        let sum: vec4f = c * (w12.x * side.x) + l * (w0.x * side.x) + r * (w3.x * side.x) + t *
            (w0.y * side.y) + b * (w3.y * side.y);
        result = clamp(sum, min(min(c, min(l, r)), min(t, b)), max(max(c, max(l, r)), max(t, b)));
    }
    else
    {
        result = BokehFetchGrid(LayerSamp, place, halves, BokehLinearClamp);
    }
    return result;
}

// Layers: 1 / radius^2 of what two CoC spread over, pixels
//   For r = CoC / 2 that is (r^2 + 0.6) / r^4: pixels and the linear filter blur by themselves. 0.6
//   suits input of one sample per pixel, 1.2 antialiased input.
fn BokehSpreadInverse(CoC: vec2f) -> vec2f
{
    let inverse: vec2f = 1.0 / max(CoC * CoC, vec2f(0.000001, 0.000001));
    return inverse * (inverse * 9.6 + 4.0);
}

// Layers: outer border of a ring of the gather, pixels; 0: of the middle
//   spacing       between rings
//   narrowing     0: evenly spaced; 1: closer to the middle, but not closer than a pixel
fn BokehRingBorder(ring: i32, radius: f32, spacing: f32, narrowing: f32) -> f32
{
    let even: f32 = spacing * (f32(ring) + 0.5);
    return max(even + even * (even / radius - 1.0) * narrowing, min(even, f32(ring) + 0.5));
}

// Layers: the gather around a pixel, as far as it has come
//   sum, front    colour and weight of all that it found, and of what is in front of this pixel
//   farWeight     of what it found in the far layer
//   s, inverse, nearShare  of this pixel: signed CoC, BokehSpreadInverse, share of the near layer
//   slopes        of the near and the far layer; snapping: 0 = linear filter, 100 = nearest texel
//   bounds        of a sample's 1 / radius^2: what spreads over the radius, over the middle
//   inner         where the next ring begins, pixels
struct BokehGather
{
    sum: vec4f,
    front: vec4f,
    farWeight: f32,
    s: f32,
    inverse: f32,
    nearShare: f32,
    slopes: vec2f,
    snapping: f32,
    bounds: vec2f,
    inner: f32,
}

// Layers: one more ring of the gather
//   onEdge        samples on an edge; where they and the polygon's sides are literals, compilers
//                 write both loops out
//   outer         where it ends, pixels
fn BokehGatherRing(before: BokehGather, MapSamp: texture_2d<f32>, ring: i32, onEdge: i32,
    outer: f32, polygon: BokehPolygon, layers: BokehLayers,
    BokehLinearClamp: sampler) -> BokehGather
{
    //   |-----|--.--|--.--|     a sample counts by as much of its ring as its own disc
    //  middle   1     2         covers, over that disc
    var gather: BokehGather = before;
    let full: BokehGrid = BokehFullGrid(layers);
    let none: vec2f = vec2f(0.0, 0.0);
    let whole: vec2f = vec2f(1.0, 1.0);
    // in the middle with two rings; with more the first, which is turned, counts for less (HIGH
    // with 0.5: street_11 .0420 for .0416)
    let outwards: f32 = 0.58 - 0.04 * f32(BOKEH_LAYER_RINGS);
    let current: f32 = gather.inner + (outer - gather.inner) * outwards;
    let innerSquare: f32 = gather.inner * gather.inner;
    let area: f32 = outer * outer - innerSquare;
    var phase: f32 = layers.jitter * clamp(current / f32(ring) - 1.0, 0.0, 1.0);
    if (ring == 1)
    {
        // between the corners, where the next ring has gaps (canopy_12: .138 for .140)
        phase += 0.5;
    }
    // the upright polygon's x and y, in pixels: what is done with those is known to compilers
    let right: vec2f = vec2f(polygon.axis.x * polygon.squeeze, polygon.axis.y) * current;
    let upwards: vec2f = vec2f(-polygon.axis.y * polygon.squeeze, polygon.axis.x) * current;
    var corner: vec2f = polygon.corner * 2.0;
    let turn: vec2f = BokehTurn(1.0, polygon);
    var direction: vec2f = vec2f(-turn.y, turn.x) * 2.0;
    // half of the edges: the others are opposite to them, sample by sample
    for (var edge: i32 = 1; edge <= polygon.sides / 2; edge++)
    {
        let alongEdge: vec2f = direction * BokehEdgeLength(edge, polygon);
        let along: vec2f = alongEdge / f32(onEdge);
        // of its edges each gets what lies in the triangle from the middle to it
        let cell: f32 = (corner.x * along.y - corner.y * along.x) / (8.0 * polygon.area);
        for (var i: i32 = 0; i < onEdge; i++)
        {
            let upright: vec2f = corner + along * (f32(i) + phase);
            let place: vec2f = right * upright.x + upwards * upright.y;
            let texel: vec2f = floor(place);
            // steeper between two texels than the linear filter is
            let offset: vec2f = texel + clamp((place - texel) * (gather.snapping + 1.0) - 0.5 *
                gather.snapping, none, whole);
            // both at once: this one and the one opposite to it
            let pixel: vec4f = BokehFetchAround(MapSamp, layers.uv, offset, full, BokehLinearClamp);
            let other: vec4f = BokehFetchAround(MapSamp, layers.uv, -offset, full,
                BokehLinearClamp);
            let CoC: vec2f = vec2f(pixel.a, other.a) * full.size.y;
            let isBehind: vec2f = clamp(CoC * 2.0 - 2.0 * gather.s, none, whole) * (1.0 -
                gather.nearShare);
            var inverse: vec2f = BokehSpreadInverse(CoC);
            inverse += (gather.inverse - inverse) * isBehind;
            inverse = clamp(inverse, gather.bounds.xx, gather.bounds.yy);
            var covers: vec2f = cell * max(min(1.0 - innerSquare * inverse, area * inverse), none);
            let inFar: vec2f = covers * clamp(CoC * gather.slopes.y - 2.0, none, whole);
            covers = covers * (1.0 - clamp(CoC * -gather.slopes.x - 2.0, none, whole)) - inFar;
            gather.farWeight += inFar.x + inFar.y;
            let part: vec4f = vec4f(pixel.rgb, 1.0) * covers.x;
            let otherPart: vec4f = vec4f(other.rgb, 1.0) * covers.y;
            gather.sum += part + otherPart;
            let isFront: vec2f = clamp(gather.s - 0.5 - CoC, none, whole);
            gather.front += part * isFront.x + otherPart * isFront.y;
        }
        corner += alongEdge;
        direction = BokehRotated(direction, turn);
    }
    gather.inner = outer;
    return gather;
}

// Layers: the last pass: a gather over what is in no layer, and all of it together
//   Each sample counts by its own CoC, spread over the area that it covers; from behind this
//   pixel's surface by this pixel's CoC. What is in a layer is left out; the layers are put over it
//   and behind it. The table at the top says what it reads.
//   returns       rgb = the picture, a = signed CoC of this pixel
fn BokehComposite(MapSamp: texture_2d<f32>, TilesSamp: texture_2d<f32>, NearSamp: texture_2d<f32>,
    FarSamp: texture_2d<f32>, MiddleSamp: texture_2d<f32>, BackSamp: texture_2d<f32>,
    polygon: BokehPolygon, layers: BokehLayers, BokehLinearClamp: sampler) -> vec4f
{
    let full: BokehGrid = BokehFullGrid(layers);
    let center: vec2f = layers.uv * full.size;
    let centerPixel: vec4f = BokehFetchTexel(MapSamp, BokehToTexture(layers.uv));
    let tile: vec4f = BokehFetchGrid(TilesSamp, center / 8.0, BokehReducedGrid(layers, 8.0),
        BokehLinearClamp);
    var result: vec3f = centerPixel.rgb;
    // up to a CoC of one pixel nothing spreads
    if (max(tile.r, tile.g) > 1.0)
    {
        var gather: BokehGather;
        let s: f32 = centerPixel.a * full.size.y;
        gather.s = s;
        gather.slopes = vec2f(BokehNearSlope(tile.r), BokehFarSlope(tile.g));
        let nearShare: f32 = BokehLayerShare(-s, gather.slopes.x);
        let farShare: f32 = BokehLayerShare(s, gather.slopes.y);
        gather.nearShare = nearShare;
        gather.inverse = BokehSpreadInverse(vec2f(s, s)).x;
        // the gather reaches as far as what is in no layer
        let restRadius: f32 = clamp(16.0 - 16.0 * farShare, 0.0, 1.0) * (1.0 - nearShare) /
            sqrt(gather.inverse);
        let radius: f32 = max(max(restRadius, 0.01), 0.5 * max(tile.b, tile.a * farShare));
        let narrowing: f32 = clamp(radius / max(restRadius, 1.0) - 1.0, 0.0, 1.0);
        // where no layer is, its fetches are free for one more ring (moderate blur: .112 for .114);
        // without CUBIC also where layers are small (LOW, canopy_12: .150 for .156)
        var rings: f32 = f32(BOKEH_LAYER_RINGS);
        if (max(tile.g, tile.r + 4.0) <= 14.0 - 4.0 * f32(BOKEH_LAYER_CUBIC))
        {
            rings += 1.0;
        }
        // rings closer than a pixel find nothing new; .499: the last ends at the radius
        let spacing: f32 = max(min(radius / 1.499, 1.0), radius / (rings + 0.499));
        gather.inner = BokehRingBorder(0, radius, spacing, narrowing);
        // Samples within half a pixel are this pixel again: no ring.
        if (radius < 0.5)
        {
            gather.inner = radius;
        }
        // what spreads less than the inner radius of the first ring reaches no other pixel
        gather.bounds = 1.0 / vec2f(radius * radius, gather.inner * gather.inner);
        let weight: f32 = (1.0 - nearShare) * min(gather.inverse / gather.bounds.y, 1.0);
        // of what is in the far layer, that layer takes the place: one of its pixels alone would
        // shine
        gather.farWeight = weight * farShare;
        gather.sum = vec4f(centerPixel.rgb, 1.0) * (weight - gather.farWeight);
        gather.front = vec4f(0.0, 0.0, 0.0, 0.0);
        // where near layers are, places move to the nearest texel: between a near light and what is
        // behind it, the linear filter would find a light in focus
        let edges: f32 = max(tile.r, tile.g - 16.0);
        gather.snapping = 3.75 * clamp(edges / 5.0, 0.0, 1.0) + 100.0 * clamp((edges - 10.0) / 16.0,
            0.0, 1.0);
        var first: i32 = 1;
        if (BOKEH_SIDES > 0)
        {
            // by itself, since the others have more samples: so their number is a literal
            if (gather.inner < radius)
            {
                let outer: f32 = min(BokehRingBorder(1, radius, spacing, narrowing), radius);
                gather = BokehGatherRing(gather, MapSamp, 1, BokehOnEdge(1, polygon), outer,
                    polygon, layers, BokehLinearClamp);
            }
            first = 2;
        }
        for (var ring: i32 = first; ring <= BOKEH_LAYER_RINGS + 1; ring++)
        {
            if (gather.inner >= radius)
            {
                break;
            }
            let outer: f32 = min(BokehRingBorder(ring, radius, spacing, narrowing), radius);
            var onEdge: i32 = BokehOnEdge(BOKEH_LAYER_RINGS, polygon);
            if (first < BOKEH_LAYER_RINGS)
            {
                onEdge = BokehOnEdge(min(ring, BOKEH_LAYER_RINGS), polygon);
            }
            gather = BokehGatherRing(gather, MapSamp, ring, onEdge, outer, polygon, layers,
                BokehLinearClamp);
        }

        var near: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        var far: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        if (max(tile.r - 6.0, tile.g - 10.0) > 0.0)
        {
            let halves: BokehGrid = BokehReducedGrid(layers, 2.0);
            near = BokehFetchLayer(NearSamp, 0.5 * center, halves, BokehLinearClamp);
            far = BokehFetchLayer(FarSamp, 0.5 * center, halves, BokehLinearClamp);
        }
        // at a pixel of a layer, that layer itself is added below
        let sum: vec4f = gather.sum + far * (gather.farWeight * (1.0 - max(farShare, nearShare)) /
            max(far.a, 0.001));
        let plain: vec4f = sum + far * farShare;
        if (plain.a >= 0.001)
        {
            // what is in front covers the rest by as much as it has weight
            let rest: f32 = plain.a - gather.front.a;
            let open: f32 = max(1.0 - gather.front.a, 0.0) / max(rest, 0.1);
            result = (gather.front.rgb + (plain.rgb - gather.front.rgb) * open) / max(gather.front.a
                + rest * open, 0.001);
        }
        if (nearShare > 0.0)
        {
            // in depth order: the gather, then what fills its holes, then the far layer, and what
            // fills that
            let quarters: BokehGrid = BokehReducedGrid(layers, 4.0);
            let middle: vec4f = BokehFetchGrid(MiddleSamp, 0.25 * center, quarters,
                BokehLinearClamp);
            let back: vec4f = BokehFetchGrid(BackSamp, 0.25 * center, quarters, BokehLinearClamp);
            let inNear: f32 = near.a * min(2.0 - 2.0 * nearShare, 1.0);
            let empty: f32 = max(1.0 - sum.a - inNear, 0.0);
            let cover: f32 = empty * clamp((middle.a - 0.3) / 0.4, 0.0, 1.0);
            let missing: f32 = max(1.0 - 2.0 * far.a, 0.0);
            let background: vec3f = far.rgb * ((1.0 - missing) / max(far.a, 0.000001)) + back.rgb *
                missing;
            let stack: vec3f = (sum.rgb + middle.rgb * cover + background * (empty - cover)) /
                max(sum.a + empty, 0.000001);
            result += (stack - result) * nearShare;
        }
        // half floats leave a covered pixel at .999: without 1.002 a light behind would shine
        // through; 1.02 makes edges hard (street_11: FLIP .042 for .041)
        let alpha: f32 = clamp(near.a * 1.002, 0.0, 1.0);
        result = result * (1.0 - alpha) + near.rgb * (alpha / max(near.a, 0.000001));
    }
    return vec4f(result, centerPixel.a);
}
