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

    // Focus on what is seen at a pixel of the viewport. Returns false if nothing there blocks the Visibility channel.
    BOKEHDEPTHOFFIELD_API bool FocusOnPixel(const APlayerController& Player, const FVector2D& Pixel);

    // Autofocus, to be called in each frame: moves the focus towards the nearest thing seen at these pixels; Tau is the
    // time constant in seconds
    BOKEHDEPTHOFFIELD_API void PullFocus(
        const APlayerController& Player, const TArray<FVector2D>& Pixels, float DeltaSeconds, float Tau = 0.2f);

    // Use the camera's focus again: the focus distance of a cine camera or a post-process volume, or 5 m if there is none
    BOKEHDEPTHOFFIELD_API void FollowCamera();
}
