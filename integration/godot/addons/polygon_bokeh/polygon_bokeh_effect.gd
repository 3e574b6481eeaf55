# SPDX-License-Identifier: MIT
@tool
@icon("icon.svg")
class_name PolygonBokehEffect
extends CompositorEffect
## Depth of field with polygonal bokeh for the Forward+ and Mobile renderers.
##
## Add it to the [Compositor] of a [Camera3D] or of a [WorldEnvironment]. It runs after transparent surfaces, and before
## the engine's own glow and tone mapping. For the Compatibility renderer, use [PolygonBokeh].

const Frames := preload("compositor_frames.gd")

const SHADERS := "compositor.glsl"
const CONTEXT := &"polygon_bokeh"

## How the image is blurred. With [code]layered[/code], blurred near objects spread over the sharp background.
## [code]exact[/code] blurs each pixel by its own circle of confusion, in fewer passes.
@export_enum("layered", "exact") var method := "layered"
## Number of sides of the polygon: 4, 6, 8 or 10.
@export_enum("4:4", "6:6", "8:8", "10:10") var sides := 6
@export_enum("MOBILE", "LOW", "MEDIUM", "HIGH", "ULTRA") var preset := "MEDIUM"
## f-stop of the lens. Its focal length comes from the camera's field of view.
@export_range(0.1, 32.0, 0.1, "or_greater") var f_stop := 2.8
## How many times as wide the blur is as that of a real lens. At 0, no pass is drawn.
@export_range(0.0, 50.0, 0.1, "or_greater") var bokeh_scale := 10.0
## Focus distance along the view axis, in metres. [method focus_on] sets it.
@export_range(0.1, 1000.0, 0.01, "or_greater", "suffix:m") var focus_distance := 5.0
@export var sensor_height := 0.024 ## Height of the camera's sensor in metres.
@export_range(0.0, 1.0) var max_coc := 0.1 ## Largest diameter of the blur, as a fraction of the image height.
@export_range(-360.0, 360.0, 0.1, "radians_as_degrees") var rotation := 0.0
@export var squeeze := 1.0 ## Width of the bokeh divided by its height.

@export_group("Near and Far Blur") # In front of the focus distance, and behind it.
@export var near_scale := 1.0 ## Factor of the blur in front of the focus; 0 turns it off.
@export var far_scale := 1.0 ## Factor of the blur behind the focus; 0 turns it off.
@export_range(0.0, 1.0) var near_max_coc := 1.0 ## Largest blur in front of the focus, fraction of the image height.
@export_range(0.0, 1.0) var far_max_coc := 1.0 ## Largest blur behind the focus, fraction of the image height.

var _device: RenderingDevice
var _file: RDShaderFile
var _linear: RID
var _nearest: RID
var _shaders := {} # name of a version -> RID
var _pipelines := {} # [shader, format of the framebuffer] -> RID


func _init() -> void:
	effect_callback_type = EFFECT_CALLBACK_TYPE_POST_TRANSPARENT
	access_resolved_color = true
	access_resolved_depth = true
	needs_motion_vectors = false
	RenderingServer.call_on_render_thread(_prepare)


func _notification(what: int) -> void:
	if what == NOTIFICATION_PREDELETE and _device != null:
		# this also frees the pipelines and uniform sets of the shaders
		for rid: RID in _shaders.values() + [_linear, _nearest]:
			if rid.is_valid():
				_device.free_rid(rid)


## Focuses on a point of the world, as [param camera] sees it. If the point or the camera moves, call it in every frame.
func focus_on(camera: Camera3D, point: Vector3) -> void:
	focus_distance = maxf(-(camera.global_transform.affine_inverse() * point).z, 0.01)


func _prepare() -> void:
	_device = RenderingServer.get_rendering_device()
	if _device == null:
		push_warning("PolygonBokehEffect needs the Forward+ or Mobile renderer. With the Compatibility renderer, use the "
				+ "node PolygonBokeh instead.")
		return
	_file = load((get_script() as Script).resource_path.get_base_dir().path_join(SHADERS))
	var state := RDSamplerState.new()
	_nearest = _device.sampler_create(state)
	state.min_filter = RenderingDevice.SAMPLER_FILTER_LINEAR
	state.mag_filter = RenderingDevice.SAMPLER_FILTER_LINEAR
	_linear = _device.sampler_create(state)


func _render_callback(_type: int, data: RenderData) -> void:
	if _device == null or f_stop <= 0.0 or bokeh_scale <= 0.0:
		return
	var buffers := data.get_render_scene_buffers() as RenderSceneBuffersRD
	if buffers == null:
		return
	var size := buffers.get_internal_size()
	if size.x < 2 or size.y < 2:
		return
	var parameters := _parameters(data.get_render_scene_data().get_cam_projection(), size)
	for view in buffers.get_view_count():
		for row: Array in Frames.FRAMES[method][sides]:
			_draw(buffers, view, size, row, parameters)


