// SPDX-License-Identifier: MIT

//! Depth of field with polygonal bokeh for wgpu.
//!
//! Create a [`Bokeh`] once. Call [`Bokeh::targets`] at the start, and again when the image gets another size. Call
//! [`Bokeh::render`] in each frame:
//!
//! ```no_run
//! use polygonal_bokeh::{Bokeh, Depth, Lens, Method, Polygon, Preset};
//!
//! # fn frame(device: &wgpu::Device, queue: &wgpu::Queue, color: &wgpu::Texture, depth: &wgpu::Texture,
//! #     encoder: &mut wgpu::CommandEncoder) -> Result<(), polygonal_bokeh::Error> {
//! let bokeh = Bokeh::new(device, Method::Layered, Polygon::Hexagon, Preset::Medium);
//! let targets = bokeh.targets(device, color, depth)?;
//! let lens = Lens::new(45.0_f32.to_radians(), 5.0);
//! let planes = Depth::Standard { near: 0.1, far: 100.0 };
//! let blurred: &wgpu::Texture = bokeh.render(queue, encoder, &targets, &lens, planes);
//! # Ok(())
//! # }
//! ```

#[rustfmt::skip]
mod frames;
pub mod images;
mod lens;
mod output;
#[rustfmt::skip]
mod parameters;

use frames::{Frame, Pass};
pub use lens::{Debug, Depth, Lens};
pub use output::Output;
use parameters::BokehParameters;
use std::{borrow::Cow, collections::HashMap, fmt, sync::OnceLock};
use wgpu::*;

/// The way in which the blur is computed. docs/start.md in the repository compares the methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// Blurred near objects spread over the sharp background, and the background that they hide is filled from its
    /// surroundings.
    #[default]
    Layered,
    /// Blurs each pixel by its own circle of confusion, in three passes. Blurred near objects keep a hard outline.
    Exact,
}

/// The shape of the bokeh. The values are the numbers of sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Polygon {
    Square = 4,
    #[default]
    Hexagon = 6,
    Octagon = 8,
    Decagon = 10,
}

/// The number of samples that the blur takes, and the distance between them. More samples look smoother and cost more.
///
/// With `Mobile`, [`Method::Layered`] also blurs its layers at a quarter of the image's size instead of half.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Preset {
    Mobile,
    Low,
    #[default]
    Medium,
    High,
    Ultra,
}

/// The rectangle of the textures that the image fills, in pixels, counted from the first texel in memory. With
/// [`Method::Layered`], `x` and `y` must be multiples of 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

/// The reason why [`Bokeh::targets`] refuses a texture, or [`Bokeh::render_part`] a viewport.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// Colour and depth have different sizes. The pairs are width and height in pixels.
    SizesDiffer { color: (u32, u32), depth: (u32, u32) },
    /// Colour is multisampled, with this number of samples per pixel: resolve it first.
    ColorIsMultisampled(u32),
    /// The texture, "colour" or "depth", was made without [`TextureUsages::TEXTURE_BINDING`].
    CannotBeRead(&'static str),
    /// The texture, "colour" or "depth", has a format that the effect does not read.
    Format(&'static str, TextureFormat),
    /// The effect was made by [`Bokeh::new`], so it has no viewports. Make it with [`Bokeh::with_viewport`].
    NoViewports,
    /// The viewport is empty, or not within the textures. The pair is the width and height of the textures in pixels.
    Outside(Viewport, (u32, u32)),
    /// The viewport does not begin at multiples of 8, which [`Method::Layered`] needs.
    Misaligned(Viewport),
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::SizesDiffer { color: (w, h), depth: (x, y) } => {
                write!(out, "colour is {w} x {h} pixels, but depth is {x} x {y}: both need the same size")
            }
            Self::ColorIsMultisampled(samples) => {
                write!(out, "colour has {samples} samples per pixel: resolve it first (depth may stay multisampled)")
            }
            Self::CannotBeRead(name) => {
                write!(out, "the {name} texture cannot be read: create it with TextureUsages::TEXTURE_BINDING")
            }
            Self::Format("depth", format) => {
                write!(out, "depth has the format {format:?}: use a depth format, R32Float, Rg16Float or Rg32Float")
            }
            Self::Format(name, format) => {
                write!(out, "{name} has the format {format:?}: use a filterable float format, such as Rgba16Float")
            }
            Self::NoViewports => write!(out, "the effect cannot draw viewports: create it with Bokeh::with_viewport"),
            Self::Outside(viewport, (w, h)) => {
                write!(out, "{viewport:?} is empty, or is not within the image of {w} x {h} pixels")
            }
            Self::Misaligned(viewport) => {
                write!(out, "{viewport:?} does not begin at multiples of 8 pixels, which the method layered needs")
            }
        }
    }
}

