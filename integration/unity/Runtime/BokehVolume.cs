// SPDX-License-Identifier: MIT
// The Volume override with the settings of BokehRendererFeature (Add Override, Post-processing, Polygonal Bokeh). Only
// the preset and the debug view are settings of the feature itself. The feature draws nothing until a volume overrides
// Strength.

using System;
using UnityEngine;
using UnityEngine.Rendering;
using UnityEngine.Rendering.Universal;

namespace PolygonalBokeh
{
    public enum BokehMethod { Layered, Exact, Paper }

    public enum BokehAperture { Square = 4, Hexagon = 6, Octagon = 8, Decagon = 10 }

    [Serializable, VolumeComponentMenu("Post-processing/Polygonal Bokeh")]
    [SupportedOnRenderPipeline(typeof(UniversalRenderPipelineAsset))]
    [VolumeRequiresRendererFeatures(typeof(BokehRendererFeature))]
    public sealed class BokehVolume : VolumeComponent, IPostProcessComponent
    {
        [Tooltip("Share of the aperture: 1 is all of it; 0 is no blur, and no pass is drawn. Blend this one between volumes.")]
        public ClampedFloatParameter strength = new ClampedFloatParameter(0.0f, 0.0f, 1.0f);

        [Header("Lens")]
        [Tooltip("Take focal length, f-stop, focus distance, number of blades and anamorphism from a camera whose Physical "
            + "Camera is ticked")]
        public BoolParameter physicalCamera = new BoolParameter(false);

        [Tooltip("Metres along the view axis. A BokehFocus on the camera overrides it.")]
        public MinFloatParameter focusDistance = new MinFloatParameter(5.0f, 0.1f);

        [Tooltip("Focal length over aperture. The focal length is that of the camera's field of view")]
        public MinFloatParameter fStop = new MinFloatParameter(2.8f, 0.01f);

        [Tooltip("How many times wider the blur is than that lens's. 1 is the real lens, which hardly blurs at a game's field "
            + "of view; 0 is off")]
        public MinFloatParameter bokehScale = new MinFloatParameter(10.0f, 0.0f);

        [Tooltip("Millimetres: 24 is 35 mm film")]
        public MinFloatParameter sensorHeight = new MinFloatParameter(24.0f, 1.0f);

        [Tooltip("Largest circle of confusion: its diameter as a fraction of the image height")]
        public ClampedFloatParameter maxCoC = new ClampedFloatParameter(0.1f, 0.0f, 0.5f);

        [Tooltip("Factor of the circle of confusion in front of the focus distance. Paper ignores this and the next three")]
        public MinFloatParameter nearScale = new MinFloatParameter(1.0f, 0.0f);

        [Tooltip("Factor of the circle of confusion behind the focus distance")]
        public MinFloatParameter farScale = new MinFloatParameter(1.0f, 0.0f);

        [Tooltip("Limit in front of the focus distance, as Max CoC, which limits both sides")]
        public ClampedFloatParameter nearMaxCoC = new ClampedFloatParameter(1.0f, 0.0f, 1.0f);

        [Tooltip("Limit behind the focus distance")]
        public ClampedFloatParameter farMaxCoC = new ClampedFloatParameter(1.0f, 0.0f, 1.0f);

        [Header("Bokeh")]
        [Tooltip("The paper's method has Hexagon and Octagon")]
        public EnumParameter<BokehAperture> aperture = new EnumParameter<BokehAperture>(BokehAperture.Hexagon);

        [Tooltip("Degrees, clockwise")]
        public ClampedFloatParameter rotation = new ClampedFloatParameter(0.0f, 0.0f, 360.0f);

        [Tooltip("Width over height: 0.5 is anamorphic")]
        public ClampedFloatParameter squeeze = new ClampedFloatParameter(1.0f, 0.25f, 1.0f);

        [Header("Quality")]
        [Tooltip("Layered: near things spread over what is behind them. Exact: one layer, cheaper, near things keep a hard "
            + "outline. Paper: McIntosh 2012, lines combined by min")]
        public EnumParameter<BokehMethod> method = new EnumParameter<BokehMethod>(BokehMethod.Layered);

        public bool IsActive()
        {
            return strength.value > 0.0f && bokehScale.value > 0.0f;
        }
    }
}
