// SPDX-License-Identifier: MIT
// Draws depth of field with polygonal bokeh in the Universal Render Pipeline: Unity 6 (6000.0), URP 17, render graph.
// Add this feature to the renderer asset (Add Renderer Feature, Bokeh Renderer Feature). Most settings are in
// BokehVolume. The feature draws nothing until a volume overrides Strength.

using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Experimental.Rendering;
using UnityEngine.Rendering;
using UnityEngine.Rendering.RenderGraphModule;
using UnityEngine.Rendering.Universal;

namespace PolygonalBokeh
{
    // Describes a pass: a row of BokehFrames.
    //
    // reads   names of the textures that it reads, separated by spaces; "-" leaves a slot unused
    // writes  names of its targets, separated by spaces
    // scale   divides the size of the image to get the size of the targets, rounded up
    sealed class BokehStep
    {
        public readonly BokehShaderPass pass;
        public readonly string name;
        public readonly string[] reads;
        public readonly string[] writes;
        public readonly int scale;
        // parameters whose values differ from pass to pass; Angle is in degrees, without the volume's rotation
        public float Sides, Angle;

        public BokehStep(BokehShaderPass pass, string reads, string writes, int scale)
        {
            this.pass = pass;
            name = "Bokeh " + pass;
            this.reads = reads.Split(' ');
            this.writes = writes.Split(' ');
            this.scale = scale;
        }
    }

    public sealed class BokehRendererFeature : ScriptableRendererFeature
    {
        public enum View { Result, Colour, Depth, CircleOfConfusion, NearAndFar }

        // A build contains only the shader variants of the materials that its renderers use
        [Tooltip("The preset, which sets the number of samples. It is one of the package's materials, from Bokeh "
            + "Mobile to Bokeh Ultra.")]
        public Material material;

        [Tooltip("Selects what the camera shows: the result, or a debug view.")]
        public View view = View.Result;

        BokehPass pass;

        public override void Create()
        {
#if UNITY_EDITOR
            if (material == null)
            {
                material = UnityEditor.AssetDatabase.LoadAssetAtPath<Material>(
                    "Packages/com.polygonal-bokeh.urp/Materials/Bokeh Medium.mat");
                UnityEditor.EditorUtility.SetDirty(this);
            }
#endif
            pass = new BokehPass { renderPassEvent = RenderPassEvent.BeforeRenderingPostProcessing };
        }

        public override void AddRenderPasses(ScriptableRenderer renderer, ref RenderingData renderingData)
        {
            CameraType type = renderingData.cameraData.cameraType;
            if (material == null || !renderingData.cameraData.postProcessEnabled)
            {
                return;
            }
            // URP blends the volumes for this camera before it calls this method
            BokehVolume volume = VolumeManager.instance.stack?.GetComponent<BokehVolume>();
            if (volume == null || !volume.IsActive() || type == CameraType.Preview || type == CameraType.Reflection)
            {
                return;
            }
            pass.Setup(material, volume, view);
            renderer.EnqueuePass(pass);
        }

        // The values that all passes of a camera share. Lengths are in metres, and the rotation is in degrees.
        struct Values
        {
            public Material material;
            public float apertureDiameter, focalLength, focusDistance, sensorHeight;
            public float nearScale, farScale, nearMaxCoC, farMaxCoC;
            public float maxCoC, squeeze, rotation, debugMode;
            public float width, height;
            public float depthKind, near, far;
            public int sides;
        }

        // The data that the render function of a pass gets
        sealed class PassData
        {
            public BokehStep step;
            public Values values;
            public TextureHandle depth;
            public readonly TextureHandle[] reads = new TextureHandle[BokehFrames.Slots.Length];
        }

        sealed class BokehPass : ScriptableRenderPass
        {
            static readonly BokehStep Metres = new BokehStep(BokehShaderPass.LinearDepth, "", "metres", 1);
            static readonly BokehStep SignedMap = new BokehStep(BokehShaderPass.SignedCoCMap, "color", "coc", 1);
            static readonly BokehStep PaperMap = new BokehStep(BokehShaderPass.CoCMap, "color", "coc", 1);
            static readonly BokehStep Shown = new BokehStep(BokehShaderPass.Debug, "coc", "result", 1);
            static readonly MaterialPropertyBlock Properties = new MaterialPropertyBlock();

            readonly Dictionary<string, TextureHandle> textures = new Dictionary<string, TextureHandle>();
            Values values;
            BokehVolume volume;
            View view;
            TextureDesc description;

