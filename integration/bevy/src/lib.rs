// SPDX-License-Identifier: MIT

//! Depth of field with polygonal bokeh for perspective 3D cameras. Add [`BokehPlugin`] to the app, and the component
//! [`Bokeh`] to the camera.

#[rustfmt::skip]
mod passes;

use bevy::{
    camera::Hdr,
    core_pipeline::{Core3dSystems, schedule::Core3d},
    platform::collections::HashMap,
    prelude::*,
    render::{
        Render, RenderApp, RenderStartup, RenderSystems,
        camera::ExtractedCamera,
        extract_component::{ExtractComponent, ExtractComponentPlugin},
        render_resource::{
            binding_types::{sampler, texture_2d, texture_depth_2d_multisampled, uniform_buffer},
            *,
        },
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
        texture::{CachedTexture, TextureCache},
        view::{ExtractedView, ViewDepthStencilTexture, ViewTarget},
    },
};

/// The number of samples that the blur takes, and the distance between them. More samples look smoother and cost more.
///
/// With `Mobile`, [`BokehMethod::Layered`] also blurs its layers at a quarter of the image's size instead of half.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BokehPreset {
    Mobile,
    Low,
    #[default]
    Medium,
    High,
    Ultra,
}

/// Names of the shader constants that a preset sets.
const CONSTANTS: [&str; 5] =
    ["BOKEH_NUM_SAMPLES", "BOKEH_LAYER_RINGS", "BOKEH_LAYER_SAMPLES", "BOKEH_LAYER_CUBIC", "BOKEH_LAYER_SCALE"];
/// The line of the shaders that declares the type of the depth texture, and the line that replaces it if depth is
/// multisampled.
const DEPTH: [&str; 2] =
    ["alias BokehDepthTexture = texture_2d<f32>;", "alias BokehDepthTexture = texture_depth_multisampled_2d;"];

impl BokehPreset {
    /// Returns the values of [`CONSTANTS`], and the distance between samples in pixels.
    fn numbers(self) -> ([i32; 5], f32) {
        match self {
            Self::Mobile => ([5, 0, 18, 0, 4], 2.0),
            Self::Low => ([5, 1, 11, 0, 2], 2.0),
            Self::Medium => ([9, 2, 11, 1, 2], 1.5),
            Self::High => ([17, 3, 18, 1, 2], 1.0),
            Self::Ultra => ([33, 4, 18, 1, 2], 1.0),
        }
    }

    /// Returns [`Pass::scale`] for this preset. In the tables, the layers have half the image's size; with `Mobile`,
    /// they have a quarter.
    fn scale(self, pass: &Pass) -> u32 {
        if self == Self::Mobile && pass.scale == 2 { 4 } else { pass.scale }
    }
}

/// Draws depth of field for every camera that has a [`Bokeh`]. Add this plugin after `DefaultPlugins`.
pub struct BokehPlugin;

/// The way in which the blur is computed. docs/start.md in the repository compares the methods.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BokehMethod {
    /// Blurred near objects spread over the sharp background, and the background that they hide is filled from its
    /// surroundings.
    #[default]
    Layered,
    /// Blurs each pixel by its own circle of confusion, in three passes. Blurred near objects keep a hard outline.
    Exact,
    /// Blurs along lines and combines the results by their minimum, as in the paper of 2012 (docs/paper.md). Draws only
    /// hexagons and octagons: a square or decagon becomes a hexagon.
    Paper,
}

/// The shape of the bokeh. The values are the numbers of sides.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BokehShape {
    Square = 4,
    #[default]
    Hexagon = 6,
    Octagon = 8,
    Decagon = 10,
}

/// A view that is shown instead of the result. The values are those of the shader parameter BokehDebugMode.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub enum BokehDebug {
    /// The colour that the effect reads.
    Color = 0,
    /// Depth: black at the camera, grey at the focus distance, white at infinity.
    Depth = 1,
    /// The circle of confusion: black in focus, white at `max_coc`.
    CircleOfConfusion = 2,
    /// Orange in front of the focus distance, blue behind it, and black where the image is sharp.
    Focus = 3,
}