impl std::error::Error for Error {}

impl Preset {
    /// Returns the scale of a pass for this preset. In the tables, the layers have half the image's size; with
    /// `Mobile`, they have a quarter.
    fn scale(self, scale: u32) -> u32 {
        if self == Self::Mobile && scale == 2 { 4 } else { scale }
    }
}

/// The effect for one method, polygon and preset. It holds the pipelines.
pub struct Bokeh {
    polygon: Polygon,
    frame: &'static Frame,
    preset: Preset,
    // of all passes except the first one, which reads depth
    pipelines: Vec<RenderPipeline>,
    single_sampled: ReadsDepth,
    // created when targets() gets a multisampled depth texture for the first time
    multisampled: OnceLock<ReadsDepth>,
    constants: Vec<(&'static str, f64)>,
    sampler: Sampler,
    has_viewport: bool,
}

/// The two pipelines that read depth: the first pass, and the pass that draws [`Debug`] views.
struct ReadsDepth {
    map: RenderPipeline,
    debug: RenderPipeline,
}

/// The textures that [`Bokeh::render`] draws to, for one image. [`Bokeh::targets`] creates them for one colour and one
/// depth texture; call it again when you use other textures.
///
/// A `Targets` holds one set of parameters. You can therefore render it only once between two calls of
/// [`Queue::submit`]. For a second camera, create a second one.
pub struct Targets {
    color: Texture,
    steps: Vec<Step>,
    debug: Step,
    parameters: Buffer,
    full: Viewport,
    result: Texture,
}

/// A pass, with the resources that it reads and its targets.
struct Step {
    entry: &'static str,
    pipeline: RenderPipeline,
    bindings: BindGroup,
    targets: Vec<TextureView>,
    scale: u32,
}

/// A function that is called after each pass, with the encoder and the targets of the pass.
type Observer<'a> = &'a mut dyn FnMut(&mut CommandEncoder, &[TextureView]);

/// The format of all targets and of the result. The alpha of the result is the signed circle of confusion.
pub const FORMAT: TextureFormat = TextureFormat::Rgba16Float;
const SHADERS: &str = include_str!("bokeh.wgsl");
/// The bindings in `bokeh.wgsl`: the block of parameters, the linear sampler, depth, and the colours that a pass reads.
const PARAMETERS: u32 = 0;
const SAMPLER: u32 = 7;
const DEPTH: u32 = 2;
const COLORS: [u32; 6] = [1, 3, 4, 5, 8, 9];
const DEBUG_PASS: Pass = Pass {
    entry: "BokehDebug_PS",
    reads: &["coc"],
    writes: &["result"],
    memory: &[],
    scale: 1,
    linear: true,
};

impl Bokeh {
    /// Creates the effect for images that fill their textures. This compiles the shaders.
    pub fn new(device: &Device, method: Method, polygon: Polygon, preset: Preset) -> Self {
        Self::made(device, method, polygon, preset, false)
    }

    /// Creates the effect for images that may fill only a part of their textures, for example with dynamic resolution
    /// or a split screen. This compiles the shaders. Draw with [`Bokeh::render_part`].
    pub fn with_viewport(device: &Device, method: Method, polygon: Polygon, preset: Preset) -> Self {
        Self::made(device, method, polygon, preset, true)
    }

