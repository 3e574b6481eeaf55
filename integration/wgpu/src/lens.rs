// SPDX-License-Identifier: MIT

//! The camera's lens, and the kind of its depth.

use crate::parameters::BokehParameters;

/// The lens of a camera. Every field may change in any frame. Lengths are in metres, or in the unit of your depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Vertical field of view, radians.
    pub fov_y: f32,
    /// The f-stop of the lens. If you halve it, the blur becomes twice as wide.
    pub f_stop: f32,
    /// Multiplies the width of the blur. 1 is the blur of a real lens, which hardly blurs at a game's field of view. 0
    /// turns the effect off.
    pub bokeh_scale: f32,
    /// Distance along the view axis at which objects are sharp.
    pub focus_distance: f32,
    /// Height of the sensor. 0.024 m is the height of a frame of 35 mm film.
    pub sensor_height: f32,
    /// Largest circle of confusion (the diameter of the blur), as a fraction of the image height.
    pub max_coc: f32,
    /// Multiplies the circle of confusion in front of the focus distance.
    pub near_scale: f32,
    /// Multiplies the circle of confusion behind the focus distance.
    pub far_scale: f32,
    /// Largest circle of confusion in front of the focus distance, as a fraction of the image height. [`Lens::max_coc`]
    /// applies too.
    pub near_max_coc: f32,
    /// Largest circle of confusion behind the focus distance, as a fraction of the image height. [`Lens::max_coc`]
    /// applies too.
    pub far_max_coc: f32,
    /// Rotation of the polygon, radians, from +x to +y of the image (clockwise on the screen).
    pub rotation: f32,
    /// Width of the polygon divided by its height. A 2x anamorphic lens has 0.5.
    pub squeeze: f32,
    /// Selects a view that is shown instead of the result.
    pub debug: Option<Debug>,
}

/// A view that is shown instead of the result. The values are those of the shader parameter `BokehDebugMode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Debug {
    /// The colour that the effect reads.
    Color = 0,
    /// Depth: black at the camera, grey at the focus distance, white far away.
    Depth = 1,
    /// The circle of confusion: black in focus, white at [`Lens::max_coc`].
    CircleOfConfusion = 2,
    /// Orange in front of the focus distance, blue behind it, and black where the image is sharp.
    Focus = 3,
}

impl Lens {
    /// Returns a lens with an f-stop of 2.8 and a bokeh scale of 10, on a sensor 0.024 m high.
    ///
    /// * `fov_y`: vertical field of view, radians
    /// * `focus_distance`: distance along the view axis at which objects are sharp
    pub fn new(fov_y: f32, focus_distance: f32) -> Self {
        Self {
            fov_y,
            f_stop: 2.8,
            bokeh_scale: 10.0,
            focus_distance,
            sensor_height: 0.024,
            max_coc: 0.1,
            near_scale: 1.0,
            far_scale: 1.0,
            near_max_coc: 1.0,
            far_max_coc: 1.0,
            rotation: 0.0,
            squeeze: 1.0,
            debug: None,
        }
    }

    /// Returns the focal length, which follows from the field of view and the sensor height.
    pub fn focal_length(&self) -> f32 {
        self.sensor_height / (2.0 * (0.5 * self.fov_y).tan())
    }

    /// Returns the diameter of the aperture, multiplied by the bokeh scale.
    pub fn aperture_diameter(&self) -> f32 {
        self.focal_length() / self.f_stop * self.bokeh_scale
    }

    /// Moves the focus smoothly towards the nearest of several depths. Call this once per frame.
    ///
    /// * `dt`: time since the last frame, seconds; if it is infinite, the focus arrives at once
    /// * `depths`: depths along the view axis
    /// * `tau`: time constant of the movement, seconds
    ///
    /// The function interpolates 1 / distance instead of the distance, because the width of the blur depends on
    /// 1 / distance (docs/lens.md).
    pub fn pull_focus(&mut self, dt: f32, depths: impl IntoIterator<Item = f32>, tau: f32) {
        let nearest = depths.into_iter().fold(f32::INFINITY, f32::min);
        let k = 1.0 - (-dt / tau).exp();
        // if the distance is NaN or not positive, begin at the nearest depth
        let from = if self.focus_distance > 0.0 { self.focus_distance } else { nearest };
        self.focus_distance = 1.0 / ((1.0 - k) / from + k / nearest);
    }

    pub(crate) fn set(&self, parameters: &mut BokehParameters) {
        parameters.aperture_diameter = self.aperture_diameter();
        parameters.focal_length = self.focal_length();
        parameters.focus_distance = self.focus_distance;
        parameters.sensor_height = self.sensor_height;
        parameters.max_coc = self.max_coc;
        parameters.near_scale = self.near_scale;
        parameters.far_scale = self.far_scale;
        parameters.near_max_coc = self.near_max_coc;
        parameters.far_max_coc = self.far_max_coc;
        parameters.angle = self.rotation;
        parameters.squeeze = self.squeeze;
        parameters.debug_mode = self.debug.map_or(0.0, |mode| mode as u32 as f32);
    }
}

/// The kind of depth in the depth texture. `near` and `far` are the distances of the camera's planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Depth {
    /// Metres along the view axis, not along the ray.
    Metres,
    /// 0 at the near plane, 1 at the far plane: the usual depth buffer of wgpu.
    Standard { near: f32, far: f32 },
    /// 1 at the near plane, 0 at the far plane.
    Reversed { near: f32, far: f32 },
    /// 1 at the near plane, 0 at infinity.
    ReversedInfinite { near: f32 },
    /// z / w of OpenGL's clip space: -1 at the near plane, 1 at the far plane.
    OpenGL { near: f32, far: f32 },
    /// Depth of an orthographic camera: 0 at the near plane, 1 at the far plane.
    Orthographic { near: f32, far: f32 },
    /// Depth of an orthographic camera: 1 at the near plane, 0 at the far plane.
    OrthographicReversed { near: f32, far: f32 },
    /// Metres / far: 0 at the camera, 1 at the far plane.
    FractionOfFar { far: f32 },
    /// log(1 + metres) / log(1 + far).
    Logarithmic { far: f32 },
    /// Metres times opacity in red and opacity in green, for example in an `Rg16Float` texture. Each surface is blended
    /// over the surfaces behind it (docs/inputs.md).
    WeightedByOpacity,
}

impl Depth {
    pub(crate) fn set(&self, parameters: &mut BokehParameters) {
        let (kind, near, far) = match *self {
            Self::Metres => (0, 0.0, 0.0),
            Self::Standard { near, far } => (1, near, far),
            Self::Reversed { near, far } => (2, near, far),
            Self::ReversedInfinite { near } => (3, near, 0.0),
            Self::OpenGL { near, far } => (4, near, far),
            Self::Orthographic { near, far } => (5, near, far),
            Self::OrthographicReversed { near, far } => (6, near, far),
            Self::FractionOfFar { far } => (7, 0.0, far),
            Self::Logarithmic { far } => (8, 0.0, far),
            Self::WeightedByOpacity => (9, 0.0, 0.0),
        };
        (parameters.depth_kind, parameters.near, parameters.far) = (kind as f32, near, far);
    }
}
