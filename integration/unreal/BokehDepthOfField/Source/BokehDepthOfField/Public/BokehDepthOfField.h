// SPDX-License-Identifier: MIT
// Where the focus is. Both functions set r.Bokeh.FocusDistance; call them each frame to follow an object.

#pragma once

#include "CoreMinimal.h"

class APlayerController;

namespace Bokeh
{
    // Focus on a place in the world
    BOKEHDEPTHOFFIELD_API void FocusOn(const APlayerController& Player, const FVector& WorldPosition);

    // Focus on what is seen at a pixel of the viewport. False where nothing is that blocks the Visibility channel.
    BOKEHDEPTHOFFIELD_API bool FocusOnPixel(const APlayerController& Player, const FVector2D& Pixel);
}