    fn made(device: &Device, method: Method, polygon: Polygon, preset: Preset, has_viewport: bool) -> Self {
        let table = match method {
            Method::Layered => &frames::LAYERED,
            Method::Exact => &frames::EXACT,
        };
        let frame = &table[polygon as usize / 2 - 2];
        let mut constants = frames::PRESETS[preset as usize].to_vec();
        constants.push(("BOKEH_VIEWPORT", f64::from(u8::from(has_viewport))));
        constants.push(("BOKEH_FOCUS_CONTROLS", 1.0));
        let shaders = module(device, SHADERS.into());
        let pipelines = frame.passes[1..].iter().map(|pass| pipeline(device, &shaders, pass, &constants)).collect();
        let single_sampled = ReadsDepth::new(device, &shaders, frame, &constants);
        let sampler = device.create_sampler(&SamplerDescriptor {
            label: Some("bokeh"),
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            ..Default::default()
        });
        let multisampled = OnceLock::new();
        Self { polygon, frame, preset, pipelines, single_sampled, multisampled, constants, sampler, has_viewport }
    }

    /// Creates the textures of all passes for one image. With [`Method::Layered`], [`Polygon::Hexagon`] and
    /// [`Preset::Medium`], they take 31.6 bytes per pixel of the image.
    ///
    /// * `color`: linear colour, not premultiplied
    /// * `depth`: depth of the same size. It may be multisampled; the effect then reads the first sample of each pixel.
    ///
    /// # Errors
    ///
    /// Returns an error if a texture cannot be read or has the wrong format, if `color` is multisampled, or if the
    /// sizes differ.
    pub fn targets(&self, device: &Device, color: &Texture, depth: &Texture) -> Result<Targets, Error> {
        checked(color, depth)?;
        let (width, height) = (color.width(), color.height());
        let parameters = device.create_buffer(&BufferDescriptor {
            label: Some("bokeh"),
            size: BokehParameters::SIZE,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        // targets with the same memory number share a texture
        let mut memory: HashMap<usize, Texture> = HashMap::new();
        let mut views: HashMap<&str, TextureView> = HashMap::new();
        views.insert("color", color.create_view(&Default::default()));
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        for pass in self.frame.passes {
            let scale = self.preset.scale(pass.scale);
            let target = || images::empty(device, width.div_ceil(scale), height.div_ceil(scale), FORMAT, usage);
            for (name, number) in pass.writes.iter().zip(pass.memory) {
                let texture = memory.entry(*number).or_insert_with(target);
                views.insert(name, texture.create_view(&Default::default()));
            }
        }
        let aspect = if depth.format().has_depth_aspect() { TextureAspect::DepthOnly } else { TextureAspect::All };
        let depth_view = depth.create_view(&TextureViewDescriptor { aspect, ..Default::default() });
        let reads_depth = if depth.sample_count() > 1 {
            self.multisampled.get_or_init(|| {
                let text = SHADERS.replace(
                    "alias BokehDepthTexture = texture_2d<f32>;",
                    "alias BokehDepthTexture = texture_depth_multisampled_2d;",
                );
                ReadsDepth::new(device, &module(device, text.into()), self.frame, &self.constants)
            })
        } else {
            &self.single_sampled
        };
        let step = |pipeline: &RenderPipeline, pass: &'static Pass, depth: Option<&TextureView>| {
            let mut entries = vec![BindGroupEntry {
                binding: PARAMETERS,
                resource: parameters.as_entire_binding(),
            }];
            let colors = pass.reads.iter().zip(COLORS).filter(|(name, _)| **name != "-");
            let textures = colors.map(|(name, binding)| (binding, &views[name]));
            for (binding, view) in textures.chain(depth.map(|view| (DEPTH, view))) {
                entries.push(BindGroupEntry { binding, resource: BindingResource::TextureView(view) });
            }
            if pass.linear {
                entries.push(BindGroupEntry { binding: SAMPLER, resource: BindingResource::Sampler(&self.sampler) });
            }
            let bindings = device.create_bind_group(&BindGroupDescriptor {
                label: Some(pass.entry),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            let targets = pass.writes.iter().map(|name| views[name].clone()).collect();
            Step {
                entry: pass.entry,
                pipeline: pipeline.clone(),
                bindings,
                targets,
                scale: self.preset.scale(pass.scale),
            }
        };
        let mut steps = vec![step(&reads_depth.map, &self.frame.passes[0], Some(&depth_view))];
        let others = self.pipelines.iter().zip(&self.frame.passes[1..]);
        steps.extend(others.map(|(pipeline, pass)| step(pipeline, pass, None)));
        let debug = step(&reads_depth.debug, &DEBUG_PASS, Some(&depth_view));
        let last = &self.frame.passes[self.frame.passes.len() - 1];
        let result = memory[&last.memory[0]].clone();
        let full = Viewport { x: 0, y: 0, width, height };
        Ok(Targets { color: color.clone(), steps, debug, parameters, full, result })
    }

    /// Records all passes, and returns the texture with the result. Its rgb is linear colour, and its alpha is the
    /// signed circle of confusion. [`Output`] copies it to a target of your own.
    ///
    /// If [`Lens::bokeh_scale`] is 0 and [`Lens::debug`] is `None`, the function records nothing, and returns the
    /// colour texture that was passed to [`Bokeh::targets`].
    ///
    /// * `targets`: from [`Bokeh::targets`] of the same `Bokeh`
    /// * `depth`: what the depth texture contains
    pub fn render<'a>(
        &self,
        queue: &Queue,
        encoder: &mut CommandEncoder,
        targets: &'a Targets,
        lens: &Lens,
        depth: Depth,
    ) -> &'a Texture {
        self.recorded(queue, encoder, targets, lens, depth, targets.full, &mut |_, _| ())
    }

    /// Does the same as [`Bokeh::render`], and calls `after_pass` after each pass, before another pass writes to the
    /// same memory. For tests.
    #[doc(hidden)]
    pub fn render_observed<'a>(
        &self,
        queue: &Queue,
        encoder: &mut CommandEncoder,
        targets: &'a Targets,
        lens: &Lens,
        depth: Depth,
        after_pass: Observer,
    ) -> &'a Texture {
        self.recorded(queue, encoder, targets, lens, depth, targets.full, after_pass)
    }

