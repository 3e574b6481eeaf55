# SPDX-License-Identifier: MIT
@tool
@icon("icon.svg")
class_name PolygonBokeh
extends Node
## Depth of field with polygonal bokeh for the [Camera3D] that this is a child of.
##
## While that camera is current, its viewport draws no 3D: a viewport of this node's own does, as large
## and with more than 8 bits; further ones blur that in passes, and the result is shown behind all 2D.
## For the Compatibility renderer; Forward+ and Mobile have [PolygonBokehEffect]. The editor shows no blur.

const Frames := preload("frames.gd")

enum View { PICTURE, DEPTH, COC, FIELDS }

## [code]layered[/code]: near objects spread over what is behind them. [code]exact[/code]: each pixel by
## its own circle of confusion, fewer passes. [code]paper[/code]: lines and min; 6 or 8 sides.
@export_enum("layered", "exact", "paper") var method := "layered":
	set(value):
		method = value
		update_configuration_warnings()
## Of the aperture: 4, 6, 8 or 10.
@export_enum("4:4", "6:6", "8:8", "10:10") var sides := 6:
	set(value):
		sides = value
		update_configuration_warnings()
@export_enum("MOBILE", "LOW", "MEDIUM", "HIGH", "ULTRA") var preset := "MEDIUM"
## Of the lens, whose focal length comes from the camera's field of view.
@export var f_stop := 2.8
## How many times wider the blur is than that lens's: 1 is the real lens; with 0 no pass is drawn.
@export var bokeh_scale := 10.0
@export var sensor_height := 0.024 ## Metres.
@export_range(0.0, 1.0) var max_coc := 0.1 ## Largest blur, fraction of the image height.
@export_range(-360.0, 360.0, 0.1, "radians_as_degrees") var rotation := 0.0
@export var squeeze := 1.0 ## Width of the bokeh over its height.

@export_group("Near and Far Blur") # In front of the focus, and behind it. No effect with paper.
@export var near_scale := 1.0 ## Factor of the blur in front of the focus; 0 turns it off.
@export var far_scale := 1.0 ## Factor of the blur behind the focus; 0 turns it off.
@export_range(0.0, 1.0) var near_max_coc := 1.0 ## Largest blur in front of the focus, fraction of the image height.
@export_range(0.0, 1.0) var far_max_coc := 1.0 ## Largest blur behind the focus, fraction of the image height.

@export_group("Focus")
## Depth along the camera's axis, metres, where nothing below is set.
@export var distance := 5.0
@export var target: Node3D ## To focus on, wherever it is.
## Autofocus: up to four places of the view, (0, 0) at its top left, (1, 1) at its bottom right. The
## nearest of what is drawn there wins.
@export var points := PackedVector2Array()
@export var pull_seconds := 0.3 ## Time constant of the way to a new focus.

@export_group("Picture")
@export var exposure := 1.0
@export var white := 16.0 ## What becomes white by tone mapping.
@export var view := View.PICTURE

# alpha of the scene's viewport is 1 + this many times near / metres, of the half floats up to 65504
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

## The passes as they are drawn: [code][name of the texture, 1 / its size, call of the library][/code]
var frame: Array[Array] = []
## name -> what a pass wrote; [code]scene[/code]: what the camera drew
var textures := {}

var _camera: Camera3D
var _host: Viewport # that shows the picture
var _size: Vector2i
var _made: Array # what the passes were made for
var _parts: Array[Node] = []
var _passes: Array[SubViewport] = []
var _materials: Array[ShaderMaterial] = []
var _values := {}
var _cut := true


func _enter_tree() -> void:
	_camera = get_parent() as Camera3D
	process_priority = 1000 # after all that moves the camera
	update_configuration_warnings()


func _exit_tree() -> void:
	_remove()


## Focus at once, without a pull: after a cut of the camera.
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
	var size := Vector2i(host.get_texture().get_size())
	var wanted := [method, sides, preset, size, host.msaa_3d]
	if _made != wanted:
		_remove()
		_made = wanted
		_make(host, size)
	_host.disable_3d = true
	_update(delta)


# What the shaders need to know of this frame
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
		# the table has layers of half size, and those of MOBILE have a quarter
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


# The camera, drawing into a viewport that keeps what is brighter than 1, with depth in alpha
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


# A pass. Viewports are drawn in the order in which they come into the tree.
func _add(title: String, size: Vector2i, shader: Shader) -> SubViewport:
	var target_of_pass := _viewport(title, size)
	target_of_pass.disable_3d = true
	target_of_pass.transparent_bg = true # alpha is data
	_keep(_rectangle(shader), target_of_pass)
	return target_of_pass


func _viewport(title: String, size: Vector2i) -> SubViewport:
	var made := SubViewport.new()
	made.size = size
	made.use_hdr_2d = true # RGBA16F, in 3D too
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
