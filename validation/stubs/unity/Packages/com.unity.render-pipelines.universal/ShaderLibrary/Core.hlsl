// Stand-in for Core.hlsl of URP 17: names only, and macros that may clash with a library's names.
#ifndef STUB_UNITY_CORE
#define STUB_UNITY_CORE

#define SHADER_API_D3D11 1
#define UNITY_REVERSED_Z 1
#define UNITY_UV_STARTS_AT_TOP 1

// the type `half` is what the project's precision makes of it
#ifndef STUB_HALF
#define STUB_HALF float
#endif
#define half STUB_HALF
#define real half
#define real4 half
#define REAL_MIN 0.0
#define REAL_MAX 65504.0
#define HALF_MAX 65504.0
#define HALF_MIN 6.103515625e-5
#define FLT_MAX 3.402823466e+38
#define PI 3.14159265
#define TWO_PI 6.28318531
#define HALF_PI 1.57079632
#define INV_PI 0.31830988

#define UNITY_BRANCH [branch]
#define UNITY_FLATTEN [flatten]
#define UNITY_UNROLL [unroll]
#define UNITY_LOOP [loop]
#define CBUFFER_START(name) cbuffer name {
#define CBUFFER_END };
#define ZERO_INITIALIZE(type, name) name = (type)0;

#define TEXTURE2D(textureName) Texture2D textureName
#define TEXTURE2D_ARRAY(textureName) Texture2DArray textureName
#define TEXTURE2D_FLOAT(textureName) Texture2D textureName
#define SAMPLER(samplerName) SamplerState samplerName
#define TEXTURE2D_PARAM(textureName, samplerName) Texture2D textureName, SamplerState samplerName
#define TEXTURE2D_ARGS(textureName, samplerName) textureName, samplerName
#define SAMPLE_TEXTURE2D(textureName, samplerName, coord) textureName.Sample(samplerName, coord)
#define SAMPLE_TEXTURE2D_LOD(textureName, samplerName, coord, lod) textureName.SampleLevel(samplerName, coord, lod)
#define LOAD_TEXTURE2D(textureName, coord) textureName.Load(int3(coord, 0))

#ifdef STUB_STEREO
#define UNITY_STEREO_INSTANCING_ENABLED
#define TEXTURE2D_X(textureName) TEXTURE2D_ARRAY(textureName)
#define TEXTURE2D_X_FLOAT(textureName) TEXTURE2D_ARRAY(textureName)
#define SAMPLE_TEXTURE2D_X_LOD(textureName, samplerName, coord, lod) textureName.SampleLevel(samplerName, \
    float3(coord, 0.0), lod)
#else
#define TEXTURE2D_X(textureName) TEXTURE2D(textureName)
#define TEXTURE2D_X_FLOAT(textureName) TEXTURE2D_FLOAT(textureName)
#define SAMPLE_TEXTURE2D_X_LOD SAMPLE_TEXTURE2D_LOD
#endif

#define UNITY_VERTEX_INPUT_INSTANCE_ID
#define UNITY_VERTEX_OUTPUT_STEREO
#define UNITY_SETUP_INSTANCE_ID(input)
#define UNITY_INITIALIZE_VERTEX_OUTPUT_STEREO(output)
#define UNITY_SETUP_STEREO_EYE_INDEX_POST_VERTEX(input)

float4 _ZBufferParams;
float4 _ProjectionParams;
float4 _ScreenParams;
float4 unity_OrthoParams;

float Sq(float x) { return x * x; }
float Min3(float a, float b, float c) { return min(min(a, b), c); }
float Max3(float a, float b, float c) { return max(max(a, b), c); }
float Luminance(float3 linearRgb) { return dot(linearRgb, float3(0.2126729, 0.7151522, 0.0721750)); }
float LinearEyeDepth(float depth, float4 zBufferParam) { return 1.0 / (zBufferParam.z * depth + zBufferParam.w); }
float2 GetFullScreenTriangleTexCoord(uint id) { return float2((id << 1) & 2, 1.0 - (id & 2)); }
float4 GetFullScreenTriangleVertexPosition(uint id) { return float4((id << 1) & 2, id & 2, 0.5, 1.0) * 2.0 - 1.0; }
float Linear01Depth(float depth, float4 zBufferParam) { return 1.0 / (zBufferParam.x * depth + zBufferParam.y); }

#endif
