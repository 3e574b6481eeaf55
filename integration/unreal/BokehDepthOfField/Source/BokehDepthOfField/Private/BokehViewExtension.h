// Copyright (c) 2026 the authors of the polygonal bokeh shader package
// SPDX-License-Identifier: MIT

#pragma once

#include "CoreMinimal.h"
#include "SceneViewExtension.h"

// Draws the effect in each view, at the point of the frame just before the engine's own depth of field
class FBokehViewExtension : public FSceneViewExtensionBase
{
public:
    FBokehViewExtension(const FAutoRegister& AutoRegister);

    virtual void SetupViewFamily(FSceneViewFamily& InViewFamily) override {}
    virtual void SetupView(FSceneViewFamily& InViewFamily, FSceneView& InView) override {}
    virtual void BeginRenderViewFamily(FSceneViewFamily& InViewFamily) override {}
    virtual void SubscribeToPostProcessingPass(EPostProcessingPass Pass, const FSceneView& InView,
        FPostProcessingPassDelegateArray& InOutPassCallbacks, bool bIsPassEnabled) override;

protected:
    virtual bool IsActiveThisFrame_Internal(const FSceneViewExtensionContext& Context) const override;

private:
    FScreenPassTexture Draw(FRDGBuilder& GraphBuilder, const FSceneView& View,
        const FPostProcessMaterialInputs& Inputs);
};
