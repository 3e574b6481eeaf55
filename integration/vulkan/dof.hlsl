// SPDX-License-Identifier: MIT
// The package's passes as they are.
#define BOKEH_HLSL_SM 6
#include "../../hlsl/bokeh.hlsl"
#include "../../hlsl/bokeh_layers.hlsl"
#include "../../hlsl/bokeh_passes.hlsl"
