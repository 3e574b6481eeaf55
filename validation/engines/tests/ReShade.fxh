// What PolygonalBokeh.fx needs of ReShade's header of this name; colour and depth are pictures that test_reshade.py
// writes, of 16 bits in two channels the latter.

texture KnownColor < source = "color.png"; > { Width = BUFFER_WIDTH; Height = BUFFER_HEIGHT; Format = RGBA8; };
texture KnownDepth < source = "depth.png"; > { Width = BUFFER_WIDTH; Height = BUFFER_HEIGHT; Format = RGBA8; };

namespace ReShade
{
    sampler BackBuffer { Texture = KnownColor; MinFilter = POINT; MagFilter = POINT; };
    sampler DepthBuffer { Texture = KnownDepth; MinFilter = POINT; MagFilter = POINT; };

    float GetLinearizedDepth(float2 uv)
    {
        return dot(tex2Dlod(DepthBuffer, float4(uv, 0.0, 0.0)).rg, float2(65280.0, 255.0)) / 65535.0;
    }
}

void PostProcessVS(in uint id : SV_VertexID, out float4 position : SV_Position, out float2 uv : TEXCOORD)
{
    uv = float2(id == 2 ? 2.0 : 0.0, id == 1 ? 2.0 : 0.0);
    position = float4(uv * float2(2.0, -2.0) + float2(-1.0, 1.0), 0.0, 1.0);
}