            public void Setup(Material material, BokehVolume newVolume, View newView)
            {
                values.material = material;
                volume = newVolume;
                view = newView;
                // request a depth texture, and a colour target that shaders can read
                ConfigureInput(ScriptableRenderPassInput.Depth);
                requiresIntermediateTexture = true;
            }

            public override void RecordRenderGraph(RenderGraph graph, ContextContainer frameData)
            {
                UniversalResourceData resources = frameData.Get<UniversalResourceData>();
                // a camera that renders only depth, and the 2D renderer, have no colour or depth to read here
                if (resources.isActiveTargetBackBuffer || !resources.cameraDepthTexture.IsValid())
                {
                    return;
                }
                TextureHandle color = resources.activeColorTexture;
                description = graph.GetTextureDesc(color);
                description.msaaSamples = MSAASamples.None;
                description.filterMode = FilterMode.Bilinear;
                description.wrapMode = TextureWrapMode.Clamp;
                SetValues(frameData.Get<UniversalCameraData>().camera);

                textures.Clear();
                textures["color"] = color;
                textures["depth"] = resources.cameraDepthTexture;
                // the last pass writes into the camera's own texture, which only the pass of the CoC map reads
                textures["result"] = color;
                BokehMethod method = volume.method.value;
                if (view != View.Result)
                {
                    Draw(graph, SignedMap);
                    Draw(graph, Shown);
                }
                else if (method == BokehMethod.Paper)
                {
                    Draw(graph, Metres);
                    textures["depth"] = textures["metres"];
                    values.depthKind = 0.0f;
                    Draw(graph, PaperMap);
                    Draw(graph, BokehFrames.Paper);
                }
                else
                {
                    Draw(graph, SignedMap);
                    Draw(graph, method == BokehMethod.Exact ? BokehFrames.Exact : BokehFrames.Layered);
                }
            }

            void SetValues(Camera camera)
            {
                // fieldOfView is vertical, as docs/lens.md needs it
                float fovy = Mathf.Deg2Rad * camera.fieldOfView;
                values.sensorHeight = 0.001f * volume.sensorHeight.value;
                values.focalLength = values.sensorHeight / (2.0f * Mathf.Tan(0.5f * fovy));
                values.focusDistance = volume.focusDistance.value;
                values.squeeze = volume.squeeze.value;
                values.sides = (int)volume.aperture.value;
                float fStop = volume.fStop.value;
                if (volume.physicalCamera.value && camera.usePhysicalProperties)
                {
                    // use the camera's own focal length, and scale the sensor with it: this keeps the field of view,
                    // whatever the gate fit is
                    float size = 0.001f * camera.focalLength / values.focalLength;
                    values.sensorHeight *= size;
                    values.focalLength *= size;
                    fStop = camera.aperture;
                    values.focusDistance = camera.focusDistance;
                    // the camera has 3 to 11 blades; the polygon has an even number of sides, 4 to 10
                    values.sides = Mathf.Clamp((camera.bladeCount + 1) / 2 * 2, 4, 10);
                    values.squeeze *= (4.0f - camera.anamorphism) / (4.0f + camera.anamorphism);
                }
                values.apertureDiameter = volume.strength.value * volume.bokehScale.value * values.focalLength / fStop;
                if (camera.TryGetComponent(out BokehFocus focus))
                {
                    values.focusDistance = focus.distance;
                }
                values.maxCoC = volume.maxCoC.value;
                values.nearScale = volume.nearScale.value;
                values.farScale = volume.farScale.value;
                values.nearMaxCoC = volume.nearMaxCoC.value;
                values.farMaxCoC = volume.farMaxCoC.value;
                values.rotation = volume.rotation.value;
                values.debugMode = (int)view - (int)View.Colour;
                values.width = description.width;
                values.height = description.height;
                // BokehDepthKind: 1 is perspective depth, 0 at the near plane and 1 at the far plane; 2 is the same
                // reversed; 5 and 6 are orthographic depth, normal and reversed
                values.depthKind = (camera.orthographic ? 5.0f : 1.0f) + (SystemInfo.usesReversedZBuffer ? 1.0f : 0.0f);
                values.near = camera.nearClipPlane;
                values.far = camera.farClipPlane;
            }

