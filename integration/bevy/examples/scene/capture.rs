// SPDX-License-Identifier: MIT

//! Draws the scene by each method and shape and leaves the camera's image and its depth as the shaders read them, and
//! their results, in files. For validation/run; a game needs nothing of this.

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
        render_resource::{Extent3d, Texture, TextureDimension, TextureFormat, TextureUsages},
        renderer::{RenderAdapterInfo, RenderContext, ViewQuery},
        texture::GpuImage,
        view::ViewTarget,
    },
};
use bokeh_bevy::{Bokeh, BokehDebug, BokehMethod, BokehShape, BokehSystems, BokehTextures};
use std::{fs, path::PathBuf};

/// A row of 4-byte pixels is a multiple of 256 bytes, so rows are read back without gaps.
const WIDTH: u32 = 384;
const HEIGHT: u32 = 256;

/// Frames until what is read back is the new shot.
const FRAMES_PER_SHOT: u32 = 12;

const SHOTS: [(&str, BokehMethod, BokehShape); 4] = [
    ("paper-hexagon", BokehMethod::Paper, BokehShape::Hexagon),
    ("paper-octagon", BokehMethod::Paper, BokehShape::Octagon),
    ("exact-octagon", BokehMethod::Exact, BokehShape::Octagon),
    ("exact-hexagon", BokehMethod::Exact, BokehShape::Hexagon),
];

pub struct CapturePlugin {
    pub folder: PathBuf,
}

#[derive(Resource)]
struct Folder(PathBuf);

/// Images that the camera's own are copied to, so that they can be read back.
#[derive(Resource, ExtractResource, Clone)]
struct Copies {
    color: Handle<Image>,
    depth: Handle<Image>,
    result: Handle<Image>,
}

/// What was read back last, by name.
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
                copy_result.after(BokehSystems).before(Core3dSystems::PostProcess),
            ),
        );
    }
}

fn prepare(mut commands: Commands, mut images: ResMut<Assets<Image>>, camera: Single<Entity, With<Bokeh>>) {
    let mut image = |name: &'static str, format| {
        let mut image = Image::new_target_texture(WIDTH, HEIGHT, format, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let handle = images.add(image);
        commands.spawn(Readback::texture(handle.clone())).observe(
            move |read: On<ReadbackComplete>, mut latest: ResMut<Latest>| {
                latest.0.insert(name, read.data.clone());
            },
        );
        handle
    };
    let copies = Copies {
        color: image("color", TextureFormat::Rgba16Float),
        depth: image("depth", TextureFormat::R32Float),
        result: image("result", TextureFormat::Rgba16Float),
    };
    let picture = image("picture", TextureFormat::Rgba8UnormSrgb);
    commands.insert_resource(copies);
    commands.entity(*camera).insert(RenderTarget::Image(picture.into()));
}

fn copy(context: &mut RenderContext, from: &Texture, to: Option<&GpuImage>) {
    if let Some(to) = to {
        let (from, size) = (from.as_image_copy(), to.texture.size());
        context.command_encoder().copy_texture_to_texture(from, to.texture.as_image_copy(), size);
    }
}

fn copy_color(
    view: ViewQuery<&ViewTarget, With<Bokeh>>,
    copies: Res<Copies>,
    images: Res<RenderAssets<GpuImage>>,
    mut context: RenderContext,
) {
    copy(&mut context, view.into_inner().main_texture(), images.get(&copies.color));
}

fn copy_result(
    view: ViewQuery<(&ViewTarget, &BokehTextures), With<Bokeh>>,
    copies: Res<Copies>,
    images: Res<RenderAssets<GpuImage>>,
    mut context: RenderContext,
) {
    let (target, textures) = view.into_inner();
    copy(&mut context, target.main_texture(), images.get(&copies.result));
    copy(&mut context, &textures.depth.texture, images.get(&copies.depth));
}

/// Keep what the shot has drawn, then go on to the next one; the debug view is the last.
fn next_shot(
    mut frame: Local<u32>,
    mut camera: Single<&mut Bokeh>,
    latest: Res<Latest>,
    folder: Res<Folder>,
    adapter: Res<RenderAdapterInfo>,
    mut exit: MessageWriter<AppExit>,
) {
    let shot = (*frame / FRAMES_PER_SHOT) as usize;
    if frame.is_multiple_of(FRAMES_PER_SHOT) {
        if let Some((_, method, shape)) = SHOTS.get(shot) {
            (camera.method, camera.shape) = (*method, *shape);
        } else {
            camera.debug = Some(BokehDebug::Focus);
        }
    }
    *frame += 1;
    if !frame.is_multiple_of(FRAMES_PER_SHOT) {
        return;
    }
    let write =
        |name: String, bytes: &[u8]| fs::write(folder.0.join(name), bytes).expect("the folder can be written to");
    if let Some((name, method, _)) = SHOTS.get(shot) {
        write("color.f16".into(), &latest.0["color"]);
        // only this method makes metres; nothing in the scene moves
        if *method == BokehMethod::Paper {
            write("depth.f32".into(), &latest.0["depth"]);
        }
        write(format!("{name}.f16"), &latest.0["result"]);
        save(&latest.0["picture"], folder.0.join("picture.png"));
    } else {
        save(&latest.0["picture"], folder.0.join("debug.png"));
        write("capture.json".into(), description(&camera, &adapter).as_bytes());
        exit.write(AppExit::Success);
    }
}

fn save(pixels: &[u8], path: PathBuf) {
    let size = Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba8UnormSrgb;
    let image = Image::new(size, TextureDimension::D2, pixels.to_vec(), format, RenderAssetUsages::MAIN_WORLD);
    image.try_into_dynamic().unwrap().to_rgb8().save(path).expect("the folder can be written to");
}

/// capture.json: validation/bokeh_validation/engines/capture.py has its format.
fn description(bokeh: &Bokeh, adapter: &RenderAdapterInfo) -> String {
    let shots = SHOTS.map(|(name, method, shape)| {
        let (method, shape) = (format!("{method:?}").to_lowercase(), format!("{shape:?}").to_lowercase());
        // what the preset stands for
        let adaptive = if method == "paper" { r#", "spacing": 1.5, "samples": 9"# } else { "" };
        format!(
            r#"{{"name": "{name}", "method": "{method}", "aperture": "{shape}", "result": "{name}.f16"{adaptive}}}"#
        )
    });
    format!(
        r#"{{"engine": "Bevy 0.19.1, {:?}", "device": "{}, {}", "width": {WIDTH}, "height": {HEIGHT},
"color": "color.f16", "depth": "depth.f32",
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

/// The autofocus, frame by frame, on two depths.
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
