// Stand-ins for the classes and macros of Unreal 5.6 that integration/unreal uses: signatures after the public API,
// nothing behind them. For `g++ -fsyntax-only`; every header that the plug-in includes is this one.

#pragma once

#include <cstdint>
#include <initializer_list>

using int32 = std::int32_t;
using uint32 = std::uint32_t;
using TCHAR = char16_t;
#define STUB_TEXT(x) u##x
#define TEXT(x) STUB_TEXT(x)
#define BOKEHDEPTHOFFIELD_API

// ---- Core ----

template <typename T> struct TArray
{
    TArray() = default;
    TArray(std::initializer_list<T>) {}
    const T* begin() const { return nullptr; }
    const T* end() const { return nullptr; }
    const T& operator[](int32) const { return *begin(); }
    bool IsValidIndex(int32) const { return false; }
    int32 Num() const { return 0; }
};

struct FString
{
    FString() = default;
    FString(const TCHAR*) {}
    const TCHAR* operator*() const { return nullptr; }
    bool operator==(const TCHAR*) const { return false; }
    int32 ParseIntoArray(TArray<FString>& OutArray, const TCHAR* pchDelim, bool InCullEmpty = true) const { return 0; }
};

template <typename Key, typename Value> struct TMap
{
    void Add(const Key&, const Value&) {}
    Value FindRef(const Key&) const { return {}; }
};

struct FPaths
{
    template <typename... Parts> static FString Combine(Parts&&...) { return {}; }
};

enum class ESPMode { NotThreadSafe, ThreadSafe };

template <typename T, ESPMode Mode = ESPMode::ThreadSafe> struct TSharedRef
{
    T* operator->() const { return nullptr; }
};

template <typename T, ESPMode Mode = ESPMode::ThreadSafe> struct TSharedPtr
{
    TSharedPtr() = default;
    TSharedPtr(const TSharedRef<T, Mode>&) {}
    T* operator->() const { return nullptr; }
    void Reset() {}
};

struct FMath
{
    template <typename T> static T DegreesToRadians(T Degrees) { return Degrees; }
    template <typename T> static T Max(T A, T B) { return A; }
    template <typename T> static T Clamp(T A, T Min, T Max) { return A; }
    static float Exp(float Value) { return Value; }
};

struct FVector
{
    double X, Y, Z;
    FVector operator-(const FVector&) const { return *this; }
    static double DotProduct(const FVector&, const FVector&) { return 0; }
};

struct FVector2D { double X, Y; };

struct FMatrix
{
    double M[4][4];
};

struct FVector2f
{
    FVector2f() = default;
    FVector2f(float, float) {}
};

struct FRotator
{
    FVector Vector() const { return {}; }
};

struct FIntPoint
{
    int32 X = 0, Y = 0;
    FIntPoint() = default;
    FIntPoint(int32 InX, int32 InY) : X(InX), Y(InY) {}
    static FIntPoint DivideAndRoundUp(FIntPoint A, int32 Divisor) { return A; }
};

struct FIntRect
{
    FIntPoint Min, Max;
    FIntRect() = default;
    FIntRect(FIntPoint InMin, FIntPoint InMax) : Min(InMin), Max(InMax) {}
    int32 Width() const { return 0; }
    int32 Height() const { return 0; }
    FIntPoint Size() const { return {}; }
};

enum EConsoleVariableFlags { ECVF_Default = 0, ECVF_RenderThreadSafe = 0x20, ECVF_SetByCode = 0x0d000000 };

struct IConsoleVariable
{
    void Set(float, EConsoleVariableFlags) {}
    float GetFloat() const { return 0; }
};

struct IConsoleManager
{
    static IConsoleManager& Get();
    IConsoleVariable* FindConsoleVariable(const TCHAR*) const;
};

template <typename T> struct TAutoConsoleVariable
{
    TAutoConsoleVariable(const TCHAR*, const T&, const TCHAR*, uint32 = ECVF_Default) {}
    T GetValueOnRenderThread() const { return {}; }
    T GetValueOnGameThread() const { return {}; }
};

