// SPDX-License-Identifier: MIT

//! A tower of blocks in focus, with lamps in front of it and behind it. `cargo run --example scene -- FOLDER` draws the
//! scene without a window. It writes picture.png, debug.png and everything that the shaders read and wrote into FOLDER.

mod capture;

use bevy::{
    app::ScheduleRunnerPlugin, core_pipeline::tonemapping::Tonemapping, prelude::*, render::RenderPlugin,
    window::ExitCondition,
};
use bokeh_bevy::{Bokeh, BokehPlugin, view_depth};
use capture::CapturePlugin;
use std::time::Duration;

/// Marks an object that the camera focuses on.
#[derive(Component)]
struct Subject;

fn main() -> AppExit {
    let no_window = WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
    let all_shaders_first = RenderPlugin { synchronous_pipeline_compilation: true, ..default() };
    let mut app = App::new();
    app.add_plugins(DefaultPlugins.set(no_window).set(all_shaders_first))
        .add_plugins(ScheduleRunnerPlugin::run_loop(Duration::ZERO))
        .add_plugins(BokehPlugin)
        .add_systems(Startup, setup)
        .add_systems(PostUpdate, focus_on_subjects.after(TransformSystems::Propagate));
    app.add_plugins(CapturePlugin { folder: std::env::args_os().nth(1).unwrap_or(".".into()).into() });
    app.run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    // Vertical field of view of a 50 mm lens on a sensor that is 24 mm high
    let fov = 2.0 * (0.012_f32 / 0.05).atan();
    commands.spawn((
        Camera3d::default(),
        Camera { clear_color: Color::linear_rgb(0.006, 0.01, 0.03).into(), ..default() },
        Projection::from(PerspectiveProjection { fov, ..default() }),
        Tonemapping::AcesFitted,
        Transform::from_xyz(0.0, 1.5, 0.0).looking_at(Vec3::new(0.0, 1.2, -6.0), Vec3::Y),
        // f/1 with a bokeh scale of 5: a strong blur, because the picture is small
        Bokeh::with_lens(fov, 1.0, 5.0),
    ));
    commands.spawn((
        DirectionalLight { illuminance: 5000.0, color: Color::srgb(0.85, 0.9, 1.0), ..default() },
        Transform::default().looking_to(Vec3::new(-0.5, -0.7, -1.0), Vec3::Y),
    ));

    // The tower, 6 m away: four blocks, each rotated a little more than the one below it
    let block = meshes.add(Cuboid::from_length(0.55));
    for (level, color) in [0xE0_5A_3C_u32, 0xF0_C0_50, 0x4C_A0_90, 0xEC_E8_DC].into_iter().enumerate() {
        let mut block = commands.spawn((
            Mesh3d(block.clone()),
            MeshMaterial3d(materials.add(Color::srgb_u8((color >> 16) as u8, (color >> 8) as u8, color as u8))),
            Transform::from_xyz(0.0, 0.275 + 0.55 * level as f32, -6.0)
                .with_rotation(Quat::from_rotation_y(0.3 + 0.5 * level as f32)),
        ));
        if level == 2 {
            block.insert(Subject);
        }
    }

    // The lamps are much brighter than white, so their blur is visible as polygons
    let lamp = meshes.add(Sphere::new(1.0));
    let mut spawn_lamp = |place: Vec3, radius: f32, color: LinearRgba| {
        commands.spawn((
            Mesh3d(lamp.clone()),
            MeshMaterial3d(materials.add(StandardMaterial { base_color: color.into(), unlit: true, ..default() })),
            Transform::from_translation(place).with_scale(Vec3::splat(radius)),
        ));
    };
    let amber = LinearRgba::rgb(24.0, 11.0, 3.0);
    let colors =
        [amber, LinearRgba::rgb(5.0, 12.0, 22.0), LinearRgba::rgb(22.0, 4.0, 6.0), LinearRgba::rgb(6.0, 18.0, 8.0)];
    for index in 0..20 {
        let (step, distance) = (index as f32, 18.0 + 1.2 * index as f32);
        let x = 0.33 * distance * (2.4 * step).sin();
        let y = 1.5 + distance * (0.01 + 0.15 * (0.382 * step).fract());
        spawn_lamp(Vec3::new(x, y, -distance), 0.004 * distance, colors[index % colors.len()]);
    }
    for x in [-0.62, 0.68] {
        spawn_lamp(Vec3::new(x, 1.7, -2.2), 0.012, amber);
    }

    // The floor, in tiles of 1 m
    let tile = meshes.add(Plane3d::default().mesh().size(1.0, 1.0));
    let shades = [0.30, 0.05].map(|grey| {
        materials.add(StandardMaterial {
            base_color: Color::linear_rgb(grey, grey, grey),
            perceptual_roughness: 0.9,
            ..default()
        })
    });
    for x in -12..12_i32 {
        for z in 1..40_i32 {
            commands.spawn((
                Mesh3d(tile.clone()),
                MeshMaterial3d(shades[(x + z).rem_euclid(2) as usize].clone()),
                Transform::from_xyz(x as f32 + 0.5, 0.0, -z as f32),
            ));
        }
    }
}

/// Moves the focus smoothly to the nearest subject, also if the subjects or the camera move. In the first frame, the
/// focus jumps there.
fn focus_on_subjects(
    subjects: Query<&GlobalTransform, With<Subject>>,
    camera: Single<(&GlobalTransform, &mut Bokeh)>,
    time: Res<Time>,
) {
    let (transform, mut bokeh) = camera.into_inner();
    let depths = subjects.iter().map(|subject| view_depth(transform, subject.translation()));
    let dt = if time.elapsed_secs() > 0.0 { time.delta_secs() } else { f32::INFINITY };
    bokeh.pull_focus(dt, depths, 0.2);
}
