// SPDX-License-Identifier: MIT
// The passes of BokehRendererFeature.cs, Unity 6 (6000.0), URP 17. Needs bokeh.hlsl and bokeh_paper.hlsl beside it.

Shader "Hidden/BokehDepthOfField"
{
    HLSLINCLUDE

    #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
    #include "Packages/com.unity.render-pipelines.core/Runtime/Utilities/Blit.hlsl"

    #ifdef USE_TEXTURE2D_X_AS_ARRAY
    #error Bokeh: single-pass instanced rendering has texture arrays; set the XR plug-in to multi-pass
    #endif

    // textures and samplers as Direct3D 11 has them; Unity translates that for all of its platforms
    #define BOKEH_HLSL_SM 5
    // the preset is MEDIUM; for another: #define BOKEH_PRESET_HIGH
    #include "bokeh.hlsl"
    #include "bokeh_paper.hlsl"

    // _BlitTexture, of Blit.hlsl, is what a pass reads first: colour, or what the pass before made
    // _BokehDepth: the camera's depth texture; in Line, LineFinal and CoCMap metres, which Depth has made
    TEXTURE2D(_BokehDepth);
    TEXTURE2D(_BokehColorB);
    TEXTURE2D(_BokehColorC);

    // metres
    float _BokehApertureDiameter, _BokehFocalLength, _BokehFocusDistance, _BokehSensorHeight;
    // fraction of the image height
    float _BokehMaxCoC;
    float _BokehSqueeze;
    // pixels
    float2 _BokehImageSize;
    // radians: rotation of the polygon (exact), direction of the line (paper)
    float _BokehAngle;
    float _BokehDebugMode;

    // Whatever the platform has, reversed or not, to metres along the view axis
    float BokehMetres(float2 uv)
    {
        float depth = LinearEyeDepth(BokehFetchDepth(_BokehDepth, uv), _ZBufferParams);
        return BokehSafe(depth, BOKEH_MIN_DEPTH, BOKEH_MAX_DEPTH);
    }

    float DepthFragment(Varyings input) : SV_Target
    {
        return BokehMetres(input.texcoord);
    }

    BokehLens BokehGivenLens()
    {
        BokehLens lens = BokehMakeLens(_BokehApertureDiameter, _BokehFocalLength, _BokehFocusDistance);
        lens.sensorHeight = _BokehSensorHeight;
        lens.maxCoC = _BokehMaxCoC;
        return lens;
    }

    float4 SignedCoCMapFragment(Varyings input) : SV_Target
    {
        float4 color = BokehFetchTexel(_BlitTexture, input.texcoord);
        return BokehPackCoC(color, BokehSignedCoC(BokehMetres(input.texcoord), BokehGivenLens()));
    }

    // The paper's way: a CoC without a sign
    float4 CoCMapFragment(Varyings input) : SV_Target
    {
        return BokehCoCMap(_BlitTexture, _BokehDepth, input.texcoord, BokehGivenLens());
    }

    BokehPolygon BokehAperture(int sides)
    {
        return BokehMakePolygon(sides, _BokehAngle, _BokehSqueeze);
    }

    void HexagonFirstFragment(Varyings input, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
    {
        BokehTargets targets = BokehHexagonFirst(_BlitTexture, input.texcoord, BokehAperture(6),
            BokehDefaultFilter(_BokehImageSize), sampler_LinearClamp);
        target0 = targets.edge2;
        target1 = targets.edge3;
    }

    float4 HexagonSecondFragment(Varyings input) : SV_Target
    {
        float4 color = BokehHexagonSecond(_BlitTexture, _BokehColorB, input.texcoord, BokehAperture(6),
            BokehDefaultFilter(_BokehImageSize), sampler_LinearClamp);
        return float4(color.rgb, 1.0);
    }

    void OctagonFirstFragment(Varyings input, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1,
        out float4 target2 : SV_Target2)
    {
        BokehTargets targets = BokehOctagonFirst(_BlitTexture, input.texcoord, BokehAperture(8),
            BokehDefaultFilter(_BokehImageSize), sampler_LinearClamp);
        target0 = targets.edge2;
        target1 = targets.edge3;
        target2 = targets.edge4;
    }

    float4 OctagonSecondFragment(Varyings input) : SV_Target
    {
        float4 color = BokehOctagonSecond(_BlitTexture, _BokehColorB, _BokehColorC, input.texcoord, BokehAperture(8),
            BokehDefaultFilter(_BokehImageSize), sampler_LinearClamp);
        return float4(color.rgb, 1.0);
    }

    // The paper's way: one line a pass, parallelograms combined by min
    float4 LineFragment(Varyings input) : SV_Target
    {
        BokehFilter settings = BokehDefaultFilter(_BokehImageSize);
        float4 segment = BokehSegment(_BokehAngle, 1.0, float2(0.0, 0.0), _BokehSqueeze);
        return BokehDepthOfFieldAdaptive(_BlitTexture, _BokehDepth, input.texcoord, segment,
            settings, true, sampler_LinearClamp);
    }

    float4 LineFinalFragment(Varyings input) : SV_Target
    {
        float4 color = LineFragment(input);
        color = BokehCombine(color, BokehFetch(_BokehColorB, input.texcoord, sampler_LinearClamp), false);
        return float4(color.rgb, 1.0);
    }

    // _BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
    float4 DebugFragment(Varyings input) : SV_Target
    {
        float4 color = BokehFetch(_BlitTexture, input.texcoord, sampler_LinearClamp);
        float4 result = float4(color.rgb, 1.0);
        float depth = BokehMetres(input.texcoord);
        float grey = clamp(abs(color.a) / max(_BokehMaxCoC, BOKEH_MIN_DEPTH), 0.0, 1.0);
        float3 weights = float3(1.0, 1.0, 1.0);
        if (_BokehDebugMode > 2.5)
        {
            weights = float3(0.1, 0.4, 1.0);
            if (depth < _BokehFocusDistance)
            {
                weights = float3(1.0, 0.5, 0.0);
            }
        }
        else if (_BokehDebugMode < 1.5)
        {
            grey = depth / (depth + _BokehFocusDistance);
        }
        if (_BokehDebugMode > 0.5)
        {
            result = float4(weights * grey, 1.0);
        }
        return result;
    }

    ENDHLSL

    SubShader
    {
        Tags { "RenderPipeline" = "UniversalPipeline" }
        ZTest Always
        ZWrite Off
        Cull Off
        // alpha is the circle of confusion
        Blend Off

        // in the order of BokehRendererFeature.ShaderPass
        Pass { Name "Depth" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment DepthFragment
        ENDHLSL }
        Pass { Name "SignedCoCMap" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment SignedCoCMapFragment
        ENDHLSL }
        Pass { Name "CoCMap" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment CoCMapFragment
        ENDHLSL }
        Pass { Name "HexagonFirst" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment HexagonFirstFragment
        ENDHLSL }
        Pass { Name "HexagonSecond" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment HexagonSecondFragment
        ENDHLSL }
        Pass { Name "OctagonFirst" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment OctagonFirstFragment
        ENDHLSL }
        Pass { Name "OctagonSecond" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment OctagonSecondFragment
        ENDHLSL }
        Pass { Name "Line" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment LineFragment
        ENDHLSL }
        Pass { Name "LineFinal" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment LineFinalFragment
        ENDHLSL }
        Pass { Name "Debug" HLSLPROGRAM
            #pragma target 3.5
            #pragma vertex Vert
            #pragma fragment DebugFragment
        ENDHLSL }
    }
}