/// Gives a camera depth of field. Every field may change in any frame. Lengths are in metres: one unit of the world is
/// one metre.
///
/// This component requires [`Hdr`], so adding it turns HDR on. If the camera uses [`Msaa`], the effect reads the depth
/// of the first sample of each pixel.
#[derive(Component, ExtractComponent, Reflect, Clone, Debug)]
#[extract_app(RenderApp)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Hdr)]
pub struct Bokeh {
    /// Diameter of the aperture. The default is f/2.8 with a bokeh scale of 10. 0 turns the effect off: no pass is
    /// drawn, unless `debug` is set.
    pub aperture_diameter: f32,
    pub focal_length: f32,
    /// Distance along the view axis at which objects are sharp; it must be more than the focal length. [`view_depth`]
    /// computes it for a point of the world.
    pub focus_distance: f32,
    pub sensor_height: f32,
    /// Largest circle of confusion (the diameter of the blur), as a fraction of the image height.
    pub max_coc: f32,
    /// Multiplies the circle of confusion in front of the focus distance. [`BokehMethod::Paper`] ignores this field and
    /// the next three.
    pub near_scale: f32,
    /// Multiplies the circle of confusion behind the focus distance.
    pub far_scale: f32,
    /// Largest circle of confusion in front of the focus distance, as a fraction of the image height. `max_coc` applies
    /// too.
    pub near_max_coc: f32,
    /// Largest circle of confusion behind the focus distance, as a fraction of the image height. `max_coc` applies too.
    pub far_max_coc: f32,
    pub method: BokehMethod,
    pub shape: BokehShape,
    pub preset: BokehPreset,
    /// Rotation of the polygon, radians, clockwise on the screen.
    pub rotation: f32,
    pub debug: Option<BokehDebug>,
}

impl Default for Bokeh {
    fn default() -> Self {
        Self {
            aperture_diameter: 0.05 / 2.8 * 10.0,
            focal_length: 0.05,
            focus_distance: 5.0,
            sensor_height: 0.024,
            max_coc: 0.1,
            near_scale: 1.0,
            far_scale: 1.0,
            near_max_coc: 1.0,
            far_max_coc: 1.0,
            method: default(),
            shape: default(),
            preset: default(),
            rotation: 0.0,
            debug: None,
        }
    }
}

impl Bokeh {
    /// Returns a `Bokeh` with the focal length and aperture of a camera's lens, and defaults for all other fields.
    ///
    /// * `fov`: vertical field of view of the camera, radians
    /// * `f_stop`: for example 2.8; a lower f-stop blurs more
    /// * `bokeh_scale`: multiplies the width of the blur; 10 is a good value to begin with. 1 is the blur of a real
    ///   lens, which hardly blurs at a game's field of view (docs/lens.md). 0 turns the effect off.
    pub fn with_lens(fov: f32, f_stop: f32, bokeh_scale: f32) -> Self {
        let lens = Self::default();
        let focal_length = lens.sensor_height / (2.0 * (0.5 * fov).tan());
        Self { focal_length, aperture_diameter: focal_length / f_stop * bokeh_scale, ..lens }
    }

    /// Moves the focus smoothly towards the nearest of several depths. Call this once per frame.
    ///
    /// * `dt`: time since the last frame, seconds; if it is infinite, the focus arrives at once
    /// * `depths`: depths along the view axis, metres, for example from [`view_depth`]
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
}

/// Returns the depth of a point of the world along a camera's view axis, metres. This is the focus distance at which
/// the point is sharp.
pub fn view_depth(camera: &GlobalTransform, point: Vec3) -> f32 {
    (point - camera.translation()).dot(*camera.forward())
}

/// The system set of the effect, in the schedule [`Core3d`]. Use it to order your own systems before or after the
/// effect.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct BokehSystems;

