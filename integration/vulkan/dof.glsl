#version 450
// SPDX-License-Identifier: MIT
// The passes of the library, without changes. The compiler's command line defines BOKEH_PASS.
#extension GL_GOOGLE_include_directive : require
// a specialization constant, which each pipeline sets to its number of sides
layout(constant_id = 0) const int BokehKnownSides = 0;
#define BOKEH_SIDES BokehKnownSides
#include "../../glsl/bokeh.glsl"
#include "../../glsl/bokeh_layers.glsl"
#include "../../glsl/bokeh_passes.glsl"
