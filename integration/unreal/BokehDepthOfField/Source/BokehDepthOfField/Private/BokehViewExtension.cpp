// SPDX-License-Identifier: MIT
// The passes, in the render dependency graph. Lengths in metres; the engine's centimetres end in the first shader.

#include "BokehViewExtension.h"

#include "GlobalShader.h"
#include "HAL/IConsoleManager.h"
#include "PixelShaderUtils.h"
#include "PostProcess/PostProcessMaterialInputs.h"
#include "RenderGraphUtils.h"
#include "SceneTexturesConfig.h"
#include "SceneView.h"
#include "ScreenPass.h"
#include "ShaderParameterStruct.h"

#define BOKEH_SETTING(Type, Name, Default, Help) \
    static TAutoConsoleVariable<Type> Setting##Name(TEXT("r.Bokeh." #Name), Default, TEXT(Help), ECVF_RenderThreadSafe)

BOKEH_SETTING(int32, Enable, 1, "0: off");
BOKEH_SETTING(int32, Sides, 6, "6: hexagon, 8: octagon");
BOKEH_SETTING(int32, Paper, 0, "0: exact polygons, 1: the paper's, by min");
BOKEH_SETTING(int32, Debug, 0, "0: off, 1: colour, 2: depth, 3: circle of confusion, 4: near and far field");
BOKEH_SETTING(float, FStop, 0.2f, "of a lens with the view's field of view; below that of real ones: more blur");
BOKEH_SETTING(float, FocusDistance, 5.0f, "metres along the view axis");
BOKEH_SETTING(float, SensorHeight, 0.024f, "metres");
BOKEH_SETTING(float, MaxCoC, 0.1f, "fraction of the image height");
BOKEH_SETTING(float, Rotation, 0.0f, "degrees, clockwise");
BOKEH_SETTING(float, Squeeze, 1.0f, "width over height of the bokeh");

// Names and types are those of BokehDepthOfField.usf
BEGIN_SHADER_PARAMETER_STRUCT(FBokehParameters, )
    SHADER_PARAMETER_STRUCT_REF(FViewUniformShaderParameters, View)
    SHADER_PARAMETER_STRUCT_INCLUDE(FSceneTextureShaderParameters, SceneTextures)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColor)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorB)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorC)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehDepth)
    SHADER_PARAMETER_SAMPLER(SamplerState, BokehLinear)
    SHADER_PARAMETER(FIntPoint, BokehViewMin)
    SHADER_PARAMETER(FIntPoint, BokehTargetMin)
    SHADER_PARAMETER(FVector2f, BokehImageSize)
    SHADER_PARAMETER(float, BokehApertureDiameter)
    SHADER_PARAMETER(float, BokehFocalLength)
    SHADER_PARAMETER(float, BokehFocusDistance)
    SHADER_PARAMETER(float, BokehSensorHeight)
    SHADER_PARAMETER(float, BokehMaxCoC)
    SHADER_PARAMETER(float, BokehSqueeze)
    SHADER_PARAMETER(float, BokehAngle)
    SHADER_PARAMETER(float, BokehDebugMode)
    RENDER_TARGET_BINDING_SLOTS()
END_SHADER_PARAMETER_STRUCT()

class FBokehShader : public FGlobalShader
{
public:
    using FParameters = FBokehParameters;
    FBokehShader() = default;
    FBokehShader(const ShaderMetaType::CompiledShaderInitializerType& Initializer) : FGlobalShader(Initializer) {}

    static bool ShouldCompilePermutation(const FGlobalShaderPermutationParameters& Parameters)
    {
        return IsFeatureLevelSupported(Parameters.Platform, ERHIFeatureLevel::SM5);
    }
};

