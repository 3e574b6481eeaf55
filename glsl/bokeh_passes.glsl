// SPDX-License-Identifier: MIT
//
// Ready-made passes on bokeh.glsl, GLSL. Version 0.1.0.
// A program is: your #version line, one BOKEH_PASS define, bokeh.glsl, this file.
//
//   #define BOKEH_PASS ...       reads                                  writes
//   BOKEH_COC_MAP                ColorSamp, DepthSamp                   colour, CoC in alpha
//   BOKEH_CONSTANT_COC           ColorSamp                              colour, the same CoC everywhere
//   BOKEH_DEPTH_OF_FIELD         ColorSamp, DepthSamp                   one line of the filter
//   BOKEH_DEPTH_OF_FIELD_FINAL   ColorSamp, DepthSamp, ColorSampB       the same, min or max with ColorSampB
//   BOKEH_NAIVE_GATHER           ColorSamp, DepthSamp, KernelSamp       a table of BOKEH_NUM_SAMPLES offsets
//   BOKEH_NAIVE_GRID             ColorSamp, DepthSamp                   BOKEH_NUM_SAMPLES x BOKEH_NUM_SAMPLES grid
//   BOKEH_DEBUG                  ColorSamp (with CoC), DepthSamp        debug view
//   BOKEH_FULL_SCREEN            -                                      (vertex shader) one triangle over the target
//
//   Parameters: single uniforms in OpenGL; under Vulkan one uniform block in the order below (docs/inputs.md has the
//   table with units and offsets). Set 0: the block at binding 0, the four textures in their order at 1 to 4.

#define BOKEH_COC_MAP 1
#define BOKEH_CONSTANT_COC 2
#define BOKEH_DEPTH_OF_FIELD 3
#define BOKEH_DEPTH_OF_FIELD_FINAL 4
#define BOKEH_NAIVE_GATHER 5
#define BOKEH_NAIVE_GRID 6
#define BOKEH_DEBUG 7
#define BOKEH_FULL_SCREEN 8

#ifndef BOKEH_PASS
#error define BOKEH_PASS before this file, for example as BOKEH_DEPTH_OF_FIELD
#elif BOKEH_PASS < BOKEH_COC_MAP || BOKEH_PASS > BOKEH_FULL_SCREEN
#error BOKEH_PASS is none of the names in the table at the top of this file
#endif

#if BOKEH_PASS == BOKEH_FULL_SCREEN

// ---------------------------------------------------------------------------------------------------------------------
// vertex shader
// ---------------------------------------------------------------------------------------------------------------------

#ifdef VULKAN
#define BOKEH_VERTEX_ID gl_VertexIndex
layout(location = 0) out vec2 BokehUV;
#else
#define BOKEH_VERTEX_ID gl_VertexID
out vec2 BokehUV;
#endif

