// A material's parameter X is the uniform m_X here.
#define BokehColorSamp m_Texture
#define BokehDepthSamp m_DepthTexture
#define BokehColorSampB m_TextureB
#define BokehColorSampC m_TextureC
#define BokehColorSampD m_TextureD
#define BokehColorSampE m_TextureE
#define BokehColorSampF m_TextureF
#define BokehApertureDiameter m_ApertureDiameter
#define BokehFocalLength m_FocalLength
#define BokehFocusDistance m_FocusDistance
#define BokehNear m_Near
#define BokehFar m_Far
#define BokehAspectRatio m_AspectRatio
#define BokehImageWidth m_ImageWidth
#define BokehImageHeight m_ImageHeight
#define BokehDepthKind m_DepthKind
#define BokehSensorHeight m_SensorHeight
#define BokehMaxCoC m_MaxCoC
#define BokehSpacing m_Spacing
#define BokehSqueeze m_Squeeze
#define BokehAngle m_Angle
#define BokehSides m_Sides
#define BokehAxis m_Axis
#define BokehLayer m_Layer
#define BokehDebugMode m_DebugMode
#define BokehBleedingBias m_BleedingBias
#define BokehBleedingMult m_BleedingMult
#define BokehBlurCoC m_BlurCoC
#define BokehLineLength m_LineLength

#import "glsl/bokeh.glsl"
#import "glsl/bokeh_layers.glsl"
#import "glsl/bokeh_passes.glsl"
