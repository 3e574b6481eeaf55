// Copyright (c) 2026 the authors of the polygonal bokeh shader package
// SPDX-License-Identifier: MIT
// Adds the passes to the render dependency graph. Lengths are in metres; the first shader converts the engine's depth
// from centimetres.

#include "BokehViewExtension.h"

#include "BokehParameters.h"
#include "GlobalShader.h"
#include "HAL/IConsoleManager.h"
#include "PixelShaderUtils.h"
#include "PostProcess/PostProcessMaterialInputs.h"
#include "RenderGraphUtils.h"
#include "SceneTexturesConfig.h"
#include "SceneView.h"
#include "ScreenPass.h"
#include "ShaderParameterStruct.h"
#include "ShaderPermutation.h"

#define BOKEH_SETTING(Type, Name, Default, Help) \
    static TAutoConsoleVariable<Type> Setting##Name(TEXT("r.Bokeh." #Name), Default, TEXT(Help), ECVF_RenderThreadSafe)

BOKEH_SETTING(int32, Enable, 1, "Turns the effect on (1) or off (0).");
BOKEH_SETTING(int32, Method, 0, "Selects the method. 0: layered. 1: exact, which is cheaper, but blurred near objects "
    "keep a hard outline. 2: paper.");
BOKEH_SETTING(int32, Preset, 1, "Sets the number of samples. 0: low, 1: medium, 2: high, 3: ultra, 4: mobile.");
BOKEH_SETTING(int32, Sides, 0, "Number of sides of the polygon: 4, 6, 8 or 10. Paper draws 6 instead of 4 and 10. "
    "0: uses the number of the camera's blades, or 6 if the camera has no depth of field.");
BOKEH_SETTING(int32, Debug, 0, "Shows a debug view. "
    "0: off, 1: colour, 2: depth, 3: circle of confusion, 4: near and far field.");
BOKEH_SETTING(float, FStop, 0.0f, "A lower f-stop blurs more. "
    "0: uses the camera's f-stop, or 2.8 if the camera has no depth of field.");
BOKEH_SETTING(float, BokehScale, 10.0f, "Multiplies the width of the blur. 1 is a real lens, 0 turns the effect off.");
BOKEH_SETTING(float, FocusDistance, 0.0f, "Distance to the plane in focus, in metres along the view axis. "
    "0: uses the camera's focus distance, or 5 if the camera has no depth of field.");
BOKEH_SETTING(float, SensorHeight, 0.0f, "Height of the camera's sensor in metres. "
    "0: uses the camera's sensor, or 0.024 if the camera has no depth of field.");
BOKEH_SETTING(float, MaxCoC, 0.1f, "Largest diameter of the circle of confusion, as a fraction of the image height.");
BOKEH_SETTING(float, NearScale, 1.0f, "Multiplies the circle of confusion in front of the focus distance.");
BOKEH_SETTING(float, FarScale, 1.0f, "Multiplies the circle of confusion behind the focus distance.");
BOKEH_SETTING(float, NearMaxCoC, 1.0f, "Largest diameter of the circle of confusion in front of the focus distance, "
    "as a fraction of the image height. MaxCoC limits it too.");
BOKEH_SETTING(float, FarMaxCoC, 1.0f, "Largest diameter of the circle of confusion behind the focus distance, "
    "as a fraction of the image height. MaxCoC limits it too.");
BOKEH_SETTING(float, Rotation, 0.0f, "Rotates the polygon clockwise, in degrees.");
BOKEH_SETTING(float, Squeeze, 0.0f, "Width of the bokeh divided by its height. "
    "0: uses the inverse of the camera's squeeze factor, or 1 if the camera has no depth of field.");

// The lens of a view. Lengths are in metres. A console variable that is above 0 sets its value. All other values come
// from the depth of field settings of a cine camera or a post-process volume. If there are none, the defaults below
// are used.
struct FBokehLens
{
    float FStop = 2.8f;
    float FocusDistance = 5.0f;
    float SensorHeight = 0.024f;
    float Squeeze = 1.0f;
    int32 Sides = 6;

