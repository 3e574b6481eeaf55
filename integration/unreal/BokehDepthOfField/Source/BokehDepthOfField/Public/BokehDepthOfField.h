// Copyright (c) 2026 the authors of the polygonal bokeh shader package
// SPDX-License-Identifier: MIT
// Where the focus is. These functions set r.Bokeh.FocusDistance; call them each frame to follow an object.

#pragma once

#include "CoreMinimal.h"

class APlayerController;

namespace Bokeh
{
    // Focus on a place in the world
    BOKEHDEPTHOFFIELD_API void FocusOn(const APlayerController& Player, const FVector& WorldPosition);

    // Focus on what is seen at a pixel of the viewport. False where nothing is that blocks the Visibility channel.
    BOKEHDEPTHOFFIELD_API bool FocusOnPixel(const APlayerController& Player, const FVector2D& Pixel);

    // Autofocus, each frame: towards the nearest of what is seen at these pixels, with Tau seconds as time constant
    BOKEHDEPTHOFFIELD_API void PullFocus(
        const APlayerController& Player, const TArray<FVector2D>& Pixels, float DeltaSeconds, float Tau = 0.2f);

    // Give the focus back to the camera: that of a cine camera or a post-process volume, or 5 m
    BOKEHDEPTHOFFIELD_API void FollowCamera();
}