/// The textures that a view's passes write, except the result: name and texture, in the order of the passes. This
/// component belongs to the view's entity in the render world.
///
/// You can copy from the textures. Their format is Rgba16Float, with one exception: "metres" of [`BokehMethod::Paper`],
/// the depth along the view axis, is R32Float.
#[derive(Component)]
pub struct BokehTextures(pub Vec<(&'static str, CachedTexture)>);

impl Plugin for BokehPlugin {
    fn build(&self, app: &mut App) {
        let text = include_str!("bokeh.wgsl");
        let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
        let shaders = [("bokeh.wgsl", text.to_string()), ("bokeh_multisampled.wgsl", text.replace(DEPTH[0], DEPTH[1]))]
            .map(|(name, text)| shaders.add(Shader::from_wgsl(text, name)));
        app.register_type::<Bokeh>().add_plugins(ExtractComponentPlugin::<Bokeh>::default()).add_systems(PostUpdate, let_depth_be_read);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .insert_resource(BokehShaders(shaders))
            .init_resource::<BokehUniforms>()
            .add_systems(RenderStartup, create_pipelines)
            .add_systems(Render, prepare_bokeh.in_set(RenderSystems::PrepareResources))
            .add_systems(
                Core3d,
                // PostProcess contains bloom and tone mapping
                bokeh.in_set(BokehSystems).after(Core3dSystems::EarlyPostProcess).before(Core3dSystems::PostProcess),
            );
    }
}

fn let_depth_be_read(mut cameras: Query<&mut Camera3d, Added<Bokeh>>) {
    for mut camera in &mut cameras {
        let usages = TextureUsages::from(camera.depth_texture_usages) | TextureUsages::TEXTURE_BINDING;
        camera.depth_texture_usages = usages.into();
    }
}

/// Describes one full-screen pass.
pub struct Pass {
    /// Its entry point in `bokeh.wgsl`.
    pub entry: &'static str,
    /// The textures that it reads, for the slots BokehColorSamp and BokehColorSampB to F. Each is a target of an
    /// earlier pass, or "color", the image before the effect. "-" leaves a slot unused.
    pub reads: &'static [&'static str],
    /// The targets that it writes; "result" is the image after the effect.
    pub writes: &'static [&'static str],
    /// The targets have the image's size divided by this number, rounded up.
    pub scale: u32,
    sets: &'static [Own],
}

/// A parameter whose value differs from pass to pass.
enum Own {
    /// Degrees, added to the polygon's rotation.
    Angle(f32),
    Sides(f32),
}

/// For each number of sides, the passes after the pass that computes the circle of confusion.
type Table = &'static [(u32, &'static [Pass])];

const fn pass(
    entry: &'static str,
    reads: &'static [&'static str],
    writes: &'static [&'static str],
    scale: u32,
    sets: &'static [Own],
) -> Pass {
    Pass { entry, reads, writes, scale, sets }
}

impl Pass {
    /// Returns whether the pass reads the depth that BokehLinearDepth_PS wrote. All other passes get the camera's depth
    /// buffer.
    fn reads_metres(&self) -> bool {
        matches!(self.entry, "BokehCoCMap_PS" | "BokehAdaptive_PS" | "BokehAdaptiveFinal_PS")
    }

    /// Returns whether the pass gets multisampled depth, if the camera's depth buffer has `samples` samples per pixel.
    fn is_multisampled(&self, samples: u32) -> bool {
        samples > 1 && !self.reads_metres()
    }
}

const SIGNED_MAP: &[Pass] = &[pass("BokehSignedCoCMap_PS", &["color"], &["coc"], 1, &[])];
const PAPER_MAP: &[Pass] =
    &[pass("BokehLinearDepth_PS", &[], &["metres"], 1, &[]), pass("BokehCoCMap_PS", &["color"], &["coc"], 1, &[])];
const DEBUG: Table = &[(6, &[pass("BokehDebug_PS", &["coc"], &["result"], 1, &[])])];

/// The value of BokehDepthKind for depth that is 1 at the near plane and 0 at infinity.
const REVERSED_INFINITE: f32 = 3.0;

fn format(texture: &str) -> TextureFormat {
    if texture == "metres" { TextureFormat::R32Float } else { TextureFormat::Rgba16Float }
}

