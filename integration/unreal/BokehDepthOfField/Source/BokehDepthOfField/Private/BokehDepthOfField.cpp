// Copyright (c) 2026 the authors of the polygonal bokeh shader package
// SPDX-License-Identifier: MIT
// Defines the plug-in's module, and the functions of BokehDepthOfField.h, which set the focus distance.

#include "BokehDepthOfField.h"

#include "BokehViewExtension.h"
#include "Engine/HitResult.h"
#include "GameFramework/PlayerController.h"
#include "HAL/IConsoleManager.h"
#include "Interfaces/IPluginManager.h"
#include "Misc/CoreDelegates.h"
#include "Misc/EngineVersionComparison.h"
#include "Misc/Paths.h"
#include "Modules/ModuleManager.h"
#include "SceneViewExtension.h"
#include "ShaderCore.h"

static auto& PostEngineInit()
{
#if UE_VERSION_OLDER_THAN(5, 8, 0)
    return FCoreDelegates::OnPostEngineInit;
#else
    return FCoreDelegates::GetOnPostEngineInit();
#endif
}

class FBokehDepthOfFieldModule : public IModuleInterface
{
public:
    virtual void StartupModule() override
    {
        const FString Folder = IPluginManager::Get().FindPlugin(TEXT("BokehDepthOfField"))->GetBaseDir();
        AddShaderSourceDirectoryMapping(TEXT("/Plugin/BokehDepthOfField"), FPaths::Combine(Folder, TEXT("Shaders")));
        // view extensions need the engine, which is not initialised yet
        PostEngineInit().AddRaw(this, &FBokehDepthOfFieldModule::Register);
    }

    virtual void ShutdownModule() override
    {
        PostEngineInit().RemoveAll(this);
        Extension.Reset();
    }

private:
    void Register()
    {
        Extension = FSceneViewExtensions::NewExtension<FBokehViewExtension>();
    }

    TSharedPtr<FBokehViewExtension, ESPMode::ThreadSafe> Extension;
};

IMPLEMENT_MODULE(FBokehDepthOfFieldModule, BokehDepthOfField)

namespace
{
    IConsoleVariable& FocusDistance()
    {
        return *IConsoleManager::Get().FindConsoleVariable(TEXT("r.Bokeh.FocusDistance"));
    }

    float Metres(const APlayerController& Player, const FVector& WorldPosition)
    {
        FVector Location;
        FRotator Rotation;
        Player.GetPlayerViewPoint(Location, Rotation);
        // depth along the view axis, not the length of the ray; the engine's unit is a centimetre
        const double Centimetres = FVector::DotProduct(WorldPosition - Location, Rotation.Vector());
        return static_cast<float>(Centimetres * 0.01);
    }
}

void Bokeh::FocusOn(const APlayerController& Player, const FVector& WorldPosition)
{
    FocusDistance().Set(Metres(Player, WorldPosition), ECVF_SetByCode);
}

bool Bokeh::FocusOnPixel(const APlayerController& Player, const FVector2D& Pixel)
{
    FHitResult Hit;
    if (!Player.GetHitResultAtScreenPosition(Pixel, ECC_Visibility, false, Hit))
    {
        return false;
    }
    FocusOn(Player, Hit.ImpactPoint);
    return true;
}

void Bokeh::PullFocus(const APlayerController& Player, const TArray<FVector2D>& Pixels, float DeltaSeconds, float Tau)
{
    // Interpolates 1 / distance instead of the distance: docs/lens.md. If no ray hits an object, the depth is 1000 km
    float Nearest = 1e-6f;
    for (const FVector2D& Pixel : Pixels)
    {
        FHitResult Hit;
        if (Player.GetHitResultAtScreenPosition(Pixel, ECC_Visibility, false, Hit))
        {
            Nearest = FMath::Max(Nearest, 1.0f / Metres(Player, Hit.ImpactPoint));
        }
    }
    const float K = 1.0f - FMath::Exp(-DeltaSeconds / Tau);
    const float Before = FocusDistance().GetFloat();
    // 0 means that the camera has set the focus until now. This distance is not known here, so the focus jumps
    const float Inverse = Before > 0.0f ? (1.0f - K) / Before + K * Nearest : Nearest;
    FocusDistance().Set(1.0f / Inverse, ECVF_SetByCode);
}

void Bokeh::FollowCamera()
{
    FocusDistance().Set(0.0f, ECVF_SetByCode);
}
