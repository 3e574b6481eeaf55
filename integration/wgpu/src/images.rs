// SPDX-License-Identifier: MIT

//! Pixels to textures and back, for programs without a window and for tests. Rows begin with the image's first, at the
//! top.

use crate::Output;
use wgpu::*;

/// Linear colour in a texture that [`Bokeh::targets`](crate::Bokeh::targets) takes; Rgba16Float.
///
/// # Panics
///
/// If `pixels` are not `width * height`.
pub fn color(device: &Device, queue: &Queue, width: u32, height: u32, pixels: &[[f32; 4]]) -> Texture {
    let bytes: Vec<u8> = pixels.iter().flatten().flat_map(|value| half(*value).to_le_bytes()).collect();
    uploaded(device, queue, width, height, TextureFormat::Rgba16Float, &bytes)
}

/// Depth as numbers in a texture that [`Bokeh::targets`](crate::Bokeh::targets) takes; R32Float.
///
/// # Panics
///
/// If `values` are not `width * height`.
pub fn depth(device: &Device, queue: &Queue, width: u32, height: u32, values: &[f32]) -> Texture {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    uploaded(device, queue, width, height, TextureFormat::R32Float, &bytes)
}

/// Depth for [`Depth::WeightedByOpacity`](crate::Depth::WeightedByOpacity): metres times opacity, and opacity;
/// Rg16Float.
///
/// # Panics
///
/// If `texels` are not `width * height`.
pub fn weighted_depth(device: &Device, queue: &Queue, width: u32, height: u32, texels: &[[f32; 2]]) -> Texture {
    let bytes: Vec<u8> = texels.iter().flatten().flat_map(|value| half(*value).to_le_bytes()).collect();
    uploaded(device, queue, width, height, TextureFormat::Rg16Float, &bytes)
}

/// The result as a picture: four bytes a pixel, sRGB-encoded, alpha 255. What is brighter than 1 is cut off. It waits
/// for the GPU.
///
/// # Panics
///
/// If the device is lost.
pub fn srgb(device: &Device, queue: &Queue, result: &Texture) -> Vec<u8> {
    let format = TextureFormat::Rgba8UnormSrgb;
    let picture = texture(device, result.width(), result.height(), format, TextureUsages::RENDER_ATTACHMENT);
    let mut encoder = device.create_command_encoder(&Default::default());
    let view = picture.create_view(&Default::default());
    let output = Output::new(device, format);
    output.draw(device, &mut encoder, result, &view);
    queue.submit([encoder.finish()]);
    bytes(device, queue, &picture)
}

/// The bytes of a texture as it is, without a gap between rows. It waits for the GPU.
///
/// # Panics
///
/// If the texture was made without [`TextureUsages::COPY_SRC`], or the device is lost.
pub fn bytes(device: &Device, queue: &Queue, texture: &Texture) -> Vec<u8> {
    let texel = texture.format().block_copy_size(None).expect("a format with one aspect");
    let row = texture.width() * texel;
    let padded = row.next_multiple_of(COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&BufferDescriptor {
        label: Some("bokeh"),
        size: u64::from(padded * texture.height()),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout =
        TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: Some(texture.height()) };
    let mut encoder = device.create_command_encoder(&Default::default());
    let target = TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    queue.submit([encoder.finish()]);
    buffer.map_async(MapMode::Read, .., |mapped| mapped.expect("a buffer that can be read"));
    device.poll(PollType::wait_indefinitely()).expect("a device that answers");
    let data = buffer.get_mapped_range(..).expect("a buffer that is mapped");
    data.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect()
}

fn texture(device: &Device, width: u32, height: u32, format: TextureFormat, usage: TextureUsages) -> Texture {
    device.create_texture(&TextureDescriptor {
        label: Some("bokeh"),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage: usage | TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

fn uploaded(device: &Device, queue: &Queue, width: u32, height: u32, format: TextureFormat, data: &[u8]) -> Texture {
    let row = width * format.block_copy_size(None).expect("a format with one aspect");
    assert_eq!(data.len(), row as usize * height as usize, "not {width} x {height} pixels");
    let made = texture(device, width, height, format, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let layout = TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(height) };
    queue.write_texture(made.as_image_copy(), data, layout, made.size());
    made
}

/// The nearest half float, ties to even; what is too large becomes infinite.
fn half(value: f32) -> u16 {
    let bits = value.to_bits();
    let sign = (bits >> 16) as u16 & 0x8000;
    let size = value.abs();
    let magnitude = if value.is_nan() {
        0x7e00
    } else if size >= 65520.0 {
        0x7c00
    } else if size < 6.103_515_6e-5 {
        // subnormal: adding 0.5 lets the addition round to multiples of 2^-24
        ((size + 0.5).to_bits() - 0.5_f32.to_bits()) as u16
    } else {
        // 2^112 lies between the two exponents' biases
        let shifted = (bits & 0x7fff_ffff) - (112 << 23);
        ((shifted + 0xfff + (shifted >> 13 & 1)) >> 13) as u16
    };
    sign | magnitude
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn half_floats() {
        let known = [
            (0.0, 0),
            (-0.0, 0x8000),
            (1.0, 0x3c00),
            (-2.0, 0xc000),
            (65504.0, 0x7bff),
            (65519.9, 0x7bff),
            (65520.0, 0x7c00),
            (f32::INFINITY, 0x7c00),
            (6.103_515_6e-5, 0x0400),
            (5.960_464_5e-8, 1),
            (2.980_232_2e-8, 0),
            (0.333_251_95, 0x3555),
            (1.000_488_3, 0x3c00),
            (1.001_464_8, 0x3c02),
        ];
        for (value, bits) in known {
            assert_eq!(half(value), bits, "{value}");
        }
        assert_eq!(half(f32::NAN) & 0x7fff, 0x7e00);
    }
}
