// Floor of a filter pass: the same fetches at the same places, only added up. bench/floors.py puts the library before
// this file, and an entry with the lines of one pass after it.

// Samples first, first + between .., as many as `count`; `deep`: depth is fetched too
float4 FloorLine(BOKEH_TEXTURE(color), BOKEH_TEXELS(depth), bool deep, float2 first, float2 between, int count)
{
    float4 colors = float4(0.0, 0.0, 0.0, 0.0);
    float depths = 0.0;
    BOKEH_LOOP for (int i = 0; i < count; i++)
    {
        float2 coords = first + between * float(i);
        colors += BokehFetch(BOKEH_ARGUMENT(color), coords);
        if (deep)
        {
            depths += BokehFetchNearest(depth, coords).r;
        }
    }
    return colors + depths;
}

// The same over side x side samples
float4 FloorGrid(BOKEH_TEXTURE(color), BOKEH_TEXELS(depth), bool deep, float2 first, float2 betweenU, float2 betweenV,
    int side)
{
    float4 colors = float4(0.0, 0.0, 0.0, 0.0);
    float depths = 0.0;
    BOKEH_LOOP for (int j = 0; j < side; j++)
    {
        float2 row = first + betweenV * float(j);
        BOKEH_LOOP for (int i = 0; i < side; i++)
        {
            float2 coords = row + betweenU * float(i);
            colors += BokehFetch(BOKEH_ARGUMENT(color), coords);
            if (deep)
            {
                depths += BokehFetchNearest(depth, coords).r;
            }
        }
    }
    return colors + depths;
}

// As many samples as the line needs, where BokehLineSum has them; `halfLine` from its middle to its end, uv
float4 FloorAdaptive(BOKEH_TEXTURE(color), BOKEH_TEXELS(depth), bool deep, float2 middle, float2 halfLine, float cells, int most)
{
    float2 cellLength = halfLine * (2.0 / cells);
    float4 colors = float4(0.0, 0.0, 0.0, 0.0);
    float depths = 0.0;
    BOKEH_LOOP for (int i = 0; i < most; i++)
    {
        if (float(i) >= cells)
        {
            break;
        }
        float2 coords = middle - halfLine + cellLength * (float(i) + 0.5 * clamp(cells - float(i), 0.0, 1.0));
        colors += BokehFetch(BOKEH_ARGUMENT(color), coords);
        if (deep)
        {
            depths += BokehFetchNearest(depth, coords).r;
        }
    }
    return colors + depths;
}
