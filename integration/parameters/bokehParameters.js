// SPDX-License-Identifier: MIT
// The parameter block of bokeh_passes.*, 160 bytes: docs/parameters.md has the units.
const BOKEH_PARAMETERS = [
    "ApertureDiameter", "FocalLength", "FocusDistance", "SensorHeight", "MaxCoC", "ConstantCoC",
    "AspectRatio", "Angle", "AngleB", "BleedingBias", "BleedingMult", "BlurCoC", "UseMax",
    "DebugMode", "LineLength", "LineCenterX", "LineCenterY", "Squeeze", "Spacing", "ImageWidth",
    "ImageHeight", "Jitter", "Frame", "Sides", "Edge", "DepthKind", "Near", "Far", "ViewportX",
    "ViewportY", "TextureWidth", "TextureHeight", "PassIndex", "Axis", "Layer", "CatsEye",
    "Roundness", "Lateral", "AxialRed", "AxialBlue",
];

// From an object such as { ApertureDiameter: 0.025, FocalLength: 0.05 }
export function bokehParameters(values) {
    const block = new Float32Array(40);
    for (const [name, value] of Object.entries(values)) {
        const i = BOKEH_PARAMETERS.indexOf(name);
        if (i < 0) throw new Error(`no parameter ${name}`);
        block[i] = value;
    }
    return block;
}
