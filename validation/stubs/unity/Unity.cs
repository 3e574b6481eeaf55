// Stand-ins for the classes of Unity 6 (6000.0) and URP 17 that integration/unity uses: signatures after the public
// API, bodies that do nothing. Parameters that Unity takes by `in` are by value here, since mcs does not know `in`; that
// makes no difference to a caller.

using System;
using UnityEngine.Experimental.Rendering;
using UnityEngine.Rendering.RenderGraphModule;

namespace UnityEngine
{
    public class Object
    {
        public string name { get; set; }
        public static implicit operator bool(Object exists) { return exists != null; }
        public static bool operator ==(Object x, Object y) { return ReferenceEquals(x, y); }
        public static bool operator !=(Object x, Object y) { return !ReferenceEquals(x, y); }
        public override bool Equals(object other) { return ReferenceEquals(this, other); }
        public override int GetHashCode() { return 0; }
    }

    public class ScriptableObject : Object { }

    public class Component : Object
    {
        public Transform transform { get { return null; } }
        public T GetComponent<T>() { return default(T); }
        public bool TryGetComponent<T>(out T component) { component = default(T); return false; }
    }

    public class Behaviour : Component { }

    public class MonoBehaviour : Behaviour { }

    public class Transform : Component
    {
        public Vector3 position { get; set; }
        public Vector3 localScale { get; set; }
        public Vector3 forward { get; set; }
        public Vector3 right { get; set; }
        public Vector3 up { get; set; }
    }

    public enum PrimitiveType { Sphere }

    public sealed class GameObject : Object
    {
        public static GameObject CreatePrimitive(PrimitiveType type) { return null; }
        public Transform transform { get { return null; } }
        public T GetComponent<T>() { return default(T); }
    }

    public class Renderer : Component
    {
        public Material material { get; set; }
    }

    public struct Color
    {
        public static Color HSVToRGB(float H, float S, float V) { return default(Color); }
        public static Color operator *(float b, Color a) { return a; }
    }

    public enum CameraType { Game = 1, SceneView = 2, Preview = 4, VR = 8, Reflection = 16 }

    public sealed class Camera : Behaviour
    {
        public float fieldOfView { get; set; }
        public float nearClipPlane { get; set; }
        public float farClipPlane { get; set; }
        public bool orthographic { get; set; }
        public bool usePhysicalProperties { get; set; }
        public float focalLength { get; set; }
        public float aperture { get; set; }
        public float focusDistance { get; set; }
        public int bladeCount { get; set; }
        public float anamorphism { get; set; }
        public Ray ScreenPointToRay(Vector3 pos) { return default(Ray); }
        public Ray ViewportPointToRay(Vector3 pos) { return default(Ray); }
    }

    public struct Ray { }

    public struct RaycastHit
    {
        public Vector3 point { get; set; }
    }

    public static class Physics
    {
        public static bool Raycast(Ray ray, out RaycastHit hitInfo) { hitInfo = default(RaycastHit); return false; }
    }

    public struct Vector2
    {
        public float x, y;
        public static implicit operator Vector3(Vector2 v) { return default(Vector3); }
    }

    public struct Vector3
    {
        public float x, y, z;
        public static Vector3 one { get { return default(Vector3); } }
        public static Vector3 operator +(Vector3 a, Vector3 b) { return a; }
        public static Vector3 operator -(Vector3 a, Vector3 b) { return a; }
        public static Vector3 operator *(float d, Vector3 a) { return a; }
        public static float Dot(Vector3 lhs, Vector3 rhs) { return 0; }
    }

    public struct Matrix4x4
    {
        public static Matrix4x4 identity { get { return default(Matrix4x4); } }
    }

    public class Time
    {
        public static float deltaTime { get { return 0.0f; } }
        public static float time { get { return 0.0f; } }
    }

    public struct Mathf
    {
        public const float Deg2Rad = 0.0174532924f;
        public static float Tan(float f) { return 0.0f; }
        public static float Exp(float power) { return 0.0f; }
        public static float Min(float a, float b) { return 0.0f; }
        public static int Clamp(int value, int min, int max) { return 0; }
        public static float Lerp(float a, float b, float t) { return 0.0f; }
        public static float PingPong(float t, float length) { return 0.0f; }
    }