struct FSimpleMulticastDelegate
{
    template <typename T> void AddRaw(T*, void (T::*)()) {}
    void RemoveAll(const void*) {}
};

// 5.6, or what the compiler is told
#ifndef STUB_ENGINE_MINOR
#define STUB_ENGINE_MINOR 6
#endif
#define UE_VERSION_OLDER_THAN(Major, Minor, Patch) (5 < Major || (5 == Major && STUB_ENGINE_MINOR < Minor))

struct FCoreDelegates
{
#if STUB_ENGINE_MINOR < 8
    static FSimpleMulticastDelegate OnPostEngineInit;
#else
    static FSimpleMulticastDelegate& GetOnPostEngineInit();
#endif
};

struct IModuleInterface
{
    virtual ~IModuleInterface() = default;
    virtual void StartupModule() {}
    virtual void ShutdownModule() {}
};
#define IMPLEMENT_MODULE(ModuleImplClass, ModuleName) static ModuleImplClass Stub##ModuleName;

// ---- Projects, RenderCore ----

struct IPlugin
{
    FString GetBaseDir() const { return {}; }
};

struct IPluginManager
{
    static IPluginManager& Get();
    TSharedPtr<IPlugin> FindPlugin(const TCHAR*);
};

void AddShaderSourceDirectoryMapping(const FString& VirtualShaderDirectory, const FString& RealShaderDirectory);

struct ERHIFeatureLevel
{
    enum Type { ES3_1 = 1, SM5 = 3, SM6 = 4 };
};
enum EShaderPlatform { SP_PCD3D_SM5, SP_PCD3D_SM6 };
bool IsFeatureLevelSupported(EShaderPlatform Platform, ERHIFeatureLevel::Type FeatureLevel);

enum EPixelFormat { PF_Unknown, PF_FloatRGBA, PF_R32_FLOAT };
enum class ERenderTargetLoadAction { ENoAction, ELoad, EClear };
enum ETextureCreateFlags : uint32 { TexCreate_ShaderResource = 1, TexCreate_RenderTargetable = 2 };
inline ETextureCreateFlags operator|(ETextureCreateFlags A, ETextureCreateFlags B)
{
    return static_cast<ETextureCreateFlags>(static_cast<uint32>(A) | static_cast<uint32>(B));
}
enum ESamplerFilter { SF_Point, SF_Bilinear };
enum ESamplerAddressMode { AM_Wrap, AM_Clamp };

struct FRHISamplerState {};
template <ESamplerFilter, ESamplerAddressMode = AM_Clamp, ESamplerAddressMode = AM_Clamp,
    ESamplerAddressMode = AM_Clamp>
struct TStaticSamplerState
{
    static FRHISamplerState* GetRHI() { return nullptr; }
};

enum EColorWriteMask { CW_RGBA = 15 };
enum EBlendOperation { BO_Add };
enum EBlendFactor { BF_Zero, BF_One };
struct FRHIBlendState {};
template <EColorWriteMask, EBlendOperation, EBlendFactor, EBlendFactor, EBlendOperation, EBlendFactor, EBlendFactor>
struct TStaticBlendState
{
    static FRHIBlendState* GetRHI() { return nullptr; }
};

struct FClearValueBinding
{
    static const FClearValueBinding None;
};

struct FRDGTexture {};
using FRDGTextureRef = FRDGTexture*;

struct FRDGTextureDesc
{
    static FRDGTextureDesc Create2D(FIntPoint, EPixelFormat, FClearValueBinding, ETextureCreateFlags) { return {}; }
};

struct FRDGBuilder
{
    FRDGTextureRef CreateTexture(const FRDGTextureDesc&, const TCHAR*) { return nullptr; }
    template <typename T> T* AllocParameters() { return nullptr; }
};

struct FRDGEventName
{
    template <typename... T> explicit FRDGEventName(const TCHAR*, T...) {}
};
#define RDG_EVENT_NAME(Format, ...) FRDGEventName(TEXT(Format) __VA_OPT__(, ) __VA_ARGS__)

