// SPDX-License-Identifier: MIT
//
// Layered depth of field with polygonal bokeh, WGSL. Version 0.2.0. Put it after bokeh.wgsl.
//
//   The one-layer filters of bokeh.wgsl blur each pixel by its own CoC, so near objects keep a hard
//   outline. Here near objects spread over what is behind them, what they hide is filled, and far
//   samples count by how far they spread themselves. docs/layers.md has the method.
//
// CONTRACT
//   This file holds functions only: no bindings, no entry points. bokeh_passes.wgsl beside it has
//   ready-made programs.
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
//   HoleDownsample  1/4   map, tiles                        middle, far, shares (RG)
//   HoleFill        1/4   middle, far, shares, tiles        middle, back: without holes
//   LayerFirst      1/2   a layer, sizes                    exact polygon, first pass
//   LayerSecond     1/2   what that wrote, sizes            exact polygon, second pass
//   Composite       1     map, reach, both layers,          the picture
//                         middle, back
//
//   TileDilate runs twice, along rows, then along columns; LayerFirst and LayerSecond for the near
//   layer, then for the far one.
//
// CONTENTS
//   [10] layers: BokehMakeLayers, BokehTileMax, BokehTileDilate, BokehPrefilter,
//        BokehKernelReduce, BokehKernelRows, BokehKernelColumns
//   [11] holes: BokehHoleDownsample, BokehHoleFill
//   [12] polygons at half size: BokehLayerFirst, BokehLayerSecond; for one target at a time:
//        BokehLayerEdge
//   [13] the picture: BokehComposite

// -------------------------------------------------------------------------------------------------
// [10] layers
// -------------------------------------------------------------------------------------------------
//
//   name                    default    range   meaning
//   BOKEH_LAYER_RINGS       3          1 .. 6  rings of the small gather at full size
//   BOKEH_LAYER_CELLS       12         2 ..    most samples on an edge of a layer's polygon
//   BOKEH_LAYER_CUBIC       1          0, 1    1: layers are enlarged by five fetches, not by one
//   BOKEH_MIN_LEVEL         0.00001    > 0     colour that is as good as black: darker pixels do
//                                              not lower the level of light; far below what the
//                                              exposure shows
//
//   Presets: define one before both files; in WGSL set the three constants.
//
//   preset                  rings      cells   cubic
//   BOKEH_PRESET_LOW        2          8       0
//   BOKEH_PRESET_MEDIUM     3          12      1      the default
//   BOKEH_PRESET_HIGH       3          16      1
//   BOKEH_PRESET_ULTRA      4          16      1

override BOKEH_LAYER_RINGS: i32 = 3;
override BOKEH_LAYER_CELLS: i32 = 12;
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

// Layers: what all passes need to know
//   full          the grid of the full size
//   polygon       the aperture
//   largest       possible CoC: BokehMaxCoC times the image height, pixels
//   jitter        from BokehNoise, times its amount; 0 = none
struct BokehLayers
{
    full: BokehGrid,
    polygon: BokehPolygon,
    largest: f32,
    jitter: f32,
}

// Layers: the grid of the full size
//   viewport      x, y of the image's first pixel, multiples of 8, width, height; pixels
//   wholeSize     of the textures, pixels; it and x, y count with BOKEH_VIEWPORT 1 only
fn BokehMakeGrid(viewport: vec4f, wholeSize: vec2f) -> BokehGrid
{
    var grid: BokehGrid;
    grid.size = viewport.zw;
    grid.origin = vec2f(0.0, 0.0);
    grid.texel = 1.0 / viewport.zw;
    if (BOKEH_VIEWPORT > 0)
    {
        grid.origin = viewport.xy;
        grid.texel = 1.0 / wholeSize;
    }
    return grid;
}

// Layers: settings for an image that fills its textures, without jitter
//   imageSize     width, height; pixels
//   MaxCoC        fraction of the image height, as in the CoC map
fn BokehMakeLayers(imageSize: vec2f, polygon: BokehPolygon, MaxCoC: f32) -> BokehLayers
{
    var layers: BokehLayers;
    layers.full = BokehMakeGrid(vec4f(0.0, 0.0, imageSize), imageSize);
    layers.polygon = polygon;
    layers.largest = MaxCoC * imageSize.y;
    layers.jitter = 0.0;
    return layers;
}

