#version 450
// SPDX-License-Identifier: MIT
// The package's passes as they are; BOKEH_PASS comes from the command line.
#extension GL_GOOGLE_include_directive : require
// of each pipeline
layout(constant_id = 0) const int BokehKnownSides = 0;
#define BOKEH_SIDES BokehKnownSides
#include "../../glsl/bokeh.glsl"
#include "../../glsl/bokeh_layers.glsl"
#include "../../glsl/bokeh_passes.glsl"
