// SPDX-License-Identifier: MIT
//
// Depth of field with hexagonal bokeh for ReShade. Copy the files of this folder into reshade-shaders/Shaders.
//
// The preprocessor definition POLYGONAL_BOKEH_PRESET selects the preset, which sets the number of samples:
// 0 MOBILE, 1 LOW, 2 MEDIUM (the default), 3 HIGH, 4 ULTRA.

#include "ReShade.fxh"

#ifndef POLYGONAL_BOKEH_PRESET
#define POLYGONAL_BOKEH_PRESET 2
#endif
#define POLYGONAL_BOKEH_LAYER_SCALE 2
#if POLYGONAL_BOKEH_PRESET == 0
#define BOKEH_PRESET_MOBILE 1
#undef POLYGONAL_BOKEH_LAYER_SCALE
#define POLYGONAL_BOKEH_LAYER_SCALE 4
#elif POLYGONAL_BOKEH_PRESET == 1
#define BOKEH_PRESET_LOW 1
#elif POLYGONAL_BOKEH_PRESET == 3
#define BOKEH_PRESET_HIGH 1
#elif POLYGONAL_BOKEH_PRESET == 4
#define BOKEH_PRESET_ULTRA 1
#endif
// In ReShade FX, the type of a texture is `sampler`. Everything else in section [2] of the library is as in shader
// model 3.
#define BOKEH_HLSL_SM 3
#define sampler2D sampler
#include "bokeh.hlsl"
#include "bokeh_layers.hlsl"

uniform int FocusMode <
    ui_category = "Focus"; ui_type = "combo"; ui_label = "Focus on";
    ui_items = "the distance below\0the middle of the screen\0the pixel under the cursor\0the point below\0";
    ui_tooltip = "Selects what is in focus. The last three choices focus automatically: they read the depth of one\n"
        "pixel, and move the focus there smoothly.";
> = 1;
uniform float FocusDistance <
    ui_category = "Focus"; ui_type = "slider"; ui_label = "Distance (m)"; ui_min = 0.2; ui_max = 200.0;
    ui_tooltip = "Focus distance in metres. It is used only if 'Focus on' is 'the distance below'.";
> = 5.0;
uniform float2 FocusPoint <
    ui_category = "Focus"; ui_type = "slider"; ui_label = "Point"; ui_min = 0.0; ui_max = 1.0;
    ui_tooltip = "The point of the screen to focus on. It is used only if 'Focus on' is 'the point below'.\n"
        "0, 0 is the upper left corner, and 1, 1 is the lower right corner. 'Show focus' marks the point.";
> = float2(0.5, 0.5);
uniform float PullTime <
    ui_category = "Focus"; ui_type = "slider"; ui_label = "Pull (s)"; ui_min = 0.0; ui_max = 3.0;
    ui_tooltip = "The time in which automatic focus covers 63 % of the way to its new distance. 0 focuses at once.";
> = 0.25;
uniform float MetresToFarPlane <
    ui_category = "Focus"; ui_type = "slider"; ui_label = "Far plane (m)"; ui_min = 10.0; ui_max = 2000.0;
    ui_tooltip = "The distance in metres at which depth is 1. ReShade does not know the game's units. Change this\n"
        "until 'Distance' is right for an object whose distance you know, such as a person two metres away.";
> = 1000.0;
uniform bool ShowFocus <
    ui_category = "Focus"; ui_label = "Show focus";
    ui_tooltip = "Colours the image: sharp objects are green, blurred objects in front of the focus distance are\n"
        "orange, and blurred objects behind it are blue. A white square marks the pixel that automatic focus reads.";
> = false;

uniform float FStop <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "f-stop"; ui_min = 0.1; ui_max = 22.0;
    ui_tooltip = "Focal length divided by the diameter of the aperture. A lower f-stop blurs more.";
> = 2.8;
uniform float BokehScale <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Bokeh scale"; ui_min = 0.0; ui_max = 50.0;
    ui_tooltip = "Multiplies the width of the blur. 1 is a real lens, which hardly blurs at a game's field of view.\n"
        "0 turns the blur off.";
