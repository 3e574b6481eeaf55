// Stand-in for Blit.hlsl of the core package 17. Core.hlsl comes before it.
#ifndef STUB_UNITY_BLIT
#define STUB_UNITY_BLIT

TEXTURE2D_X(_BlitTexture);
SamplerState sampler_PointClamp;
SamplerState sampler_LinearClamp;
SamplerState sampler_PointRepeat;
SamplerState sampler_LinearRepeat;
float4 _BlitScaleBias;
float4 _BlitTexture_TexelSize;
float _BlitMipLevel;

struct Attributes
{
    uint vertexID : SV_VertexID;
    UNITY_VERTEX_INPUT_INSTANCE_ID
};

struct Varyings
{
    float4 positionCS : SV_POSITION;
    float2 texcoord : TEXCOORD0;
    UNITY_VERTEX_OUTPUT_STEREO
};

Varyings Vert(Attributes input)
{
    Varyings output;
    float2 corner = float2(input.vertexID == 1 ? 2.0 : 0.0, input.vertexID == 2 ? 2.0 : 0.0);
    output.positionCS = float4(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0);
    output.texcoord = corner * _BlitScaleBias.xy + _BlitScaleBias.zw;
    return output;
}

float4 FragNearest(Varyings input) : SV_Target
{
    return SAMPLE_TEXTURE2D_X_LOD(_BlitTexture, sampler_PointClamp, input.texcoord, _BlitMipLevel);
}

#endif
