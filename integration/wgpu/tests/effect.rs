// SPDX-License-Identifier: MIT

//! Draws frames to test what the crate promises. `validation/run engines wgpu` compares its images with the reference.

use polygonal_bokeh::*;
use wgpu::*;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 64;
const PLANES: Depth = Depth::Standard { near: 0.5, far: 100.0 };

struct Gpu(Device, Queue);

fn gpu() -> Gpu {
    let adapter = pollster::block_on(Instance::default().request_adapter(&Default::default())).unwrap();
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default())).unwrap();
    Gpu(device, queue)
}

fn lens() -> Lens {
    Lens { f_stop: 1.0, ..Lens::new(0.5, 2.0) }
}

/// Creates a colour texture, dark except for a grid of bright pixels. `x` and `y` move the grid, in pixels.
fn color(gpu: &Gpu, width: u32, height: u32, x: u32, y: u32) -> Texture {
    let bright = |i: u32| {
        let (column, row) = (i32_of(i % width) - i32_of(x), i32_of(i / width) - i32_of(y));
        column.rem_euclid(23) == 5 && row.rem_euclid(19) == 7
    };
    let pixels: Vec<_> =
        (0..width * height).map(|i| if bright(i) { [40.0, 20.0, 9.0, 1.0] } else { [0.1, 0.2, 0.3, 1.0] }).collect();
    images::color(&gpu.0, &gpu.1, width, height, &pixels)
}

fn i32_of(value: u32) -> i32 {
    value.try_into().unwrap()
}

fn depth(gpu: &Gpu, width: u32, height: u32, stored: f32) -> Texture {
    images::depth(&gpu.0, &gpu.1, width, height, &vec![stored; (width * height) as usize])
}

/// Draws a frame, and returns its pixels: red, green, blue and alpha as half floats.
fn drawn(gpu: &Gpu, bokeh: &Bokeh, color: &Texture, depth: &Texture, lens: &Lens, planes: Depth) -> Vec<u8> {
    let targets = bokeh.targets(&gpu.0, color, depth).unwrap();
    let mut encoder = gpu.0.create_command_encoder(&Default::default());
    let result = bokeh.render(&gpu.1, &mut encoder, &targets, lens, planes);
    gpu.1.submit([encoder.finish()]);
    images::bytes(&gpu.0, &gpu.1, result)
}

const DRAWABLE: TextureUsages = TextureUsages::RENDER_ATTACHMENT;
const READABLE: TextureUsages = TextureUsages::TEXTURE_BINDING;

