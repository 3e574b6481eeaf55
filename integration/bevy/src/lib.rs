// SPDX-License-Identifier: MIT

//! Depth of field with polygonal bokeh for perspective 3D cameras: add [`BokehPlugin`], put a [`Bokeh`] on the camera.

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

/// How finely is sampled.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BokehPreset {
    Mobile,
    Low,
    #[default]
    Medium,
    High,
    Ultra,
}

/// Constants of the shaders that a preset sets.
const CONSTANTS: [&str; 5] =
    ["BOKEH_NUM_SAMPLES", "BOKEH_LAYER_RINGS", "BOKEH_LAYER_SAMPLES", "BOKEH_LAYER_CUBIC", "BOKEH_LAYER_SCALE"];
/// The type of depth in the shaders, and what it is where depth is multisampled.
const DEPTH: [&str; 2] =
    ["alias BokehDepthTexture = texture_2d<f32>;", "alias BokehDepthTexture = texture_depth_multisampled_2d;"];

impl BokehPreset {
    /// Of [`CONSTANTS`], then pixels between samples.
    fn numbers(self) -> ([i32; 5], f32) {
        match self {
            Self::Mobile => ([5, 0, 18, 0, 4], 2.0),
            Self::Low => ([5, 1, 11, 0, 2], 2.0),
            Self::Medium => ([9, 2, 11, 1, 2], 1.5),
            Self::High => ([17, 3, 18, 1, 2], 1.0),
            Self::Ultra => ([33, 4, 18, 1, 2], 1.0),
        }
    }

    /// [`Pass::scale`] with this preset: the tables have layers of half size, and those of `Mobile` have a quarter.
    fn scale(self, pass: &Pass) -> u32 {
        if self == Self::Mobile && pass.scale == 2 { 4 } else { pass.scale }
    }
}

/// Depth of field for every camera that has a [`Bokeh`]. Add it after `DefaultPlugins`.
pub struct BokehPlugin;

/// How the polygon is made: docs/methods.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BokehMethod {
    /// Near objects spread over what is behind them, and what they hide is filled.
    #[default]
    Layered,
    /// Each pixel by its own circle of confusion, in three passes: near objects keep a hard outline.
    Exact,
    /// The paper's lines, combined by min: hexagon and octagon only, of which the others get the first.
    Paper,
}

/// The aperture, by its number of blades.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BokehShape {
    Square = 4,
    #[default]
    Hexagon = 6,
    Octagon = 8,
    Decagon = 10,
}

/// What is shown in place of the result; the values are those of BokehDebugMode.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub enum BokehDebug {
    /// The colour that goes in.
    Color = 0,
    /// Black at the camera, grey at the focus distance, white at infinity.
    Depth = 1,
    /// Black in focus, white at `max_coc`.
    CircleOfConfusion = 2,
    /// Orange before the focus, blue behind it.
    Focus = 3,
}

/// The lens of a camera; all of it may change in any frame. Lengths are in metres: one unit of the world is one metre.
///
/// Turns HDR on. With [`Msaa`], depth is that of the first sample.
#[derive(Component, ExtractComponent, Reflect, Clone, Debug)]
#[extract_app(RenderApp)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Hdr)]
pub struct Bokeh {
    /// 0 turns the effect off: no pass is drawn.
    pub aperture_diameter: f32,
    pub focal_length: f32,
    /// Along the view axis, more than the focal length: see [`view_depth`].
    pub focus_distance: f32,
    pub sensor_height: f32,
    /// Largest circle of confusion, fraction of the image height.
    pub max_coc: f32,
    /// Factor of the circle of confusion in front of the focus distance.
    pub near_scale: f32,
    /// Factor of the circle of confusion behind the focus distance.
    pub far_scale: f32,
    /// Limit in front of the focus distance, as `max_coc`, which limits both sides.
    pub near_max_coc: f32,
    /// Limit behind the focus distance.
    pub far_max_coc: f32,
    pub method: BokehMethod,
    pub shape: BokehShape,
    pub preset: BokehPreset,
    /// Of the polygon, radians, clockwise on the screen.
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
    /// The lens of a camera's vertical field of view (radians), at an f-stop, 2.8, with a blur `bokeh_scale` times as wide,
    /// 10: 1 is the real lens, which hardly blurs at a game's field of view (docs/lens.md), 0 is none.
    pub fn with_lens(fov: f32, f_stop: f32, bokeh_scale: f32) -> Self {
        let lens = Self::default();
        let focal_length = lens.sensor_height / (2.0 * (0.5 * fov).tan());
        Self { focal_length, aperture_diameter: focal_length / f_stop * bokeh_scale, ..lens }
    }

    /// Moves the focus towards the nearest of these depths; call it once a frame of `dt` seconds. 1 / distance changes
    /// evenly, not the distance; `tau` is the time constant (docs/lens.md). With an infinite `dt`, it arrives at once.
    pub fn pull_focus(&mut self, dt: f32, depths: impl IntoIterator<Item = f32>, tau: f32) {
        let nearest = depths.into_iter().fold(f32::INFINITY, f32::min);
        let k = 1.0 - (-dt / tau).exp();
        // recovers from 0 and NaN
        let from = if self.focus_distance > 0.0 { self.focus_distance } else { nearest };
        self.focus_distance = 1.0 / ((1.0 - k) / from + k / nearest);
    }
}

