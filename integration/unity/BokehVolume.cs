// SPDX-License-Identifier: MIT
// The lens of BokehRendererFeature as a Volume override (Add Override, Post-processing, Polygonal Bokeh), for a feature
// whose Lens From Volumes is on.

using System;
using UnityEngine;
using UnityEngine.Rendering;

[Serializable, VolumeComponentMenu("Post-processing/Polygonal Bokeh")]
public sealed class BokehVolume : VolumeComponent, IPostProcessComponent
{
    [Tooltip("Share of the aperture: 0 is no blur, and no pass is drawn. Blend this one between volumes.")]
    public ClampedFloatParameter strength = new ClampedFloatParameter(0.0f, 0.0f, 1.0f);

    [Tooltip("The focal length is that of the camera's field of view. Smaller than any real lens: more blur")]
    public MinFloatParameter fStop = new MinFloatParameter(0.2f, 0.01f);

    [Tooltip("Metres along the view axis. A BokehFocus on the camera overrides it.")]
    public MinFloatParameter focusDistance = new MinFloatParameter(5.0f, 0.1f);

    [Tooltip("Fraction of the image height")]
    public ClampedFloatParameter maxCoC = new ClampedFloatParameter(0.1f, 0.0f, 1.0f);

    [Tooltip("Degrees")]
    public ClampedFloatParameter rotation = new ClampedFloatParameter(0.0f, 0.0f, 360.0f);

    [Tooltip("Width over height: 0.5 is anamorphic")]
    public ClampedFloatParameter squeeze = new ClampedFloatParameter(1.0f, 0.25f, 1.0f);

    public bool IsActive()
    {
        return strength.value > 0.0f;
    }

    // What the volumes say of the lens, into a feature's settings
    public void CopyTo(BokehRendererFeature.Settings settings)
    {
        settings.fStop = fStop.value / strength.value;
        settings.focusDistance = focusDistance.value;
        settings.maxCoC = maxCoC.value;
        settings.rotation = rotation.value;
        settings.squeeze = squeeze.value;
    }
}
