// SPDX-License-Identifier: MIT
//
// The character of a lens, WGSL. Version 0.3.0. Put it after bokeh.wgsl.
//
//   Curved blades and a cat's eye are functions from polygon to polygon: what they return goes
//   wherever a BokehPolygon goes, in `exact` and in the layers. A focus that artists can bend is
//   another CoC in the map; a steady map is a pass after the map, lateral colour one over the
//   finished picture. Axial colour is a recipe: docs/methods/character.md.
//   Functions only: no bindings, no entry points.

// -------------------------------------------------------------------------------------------------
// [15] apertures

// Lens: a polygon whose lengths have changed, with what follows from them
fn BokehUpdatePolygon(polygon: BokehPolygon) -> BokehPolygon
{
    var closed: BokehPolygon = polygon;
    closed.mean = vec2f(0.0, 0.0);
    closed.area = 0.0;
    var begin: vec2f = vec2f(0.0, 0.0);
    for (var i: i32 = 1; i <= polygon.sides / 2; i++)
    {
        let edge: vec2f = BokehEdge(i, polygon);
        if (i < polygon.sides / 2)
        {
            closed.mean += (begin + edge * 0.5) / (0.5 * f32(polygon.sides) - 1.0);
        }
        closed.area += begin.x * edge.y - begin.y * edge.x;
        begin += edge;
    }
    // the outline's other half leads back: the middle is half-way
    closed.corner = begin * -0.5;
    closed.mean += closed.corner;
    return closed;
}

// Lens: curved blades, of an octagon; other polygons stay as they are
//   Its corners stay on the circle. (fxc for shader model 3 drops a max around a sin.)
//   roundness     0 a square, 1 regular, between them a square with corners cut off
fn BokehWithRoundness(polygon: BokehPolygon, roundness: f32) -> BokehPolygon
{
    var result: BokehPolygon = polygon;
    if (polygon.sides == 8)
    {
        let corner: f32 = 0.39269908 * clamp(roundness, 0.0, 1.0);
        let odd: f32 = sin(max(corner, 0.001));
        let even: f32 = sin(0.78539816 - corner);
        result.lengths = vec4f(odd, even, odd, even);
        result = BokehUpdatePolygon(result);
    }
    return result;
}

// Lens: distance of edge k from the middle of a polygon
//   along         the cut: by how much of that distance the edge moves to the middle, as a vector
fn BokehHalfWidth(k: i32, polygon: BokehPolygon, along: vec2f) -> f32
{
    var width: f32 = 0.0;
    for (var i: i32 = 1; i <= polygon.sides / 2; i++)
    {
        width += abs(BokehTurn(f32(i - k), polygon).y) * BokehEdgeLength(i, polygon);
    }
    return 0.5 * width * (1.0 - abs(dot(along, BokehTurn(f32(k), polygon))));
}

// Lens: length of edge k between the lines of all other edges
//
//      before after
//      ,---+---,   edge k is on a line half a width from the middle; on both sides it ends where
//     /    |    '  the nearest of the other lines crosses that one
//
//   widths        a polygon whose lengths are the half widths of the edges
//   returns       0.001 where nothing is left, so that no weights add up to 0
fn BokehCutLength(k: i32, widths: BokehPolygon) -> f32
{
    let halfWidth: f32 = BokehEdgeLength(k, widths);
    let edges: i32 = widths.sides / 2;
    var ends: vec2f = vec2f(1.0, 1.0);
    for (var i: i32 = 1; i < edges; i++)
    {
        let turn: vec2f = BokehTurn(f32(i), widths);
        let others: vec2f = vec2f(BokehEdgeLength(k - i + edges, widths), BokehEdgeLength(k + i,
            widths));
        ends = min(ends, (others - halfWidth * turn.x) / turn.y);
    }
    return max(ends.x + ends.y, 0.001);
}

// Lens: cat's eye: the polygon cut by the lens barrel, more towards the corners of the image
//   The front and rear rims of the barrel are two copies of the polygon, shifted apart; the bokeh
//   is where they overlap. So the middle stays where it is, near and far are alike, and what is
//   left has the same edges, some of them shorter.
//   amount        0 .. 0.9: share of the width, from the middle of the image outwards, that is gone
//                 in its corners; half-way to them half as much
fn BokehWithCatsEye(polygon: BokehPolygon, uv: vec2f, imageSize: vec2f, amount: f32) -> BokehPolygon
{
    // uv * 2.0 - 1.0 leaves fxc with -1 among its constants, of which it makes breaks never taken
    let place: vec2f = (uv - 0.5) * 2.0 * imageSize / length(imageSize);
    let along: vec2f = BokehRotated(place, vec2f(polygon.axis.x, -polygon.axis.y)) * clamp(amount,
        0.0, 0.9);
    var whole: BokehPolygon = polygon;
    // an edge of the least length stands for none
    whole.lengths *= clamp((polygon.lengths - 0.001) * 100000.0, vec4f(0.0, 0.0, 0.0, 0.0),
        vec4f(1.0, 1.0, 1.0, 1.0));
    var widths: BokehPolygon = polygon;
    widths.lengths = vec4f(BokehHalfWidth(1, whole, along), BokehHalfWidth(2, whole, along),
        BokehHalfWidth(3, whole, along), BokehHalfWidth(4, whole, along));
    widths.fifth = BokehHalfWidth(5, whole, along);
    var result: BokehPolygon = polygon;
    result.lengths = vec4f(BokehCutLength(1, widths), BokehCutLength(2, widths), BokehCutLength(3,
        widths), BokehCutLength(4, widths));
    result.fifth = BokehCutLength(5, widths);
    return BokehUpdatePolygon(result);
}

