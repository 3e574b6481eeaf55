// SPDX-License-Identifier: MIT
//
// The character of a lens, GLSL. Version 0.3.0. Put it after bokeh.glsl.
//
//   BokehWithRoundness, BokehWithCatsEye   change a BokehPolygon; pass the result to any function
//                                          of `exact` or `layered` that takes a polygon
//   BokehFocusedCoC                        computes the CoC of a focus that artists can bend
//   BokehStableMap                         is a pass after the CoC map, for temporal anti-aliasing
//   BokehLateralColor                      is a pass after the finished image
//
//   Axial colour needs no function: docs/methods/character.md has a recipe.
//   Functions only: no bindings, no entry points.

#ifndef BOKEH_VIEWPORT
#error put bokeh.glsl before bokeh_lens.glsl
#endif
#define BOKEH_LENS 1

// -------------------------------------------------------------------------------------------------
// [15] apertures

// Lens: recomputes the corner, mean and area of a polygon whose lengths have changed
BokehPolygon BokehUpdatePolygon(BokehPolygon polygon)
{
    BokehPolygon closed = polygon;
    closed.mean = vec2(0.0, 0.0);
    closed.area = 0.0;
    vec2 begin = vec2(0.0, 0.0);
    for (int i = 1; i <= polygon.sides / 2; i++)
    {
        vec2 edge = BokehEdge(i, polygon);
        if (i < polygon.sides / 2)
        {
            closed.mean += (begin + edge * 0.5) / (0.5 * float(polygon.sides) - 1.0);
        }
        closed.area += begin.x * edge.y - begin.y * edge.x;
        begin += edge;
    }
    // the other half of the outline leads back, so the centre is half-way
    closed.corner = begin * -0.5;
    closed.mean += closed.corner;
    return closed;
}

// Lens: curves the blades of an octagon; returns any other polygon unchanged
//   The corners stay on the circle of confusion. (fxc for shader model 3 drops a max around a sin.)
//   roundness     0: a square; 1: a regular octagon; between: a square with its corners cut off
BokehPolygon BokehWithRoundness(BokehPolygon polygon, float roundness)
{
    BokehPolygon result = polygon;
    if (polygon.sides == 8)
    {
        float corner = 0.39269908 * clamp(roundness, 0.0, 1.0);
        vec4 sines = BokehSines(vec4(max(corner, 0.001), 0.78539816 - corner, 0.0, 0.0));
        result.lengths = sines.xyxy;
        result = BokehUpdatePolygon(result);
    }
    return result;
}

// Lens: computes how far each edge of a polygon is from the centre
//   One loop serves all edges, here and in BokehCutLengths: with a loop for each edge, some drivers
//   compile for 20 seconds.
//   along         cut as a vector: the fraction of that distance by which an edge moves inwards
//   returns       a polygon whose lengths are these distances, in units of the CoC
BokehPolygon BokehHalfWidths(BokehPolygon polygon, vec2 along)
{
    float angle = 6.28318531 / float(polygon.sides);
    vec4 k = vec4(1.0, 2.0, 3.0, 4.0);
    BokehPolygon widths = polygon;
    widths.lengths = vec4(0.0, 0.0, 0.0, 0.0);
    widths.fifth = 0.0;
    for (int i = 1; i <= polygon.sides / 2; i++)
    {
        float halfEdge = 0.5 * BokehEdgeLength(i, polygon);
        widths.lengths += halfEdge * abs(BokehSines(angle * (float(i) - k)));
        widths.fifth += halfEdge * abs(BokehCosSin(angle * (float(i) - 5.0)).y);
    }
    widths.lengths *= 1.0 - abs(along.x * BokehSines(angle * k + 1.57079633) + along.y *
        BokehSines(angle * k));
    // only a decagon has an edge 5, which faces along the x axis
    widths.fifth *= 1.0 - abs(along.x);
    return widths;
}

