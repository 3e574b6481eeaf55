// SPDX-License-Identifier: MIT

//! Functions that convert pixels to textures and back, for programs without a window and for tests. The first row of
//! pixels is the top of the image.

use crate::Output;
use wgpu::*;

/// Creates an Rgba16Float texture for [`Bokeh::targets`](crate::Bokeh::targets). `pixels` are linear red, green, blue
/// and alpha, row by row.
///
/// # Panics
///
/// Panics if the number of `pixels` is not `width * height`.
pub fn color(device: &Device, queue: &Queue, width: u32, height: u32, pixels: &[[f32; 4]]) -> Texture {
    let bytes: Vec<u8> = pixels.iter().flatten().flat_map(|value| half(*value).to_le_bytes()).collect();
    uploaded(device, queue, width, height, TextureFormat::Rgba16Float, &bytes)
}

/// Creates an R32Float texture with depth for [`Bokeh::targets`](crate::Bokeh::targets). `values` are metres, or any
/// other kind of [`Depth`](crate::Depth) that has one channel, row by row.
///
/// # Panics
///
/// Panics if the number of `values` is not `width * height`.
pub fn depth(device: &Device, queue: &Queue, width: u32, height: u32, values: &[f32]) -> Texture {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    uploaded(device, queue, width, height, TextureFormat::R32Float, &bytes)
}

/// Creates an Rg16Float texture for [`Depth::WeightedByOpacity`](crate::Depth::WeightedByOpacity). Each texel is metres
/// times opacity, then opacity.
///
/// # Panics
///
/// Panics if the number of `texels` is not `width * height`.
pub fn weighted_depth(device: &Device, queue: &Queue, width: u32, height: u32, texels: &[[f32; 2]]) -> Texture {
    let bytes: Vec<u8> = texels.iter().flatten().flat_map(|value| half(*value).to_le_bytes()).collect();
    uploaded(device, queue, width, height, TextureFormat::Rg16Float, &bytes)
}

/// Returns the result as an image with four bytes per pixel, sRGB-encoded, with an alpha of 255. Values above 1 are
/// clamped. The function waits for the GPU.
///
/// # Panics
///
/// Panics if the device is lost.
pub fn srgb(device: &Device, queue: &Queue, result: &Texture) -> Vec<u8> {
    let format = TextureFormat::Rgba8UnormSrgb;
    let picture = empty(device, result.width(), result.height(), format, TextureUsages::RENDER_ATTACHMENT);
    let mut encoder = device.create_command_encoder(&Default::default());
    let view = picture.create_view(&Default::default());
    let output = Output::new(device, format);
    output.draw(device, &mut encoder, result, &view);
    queue.submit([encoder.finish()]);
    bytes(device, queue, &picture)
}

/// Returns the bytes of a texture in its own format, without gaps between rows. The function waits for the GPU.
///
/// # Panics
///
/// Panics if the texture was made without [`TextureUsages::COPY_SRC`], or if the device is lost.
pub fn bytes(device: &Device, queue: &Queue, texture: &Texture) -> Vec<u8> {
    let texel = texture.format().block_copy_size(None).expect("the format must have a single aspect");
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
    buffer.map_async(MapMode::Read, .., |mapped| mapped.expect("cannot map the buffer"));
    device.poll(PollType::wait_indefinitely()).expect("cannot wait for the device");
    let data = buffer.get_mapped_range(..).expect("cannot read the mapped buffer");
    data.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect()
}

pub(crate) fn empty(device: &Device, width: u32, height: u32, format: TextureFormat, usage: TextureUsages) -> Texture {
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
    let row = width * format.block_copy_size(None).expect("the format must have a single aspect");
    assert_eq!(data.len(), row as usize * height as usize, "there must be {width} x {height} pixels");
    let made = empty(device, width, height, format, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let layout = TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(height) };
    queue.write_texture(made.as_image_copy(), data, layout, made.size());
    made
}

/// Returns the bits of the nearest half float. Ties round to even, and values that are too large become infinite.
fn half(value: f32) -> u16 {
    let bits = value.to_bits();
    let sign = (bits >> 16) as u16 & 0x8000;
    let size = value.abs();
    let magnitude = if value.is_nan() {
        0x7e00
    } else if size >= 65520.0 {
        0x7c00
    } else if size < 6.103_515_6e-5 {
        // the half float is subnormal: adding 0.5 rounds to a multiple of 2^-24
        ((size + 0.5).to_bits() - 0.5_f32.to_bits()) as u16
    } else {
        // the bias of the exponent is 127 in a float and 15 in a half float: the difference is 112
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