    FBokehLens(const FSceneView& View, const FIntRect& ViewRect)
    {
        const FPostProcessSettings& Settings = View.FinalPostProcessSettings;
        // the engine turns its own depth of field on under the same condition
        if (Settings.DepthOfFieldFstop > 0.0f && Settings.DepthOfFieldFocalDistance > 0.0f)
        {
            FStop = Settings.DepthOfFieldFstop;
            FocusDistance = 0.01f * Settings.DepthOfFieldFocalDistance;
            SensorHeight = 0.001f * Settings.DepthOfFieldSensorWidth * static_cast<float>(ViewRect.Height()) / static_cast<float>(ViewRect.Width());
            Squeeze = 1.0f / FMath::Max(Settings.DepthOfFieldSqueezeFactor, 1.0f);
            // the camera has 4 to 16 blades; the polygon has an even number of sides, 4 to 10
            Sides = FMath::Clamp((Settings.DepthOfFieldBladeCount + 1) / 2 * 2, 4, 10);
        }
        Override(FStop, SettingFStop.GetValueOnRenderThread());
        Override(FocusDistance, SettingFocusDistance.GetValueOnRenderThread());
        Override(SensorHeight, SettingSensorHeight.GetValueOnRenderThread());
        Override(Squeeze, SettingSqueeze.GetValueOnRenderThread());
        Override(Sides, SettingSides.GetValueOnRenderThread());
    }

private:
    template <typename T> static void Override(T& Value, T Set)
    {
        Value = Set > T(0) ? Set : Value;
    }
};

// The parameters of all shaders. Names and types must be the same in BokehDepthOfField.usf and bokeh_passes.ush
#define BOKEH_DECLARE(Name, Default) SHADER_PARAMETER(float, Bokeh##Name)
BEGIN_SHADER_PARAMETER_STRUCT(FBokehParameters, )
    SHADER_PARAMETER_STRUCT_REF(FViewUniformShaderParameters, View)
    SHADER_PARAMETER_STRUCT_INCLUDE(FSceneTextureShaderParameters, SceneTextures)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorSamp)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehDepthSamp)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorSampB)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorSampC)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorSampD)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorSampE)
    SHADER_PARAMETER_RDG_TEXTURE(Texture2D, BokehColorSampF)
    SHADER_PARAMETER_SAMPLER(SamplerState, BokehLinearClamp)
    SHADER_PARAMETER(FIntPoint, BokehViewMin)
    SHADER_PARAMETER(FIntPoint, BokehTargetMin)
    SHADER_PARAMETER(FVector2f, BokehTargetSize)
    BOKEH_PARAMETERS(BOKEH_DECLARE)
    RENDER_TARGET_BINDING_SLOTS()
END_SHADER_PARAMETER_STRUCT()

class FBokehShader : public FGlobalShader
{
public:
    class FPreset : SHADER_PERMUTATION_INT("BOKEH_QUALITY", 5);
    using FPermutationDomain = TShaderPermutationDomain<FPreset>;
    using FParameters = FBokehParameters;
    FBokehShader() = default;
    FBokehShader(const ShaderMetaType::CompiledShaderInitializerType& Initializer) : FGlobalShader(Initializer) {}

    static bool ShouldCompilePermutation(const FGlobalShaderPermutationParameters& Parameters)
    {
        return IsFeatureLevelSupported(Parameters.Platform, ERHIFeatureLevel::SM5);
    }
};

