// SPDX-License-Identifier: MIT
// Polygonal bokeh in the Universal Render Pipeline: Unity 6 (6000.0), URP 17, render graph.
// Add it to the renderer asset (Add Renderer Feature, Bokeh Renderer Feature).

using System;
using UnityEngine;
using UnityEngine.Experimental.Rendering;
using UnityEngine.Rendering;
using UnityEngine.Rendering.RenderGraphModule;
using UnityEngine.Rendering.Universal;

public sealed class BokehRendererFeature : ScriptableRendererFeature
{
    public enum Method { Exact, Paper }

    public enum Aperture { Hexagon, Octagon }

    public enum View { Result, Colour, Depth, CircleOfConfusion, NearAndFar }

    [Serializable]
    public sealed class Settings
    {
        public Method method = Method.Exact;
        public Aperture aperture = Aperture.Hexagon;
        public View view = View.Result;

        [Header("Lens, metres")]
        [Tooltip("F Stop, Focus Distance, Max CoC, Rotation and Squeeze are those of the BokehVolume overrides")]
        public bool lensFromVolumes;
        [Tooltip("The focal length is that of the camera's field of view. Smaller than any real lens: more blur")]
        public float fStop = 0.2f;
        [Tooltip("Along the view axis. A BokehFocus on the camera overrides it.")]
        public float focusDistance = 5.0f;
        public float sensorHeight = 0.024f;

        [Header("Bokeh")]
        [Range(0.0f, 1.0f), Tooltip("Fraction of the image height")]
        public float maxCoC = 0.1f;
        [Range(0.0f, 360.0f)]
        public float rotation;
        [Range(0.25f, 1.0f), Tooltip("Width over height: 0.5 is anamorphic")]
        public float squeeze = 1.0f;

        public Settings Copy()
        {
            return (Settings)MemberwiseClone();
        }
    }

    // in the order of the shader's passes
    enum ShaderPass
    {
        Depth, SignedCoCMap, CoCMap, HexagonFirst, HexagonSecond, OctagonFirst, OctagonSecond, Line, LineFinal, Debug
    }

    [SerializeField] Shader shader;
    [SerializeField] Settings settings = new Settings();

    Material material;
    BokehPass pass;
    // the settings with the volumes' lens; made anew with the pass
    Settings blended;

    public override void Create()
    {
        if (shader == null)
        {
            shader = Shader.Find("Hidden/BokehDepthOfField");
        }
        // Unity calls this again whenever a setting changes
        CoreUtils.Destroy(material);
        if (shader != null)
        {
            material = CoreUtils.CreateEngineMaterial(shader);
        }
        pass = new BokehPass { renderPassEvent = RenderPassEvent.BeforeRenderingPostProcessing };
        blended = settings.Copy();
    }

    public override void AddRenderPasses(ScriptableRenderer renderer, ref RenderingData renderingData)
    {
        CameraType type = renderingData.cameraData.cameraType;
        if (material == null || type == CameraType.Preview || type == CameraType.Reflection)
        {
            return;
        }
        Settings used = settings;
        if (settings.lensFromVolumes)
        {
            // URP has blended the volumes for this camera before it asks for passes
            BokehVolume volume = VolumeManager.instance.stack?.GetComponent<BokehVolume>();
            if (volume == null || !volume.IsActive())
            {
                return;
            }
            used = blended;
            volume.CopyTo(used);
        }
        pass.Setup(material, used);
        renderer.EnqueuePass(pass);
    }

    protected override void Dispose(bool disposing)
    {
        CoreUtils.Destroy(material);
    }

    // What differs between the passes. degrees: of the line, before the rotation
    struct Inputs
    {
        public TextureHandle source;
        public TextureHandle depth;
        public TextureHandle second;
        public TextureHandle third;
        public float degrees;
    }

    // What the render function of a pass is given
    sealed class PassData
    {
        public Material material;
        public ShaderPass pass;
        public Settings settings;
        public Inputs inputs;
        public float focalLength;
        public float focusDistance;
        public float width;
        public float height;
    }