struct FRenderTargetBinding
{
    FRenderTargetBinding() = default;
    FRenderTargetBinding(FRDGTextureRef, ERenderTargetLoadAction) {}
};

template <typename T> struct TUniformBufferRef {};
struct FViewUniformShaderParameters {};
struct FSceneTextureShaderParameters {};

#define BEGIN_SHADER_PARAMETER_STRUCT(StructTypeName, DllStorage) struct DllStorage StructTypeName {
#define END_SHADER_PARAMETER_STRUCT() };
#define SHADER_PARAMETER(MemberType, MemberName) MemberType MemberName;
#define SHADER_PARAMETER_STRUCT_REF(StructType, MemberName) TUniformBufferRef<StructType> MemberName;
#define SHADER_PARAMETER_STRUCT_INCLUDE(StructType, MemberName) StructType MemberName;
#define SHADER_PARAMETER_RDG_TEXTURE(ShaderType, MemberName) FRDGTextureRef MemberName;
#define SHADER_PARAMETER_SAMPLER(ShaderType, MemberName) FRHISamplerState* MemberName;
#define RENDER_TARGET_BINDING_SLOTS() FRenderTargetBinding RenderTargets[8];

struct FGlobalShaderPermutationParameters
{
    EShaderPlatform Platform;
};

struct FGlobalShader
{
    struct ShaderMetaType
    {
        struct CompiledShaderInitializerType {};
    };
    FGlobalShader() = default;
    FGlobalShader(const ShaderMetaType::CompiledShaderInitializerType&) {}
};

enum EShaderFrequency { SF_Vertex, SF_Pixel };
#define DECLARE_GLOBAL_SHADER(ShaderClass) \
public: \
    static const TCHAR* StubEntry()
#define SHADER_USE_PARAMETER_STRUCT(ShaderClass, ShaderParentClass) \
    ShaderClass() = default; \
    ShaderClass(const ShaderMetaType::CompiledShaderInitializerType& Initializer) : ShaderParentClass(Initializer) {} \
    static_assert(sizeof(FParameters) > 0)
#define IMPLEMENT_GLOBAL_SHADER(ShaderClass, SourceFilename, FunctionName, Frequency) \
    const TCHAR* ShaderClass::StubEntry() \
    { \
        return Frequency == SF_Pixel ? TEXT(FunctionName) : TEXT(SourceFilename); \
    } \
    static_assert(true)

struct FGlobalShaderMap {};
FGlobalShaderMap* GetGlobalShaderMap(ERHIFeatureLevel::Type FeatureLevel);

template <typename T> struct TShaderRef {};
template <typename T> struct TShaderMapRef : TShaderRef<T>
{
    TShaderMapRef(const FGlobalShaderMap*, const typename T::FPermutationDomain&) {}
};

template <int Count> struct FShaderPermutationInt {};
#define SHADER_PERMUTATION_INT(InDefineName, Count) public FShaderPermutationInt<Count> { }
template <typename... T> struct TShaderPermutationDomain
{
    template <typename Dimension> void Set(int32) {}
};

struct FPixelShaderUtils
{
    template <typename TShaderClass>
    static void AddFullscreenPass(FRDGBuilder&, const FGlobalShaderMap*, FRDGEventName&&,
        const TShaderRef<TShaderClass>&, typename TShaderClass::FParameters*, const FIntRect&, FRHIBlendState* = nullptr)
    {
    }
};

// ---- Renderer ----

struct FScreenPassTextureSlice {};

struct FScreenPassTexture
{
    FScreenPassTexture() = default;
    explicit FScreenPassTexture(FRDGTextureRef) {}
    FScreenPassTexture(FRDGTextureRef, FIntRect) {}
    static FScreenPassTexture CopyFromSlice(FRDGBuilder&, const FScreenPassTextureSlice&);
    FRDGTextureRef Texture = nullptr;
    FIntRect ViewRect;
};

