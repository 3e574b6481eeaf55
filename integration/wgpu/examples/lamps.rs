use polygonal_bokeh::{Bokeh, Depth, Lens, Method, Polygon, Preset, images};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let adapter = pollster::block_on(wgpu::Instance::default().request_adapter(&Default::default()))?;
    let (device, queue) = &pollster::block_on(adapter.request_device(&Default::default()))?;
    // lamps of 3 x 3 pixels, 1 to 8 metres away, in front of a dark wall
    let (width, height) = (960, 540);
    let (mut color, mut metres) = (vec![[0.01, 0.01, 0.02, 1.0]; width * height], vec![20.0; width * height]);
    for i in 0..8 * 9 {
        let (lamp, x, y) = (i / 9, 120 * (i / 9) + 60 + i % 3, 270 + i / 3 % 3);
        color[y * width + x] = [40.0 + 30.0 * lamp as f32, 60.0, 250.0 - 30.0 * lamp as f32, 1.0];
        metres[y * width + x] = 1.0 + lamp as f32;
    }
    let (w, h) = (width as u32, height as u32);
    let (color, depth) = (images::color(device, queue, w, h, &color), images::depth(device, queue, w, h, &metres));
    let bokeh = Bokeh::new(device, Method::Layered, Polygon::Hexagon, Preset::Medium);
    let targets = bokeh.targets(device, &color, &depth)?;
    let mut encoder = device.create_command_encoder(&Default::default());
    let result = bokeh.render(queue, &mut encoder, &targets, &Lens::new(0.6, 4.0), Depth::Metres);
    queue.submit([encoder.finish()]);
    let mut png = png::Encoder::new(std::fs::File::create("lamps.png")?, w, h);
    png.set_color(png::ColorType::Rgba);
    Ok(png.write_header()?.write_image_data(&images::srgb(device, queue, result))?)
}