impl Bokeh {
    /// Returns the passes that are drawn, in their order.
    pub fn passes(&self) -> impl Iterator<Item = &'static Pass> {
        let (map, table) = match (self.debug, self.method) {
            (Some(_), _) => (SIGNED_MAP, DEBUG),
            (None, BokehMethod::Layered) => (SIGNED_MAP, passes::LAYERED),
            (None, BokehMethod::Exact) => (SIGNED_MAP, passes::EXACT),
            (None, BokehMethod::Paper) => (PAPER_MAP, passes::PAPER),
        };
        let row = table.iter().find(|(sides, _)| *sides == self.shape as u32).unwrap_or(&table[0]);
        map.iter().chain(row.1)
    }

    fn parameters(&self, size: UVec2, near: f32, pass: &Pass) -> BokehParameters {
        let size = size.as_vec2();
        let mut parameters = BokehParameters {
            aperture_diameter: self.aperture_diameter,
            focal_length: self.focal_length,
            focus_distance: self.focus_distance,
            sensor_height: self.sensor_height,
            max_coc: self.max_coc,
            aspect_ratio: size.x / size.y,
            angle: self.rotation,
            bleeding_bias: 0.02,
            bleeding_mult: 30.0,
            blur_coc: 1.0,
            debug_mode: self.debug.map_or(0.0, |mode| mode as u32 as f32),
            line_length: 1.0,
            near_scale: self.near_scale,
            far_scale: self.far_scale,
            near_max_coc: self.near_max_coc,
            far_max_coc: self.far_max_coc,
            depth_width: 1.0,
            depth_height: 1.0,
            squeeze: 1.0,
            spacing: self.preset.numbers().1,
            image_width: size.x,
            image_height: size.y,
            depth_kind: REVERSED_INFINITE,
            near,
            ..default()
        };
        for own in pass.sets {
            match own {
                Own::Angle(degrees) => parameters.angle += degrees.to_radians(),
                Own::Sides(sides) => parameters.sides = *sides,
            }
        }
        parameters
    }
}

/// Mirrors the struct of the same name in `bokeh.wgsl`. docs/reference/parameters.md has the units.
#[derive(ShaderType, Default)]
struct BokehParameters {
    // generated by validation/run generate from shaders/parameters.py: begin
    aperture_diameter: f32,
    focal_length: f32,
    focus_distance: f32,
    sensor_height: f32,
    max_coc: f32,
    constant_coc: f32,
    aspect_ratio: f32,
    angle: f32,
    angle_b: f32,
    bleeding_bias: f32,
    bleeding_mult: f32,
    blur_coc: f32,
    use_max: f32,
    debug_mode: f32,
    line_length: f32,
    line_center_x: f32,
    line_center_y: f32,
    squeeze: f32,
    spacing: f32,
    image_width: f32,
    image_height: f32,
    jitter: f32,
    frame: f32,
    sides: f32,
    depth_kind: f32,
    near: f32,
    far: f32,
    viewport_x: f32,
    viewport_y: f32,
    texture_width: f32,
    texture_height: f32,
    pass_index: f32,
    cats_eye: f32,
    roundness: f32,
    lateral: f32,
    front_range: f32,
    back_range: f32,
    near_scale: f32,
    far_scale: f32,
    near_max_coc: f32,
    far_max_coc: f32,
    depth_x: f32,
    depth_y: f32,
    depth_width: f32,
    depth_height: f32,
    stable_blend: f32,
    // generated by validation/run generate from shaders/parameters.py: end
}

#[derive(Resource)]
struct BokehShaders([Handle<Shader>; 2]);