// Layers: the grid of textures of 1 / scale of the full size
fn BokehReducedGrid(full: BokehGrid, scale: f32) -> BokehGrid
{
    var grid: BokehGrid;
    grid.size = ceil(full.size / scale);
    grid.origin = full.origin / scale;
    grid.texel = 1.0 / grid.size;
    if (BOKEH_VIEWPORT > 0)
    {
        grid.texel = 1.0 / ceil(floor(1.0 / full.texel + 0.5) / scale);
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
fn BokehFetchGrid(tex: texture_2d<f32>, texSampler: sampler, place: vec2f, grid: BokehGrid) -> vec4f
{
    return BokehFetchTexture(tex, texSampler, BokehGridCoords(place, grid));
}

// Layers: the same at a distance from a pixel, with fewer instructions
//   uv            of the pixel in the image
//   offset        texels of the grid
fn BokehFetchAround(tex: texture_2d<f32>, texSampler: sampler, uv: vec2f, offset: vec2f,
    grid: BokehGrid) -> vec4f
{
    var coords: vec2f = uv + offset * grid.texel;
    if (BOKEH_VIEWPORT > 0)
    {
        coords = BokehGridCoords(uv * grid.size + offset, grid);
    }
    return BokehFetchTexture(tex, texSampler, coords);
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

// Layers: largest near and far CoC of 8 x 8 pixels, and how bright they are
//   The level is the mean of the logarithm: later passes compare brightness with it, so that the
//   picture does not depend on exposure.
//   returns       r = near, g = far, both >= 0, pixels; b = level
fn BokehTileMax(MapSamp: texture_2d<f32>, MapSampSampler: sampler, uv: vec2f,
    layers: BokehLayers) -> vec4f
{
    let first: vec2f = floor(uv * BokehReducedGrid(layers.full, 8.0).size) * 8.0 + vec2f(0.5, 0.5);
    var found: vec3f = vec3f(0.0, 0.0, 0.0);
    for (var y: i32 = 0; y < 8; y++)
    {
        for (var x: i32 = 0; x < 8; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            let pixel: vec4f = BokehFetchGrid(MapSamp, MapSampSampler, place, layers.full);
            let s: f32 = pixel.a * layers.full.size.y;
            let level: f32 = log2(max(BokehBrightest(pixel.rgb), BOKEH_MIN_LEVEL));
            found = vec3f(max(found.r, -s), max(found.g, s), found.b + level);
        }
    }
    return vec4f(min(found.r, BOKEH_MAX_COLOR), min(found.g, BOKEH_MAX_COLOR), found.b / 64.0,
        1.0);
}

// Layers: what a CoC of another tile counts for here
//   All of it where it reaches, with a margin for the linear filter; it fades out over one tile
//   more, so that nothing jumps as CoC change.
//   tiles         distance
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

// Layers: the largest CoC that reach a tile; along rows first, then along columns
//   TilesSamp     from BokehTileMax, then from here
//   axis          (1, 0), then (0, 1)
fn BokehTileDilate(TilesSamp: texture_2d<f32>, TilesSampSampler: sampler, uv: vec2f, axis: vec2f,
    layers: BokehLayers) -> vec4f
{
    let grid: BokehGrid = BokehReducedGrid(layers.full, 8.0);
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
        let tile: vec4f = BokehFetchGrid(TilesSamp, TilesSampSampler, uv * grid.size + axis * tiles,
            grid);
        found = max(found, BokehReaching(tile.rg, abs(tiles)));
        level += tile.b;
    }
    return vec4f(found, level / (2.0 * radius + 1.0), 1.0);
}

// Layers: what a pixel counts for in its layer's CoC: bokeh comes from bright pixels
//   brightness    in units of the level around
//   heaviest      10000 at most; times the largest CoC / 8 it has to fit into a half float. The
//                 least that BokehKernelColumns takes for a layer, 0.0001 of 6 pixels, is then no
//                 subnormal half either, which some GPUs flush to 0.
fn BokehBlurWeight(brightness: f32, heaviest: f32) -> f32
{
    return min(0.01 + brightness, heaviest);
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

// Layers: near and far layer at half size, and what is known of their CoC
fn BokehPrefilter(MapSamp: texture_2d<f32>, MapSampSampler: sampler, ReachSamp: texture_2d<f32>,
    uv: vec2f, layers: BokehLayers) -> BokehPrefiltered
{
    let full: BokehGrid = layers.full;
    let middle: vec2f = floor(uv * BokehReducedGrid(full, 2.0).size) * 2.0 + vec2f(1.0, 1.0);
    let reach: vec4f = BokehFetchGrid(ReachSamp, MapSampSampler, middle / 8.0,
        BokehReducedGrid(full, 8.0));
    let nearSlope: f32 = BokehNearSlope(reach.r);
    let farSlope: f32 = BokehFarSlope(reach.g);
    let unit: f32 = exp2(-reach.b);
    let heaviest: f32 = 500000.0 / max(layers.largest, 50.0);
    var near: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var far: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var sums: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var left: vec2f = vec2f(0.0, 0.0);
    var largestShare: f32 = 0.0;
    for (var y: i32 = 0; y < 2; y++)
    {
        for (var x: i32 = 0; x < 2; x++)
        {
            let place: vec2f = middle + vec2f(f32(x) - 0.5, f32(y) - 0.5);
            let pixel: vec4f = BokehFetchGrid(MapSamp, MapSampSampler, place, full);
            let s: f32 = pixel.a * full.size.y;
            let nearShare: f32 = BokehLayerShare(-s, nearSlope);
            let farShare: f32 = BokehLayerShare(s, farSlope);
            let weight: f32 = farShare *
                BokehBlurWeight(BokehBrightest(pixel.rgb) * unit, heaviest);
            far += vec4f(pixel.rgb, 1.0) * farShare;
            sums += vec4f(0.0, 0.0, weight * s / 8.0, weight);
            left = max(left, vec2f(-s, s) * min(vec2f(4.0 - 4.0 * nearShare, 4.0 - 4.0 * farShare),
                vec2f(1.0, 1.0)));
            largestShare = max(largestShare, nearShare);
        }
    }
    if (largestShare > 0.0)
    {
        // an antialiased pixel of a near edge holds light of what is behind it: where that is
        // brighter, no near pixel stays brighter than the darkest one around
        var behind: f32 = 0.0;
        var darkest: vec3f = vec3f(BOKEH_MAX_COLOR, BOKEH_MAX_COLOR, BOKEH_MAX_COLOR);
        for (var y: i32 = 0; y < 4; y++)
        {
            for (var x: i32 = 0; x < 4; x++)
            {
                let place: vec2f = middle + vec2f(f32(x) - 1.5, f32(y) - 1.5);
                let pixel: vec4f = BokehFetchGrid(MapSamp, MapSampSampler, place, full);
                let nearShare: f32 = BokehLayerShare(-pixel.a * full.size.y, nearSlope);
                if (nearShare < 0.5 * largestShare)
                {
                    behind = max(behind, BokehBrightest(pixel.rgb));
                }
                else
                {
                    darkest = min(darkest, pixel.rgb);
                }
            }
        }
        let limit: f32 = BokehBrightest(darkest);
        for (var row: i32 = 0; row < 2; row++)
        {
            for (var column: i32 = 0; column < 2; column++)
            {
                let place: vec2f = middle + vec2f(f32(column) - 0.5, f32(row) - 0.5);
                let pixel: vec4f = BokehFetchGrid(MapSamp, MapSampSampler, place, full);
                let s: f32 = pixel.a * full.size.y;
                var nearShare: f32 = BokehLayerShare(-s, nearSlope);
                let brightest: f32 = BokehBrightest(pixel.rgb);
                var color: vec3f = pixel.rgb;
                if (behind > brightest)
                {
                    color = min(color, darkest);
                    if (brightest > limit)
                    {
                        // the part of it that is not light from behind
                        nearShare *= (behind - brightest) / (behind - limit);
                    }
                }
                let weight: f32 = nearShare *
                    BokehBlurWeight(BokehBrightest(color) * unit, heaviest);
                near += vec4f(color, 1.0) * nearShare;
                sums += vec4f(-weight * s / 8.0, weight, 0.0, 0.0);
            }
        }
    }
    var targets: BokehPrefiltered;
    targets.nearLayer = near * 0.25;
    targets.farLayer = far * 0.25;
    let most: f32 = BOKEH_MAX_COLOR;
    targets.kernelSums = min(sums * 0.25, vec4f(most, most, most, most));
    targets.leftovers = vec4f(min(left, vec2f(most, most)), 0.0, 1.0);
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
fn BokehKernelReduce(SumsSamp: texture_2d<f32>, SumsSampSampler: sampler, LeftSamp: texture_2d<f32>,
    uv: vec2f, layers: BokehLayers) -> BokehKernels
{
    let halves: BokehGrid = BokehReducedGrid(layers.full, 2.0);
    let first: vec2f = floor(uv * BokehReducedGrid(layers.full, 8.0).size) * 4.0 + vec2f(0.5, 0.5);
    var sums: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var left: vec2f = vec2f(0.0, 0.0);
    for (var y: i32 = 0; y < 4; y++)
    {
        for (var x: i32 = 0; x < 4; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            sums += BokehFetchGrid(SumsSamp, SumsSampSampler, place, halves);
            left = max(left, BokehFetchGrid(LeftSamp, SumsSampSampler, place, halves).rg);
        }
    }
    var targets: BokehKernels;
    targets.leftovers = vec4f(left, 0.0, 1.0);
    targets.sums = sums / 16.0;
    return targets;
}

// Layers: BokehKernelRows along any axis
//   axis          (1, 0) or (0, 1)
fn BokehKernelAlong(LeftSamp: texture_2d<f32>, LeftSampSampler: sampler,
    SumsSamp: texture_2d<f32>, ReachSamp: texture_2d<f32>, uv: vec2f, axis: vec2f,
    layers: BokehLayers) -> BokehKernels
{
    let grid: BokehGrid = BokehReducedGrid(layers.full, 8.0);
    let reach: vec2f = BokehFetchGrid(ReachSamp, LeftSampSampler, uv * grid.size, grid).rg;
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
        let place: vec2f = uv * grid.size + axis * tiles;
        let weight: vec2f = exp(-0.5 * tiles * tiles / (sigma * sigma));
        sums += BokehFetchGrid(SumsSamp, LeftSampSampler, place, grid) *
            vec4f(weight.x, weight.x, weight.y, weight.y);
        left = max(left, BokehReaching(BokehFetchGrid(LeftSamp, LeftSampSampler, place, grid).rg,
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
fn BokehKernelRows(LeftSamp: texture_2d<f32>, LeftSampSampler: sampler, SumsSamp: texture_2d<f32>,
    ReachSamp: texture_2d<f32>, uv: vec2f, layers: BokehLayers) -> BokehKernels
{
    return BokehKernelAlong(LeftSamp, LeftSampSampler, SumsSamp, ReachSamp, uv, vec2f(1.0, 0.0),
        layers);
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
fn BokehKernelColumns(LeftSamp: texture_2d<f32>, LeftSampSampler: sampler,
    SumsSamp: texture_2d<f32>, ReachSamp: texture_2d<f32>, uv: vec2f,
    layers: BokehLayers) -> BokehSizes
{
    let grid: BokehGrid = BokehReducedGrid(layers.full, 8.0);
    let reach: vec2f = BokehFetchGrid(ReachSamp, LeftSampSampler, uv * grid.size, grid).rg;
    let kernels: BokehKernels = BokehKernelAlong(LeftSamp, LeftSampSampler, SumsSamp, ReachSamp, uv,
        vec2f(0.0, 1.0), layers);
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
// [11] holes: what the near layer hides
// -------------------------------------------------------------------------------------------------

// Layers: what BokehHoleDownsample writes
//   middle, far   what is between the layers, and the far layer: rgb times weight, weight
//   shares        rg = shares of the two, unweighted
struct BokehHoles
{
    middle: vec4f,
    far: vec4f,
    shares: vec4f,
}

// Layers: what is not near, at quarter size, as weighted sums
//   Bright pixels weigh less: a light would fill the whole hole.
fn BokehHoleDownsample(MapSamp: texture_2d<f32>, MapSampSampler: sampler,
    ReachSamp: texture_2d<f32>, uv: vec2f, layers: BokehLayers) -> BokehHoles
{
    let full: BokehGrid = layers.full;
    let first: vec2f = floor(uv * BokehReducedGrid(full, 4.0).size) * 4.0 + vec2f(0.5, 0.5);
    let middlePlace: vec2f = first + vec2f(1.5, 1.5);
    let reach: vec4f = BokehFetchGrid(ReachSamp, MapSampSampler, middlePlace / 8.0,
        BokehReducedGrid(full, 8.0));
    let nearSlope: f32 = BokehNearSlope(reach.r);
    let farSlope: f32 = BokehFarSlope(reach.g);
    let unit: f32 = exp2(-reach.b);
    var middle: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var far: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var shares: vec2f = vec2f(0.0, 0.0);
    for (var y: i32 = 0; y < 4; y++)
    {
        for (var x: i32 = 0; x < 4; x++)
        {
            let place: vec2f = first + vec2f(f32(x), f32(y));
            let pixel: vec4f = BokehFetchGrid(MapSamp, MapSampSampler, place, full);
            let s: f32 = pixel.a * full.size.y;
            // what is partly near is hardly background: a near light would shine through itself
            let nearShare: f32 = BokehLayerShare(-s, nearSlope);
            let notNear: f32 = max(1.0 - 2.0 * nearShare, 0.0625 - 0.0625 * nearShare);
            let farShare: f32 = BokehLayerShare(s, farSlope);
            let weight: f32 = notNear / (1.0 + BokehBrightest(pixel.rgb) * unit);
            middle += vec4f(pixel.rgb, 1.0) * (weight * (1.0 - farShare));
            far += vec4f(pixel.rgb, 1.0) * (weight * farShare);
            shares += vec2f(1.0 - farShare, farShare) * notNear;
        }
    }
    var targets: BokehHoles;
    targets.middle = middle / 16.0;
    targets.far = far / 16.0;
    targets.shares = vec4f(shares / 16.0, 0.0, 1.0);
    return targets;
}

// Layers: the first corner of a polygon, at a distance of 1 from its middle; not squeezed
fn BokehFirstCorner(polygon: BokehPolygon) -> vec2f
{
    let angle: f32 = polygon.rotation - 3.14159265 / f32(polygon.sides);
    var corner: vec2f = vec2f(cos(angle), sin(angle));
    if (BOKEH_CHARACTER > 0)
    {
        // the last edge, less the others
        var sum: vec2f = BokehEdgeVector(polygon.sides / 2, polygon);
        for (var i: i32 = 1; i < polygon.sides / 2; i++)
        {
            sum -= BokehEdgeVector(i, polygon);
        }
        corner = BokehRotated(sum, vec2f(cos(polygon.rotation), sin(polygon.rotation)));
    }
    return corner;
}

// Layers: (cos, sin) of the angle from one corner to the next
fn BokehCornerStep(polygon: BokehPolygon) -> vec2f
{
    let angle: f32 = 6.28318531 / f32(polygon.sides);
    return vec2f(cos(angle), sin(angle));
}

// Layers: the corner that follows on another one, both as in BokehFirstCorner
//   k             of the edge between them: 0, 1 ..; edge sides / 2 is opposite to edge 0
//   cornerStep    from BokehCornerStep
fn BokehNextCorner(corner: vec2f, k: i32, cornerStep: vec2f, polygon: BokehPolygon) -> vec2f
{
    var nextCorner: vec2f = BokehRotated(corner, cornerStep);
    if (BOKEH_CHARACTER > 0)
    {
        let edges: i32 = polygon.sides / 2;
        var edge: i32 = k;
        if (k >= edges)
        {
            edge = k - edges;
        }
        if (edge == 0)
        {
            edge = edges;
        }
        let axis: vec2f = vec2f(cos(polygon.rotation), sin(polygon.rotation));
        var along: vec2f = BokehRotated(BokehEdgeVector(edge, polygon), axis) * 2.0;
        // the outline runs around the middle one way
        if (corner.x * along.y < corner.y * along.x)
        {
            along = -along;
        }
        nextCorner = corner + along;
    }
    return nextCorner;
}

// Layers: area of the triangle from the middle to an edge, in units of their mean
fn BokehEdgeShare(corner: vec2f, nextCorner: vec2f, polygon: BokehPolygon) -> f32
{
    var share: f32 = 1.0;
    if (BOKEH_CHARACTER > 0)
    {
        var area: f32 = 0.0;
        for (var k: i32 = 2; k <= polygon.sides / 2; k++)
        {
            area += BokehExactWeight(k, polygon);
        }
        share = (corner.x * nextCorner.y - corner.y * nextCorner.x) * f32(polygon.sides) /
            (8.0 * area);
    }
    return share;
}

// Layers: how many samples of a ring are on each edge of the polygon
//   6 on the first ring, 12 on the second and so on, shared out among the sides: all rings are
//   sampled as densely. A polygon of more sides than that has one a side.
fn BokehOnEdge(ring: i32, polygon: BokehPolygon) -> i32
{
    return i32(max(6.0 * f32(ring) / f32(polygon.sides) + 0.5, 1.0));
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
//   MiddleSamp, FarSamp, SharesSamp  what BokehHoleDownsample wrote
fn BokehHoleFill(MiddleSamp: texture_2d<f32>, MiddleSampSampler: sampler, FarSamp: texture_2d<f32>,
    SharesSamp: texture_2d<f32>, ReachSamp: texture_2d<f32>, uv: vec2f,
    layers: BokehLayers) -> BokehFilled
{
    let grid: BokehGrid = BokehReducedGrid(layers.full, 4.0);
    let center: vec2f = uv * grid.size;
    let reach: f32 = BokehFetchGrid(ReachSamp, MiddleSampSampler, center / 2.0,
        BokehReducedGrid(layers.full, 8.0)).r;
    let stretch: vec2f = vec2f(layers.polygon.squeeze, 1.0);
    let cornerStep: vec2f = BokehCornerStep(layers.polygon);
    var corner: vec2f = BokehFirstCorner(layers.polygon);
    var middle: vec4f = BokehFetchGrid(MiddleSamp, MiddleSampSampler, center, grid);
    var far: vec4f = BokehFetchGrid(FarSamp, MiddleSampSampler, center, grid);
    var shares: vec2f = BokehFetchGrid(SharesSamp, MiddleSampSampler, center, grid).rg;
    for (var ring: i32 = 1; ring < 3; ring++)
    {
        // no near layer, no holes
        if (reach < 6.0)
        {
            break;
        }
        // in quarter pixels; the rings reach half the CoC
        let radius: f32 = max(reach / 16.0, 1.0) * f32(ring);
        let weight: f32 = 1.0 / (1.0 + 16.0 * radius * radius);
        let onEdge: i32 = BokehOnEdge(ring, layers.polygon);
        for (var edge: i32 = 0; edge < layers.polygon.sides; edge++)
        {
            let nextCorner: vec2f = BokehNextCorner(corner, edge, cornerStep,
                layers.polygon);
            let along: vec2f = (nextCorner - corner) / f32(onEdge);
            for (var i: i32 = 0; i < onEdge; i++)
            {
                let place: vec2f = center + (corner + along * f32(i)) * stretch * radius;
                middle += BokehFetchGrid(MiddleSamp, MiddleSampSampler, place, grid) * weight;
                far += BokehFetchGrid(FarSamp, MiddleSampSampler, place, grid) * weight;
                shares += BokehFetchGrid(SharesSamp, MiddleSampSampler, place, grid).rg * weight;
            }
            corner = nextCorner;
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
// [12] polygons at half size
// -------------------------------------------------------------------------------------------------
//
//   The parallelograms of [8], without weights and without a leakage test: a layer has nothing in
//   it that must not spread. All four channels are blurred alike.

// Layers: mean of the samples along one line
//   center        place, texels of the half size
//   segment       from BokehPolygonEdge
//   CoC           texels of the half size
fn BokehLayerLine(LayerSamp: texture_2d<f32>, LayerSampSampler: sampler, center: vec2f,
    segment: vec4f, CoC: f32, layers: BokehLayers) -> vec4f
{
    let halves: BokehGrid = BokehReducedGrid(layers.full, 2.0);
    let lengthInTexels: f32 = 2.0 * length(segment.zw) * CoC;
    let cells: f32 = clamp(lengthInTexels, 2.0, f32(BOKEH_LAYER_CELLS));
    let phase: f32 = 0.5 + layers.jitter * clamp(lengthInTexels / cells - 1.0, 0.0, 1.0);
    let first: vec2f = center + (segment.xy - segment.zw) * CoC;
    let cellLength: vec2f = segment.zw * CoC * (2.0 / cells);
    var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    for (var i: i32 = 0; i < i32(ceil(cells)); i++)
    {
        let cell: f32 = clamp(cells - f32(i), 0.0, 1.0);
        let place: vec2f = first + cellLength * (f32(i) + cell * phase);
        sum += cell * BokehFetchGrid(LayerSamp, LayerSampSampler, place, halves);
    }
    return sum / cells;
}

// Layers: the CoC that a layer is blurred by, texels of the half size
//   Averaging 2 x 2 pixels and the linear filter blur by themselves: 8 is their share of the
//   squared CoC. With 0 layers are too soft (market_7: FLIP .186 for .180), with 16 too sharp
//   (street_11: .044 for .041).
//   returns       0.5 or more; 0.5 where there is no layer, or nothing left to do
fn BokehLayerCoC(SizesSamp: texture_2d<f32>, SizesSampSampler: sampler, center: vec2f, isFar: bool,
    layers: BokehLayers) -> f32
{
    let sizes: vec2f = BokehFetchGrid(SizesSamp, SizesSampSampler, center / 4.0,
        BokehReducedGrid(layers.full, 8.0)).rg;
    var CoC: f32 = 0.5 * sizes.r;
    if (isFar)
    {
        CoC = 0.5 * sizes.g;
    }
    return sqrt(max(CoC * CoC - 8.0, 0.25));
}

// Layers: what the first pass writes for edge k: the lines along the edges before it, weighted by
//   their parallelograms
//   L1 .. L4      from BokehLayerLine, along edges 1 to 4; only those before edge k count
fn BokehLayerTarget(k: i32, polygon: BokehPolygon, L1: vec4f, L2: vec4f, L3: vec4f,
    L4: vec4f) -> vec4f
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
    return (L1 * w1 + L2 * w2 + L3 * w3 + L4 * w4) / (w1 + w2 + w3 + w4);
}

// Layers: first pass over a layer
//   LayerSamp     nearLayer or farLayer of BokehPrefilter
//   SizesSamp     sizes of BokehKernelColumns
//   isFar         false: the near layer
//   returns       as BokehExactFirst
fn BokehLayerFirst(LayerSamp: texture_2d<f32>, LayerSampSampler: sampler,
    SizesSamp: texture_2d<f32>, uv: vec2f, isFar: bool, layers: BokehLayers) -> BokehTargets
{
    let polygon: BokehPolygon = layers.polygon;
    let center: vec2f = uv * BokehReducedGrid(layers.full, 2.0).size;
    let none: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var targets: BokehTargets;
    targets.edge2 = none;
    targets.edge3 = none;
    targets.edge4 = none;
    targets.edge5 = none;
    let CoC: f32 = BokehLayerCoC(SizesSamp, LayerSampSampler, center, isFar, layers);
    if (CoC > 0.5)
    {
        var L2: vec4f = none;
        var L3: vec4f = none;
        let L1: vec4f = BokehLayerLine(LayerSamp, LayerSampSampler, center,
            BokehPolygonEdge(1, polygon, false), CoC, layers);
        targets.edge2 = L1;
        if (polygon.sides > 4)
        {
            L2 = BokehLayerLine(LayerSamp, LayerSampSampler, center,
                BokehPolygonEdge(2, polygon, false), CoC, layers);
            targets.edge3 = BokehLayerTarget(3, polygon, L1, L2, none, none);
        }
        if (polygon.sides > 6)
        {
            L3 = BokehLayerLine(LayerSamp, LayerSampSampler, center,
                BokehPolygonEdge(3, polygon, false), CoC, layers);
            targets.edge4 = BokehLayerTarget(4, polygon, L1, L2, L3, none);
        }
        if (polygon.sides > 8)
        {
            let L4: vec4f = BokehLayerLine(LayerSamp, LayerSampSampler, center,
                BokehPolygonEdge(4, polygon, false), CoC, layers);
            targets.edge5 = BokehLayerTarget(5, polygon, L1, L2, L3, L4);
        }
    }
    else
    {
        targets.edge2 = BokehFetchGrid(LayerSamp, LayerSampSampler, center,
            BokehReducedGrid(layers.full, 2.0));
        targets.edge3 = targets.edge2;
        targets.edge4 = targets.edge2;
        targets.edge5 = targets.edge2;
    }
    return targets;
}

// Layers: second pass: the finished layer
//   Edge2Samp ..  what the first pass wrote; where there are fewer, pass any of them for the
//                 rest: it is not read
//   SizesSamp     sizes of BokehKernelColumns
//   isFar         false: the near layer
//   returns       rgb times share, share
fn BokehLayerSecond(Edge2Samp: texture_2d<f32>, Edge2SampSampler: sampler,
    Edge3Samp: texture_2d<f32>, Edge4Samp: texture_2d<f32>, Edge5Samp: texture_2d<f32>,
    SizesSamp: texture_2d<f32>, uv: vec2f, isFar: bool, layers: BokehLayers) -> vec4f
{
    let polygon: BokehPolygon = layers.polygon;
    let center: vec2f = uv * BokehReducedGrid(layers.full, 2.0).size;
    var result: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    let CoC: f32 = BokehLayerCoC(SizesSamp, Edge2SampSampler, center, isFar, layers);
    if (CoC > 0.5)
    {
        var total: f32 = BokehExactWeight(2, polygon);
        var sum: vec4f = total * BokehLayerLine(Edge2Samp, Edge2SampSampler, center,
            BokehPolygonEdge(2, polygon, true), CoC, layers);
        if (polygon.sides > 4)
        {
            let weight: f32 = BokehExactWeight(3, polygon);
            sum += weight * BokehLayerLine(Edge3Samp, Edge2SampSampler, center,
                BokehPolygonEdge(3, polygon, true), CoC, layers);
            total += weight;
        }
        if (polygon.sides > 6)
        {
            let weight: f32 = BokehExactWeight(4, polygon);
            sum += weight * BokehLayerLine(Edge4Samp, Edge2SampSampler, center,
                BokehPolygonEdge(4, polygon, true), CoC, layers);
            total += weight;
        }
        if (polygon.sides > 8)
        {
            let weight: f32 = BokehExactWeight(5, polygon);
            sum += weight * BokehLayerLine(Edge5Samp, Edge2SampSampler, center,
                BokehPolygonEdge(5, polygon, true), CoC, layers);
            total += weight;
        }
        result = sum / total;
    }
    else
    {
        result = BokehFetchGrid(Edge2Samp, Edge2SampSampler, center, BokehReducedGrid(layers.full,
            2.0));
    }
    return result;
}

// Layers: one target of the first pass, where a pass can write only one
//   Call it for k = 2 .. sides / 2; as BokehExactEdge.
fn BokehLayerEdge(LayerSamp: texture_2d<f32>, LayerSampSampler: sampler, SizesSamp: texture_2d<f32>,
    uv: vec2f, isFar: bool, k: i32, layers: BokehLayers) -> vec4f
{
    let polygon: BokehPolygon = layers.polygon;
    let center: vec2f = uv * BokehReducedGrid(layers.full, 2.0).size;
    var result: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    let CoC: f32 = BokehLayerCoC(SizesSamp, LayerSampSampler, center, isFar, layers);
    if (CoC > 0.5)
    {
        let angle: f32 = 6.28318531 / f32(polygon.sides);
        var sum: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
        var total: f32 = 0.0;
        for (var i: i32 = 1; i < min(k, 5); i++)
        {
            var area: f32 = max(sin(f32(k - i) * angle), 0.0);
            if (BOKEH_CHARACTER > 0)
            {
                area *= BokehEdgeLength(i, polygon);
            }
            sum += area * BokehLayerLine(LayerSamp, LayerSampSampler, center,
                BokehPolygonEdge(i, polygon, false), CoC, layers);
            total += area;
        }
        result = sum / total;
    }
    else
    {
        result = BokehFetchGrid(LayerSamp, LayerSampSampler, center,
            BokehReducedGrid(layers.full, 2.0));
    }
    return result;
}

// -------------------------------------------------------------------------------------------------
// [13] the picture
// -------------------------------------------------------------------------------------------------

// Layers: a half-size layer at a place of the full size
//   Catmull-Rom without its corners, five fetches: bilinear would make the edges of polygons
//   ragged. It overshoots: no channel leaves the range of its five fetches, or lights had dark rims
//   and too much light.
//
//            t          w0     weights from the texel before to the second one after;
//          l c r      w1 + w2  c, the middle fetch, takes two by two texels
//            b          w3
//
//   place         texels of the half size
fn BokehFetchLayer(LayerSamp: texture_2d<f32>, LayerSampSampler: sampler, place: vec2f,
    halves: BokehGrid) -> vec4f
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
        let c: vec4f = BokehFetchGrid(LayerSamp, LayerSampSampler, inner, halves);
        let l: vec4f = BokehFetchGrid(LayerSamp, LayerSampSampler, vec2f(texel.x - 1.0, inner.y),
            halves);
        let r: vec4f = BokehFetchGrid(LayerSamp, LayerSampSampler, vec2f(texel.x + 2.0, inner.y),
            halves);
        let t: vec4f = BokehFetchGrid(LayerSamp, LayerSampSampler, vec2f(inner.x, texel.y - 1.0),
            halves);
        let b: vec4f = BokehFetchGrid(LayerSamp, LayerSampSampler, vec2f(inner.x, texel.y + 2.0),
            halves);
        let side: vec2f = w12.yx / (w12.x * w12.y + (w0.x + w3.x) * w12.y + (w0.y + w3.y) * w12.x);
        let sum: vec4f = c * (w12.x * side.x) + l * (w0.x * side.x) + r * (w3.x * side.x) +
            t * (w0.y * side.y) + b * (w3.y * side.y);
        result = clamp(sum, min(min(c, min(l, r)), min(t, b)),
            max(max(c, max(l, r)), max(t, b)));
    }
    else
    {
        result = BokehFetchGrid(LayerSamp, LayerSampSampler, place, halves);
    }
    return result;
}

// Layers: how far a CoC spreads, pixels, without the blur that linear filtering adds by itself
fn BokehSpreadRadius(s: f32) -> f32
{
    return max(0.5 * abs(s) - 0.5, 0.0);
}

// Layers: radius of a ring of the gather, pixels
//   power         1: evenly spaced, the last ring half a step within the radius; 2: closer to the
//                 middle. No two rings are closer than a pixel.
fn BokehRingRadius(ring: i32, radius: f32, power: f32) -> f32
{
    let share: f32 = f32(ring) / (f32(BOKEH_LAYER_RINGS) + 0.5);
    return max(radius * exp2(power * log2(share)), f32(ring));
}

// Layers: the last pass: a gather over what is in no layer, and all of it together
//   Each sample counts by its own CoC, spread over the area that it covers; from behind this
//   pixel's surface by this pixel's CoC. What is in a layer is left out, and the layers are put
//   over it and behind it.
//   MapSamp       from BokehSignedCoCMap
//   TilesSamp     reach of BokehKernelColumns
//   NearSamp, FarSamp     from BokehLayerSecond
//   MiddleSamp, BackSamp  what BokehHoleFill wrote
//   returns       rgb = the picture, a = signed CoC of this pixel
fn BokehComposite(MapSamp: texture_2d<f32>, MapSampSampler: sampler, TilesSamp: texture_2d<f32>,
    NearSamp: texture_2d<f32>, FarSamp: texture_2d<f32>, MiddleSamp: texture_2d<f32>,
    BackSamp: texture_2d<f32>, uv: vec2f, layers: BokehLayers) -> vec4f
{
    let full: BokehGrid = layers.full;
    let center: vec2f = uv * full.size;
    let centerPixel: vec4f = BokehFetchNearest(MapSamp, uv);
    let tile: vec4f = BokehFetchGrid(TilesSamp, MapSampSampler, center / 8.0,
        BokehReducedGrid(full, 8.0));
    var result: vec3f = centerPixel.rgb;
    // up to a CoC of one pixel nothing spreads
    if (max(tile.r, tile.g) > 1.0)
    {
        let height: f32 = full.size.y;
        let s: f32 = centerPixel.a * height;
        let nearSlope: f32 = BokehNearSlope(tile.r);
        let farSlope: f32 = BokehFarSlope(tile.g);
        let nearShare: f32 = BokehLayerShare(-s, nearSlope);
        let farShare: f32 = BokehLayerShare(s, farSlope);
        // at a near pixel the far layer is added too: it lies beyond it
        let addFar: f32 = max(farShare, nearShare);
        let near: vec4f = BokehFetchLayer(NearSamp, MapSampSampler, 0.5 * center,
            BokehReducedGrid(full, 2.0));
        let far: vec4f = BokehFetchLayer(FarSamp, MapSampSampler, 0.5 * center,
            BokehReducedGrid(full, 2.0));

        // the gather reaches as far as what is in no layer
        let ownRadius: f32 = BokehSpreadRadius(s);
        let restRadius: f32 = ownRadius * clamp(16.0 - 16.0 * farShare, 0.0, 1.0) *
            (1.0 - nearShare);
        var radius: f32 = max(restRadius, 0.5 * max(tile.b, tile.a * farShare));
        if (near.a > 0.998)
        {
            // wholly covered
            radius = 0.0;
        }
        let power: f32 = 1.0 + clamp(log2(max(radius, 1.0) / max(restRadius, 1.0)), 0.0, 1.0);
        var before: f32 = 0.0;
        var current: f32 = BokehRingRadius(1, radius, power);
        // what spreads less than the inner radius of the first ring reaches no other pixel
        let least: f32 = 0.5 * current;
        let share: f32 = least / max(ownRadius, least);
        var weight: f32 = (1.0 - nearShare) * (1.0 - farShare * addFar) * share * share;
        var sum: vec4f = vec4f(centerPixel.rgb, 1.0) * weight;
        // where near layers are, places move to the nearest texel: between a near light and what is
        // behind it, the linear filter would find a light in focus
        let steepness: f32 = 3.0 * clamp((tile.r - 6.0) / 6.0, 0.0, 1.0) + 100.0 *
            clamp((tile.r - 16.0) / 16.0, 0.0, 1.0);
        let stretch: vec2f = vec2f(layers.polygon.squeeze, 1.0);
        let cornerStep: vec2f = BokehCornerStep(layers.polygon);
        var corner: vec2f = BokehFirstCorner(layers.polygon);
        for (var ring: i32 = 1; ring <= BOKEH_LAYER_RINGS; ring++)
        {
            //   ring        1     2     3
            //   |--.--|-----.-----|--.--|     a ring has the area half way to its neighbours
            //   inner outer
            let next: f32 = BokehRingRadius(ring + 1, radius, power);
            let inner: f32 = 0.5 * (before + current);
            var outer: f32 = 0.5 * (current + next);
            if (ring == BOKEH_LAYER_RINGS)
            {
                outer = 1.5 * current - 0.5 * before;
            }
            if (inner > radius)
            {
                break;
            }
            let onEdge: i32 = BokehOnEdge(ring, layers.polygon);
            let cell: f32 = (outer * outer - inner * inner) / f32(onEdge * layers.polygon.sides);
            let slope: f32 = 1.0 / (outer - inner);
            let start: f32 = inner * slope;
            let phase: f32 = layers.jitter * clamp(current / f32(ring) - 1.0, 0.0, 1.0);
            let scale: vec2f = stretch * current;
            // half of the edges: the others are opposite to them, sample by sample
            for (var edge: i32 = 0; edge < layers.polygon.sides / 2; edge++)
            {
                let nextCorner: vec2f = BokehNextCorner(corner, edge, cornerStep,
                    layers.polygon);
                let edgeCell: f32 = cell * BokehEdgeShare(corner, nextCorner, layers.polygon);
                let along: vec2f = (nextCorner - corner) * scale / f32(onEdge);
                let first: vec2f = corner * scale + along * phase;
                for (var i: i32 = 0; i < onEdge; i++)
                {
                    var offset: vec2f = first + along * f32(i);
                    let texel: vec2f = floor(offset);
                    offset = texel + clamp((offset - texel) * (steepness + 1.0) - 0.5 * steepness,
                        vec2f(0.0, 0.0), vec2f(1.0, 1.0));
                    for (var side: i32 = 0; side < 2; side++)
                    {
                        let pixel: vec4f = BokehFetchAround(MapSamp, MapSampSampler, uv, offset,
                            full);
                        let isBehind: f32 = clamp(pixel.a * (2.0 * height) - 2.0 * s, 0.0, 1.0) *
                            (1.0 - nearShare);
                        var spread: f32 = abs(pixel.a) * (0.5 * height) - 0.5;
                        spread = max(min(spread + (ownRadius - spread) * isBehind, radius), least);
                        let kept: f32 = 1.0 - BokehLayerShare(-pixel.a, nearSlope * height) -
                            BokehLayerShare(pixel.a, farSlope * height) * addFar;
                        weight = kept * clamp(spread * slope - start, 0.0, 1.0) * edgeCell /
                            (spread * spread);
                        sum += vec4f(pixel.rgb, 1.0) * weight;
                        offset = -offset;
                    }
                }
                corner = nextCorner;
            }
            before = current;
            current = next;
        }

        let plain: vec4f = sum + far * addFar;
        if (plain.a >= 0.001)
        {
            result = plain.rgb / plain.a;
        }
        if (nearShare > 0.0)
        {
            // in depth order: the gather, then what fills its holes, then the far layer, and what
            // fills that
            let quarters: BokehGrid = BokehReducedGrid(full, 4.0);
            let middle: vec4f = BokehFetchGrid(MiddleSamp, MapSampSampler, 0.25 * center, quarters);
            let back: vec4f = BokehFetchGrid(BackSamp, MapSampSampler, 0.25 * center, quarters);
            let empty: f32 = clamp(1.0 - sum.a, 0.0, 1.0);
            let cover: f32 = empty * nearShare * clamp((middle.a - 0.3) / 0.4, 0.0, 1.0);
            let farAlpha: f32 = min(far.a, 1.0);
            let missing: f32 = (1.0 - farAlpha) * (1.0 - 0.25 * min(farAlpha / 0.05, 1.0));
            let background: vec3f = far.rgb * ((1.0 - missing) / max(far.a, 0.000001)) + back.rgb *
                missing;
            let stack: vec3f = sum.rgb / max(sum.a, 1.0) + middle.rgb * cover + background *
                (empty - cover);
            if (plain.a < 0.001)
            {
                result = stack;
            }
            result += (stack - result) * nearShare;
        }
        // half floats leave a covered pixel at .999: without 1.002 a light behind would shine
        // through; 1.02 makes edges hard (street_11: FLIP .042 for .041)
        let alpha: f32 = clamp(near.a * 1.002, 0.0, 1.0);
        result = result * (1.0 - alpha) + near.rgb * (alpha / max(near.a, 0.000001));
    }
    return vec4f(result, centerPixel.a);
}
