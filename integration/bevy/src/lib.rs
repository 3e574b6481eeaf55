// SPDX-License-Identifier: MIT

//! Depth of field with polygonal bokeh for perspective 3D cameras: add [`BokehPlugin`], put a [`Bokeh`] on the camera.

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
            binding_types::{sampler, texture_2d, uniform_buffer},
            *,
        },
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
        texture::{CachedTexture, TextureCache},
        view::{ExtractedView, ViewDepthTexture, ViewTarget},
    },
};

const SHADERS: &str = concat!(
    include_str!("../../../wgsl/bokeh.wgsl"),
    include_str!("../../../wgsl/bokeh_paper.wgsl"),
    include_str!("../../../wgsl/bokeh_layers.wgsl"),
    include_str!("../../../wgsl/bokeh_lens.wgsl"),
    include_str!("../../../wgsl/bokeh_passes.wgsl"),
);

/// The lines of `bokeh.wgsl` that a preset sets.
const SAMPLES: &str = "override BOKEH_NUM_SAMPLES: i32 = 9;";
const SPACING: &str = "override BOKEH_SPACING: f32 = 1.5;";

/// How finely lines are sampled: `bokeh.wgsl` has the numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BokehPreset {
    Low,
    #[default]
    Medium,
    High,
    Ultra,
}

/// Depth of field for every camera that has a [`Bokeh`]. Add it after `DefaultPlugins`.
#[derive(Default)]
pub struct BokehPlugin {
    pub preset: BokehPreset,
}

/// How the polygon is made: docs/methods/polygons.md.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BokehMethod {
    /// Two passes, all light is kept.
    #[default]
    Exact,
    /// The paper's three or four passes, combined by min.
    Paper,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BokehShape {
    #[default]
    Hexagon,
    Octagon,
}

/// What is shown in place of the result; the values are those of BokehDebugMode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// The lens of a camera. Lengths are in metres: one unit of the world is one metre.
///
/// Turns HDR on and multisampling off, since there is no linear depth of several samples.
#[derive(Component, ExtractComponent, Clone, Debug)]
#[require(Hdr)]
pub struct Bokeh {
    pub aperture_diameter: f32,
    pub focal_length: f32,
    /// Along the view axis, more than the focal length: see [`view_depth`].
    pub focus_distance: f32,
    pub sensor_height: f32,
    /// Largest circle of confusion, fraction of the image height.
    pub max_coc: f32,
    pub method: BokehMethod,
    pub shape: BokehShape,
    /// Of the polygon, radians.
    pub rotation: f32,
    pub debug: Option<BokehDebug>,
}

impl Default for Bokeh {
    fn default() -> Self {
        Self {
            aperture_diameter: 0.05,
            focal_length: 0.05,
            focus_distance: 5.0,
            sensor_height: 0.024,
            max_coc: 0.1,
            method: BokehMethod::Exact,
            shape: BokehShape::Hexagon,
            rotation: 0.0,
            debug: None,
        }
    }
}

impl Bokeh {
    /// The lens of a camera's vertical field of view (radians), at an f-stop. Smaller stops than those of real lenses blur
    /// more: docs/lens.md.
    pub fn with_lens(fov: f32, f_stop: f32) -> Self {
        let lens = Self::default();
        let focal_length = lens.sensor_height / (2.0 * (0.5 * fov).tan());
        Self { focal_length, aperture_diameter: focal_length / f_stop, ..lens }
    }

    /// Autofocus, once a frame of `dt` seconds: towards the nearest of these depths. 1 / distance goes the way, and `tau`
    /// is its time constant (docs/lens.md). An infinite `dt` is there at once.
    pub fn pull_focus(&mut self, dt: f32, depths: impl IntoIterator<Item = f32>, tau: f32) {
        let nearest = depths.into_iter().fold(f32::INFINITY, f32::min);
        let k = 1.0 - (-dt / tau).exp();
        self.focus_distance = 1.0 / ((1.0 - k) / self.focus_distance + k / nearest);
    }
}

/// Depth of a point of the world along a camera's view axis, metres: the focus distance at which it is sharp.
pub fn view_depth(camera: &GlobalTransform, point: Vec3) -> f32 {
    (point - camera.translation()).dot(*camera.forward())
}

/// The effect's place in [`Core3d`], for what wants to be before or after it.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct BokehSystems;