    sealed class BokehPass : ScriptableRenderPass
    {
        static readonly MaterialPropertyBlock Properties = new MaterialPropertyBlock();
        static readonly int BlitTexture = Shader.PropertyToID("_BlitTexture");
        static readonly int BlitScaleBias = Shader.PropertyToID("_BlitScaleBias");
        static readonly int Depth = Shader.PropertyToID("_BokehDepth");
        static readonly int ColorB = Shader.PropertyToID("_BokehColorB");
        static readonly int ColorC = Shader.PropertyToID("_BokehColorC");
        static readonly int ApertureDiameter = Shader.PropertyToID("_BokehApertureDiameter");
        static readonly int FocalLength = Shader.PropertyToID("_BokehFocalLength");
        static readonly int FocusDistance = Shader.PropertyToID("_BokehFocusDistance");
        static readonly int SensorHeight = Shader.PropertyToID("_BokehSensorHeight");
        static readonly int MaxCoC = Shader.PropertyToID("_BokehMaxCoC");
        static readonly int ImageSize = Shader.PropertyToID("_BokehImageSize");
        static readonly int Squeeze = Shader.PropertyToID("_BokehSqueeze");
        static readonly int Angle = Shader.PropertyToID("_BokehAngle");
        static readonly int DebugMode = Shader.PropertyToID("_BokehDebugMode");

        Material material;
        Settings settings;
        float focalLength;
        float focusDistance;
        TextureDesc description;

        public void Setup(Material newMaterial, Settings newSettings)
        {
            material = newMaterial;
            settings = newSettings;
            // the depth texture, and a colour target that a shader can read
            ConfigureInput(ScriptableRenderPassInput.Depth);
            requiresIntermediateTexture = true;
        }

        public override void RecordRenderGraph(RenderGraph graph, ContextContainer frameData)
        {
            UniversalResourceData resources = frameData.Get<UniversalResourceData>();
            Camera camera = frameData.Get<UniversalCameraData>().camera;
            // the field of view is the vertical one: docs/lens.md
            float fovy = Mathf.Deg2Rad * camera.fieldOfView;
            focalLength = settings.sensorHeight / (2.0f * Mathf.Tan(0.5f * fovy));
            focusDistance = settings.focusDistance;
            if (camera.TryGetComponent(out BokehFocus focus))
            {
                focusDistance = focus.distance;
            }

            TextureHandle color = resources.activeColorTexture;
            description = graph.GetTextureDesc(color);
            description.clearBuffer = false;
            description.msaaSamples = MSAASamples.None;
            description.filterMode = FilterMode.Bilinear;
            description.wrapMode = TextureWrapMode.Clamp;

            TextureHandle depth = resources.cameraDepthTexture;
            // the exact passes read a signed CoC, the paper's unsigned and depth in metres
            bool exact = settings.method == Method.Exact || settings.view != View.Result;
            if (!exact)
            {
                TextureHandle metres = Target(graph, "_BokehMetres", GraphicsFormat.R32_SFloat);
                Draw(graph, ShaderPass.Depth, new Inputs { source = color, depth = depth }, metres);
                depth = metres;
            }
            TextureHandle coc = Target(graph, "_BokehCoC");
            Draw(graph, exact ? ShaderPass.SignedCoCMap : ShaderPass.CoCMap,
                new Inputs { source = color, depth = depth }, coc);

            // the last pass writes into the camera's own texture, which was read above and not since
            if (settings.view != View.Result)
            {
                Draw(graph, ShaderPass.Debug, new Inputs { source = coc, depth = depth }, color);
            }
            else if (exact)
            {
                Exact(graph, coc, color);
            }
            else
            {
                Paper(graph, coc, depth, color);
            }
        }

        // Two passes; the first writes two targets for the hexagon, three for the octagon
        void Exact(RenderGraph graph, TextureHandle coc, TextureHandle result)
        {
            TextureHandle target2 = Target(graph, "_BokehTarget2");
            TextureHandle target3 = Target(graph, "_BokehTarget3");
            Inputs first = new Inputs { source = coc };
            Inputs second = new Inputs { source = target2, second = target3 };
            if (settings.aperture == Aperture.Hexagon)
            {
                Draw(graph, ShaderPass.HexagonFirst, first, target2, target3);
                Draw(graph, ShaderPass.HexagonSecond, second, result);
            }
            else
            {
                TextureHandle target4 = Target(graph, "_BokehTarget4");
                second.third = target4;
                Draw(graph, ShaderPass.OctagonFirst, first, target2, target3, target4);
                Draw(graph, ShaderPass.OctagonSecond, second, result);
            }
        }

