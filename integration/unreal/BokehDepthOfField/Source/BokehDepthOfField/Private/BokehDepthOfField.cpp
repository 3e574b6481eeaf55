// SPDX-License-Identifier: MIT
// The plug-in's module, and the focus distance from the world.

#include "BokehDepthOfField.h"

#include "BokehViewExtension.h"
#include "Engine/HitResult.h"
#include "GameFramework/PlayerController.h"
#include "HAL/IConsoleManager.h"
#include "Interfaces/IPluginManager.h"
#include "Misc/CoreDelegates.h"
#include "Misc/Paths.h"
#include "Modules/ModuleManager.h"
#include "SceneViewExtension.h"
#include "ShaderCore.h"

class FBokehDepthOfFieldModule : public IModuleInterface
{
public:
    virtual void StartupModule() override
    {
        const FString Folder = IPluginManager::Get().FindPlugin(TEXT("BokehDepthOfField"))->GetBaseDir();
        AddShaderSourceDirectoryMapping(TEXT("/Plugin/BokehDepthOfField"), FPaths::Combine(Folder, TEXT("Shaders")));
        // view extensions need the engine, which is not there yet
        FCoreDelegates::OnPostEngineInit.AddRaw(this, &FBokehDepthOfFieldModule::Register);
    }

    virtual void ShutdownModule() override
    {
        FCoreDelegates::OnPostEngineInit.RemoveAll(this);
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

void Bokeh::FocusOn(const APlayerController& Player, const FVector& WorldPosition)
{
    FVector Location;
    FRotator Rotation;
    Player.GetPlayerViewPoint(Location, Rotation);
    // depth along the view axis, not the length of the ray; the engine has centimetres
    const double Centimetres = FVector::DotProduct(WorldPosition - Location, Rotation.Vector());
    IConsoleVariable* Distance = IConsoleManager::Get().FindConsoleVariable(TEXT("r.Bokeh.FocusDistance"));
    Distance->Set(static_cast<float>(Centimetres * 0.01), ECVF_SetByCode);
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
