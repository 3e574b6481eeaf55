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
        [Tooltip("Fraction of the full aperture. 0 turns the effect off, and no pass is drawn. To fade the effect in "
            + "or out, blend this setting between volumes.")]
        public ClampedFloatParameter strength = new ClampedFloatParameter(0.0f, 0.0f, 1.0f);

        [Header("Lens")]
        [Tooltip("Takes focal length, f-stop, focus distance, number of blades and anamorphism from the camera "
            + "component, if Physical Camera is ticked there too.")]
        public BoolParameter physicalCamera = new BoolParameter(false);

        [Tooltip("Distance to the plane in focus, in metres along the view axis. A BokehFocus on the camera "
            + "overrides it.")]
        public MinFloatParameter focusDistance = new MinFloatParameter(5.0f, 0.1f);

        [Tooltip("A lower f-stop blurs more. The focal length comes from the camera's field of view.")]
        public MinFloatParameter fStop = new MinFloatParameter(2.8f, 0.01f);

        [Tooltip("Multiplies the width of the blur. 1 is a real lens, which hardly blurs at a game's field of view. "
            + "0 turns the effect off.")]
        public MinFloatParameter bokehScale = new MinFloatParameter(10.0f, 0.0f);

        [Tooltip("Height of the camera's sensor in millimetres. A frame of 35 mm film is 24 mm high.")]
        public MinFloatParameter sensorHeight = new MinFloatParameter(24.0f, 1.0f);

        [Tooltip("Largest diameter of the circle of confusion, as a fraction of the image height.")]
        public ClampedFloatParameter maxCoC = new ClampedFloatParameter(0.1f, 0.0f, 0.5f);

        [Tooltip("Multiplies the circle of confusion in front of the focus distance. Paper ignores this setting and "
            + "the next three.")]
        public MinFloatParameter nearScale = new MinFloatParameter(1.0f, 0.0f);

        [Tooltip("Multiplies the circle of confusion behind the focus distance.")]
        public MinFloatParameter farScale = new MinFloatParameter(1.0f, 0.0f);

        [Tooltip("Largest diameter of the circle of confusion in front of the focus distance, as a fraction of the "
            + "image height. Max CoC limits it too.")]
        public ClampedFloatParameter nearMaxCoC = new ClampedFloatParameter(1.0f, 0.0f, 1.0f);

        [Tooltip("Largest diameter of the circle of confusion behind the focus distance, as a fraction of the image "
            + "height. Max CoC limits it too.")]
        public ClampedFloatParameter farMaxCoC = new ClampedFloatParameter(1.0f, 0.0f, 1.0f);

        [Header("Bokeh")]
        [Tooltip("The polygon that a blurred light becomes. Paper draws a hexagon instead of a square or decagon.")]
        public EnumParameter<BokehAperture> aperture = new EnumParameter<BokehAperture>(BokehAperture.Hexagon);

        [Tooltip("Rotates the polygon clockwise, in degrees.")]
        public ClampedFloatParameter rotation = new ClampedFloatParameter(0.0f, 0.0f, 360.0f);

        [Tooltip("Width of the bokeh divided by its height. 0.5 looks like an anamorphic lens.")]
        public ClampedFloatParameter squeeze = new ClampedFloatParameter(1.0f, 0.25f, 1.0f);

        [Header("Quality")]
        [Tooltip("Layered looks like a lens: blurred near objects spread over the sharp background. Exact is "
            + "cheaper, but blurred near objects keep a hard outline. Paper is the method of McIntosh, Riecke and "
            + "DiPaola 2012.")]
        public EnumParameter<BokehMethod> method = new EnumParameter<BokehMethod>(BokehMethod.Layered);

        public bool IsActive()
        {
            return strength.value > 0.0f && bokehScale.value > 0.0f;
        }
    }
}
