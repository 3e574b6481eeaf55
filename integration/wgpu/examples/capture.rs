// SPDX-License-Identifier: MIT

//! Draws the scene in a folder with each method. Writes the results and everything that the passes wrote into the same
//! folder. This is for `validation/run engines wgpu`; your program does not need it.

use polygonal_bokeh::{Bokeh, Depth, Lens, Method, Polygon, Preset, images};
use std::{env, error::Error, fs, path::Path};
use wgpu::*;

/// The shots: name, method, polygon, preset, and rotation in degrees clockwise.
const SHOTS: [(&str, Method, Polygon, Preset, f32); 7] = [
    ("layered-hexagon", Method::Layered, Polygon::Hexagon, Preset::Medium, 0.0),
    ("layered-square", Method::Layered, Polygon::Square, Preset::Low, 0.0),
    ("layered-octagon", Method::Layered, Polygon::Octagon, Preset::High, 0.0),
    ("exact-octagon", Method::Exact, Polygon::Octagon, Preset::High, 0.0),
    ("exact-decagon", Method::Exact, Polygon::Decagon, Preset::Medium, 0.0),
    ("exact-square-rotated", Method::Exact, Polygon::Square, Preset::Medium, 10.0),
    ("exact-hexagon", Method::Exact, Polygon::Hexagon, Preset::Medium, 0.0),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args().nth(1).ok_or("pass the folder of the scene as an argument")?;
    let folder = Path::new(&folder);
    let adapter = pollster::block_on(Instance::default().request_adapter(&Default::default()))?;
    let (device, queue) = &pollster::block_on(adapter.request_device(&Default::default()))?;
    let camera = fs::read_to_string(folder.join("camera.txt"))?;
    let numbers: Vec<f32> = camera.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    let [width, height, aperture, focal_length, focus_distance, max_coc, near, far] = numbers[..] else {
        return Err("camera.txt must contain eight numbers".into());
    };
    let lens = Lens {
        f_stop: focal_length / aperture,
        bokeh_scale: 1.0,
        max_coc,
        ..Lens::new(2.0 * (0.012 / focal_length).atan(), focus_distance)
    };
    let (width, height) = (width as u32, height as u32);
    let color = uploaded(device, queue, width, height, TextureFormat::Rgba16Float, &folder.join("color.f16"))?;
    let depth = uploaded(device, queue, width, height, TextureFormat::R32Float, &folder.join("depth.f32"))?;
    let mut shots = Vec::new();
    for (name, method, polygon, preset, clockwise) in SHOTS {
        let lens = Lens { rotation: clockwise.to_radians(), ..lens };
        let bokeh = Bokeh::new(device, method, polygon, preset);
        let targets = bokeh.targets(device, &color, &depth)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut written = Vec::new();
        let mut keep = |encoder: &mut CommandEncoder, views: &[TextureView]| {
            written.extend(views.iter().map(|view| copied(device, encoder, view.texture())));
        };
        let planes = Depth::Standard { near, far };
        let result = bokeh.render_observed(queue, &mut encoder, &targets, &lens, planes, &mut keep);
        queue.submit([encoder.finish()]);
        fs::write(folder.join(format!("{name}.f16")), images::bytes(device, queue, result))?;
        let bytes: Vec<u8> = written.iter().flat_map(|texture| images::bytes(device, queue, texture)).collect();
        fs::write(folder.join(format!("{name}.written")), bytes)?;
        let keys = [
            format!(r#""name": "{name}", "result": "{name}.f16", "written": "{name}.written""#),
            format!(r#""method": "{}", "aperture": "{}""#, word(method), word(polygon)),
            format!(r#""preset": "{}", "clockwise": {clockwise}"#, word(preset)),
        ];
        shots.push(format!("{{{}}}", keys.join(", ")));
    }
    let camera = [
        format!(r#""aperture_diameter": {}, "focal_length": {}"#, lens.aperture_diameter(), lens.focal_length()),
        format!(r#""focus_distance": {focus_distance}, "sensor_height": {}"#, lens.sensor_height),
        format!(r#""max_coc": {max_coc}"#),
    ];
    let mut pulled = Lens { focus_distance: 40.0, ..lens };
    let (dt, tau) = (1.0 / 30.0, 0.2);
    let mut distances = Vec::new();
    for _ in 0..12 {
        pulled.pull_focus(dt, [7.0, 3.0, 250.0], tau);
        distances.push(pulled.focus_distance);
    }
    let pull = format!(
        r#""frame": {dt}, "seconds": {tau}, "from": 40.0, "depths": [7.0, 3.0, 250.0], "distances": {distances:?}"#
    );
    let capture = [
        format!(r#""engine": "wgpu", "device": "{}", "width": {width}, "height": {height}"#, adapter.get_info().name),
        r#""color": "color.f16", "depth": "depth.f32""#.to_string(),
        format!(r#""stored": {{"kind": 1, "near": {near}, "far": {far}}}"#),
        format!(r#""camera": {{{}}}"#, camera.join(", ")),
        format!(r#""pull": {{{pull}}}"#),
        format!(r#""shots": [{}]"#, shots.join(", ")),
    ];
    Ok(fs::write(folder.join("capture.json"), format!("{{{}}}", capture.join(", ")))?)
}

fn word(value: impl std::fmt::Debug) -> String {
    format!("{value:?}").to_lowercase()
}

fn empty(device: &Device, size: Extent3d, format: TextureFormat, usage: TextureUsages) -> Texture {
    device.create_texture(&TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn uploaded(
    device: &Device,
    queue: &Queue,
    width: u32,
    height: u32,
    format: TextureFormat,
    file: &Path,
) -> Result<Texture, Box<dyn Error>> {
    let size = Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = empty(device, size, format, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let data = fs::read(file)?;
    let row = Some(data.len() as u32 / height);
    let layout = TexelCopyBufferLayout { offset: 0, bytes_per_row: row, rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), &data, layout, texture.size());
    Ok(texture)
}

/// Records a copy of a texture, and returns the texture that will hold the copy.
fn copied(device: &Device, encoder: &mut CommandEncoder, texture: &Texture) -> Texture {
    let usage = TextureUsages::COPY_DST | TextureUsages::COPY_SRC;
    let copy = empty(device, texture.size(), texture.format(), usage);
    encoder.copy_texture_to_texture(texture.as_image_copy(), copy.as_image_copy(), texture.size());
    copy
}
