// SPDX-License-Identifier: MIT
@group(0) @binding(0) var result: texture_2d<f32>;

@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f
{
    // a triangle that covers the target
    return vec4f(f32(index % 2u) * 4.0 - 1.0, f32(index / 2u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f
{
    return vec4f(textureLoad(result, vec2u(position.xy), 0).rgb, 1.0);
}