#define BOKEH_SHADER(Name, Entry) \
    class FBokeh##Name##PS : public FBokehShader \
    { \
        DECLARE_GLOBAL_SHADER(FBokeh##Name##PS); \
        SHADER_USE_PARAMETER_STRUCT(FBokeh##Name##PS, FBokehShader); \
    }; \
    IMPLEMENT_GLOBAL_SHADER(FBokeh##Name##PS, "/Plugin/BokehDepthOfField/BokehDepthOfField.usf", Entry, SF_Pixel)

// These three replace passes of bokeh_passes.ush, which can read only textures that have the size of the view
BOKEH_SHADER(LinearDepth, "BokehViewMetres_PS");
BOKEH_SHADER(SignedCoCMap, "BokehViewMap_PS");
BOKEH_SHADER(CoCMap, "BokehPaperMap_PS");

// A function that draws a pass with the shader of a class
using FBokehDraw = void (*)(
    FRDGBuilder&, const FSceneView&, const FString& Name, FBokehParameters*, const FIntRect& Area, FRHIBlendState*);

template <typename ShaderType>
static void AddBokehPass(FRDGBuilder& GraphBuilder, const FSceneView& View, const FString& Name,
    FBokehParameters* Given, const FIntRect& Area, FRHIBlendState* Blend)
{
    typename ShaderType::FPermutationDomain Permutation;
    Permutation.template Set<FBokehShader::FPreset>(FMath::Clamp(SettingPreset.GetValueOnRenderThread(), 0, 4));
    const FGlobalShaderMap* ShaderMap = GetGlobalShaderMap(View.GetFeatureLevel());
    const TShaderMapRef<ShaderType> PixelShader(ShaderMap, Permutation);
    FPixelShaderUtils::AddFullscreenPass(GraphBuilder, ShaderMap, RDG_EVENT_NAME("Bokeh %s", *Name), PixelShader, Given,
        Area, Blend);
}

// Parameters whose values differ from pass to pass. The angle is in degrees, without r.Bokeh.Rotation
struct FBokehOwn
{
    float Angle = 0.0f;
    float Sides = 0.0f;
};

// Describes a pass.
//
// Draw    draws the pass with its shader
// Reads   names of the textures that it reads, separated by spaces; "-" leaves a slot unused
// Writes  names of its targets, separated by spaces
// Scale   divides the size of the view to get the size of the targets, rounded up
// Own     parameters whose values differ from pass to pass
struct FBokehStep
{
    FBokehDraw Draw;
    const TCHAR* Reads;
    const TCHAR* Writes;
    int32 Scale;
    FBokehOwn Own;
};

#include "BokehFrames.h"

// Draws the passes of one view. All passes except the last one write targets that have the size of the view or a
// fraction of it. In these targets, the coordinates of the library go from 0 to 1, wherever the view lies in the
// engine's textures.
struct FBokehPasses
{
    FRDGBuilder& GraphBuilder;
    const FSceneView& View;
    const FPostProcessMaterialInputs& Inputs;
    const FIntRect ViewRect;
    const FScreenPassRenderTarget& Output;
    const FBokehLens Lens;
    TMap<FString, FRDGTextureRef> Textures;

    // Returns the parameters that all passes of the view share
    FBokehParameters* Parameters() const
    {
        FBokehParameters* Given = GraphBuilder.AllocParameters<FBokehParameters>();
#define BOKEH_SET_DEFAULT(Name, Default) Given->Bokeh##Name = Default;
        BOKEH_PARAMETERS(BOKEH_SET_DEFAULT)
        Given->View = View.ViewUniformBuffer;
        Given->SceneTextures = Inputs.SceneTextures;
        Given->BokehLinearClamp = TStaticSamplerState<SF_Bilinear, AM_Clamp, AM_Clamp, AM_Clamp>::GetRHI();
        Given->BokehViewMin = ViewRect.Min;
        Given->BokehImageWidth = static_cast<float>(ViewRect.Width());
        Given->BokehImageHeight = static_cast<float>(ViewRect.Height());
        Given->BokehAspectRatio = Given->BokehImageWidth / Given->BokehImageHeight;
        // M[1][1] is 1 / tan(half of the vertical field of view): docs/lens.md
        const float Zoom = static_cast<float>(View.ViewMatrices.GetProjectionMatrix().M[1][1]);
        Given->BokehFocalLength = 0.5f * Lens.SensorHeight * Zoom;
        Given->BokehApertureDiameter = SettingBokehScale.GetValueOnRenderThread() * Given->BokehFocalLength / Lens.FStop;
        Given->BokehFocusDistance = Lens.FocusDistance;
        Given->BokehSensorHeight = Lens.SensorHeight;
        Given->BokehMaxCoC = SettingMaxCoC.GetValueOnRenderThread();
        Given->BokehNearScale = SettingNearScale.GetValueOnRenderThread();
        Given->BokehFarScale = SettingFarScale.GetValueOnRenderThread();
        Given->BokehNearMaxCoC = SettingNearMaxCoC.GetValueOnRenderThread();
        Given->BokehFarMaxCoC = SettingFarMaxCoC.GetValueOnRenderThread();
        Given->BokehSqueeze = Lens.Squeeze;
        Given->BokehDebugMode = static_cast<float>(SettingDebug.GetValueOnRenderThread() - 1);
        return Given;
    }

    void Draw(const FBokehStep& Step)
    {
        FBokehParameters* Given = Parameters();
        Given->BokehAngle = FMath::DegreesToRadians(Step.Own.Angle + SettingRotation.GetValueOnRenderThread());
        Given->BokehSides = Step.Own.Sides;
        TArray<FString> Reads, Writes;
        FString(Step.Reads).ParseIntoArray(Reads, TEXT(" "));
        FString(Step.Writes).ParseIntoArray(Writes, TEXT(" "));
        const auto Read = [&](int32 Slot) -> FRDGTextureRef
        {
            return Reads.IsValidIndex(Slot) ? Textures.FindRef(Reads[Slot]) : nullptr;
        };
        Given->BokehColorSamp = Read(0);
        Given->BokehColorSampB = Read(1);
        Given->BokehColorSampC = Read(2);
        Given->BokehColorSampD = Read(3);
        Given->BokehColorSampE = Read(4);
        Given->BokehColorSampF = Read(5);
        // BokehDepthKind keeps its default of 0: depth is in metres
        Given->BokehDepthSamp = Textures.FindRef(TEXT("metres"));

        // in the tables, the layers have half the view's size; with the preset mobile, they have a quarter
        const bool bQuarter = Step.Scale == 2 && SettingPreset.GetValueOnRenderThread() >= 4;
        FIntRect Area(FIntPoint(0, 0), FIntPoint::DivideAndRoundUp(ViewRect.Size(), bQuarter ? 4 : Step.Scale));
        FRHIBlendState* Blend = nullptr;
        if (Writes[0] == TEXT("result"))
        {
            // draw into the part of the engine's target that belongs to this view; the blend state writes 0 to alpha
            // instead of the circle of confusion
            Area = Output.ViewRect;
            Given->RenderTargets[0] = Output.GetRenderTargetBinding();
            Blend = TStaticBlendState<CW_RGBA, BO_Add, BF_One, BF_Zero, BO_Add, BF_Zero, BF_Zero>::GetRHI();
        }
        for (int32 Index = 0; Blend == nullptr && Index < Writes.Num(); Index++)
        {
            const EPixelFormat Format = Writes[Index] == TEXT("metres") ? PF_R32_FLOAT : PF_FloatRGBA;
            const FRDGTextureDesc Description = FRDGTextureDesc::Create2D(Area.Size(), Format,
                FClearValueBinding::None, TexCreate_ShaderResource | TexCreate_RenderTargetable);
            FRDGTextureRef Texture = GraphBuilder.CreateTexture(Description, TEXT("Bokeh"));
            Given->RenderTargets[Index] = FRenderTargetBinding(Texture, ERenderTargetLoadAction::ENoAction);
            Textures.Add(Writes[Index], Texture);
        }
        Given->BokehTargetMin = Area.Min;
        Given->BokehTargetSize = FVector2f(static_cast<float>(Area.Width()), static_cast<float>(Area.Height()));
        Step.Draw(GraphBuilder, View, Writes[0], Given, Area, Blend);
    }
};

FBokehViewExtension::FBokehViewExtension(const FAutoRegister& AutoRegister)
    : FSceneViewExtensionBase(AutoRegister)
{
}

bool FBokehViewExtension::IsActiveThisFrame_Internal(const FSceneViewExtensionContext& Context) const
{
    const bool bBlurs = SettingBokehScale.GetValueOnGameThread() > 0.0f || SettingDebug.GetValueOnGameThread() > 0;
    return SettingEnable.GetValueOnGameThread() != 0 && bBlurs;
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
    const FBokehLens Lens(View, SceneColor.ViewRect);
    FBokehPasses Passes{GraphBuilder, View, Inputs, SceneColor.ViewRect, Output, Lens, {}};
    Passes.Textures.Add(TEXT("color"), SceneColor.Texture);

    const bool bDebug = SettingDebug.GetValueOnRenderThread() > 0;
    const int32 Method = bDebug ? 0 : SettingMethod.GetValueOnRenderThread();
    if (bDebug || Method == 2)
    {
        Passes.Draw({&AddBokehPass<FBokehLinearDepthPS>, TEXT(""), TEXT("metres"), 1, {}});
    }
    // the passes of paper read a CoC without a sign
    const FBokehDraw Map = Method == 2 ? &AddBokehPass<FBokehCoCMapPS> : &AddBokehPass<FBokehSignedCoCMapPS>;
    Passes.Draw({Map, TEXT("color"), TEXT("coc"), 1, {}});
    if (bDebug)
    {
        Passes.Draw({&AddBokehPass<FBokehDebugPS>, TEXT("coc"), TEXT("result"), 1, {}});
        return Output;
    }
    const auto Frame = Method == 0 ? &BokehLayered : Method == 1 ? &BokehExact : &BokehPaper;
    const TArray<FBokehStep>* Steps = Frame(Lens.Sides);
    for (const FBokehStep& Step : Steps ? *Steps : *Frame(6))
    {
        Passes.Draw(Step);
    }
    return Output;
}
