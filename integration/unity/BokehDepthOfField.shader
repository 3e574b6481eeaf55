// SPDX-License-Identifier: MIT
// The passes of BokehRendererFeature.cs, Unity 6 (6000.0), URP 17. Needs bokeh.hlsl of the package beside it.

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
    // samples on a line, at most
    #define BOKEH_NUM_SAMPLES 33
    #include "bokeh.hlsl"

    // _BlitTexture, of Blit.hlsl, is what a pass reads first: depth, colour, or what the pass before made
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
    float _BokehSpacing;
    // radians: rotation of the polygon (exact), direction of the line (paper)
    float _BokehAngle;
    float _BokehDebugMode;

    // Depth: whatever the platform has, reversed or not, to metres along the view axis
    float DepthFragment(Varyings input) : SV_Target
    {
        return LinearEyeDepth(BokehFetchNearest(_BlitTexture, input.texcoord).r, _ZBufferParams);
    }

    float4 SignedCoCMapFragment(Varyings input) : SV_Target
    {
        return BokehSignedCoCMap(_BlitTexture, _BokehDepth, input.texcoord, _BokehApertureDiameter, _BokehFocalLength,
            _BokehFocusDistance, _BokehSensorHeight, _BokehMaxCoC);
    }

    // The paper's way: a CoC without a sign
    float4 CoCMapFragment(Varyings input) : SV_Target
    {
        return BokehCoCMap(_BlitTexture, _BokehDepth, input.texcoord, _BokehApertureDiameter, _BokehFocalLength,
            _BokehFocusDistance, _BokehSensorHeight, _BokehMaxCoC);
    }

    BokehFilter BokehSettings()
    {
        BokehFilter settings = BokehDefaultFilter(_BokehImageSize);
        settings.spacing = _BokehSpacing;
        return settings;
    }

    BokehPolygon BokehAperture(int sides)
    {
        return BokehMakePolygon(sides, _BokehAngle, _BokehSqueeze);
    }

    void HexagonFirstFragment(Varyings input, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
    {
        BokehTargets targets = BokehExactFirst(_BlitTexture, sampler_LinearClamp, input.texcoord,
            BokehAperture(6), BokehSettings());
        target0 = targets.edge2;
        target1 = targets.edge3;
    }

    float4 HexagonSecondFragment(Varyings input) : SV_Target
    {
        float4 color = BokehExactSecond(_BlitTexture, sampler_LinearClamp, _BokehColorB, _BokehColorB, _BokehColorB,
            input.texcoord, BokehAperture(6), BokehSettings());
        return float4(color.rgb, 1.0);
    }

    void OctagonFirstFragment(Varyings input, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1,
        out float4 target2 : SV_Target2)
    {
        BokehTargets targets = BokehExactFirst(_BlitTexture, sampler_LinearClamp, input.texcoord,
            BokehAperture(8), BokehSettings());
        target0 = targets.edge2;
        target1 = targets.edge3;
        target2 = targets.edge4;
    }

    float4 OctagonSecondFragment(Varyings input) : SV_Target
    {
        float4 color = BokehExactSecond(_BlitTexture, sampler_LinearClamp, _BokehColorB, _BokehColorC, _BokehColorC,
            input.texcoord, BokehAperture(8), BokehSettings());
        return float4(color.rgb, 1.0);
    }

    // The paper's way: one line a pass, parallelograms combined by min
    float4 LineFragment(Varyings input) : SV_Target
    {
        BokehFilter settings = BokehSettings();
        float4 segment = BokehSegment(_BokehAngle, 1.0, float2(0.0, 0.0), _BokehSqueeze);
        return BokehDepthOfFieldAdaptive(_BlitTexture, sampler_LinearClamp, _BokehDepth, input.texcoord, segment,
            settings, true);
    }

    float4 LineFinalFragment(Varyings input) : SV_Target
    {
        float4 color = LineFragment(input);
        color = BokehCombine(color, BokehFetch(_BokehColorB, sampler_LinearClamp, input.texcoord), false);
        return float4(color.rgb, 1.0);
    }

    // _BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
    float4 DebugFragment(Varyings input) : SV_Target
    {
        float4 color = BokehFetch(_BlitTexture, sampler_LinearClamp, input.texcoord);
        float depth = BokehSafeDepth(BokehFetchNearest(_BokehDepth, input.texcoord).r);
        float4 result = float4(color.rgb, 1.0);
        if (_BokehDebugMode > 2.5)
        {
            result = BokehDebugFocus(depth, _BokehFocusDistance, color.a, _BokehMaxCoC);
        }
        else if (_BokehDebugMode > 1.5)
        {
            result = BokehDebugCoC(color.a, _BokehMaxCoC);
        }
        else if (_BokehDebugMode > 0.5)
        {
            result = BokehDebugDepth(depth, _BokehFocusDistance);
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