/// Depth of a point of the world along a camera's view axis, metres: the focus distance at which it is sharp.
pub fn view_depth(camera: &GlobalTransform, point: Vec3) -> f32 {
    (point - camera.translation()).dot(*camera.forward())
}

/// The effect's place in [`Core3d`], for what wants to be before or after it.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct BokehSystems;

/// What a view's passes write before the result, by name, in their order, in the render world. It may be copied from:
/// Rgba16Float, but R32Float for the "metres" along the view axis of [`BokehMethod::Paper`].
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
                // Bloom and tone mapping are in PostProcess
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

/// One full-screen pass.
pub struct Pass {
    /// Of `bokeh.wgsl`.
    pub entry: &'static str,
    /// Textures for BokehColorSamp, BokehColorSampB to F: of passes before it, or "color", the image as it comes; "-": none.
    pub reads: &'static [&'static str],
    /// Its targets; "result" is the image as it goes on.
    pub writes: &'static [&'static str],
    /// Their size is that of the image divided by it, rounded up.
    pub scale: u32,
    sets: &'static [Own],
}

/// A parameter of one pass alone.
enum Own {
    /// Degrees, beside the polygon's rotation.
    Angle(f32),
    Axis(f32),
    Layer(f32),
    Sides(f32),
}

/// Number of sides, passes after the circle of confusion.
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
    /// Whether its depth is that of BokehLinearDepth_PS; else it is the camera's depth buffer.
    fn reads_metres(&self) -> bool {
        matches!(self.entry, "BokehCoCMap_PS" | "BokehAdaptive_PS" | "BokehAdaptiveFinal_PS")
    }

    /// Whether its depth is multisampled, where the camera's has so many samples.
    fn is_multisampled(&self, samples: u32) -> bool {
        samples > 1 && !self.reads_metres()
    }
}

const SIGNED_MAP: &[Pass] = &[pass("BokehSignedCoCMap_PS", &["color"], &["coc"], 1, &[])];
const PAPER_MAP: &[Pass] =
    &[pass("BokehLinearDepth_PS", &[], &["metres"], 1, &[]), pass("BokehCoCMap_PS", &["color"], &["coc"], 1, &[])];
const DEBUG: Table = &[(6, &[pass("BokehDebug_PS", &["coc"], &["result"], 1, &[])])];

/// Of BokehDepthKind: 1 at the near plane, 0 at infinity.
const REVERSED_INFINITE: f32 = 3.0;

fn format(texture: &str) -> TextureFormat {
    if texture == "metres" { TextureFormat::R32Float } else { TextureFormat::Rgba16Float }
}

impl Bokeh {
    /// What is drawn, in its order.
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
                Own::Axis(axis) => parameters.axis = *axis,
                Own::Layer(layer) => parameters.layer = *layer,
                Own::Sides(sides) => parameters.sides = *sides,
            }
        }
        parameters
    }
}

/// The struct of the same name in `bokeh.wgsl`; docs/reference/parameters.md has the units.
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
    axis: f32,
    layer: f32,
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
    /// Both for depth of one sample, and of several.
    shaders: [Handle<Shader>; 2],
    layouts: [BindGroupLayoutDescriptor; 2],
    linear: Sampler,
    /// By entry, preset and whether depth has several samples.
    made: HashMap<(&'static str, BokehPreset, bool), CachedRenderPipelineId>,
}

/// The parameters of every pass of every view.
#[derive(Resource, Default)]
struct BokehUniforms(DynamicUniformBuffer<BokehParameters>);

/// A view's passes, each with its pipeline and the place of its parameters in [`BokehUniforms`].
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
    /// Made when a view first needs it: Bevy compiles it beside the frames.
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
                    // without a blend state, since alpha is the circle of confusion
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
        // While another method, shape or preset is being compiled, the one before is drawn
        if let Some(last) = last
            && wanted.iter().any(|(_, pipeline)| cache.get_render_pipeline(*pipeline).is_none())
        {
            let Bokeh { method, shape, preset, debug, .. } = last.drawn;
            drawn = Bokeh { method, shape, preset, debug, ..drawn };
            wanted = made(&drawn);
        }
        // Bevy's perspective projection has it there, whatever the camera is made of
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
    // Nothing is drawn before every shader is compiled
    let ready: Option<Vec<_>> = passes.steps.iter().map(|step| cache.get_render_pipeline(step.1)).collect();
    let depth_buffer = device_depth.attachment.depth_stencil_views().depth_only_view();
    let (Some(ready), Some(parameters), Some(depth_buffer)) = (ready, uniforms.0.binding(), depth_buffer) else {
        return;
    };
    let image = view_target.post_process_write();
    // A slot that the pass does not read needs a texture all the same: the image
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