fn empty(gpu: &Gpu, format: TextureFormat, usage: TextureUsages, sample_count: u32) -> Texture {
    gpu.0.create_texture(&TextureDescriptor {
        label: None,
        size: Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn depth_buffer(gpu: &Gpu, samples: u32, stored: f32) -> Texture {
    let texture = empty(gpu, TextureFormat::Depth32Float, DRAWABLE | READABLE, samples);
    let mut encoder = gpu.0.create_command_encoder(&Default::default());
    encoder.begin_render_pass(&RenderPassDescriptor {
        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
            view: &texture.create_view(&Default::default()),
            depth_ops: Some(Operations { load: LoadOp::Clear(stored), store: StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    gpu.1.submit([encoder.finish()]);
    texture
}

#[test]
fn every_method_and_polygon_draws_its_own_picture() {
    let gpu = gpu();
    let (color, depth) = (color(&gpu, WIDTH, HEIGHT, 0, 0), depth(&gpu, WIDTH, HEIGHT, 0.97));
    // a blur so wide that the presets place their samples differently
    let wide = Lens { f_stop: 0.2, max_coc: 0.9, ..lens() };
    let mut seen = std::collections::HashSet::new();
    for method in [Method::Layered, Method::Exact] {
        for polygon in [Polygon::Square, Polygon::Hexagon, Polygon::Octagon, Polygon::Decagon] {
            for preset in [Preset::Mobile, Preset::Low, Preset::Ultra] {
                if method == Method::Exact && preset == Preset::Mobile {
                    continue; // for Exact, Mobile is the same as Low
                }
                let bokeh = Bokeh::new(&gpu.0, method, polygon, preset);
                let picture = drawn(&gpu, &bokeh, &color, &depth, &wide, PLANES);
                assert!(seen.insert(picture), "{method:?}, {polygon:?}, {preset:?} draws no image of its own");
            }
        }
    }
}

#[test]
fn depth_buffers_are_read_multisampled_too() {
    let gpu = gpu();
    let color = color(&gpu, WIDTH, HEIGHT, 0, 0);
    let bokeh = Bokeh::new(&gpu.0, Method::Layered, Polygon::Hexagon, Preset::Medium);
    let wanted = drawn(&gpu, &bokeh, &color, &depth(&gpu, WIDTH, HEIGHT, 0.97), &lens(), PLANES);
    for samples in [1, 4] {
        let buffer = depth_buffer(&gpu, samples, 0.97);
        assert!(drawn(&gpu, &bokeh, &color, &buffer, &lens(), PLANES) == wanted, "{samples} samples");
        let debug = Lens { debug: Some(Debug::Depth), ..lens() };
        assert!(drawn(&gpu, &bokeh, &color, &buffer, &debug, PLANES) != wanted);
    }
}

#[test]
fn kinds_of_depth_agree() {
    let gpu = gpu();
    let (near, far, metres) = (0.5, 100.0, 8.0_f32);
    let stored = (1.0 - near / metres) / (1.0 - near / far);
    let line = (metres - near) / (far - near);
    let kinds = [
        (Depth::Metres, metres),
        (Depth::Standard { near, far }, stored),
        (Depth::Reversed { near, far }, 1.0 - stored),
        (Depth::ReversedInfinite { near }, near / metres),
        (Depth::OpenGL { near, far }, 2.0 * stored - 1.0),
        (Depth::Orthographic { near, far }, line),
        (Depth::OrthographicReversed { near, far }, 1.0 - line),
        (Depth::FractionOfFar { far }, metres / far),
        (Depth::Logarithmic { far }, metres.ln_1p() / far.ln_1p()),
    ];
    let mut textures: Vec<_> = kinds.map(|(kind, value)| (kind, depth(&gpu, WIDTH, HEIGHT, value))).into();
    let weighted = vec![[0.75 * metres, 0.75]; (WIDTH * HEIGHT) as usize];
    textures.push((Depth::WeightedByOpacity, images::weighted_depth(&gpu.0, &gpu.1, WIDTH, HEIGHT, &weighted)));
    let color = color(&gpu, WIDTH, HEIGHT, 0, 0);
    let bokeh = Bokeh::new(&gpu.0, Method::Layered, Polygon::Hexagon, Preset::Medium);
    let debug = Lens { debug: Some(Debug::CircleOfConfusion), ..lens() };
    let mut greys = Vec::new();
    for (kind, texture) in textures {
        let picture = drawn(&gpu, &bokeh, &color, &texture, &debug, kind);
        greys.push(u16::from_le_bytes([picture[0], picture[1]]));
    }
    // stored depth has about 24 bits of precision and the greys have 11, so the greys differ by at most one step
    let (least, most) = (greys.iter().min().unwrap(), greys.iter().max().unwrap());
    assert!(*least > 0 && most - least <= 1, "{greys:?}");
}

#[test]
fn a_viewport_draws_what_the_whole_image_does() {
    let gpu = gpu();
    for method in [Method::Layered, Method::Exact] {
        let whole = Bokeh::new(&gpu.0, method, Polygon::Hexagon, Preset::Medium);
        let wanted =
            drawn(&gpu, &whole, &color(&gpu, WIDTH, HEIGHT, 0, 0), &depth(&gpu, WIDTH, HEIGHT, 0.97), &lens(), PLANES);
        let part = Bokeh::with_viewport(&gpu.0, method, Polygon::Hexagon, Preset::Medium);
        let viewport = Viewport { x: 64, y: 32, width: WIDTH, height: HEIGHT };
        let (width, height) = (256, 128);
        let (color, depth) = (color(&gpu, width, height, 64, 32), depth(&gpu, width, height, 0.97));
        let targets = part.targets(&gpu.0, &color, &depth).unwrap();
        let mut encoder = gpu.0.create_command_encoder(&Default::default());
        let result = part.render_part(&gpu.1, &mut encoder, &targets, &lens(), PLANES, viewport).unwrap();
        gpu.1.submit([encoder.finish()]);
        let picture = images::bytes(&gpu.0, &gpu.1, result);
        let row = |y: u32| &picture[((32 + y) * width + 64) as usize * 8..][..WIDTH as usize * 8];
        let inside: Vec<u8> = (0..HEIGHT).flat_map(row).copied().collect();
        let far_apart = halves(&inside).zip(halves(&wanted)).filter(|(a, b)| a.abs_diff(*b) > 4).count();
        assert!(far_apart == 0, "{method:?}: {far_apart} values are more than 4 half-float steps apart");
    }
}

fn halves(bytes: &[u8]) -> impl Iterator<Item = u16> {
    bytes.chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
}

#[test]
fn off_draws_nothing() {
    let gpu = gpu();
    let (color, depth) = (color(&gpu, WIDTH, HEIGHT, 0, 0), depth(&gpu, WIDTH, HEIGHT, 0.97));
    let bokeh = Bokeh::new(&gpu.0, Method::Layered, Polygon::Hexagon, Preset::Medium);
    let off = Lens { bokeh_scale: 0.0, ..lens() };
    assert!(drawn(&gpu, &bokeh, &color, &depth, &off, PLANES) == images::bytes(&gpu.0, &gpu.1, &color));
}

#[test]
fn output_is_opaque_and_encoded() {
    let gpu = gpu();
    let grey = vec![[0.214_041, 0.0, 1.0, 0.3]; (WIDTH * HEIGHT) as usize];
    let color = images::color(&gpu.0, &gpu.1, WIDTH, HEIGHT, &grey);
    // 0.214041 is 127.5 of 255 in sRGB
    let picture = images::srgb(&gpu.0, &gpu.1, &color);
    assert!(picture.chunks(4).all(|pixel| (127..=128).contains(&pixel[0]) && pixel[1..] == [0, 255, 255]));
}

#[test]
fn mistakes_are_errors() {
    let gpu = gpu();
    let bokeh = Bokeh::new(&gpu.0, Method::Exact, Polygon::Square, Preset::Low);
    let (color, depth) = (color(&gpu, WIDTH, HEIGHT, 0, 0), depth(&gpu, WIDTH, HEIGHT, 0.97));
    let unreadable = empty(&gpu, FORMAT, DRAWABLE, 1);
    let several = empty(&gpu, FORMAT, DRAWABLE | READABLE, 4);
    let integers = empty(&gpu, TextureFormat::Rgba8Uint, READABLE, 1);
    let small = self::depth(&gpu, WIDTH / 2, HEIGHT, 0.97);
    let found = |color: &Texture, depth: &Texture| bokeh.targets(&gpu.0, color, depth).err().unwrap();
    let said = [
        found(&unreadable, &depth),
        found(&several, &depth),
        found(&integers, &depth),
        found(&color, &color),
        found(&color, &small),
    ]
    .map(|error| error.to_string());
    let wanted = [
        "the colour texture cannot be read: create it with TextureUsages::TEXTURE_BINDING",
        "colour has 4 samples per pixel: resolve it first (depth may stay multisampled)",
        "colour has the format Rgba8Uint: use a filterable float format, such as Rgba16Float",
        "depth has the format Rgba16Float: use a depth format, R32Float, Rg16Float or Rg32Float",
        "colour is 96 x 64 pixels, but depth is 48 x 64: both need the same size",
    ];
    assert_eq!(said, wanted.map(str::to_string));
}

#[test]
fn wrong_viewports_are_errors() {
    let gpu = gpu();
    let (color, depth) = (color(&gpu, WIDTH, HEIGHT, 0, 0), depth(&gpu, WIDTH, HEIGHT, 0.97));
    let said = |bokeh: &Bokeh, x: u32, width: u32| {
        let targets = bokeh.targets(&gpu.0, &color, &depth).unwrap();
        let mut encoder = gpu.0.create_command_encoder(&Default::default());
        let viewport = Viewport { x, y: 0, width, height: HEIGHT };
        bokeh.render_part(&gpu.1, &mut encoder, &targets, &lens(), PLANES, viewport).map_err(|error| error.to_string()).err()
    };
    let whole = Bokeh::new(&gpu.0, Method::Exact, Polygon::Square, Preset::Low);
    let part = Bokeh::with_viewport(&gpu.0, Method::Exact, Polygon::Square, Preset::Low);
    let outside = |x: u32, width: u32| {
        let viewport = Viewport { x, y: 0, width, height: HEIGHT };
        Some(format!("{viewport:?} is empty, or is not within the image of 96 x 64 pixels"))
    };
    let no_viewports = "the effect cannot draw viewports: create it with Bokeh::with_viewport";
    assert_eq!(said(&whole, 0, WIDTH), Some(no_viewports.into()));
    assert_eq!(said(&part, 8, WIDTH), outside(8, WIDTH));
    assert_eq!(said(&part, u32::MAX, WIDTH), outside(u32::MAX, WIDTH));
    assert_eq!(said(&part, 0, 0), outside(0, 0));
    assert_eq!(said(&part, 4, WIDTH - 8), None);
    let layered = Bokeh::with_viewport(&gpu.0, Method::Layered, Polygon::Square, Preset::Low);
    let misaligned = Viewport { x: 4, y: 0, width: WIDTH - 8, height: HEIGHT };
    let text = format!("{misaligned:?} does not begin at multiples of 8 pixels, which the method layered needs");
    assert_eq!(said(&layered, 4, WIDTH - 8), Some(text));
    assert_eq!(said(&layered, 8, WIDTH - 8), None);
}

/// Draws an image whose depth is `stored` everywhere, and returns the alpha of its first pixel: the signed circle of
/// confusion as the two bytes of a half float.
fn coc(gpu: &Gpu, bokeh: &Bokeh, stored: f32, lens: &Lens) -> Vec<u8> {
    let grey = images::color(&gpu.0, &gpu.1, WIDTH, HEIGHT, &[[0.1; 4]; (WIDTH * HEIGHT) as usize]);
    let picture = drawn(gpu, bokeh, &grey, &depth(gpu, WIDTH, HEIGHT, stored), lens, PLANES);
    picture[6..8].to_vec()
}

#[test]
fn near_and_far_have_scales_and_limits_of_their_own() {
    let gpu = gpu();
    let bokeh = Bokeh::new(&gpu.0, Method::Exact, Polygon::Square, Preset::Low);
    let (near, far) = (0.0, 0.97); // 0.5 m and 14.4 m; the focus distance is 2 m
    let plain = lens();
    for (is_near, changed) in [
        (true, Lens { near_scale: 0.5, max_coc: 1.0, ..plain }),
        (false, Lens { far_scale: 0.5, max_coc: 1.0, ..plain }),
        (true, Lens { near_max_coc: 0.01, ..plain }),
        (false, Lens { far_max_coc: 0.01, ..plain }),
    ] {
        let unchanged = Lens { max_coc: changed.max_coc, ..plain };
        for (side, stored) in [(true, near), (false, far)] {
            let same = coc(&gpu, &bokeh, stored, &changed) == coc(&gpu, &bokeh, stored, &unchanged);
            assert_eq!(same, side != is_near, "{changed:?}");
        }
    }
}
