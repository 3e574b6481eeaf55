// SPDX-License-Identifier: MIT

//! Draws the scene with each method and shape. Writes the colour and depth that the shaders read, and everything that
//! they wrote, into files. This is for `validation/run engines`; your game does not need it.

use bevy::{
    asset::RenderAssetUsages,
    camera::RenderTarget,
    core_pipeline::{Core3dSystems, schedule::Core3d},
    platform::collections::HashMap,
    prelude::*,
    render::{
        RenderApp,
        extract_resource::{ExtractResource, ExtractResourcePlugin},
        gpu_readback::{Readback, ReadbackComplete},
        render_asset::RenderAssets,
        render_resource::{
            Extent3d, TexelCopyBufferInfo, TexelCopyBufferLayout, Texture, TextureDimension, TextureFormat,
            TextureUsages,
        },
        renderer::{RenderAdapterInfo, RenderContext, ViewQuery},
        storage::{GpuShaderBuffer, ShaderBuffer},
        view::ViewTarget,
    },
};
use bokeh_bevy::{Bokeh, BokehDebug, BokehMethod, BokehPreset, BokehShape, BokehSystems, BokehTextures};
use std::{fs, path::PathBuf};

/// Sizes of the images. The widths are multiples of 256 pixels. In all targets, even in those of 1/8 size, a row is
/// then a multiple of 256 bytes, so the data that is read back has no gaps between rows.
const SMALL: UVec2 = UVec2::new(256, 172);
const SIZE: UVec2 = UVec2::new(512, 344);

/// Number of frames after which the data that is read back shows the new shot.
const FRAMES_PER_SHOT: u32 = 8;

/// Rotation of the shots whose names begin with "rotated", degrees clockwise.
const CLOCKWISE: f32 = 10.0;

/// The shots of a run: name, method, shape, preset, [`Msaa`] and size. The scene does not move, so the depth that the
/// shots of [`BokehMethod::Paper`] write is the depth of all shots of the same size.
const SHOTS: [(&str, BokehMethod, BokehShape, BokehPreset, Msaa, UVec2); 10] = [
    ("layered-small", BokehMethod::Layered, BokehShape::Hexagon, BokehPreset::Medium, Msaa::Off, SMALL),
    ("paper-small", BokehMethod::Paper, BokehShape::Hexagon, BokehPreset::Medium, Msaa::Off, SMALL),
    ("paper-hexagon", BokehMethod::Paper, BokehShape::Hexagon, BokehPreset::Medium, Msaa::Sample4, SIZE),
    ("paper-octagon", BokehMethod::Paper, BokehShape::Octagon, BokehPreset::Medium, Msaa::Sample4, SIZE),
    ("exact-octagon", BokehMethod::Exact, BokehShape::Octagon, BokehPreset::Medium, Msaa::Sample4, SIZE),
    ("exact-hexagon", BokehMethod::Exact, BokehShape::Hexagon, BokehPreset::Medium, Msaa::Sample4, SIZE),
    ("rotated-exact", BokehMethod::Exact, BokehShape::Square, BokehPreset::Medium, Msaa::Off, SMALL),
    ("rotated-paper", BokehMethod::Paper, BokehShape::Hexagon, BokehPreset::Medium, Msaa::Off, SMALL),
    ("layered-octagon", BokehMethod::Layered, BokehShape::Octagon, BokehPreset::High, Msaa::Sample4, SIZE),
    ("layered-hexagon", BokehMethod::Layered, BokehShape::Hexagon, BokehPreset::Medium, Msaa::Sample4, SIZE),
];

pub struct CapturePlugin {
    pub folder: PathBuf,
}

#[derive(Resource)]
struct Folder(PathBuf);

/// The image that the camera draws to.
#[derive(Resource)]
struct Picture(Handle<Image>);

/// The buffer to which the camera's image and the targets are copied, so that they can be read back.
#[derive(Resource, ExtractResource, Clone)]
#[extract_app(RenderApp)]
struct Copies(Handle<ShaderBuffer>);

/// The data that was read back last, by name.
#[derive(Resource, Default)]
struct Latest(HashMap<&'static str, Vec<u8>>);

impl Plugin for CapturePlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Folder(self.folder.clone()))
            .init_resource::<Latest>()
            .add_plugins(ExtractResourcePlugin::<Copies>::default())
            .add_systems(PostStartup, prepare)
            .add_systems(Last, next_shot);
        app.sub_app_mut(RenderApp).add_systems(
            Core3d,
            (
                copy_color.after(Core3dSystems::EarlyPostProcess).before(BokehSystems),
                copy_written.after(BokehSystems).before(Core3dSystems::PostProcess),
            ),
        );
    }
}

