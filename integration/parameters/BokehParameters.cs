// SPDX-License-Identifier: MIT
// The parameter block of bokeh_passes.*, 160 bytes: docs/parameters.md has the units.
[System.Runtime.InteropServices.StructLayout(System.Runtime.InteropServices.LayoutKind.Sequential, Size = 160)]
public struct BokehParameters
{
    public float ApertureDiameter, FocalLength, FocusDistance, SensorHeight;
    public float MaxCoC, ConstantCoC, AspectRatio, Angle;
    public float AngleB, BleedingBias, BleedingMult, BlurCoC;
    public float UseMax, DebugMode, LineLength, LineCenterX;
    public float LineCenterY, Squeeze, Spacing, ImageWidth;
    public float ImageHeight, Jitter, Frame, Sides;
    public float Edge, DepthKind, Near, Far;
    public float ViewportX, ViewportY, TextureWidth, TextureHeight;
    public float PassIndex, Axis, Layer, CatsEye;
    public float Roundness, Lateral, AxialRed, AxialBlue;
}
