// SPDX-License-Identifier: MIT
//
// The character of a lens, HLSL. Version 0.3.0. Put it after bokeh.hlsl.
//
//   Curved blades and a cat's eye are functions from polygon to polygon: what they return goes
//   wherever a BokehPolygon goes, in `exact` and in the layers. A focus that artists can bend is
//   another CoC in the map; a steady map is a pass after the map, lateral colour one over the
//   finished picture. Axial colour is a recipe: docs/methods/character.md.
//   Functions only: no bindings, no entry points.

#ifndef BOKEH_VIEWPORT
#error put bokeh.hlsl before bokeh_lens.hlsl
#endif
#define BOKEH_LENS 1

// -------------------------------------------------------------------------------------------------
// [15] apertures

// Lens: a polygon whose lengths have changed, with what follows from them
BokehPolygon BokehUpdatePolygon(BokehPolygon polygon)
{
    BokehPolygon closed = polygon;
    closed.mean = float2(0.0, 0.0);
    closed.area = 0.0;
    float2 begin = float2(0.0, 0.0);
    BOKEH_LOOP for (int i = 1; i <= polygon.sides / 2; i++)
    {
        float2 edge = BokehEdge(i, polygon);
        if (i < polygon.sides / 2)
        {
            closed.mean += (begin + edge * 0.5) / (0.5 * float(polygon.sides) - 1.0);
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
BokehPolygon BokehWithRoundness(BokehPolygon polygon, float roundness)
{
    BokehPolygon result = polygon;
    if (polygon.sides == 8)
    {
        float corner = 0.39269908 * clamp(roundness, 0.0, 1.0);
        float odd = sin(max(corner, 0.001));
        float even = sin(0.78539816 - corner);
        result.lengths = float4(odd, even, odd, even);
        result = BokehUpdatePolygon(result);
    }
    return result;
}

// Lens: distance of edge k from the middle of a polygon
//   along         the cut: by how much of that distance the edge moves to the middle, as a vector
float BokehHalfWidth(int k, BokehPolygon polygon, float2 along)
{
    float width = 0.0;
    BOKEH_LOOP for (int i = 1; i <= polygon.sides / 2; i++)
    {
        width += abs(BokehTurn(float(i - k), polygon).y) * BokehEdgeLength(i, polygon);
    }
    return 0.5 * width * (1.0 - abs(dot(along, BokehTurn(float(k), polygon))));
}

// Lens: length of edge k between the lines of all other edges
//
//      before after
//      ,---+---,   edge k is on a line half a width from the middle; on both sides it ends where
//     /    |    '  the nearest of the other lines crosses that one
//
//   widths        a polygon whose lengths are the half widths of the edges
//   returns       0.001 where nothing is left, so that no weights add up to 0
float BokehCutLength(int k, BokehPolygon widths)
{
    float halfWidth = BokehEdgeLength(k, widths);
    int edges = widths.sides / 2;
    float2 ends = float2(1.0, 1.0);
    BOKEH_LOOP for (int i = 1; i < edges; i++)
    {
        float2 turn = BokehTurn(float(i), widths);
        float2 others = float2(BokehEdgeLength(k - i + edges, widths), BokehEdgeLength(k + i,
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
BokehPolygon BokehWithCatsEye(BokehPolygon polygon, float2 uv, float2 imageSize, float amount)
{
    // uv * 2.0 - 1.0 leaves fxc with -1 among its constants, of which it makes breaks never taken
    float2 place = (uv - 0.5) * 2.0 * imageSize / length(imageSize);
    float2 along = BokehRotated(place, float2(polygon.axis.x, -polygon.axis.y)) * clamp(amount, 0.0,
        0.9);
    BokehPolygon whole = polygon;
    // an edge of the least length stands for none
    whole.lengths *= clamp((polygon.lengths - 0.001) * 100000.0, float4(0.0, 0.0, 0.0, 0.0),
        float4(1.0, 1.0, 1.0, 1.0));
    BokehPolygon widths = polygon;
    widths.lengths = float4(BokehHalfWidth(1, whole, along), BokehHalfWidth(2, whole, along),
        BokehHalfWidth(3, whole, along), BokehHalfWidth(4, whole, along));
    widths.fifth = BokehHalfWidth(5, whole, along);
    BokehPolygon result = polygon;
    result.lengths = float4(BokehCutLength(1, widths), BokehCutLength(2, widths), BokehCutLength(3,
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
    float2 sharpRange;
    float2 sideScale;
    float2 sideMaxCoC;
};

// Lens: BokehSignedCoC with a BokehFocus; BokehPackCoC puts it beside the colour
float BokehFocusedCoC(float depth, BokehLens lens, BokehFocus focus)
{
    float middle = min(lens.focusDistance, BOKEH_MAX_DEPTH);
    BokehLens nearest = lens;
    nearest.focusDistance = clamp(depth, middle - focus.sharpRange.x, middle + focus.sharpRange.y);
    float CoC = BokehSignedCoC(depth, nearest);
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
float4 BokehStableMap(BOKEH_TEXTURE MapSamp, BOKEH_TEXTURE HistorySamp, BOKEH_TEXTURE VelocitySamp,
    float2 uv, float2 imageSize, float blend BOKEH_SAMPLER)
{
    float4 pixel = BokehFetchTexel(MapSamp, BokehToTexture(uv));
    float nearest = pixel.a;
    for (int y = 0; y < 3; y++)
    {
        for (int x = 0; x < 3; x++)
        {
            float2 place = uv + (float2(float(x), float(y)) - 1.0) / imageSize;
            nearest = min(nearest, BokehFetchTexel(MapSamp, BokehToTexture(place)).a);
        }
    }
    float2 velocity = BokehFetchTexel(VelocitySamp, BokehToTexture(uv)).rg;
    // NaN leaves the image
    float2 before = uv - float2(BokehSanitize(velocity.x, -2.0, 2.0), BokehSanitize(velocity.y,
        -2.0, 2.0));
    float history = BokehSanitize(BokehFetch(HistorySamp, before BOKEH_LINEAR).a, nearest, pixel.a);
    if (max(abs(before.x - 0.5), abs(before.y - 0.5)) <= 0.5)
    {
        pixel += float4(0.0, 0.0, 0.0, (history - pixel.a) * clamp(1.0 - blend, 0.0, 1.0));
    }
    return pixel;
}

// Lens: lateral colour: the red of a finished picture drawn larger than the green, the blue smaller
//   The last pass after any method; bloom and tone mapping come after it.
//   PictureSamp   linear filter, clamp
//   amount        -0.1 .. 0.1: share of its size that red is larger by, and blue smaller; below 0
//                 the reverse. 0.001 is about a pixel in the corners of 1920 x 1080.
//   returns       green and a are those of this pixel
float4 BokehLateralColor(BOKEH_TEXTURE PictureSamp, float2 uv, float amount BOKEH_SAMPLER)
{
    float larger = clamp(amount, -0.1, 0.1);
    float2 place = uv - 0.5;
    float4 green = BokehFetch(PictureSamp, uv BOKEH_LINEAR);
    float red = BokehFetch(PictureSamp, place / (1.0 + larger) + 0.5 BOKEH_LINEAR).r;
    float blue = BokehFetch(PictureSamp, place / (1.0 - larger) + 0.5 BOKEH_LINEAR).b;
    return float4(red, green.g, blue, green.a);
}