    public static class SystemInfo
    {
        public static bool usesReversedZBuffer { get { return true; } }
    }

    public class Texture : Object { }

    public class RenderTexture : Texture { }

    public sealed class Shader : Object
    {
        public static int PropertyToID(string name) { return 0; }
    }

    public class Material : Object
    {
        public void EnableKeyword(string keyword) { }
        public bool IsKeywordEnabled(string keyword) { return false; }
        public void SetColor(string name, Color value) { }
    }

    public sealed class MaterialPropertyBlock
    {
        public void Clear() { }
        public void SetFloat(int nameID, float value) { }
        public void SetTexture(int nameID, Texture value) { }
        public void SetTexture(int nameID, RenderTexture value, Rendering.RenderTextureSubElement element) { }
    }

    public enum MeshTopology { Triangles, Quads = 2, Lines, LineStrip, Points }
    public enum FilterMode { Point, Bilinear, Trilinear }
    public enum TextureWrapMode { Repeat, Clamp, Mirror, MirrorOnce }

    [AttributeUsage(AttributeTargets.Class, AllowMultiple = true)]
    public sealed class RequireComponent : Attribute
    {
        public RequireComponent(Type requiredComponent) { }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class SerializeField : Attribute { }

    [AttributeUsage(AttributeTargets.Field, AllowMultiple = true)]
    public class HeaderAttribute : Attribute
    {
        public HeaderAttribute(string header) { }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string tooltip) { }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class RangeAttribute : Attribute
    {
        public RangeAttribute(float min, float max) { }
    }
}

namespace UnityEngine.Experimental.Rendering
{
    public enum GraphicsFormat { None, R16G16B16A16_SFloat = 48, R32_SFloat = 49 }
}

namespace UnityEngine.Rendering
{
    public enum RenderTextureSubElement { Color, Depth, Stencil, Default }
    public enum MSAASamples { None = 1, MSAA2x = 2, MSAA4x = 4, MSAA8x = 8 }

    [AttributeUsage(AttributeTargets.Class)]
    public class VolumeComponentMenu : Attribute
    {
        public VolumeComponentMenu(string menu) { }
    }

    public abstract class VolumeParameter { }

    public class VolumeParameter<T> : VolumeParameter
    {
        public VolumeParameter() { }
        protected VolumeParameter(T value, bool overrideState) { }
        public virtual T value { get; set; }
    }

    public class BoolParameter : VolumeParameter<bool>
    {
        public BoolParameter(bool value, bool overrideState = false) { }
    }

    [Serializable]
    public sealed class EnumParameter<T> : VolumeParameter<T>
    {
        public EnumParameter(T value, bool overrideState = false) : base(value, overrideState) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public class SupportedOnRenderPipelineAttribute : Attribute
    {
        public SupportedOnRenderPipelineAttribute(params Type[] renderPipeline) { }
    }

    public abstract class RenderPipelineAsset : ScriptableObject { }

    public class FloatParameter : VolumeParameter<float>
    {
        public FloatParameter(float value, bool overrideState = false) { }
    }

    public class MinFloatParameter : FloatParameter
    {
        public MinFloatParameter(float value, float min, bool overrideState = false) : base(value) { }
    }

    public class ClampedFloatParameter : FloatParameter
    {
        public ClampedFloatParameter(float value, float min, float max, bool overrideState = false) : base(value) { }
    }

    public class VolumeComponent : ScriptableObject { }

    public interface IPostProcessComponent
    {
        bool IsActive();
    }

    public sealed class VolumeStack
    {
        public T GetComponent<T>() where T : VolumeComponent { return null; }
    }

    public sealed class VolumeManager
    {
        public static VolumeManager instance { get { return null; } }
        public VolumeStack stack { get; set; }
    }

    public class ContextContainer
    {
        public T Get<T>() where T : ContextItem, new() { return null; }
    }

    public abstract class ContextItem { }

    public class RasterCommandBuffer
    {
        public void DrawProcedural(Matrix4x4 matrix, Material material, int shaderPass, MeshTopology topology,
            int vertexCount, int instanceCount, MaterialPropertyBlock properties) { }
    }
}

namespace UnityEngine.Rendering.RenderGraphModule
{
    [Flags]
    public enum AccessFlags { None = 0, Read = 1, Write = 2, Discard = 4, WriteAll = 6, ReadWrite = 3 }

