// SPDX-License-Identifier: MIT
// The passes of the library, without changes.
#define BOKEH_HLSL_SM 6
// a specialization constant, which each pipeline sets to its number of sides
[[vk::constant_id(0)]] const int BokehKnownSides = 0;
#define BOKEH_SIDES BokehKnownSides
#include "../../hlsl/bokeh.hlsl"
#include "../../hlsl/bokeh_layers.hlsl"
#include "../../hlsl/bokeh_passes.hlsl"