// Lens: returns the lengths of the edges first .. first + 3
vec4 BokehFourLengths(int first, BokehPolygon polygon)
{
    return vec4(BokehEdgeLength(first, polygon), BokehEdgeLength(first + 1, polygon),
        BokehEdgeLength(first + 2, polygon), BokehEdgeLength(first + 3, polygon));
}

// Lens: computes the length of each edge between the lines of all other edges
//
//      before after
//      ,---+---,   An edge lies on a line half a width away from the centre. On each side it ends
//     /    |    '  where the nearest of the other lines crosses it.
//
//   widths        from BokehHalfWidths
//   returns       a polygon with these lengths, in units of the CoC: at least 0.001, so that no
//                 weights add up to 0
BokehPolygon BokehCutLengths(BokehPolygon widths)
{
    int edges = widths.sides / 2;
    vec4 before = vec4(1.0, 1.0, 1.0, 1.0);
    vec4 after = vec4(1.0, 1.0, 1.0, 1.0);
    vec2 fifth = vec2(1.0, 1.0);
    for (int i = 1; i < edges; i++)
    {
        vec2 turn = BokehTurn(float(i), widths);
        before = min(before, (BokehFourLengths(1 - i + edges, widths) - widths.lengths * turn.x) /
            turn.y);
        after = min(after, (BokehFourLengths(1 + i, widths) - widths.lengths * turn.x) / turn.y);
        vec2 others = vec2(BokehEdgeLength(5 - i + edges, widths), BokehEdgeLength(5 + i, widths));
        fifth = min(fifth, (others - widths.fifth * turn.x) / turn.y);
    }
    BokehPolygon cut = widths;
    cut.lengths = max(before + after, vec4(0.001, 0.001, 0.001, 0.001));
    cut.fifth = max(fifth.x + fifth.y, 0.001);
    return cut;
}

// Lens: cuts a polygon as the lens barrel does, more towards the corners of the image
//   The front and the rear rim of the barrel are two copies of the polygon, shifted apart, and the
//   bokeh is their overlap. So its centre does not move, near and far blur look the same, and the
//   result has the same edges, some of them shorter.
//   amount        0 .. 0.9: fraction of the width that is missing in the corners of the image; half
//                 of it is missing half-way to them
BokehPolygon BokehWithCatsEye(BokehPolygon polygon, vec2 uv, vec2 imageSize, float amount)
{
    // uv * 2.0 - 1.0 leaves fxc with -1 among its constants, of which it makes breaks never taken
    vec2 place = (uv - 0.5) * 2.0 * imageSize / length(imageSize);
    vec2 along = BokehRotated(place, vec2(polygon.axis.x, -polygon.axis.y)) * clamp(amount, 0.0,
        0.9);
    BokehPolygon uncut = polygon;
    // an edge of the minimum length means that there is none
    uncut.lengths *= clamp((polygon.lengths - 0.001) * 100000.0, vec4(0.0, 0.0, 0.0, 0.0), vec4(1.0,
        1.0, 1.0, 1.0));
    return BokehUpdatePolygon(BokehCutLengths(BokehHalfWidths(uncut, along)));
}

// -------------------------------------------------------------------------------------------------
// [16] the CoC map, and the finished image

// Lens: lets artists bend the focus; x is in front of the focus distance, y behind it
//   sharpRange    metres that stay in focus; the CoC grows from the ends of this range as it does
//                 from a focus distance there
//   sideScale     factors of the CoC; 0 turns the blur of a side off
//   sideMaxCoC    limits of the CoC, fractions of the image height
struct BokehFocus
{
    vec2 sharpRange;
    vec2 sideScale;
    vec2 sideMaxCoC;
};