// One class for each entry point of the shader file
#define BOKEH_SHADER(Name) \
    class FBokeh##Name##PS : public FBokehShader \
    { \
        DECLARE_GLOBAL_SHADER(FBokeh##Name##PS); \
        SHADER_USE_PARAMETER_STRUCT(FBokeh##Name##PS, FBokehShader); \
    }; \
    IMPLEMENT_GLOBAL_SHADER(FBokeh##Name##PS, "/Plugin/BokehDepthOfField/BokehDepthOfField.usf", #Name "PS", SF_Pixel)

BOKEH_SHADER(Depth);
BOKEH_SHADER(SignedCoCMap);
BOKEH_SHADER(CoCMap);
BOKEH_SHADER(HexagonFirst);
BOKEH_SHADER(HexagonSecond);
BOKEH_SHADER(OctagonFirst);
BOKEH_SHADER(OctagonSecond);
BOKEH_SHADER(Line);
BOKEH_SHADER(LineFinal);
BOKEH_SHADER(Debug);

// The passes of one view. All but the last write targets of the view's own size, so that the library's coordinates run
// from 0 to 1 there, wherever the view lies in the engine's textures.
struct FBokehPasses
{
    FRDGBuilder& GraphBuilder;
    const FSceneView& View;
    const FPostProcessMaterialInputs& Inputs;
    const FIntRect ViewRect;

    FRDGTextureRef Target(const TCHAR* Name, EPixelFormat Format = PF_FloatRGBA) const
    {
        const FRDGTextureDesc Description = FRDGTextureDesc::Create2D(ViewRect.Size(), Format,
            FClearValueBinding::None, TexCreate_ShaderResource | TexCreate_RenderTargetable);
        return GraphBuilder.CreateTexture(Description, Name);
    }

    // What a pass is given; Degrees of its line, before the rotation
    FBokehParameters* Parameters(FRDGTextureRef Color = nullptr, FRDGTextureRef Depth = nullptr,
        float Degrees = 0.0f) const
    {
        FBokehParameters* Given = GraphBuilder.AllocParameters<FBokehParameters>();
        Given->View = View.ViewUniformBuffer;
        Given->SceneTextures = Inputs.SceneTextures;
        Given->BokehColor = Color;
        Given->BokehDepth = Depth;
        Given->BokehLinear = TStaticSamplerState<SF_Bilinear, AM_Clamp, AM_Clamp, AM_Clamp>::GetRHI();
        Given->BokehViewMin = ViewRect.Min;
        Given->BokehTargetMin = FIntPoint(0, 0);
        Given->BokehImageSize = FVector2f(static_cast<float>(ViewRect.Width()), static_cast<float>(ViewRect.Height()));
        // M[1][1] is 1 / tan(half of the vertical field of view): docs/lens.md
        const float Zoom = static_cast<float>(View.ViewMatrices.GetProjectionMatrix().M[1][1]);
        Given->BokehFocalLength = 0.5f * SettingSensorHeight.GetValueOnRenderThread() * Zoom;
        Given->BokehApertureDiameter = Given->BokehFocalLength / SettingFStop.GetValueOnRenderThread();
        Given->BokehFocusDistance = SettingFocusDistance.GetValueOnRenderThread();
        Given->BokehSensorHeight = SettingSensorHeight.GetValueOnRenderThread();
        Given->BokehMaxCoC = SettingMaxCoC.GetValueOnRenderThread();
        Given->BokehSqueeze = SettingSqueeze.GetValueOnRenderThread();
        Given->BokehAngle = FMath::DegreesToRadians(Degrees + SettingRotation.GetValueOnRenderThread());
        Given->BokehDebugMode = static_cast<float>(SettingDebug.GetValueOnRenderThread() - 1);
        return Given;
    }

    // Into targets of its own
    template <typename ShaderType>
    void Draw(const TCHAR* Name, FBokehParameters* Given, std::initializer_list<FRDGTextureRef> Targets) const
    {
        int32 Index = 0;
        for (FRDGTextureRef Texture : Targets)
        {
            Given->RenderTargets[Index++] = FRenderTargetBinding(Texture, ERenderTargetLoadAction::ENoAction);
        }
        AddPass<ShaderType>(Name, Given, FIntRect(FIntPoint(0, 0), ViewRect.Size()));
    }

    // The last pass: into the engine's place for this view
    template <typename ShaderType>
    void Finish(const TCHAR* Name, FBokehParameters* Given, const FScreenPassRenderTarget& Output) const
    {
        Given->BokehTargetMin = Output.ViewRect.Min;
        Given->RenderTargets[0] = Output.GetRenderTargetBinding();
        AddPass<ShaderType>(Name, Given, Output.ViewRect);
    }

    template <typename ShaderType>
    void AddPass(const TCHAR* Name, FBokehParameters* Given, const FIntRect& Viewport) const
    {
        const FGlobalShaderMap* ShaderMap = GetGlobalShaderMap(View.GetFeatureLevel());
        const TShaderMapRef<ShaderType> PixelShader(ShaderMap);
        FPixelShaderUtils::AddFullscreenPass(GraphBuilder, ShaderMap, RDG_EVENT_NAME("Bokeh %s", Name), PixelShader,
            Given, Viewport);
    }

    // Two passes; the first writes two targets for the hexagon, three for the octagon
    void Exact(FRDGTextureRef CoC, bool bHexagon, const FScreenPassRenderTarget& Output) const
    {
        FRDGTextureRef Target2 = Target(TEXT("Bokeh.Target2"));
        FRDGTextureRef Target3 = Target(TEXT("Bokeh.Target3"));
        FBokehParameters* First = Parameters(CoC);
        FBokehParameters* Second = Parameters(Target2);
        Second->BokehColorB = Target3;
        if (bHexagon)
        {
            Draw<FBokehHexagonFirstPS>(TEXT("first"), First, {Target2, Target3});
            Finish<FBokehHexagonSecondPS>(TEXT("second"), Second, Output);
        }
        else
        {
            FRDGTextureRef Target4 = Target(TEXT("Bokeh.Target4"));
            Second->BokehColorC = Target4;
            Draw<FBokehOctagonFirstPS>(TEXT("first"), First, {Target2, Target3, Target4});
            Finish<FBokehOctagonSecondPS>(TEXT("second"), Second, Output);
        }
    }

    // One line a pass: two parallelograms, the second combined with the first by min
    void Paper(FRDGTextureRef CoC, FRDGTextureRef Depth, bool bHexagon, const FScreenPassRenderTarget& Output) const
    {
        FRDGTextureRef Line = Target(TEXT("Bokeh.Line"));
        FRDGTextureRef Finished = Target(TEXT("Bokeh.Finished"));
        Draw<FBokehLinePS>(TEXT("line 1"), Parameters(CoC, Depth, bHexagon ? 90.0f : 0.0f), {Line});
        Draw<FBokehLinePS>(TEXT("line 2"), Parameters(Line, Depth, bHexagon ? 30.0f : 90.0f), {Finished});
        if (!bHexagon)
        {
            // the hexagon's two parallelograms share their first line, the octagon's do not
            Line = Target(TEXT("Bokeh.LineB"));
            Draw<FBokehLinePS>(TEXT("line 3"), Parameters(CoC, Depth, 45.0f), {Line});
        }
        FBokehParameters* Last = Parameters(Line, Depth, bHexagon ? 150.0f : 135.0f);
        Last->BokehColorB = Finished;
        Finish<FBokehLineFinalPS>(TEXT("last line"), Last, Output);
    }
};

FBokehViewExtension::FBokehViewExtension(const FAutoRegister& AutoRegister)
    : FSceneViewExtensionBase(AutoRegister)
{
}

bool FBokehViewExtension::IsActiveThisFrame_Internal(const FSceneViewExtensionContext& Context) const
{
    return SettingEnable.GetValueOnGameThread() != 0;
}

void FBokehViewExtension::SubscribeToPostProcessingPass(EPostProcessingPass Pass, const FSceneView& InView,
    FPostProcessingPassDelegateArray& InOutPassCallbacks, bool bIsPassEnabled)
{
    const bool bCapture = InView.bIsSceneCapture || InView.bIsReflectionCapture;
    if (Pass == EPostProcessingPass::BeforeDOF && !bCapture && InView.GetFeatureLevel() >= ERHIFeatureLevel::SM5)
    {
        InOutPassCallbacks.Add(FPostProcessingPassDelegate::CreateRaw(this, &FBokehViewExtension::Draw));
    }
}

FScreenPassTexture FBokehViewExtension::Draw(FRDGBuilder& GraphBuilder, const FSceneView& View,
    const FPostProcessMaterialInputs& Inputs)
{
    const FScreenPassTexture SceneColor = FScreenPassTexture::CopyFromSlice(GraphBuilder,
        Inputs.GetInput(EPostProcessMaterialInput::SceneColor));
    const FScreenPassRenderTarget Output = FScreenPassRenderTarget::CreateFromInput(GraphBuilder, SceneColor,
        ERenderTargetLoadAction::ENoAction, TEXT("Bokeh.Result"));
    const FBokehPasses Passes{GraphBuilder, View, Inputs, SceneColor.ViewRect};

    FRDGTextureRef CoC = Passes.Target(TEXT("Bokeh.CoC"));
    // the exact passes read a signed CoC, the paper's an unsigned one and metres
    const bool bDebug = SettingDebug.GetValueOnRenderThread() > 0;
    const bool bPaper = SettingPaper.GetValueOnRenderThread() != 0 && !bDebug;
    FRDGTextureRef Depth = nullptr;
    FBokehParameters* Map = Passes.Parameters(SceneColor.Texture);
    if (bPaper)
    {
        Depth = Passes.Target(TEXT("Bokeh.Depth"), PF_R32_FLOAT);
        Passes.Draw<FBokehDepthPS>(TEXT("depth"), Passes.Parameters(), {Depth});
        Passes.Draw<FBokehCoCMapPS>(TEXT("circle of confusion"), Map, {CoC});
    }
    else
    {
        Passes.Draw<FBokehSignedCoCMapPS>(TEXT("circle of confusion"), Map, {CoC});
    }

    const bool bHexagon = SettingSides.GetValueOnRenderThread() != 8;
    if (bDebug)
    {
        Passes.Finish<FBokehDebugPS>(TEXT("debug"), Passes.Parameters(CoC), Output);
    }
    else if (bPaper)
    {
        Passes.Paper(CoC, Depth, bHexagon, Output);
    }
    else
    {
        Passes.Exact(CoC, bHexagon, Output);
    }
    return Output;
}
