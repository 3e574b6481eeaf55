# SPDX-License-Identifier: MIT
@tool
@icon("icon.svg")
class_name PolygonBokeh
extends Node
## Depth of field with polygonal bokeh for its parent, a [Camera3D], with the Compatibility renderer.
##
## For Forward+ and Mobile, use [PolygonBokehEffect]. The editor shows no blur.
## While the camera is current, its viewport draws no 3D. Instead, a viewport of this node draws the
## scene, with the same size and more than 8 bits. Further viewports are the passes of the blur, and the
## result is shown behind everything 2D.

const Frames := preload("frames.gd")

enum View { PICTURE, DEPTH, COC, FIELDS }

## How the image is blurred. With [code]layered[/code], blurred near objects spread over the sharp
## background. [code]exact[/code] blurs each pixel by its own circle of confusion, in fewer passes.
## [code]paper[/code] blurs along lines, and combines them by min. It supports only 6 and 8 sides.
@export_enum("layered", "exact", "paper") var method := "layered":
	set(value):
		method = value
		update_configuration_warnings()
## Number of sides of the polygon: 4, 6, 8 or 10.
@export_enum("4:4", "6:6", "8:8", "10:10") var sides := 6:
	set(value):
		sides = value
		update_configuration_warnings()
@export_enum("MOBILE", "LOW", "MEDIUM", "HIGH", "ULTRA") var preset := "MEDIUM"
## f-stop of the lens. Its focal length comes from the camera's field of view.
@export var f_stop := 2.8
## How many times as wide the blur is as that of a real lens. At 0, no pass is drawn.
@export var bokeh_scale := 10.0
@export var sensor_height := 0.024 ## Height of the camera's sensor in metres.
@export_range(0.0, 1.0) var max_coc := 0.1 ## Largest diameter of the blur, as a fraction of the image height.
@export_range(-360.0, 360.0, 0.1, "radians_as_degrees") var rotation := 0.0
@export var squeeze := 1.0 ## Width of the bokeh divided by its height.

@export_group("Near and Far Blur") # no effect with paper
@export var near_scale := 1.0 ## Factor of the blur in front of the focus; 0 turns it off.
@export var far_scale := 1.0 ## Factor of the blur behind the focus; 0 turns it off.
@export_range(0.0, 1.0) var near_max_coc := 1.0 ## Like [member max_coc], in front of the focus only.
@export_range(0.0, 1.0) var far_max_coc := 1.0 ## Like [member max_coc], behind the focus only.

@export_group("Focus")
## Focus distance along the view axis in metres, if neither [member target] nor [member points] is set.
@export var distance := 5.0
@export var target: Node3D ## Node to focus on. The focus follows it.
## Autofocus: up to four points of the view, from (0, 0) at the top left to (1, 1) at the bottom right.
## The focus moves to the nearest of the depths that are drawn there, and [member target] has no effect.
@export var points := PackedVector2Array()
@export var pull_seconds := 0.3 ## Time constant of the movement to a new focus, in seconds.

@export_group("Picture")
@export var exposure := 1.0
@export var white := 16.0 ## The brightness that tone mapping makes white.
@export var view := View.PICTURE

# The alpha of the scene's viewport is 1 + DEPTH_RANGE * near / metres. It is a half float, so at most 65504.
const DEPTH_RANGE := 60000.0

const PASS := """shader_type canvas_item;
render_mode unshaded, blend_disabled;
#define BOKEH_PRESET_%s
#define BOKEH_SIDES %d
#include "%s/bokeh.gdshaderinc"
#include "%s/bokeh_paper.gdshaderinc"
#include "%s/bokeh_layers.gdshaderinc"
%suniform float aperture_diameter;
uniform float focal_length;
uniform float sensor_height;
uniform float max_coc;
uniform float rotation;
uniform float squeeze;
uniform vec2 image_size;
uniform vec2 side_scale;
uniform vec2 side_max_coc;

void fragment()
{
	BokehPolygon polygon = BokehMakePolygon(%d, rotation, squeeze);
	BokehLayerContext layers = BokehMakeLayerContext(UV, image_size, max_coc);
	BokehSamplingSettings settings = BokehDefaultSampling(image_size);
	COLOR = %s;
}
"""
const LENS := "SceneLens(aperture_diameter, focal_length, sensor_height, max_coc)"

