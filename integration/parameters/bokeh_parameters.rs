// SPDX-License-Identifier: MIT
// The parameter block of bokeh_passes.*, 160 bytes: docs/parameters.md has the units.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct BokehParameters {
    pub aperture_diameter: f32, pub focal_length: f32, pub focus_distance: f32, pub sensor_height: f32,
    pub max_coc: f32, pub constant_coc: f32, pub aspect_ratio: f32, pub angle: f32,
    pub angle_b: f32, pub bleeding_bias: f32, pub bleeding_mult: f32, pub blur_coc: f32,
    pub use_max: f32, pub debug_mode: f32, pub line_length: f32, pub line_center_x: f32,
    pub line_center_y: f32, pub squeeze: f32, pub spacing: f32, pub image_width: f32,
    pub image_height: f32, pub jitter: f32, pub frame: f32, pub sides: f32,
    pub edge: f32, pub depth_kind: f32, pub near: f32, pub far: f32,
    pub viewport_x: f32, pub viewport_y: f32, pub texture_width: f32, pub texture_height: f32,
    pub pass_index: f32, pub axis: f32, pub layer: f32, pub cats_eye: f32,
    pub roundness: f32, pub lateral: f32, pub axial_red: f32, pub axial_blue: f32,
}
