// Floor of a filter pass: the same fetches at the same places, only added up. bench/floors.py puts the library before
// this file, and a main() with the lines of one pass after it.

uniform sampler2D BokehColorSamp;
uniform sampler2D BokehDepthSamp;
uniform sampler2D BokehColorSampB;
uniform sampler2D BokehColorSampC;
uniform sampler2D BokehColorSampD;
in vec2 BokehUV;

// Samples first, first + between .., as many as `count`; `deep`: depth is fetched too
vec4 FloorLine(sampler2D color, sampler2D depth, bool deep, vec2 first, vec2 between, int count)
{
    vec4 colors = vec4(0.0, 0.0, 0.0, 0.0);
    float depths = 0.0;
    for (int i = 0; i < count; i++)
    {
        vec2 coords = first + between * float(i);
        colors += BokehFetch(color, coords);
        if (deep)
        {
            depths += BokehFetchNearest(depth, coords).r;
        }
    }
    return colors + depths;
}

// The same over side x side samples
vec4 FloorGrid(sampler2D color, sampler2D depth, bool deep, vec2 first, vec2 betweenU, vec2 betweenV, int side)
{
    vec4 colors = vec4(0.0, 0.0, 0.0, 0.0);
    float depths = 0.0;
    for (int j = 0; j < side; j++)
    {
        vec2 row = first + betweenV * float(j);
        for (int i = 0; i < side; i++)
        {
            vec2 coords = row + betweenU * float(i);
            colors += BokehFetch(color, coords);
            if (deep)
            {
                depths += BokehFetchNearest(depth, coords).r;
            }
        }
    }
    return colors + depths;
}

// As many samples as the line needs, where BokehLineSum has them; `halfLine` from its middle to its end, uv
vec4 FloorAdaptive(sampler2D color, sampler2D depth, bool deep, vec2 middle, vec2 halfLine, float cells, int most)
{
    vec2 cellLength = halfLine * (2.0 / cells);
    vec4 colors = vec4(0.0, 0.0, 0.0, 0.0);
    float depths = 0.0;
    for (int i = 0; i < most; i++)
    {
        if (float(i) >= cells)
        {
            break;
        }
        vec2 coords = middle - halfLine + cellLength * (float(i) + 0.5 * clamp(cells - float(i), 0.0, 1.0));
        colors += BokehFetch(color, coords);
        if (deep)
        {
            depths += BokehFetchNearest(depth, coords).r;
        }
    }
    return colors + depths;
}