// Lens: computes the signed CoC as BokehSignedCoC does, with a BokehFocus
//   Pass the result to BokehPackCoC.
//   depth         metres
//   returns       fraction of the image height, below 0 in front of the focus
float BokehFocusedCoC(float depth, BokehLens lens, BokehFocus focus)
{
    float middle = min(lens.focusDistance, BOKEH_MAX_DEPTH);
    BokehLens nearest = lens;
    nearest.focusDistance = clamp(depth, middle - focus.sharpRange.x, middle + focus.sharpRange.y);
    float CoC = BokehSignedCoC(depth, nearest);
    return clamp(min(CoC, 0.0) * focus.sideScale.x + max(CoC, 0.0) * focus.sideScale.y,
        -focus.sideMaxCoC.x, focus.sideMaxCoC.y);
}

// Lens: makes the CoC map steady where temporal anti-aliasing resolves colour while depth jitters
//   A pixel that was nearer in the last frame stays nearer as long as one of its 3 x 3 neighbours
//   is. A pixel that becomes nearer changes at once, because resolved colour has some of the near
//   object in every frame.
//
//      o  last frame         velocity points from o to x: uv of this frame minus uv of the last,
//       '--> x  this frame   without jitter. Negate it if your engine stores the reverse (Godot).
//   MapSamp       from BokehSignedCoCMap, read texel by texel
//   HistorySamp   what this function returned in the last frame (a is read); linear filter, clamp
//   VelocitySamp  rg = velocity, uv; read texel by texel
//   imageSize     width and height, pixels
//   blend         weight of this frame: 0, or 1 to start anew in the first frame, after a cut, and
//                 when the viewport has changed
//   returns       the map; a lies between the nearest CoC of the 3 x 3 and the pixel's own, and is
//                 the pixel's own where the last frame did not show this point
vec4 BokehStableMap(BOKEH_TEXTURE MapSamp, BOKEH_TEXTURE HistorySamp, BOKEH_TEXTURE VelocitySamp,
    vec2 uv, vec2 imageSize, float blend)
{
    vec4 pixel = BokehFetchTexel(MapSamp, BokehToTexture(uv));
    float nearest = pixel.a;
    for (int y = 0; y < 3; y++)
    {
        for (int x = 0; x < 3; x++)
        {
            vec2 place = uv + (vec2(float(x), float(y)) - 1.0) / imageSize;
            nearest = min(nearest, BokehFetchTexel(MapSamp, BokehToTexture(place)).a);
        }
    }
    vec2 velocity = BokehFetchTexel(VelocitySamp, BokehToTexture(uv)).rg;
    // NaN becomes an offset that leaves the image
    vec2 before = uv - vec2(BokehSanitize(velocity.x, -2.0, 2.0), BokehSanitize(velocity.y, -2.0,
        2.0));
    float history = BokehSanitize(BokehFetch(HistorySamp, before).a, nearest, pixel.a);
    if (max(abs(before.x - 0.5), abs(before.y - 0.5)) <= 0.5)
    {
        pixel += vec4(0.0, 0.0, 0.0, (history - pixel.a) * clamp(1.0 - blend, 0.0, 1.0));
    }
    return pixel;
}

// Lens: draws lateral colour: the red of a finished image larger than the green, the blue smaller
//   Draw it after any method, and before bloom and tone mapping.
//   ImageSamp     the finished image; linear filter, clamp
//   amount        -0.1 .. 0.1: fraction by which red is larger and blue is smaller, reversed below
//                 0; 0.001 is about one pixel in the corners of 1920 x 1080
//   returns       red and blue of other pixels; green and alpha of this one
vec4 BokehLateralColor(BOKEH_TEXTURE ImageSamp, vec2 uv, float amount)
{
    float larger = clamp(amount, -0.1, 0.1);
    vec2 place = uv - 0.5;
    vec4 green = BokehFetch(ImageSamp, uv);
    float red = BokehFetch(ImageSamp, place / (1.0 + larger) + 0.5).r;
    float blue = BokehFetch(ImageSamp, place / (1.0 - larger) + 0.5).b;
    return vec4(red, green.g, blue, green.a);
}