struct FScreenPassRenderTarget : FScreenPassTexture
{
    FScreenPassRenderTarget() = default;
    FScreenPassRenderTarget(FRDGTextureRef InTexture, ERenderTargetLoadAction) : FScreenPassTexture(InTexture) {}
    static FScreenPassRenderTarget CreateFromInput(FRDGBuilder&, FScreenPassTexture, ERenderTargetLoadAction,
        const TCHAR*)
    {
        return {};
    }
    FRenderTargetBinding GetRenderTargetBinding() const { return {}; }
};

enum class EPostProcessMaterialInput : uint32 { SceneColor = 0, SeparateTranslucency = 1, CombinedBloom = 2 };

struct FPostProcessMaterialInputs
{
    FScreenPassTextureSlice GetInput(EPostProcessMaterialInput) const { return {}; }
    FScreenPassRenderTarget OverrideOutput;
    FSceneTextureShaderParameters SceneTextures;
};

// ---- Engine ----

struct FSceneViewFamily {};
struct FSceneViewExtensionContext {};

struct FViewMatrices
{
    FMatrix ProjectionMatrix;
    const FMatrix& GetProjectionMatrix() const { return ProjectionMatrix; }
};

struct FPostProcessSettings
{
    float DepthOfFieldFocalDistance, DepthOfFieldFstop, DepthOfFieldSensorWidth, DepthOfFieldSqueezeFactor;
    int32 DepthOfFieldBladeCount;
};

struct FFinalPostProcessSettings : FPostProcessSettings {};

struct FSceneView
{
    FFinalPostProcessSettings FinalPostProcessSettings;
    FViewMatrices ViewMatrices;
    TUniformBufferRef<FViewUniformShaderParameters> ViewUniformBuffer;
    bool bIsSceneCapture, bIsReflectionCapture;
    ERHIFeatureLevel::Type GetFeatureLevel() const { return ERHIFeatureLevel::SM5; }
};

struct FPostProcessingPassDelegate
{
    template <typename T>
    static FPostProcessingPassDelegate CreateRaw(T*,
        FScreenPassTexture (T::*)(FRDGBuilder&, const FSceneView&, const FPostProcessMaterialInputs&))
    {
        return {};
    }
};

struct FPostProcessingPassDelegateArray
{
    int32 Add(const FPostProcessingPassDelegate&) { return 0; }
};

struct FAutoRegister {};

class ISceneViewExtension
{
public:
    enum class EPostProcessingPass : uint32
    {
        BeforeDOF, AfterDOF, TranslucencyAfterDOF, SSRInput, ReplacingTonemapper, MotionBlur, Tonemap, FXAA, MAX
    };
    virtual ~ISceneViewExtension() = default;
    virtual void SetupViewFamily(FSceneViewFamily& InViewFamily) = 0;
    virtual void SetupView(FSceneViewFamily& InViewFamily, FSceneView& InView) = 0;
    virtual void BeginRenderViewFamily(FSceneViewFamily& InViewFamily) = 0;
    virtual void SubscribeToPostProcessingPass(EPostProcessingPass Pass, const FSceneView& InView,
        FPostProcessingPassDelegateArray& InOutPassCallbacks, bool bIsPassEnabled)
    {
    }

protected:
    virtual bool IsActiveThisFrame_Internal(const FSceneViewExtensionContext& Context) const { return true; }
};

class FSceneViewExtensionBase : public ISceneViewExtension
{
public:
    FSceneViewExtensionBase(const FAutoRegister&) {}
};

struct FSceneViewExtensions
{
    template <typename T> static TSharedRef<T, ESPMode::ThreadSafe> NewExtension()
    {
        static T Made{FAutoRegister{}};
        return {};
    }
};

enum ECollisionChannel { ECC_WorldStatic, ECC_Visibility };

struct FHitResult
{
    FVector ImpactPoint;
};

class APlayerController
{
public:
    virtual ~APlayerController() = default;
    virtual void GetPlayerViewPoint(FVector& out_Location, FRotator& out_Rotation) const {}
    bool GetHitResultAtScreenPosition(const FVector2D ScreenPosition, const ECollisionChannel TraceChannel,
        bool bTraceComplex, FHitResult& HitResult) const
    {
        return false;
    }
};