#[derive(Resource)]
struct BokehPipelines {
    /// For depth with one sample per pixel, then for multisampled depth. The same goes for `layouts`.
    shaders: [Handle<Shader>; 2],
    layouts: [BindGroupLayoutDescriptor; 2],
    linear: Sampler,
    /// The pipelines, by entry point, preset, and whether depth is multisampled.
    made: HashMap<(&'static str, BokehPreset, bool), CachedRenderPipelineId>,
}

/// The parameters of every pass of every view.
#[derive(Resource, Default)]
struct BokehUniforms(DynamicUniformBuffer<BokehParameters>);

/// The passes of a view, each with its pipeline and the offset of its parameters in [`BokehUniforms`].
#[derive(Component)]
struct BokehPasses {
    drawn: Bokeh,
    steps: Vec<(&'static Pass, CachedRenderPipelineId, u32)>,
}

fn create_pipelines(mut commands: Commands, shaders: Res<BokehShaders>, device: Res<RenderDevice>) {
    let color = || texture_2d(TextureSampleType::Float { filterable: true });
    let table = || texture_2d(TextureSampleType::Float { filterable: false });
    let layouts = [table(), texture_depth_2d_multisampled()].map(|depth| {
        let uniform = uniform_buffer::<BokehParameters>(true);
        let linear = sampler(SamplerBindingType::Filtering);
        let entries = (uniform, color(), depth, color(), color(), color(), table(), linear, color(), color());
        BindGroupLayoutDescriptor::new("bokeh", &BindGroupLayoutEntries::sequential(ShaderStages::FRAGMENT, entries))
    });
    let (mag_filter, min_filter) = (FilterMode::Linear, FilterMode::Linear);
    commands.insert_resource(BokehPipelines {
        shaders: shaders.0.clone(),
        layouts,
        linear: device.create_sampler(&SamplerDescriptor { mag_filter, min_filter, ..default() }),
        made: default(),
    });
}

impl BokehPipelines {
    /// Returns the pipeline of a pass. It is queued when a view first needs it, and Bevy compiles it in the background.
    fn get(&mut self, cache: &PipelineCache, pass: &Pass, preset: BokehPreset, msaa: Msaa) -> CachedRenderPipelineId {
        let several = pass.is_multisampled(msaa.samples());
        let (shader, layout) = (self.shaders[several as usize].clone(), &self.layouts[several as usize]);
        *self.made.entry((pass.entry, preset, several)).or_insert_with(|| {
            let numbers = CONSTANTS.into_iter().zip(preset.numbers().0);
            let mut constants: Vec<_> = numbers.map(|(name, value)| (name.into(), f64::from(value))).collect();
            constants.push(("BOKEH_FOCUS_CONTROLS".into(), 1.0));
            cache.queue_render_pipeline(RenderPipelineDescriptor {
                label: Some(pass.entry.into()),
                layout: vec![layout.clone()],
                vertex: VertexState {
                    shader: shader.clone(),
                    entry_point: Some("BokehFullScreen_VS".into()),
                    constants: constants.clone(),
                    ..default()
                },
                fragment: Some(FragmentState {
                    shader,
                    entry_point: Some(pass.entry.into()),
                    constants,
                    // no blend state: alpha is the circle of confusion
                    targets: pass.writes.iter().map(|target| Some(format(target).into())).collect(),
                    ..default()
                }),
                ..default()
            })
        })
    }
}

type PreparedView = (
    Entity,
    &'static ExtractedCamera,
    &'static ExtractedView,
    &'static Msaa,
    &'static Bokeh,
    Option<&'static BokehPasses>,
);

fn prepare_bokeh(
    mut commands: Commands,
    views: Query<PreparedView>,
    mut pipelines: ResMut<BokehPipelines>,
    mut uniforms: ResMut<BokehUniforms>,
    mut textures: ResMut<TextureCache>,
    (cache, device, queue): (Res<PipelineCache>, Res<RenderDevice>, Res<RenderQueue>),
) {
    uniforms.0.clear();
    for (entity, camera, view, msaa, bokeh, last) in &views {
        let Some(size) = camera.physical_target_size else {
            continue;
        };
        let mut made = |drawn: &Bokeh| -> Vec<_> {
            drawn.passes().map(|pass| (pass, pipelines.get(&cache, pass, drawn.preset, *msaa))).collect()
        };
        let mut drawn = bokeh.clone();
        let mut wanted = made(&drawn);
        // While a new method, shape or preset is being compiled, draw with the previous one
        if let Some(last) = last
            && wanted.iter().any(|(_, pipeline)| cache.get_render_pipeline(*pipeline).is_none())
        {
            let Bokeh { method, shape, preset, debug, .. } = last.drawn;
            drawn = Bokeh { method, shape, preset, debug, ..drawn };
            wanted = made(&drawn);
        }
        // In Bevy's matrix of a perspective projection, this element is the distance of the near plane
        let near = view.clip_from_view.w_axis.z;
        let mut written = Vec::new();
        let mut steps = Vec::new();
        for (pass, pipeline) in wanted {
            let scale = drawn.preset.scale(pass);
            steps.push((pass, pipeline, uniforms.0.push(&drawn.parameters(size, near, pass))));
            for name in pass.writes.iter().filter(|name| **name != "result") {
                let descriptor = TextureDescriptor {
                    label: Some(*name),
                    size: Extent3d {
                        width: size.x.div_ceil(scale),
                        height: size.y.div_ceil(scale),
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: TextureDimension::D2,
                    format: format(name),
                    usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
                    view_formats: &[],
                };
                written.push((*name, textures.get(&device, descriptor)));
            }
        }
        commands.entity(entity).insert((BokehPasses { drawn, steps }, BokehTextures(written)));
    }
    uniforms.0.write_buffer(&device, &queue);
}

type BokehView = (&'static ViewTarget, &'static ViewDepthStencilTexture, &'static BokehTextures, &'static BokehPasses);

fn bokeh(
    view: ViewQuery<BokehView, With<Bokeh>>,
    pipelines: Res<BokehPipelines>,
    cache: Res<PipelineCache>,
    uniforms: Res<BokehUniforms>,
    mut context: RenderContext,
) {
    let (view_target, device_depth, textures, passes) = view.into_inner();
    if passes.drawn.aperture_diameter <= 0.0 && passes.drawn.debug.is_none() {
        return;
    }
    // Draw nothing until all shaders are compiled
    let ready: Option<Vec<_>> = passes.steps.iter().map(|step| cache.get_render_pipeline(step.1)).collect();
    let depth_buffer = device_depth.attachment.depth_stencil_views().depth_only_view();
    let (Some(ready), Some(parameters), Some(depth_buffer)) = (ready, uniforms.0.binding(), depth_buffer) else {
        return;
    };
    let image = view_target.post_process_write();
    // The bind group must also fill the slots that the pass does not read; these get the image
    let view_of = |texture: &str| match textures.0.iter().find(|(name, _)| *name == texture) {
        Some((_, found)) => &found.default_view,
        None if texture == "result" => image.destination,
        None => image.source,
    };
    for ((pass, _, offset), pipeline) in passes.steps.iter().zip(ready) {
        let read = |slot: usize| view_of(pass.reads.get(slot).unwrap_or(&"-"));
        let several = pass.is_multisampled(device_depth.texture().sample_count());
        let depth = if pass.reads_metres() { view_of("metres") } else { depth_buffer };
        let bindings = context.render_device().create_bind_group(
            pass.entry,
            &cache.get_bind_group_layout(&pipelines.layouts[several as usize]),
            &BindGroupEntries::sequential((
                parameters.clone(),
                read(0),
                depth,
                read(1),
                read(2),
                read(3),
                image.source,
                &pipelines.linear,
                read(4),
                read(5),
            )),
        );
        let attachments: Vec<_> = pass
            .writes
            .iter()
            .map(|target| {
                Some(RenderPassColorAttachment {
                    view: view_of(target),
                    depth_slice: None,
                    resolve_target: None,
                    ops: Operations::default(),
                })
            })
            .collect();
        let mut render_pass = context.command_encoder().begin_render_pass(&RenderPassDescriptor {
            label: Some(pass.entry),
            color_attachments: &attachments,
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        render_pass.set_pipeline(pipeline);
        render_pass.set_bind_group(0, &bindings, &[*offset]);
        render_pass.draw(0..3, 0..1);
    }
}
