/* SPDX-License-Identifier: MIT */
/* The parameter block of bokeh_passes.*, 160 bytes: docs/parameters.md has the units. */
#pragma once

struct BokehParameters
{
    float ApertureDiameter, FocalLength, FocusDistance, SensorHeight;
    float MaxCoC, ConstantCoC, AspectRatio, Angle;
    float AngleB, BleedingBias, BleedingMult, BlurCoC;
    float UseMax, DebugMode, LineLength, LineCenterX;
    float LineCenterY, Squeeze, Spacing, ImageWidth;
    float ImageHeight, Jitter, Frame, Sides;
    float Edge, DepthKind, Near, Far;
    float ViewportX, ViewportY, TextureWidth, TextureHeight;
    float PassIndex, Axis, Layer, CatsEye;
    float Roundness, Lateral, AxialRed, AxialBlue;
};