        // One line a pass: two parallelograms, the second combined with the first by min
        void Paper(RenderGraph graph, TextureHandle coc, TextureHandle depth, TextureHandle result)
        {
            bool hexagon = settings.aperture == Aperture.Hexagon;
            TextureHandle line = Target(graph, "_BokehLine");
            TextureHandle finished = Target(graph, "_BokehFinished");
            Draw(graph, ShaderPass.Line,
                new Inputs { source = coc, depth = depth, degrees = hexagon ? 90.0f : 0.0f }, line);
            Draw(graph, ShaderPass.Line,
                new Inputs { source = line, depth = depth, degrees = hexagon ? 30.0f : 90.0f }, finished);
            if (!hexagon)
            {
                // the hexagon's two parallelograms share their first line, the octagon's do not
                line = Target(graph, "_BokehLineB");
                Draw(graph, ShaderPass.Line, new Inputs { source = coc, depth = depth, degrees = 45.0f }, line);
            }
            Draw(graph, ShaderPass.LineFinal,
                new Inputs { source = line, depth = depth, second = finished, degrees = hexagon ? 150.0f : 135.0f },
                result);
        }

        TextureHandle Target(RenderGraph graph, string name,
            GraphicsFormat format = GraphicsFormat.R16G16B16A16_SFloat)
        {
            TextureDesc wanted = description;
            wanted.name = name;
            wanted.colorFormat = format;
            return graph.CreateTexture(wanted);
        }

        // One full-screen pass into one or several targets
        void Draw(RenderGraph graph, ShaderPass shaderPass, Inputs inputs, params TextureHandle[] targets)
        {
            using (var builder = graph.AddRasterRenderPass<PassData>("Bokeh " + shaderPass, out PassData data))
            {
                data.material = material;
                data.pass = shaderPass;
                data.settings = settings;
                data.inputs = inputs;
                data.focalLength = focalLength;
                data.focusDistance = focusDistance;
                data.width = description.width;
                data.height = description.height;
                Read(builder, inputs.source);
                Read(builder, inputs.depth);
                Read(builder, inputs.second);
                Read(builder, inputs.third);
                for (int index = 0; index < targets.Length; index++)
                {
                    builder.SetRenderAttachment(targets[index], index);
                }
                builder.SetRenderFunc((PassData given, RasterGraphContext context) => Execute(given, context));
            }
        }

        static void Read(IRasterRenderGraphBuilder builder, TextureHandle texture)
        {
            if (texture.IsValid())
            {
                builder.UseTexture(texture);
            }
        }

        static void Execute(PassData data, RasterGraphContext context)
        {
            Settings settings = data.settings;
            Properties.Clear();
            Properties.SetTexture(BlitTexture, data.inputs.source);
            Properties.SetVector(BlitScaleBias, new Vector4(1.0f, 1.0f, 0.0f, 0.0f));
            SetTexture(Depth, data.inputs.depth);
            SetTexture(ColorB, data.inputs.second);
            SetTexture(ColorC, data.inputs.third);
            Properties.SetFloat(ApertureDiameter, data.focalLength / settings.fStop);
            Properties.SetFloat(FocalLength, data.focalLength);
            Properties.SetFloat(FocusDistance, data.focusDistance);
            Properties.SetFloat(SensorHeight, settings.sensorHeight);
            Properties.SetFloat(MaxCoC, settings.maxCoC);
            Properties.SetVector(ImageSize, new Vector4(data.width, data.height, 0.0f, 0.0f));
            Properties.SetFloat(Squeeze, settings.squeeze);
            Properties.SetFloat(Angle, Mathf.Deg2Rad * (data.inputs.degrees + settings.rotation));
            Properties.SetFloat(DebugMode, (int)settings.view - (int)View.Colour);
            context.cmd.DrawProcedural(Matrix4x4.identity, data.material, (int)data.pass, MeshTopology.Triangles, 3, 1,
                Properties);
        }

        static void SetTexture(int name, TextureHandle texture)
        {
            if (texture.IsValid())
            {
                Properties.SetTexture(name, texture);
            }
        }
    }
}