fn prepare(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    camera: Single<Entity, With<Bokeh>>,
) {
    let mut picture = Image::new_target_texture(SMALL.x, SMALL.y, TextureFormat::Rgba8UnormSrgb, None);
    picture.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let picture = images.add(picture);
    let copies = buffers.add(ShaderBuffer::with_size((7 * texels(SIZE, 1) * 8) as u64, RenderAssetUsages::default()));
    for (name, readback) in
        [("picture", Readback::texture(picture.clone())), ("copies", Readback::buffer(copies.clone()))]
    {
        commands.spawn(readback).observe(move |read: On<ReadbackComplete>, mut latest: ResMut<Latest>| {
            latest.0.insert(name, read.data.clone());
        });
    }
    commands.entity(*camera).insert(RenderTarget::Image(picture.clone().into()));
    commands.insert_resource(Picture(picture));
    commands.insert_resource(Copies(copies));
}

/// Returns the number of texels of a target.
fn texels(size: UVec2, scale: u32) -> usize {
    (size.x.div_ceil(scale) * size.y.div_ceil(scale)) as usize
}

/// Copies textures to a buffer, one after the other, beginning at `offset` bytes.
fn copy<'a>(
    context: &mut RenderContext,
    from: impl Iterator<Item = &'a Texture>,
    to: &GpuShaderBuffer,
    mut offset: u64,
) {
    for texture in from {
        let bytes_per_row = texture.width() * texture.format().block_copy_size(None).unwrap();
        let layout = TexelCopyBufferLayout { offset, bytes_per_row: Some(bytes_per_row), rows_per_image: None };
        let place = TexelCopyBufferInfo { buffer: &to.buffer, layout };
        context.command_encoder().copy_texture_to_buffer(texture.as_image_copy(), place, texture.size());
        offset += u64::from(bytes_per_row * texture.height());
    }
}

fn copy_color(
    view: ViewQuery<&ViewTarget, With<Bokeh>>,
    copies: Res<Copies>,
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
    mut context: RenderContext,
) {
    if let Some(to) = buffers.get(&copies.0) {
        copy(&mut context, std::iter::once(view.into_inner().main_texture()), to, 0);
    }
}

/// Copies all targets to the buffer, after the colour, in the order of the passes.
fn copy_written(
    view: ViewQuery<(&ViewTarget, &BokehTextures), With<Bokeh>>,
    copies: Res<Copies>,
    buffers: Res<RenderAssets<GpuShaderBuffer>>,
    mut context: RenderContext,
) {
    let (target, textures) = view.into_inner();
    if let Some(to) = buffers.get(&copies.0) {
        let result = target.main_texture();
        let targets = textures.0.iter().map(|(_, target)| &target.texture).chain([result]);
        copy(&mut context, targets, to, u64::from(result.width() * result.height() * 8));
    }
}

/// Writes the files of the current shot, then goes on to the next one. After the shots come a debug view and a frame
/// without blur.
fn next_shot(
    mut frame: Local<u32>,
    camera: Single<(&mut Bokeh, &mut Msaa)>,
    mut images: ResMut<Assets<Image>>,
    (picture, latest, folder): (Res<Picture>, Res<Latest>, Res<Folder>),
    adapter: Res<RenderAdapterInfo>,
    mut exit: MessageWriter<AppExit>,
) {
    let (mut bokeh, mut msaa) = camera.into_inner();
    let shot = (*frame / FRAMES_PER_SHOT) as usize;
    if frame.is_multiple_of(FRAMES_PER_SHOT) {
        if let Some((name, method, shape, preset, samples, size)) = SHOTS.get(shot) {
            (bokeh.method, bokeh.shape, bokeh.preset, *msaa) = (*method, *shape, *preset, *samples);
            bokeh.rotation = if name.starts_with("rotated") { CLOCKWISE.to_radians() } else { 0.0 };
            images.get_mut(&picture.0).unwrap().resize(extent(*size));
        } else if shot == SHOTS.len() {
            bokeh.debug = Some(BokehDebug::Focus);
        } else {
            bokeh.debug = None;
            bokeh.aperture_diameter = Bokeh::with_lens(0.5, 2.8, 0.0).aperture_diameter;
        }
    }
    *frame += 1;
    if !frame.is_multiple_of(FRAMES_PER_SHOT) {
        return;
    }
    let write = |name: String, bytes: &[u8]| fs::write(folder.0.join(name), bytes).expect("cannot write to the folder");
    let Some((name, method, .., size)) = SHOTS.get(shot) else {
        if shot == SHOTS.len() {
            save(&latest.0["picture"], folder.0.join("debug.png"));
            write("capture.json".into(), description(&bokeh, &adapter).as_bytes());
        } else {
            // the scene has an alpha of 1; if a pass had run, alpha would be the circle of confusion
            let (color, targets) = read_back(&latest.0["copies"], &bokeh, SIZE);
            assert!(targets.ends_with(color), "a bokeh scale of 0 changes the image");
            exit.write(AppExit::Success);
        }
        return;
    };
    let (color, targets) = read_back(&latest.0["copies"], &bokeh, *size);
    write(format!("color-{}.f16", size.x), color);
    let (metres, written) = targets.split_at(if *method == BokehMethod::Paper { texels(*size, 1) * 4 } else { 0 });
    if !metres.is_empty() {
        write(format!("depth-{}.f32", size.x), metres);
    }
    write(format!("{name}.written"), written);
    write(format!("{name}.f16"), &targets[targets.len() - color.len()..]);
    save(&latest.0["picture"], folder.0.join("picture.png"));
}