# Returns the parameters of the shaders, 80 bytes. `projection` is the one with which Godot drew the depth buffer.
func _parameters(projection: Projection, size: Vector2i) -> PackedByteArray:
	var focal_length := 0.05
	if is_zero_approx(projection.w.w): # perspective
		focal_length = 0.5 * sensor_height * absf(projection.y.y)
	return PackedFloat32Array([
		focal_length / f_stop * bokeh_scale, focal_length, focus_distance, sensor_height,
		projection.z.z, projection.w.z, projection.z.w, projection.w.w,
		size.x, size.y, max_coc, sides,
		rotation, squeeze, near_scale, far_scale,
		near_max_coc, far_max_coc, 0.0, 0.0,
	]).to_byte_array()


# Draws a pass. `row` is [version, divisor of the targets' size, textures by slot, targets].
func _draw(
	buffers: RenderSceneBuffersRD, view: int, size: Vector2i, row: Array, parameters: PackedByteArray
) -> void:
	var shader := _shader("%s_%s" % [preset.to_lower(), row[0]])
	if not shader.is_valid():
		return
	var targets: Array[RID] = []
	for title: String in row[3]:
		targets.append(_texture(buffers, view, size, title, _scale(title)))
	var uniforms: Array[RDUniform] = []
	for slot: int in row[2].size():
		var title: String = row[2][slot]
		if title == "-":
			continue
		var uniform := RDUniform.new()
		uniform.uniform_type = RenderingDevice.UNIFORM_TYPE_SAMPLER_WITH_TEXTURE
		uniform.binding = slot
		uniform.add_id(_nearest if title == "depth" else _linear)
		uniform.add_id(_texture(buffers, view, size, title, _scale(title)))
		uniforms.append(uniform)
	var framebuffer := FramebufferCacheRD.get_cache_multipass(targets, [], 1)
	var drawn := _device.draw_list_begin(framebuffer)
	_device.draw_list_bind_render_pipeline(drawn, _pipeline(shader, framebuffer, targets.size(), row[3][0] == "color"))
	_device.draw_list_bind_uniform_set(drawn, UniformSetCacheRD.get_cache(shader, 0, uniforms), 0)
	_device.draw_list_set_push_constant(drawn, parameters, parameters.size())
	_device.draw_list_draw(drawn, false, 1, 3)
	_device.draw_list_end()


# Returns the divisor of a texture's size.
func _scale(title: String) -> int:
	for row: Array in Frames.FRAMES[method][sides]:
		if title in row[3]:
			# in the table, layers have half the size of the image; with MOBILE, they have a quarter
			return 4 if preset == "MOBILE" and row[1] == 2 else row[1]
	return 1


# Returns the engine's color or depth, or a texture of this effect. Godot frees the latter when the viewport's size
# changes.
func _texture(buffers: RenderSceneBuffersRD, view: int, size: Vector2i, title: String, scale: int) -> RID:
	if title == "color":
		return buffers.get_color_layer(view)
	if title == "depth":
		return buffers.get_depth_layer(view)
	var wanted := Vector2i((Vector2(size) / scale).ceil())
	var key := StringName("%s_%d" % [title, scale])
	if buffers.has_texture(CONTEXT, key):
		return buffers.get_texture(CONTEXT, key)
	var usage := RenderingDevice.TEXTURE_USAGE_SAMPLING_BIT | RenderingDevice.TEXTURE_USAGE_COLOR_ATTACHMENT_BIT
	return buffers.create_texture(
		CONTEXT, key, RenderingDevice.DATA_FORMAT_R16G16B16A16_SFLOAT, usage, RenderingDevice.TEXTURE_SAMPLES_1,
		wanted, 1, 1, true, false
	)


func _shader(version: String) -> RID:
	if version not in _shaders:
		var spirv := _file.get_spirv(version) if _file != null else null
		_shaders[version] = _device.shader_create_from_spirv(spirv, version) if spirv != null else RID()
	return _shaders[version]


# Returns a pipeline that writes all channels, because alpha is data. Only the alpha of the engine's own colour is kept.
func _pipeline(shader: RID, framebuffer: RID, targets: int, is_picture: bool) -> RID:
	var key := [shader, _device.framebuffer_get_format(framebuffer)]
	if key not in _pipelines:
		var blend := RDPipelineColorBlendState.new()
		var attachments: Array[RDPipelineColorBlendStateAttachment] = []
		for i in targets:
			var attachment := RDPipelineColorBlendStateAttachment.new()
			attachment.write_a = not is_picture
			attachments.append(attachment)
		blend.attachments = attachments
		_pipelines[key] = _device.render_pipeline_create(
			shader, key[1], RenderingDevice.INVALID_FORMAT_ID, RenderingDevice.RENDER_PRIMITIVE_TRIANGLES,
			RDPipelineRasterizationState.new(), RDPipelineMultisampleState.new(), RDPipelineDepthStencilState.new(), blend
		)
	return _pipelines[key]