> = 10.0;
uniform float FocalLength <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Focal length (mm)"; ui_min = 10.0; ui_max = 300.0;
    ui_tooltip = "A longer focal length blurs more. The sensor is 24 mm high, so 50 mm sees 27 degrees vertically.";
> = 50.0;
uniform float NearScale <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Near scale"; ui_min = 0.0; ui_max = 4.0;
    ui_tooltip = "Multiplies the blur in front of the focus distance. 0 keeps everything there sharp.";
> = 1.0;
uniform float FarScale <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Far scale"; ui_min = 0.0; ui_max = 4.0;
    ui_tooltip = "Multiplies the blur behind the focus distance. 0 keeps everything there sharp.";
> = 1.0;
uniform float LargestBlurNear <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Largest blur, near (% of the height)"; ui_min = 0.0; ui_max = 20.0;
    ui_tooltip = "Limits the diameter of the blur in front of the focus distance. 0 keeps everything there sharp.";
> = 10.0;
uniform float LargestBlurFar <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Largest blur, far (% of the height)"; ui_min = 0.0; ui_max = 20.0;
    ui_tooltip = "Limits the diameter of the blur behind the focus distance. 0 keeps everything there sharp.";
> = 10.0;
uniform float Rotation <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Rotation (degrees, clockwise)"; ui_min = 0.0; ui_max = 60.0;
> = 0.0;
uniform float Squeeze <
    ui_category = "Lens"; ui_type = "slider"; ui_label = "Squeeze"; ui_min = 0.3; ui_max = 1.0;
    ui_tooltip = "Width of the bokeh divided by its height. 0.5 looks like an anamorphic lens.";
> = 1.0;

uniform float Highlights <
    ui_category = "Colour"; ui_type = "slider"; ui_label = "Highlights"; ui_min = 0.0; ui_max = 0.99;
    ui_tooltip = "Makes highlights brighter before the blur, because the game has compressed bright light, and undoes\n"
        "this after the blur. Lights then become clear polygons. 0 leaves white as it is, and 0.95 makes it 20 times\n"
        "as bright.";
> = 0.9;

uniform float FrameTime < source = "frametime"; >;
uniform float2 MousePoint < source = "mousepoint"; >;

texture PolygonalBokehFocus { Format = R32F; };
texture PolygonalBokehFocusBefore { Format = R32F; };
sampler Focus { Texture = PolygonalBokehFocus; MinFilter = POINT; MagFilter = POINT; };
sampler FocusBefore { Texture = PolygonalBokehFocusBefore; MinFilter = POINT; MagFilter = POINT; };

float MetresAt(float2 uv)
{
    return ReShade::GetLinearizedDepth(uv) * MetresToFarPlane;
}

// Converts a colour of the game's image from sRGB to linear light, and undoes the curve of the game's tone mapping:
// divides the colour by 1 - Highlights x, where x is max(r, g, b).
float3 Expanded(float3 color)
{
    float3 low = color / 12.92;
    float3 high = pow(abs(color + 0.055) / 1.055, 2.4);
    float3 light = color <= 0.04045 ? low : high;
    return light / (1.0 - Highlights * min(BokehBrightest(light), 1.0));
}

// Undoes Expanded()
float3 Compressed(float3 light)
{
    light = light / (1.0 + Highlights * BokehBrightest(light));
    float3 low = light * 12.92;
    float3 high = 1.055 * pow(abs(light), 1.0 / 2.4) - 0.055;
    return light <= 0.0031308 ? low : high;
}

BokehPolygon Aperture()
{
    return BokehMakePolygon(6, radians(Rotation), Squeeze);
}

BokehLayerContext Layers(float2 uv)
{
    return BokehMakeLayerContext(uv, float2(BUFFER_WIDTH, BUFFER_HEIGHT), max(LargestBlurNear, LargestBlurFar) / 100.0);
}

// Returns the texture coordinates of the pixel that automatic focus reads
float2 FocusUV()
{
    float2 at = float2(0.5, 0.5);
    if (FocusMode == 2)
    {
        at = MousePoint / float2(BUFFER_WIDTH, BUFFER_HEIGHT);
    }
    else if (FocusMode == 3)
    {
        at = FocusPoint;
    }
    return saturate(at);
}

