// SPDX-License-Identifier: MIT

//! What the camera is like.

use crate::parameters::BokehParameters;

/// The lens of a camera. All of it may change in any frame. Lengths are in metres, or in the unit of your depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Vertical field of view, radians.
    pub fov_y: f32,
    /// As on a camera: half of it is twice the blur.
    pub f_stop: f32,
    /// How many times wider the blur is than that lens's. 1 is the real lens, which hardly blurs at a game's field of
    /// view; 0 turns the effect off.
    pub bokeh_scale: f32,
    /// Along the view axis, from the camera to what is sharp.
    pub focus_distance: f32,
    /// 0.024 m is 35 mm film.
    pub sensor_height: f32,
    /// Largest circle of confusion, as a fraction of the image height.
    pub max_coc: f32,
    /// Factor of the circle of confusion in front of the focus distance.
    pub near_scale: f32,
    /// Factor of the circle of confusion behind the focus distance.
    pub far_scale: f32,
    /// Limit in front of the focus distance, as [`Lens::max_coc`], which limits both sides.
    pub near_max_coc: f32,
    /// Limit behind the focus distance.
    pub far_max_coc: f32,
    /// Of the polygon, radians from +x to +y of the image (clockwise on the screen).
    pub rotation: f32,
    /// Width of the polygon over its height: 0.5 is an anamorphic lens of squeeze 2.
    pub squeeze: f32,
    /// Shows something else in place of the result.
    pub debug: Option<Debug>,
}

/// What is shown in place of the result; the values are those of `BokehDebugMode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Debug {
    /// The colour that goes in.
    Color = 0,
    /// Black at the camera, grey at the focus distance, white far away.
    Depth = 1,
    /// Black in focus, white at [`Lens::max_coc`].
    CircleOfConfusion = 2,
    /// Orange before the focus, blue behind it.
    Focus = 3,
}

impl Lens {
    /// An f-stop of 2.8 and a bokeh scale of 10.
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

    /// Of the field of view and the sensor.
    pub fn focal_length(&self) -> f32 {
        self.sensor_height / (2.0 * (0.5 * self.fov_y).tan())
    }

    /// With the bokeh scale in it.
    pub fn aperture_diameter(&self) -> f32 {
        self.focal_length() / self.f_stop * self.bokeh_scale
    }

    /// Autofocus, once a frame of `dt` seconds: towards the nearest of these depths. 1 / distance moves, with the time
    /// constant `tau`; an infinite `dt` is there at once.
    pub fn pull_focus(&mut self, dt: f32, depths: impl IntoIterator<Item = f32>, tau: f32) {
        let nearest = depths.into_iter().fold(f32::INFINITY, f32::min);
        let k = 1.0 - (-dt / tau).exp();
        // recovers from 0 and NaN
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

/// What the depth texture holds; `near` and `far` are the camera's planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Depth {
    /// Along the view axis, not along the ray.
    Metres,
    /// 0 at the near plane, 1 at the far plane: wgpu's depth buffers.
    Standard { near: f32, far: f32 },
    /// 1 at the near plane, 0 at the far plane.
    Reversed { near: f32, far: f32 },
    /// 1 at the near plane, 0 at infinity.
    ReversedInfinite { near: f32 },
    /// z / w of OpenGL's clip space: -1 at the near plane, 1 at the far plane.
    OpenGL { near: f32, far: f32 },
    /// Of an orthographic camera: 0 at the near plane, 1 at the far plane.
    Orthographic { near: f32, far: f32 },
    /// Of an orthographic camera: 1 at the near plane, 0 at the far plane.
    OrthographicReversed { near: f32, far: f32 },
    /// A fraction of the far plane's distance.
    FractionOfFar { far: f32 },
    /// log(1 + metres) / log(1 + far).
    Logarithmic { far: f32 },
    /// Metres times opacity in red, and opacity in green, such as `Rg16Float`: each surface blended over those behind it.
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