## The passes, in the order in which they are drawn:
## [code][name of the texture, divisor of its size, call of the library][/code]
var frame: Array[Array] = []
## Name -> texture that a pass has drawn. [code]scene[/code] is the camera's view.
var textures := {}

var _camera: Camera3D
var _host: Viewport # the viewport that shows the result
var _size: Vector2i
var _made: Array # the settings that the passes were created for
var _parts: Array[Node] = []
var _passes: Array[SubViewport] = []
var _materials: Array[ShaderMaterial] = []
var _values := {}
var _cut := true


func _enter_tree() -> void:
	_camera = get_parent() as Camera3D
	process_priority = 1000 # run after everything that moves the camera
	update_configuration_warnings()


func _exit_tree() -> void:
	_remove()


## Makes the focus jump to its new distance in the next frame. Call it after the camera jumps.
func cut() -> void:
	_cut = true


func _get_configuration_warnings() -> PackedStringArray:
	var warnings := PackedStringArray()
	if not get_parent() is Camera3D:
		warnings.append("PolygonBokeh must be a child of a Camera3D.")
	if RenderingServer.get_current_rendering_method() != "gl_compatibility":
		warnings.append("PolygonBokeh works only with the Compatibility renderer. With this renderer, add a "
				+ "PolygonBokehEffect to the compositor of the camera instead.")
	if method == "paper" and sides not in [6, 8]:
		warnings.append("The method paper can draw only 6 or 8 sides.")
	return warnings


func _process(delta: float) -> void:
	if Engine.is_editor_hint():
		return
	if _camera == null or not _camera.current:
		_remove()
		return
	var host := get_viewport()
	# the size of a window's texture is wrong if Godot stretches the window
	var stretched := host.get_visible_rect().size * host.get_stretch_transform().get_scale()
	var size: Vector2i = host.size if host is SubViewport else Vector2i(stretched.round())
	var wanted := [method, sides, preset, size, host.msaa_3d]
	if _made != wanted:
		_remove()
		_made = wanted
		_make(host, size)
	_host.disable_3d = true
	_update(delta)


# Passes the values of this frame to the shaders.
func _update(delta: float) -> void:
	var focal_length := 0.05
	if _camera.projection != Camera3D.PROJECTION_ORTHOGONAL:
		focal_length = 0.5 * sensor_height * absf(_camera.get_camera_projection().y.y)
	var focus := distance
	if target != null:
		focus = -(_camera.global_transform.affine_inverse() * target.global_position).z
	var padded := points.slice(0, 4)
	padded.resize(4)
	var values := {
		aperture_diameter = focal_length / f_stop * bokeh_scale, focal_length = focal_length,
		sensor_height = sensor_height, max_coc = max_coc, rotation = rotation, squeeze = squeeze,
		image_size = Vector2(_size), side_scale = Vector2(near_scale, far_scale),
		side_max_coc = Vector2(near_max_coc, far_max_coc), depth_unit = DEPTH_RANGE * _camera.near,
		points = padded, point_count = mini(points.size(), 4), focus_distance = focus,
		share = 1.0 if _cut or pull_seconds <= 0.0 else 1.0 - exp(-delta / pull_seconds),
		exposure = exposure, white = white, view = view,
	}
	_cut = false
	values.blurs = bokeh_scale > 0.0 or view != View.PICTURE
	for drawn in _passes:
		drawn.render_target_update_mode = SubViewport.UPDATE_ALWAYS if values.blurs else SubViewport.UPDATE_DISABLED
	for key: String in values:
		if _values.get(key) != values[key]:
			for material in _materials:
				material.set_shader_parameter(key, values[key])
	_values = values


