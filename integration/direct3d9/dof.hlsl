// SPDX-License-Identifier: MIT
//
// The passes of the library, without changes, for shader model 3.

#define BOKEH_HLSL_SM 3
#include "../../hlsl/bokeh.hlsl"
#include "../../hlsl/bokeh_paper.hlsl"
#include "../../hlsl/bokeh_layers.hlsl"
#include "../../hlsl/bokeh_passes.hlsl"
