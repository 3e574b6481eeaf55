// SPDX-License-Identifier: MIT

//! A minimal game. Copy it into a project of your own to run it: this crate builds Bevy without support for windows.

use bevy::prelude::*;
use bokeh_bevy::{Bokeh, BokehPlugin};

fn main() {
    App::new().add_plugins((DefaultPlugins, BokehPlugin)).add_systems(Startup, setup).run();
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let fov = 45.0_f32.to_radians();
    commands.spawn((
        Camera3d::default(),
        Projection::from(PerspectiveProjection { fov, ..default() }),
        Transform::from_xyz(0.0, 1.0, 5.0).looking_at(Vec3::Y, Vec3::Y),
        // f/2.8 with a bokeh scale of 28: a strong blur, to see it at once
        Bokeh { focus_distance: 5.0, ..Bokeh::with_lens(fov, 2.8, 28.0) },
    ));
    commands
        .spawn((DirectionalLight::default(), Transform::default().looking_to(Vec3::new(-0.5, -0.7, -1.0), Vec3::Y)));
    // One cube is in focus, one is in front of it, and the others are behind it
    let cube = meshes.add(Cuboid::default());
    for step in -1..8 {
        let material = MeshMaterial3d(materials.add(Color::hsl(40.0 * (step + 1) as f32, 0.8, 0.5)));
        let place = Transform::from_xyz(1.1 * step as f32, 0.7, -2.0 * step as f32);
        commands.spawn((Mesh3d(cube.clone()), material, place));
    }
}
