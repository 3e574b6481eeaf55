// SPDX-License-Identifier: MIT
//
// The shaders of the Direct3D 11 sample's scene, for shader model 5. They draw colour and the depth buffer, and
// tone-map an image for the screen.

cbuffer Camera : register(b0)
{
    float4 eye, right, up, forward;
    float4 lens; // xy: scale from view space to clip space; zw: the depth buffer gets z + w / depth
}

Texture2D Hdr : register(t0);
SamplerState Nearest : register(s1);

struct Surface
{
    float4 position : SV_Position;
    float4 radiance : TEXCOORD0; // a: 1 if the surface is chequered, else 0
    float3 place : TEXCOORD1;
};

Surface Scene_VS(float3 place : POSITION, float4 radiance : RADIANCE)
{
    float3 way = place - eye.xyz;
    float depth = dot(way, forward.xyz);
    Surface surface;
    surface.position = float4(dot(way, right.xyz) * lens.x, dot(way, up.xyz) * lens.y, depth * lens.z + lens.w, depth);
    surface.radiance = radiance;
    surface.place = place;
    return surface;
}

// returns linear HDR colour; chequered surfaces have squares of 0.125 m
float4 Scene_PS(Surface surface) : SV_Target
{
    float3 cell = floor(surface.place * 8.0 + 0.5);
    float odd = frac(0.5 * (cell.x + cell.y + cell.z)) * 2.0;
    return float4(surface.radiance.rgb * (1.0 - 0.7 * odd * surface.radiance.a), 1.0);
}

// tone-maps a texture for the screen, after all other passes
float4 Display_PS(float4 position : SV_Position, float2 uv : TEXCOORD0) : SV_Target
{
    float3 color = Hdr.SampleLevel(Nearest, uv, 0.0).rgb;
    return float4(pow(max(color / (1.0 + color), 0.0), 1.0 / 2.2), 1.0);
}