// Writes the focus distance of this frame in metres. Automatic focus interpolates 1 / distance instead of the distance,
// so that the blur changes evenly.
float4 FocusPS(float4 position : SV_Position, float2 uv : TEXCOORD) : SV_Target
{
    float before = tex2Dlod(FocusBefore, float4(0.5, 0.5, 0.0, 0.0)).r;
    float metres = FocusMode == 0 ? FocusDistance : MetresAt(FocusUV());
    float inverse = 1.0 / clamp(metres, 0.2, 10000.0);
    // In the first frame, the texture contains 0 or any other value. This pass never writes less than 0.2, so it
    // ignores smaller values.
    if (FocusMode > 0 && PullTime > 0.0 && before > 0.19)
    {
        inverse = lerp(inverse, 1.0 / before, exp(-0.001 * FrameTime / PullTime));
    }
    return float4(1.0 / inverse, 0.0, 0.0, 1.0);
}

float4 KeepFocusPS(float4 position : SV_Position, float2 uv : TEXCOORD) : SV_Target
{
    return tex2Dlod(Focus, float4(0.5, 0.5, 0.0, 0.0));
}

float4 ColorAt(float2 uv)
{
    return float4(Expanded(tex2Dlod(ReShade::BackBuffer, float4(uv, 0.0, 0.0)).rgb), 1.0);
}

// Returns the signed CoC, scaled and limited in front of the focus and behind it
float CoCAt(float2 uv)
{
    BokehLens lens = BokehMakeLens(0.001 * FocalLength / FStop * BokehScale, 0.001 * FocalLength,
        tex2Dlod(Focus, float4(0.5, 0.5, 0.0, 0.0)).r);
    lens.maxCoC = max(LargestBlurNear, LargestBlurFar) / 100.0;
    float coc = BokehSignedCoC(max(MetresAt(uv), 0.01), lens);
    coc *= coc < 0.0 ? NearScale : FarScale;
    return clamp(coc, -0.01 * LargestBlurNear, 0.01 * LargestBlurFar);
}

float4 MapPS(float4 position : SV_Position, float2 uv : TEXCOORD) : SV_Target
{
    float2 right = float2(BUFFER_RCP_WIDTH, 0.0);
    float2 below = float2(0.0, BUFFER_RCP_HEIGHT);
    float4 color = ColorAt(uv);
    float4 light = BokehLightBeside(color, ColorAt(uv + right), ColorAt(uv - right), ColorAt(uv + below),
        ColorAt(uv - below));
    float2 lightUV = uv + light.x * right + light.y * below;
    return float4(color.rgb, BokehLightCoC(CoCAt(uv), CoCAt(lightUV), light.zw, BUFFER_HEIGHT));
}

// Returns the colour for the screen. This is the blurred image or, with ShowFocus, the sharp image in colours that show
// what is in focus.
float4 Shown(float3 light, float2 uv)
{
    float3 color = Compressed(light);
    if (ShowFocus)
    {
        float pixels = CoCAt(uv) * BUFFER_HEIGHT;
        float3 tint = float3(0.0, 0.8, 0.2);
        if (abs(pixels) > 1.0)
        {
            tint = pixels < 0.0 ? float3(1.0, 0.5, 0.0) : float3(0.1, 0.4, 1.0);
        }
        float grey = dot(tex2Dlod(ReShade::BackBuffer, float4(uv, 0.0, 0.0)).rgb, float3(0.3, 0.6, 0.1));
        color = 0.5 * (grey + tint);
        float2 away = abs(uv - FocusUV()) * float2(BUFFER_WIDTH, BUFFER_HEIGHT);
        if (FocusMode > 0 && max(away.x, away.y) < 4.0)
        {
            color = float3(1.0, 1.0, 1.0);
        }
    }
    return float4(color, 1.0);
}