    public struct TextureHandle
    {
        public bool IsValid() { return false; }
        public static implicit operator Texture(TextureHandle texture) { return null; }
        public static implicit operator RenderTexture(TextureHandle texture) { return null; }
    }

    public struct TextureDesc
    {
        public int width;
        public int height;
        public GraphicsFormat colorFormat;
        public FilterMode filterMode;
        public TextureWrapMode wrapMode;
        public MSAASamples msaaSamples;
        public string name;
    }

    public struct RasterGraphContext
    {
        public RasterCommandBuffer cmd;
    }

    public delegate void BaseRenderFunc<PassData, ContextType>(PassData data, ContextType renderGraphContext)
        where PassData : class, new();

    public interface IBaseRenderGraphBuilder : IDisposable
    {
        void UseTexture(TextureHandle input, AccessFlags flags = AccessFlags.Read);
    }

    public interface IRasterRenderGraphBuilder : IBaseRenderGraphBuilder
    {
        void SetRenderAttachment(TextureHandle tex, int index, AccessFlags flags = AccessFlags.Write);
        void SetRenderFunc<PassData>(BaseRenderFunc<PassData, RasterGraphContext> renderFunc)
            where PassData : class, new();
    }

    public class RenderGraph
    {
        public TextureDesc GetTextureDesc(TextureHandle texture) { return default(TextureDesc); }
        public TextureHandle CreateTexture(TextureDesc desc) { return default(TextureHandle); }
        public TextureHandle CreateTexture(TextureHandle texture) { return default(TextureHandle); }
        public IRasterRenderGraphBuilder AddRasterRenderPass<PassData>(string passName, out PassData passData)
            where PassData : class, new()
        {
            passData = null;
            return null;
        }
    }
}

namespace UnityEngine.Rendering.Universal
{
    public enum RenderPassEvent
    {
        AfterRenderingTransparents = 500, BeforeRenderingPostProcessing = 550, AfterRenderingPostProcessing = 600
    }

    [Flags]
    public enum ScriptableRenderPassInput { None = 0, Depth = 1, Normal = 2, Color = 4, Motion = 8 }

    public struct CameraData
    {
        static bool enabled;
        public CameraType cameraType { get { return CameraType.Game; } }
        public ref bool postProcessEnabled => ref enabled;
    }

    public struct RenderingData
    {
        public CameraData cameraData;
    }

    public class UniversalRenderPipelineAsset : RenderPipelineAsset { }

    [AttributeUsage(AttributeTargets.Class, AllowMultiple = false)]
    public sealed class VolumeRequiresRendererFeatures : Attribute
    {
        public VolumeRequiresRendererFeatures(params Type[] featureTypes) { }
    }

    public class UniversalCameraData : ContextItem
    {
        public Camera camera;
    }

    public class UniversalResourceData : ContextItem
    {
        public bool isActiveTargetBackBuffer { get { return false; } }
        public TextureHandle activeColorTexture { get { return default(TextureHandle); } }
        public TextureHandle cameraDepthTexture { get { return default(TextureHandle); } }
    }

    public abstract class ScriptableRenderer
    {
        public void EnqueuePass(ScriptableRenderPass pass) { }
    }

    public abstract class ScriptableRenderPass
    {
        public RenderPassEvent renderPassEvent { get; set; }
        public bool requiresIntermediateTexture { get; set; }
        public void ConfigureInput(ScriptableRenderPassInput passInput) { }
        public virtual void RecordRenderGraph(RenderGraph renderGraph, ContextContainer frameData) { }
    }

    public abstract class ScriptableRendererFeature : ScriptableObject, IDisposable
    {
        public abstract void Create();
        public abstract void AddRenderPasses(ScriptableRenderer renderer, ref RenderingData renderingData);
        public void Dispose() { }
        protected virtual void Dispose(bool disposing) { }
    }
}

namespace UnityEditor
{
    public sealed class AssetDatabase
    {
        public static T LoadAssetAtPath<T>(string assetPath) where T : UnityEngine.Object { return null; }
    }

    public sealed class EditorUtility
    {
        public static void SetDirty(UnityEngine.Object target) { }
    }
}