            void Draw(RenderGraph graph, Dictionary<int, BokehStep[]> frames)
            {
                if (!frames.TryGetValue(values.sides, out BokehStep[] steps))
                {
                    steps = frames[(int)BokehAperture.Hexagon];
                }
                foreach (BokehStep step in steps)
                {
                    Draw(graph, step);
                }
            }

            void Draw(RenderGraph graph, BokehStep step)
            {
                using (IRasterRenderGraphBuilder builder = graph.AddRasterRenderPass(step.name, out PassData data))
                {
                    data.step = step;
                    data.values = values;
                    data.depth = textures["depth"];
                    builder.UseTexture(data.depth);
                    for (int slot = 0; slot < data.reads.Length; slot++)
                    {
                        string name = slot < step.reads.Length ? step.reads[slot] : "-";
                        if (textures.TryGetValue(name, out data.reads[slot]))
                        {
                            builder.UseTexture(data.reads[slot]);
                        }
                    }
                    for (int index = 0; index < step.writes.Length; index++)
                    {
                        // in the tables, the layers have half the image's size; with the preset MOBILE, they have a
                        // quarter
                        int scale = step.scale == 2 && values.material.IsKeywordEnabled("BOKEH_PRESET_MOBILE") ? 4 : step.scale;
                        // every pass writes all pixels; without WriteAll, the graph would clear a new target first
                        builder.SetRenderAttachment(Target(graph, step.writes[index], scale), index,
                            step.writes[index] == "result" ? AccessFlags.Write : AccessFlags.WriteAll);
                    }
                    builder.SetRenderFunc((PassData given, RasterGraphContext context) => Execute(given, context));
                }
            }

            TextureHandle Target(RenderGraph graph, string name, int scale)
            {
                if (name != "result")
                {
                    TextureDesc wanted = description;
                    wanted.name = name;
                    wanted.width = (wanted.width + scale - 1) / scale;
                    wanted.height = (wanted.height + scale - 1) / scale;
                    wanted.colorFormat = name == "metres" ? GraphicsFormat.R32_SFloat : GraphicsFormat.R16G16B16A16_SFloat;
                    textures[name] = graph.CreateTexture(wanted);
                }
                return textures[name];
            }

            static void Execute(PassData data, RasterGraphContext context)
            {
                Values values = data.values;
                BokehStep step = data.step;
                Properties.Clear();
                Properties.SetTexture(BokehFrames.DepthSlot, data.depth);
                for (int slot = 0; slot < data.reads.Length; slot++)
                {
                    if (data.reads[slot].IsValid())
                    {
                        Properties.SetTexture(BokehFrames.Slots[slot], data.reads[slot]);
                    }
                }
                Properties.SetFloat(BokehFrames.ApertureDiameter, values.apertureDiameter);
                Properties.SetFloat(BokehFrames.FocalLength, values.focalLength);
                Properties.SetFloat(BokehFrames.FocusDistance, values.focusDistance);
                Properties.SetFloat(BokehFrames.SensorHeight, values.sensorHeight);
                Properties.SetFloat(BokehFrames.MaxCoC, values.maxCoC);
                Properties.SetFloat(BokehFrames.NearScale, values.nearScale);
                Properties.SetFloat(BokehFrames.FarScale, values.farScale);
                Properties.SetFloat(BokehFrames.NearMaxCoC, values.nearMaxCoC);
                Properties.SetFloat(BokehFrames.FarMaxCoC, values.farMaxCoC);
                Properties.SetFloat(BokehFrames.Squeeze, values.squeeze);
                Properties.SetFloat(BokehFrames.DebugMode, values.debugMode);
                Properties.SetFloat(BokehFrames.ImageWidth, values.width);
                Properties.SetFloat(BokehFrames.ImageHeight, values.height);
                Properties.SetFloat(BokehFrames.AspectRatio, values.width / values.height);
                Properties.SetFloat(BokehFrames.DepthKind, values.depthKind);
                Properties.SetFloat(BokehFrames.Near, values.near);
                Properties.SetFloat(BokehFrames.Far, values.far);
                Properties.SetFloat(BokehFrames.Sides, step.Sides);
                // v grows upwards in Unity, so the shaders' angle is counter-clockwise, and the rotation is subtracted
                Properties.SetFloat(BokehFrames.Angle, Mathf.Deg2Rad * (step.Angle - values.rotation));
                context.cmd.DrawProcedural(Matrix4x4.identity, values.material, (int)step.pass, MeshTopology.Triangles, 3, 1,
                    Properties);
            }
        }
    }
}