    /// Does the same as [`Bokeh::render`] for an image that fills only a part of its textures, the `viewport`. The
    /// pixels of the result around the viewport are undefined.
    ///
    /// # Errors
    ///
    /// Returns an error and records nothing in these cases: the effect was not made by [`Bokeh::with_viewport`], the
    /// viewport is empty or not within the textures, or, with [`Method::Layered`], it does not begin at multiples of 8.
    pub fn render_part<'a>(
        &self,
        queue: &Queue,
        encoder: &mut CommandEncoder,
        targets: &'a Targets,
        lens: &Lens,
        depth: Depth,
        viewport: Viewport,
    ) -> Result<&'a Texture, Error> {
        if !self.has_viewport {
            return Err(Error::NoViewports);
        }
        let full = targets.full;
        let fits = viewport.x.saturating_add(viewport.width) <= full.width
            && viewport.y.saturating_add(viewport.height) <= full.height;
        if !fits || viewport.width == 0 || viewport.height == 0 {
            return Err(Error::Outside(viewport, (full.width, full.height)));
        }
        // no texel of the smallest targets (8 x 8 pixels for layered) may lie across the edge of the viewport
        let texel = self.frame.passes.iter().map(|pass| pass.scale).max().unwrap_or(1);
        if viewport.x % texel != 0 || viewport.y % texel != 0 {
            return Err(Error::Misaligned(viewport));
        }
        Ok(self.recorded(queue, encoder, targets, lens, depth, viewport, &mut |_, _| ()))
    }

    #[allow(clippy::too_many_arguments)]
    fn recorded<'a>(
        &self,
        queue: &Queue,
        encoder: &mut CommandEncoder,
        targets: &'a Targets,
        lens: &Lens,
        depth: Depth,
        viewport: Viewport,
        after_pass: Observer,
    ) -> &'a Texture {
        if lens.bokeh_scale == 0.0 && lens.debug.is_none() {
            return &targets.color;
        }
        let mut parameters = BokehParameters {
            aspect_ratio: viewport.width as f32 / viewport.height as f32,
            sides: self.polygon as u32 as f32,
            image_width: viewport.width as f32,
            image_height: viewport.height as f32,
            viewport_x: viewport.x as f32,
            viewport_y: viewport.y as f32,
            texture_width: targets.full.width as f32,
            texture_height: targets.full.height as f32,
            // 0 takes the preset's spacing
            spacing: 0.0,
            ..Default::default()
        };
        lens.set(&mut parameters);
        depth.set(&mut parameters);
        queue.write_buffer(&targets.parameters, 0, &parameters.bytes());
        let steps = if lens.debug.is_some() { &targets.steps[..1] } else { &targets.steps[..] };
        for step in steps.iter().chain(lens.debug.map(|_| &targets.debug)) {
            step.record(encoder, viewport, self.has_viewport);
            after_pass(encoder, &step.targets);
        }
        &targets.result
    }
}

