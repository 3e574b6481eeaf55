// SPDX-License-Identifier: MIT

//! Copies the result to a target of the caller.

use wgpu::*;

/// Copies the result to targets of one format, texel by texel, with an alpha of 1.
pub struct Output {
    pipeline: RenderPipeline,
}

impl Output {
    /// Creates the pipeline for targets of a format. If the format is an sRGB format, the copy is sRGB-encoded. The
    /// copy is not tone-mapped.
    pub fn new(device: &Device, format: TextureFormat) -> Self {
        let source = ShaderSource::Wgsl(include_str!("output.wgsl").into());
        let module = &device.create_shader_module(ShaderModuleDescriptor { label: Some("bokeh output"), source });
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some("bokeh output"),
            layout: None,
            vertex: VertexState { module, entry_point: None, compilation_options: Default::default(), buffers: &[] },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(FragmentState {
                module,
                entry_point: None,
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    /// Records the copy of `result` to `view`, which must have the same size.
    pub fn draw(&self, device: &Device, encoder: &mut CommandEncoder, result: &Texture, view: &TextureView) {
        let bindings = device.create_bind_group(&BindGroupDescriptor {
            label: Some("bokeh output"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[BindGroupEntry {
                binding: 0,
                resource: BindingResource::TextureView(&result.create_view(&Default::default())),
            }],
        });
        let ops = Operations { load: LoadOp::Clear(Color::BLACK), store: StoreOp::Store };
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("bokeh output"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops,
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}