// Three vertices without a buffer. Clip y = -1 is the first row in memory, in OpenGL and in Vulkan: v runs with y.
void main()
{
    BokehUV = vec2(BOKEH_VERTEX_ID == 1 ? 2.0 : 0.0, BOKEH_VERTEX_ID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(BokehUV * 2.0 - 1.0, 0.0, 1.0);
}

#else

// ---------------------------------------------------------------------------------------------------------------------
// bindings
// ---------------------------------------------------------------------------------------------------------------------

#ifdef VULKAN

layout(set = 0, binding = 1) uniform sampler2D BokehColorSamp;
layout(set = 0, binding = 2) uniform sampler2D BokehDepthSamp;
layout(set = 0, binding = 3) uniform sampler2D BokehColorSampB;
layout(set = 0, binding = 4) uniform sampler2D BokehKernelSamp;
layout(location = 0) in vec2 BokehUV;
layout(location = 0) out vec4 BokehResult;

#define BOKEH_PARAMETER(type, name) type name;

layout(set = 0, binding = 0, std140) uniform BokehParameters
{

#else

uniform sampler2D BokehColorSamp;
uniform sampler2D BokehDepthSamp;
uniform sampler2D BokehColorSampB;
uniform sampler2D BokehKernelSamp;
in vec2 BokehUV;
out vec4 BokehResult;

#define BOKEH_PARAMETER(type, name) uniform type name;

#endif

BOKEH_PARAMETER(float, BokehApertureDiameter)
BOKEH_PARAMETER(float, BokehFocalLength)
BOKEH_PARAMETER(float, BokehFocusDistance)
BOKEH_PARAMETER(float, BokehSensorHeight)
BOKEH_PARAMETER(float, BokehMaxCoC)
BOKEH_PARAMETER(float, BokehConstantCoC)
BOKEH_PARAMETER(float, BokehAspectRatio)
BOKEH_PARAMETER(float, BokehAngle)
BOKEH_PARAMETER(float, BokehAngleB)
BOKEH_PARAMETER(float, BokehBleedingBias)
BOKEH_PARAMETER(float, BokehBleedingMult)
BOKEH_PARAMETER(float, BokehBlurCoC)
BOKEH_PARAMETER(float, BokehUseMax)
BOKEH_PARAMETER(float, BokehDebugMode)

#ifdef VULKAN
};
#endif

// ---------------------------------------------------------------------------------------------------------------------
// fragment shaders
// ---------------------------------------------------------------------------------------------------------------------

#if BOKEH_PASS == BOKEH_COC_MAP

void main()
{
    BokehResult = BokehCoCMap(BokehColorSamp, BokehDepthSamp, BokehUV, BokehApertureDiameter, BokehFocalLength,
        BokehFocusDistance, BokehSensorHeight, BokehMaxCoC);
}

#elif BOKEH_PASS == BOKEH_CONSTANT_COC

void main()
{
    BokehResult = BokehPackCoC(BokehFetch(BokehColorSamp, BokehUV), clamp(BokehConstantCoC, 0.0, BokehMaxCoC));
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD

void main()
{
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio);
    BokehResult = BokehDepthOfField(BokehColorSamp, BokehDepthSamp, BokehUV, lineEnd, BOKEH_NUM_SAMPLES,
        BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_DEPTH_OF_FIELD_FINAL

void main()
{
    vec2 lineEnd = BokehLineEnd(BokehAngle, BokehAspectRatio);
    BokehResult = BokehDepthOfFieldFinal(BokehColorSamp, BokehDepthSamp, BokehUV, lineEnd, BOKEH_NUM_SAMPLES,
        BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5, BokehColorSampB, BokehUseMax > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GATHER

void main()
{
    BokehResult = BokehNaiveGather(BokehColorSamp, BokehDepthSamp, BokehKernelSamp, BokehUV, BokehAspectRatio,
        BOKEH_NUM_SAMPLES, BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_NAIVE_GRID

void main()
{
    vec2 lineEndU = BokehLineEnd(BokehAngle, BokehAspectRatio);
    vec2 lineEndV = BokehLineEnd(BokehAngleB, BokehAspectRatio);
    BokehResult = BokehNaiveGrid(BokehColorSamp, BokehDepthSamp, BokehUV, lineEndU, lineEndV, BOKEH_NUM_SAMPLES,
        BokehBleedingBias, BokehBleedingMult, BokehBlurCoC > 0.5);
}

#elif BOKEH_PASS == BOKEH_DEBUG

// BokehDebugMode: 0 colour, 1 depth, 2 CoC, 3 near and far field
void main()
{
    vec4 result = BokehFetch(BokehColorSamp, BokehUV);
    float S2 = BokehSafeDepth(BokehFetchNearest(BokehDepthSamp, BokehUV).r);
    if (BokehDebugMode > 2.5)
    {
        result = BokehDebugFocus(S2, BokehFocusDistance, result.a, BokehMaxCoC);
    }
    else if (BokehDebugMode > 1.5)
    {
        result = BokehDebugCoC(result.a, BokehMaxCoC);
    }
    else if (BokehDebugMode > 0.5)
    {
        result = BokehDebugDepth(S2, BokehFocusDistance);
    }
    BokehResult = result;
}

#endif
#endif
