// SPDX-License-Identifier: MIT
//
// The shaders of the Direct3D 9 sample's scene, for shader model 3. They draw colour and depth in metres, and tone-map
// an image for the screen.

float3 eye : register(c0);
float3 right : register(c1);
float3 up : register(c2);
float3 forward : register(c3);
float4 lens : register(c4); // xy: scale from view space to clip space; zw: the depth buffer gets z + w / depth

sampler2D HdrSamp : register(s0);

void Scene_VS(float3 place : POSITION, float4 surface : TEXCOORD0, out float4 position : POSITION,
    out float4 radiance : TEXCOORD0, out float4 placeAndDepth : TEXCOORD1)
{
    float3 way = place - eye;
    float depth = dot(way, forward);
    position = float4(dot(way, right) * lens.x, dot(way, up) * lens.y, depth * lens.z + lens.w, depth);
    radiance = surface;
    placeAndDepth = float4(place, depth);
}

// returns linear HDR colour; chequered surfaces have squares of 0.125 m
float4 SceneColor_PS(float4 radiance : TEXCOORD0, float4 placeAndDepth : TEXCOORD1) : COLOR
{
    float3 cell = floor(placeAndDepth.xyz * 8.0 + 0.5);
    float odd = frac(0.5 * (cell.x + cell.y + cell.z)) * 2.0;
    return float4(radiance.rgb * (1.0 - 0.7 * odd * radiance.a), 1.0);
}

// returns depth in metres along the view axis, for an R32F target
float4 SceneDepth_PS(float4 radiance : TEXCOORD0, float4 placeAndDepth : TEXCOORD1) : COLOR
{
    return float4(placeAndDepth.w, 0.0, 0.0, 1.0);
}

// tone-maps a texture for the screen, after all other passes
float4 Display_PS(float2 uv : TEXCOORD0) : COLOR
{
    float3 color = tex2D(HdrSamp, uv).rgb;
    return float4(pow(max(color / (1.0 + color), 0.0), 1.0 / 2.2), 1.0);
}