// generated by validation/run generate from frame/methods.py: begin
texture PolygonalBokehLayered0 { Width = (BUFFER_WIDTH + 0) / 1; Height = (BUFFER_HEIGHT + 0) / 1; Format = RGBA16F; };
sampler Layered0 { Texture = PolygonalBokehLayered0; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered1 { Width = (BUFFER_WIDTH + 7) / 8; Height = (BUFFER_HEIGHT + 7) / 8; Format = RGBA16F; };
sampler Layered1 { Texture = PolygonalBokehLayered1; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered2 { Width = (BUFFER_WIDTH + 7) / 8; Height = (BUFFER_HEIGHT + 7) / 8; Format = RGBA16F; };
sampler Layered2 { Texture = PolygonalBokehLayered2; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered3 { Width = (BUFFER_WIDTH + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Height = (BUFFER_HEIGHT + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Format = RGBA16F; };
sampler Layered3 { Texture = PolygonalBokehLayered3; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered4 { Width = (BUFFER_WIDTH + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Height = (BUFFER_HEIGHT + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Format = RGBA16F; };
sampler Layered4 { Texture = PolygonalBokehLayered4; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered5 { Width = (BUFFER_WIDTH + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Height = (BUFFER_HEIGHT + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Format = RGBA16F; };
sampler Layered5 { Texture = PolygonalBokehLayered5; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered6 { Width = (BUFFER_WIDTH + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Height = (BUFFER_HEIGHT + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Format = RGBA16F; };
sampler Layered6 { Texture = PolygonalBokehLayered6; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered7 { Width = (BUFFER_WIDTH + 7) / 8; Height = (BUFFER_HEIGHT + 7) / 8; Format = RGBA16F; };
sampler Layered7 { Texture = PolygonalBokehLayered7; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered8 { Width = (BUFFER_WIDTH + 7) / 8; Height = (BUFFER_HEIGHT + 7) / 8; Format = RGBA16F; };
sampler Layered8 { Texture = PolygonalBokehLayered8; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered9 { Width = (BUFFER_WIDTH + 7) / 8; Height = (BUFFER_HEIGHT + 7) / 8; Format = RGBA16F; };
sampler Layered9 { Texture = PolygonalBokehLayered9; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered10 { Width = (BUFFER_WIDTH + 3) / 4; Height = (BUFFER_HEIGHT + 3) / 4; Format = RGBA16F; };
sampler Layered10 { Texture = PolygonalBokehLayered10; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered11 { Width = (BUFFER_WIDTH + 3) / 4; Height = (BUFFER_HEIGHT + 3) / 4; Format = RGBA16F; };
sampler Layered11 { Texture = PolygonalBokehLayered11; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered12 { Width = (BUFFER_WIDTH + 3) / 4; Height = (BUFFER_HEIGHT + 3) / 4; Format = RGBA16F; };
sampler Layered12 { Texture = PolygonalBokehLayered12; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered13 { Width = (BUFFER_WIDTH + 3) / 4; Height = (BUFFER_HEIGHT + 3) / 4; Format = RGBA16F; };
sampler Layered13 { Texture = PolygonalBokehLayered13; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered14 { Width = (BUFFER_WIDTH + 3) / 4; Height = (BUFFER_HEIGHT + 3) / 4; Format = RGBA16F; };
sampler Layered14 { Texture = PolygonalBokehLayered14; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered15 { Width = (BUFFER_WIDTH + 3) / 4; Height = (BUFFER_HEIGHT + 3) / 4; Format = RGBA16F; };
sampler Layered15 { Texture = PolygonalBokehLayered15; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered16 { Width = (BUFFER_WIDTH + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Height = (BUFFER_HEIGHT + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Format = RGBA16F; };
sampler Layered16 { Texture = PolygonalBokehLayered16; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehLayered17 { Width = (BUFFER_WIDTH + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Height = (BUFFER_HEIGHT + POLYGONAL_BOKEH_LAYER_SCALE - 1) / POLYGONAL_BOKEH_LAYER_SCALE; Format = RGBA16F; };
sampler Layered17 { Texture = PolygonalBokehLayered17; AddressU = CLAMP; AddressV = CLAMP; };

void LayeredTileMax1PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0)
{
    BokehLayerContext layers = Layers(uv);
    target0 = BokehTileMax(Layered0, layers);
}

void LayeredTileDilateRows2PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0)
{
    BokehLayerContext layers = Layers(uv);
    target0 = BokehTileDilate(Layered1, float2(1.0, 0.0), layers);
}

void LayeredTileDilateColumns3PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0)
{
    BokehLayerContext layers = Layers(uv);
    target0 = BokehTileDilate(Layered2, float2(0.0, 1.0), layers);
}

void LayeredPrefilter4PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1, out float4 target2 : SV_Target2, out float4 target3 : SV_Target3)
{
    BokehLayerContext layers = Layers(uv);
    BokehPrefiltered targets = BokehPrefilter(Layered0, Layered1, layers);
    target0 = targets.nearLayer;
    target1 = targets.farLayer;
    target2 = targets.layerCoCSums;
    target3 = targets.gatherCoC;
}

void LayeredLayerCoCReduce5PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
{
    BokehLayerContext layers = Layers(uv);
    BokehTileSums targets = BokehLayerCoCReduce(Layered5, Layered6, layers);
    target0 = targets.gatherCoC;
    target1 = targets.sums;
}

void LayeredLayerCoCRows6PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
{
    BokehLayerContext layers = Layers(uv);
    BokehTileSums targets = BokehLayerCoCRows(Layered2, Layered7, Layered1, layers);
    target0 = targets.gatherCoC;
    target1 = targets.sums;
}

void LayeredLayerCoCColumns7PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
{
    BokehLayerContext layers = Layers(uv);
    BokehLayerCoCTargets targets = BokehLayerCoCColumns(Layered8, Layered9, Layered1, layers);
    target0 = targets.gatherTiles;
    target1 = targets.layerCoC;
}

void LayeredDownsample8PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1, out float4 target2 : SV_Target2, out float4 target3 : SV_Target3)
{
    BokehLayerContext layers = Layers(uv);
    BokehPolygon polygon = Aperture();
    BokehDownsampled targets = BokehDownsample(Layered0, Layered1, Layered3, Layered4, Layered7, polygon, layers);
    target0 = targets.midWithHoles;
    target1 = targets.farWithHoles;
    target2 = targets.nearQuarter;
    target3 = targets.farQuarter;
}

void LayeredHoleFill9PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
{
    BokehLayerContext layers = Layers(uv);
    BokehPolygon polygon = Aperture();
    BokehFilled targets = BokehHoleFill(Layered10, Layered11, Layered1, polygon, layers);
    target0 = targets.midFill;
    target1 = targets.farFill;
}

void LayeredHexagonLayerFirst10PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1, out float4 target2 : SV_Target2, out float4 target3 : SV_Target3)
{
    BokehLayerContext layers = Layers(uv);
    BokehPolygon polygon = Aperture();
    BokehLayersTargets targets = BokehLayersFirst(Layered3, Layered12, Layered4, Layered13, BokehLayerCoC(Layered7, layers), polygon, layers);
    target0 = targets.nearStrip2;
    target1 = targets.farStrip2;
    target2 = targets.nearStrip3;
    target3 = targets.farStrip3;
}

void LayeredHexagonLayerSecond11PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
{
    BokehLayerContext layers = Layers(uv);
    BokehPolygon polygon = Aperture();
    BokehBlurred targets = BokehLayersSecond(Layered5, Layered6, Layered16, Layered17, BokehLayerCoC(Layered7, layers), polygon, layers);
    target0 = targets.nearLayer;
    target1 = targets.farLayer;
}

void LayeredComposite12PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 color : SV_Target0)
{
    BokehLayerContext layers = Layers(uv);
    BokehPolygon polygon = Aperture();
    color = BokehComposite(Layered0, Layered2, Layered3, Layered4, Layered14, Layered15, polygon, layers);
    color = Shown(color.rgb, uv);
}

technique PolygonalBokeh < ui_tooltip = "Looks like a lens: blurred near objects spread over the sharp background."; >
{
    pass { VertexShader = PostProcessVS; PixelShader = FocusPS; RenderTarget = PolygonalBokehFocus; }
    pass { VertexShader = PostProcessVS; PixelShader = KeepFocusPS; RenderTarget = PolygonalBokehFocusBefore; }
    pass { VertexShader = PostProcessVS; PixelShader = MapPS; RenderTarget0 = PolygonalBokehLayered0; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredTileMax1PS; RenderTarget0 = PolygonalBokehLayered1; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredTileDilateRows2PS; RenderTarget0 = PolygonalBokehLayered2; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredTileDilateColumns3PS; RenderTarget0 = PolygonalBokehLayered1; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredPrefilter4PS; RenderTarget0 = PolygonalBokehLayered3; RenderTarget1 = PolygonalBokehLayered4; RenderTarget2 = PolygonalBokehLayered5; RenderTarget3 = PolygonalBokehLayered6; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredLayerCoCReduce5PS; RenderTarget0 = PolygonalBokehLayered2; RenderTarget1 = PolygonalBokehLayered7; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredLayerCoCRows6PS; RenderTarget0 = PolygonalBokehLayered8; RenderTarget1 = PolygonalBokehLayered9; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredLayerCoCColumns7PS; RenderTarget0 = PolygonalBokehLayered2; RenderTarget1 = PolygonalBokehLayered7; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredDownsample8PS; RenderTarget0 = PolygonalBokehLayered10; RenderTarget1 = PolygonalBokehLayered11; RenderTarget2 = PolygonalBokehLayered12; RenderTarget3 = PolygonalBokehLayered13; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredHoleFill9PS; RenderTarget0 = PolygonalBokehLayered14; RenderTarget1 = PolygonalBokehLayered15; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredHexagonLayerFirst10PS; RenderTarget0 = PolygonalBokehLayered5; RenderTarget1 = PolygonalBokehLayered6; RenderTarget2 = PolygonalBokehLayered16; RenderTarget3 = PolygonalBokehLayered17; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredHexagonLayerSecond11PS; RenderTarget0 = PolygonalBokehLayered3; RenderTarget1 = PolygonalBokehLayered4; }
    pass { VertexShader = PostProcessVS; PixelShader = LayeredComposite12PS; }
}

texture PolygonalBokehExact0 { Width = (BUFFER_WIDTH + 0) / 1; Height = (BUFFER_HEIGHT + 0) / 1; Format = RGBA16F; };
sampler Exact0 { Texture = PolygonalBokehExact0; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehExact1 { Width = (BUFFER_WIDTH + 0) / 1; Height = (BUFFER_HEIGHT + 0) / 1; Format = RGBA16F; };
sampler Exact1 { Texture = PolygonalBokehExact1; AddressU = CLAMP; AddressV = CLAMP; };
texture PolygonalBokehExact2 { Width = (BUFFER_WIDTH + 0) / 1; Height = (BUFFER_HEIGHT + 0) / 1; Format = RGBA16F; };
sampler Exact2 { Texture = PolygonalBokehExact2; AddressU = CLAMP; AddressV = CLAMP; };

void ExactHexagonFirst1PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 target0 : SV_Target0, out float4 target1 : SV_Target1)
{
    BokehPolygon polygon = Aperture();
    BokehSamplingSettings settings = BokehDefaultSampling(float2(BUFFER_WIDTH, BUFFER_HEIGHT));
    BokehTargets targets = BokehHexagonFirst(Exact0, uv, polygon, settings);
    target0 = targets.strip2;
    target1 = targets.strip3;
}

void ExactHexagonSecond2PS(float4 position : SV_Position, float2 uv : TEXCOORD, out float4 color : SV_Target0)
{
    BokehPolygon polygon = Aperture();
    BokehSamplingSettings settings = BokehDefaultSampling(float2(BUFFER_WIDTH, BUFFER_HEIGHT));
    color = BokehHexagonSecond(Exact1, Exact2, uv, polygon, settings);
    color = Shown(color.rgb, uv);
}

technique PolygonalBokehExact < ui_tooltip = "Takes fewer passes, but blurred near objects keep a hard outline."; >
{
    pass { VertexShader = PostProcessVS; PixelShader = FocusPS; RenderTarget = PolygonalBokehFocus; }
    pass { VertexShader = PostProcessVS; PixelShader = KeepFocusPS; RenderTarget = PolygonalBokehFocusBefore; }
    pass { VertexShader = PostProcessVS; PixelShader = MapPS; RenderTarget0 = PolygonalBokehExact0; }
    pass { VertexShader = PostProcessVS; PixelShader = ExactHexagonFirst1PS; RenderTarget0 = PolygonalBokehExact1; RenderTarget1 = PolygonalBokehExact2; }
    pass { VertexShader = PostProcessVS; PixelShader = ExactHexagonSecond2PS; }
}
// generated by validation/run generate from frame/methods.py: end