/// A view's textures, in the render world.
#[derive(Component)]
pub struct BokehTextures {
    /// Metres along the view axis, R32Float, written by [`BokehMethod::Paper`] only; may be copied from.
    pub depth: CachedTexture,
    coc: CachedTexture,
    a: CachedTexture,
    b: CachedTexture,
    c: CachedTexture,
}

impl Plugin for BokehPlugin {
    fn build(&self, app: &mut App) {
        let (samples, spacing) = match self.preset {
            BokehPreset::Low => (5, 2.0),
            BokehPreset::Medium => (9, 1.5),
            BokehPreset::High => (17, 1.0),
            BokehPreset::Ultra => (33, 1.0),
        };
        // Bevy hands no pipeline constants on to wgpu, so the overrides get their values here
        assert!(SHADERS.contains(SAMPLES) && SHADERS.contains(SPACING), "bokeh.wgsl has no {SAMPLES} {SPACING}");
        let source = SHADERS
            .replace(SAMPLES, &format!("override BOKEH_NUM_SAMPLES: i32 = {samples};"))
            .replace(SPACING, &format!("override BOKEH_SPACING: f32 = {spacing:?};"));
        let shader = Shader::from_wgsl(source, "bokeh_passes.wgsl");
        let shader = app.world_mut().resource_mut::<Assets<Shader>>().add(shader);
        app.add_plugins(ExtractComponentPlugin::<Bokeh>::default()).add_systems(PostUpdate, let_depth_be_read);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .insert_resource(BokehShader(shader))
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

fn let_depth_be_read(mut cameras: Query<(&mut Camera3d, &mut Msaa), Added<Bokeh>>) {
    for (mut camera, mut msaa) in &mut cameras {
        let usages = TextureUsages::from(camera.depth_texture_usages) | TextureUsages::TEXTURE_BINDING;
        camera.depth_texture_usages = usages.into();
        *msaa = Msaa::Off;
    }
}

/// What a pass reads and writes.
#[derive(Clone, Copy)]
enum Target {
    /// The camera's depth buffer.
    DeviceDepth,
    /// The same in metres, for the paper's method.
    Depth,
    /// The camera's image, as it comes.
    Scene,
    CoC,
    A,
    B,
    C,
    /// The camera's image, as it goes on.
    Result,
}
use Target::{A, B, C, CoC, Depth, DeviceDepth, Result as Out, Scene};

impl Target {
    fn format(self) -> TextureFormat {
        if matches!(self, Depth) { TextureFormat::R32Float } else { TextureFormat::Rgba16Float }
    }
}

/// One full-screen pass.
struct Pass {
    /// Of `bokeh_passes.wgsl`.
    entry: &'static str,
    /// Bound to BokehColorSamp, BokehColorSampB and BokehColorSampC.
    reads: &'static [Target],
    writes: &'static [Target],
    /// Degrees, beside the polygon's rotation.
    angle: f32,
}

const fn pass(entry: &'static str, reads: &'static [Target], writes: &'static [Target], angle: f32) -> Pass {
    Pass { entry, reads, writes, angle }
}

const LINEAR_DEPTH: &[Pass] = &[pass("BokehLinearDepth_PS", &[Scene], &[Depth], 0.0)];
// generated by validation/run port from frame/methods.py: begin
const EXACT_HEXAGON: &[Pass] = &[
    pass("BokehSignedCoCMap_PS", &[Scene], &[CoC], 0.0),
    pass("BokehHexagonFirst_PS", &[CoC], &[A, B], 0.0),
    pass("BokehHexagonSecond_PS", &[A, B], &[Out], 0.0),
];

const EXACT_OCTAGON: &[Pass] = &[
    pass("BokehSignedCoCMap_PS", &[Scene], &[CoC], 0.0),
    pass("BokehOctagonFirst_PS", &[CoC], &[A, B, C], 0.0),
    pass("BokehOctagonSecond_PS", &[A, B, C], &[Out], 0.0),
];

const PAPER_HEXAGON: &[Pass] = &[
    pass("BokehCoCMap_PS", &[Scene], &[CoC], 0.0),
    pass("BokehAdaptive_PS", &[CoC], &[A], 90.0),
    pass("BokehAdaptive_PS", &[A], &[B], 30.0),
    pass("BokehAdaptiveFinal_PS", &[A, B], &[Out], 150.0),
];

const PAPER_OCTAGON: &[Pass] = &[
    pass("BokehCoCMap_PS", &[Scene], &[CoC], 0.0),
    pass("BokehAdaptive_PS", &[CoC], &[A], 0.0),
    pass("BokehAdaptive_PS", &[A], &[B], 90.0),
    pass("BokehAdaptive_PS", &[CoC], &[A], 45.0),
    pass("BokehAdaptiveFinal_PS", &[A, B], &[Out], 135.0),
];
// generated by validation/run port from frame/methods.py: end
const DEBUG: &[Pass] =
    &[pass("BokehSignedCoCMap_PS", &[Scene], &[CoC], 0.0), pass("BokehDebug_PS", &[CoC], &[Out], 0.0)];

/// Of BokehDepthKind: 1 at the near plane, 0 at infinity.
const REVERSED_INFINITE: f32 = 3.0;

const ALL: [&[Pass]; 6] = [LINEAR_DEPTH, EXACT_HEXAGON, EXACT_OCTAGON, PAPER_HEXAGON, PAPER_OCTAGON, DEBUG];

impl Bokeh {
    fn passes(&self) -> impl Iterator<Item = &'static Pass> {
        let filter = match (self.debug, self.method, self.shape) {
            (Some(_), _, _) => DEBUG,
            (None, BokehMethod::Exact, BokehShape::Hexagon) => EXACT_HEXAGON,
            (None, BokehMethod::Exact, BokehShape::Octagon) => EXACT_OCTAGON,
            (None, BokehMethod::Paper, BokehShape::Hexagon) => PAPER_HEXAGON,
            (None, BokehMethod::Paper, BokehShape::Octagon) => PAPER_OCTAGON,
        };
        let metres = self.debug.is_none() && self.method == BokehMethod::Paper;
        if metres { LINEAR_DEPTH } else { &[] }.iter().chain(filter)
    }

    fn parameters(&self, size: UVec2, near: f32, pass: &Pass) -> BokehParameters {
        let size = size.as_vec2();
        BokehParameters {
            aperture_diameter: self.aperture_diameter,
            focal_length: self.focal_length,
            focus_distance: self.focus_distance,
            sensor_height: self.sensor_height,
            max_coc: self.max_coc,
            aspect_ratio: size.x / size.y,
            angle: pass.angle.to_radians() + self.rotation,
            bleeding_bias: 0.02,
            bleeding_mult: 30.0,
            blur_coc: 1.0,
            debug_mode: self.debug.map_or(0.0, |mode| mode as u32 as f32),
            line_length: 1.0,
            squeeze: 1.0,
            image_width: size.x,
            image_height: size.y,
            depth_kind: REVERSED_INFINITE,
            near,
            ..default()
        }
    }
}

/// The struct of the same name in `bokeh_passes.wgsl`; docs/reference/parameters.md has the units.
#[derive(ShaderType, Default)]
struct BokehParameters {
    // generated by validation/run port from shaders/parameters.py: begin
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
    // generated by validation/run port from shaders/parameters.py: end
}

#[derive(Resource)]
struct BokehShader(Handle<Shader>);

#[derive(Resource)]
struct BokehPipelines {
    layout: BindGroupLayoutDescriptor,
    linear: Sampler,
    by_entry: HashMap<&'static str, CachedRenderPipelineId>,
}

/// The parameters of every pass of every view.
#[derive(Resource, Default)]
struct BokehUniforms(DynamicUniformBuffer<BokehParameters>);

/// A view's passes, each with the place of its parameters in [`BokehUniforms`].
#[derive(Component)]
struct BokehPasses(Vec<(&'static Pass, u32)>);

fn create_pipelines(
    mut commands: Commands,
    shader: Res<BokehShader>,
    device: Res<RenderDevice>,
    cache: Res<PipelineCache>,
) {
    let color = || texture_2d(TextureSampleType::Float { filterable: true });
    let table = || texture_2d(TextureSampleType::Float { filterable: false });
    let layout = BindGroupLayoutDescriptor::new(
        "bokeh",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::FRAGMENT,
            (
                uniform_buffer::<BokehParameters>(true),
                color(),
                table(),
                color(),
                color(),
                color(),
                table(),
                sampler(SamplerBindingType::Filtering),
            ),
        ),
    );
    let mut by_entry = HashMap::default();
    for pass in ALL.iter().copied().flatten() {
        by_entry.entry(pass.entry).or_insert_with(|| {
            cache.queue_render_pipeline(RenderPipelineDescriptor {
                label: Some(pass.entry.into()),
                layout: vec![layout.clone()],
                vertex: VertexState {
                    shader: shader.0.clone(),
                    entry_point: Some("BokehFullScreen_VS".into()),
                    ..default()
                },
                fragment: Some(FragmentState {
                    shader: shader.0.clone(),
                    entry_point: Some(pass.entry.into()),
                    // without a blend state, since alpha is the circle of confusion
                    targets: pass.writes.iter().map(|target| Some(target.format().into())).collect(),
                    ..default()
                }),
                ..default()
            })
        });
    }
    commands.insert_resource(BokehPipelines {
        layout,
        linear: device.create_sampler(&SamplerDescriptor {
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            ..default()
        }),
        by_entry,
    });
}

fn prepare_bokeh(
    mut commands: Commands,
    views: Query<(Entity, &ExtractedCamera, &ExtractedView, &Bokeh)>,
    mut uniforms: ResMut<BokehUniforms>,
    mut textures: ResMut<TextureCache>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    uniforms.0.clear();
    for (entity, camera, view, bokeh) in &views {
        let Some(size) = camera.physical_target_size else {
            continue;
        };
        // Bevy's perspective projection has it there, whatever the camera is made of
        let near = view.clip_from_view.w_axis.z;
        let mut texture = |label, target: Target| {
            let descriptor = TextureDescriptor {
                label: Some(label),
                size: Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: target.format(),
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
                view_formats: &[],
            };
            textures.get(&device, descriptor)
        };
        let passes = bokeh.passes().map(|pass| (pass, uniforms.0.push(&bokeh.parameters(size, near, pass))));
        commands.entity(entity).insert((
            BokehPasses(passes.collect()),
            BokehTextures {
                depth: texture("bokeh depth", Depth),
                coc: texture("bokeh circle of confusion", CoC),
                a: texture("bokeh a", A),
                b: texture("bokeh b", B),
                c: texture("bokeh c", C),
            },
        ));
    }
    uniforms.0.write_buffer(&device, &queue);
}

type BokehView = (&'static ViewTarget, &'static ViewDepthTexture, &'static BokehTextures, &'static BokehPasses);

fn bokeh(
    view: ViewQuery<BokehView, With<Bokeh>>,
    pipelines: Res<BokehPipelines>,
    cache: Res<PipelineCache>,
    uniforms: Res<BokehUniforms>,
    mut context: RenderContext,
) {
    let (view_target, device_depth, textures, passes) = view.into_inner();
    // Nothing is drawn before every shader is compiled
    let ready: Option<Vec<_>> =
        passes.0.iter().map(|(pass, _)| cache.get_render_pipeline(pipelines.by_entry[pass.entry])).collect();
    let (Some(ready), Some(parameters)) = (ready, uniforms.0.binding()) else {
        return;
    };
    let image = view_target.post_process_write();
    let view_of = |target: Target| match target {
        DeviceDepth => device_depth.view(),
        Depth => &textures.depth.default_view,
        Scene => image.source,
        CoC => &textures.coc.default_view,
        A => &textures.a.default_view,
        B => &textures.b.default_view,
        C => &textures.c.default_view,
        Out => image.destination,
    };
    let layout = cache.get_bind_group_layout(&pipelines.layout);
    let mut depth = DeviceDepth;
    for ((pass, offset), pipeline) in passes.0.iter().zip(ready) {
        // A slot that the pass does not read needs a texture all the same
        let read = |slot: usize| view_of(*pass.reads.get(slot).unwrap_or(&pass.reads[0]));
        let bindings = context.render_device().create_bind_group(
            pass.entry,
            &layout,
            &BindGroupEntries::sequential((
                parameters.clone(),
                read(0),
                view_of(depth),
                read(1),
                read(2),
                read(0),
                read(0),
                &pipelines.linear,
            )),
        );
        let attachments: Vec<_> = pass
            .writes
            .iter()
            .map(|target| {
                Some(RenderPassColorAttachment {
                    view: view_of(*target),
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
        drop(render_pass);
        if matches!(pass.writes, [Depth]) {
            depth = Depth;
        }
    }
}