impl ReadsDepth {
    fn new(device: &Device, shaders: &ShaderModule, frame: &Frame, constants: &[(&str, f64)]) -> Self {
        let [map, debug] = [&frame.passes[0], &DEBUG_PASS].map(|pass| pipeline(device, shaders, pass, constants));
        Self { map, debug }
    }
}

impl Step {
    fn record(&self, encoder: &mut CommandEncoder, viewport: Viewport, has_viewport: bool) {
        // keep the pixels around a viewport
        let load = if has_viewport { LoadOp::Load } else { LoadOp::Clear(Color::TRANSPARENT) };
        let attachments: Vec<_> = self
            .targets
            .iter()
            .map(|view| {
                let ops = Operations { load, store: StoreOp::Store };
                Some(RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
            })
            .collect();
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some(self.entry),
            color_attachments: &attachments,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        if has_viewport {
            let Viewport { x, y, width, height } = viewport;
            let (width, height) = (width.div_ceil(self.scale), height.div_ceil(self.scale));
            let (x, y) = (x / self.scale, y / self.scale);
            pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        }
        pass.draw(0..3, 0..1);
    }
}

fn checked(color: &Texture, depth: &Texture) -> Result<(), Error> {
    for (name, texture) in [("colour", color), ("depth", depth)] {
        if !texture.usage().contains(TextureUsages::TEXTURE_BINDING) {
            return Err(Error::CannotBeRead(name));
        }
    }
    if color.sample_count() > 1 {
        return Err(Error::ColorIsMultisampled(color.sample_count()));
    }
    if color.format().sample_type(None, None) != Some(TextureSampleType::Float { filterable: true }) {
        return Err(Error::Format("colour", color.format()));
    }
    let numbers = [TextureFormat::R32Float, TextureFormat::Rg16Float, TextureFormat::Rg32Float];
    if !depth.format().has_depth_aspect() && !numbers.contains(&depth.format()) {
        return Err(Error::Format("depth", depth.format()));
    }
    let sizes = [color, depth].map(|texture| (texture.width(), texture.height()));
    if sizes[0] == sizes[1] { Ok(()) } else { Err(Error::SizesDiffer { color: sizes[0], depth: sizes[1] }) }
}

fn module(device: &Device, text: Cow<str>) -> ShaderModule {
    device.create_shader_module(ShaderModuleDescriptor { label: Some("bokeh"), source: ShaderSource::Wgsl(text) })
}

fn pipeline(device: &Device, shaders: &ShaderModule, pass: &Pass, constants: &[(&str, f64)]) -> RenderPipeline {
    let compilation_options = PipelineCompilationOptions { constants, ..Default::default() };
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some(pass.entry),
        layout: None,
        vertex: VertexState {
            module: shaders,
            entry_point: Some("BokehFullScreen_VS"),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(FragmentState {
            module: shaders,
            entry_point: Some(pass.entry),
            compilation_options,
            targets: &vec![Some(FORMAT.into()); pass.writes.len()],
        }),
        multiview_mask: None,
        cache: None,
    })
}
