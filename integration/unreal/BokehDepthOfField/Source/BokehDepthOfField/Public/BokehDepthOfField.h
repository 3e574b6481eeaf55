// Copyright (c) 2026 the authors of the polygonal bokeh shader package
// SPDX-License-Identifier: MIT
// Functions that set the focus. They change the console variable r.Bokeh.FocusDistance. To follow a moving object, call
// FocusOn in every frame.

#pragma once

#include "CoreMinimal.h"

class APlayerController;

namespace Bokeh
{
    // Focuses on a point of the world, in world space
    BOKEHDEPTHOFFIELD_API void FocusOn(const APlayerController& Player, const FVector& WorldPosition);

    // Focuses on the object at a pixel of the viewport. Returns false if nothing there blocks the Visibility channel.
    BOKEHDEPTHOFFIELD_API bool FocusOnPixel(const APlayerController& Player, const FVector2D& Pixel);

    // Moves the focus smoothly towards the nearest object at these pixels of the viewport. Call it in every frame.
    // DeltaSeconds is the time since the last frame, and Tau is the time constant of the movement in seconds.
    BOKEHDEPTHOFFIELD_API void PullFocus(
        const APlayerController& Player, const TArray<FVector2D>& Pixels, float DeltaSeconds, float Tau = 0.2f);

    // Lets the camera set the focus again. The focus distance then comes from a cine camera or a post-process volume,
    // or is 5 m if there is none.
    BOKEHDEPTHOFFIELD_API void FollowCamera();
}