func _make(host: Viewport, size: Vector2i) -> void:
	_host = host
	_size = size
	_draw_scene()
	var folder: String = get_script().resource_path.get_base_dir()
	_add("focus", Vector2i.ONE, load(folder + "/focus.gdshader"))
	frame = _frame()
	for row in frame:
		var shader := Shader.new()
		var reads := ""
		var call: String = row[2]
		for key: String in textures:
			var word := RegEx.create_from_string("(?<!\\.)\\b%s\\b" % key)
			if word.search(call):
				call = word.sub(call, "from_" + key, true)
				reads += "uniform sampler2D from_%s : filter_linear, repeat_disable;\n" % key
		if "Scene" in call:
			reads += "#include \"%s/scene.gdshaderinc\"\n" % folder
		shader.code = PASS % [preset, sides, folder, folder, folder, reads, sides, call]
		# in the table, layers have half the size of the image; with MOBILE, they have a quarter
		var scale: int = 4 if preset == "MOBILE" and row[1] == 2 else row[1]
		_passes.append(_add(row[0], Vector2i((Vector2(size) / scale).ceil()), shader))
	var again := Shader.new()
	again.code = "shader_type canvas_item; render_mode unshaded, blend_disabled; uniform sampler2D "\
			+ "focus; void fragment() { COLOR = texelFetch(focus, ivec2(0, 0), 0); }"
	_add("before", Vector2i.ONE, again)
	var layer := CanvasLayer.new()
	layer.layer = -128
	_keep(layer, self)
	_keep(_rectangle(load(folder + "/show.gdshader")), layer)
	for material in _materials:
		for key: String in textures:
			material.set_shader_parameter(key, textures[key])
			material.set_shader_parameter("from_" + key, textures[key])
	_values = {}
	_cut = true


func _remove() -> void:
	if _host != null:
		_host.disable_3d = false
	_host = null
	_made = []
	for part in _parts:
		part.queue_free()
	_parts.clear()
	_passes.clear()
	_materials.clear()
	textures.clear()


# Draws the camera's view into a viewport that keeps colours brighter than 1, and has depth in alpha.
func _draw_scene() -> void:
	var scene := _viewport("scene", _size)
	scene.world_3d = _host.find_world_3d()
	scene.msaa_3d = _host.msaa_3d
	RenderingServer.viewport_attach_camera(scene.get_viewport_rid(), _camera.get_camera_rid())
	var rectangle := MeshInstance3D.new()
	rectangle.mesh = QuadMesh.new()
	rectangle.mesh.size = Vector2(2.0, 2.0)
	rectangle.extra_cull_margin = 16384.0
	rectangle.layers = 0xFFFFF
	var material := ShaderMaterial.new()
	material.shader = load(get_script().resource_path.get_base_dir() + "/depth.gdshader")
	material.render_priority = Material.RENDER_PRIORITY_MAX
	rectangle.material_override = material
	_materials.append(material)
	_keep(rectangle, _camera)
	rectangle.position.z = -2.0 * _camera.near


# Adds a pass. Godot draws viewports in the order in which they enter the tree.
func _add(title: String, size: Vector2i, shader: Shader) -> SubViewport:
	var target_of_pass := _viewport(title, size)
	target_of_pass.disable_3d = true
	target_of_pass.transparent_bg = true # alpha is data
	_keep(_rectangle(shader), target_of_pass)
	return target_of_pass


func _viewport(title: String, size: Vector2i) -> SubViewport:
	var made := SubViewport.new()
	made.size = size
	made.use_hdr_2d = true # RGBA16F, also for 3D
	made.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	made.gui_disable_input = true
	_keep(made, self)
	textures[title] = made.get_texture()
	return made


func _rectangle(shader: Shader) -> ColorRect:
	var made := ColorRect.new()
	made.set_anchors_preset(Control.PRESET_FULL_RECT)
	made.mouse_filter = Control.MOUSE_FILTER_IGNORE
	made.material = ShaderMaterial.new()
	made.material.shader = shader
	_materials.append(made.material)
	return made


func _keep(part: Node, parent: Node) -> void:
	parent.add_child(part, false, INTERNAL_MODE_BACK)
	_parts.append(part)


func _frame() -> Array[Array]:
	var rows: Array[Array] = []
	var passes: Dictionary = { layered = Frames.LAYERED, exact = Frames.EXACT, paper = Frames.PAPER }[method]
	if method == "paper":
		rows.append(["metres", 1, "vec4(min(SceneDepth(UV), 65000.0), 0.0, 0.0, 1.0)"])
		rows.append(["coc", 1, "BokehPackCoC(SceneColor(UV), abs(BokehSignedCoC(BokehPaperDepth(metres, UV), %s)))" % LENS])
	else:
		rows.append(["coc", 1, "BokehPackCoC(SceneColor(UV), SceneCoC(UV, image_size, %s, SceneFocus(side_scale, side_max_coc)))" % LENS])
	for row: Array in passes[sides]:
		rows.append(row)
	return rows
