// Floor of a filter pass: the same fetches at the same places, only added up. bench/floors.py puts the library before
// this file, and an entry with the lines of one pass after it.

// Samples first, first + between .., as many as `count`; `deep`: depth is fetched too
fn FloorLine(color: texture_2d<f32>, colorSampler: sampler, depth: texture_2d<f32>, deep: bool, first: vec2f,
    between: vec2f, count: i32) -> vec4f
{
    var colors: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var depths: f32 = 0.0;
    for (var i: i32 = 0; i < count; i++)
    {
        let coords: vec2f = first + between * f32(i);
        colors += BokehFetch(color, colorSampler, coords);
        if (deep)
        {
            depths += BokehFetchNearest(depth, coords).r;
        }
    }
    return colors + depths;
}

// The same over side x side samples
fn FloorGrid(color: texture_2d<f32>, colorSampler: sampler, depth: texture_2d<f32>, deep: bool, first: vec2f,
    betweenU: vec2f, betweenV: vec2f, side: i32) -> vec4f
{
    var colors: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var depths: f32 = 0.0;
    for (var j: i32 = 0; j < side; j++)
    {
        let row: vec2f = first + betweenV * f32(j);
        for (var i: i32 = 0; i < side; i++)
        {
            let coords: vec2f = row + betweenU * f32(i);
            colors += BokehFetch(color, colorSampler, coords);
            if (deep)
            {
                depths += BokehFetchNearest(depth, coords).r;
            }
        }
    }
    return colors + depths;
}

// As many samples as the line needs, where BokehLineSum has them; `halfLine` from its middle to its end, uv
fn FloorAdaptive(color: texture_2d<f32>, colorSampler: sampler, depth: texture_2d<f32>, deep: bool,
    middle: vec2f, halfLine: vec2f, cells: f32, most: i32) -> vec4f
{
    let cellLength: vec2f = halfLine * (2.0 / cells);
    var colors: vec4f = vec4f(0.0, 0.0, 0.0, 0.0);
    var depths: f32 = 0.0;
    for (var i: i32 = 0; i < most; i++)
    {
        if (f32(i) >= cells)
        {
            break;
        }
        let coords: vec2f = middle - halfLine + cellLength * (f32(i) + 0.5 * clamp(cells - f32(i), 0.0, 1.0));
        colors += BokehFetch(color, colorSampler, coords);
        if (deep)
        {
            depths += BokehFetchNearest(depth, coords).r;
        }
    }
    return colors + depths;
}
