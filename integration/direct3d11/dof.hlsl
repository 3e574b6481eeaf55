// SPDX-License-Identifier: MIT
//
// The passes of the library, without changes, for shader model 5.

#define BOKEH_HLSL_SM 5
#define BOKEH_SIDES 6
#include "../../hlsl/bokeh.hlsl"
#include "../../hlsl/bokeh_paper.hlsl"
#include "../../hlsl/bokeh_layers.hlsl"
#include "../../hlsl/bokeh_passes.hlsl"