/// Returns the camera's image, and everything that the passes wrote; the result comes last.
fn read_back<'a>(copies: &'a [u8], bokeh: &Bokeh, size: UVec2) -> (&'a [u8], &'a [u8]) {
    let bytes = |name: &&str, scale| texels(size, scale) * if *name == "metres" { 4 } else { 8 };
    let written = bokeh.passes().flat_map(|pass| pass.writes.iter().map(|name| bytes(name, pass.scale))).sum();
    let (color, targets) = copies.split_at(texels(size, 1) * 8);
    (color, &targets[..written])
}

fn extent(size: UVec2) -> Extent3d {
    Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 }
}

fn save(pixels: &[u8], path: PathBuf) {
    let size = if pixels.len() == texels(SIZE, 1) * 4 { SIZE } else { SMALL };
    let (shape, format, usages) = (TextureDimension::D2, TextureFormat::Rgba8UnormSrgb, RenderAssetUsages::MAIN_WORLD);
    let image = Image::new(extent(size), shape, pixels.to_vec(), format, usages);
    image.try_into_dynamic().unwrap().to_rgb8().save(path).expect("cannot write to the folder");
}

/// Returns the text of capture.json. validation/engines/capture.py describes the format.
fn description(bokeh: &Bokeh, adapter: &RenderAdapterInfo) -> String {
    let shots = SHOTS.map(|(name, method, shape, preset, _, UVec2 { x, y })| {
        // capture.json has no preset for paper: write the values of MEDIUM instead
        let more = if method == BokehMethod::Paper {
            r#""spacing": 1.5, "samples": 9"#.into()
        } else {
            format!(r#""preset": "{preset:?}""#)
        };
        let more = if name.starts_with("rotated") { format!(r#"{more}, "clockwise": {CLOCKWISE}"#) } else { more };
        format!(
            r#"{{"name": "{name}", "method": "{method:?}", "aperture": "{shape:?}", {more}, "width": {x}, "height": {y},
"color": "color-{x}.f16", "depth": "depth-{x}.f32", "result": "{name}.f16", "written": "{name}.written"}}"#
        )
        .to_lowercase()
    });
    format!(
        r#"{{"engine": "Bevy 0.20.1, {:?}", "device": "{}, {}",
"camera": {{"aperture_diameter": {}, "focal_length": {}, "focus_distance": {}, "sensor_height": {}, "max_coc": {}}},
"pull": {},
"shots": [
{}
]}}
"#,
        adapter.backend,
        adapter.name,
        adapter.driver_info,
        bokeh.aperture_diameter,
        bokeh.focal_length,
        bokeh.focus_distance,
        bokeh.sensor_height,
        bokeh.max_coc,
        pulled(bokeh),
        shots.join(",\n")
    )
}

/// Returns the focus distances of an autofocus on two depths, frame by frame, as JSON.
fn pulled(bokeh: &Bokeh) -> String {
    let (frame, seconds, depths) = (1.0 / 30.0, 0.2, [7.0, 2.2]);
    let mut pulled = bokeh.clone();
    let distances: Vec<f32> = (0..12)
        .map(|_| {
            pulled.pull_focus(frame, depths, seconds);
            pulled.focus_distance
        })
        .collect();
    format!(
        r#"{{"frame": {frame:?}, "seconds": {seconds:?}, "from": {}, "depths": {depths:?}, "distances": {distances:?}}}"#,
        bokeh.focus_distance
    )
}
