// SPDX-License-Identifier: MIT
// The package's passes as they are.
#define BOKEH_HLSL_SM 6
// of each pipeline
[[vk::constant_id(0)]] const int BokehKnownSides = 0;
#define BOKEH_SIDES BokehKnownSides
#include "../../hlsl/bokeh.hlsl"
#include "../../hlsl/bokeh_layers.hlsl"
#include "../../hlsl/bokeh_passes.hlsl"