// -------------------------------------------------------------------------------------------------
// [16] the map, and the finished picture

// Lens: what artists ask of the focus; x in front of it, y behind it
//   sharpRange    metres from the focus distance that stay sharp; the CoC grows from the ends of
//                 this range as from a focus distance there
//   sideScale     factors of the CoC; 0 turns a side off
//   sideMaxCoC    limits of their own, fraction of the image height
struct BokehFocus
{
    sharpRange: vec2f,
    sideScale: vec2f,
    sideMaxCoC: vec2f,
}

// Lens: BokehSignedCoC with a BokehFocus; BokehPackCoC puts it beside the colour
fn BokehFocusedCoC(depth: f32, lens: BokehLens, focus: BokehFocus) -> f32
{
    let middle: f32 = min(lens.focusDistance, BOKEH_MAX_DEPTH);
    var nearest: BokehLens = lens;
    nearest.focusDistance = clamp(depth, middle - focus.sharpRange.x, middle + focus.sharpRange.y);
    let CoC: f32 = BokehSignedCoC(depth, nearest);
    return clamp(min(CoC, 0.0) * focus.sideScale.x + max(CoC, 0.0) * focus.sideScale.y,
        -focus.sideMaxCoC.x, focus.sideMaxCoC.y);
}

// Lens: the map made steady, where temporal anti-aliasing has resolved colour but depth jitters
//   A pixel that was nearer stays so while one of the 3 x 3 around it is, and forgets it slowly;
//   what is nearer now counts at once: resolved colour holds some of it in every frame.
//
//      o  last frame         velocity: from o to x, uv of this frame minus uv of the last, without
//       '--> x  this frame   jitter; negate it where an engine stores the reverse (Godot)
//   MapSamp       from BokehSignedCoCMap; VelocitySamp: rg = velocity; both read texel by texel
//   HistorySamp   what this returned in the last frame, of which a is read; linear filter, clamp
//   blend         share of this frame, 0.05 (docs/taa.md); 1 starts anew: in the first frame,
//                 after a cut, where the viewport has changed
//   returns       the map; a is between the nearest of the 3 x 3 and the pixel's own CoC, which
//                 stays where the last frame did not show the place
fn BokehStableMap(MapSamp: texture_2d<f32>, HistorySamp: texture_2d<f32>,
    VelocitySamp: texture_2d<f32>, uv: vec2f, imageSize: vec2f, blend: f32,
    BokehLinearClamp: sampler) -> vec4f
{
    var pixel: vec4f = BokehFetchTexel(MapSamp, BokehToTexture(uv));
    var nearest: f32 = pixel.a;
    for (var y: i32 = 0; y < 3; y++)
    {
        for (var x: i32 = 0; x < 3; x++)
        {
            let place: vec2f = uv + (vec2f(f32(x), f32(y)) - 1.0) / imageSize;
            nearest = min(nearest, BokehFetchTexel(MapSamp, BokehToTexture(place)).a);
        }
    }
    let velocity: vec2f = BokehFetchTexel(VelocitySamp, BokehToTexture(uv)).rg;
    // NaN leaves the image
    let before: vec2f = uv - vec2f(BokehSanitize(velocity.x, -2.0, 2.0), BokehSanitize(velocity.y,
        -2.0, 2.0));
    let history: f32 = BokehSanitize(BokehFetch(HistorySamp, before, BokehLinearClamp).a, nearest,
        pixel.a);
    if (max(abs(before.x - 0.5), abs(before.y - 0.5)) <= 0.5)
    {
        pixel += vec4f(0.0, 0.0, 0.0, (history - pixel.a) * clamp(1.0 - blend, 0.0, 1.0));
    }
    return pixel;
}

// Lens: lateral colour: the red of a finished picture drawn larger than the green, the blue smaller
//   The last pass after any method; bloom and tone mapping come after it.
//   PictureSamp   linear filter, clamp
//   amount        -0.1 .. 0.1: share of its size that red is larger by, and blue smaller; below 0
//                 the reverse. 0.001 is about a pixel in the corners of 1920 x 1080.
//   returns       green and a are those of this pixel
fn BokehLateralColor(PictureSamp: texture_2d<f32>, uv: vec2f, amount: f32,
    BokehLinearClamp: sampler) -> vec4f
{
    let larger: f32 = clamp(amount, -0.1, 0.1);
    let place: vec2f = uv - 0.5;
    let green: vec4f = BokehFetch(PictureSamp, uv, BokehLinearClamp);
    let red: f32 = BokehFetch(PictureSamp, place / (1.0 + larger) + 0.5, BokehLinearClamp).r;
    let blue: f32 = BokehFetch(PictureSamp, place / (1.0 - larger) + 0.5, BokehLinearClamp).b;
    return vec4f(red, green.g, blue, green.a);
}
