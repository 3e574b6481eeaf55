# For the validation suite only: draws every method and polygon, and returns their inputs and results as raw pixels.
extends Node

const Sample := preload("res://sample.gd")

const SIZE := Vector2i(320, 240)
# The size of the shots is small, because the reference computes every pass of each shot.
const SHOT := Vector2i(160, 120)
# For layered, a size that 2, 4 and 8 do not divide, because its targets have 1 / 2, 1 / 4 and 1 / 8 of the size
const ODD := Vector2i(157, 117)
const SHAPES := {
	layered = { hexagon = 6, decagon = 10 }, # the default first
	exact = { square = 4, hexagon = 6, octagon = 8, decagon = 10 },
	paper = { hexagon = 6, octagon = 8 },
}
# Polygons to draw a second time, rotated by CLOCKWISE degrees
const ROTATED := { exact = "square", paper = "hexagon" }
const CLOCKWISE := 10.0
# Settings for one more shot, with a weaker and limited blur
const FOCUS := { near_scale = 0.5, far_scale = 0.75, near_max_coc = 0.02, far_max_coc = 0.03 }
# Polygon -> preset, so that Godot's preprocessor has to handle nearly every preset; all other polygons have MEDIUM
const PRESETS := { square = "LOW", octagon = "HIGH", decagon = "ULTRA" }
# An image of a viewport has 8 bits per channel in Godot, so this shader splits floats into their bytes.
const READ := """shader_type canvas_item;
render_mode unshaded, blend_disabled;
#include "res://addons/polygon_bokeh/bokeh.gdshaderinc"
#include "res://addons/polygon_bokeh/scene.gdshaderinc"
uniform sampler2D from : filter_linear, repeat_disable;
void fragment()
{
	vec4 texel = texelFetch(from, ivec2(UV * vec2(textureSize(from, 0))), 0);
	uint bits = %s;
	COLOR = vec4(uvec4(bits, bits >> 8u, bits >> 16u, bits >> 24u) & uvec4(255u)) / 255.0;
}
"""

var _asked := JavaScriptBridge.create_callback(_answer)
# Expression in the jobs of _read -> its shader
var _shaders := {}
var _effect: Resource


func _ready() -> void:
	JavaScriptBridge.get_interface("window").ask = _asked


# Calls one of the functions below, whose name comes from the page, and passes its result to the page.
func _answer(arguments: Array) -> void:
	var said: Variant = await call(arguments[0], JSON.parse_string(arguments[1]))
	JavaScriptBridge.get_interface("window").answer(JSON.stringify(said))


# Returns { data: the content of capture.json, files: name -> base64 } for `shapes`, or for all shapes.
func capture(shapes: Variant) -> Dictionary:
	shapes = shapes if shapes else SHAPES
	var data := {
		engine = "Godot %s, Compatibility" % Engine.get_version_info().string,
		device = JavaScriptBridge.eval("device()"), width = SHOT.x, height = SHOT.y, shots = [],
	}
	var host := _host(Vector2i(640, 480))
	await _drawn()
	var picture := host.get_texture().get_image().save_png_to_buffer()
	host.queue_free()
	var files := { "picture.png": Marshalls.raw_to_base64(picture) }
	for method: String in shapes:
		for aperture: String in shapes[method]:
			data.shots.append(await _shot(files, method, aperture, shapes[method][aperture]))
	for method: String in ROTATED if shapes == SHAPES else []:
		var aperture: String = ROTATED[method]
		data.shots.append(await _shot(files, method, aperture, SHAPES[method][aperture], CLOCKWISE))
	if shapes == SHAPES:
		data.shots.append(await _shot(files, "exact", "hexagon", 6, 0.0, FOCUS))
	return { data = data, files = files }


# Draws a shot, adds its pixels to `files`, and returns its entry in capture.json.
#   clockwise  rotation in degrees
#   controls   property of the node -> value: FOCUS or nothing
func _shot(files: Dictionary, method: String, aperture: String, sides: int, clockwise := 0.0, controls := {}) -> Dictionary:
	var size := ODD if method == "layered" else SHOT
	var host := _host(size)
	var bokeh: PolygonBokeh = host.get_child(0).bokeh
	bokeh.method = method
	bokeh.sides = sides
	bokeh.preset = PRESETS.get(aperture, "MEDIUM") if method != "paper" else "MEDIUM"
	bokeh.rotation = deg_to_rad(clockwise)
	for key: String in controls:
		bokeh.set(key, controls[key])
	await _drawn()
	var title := "%s-%s" % [method, aperture] if clockwise == 0.0 else "rotated-" + method
	var shot := {
		name = title, method = method, aperture = aperture, width = size.x, height = size.y,
		use_mrt = false, preset = bokeh.preset.to_lower(),
	}
	if clockwise != 0.0:
		shot.clockwise = clockwise
	if controls:
		shot.name = "focus-" + shot.name
		shot.focus = {
			scale = [bokeh.near_scale, bokeh.far_scale], limits = [bokeh.near_max_coc, bokeh.far_max_coc],
		}
	if method == "paper":
		# the reference has no presets for paper: give it the samples and the spacing of MEDIUM
		shot.merge({ samples = 9, spacing = 1.5 })
	var textures := bokeh.textures
	var jobs := _halves(textures.coc) + _halves(textures.result) + _halves(textures.focus)
	if "metres" in textures:
		jobs.append([textures.metres, "floatBitsToUint(texel.r)"])
	else:
		jobs.append([textures.coc, "floatBitsToUint(SceneDepth(UV))", bokeh])
	if method != "paper":
		for row in bokeh.frame:
			jobs += _halves(textures[row[0]])
	var read := await _read(jobs)
	var found := { color = _joined(read, 0), result = _joined(read, 2), depth = read[6] }
	if method != "paper":
		found.written = PackedByteArray()
		for i in range(7, read.size(), 2):
			found.written.append_array(_joined(read, i))
	shot.camera = _lens(bokeh, _joined(read, 4))
	for what: String in found:
		shot[what] = "%s.%s" % [shot.name, what]
		files[shot[what]] = Marshalls.raw_to_base64(found[what])
	host.queue_free()
	return shot


# Adds the sample in a viewport of its own. Returns the viewport.
func _host(size: Vector2i) -> SubViewport:
	var made := SubViewport.new()
	made.size = size
	made.own_world_3d = true
	made.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	add_child(made)
	made.add_child(Sample.new())
	return made


func _drawn() -> void:
	for i in 2:
		await RenderingServer.frame_post_draw


# Returns the lens as the shaders got it, in float32.
func _lens(bokeh: PolygonBokeh, focus: PackedByteArray) -> Dictionary:
	var lens := { focus_distance = focus.decode_half(4) + focus.decode_half(6) }
	for key: String in ["aperture_diameter", "focal_length", "sensor_height", "max_coc"]:
		lens[key] = PackedFloat32Array([bokeh._values[key]])[0]
	return lens


# Returns the two jobs for _read that read a texture of half floats.
func _halves(texture: Texture2D) -> Array:
	return [[texture, "packHalf2x16(texel.rg)"], [texture, "packHalf2x16(texel.ba)"]]


# Joins parts i and i + 1 of a result of _read. Returns four half floats per texel, beginning with the row at v = 0.
func _joined(read: Array[PackedByteArray], i: int) -> PackedByteArray:
	var all := PackedByteArray()
	all.resize(2 * read[i].size())
	for at in range(0, read[i].size(), 4):
		all.encode_u32(2 * at, read[i].decode_u32(at))
		all.encode_u32(2 * at + 4, read[i + 1].decode_u32(at))
	return all


# Reads 32 bits per texel, for each job: [texture, expression of the bits, PolygonBokeh whose scene it needs].
func _read(jobs: Array) -> Array[PackedByteArray]:
	var readers: Array[SubViewport] = []
	for job: Array in jobs:
		var reader := SubViewport.new()
		reader.size = job[0].get_size()
		reader.disable_3d = true
		reader.transparent_bg = true
		reader.render_target_update_mode = SubViewport.UPDATE_ALWAYS
		if job[1] not in _shaders: # compile each shader only once
			_shaders[job[1]] = Shader.new()
			_shaders[job[1]].code = READ % job[1]
		var material := ShaderMaterial.new()
		# set the shader after its code, because Godot takes a shader without code for one of 3D
		material.shader = _shaders[job[1]]
		material.set_shader_parameter("from", job[0])
		if job.size() > 2:
			material.set_shader_parameter("scene", job[2].textures.scene)
			material.set_shader_parameter("depth_unit", job[2]._values.depth_unit)
		var rectangle := ColorRect.new()
		rectangle.size = reader.size
		rectangle.material = material
		reader.add_child(rectangle)
		add_child(reader)
		readers.append(reader)
	await RenderingServer.frame_post_draw
	await RenderingServer.frame_post_draw
	var read: Array[PackedByteArray] = []
	for reader in readers:
		read.append(reader.get_texture().get_image().get_data())
		reader.queue_free()
	return read


# The rest is for test_godot.py. Pixels are half floats of four channels in base64, beginning with the row at v = 0.

# Draws the scene with a perspective and an orthogonal camera. Returns { name: { scene: pixels of the scene's viewport,
# coc: the CoC map, depth: metres as the passes read them, met: metres at which rays hit the floor or the wall, for the
# first columns, unit: depth_unit } }.
func scenes(_argument: Variant) -> Dictionary:
	var found := {}
	for projection: String in ["perspective", "orthogonal"]:
		var host := _host(SIZE)
		var sample: Sample = host.get_child(0)
		if projection == "orthogonal":
			sample.camera.projection = Camera3D.PROJECTION_ORTHOGONAL
			sample.camera.size = 2.4
		sample.bokeh.method = "exact"
		await _drawn()
		var textures := sample.bokeh.textures
		var jobs := _halves(textures.scene) + _halves(textures.coc)
		var read := await _read(jobs + [[textures.coc, "floatBitsToUint(SceneDepth(UV))", sample.bokeh]])
		var met := []
		for y in SIZE.y:
			for x in SIZE.x / 10:
				met.append(_meets(sample.camera, Vector2(x + 0.5, y + 0.5)))
		found[projection] = {
			scene = Marshalls.raw_to_base64(_joined(read, 0)), coc = Marshalls.raw_to_base64(_joined(read, 2)),
			depth = Marshalls.raw_to_base64(read[4]), met = met, unit = sample.bokeh._values.depth_unit,
		}
		host.queue_free()
	return found


func _meets(camera: Camera3D, pixel: Vector2) -> float:
	var start := camera.project_ray_origin(pixel)
	var along := camera.project_ray_normal(pixel)
	var far := (-16.0 - start.z) / along.z
	if along.y < 0.0:
		far = minf(far, -start.y / along.y)
	return -(camera.global_transform.affine_inverse() * (start + along * far)).z


# Draws the debug views as on the screen. Returns { focus, maxCoC, depth, coc, views: { 1: rgba, 2: rgba, 3: rgba } }.
func views(_argument: Variant) -> Dictionary:
	var host := _host(SIZE)
	host.use_hdr_2d = true # not rounded to 8 bits
	var bokeh: PolygonBokeh = host.get_child(0).bokeh
	bokeh.method = "exact"
	await _drawn()
	var textures := bokeh.textures
	var jobs := _halves(textures.coc) + _halves(textures.focus)
	var read := await _read(jobs + [[textures.coc, "floatBitsToUint(SceneDepth(UV))", bokeh]])
	var found := {
		coc = Marshalls.raw_to_base64(_joined(read, 0)), depth = Marshalls.raw_to_base64(read[4]),
		focus = _lens(bokeh, _joined(read, 2)).focus_distance, maxCoC = bokeh.max_coc, views = {},
	}
	for view in [1, 2, 3]:
		bokeh.view = view
		await _drawn()
		found.views[view] = Marshalls.raw_to_base64(_joined(await _read(_halves(host.get_texture())), 0))
	host.queue_free()
	return found


# Runs the autofocus. Returns { frame, seconds, places: [[u, v], ...], depth, before, distances: [metres after each
# frame] }.
func pull(_argument: Variant) -> Dictionary:
	var host := _host(SIZE)
	var bokeh: PolygonBokeh = host.get_child(0).bokeh
	bokeh.method = "exact"
	bokeh.target = null
	bokeh.distance = 2.0
	await _drawn()
	bokeh.set_process(false)
	var textures := bokeh.textures
	var depth := await _read([[textures.coc, "floatBitsToUint(SceneDepth(UV))", bokeh]])
	bokeh.points = PackedVector2Array([Vector2(0.1, 0.2), Vector2(0.7, 0.65), Vector2(0.9, 0.1)])
	bokeh.pull_seconds = 0.2
	var distances := []
	for i in 12:
		bokeh._process(1.0 / 30.0)
		await RenderingServer.frame_post_draw
		bokeh._process(0.0) # reading takes more frames, in which the focus must not move
		distances.append(_lens(bokeh, _joined(await _read(_halves(textures.focus)), 0)).focus_distance)
	host.queue_free()
	return {
		frame = 1.0 / 30.0, seconds = 0.2, places = [[0.1, 0.2], [0.7, 0.65], [0.9, 0.1]],
		depth = Marshalls.raw_to_base64(depth[0]), before = 2.0, distances = distances,
	}


# Changes the focus distance. Returns the result before the change, in the first frame after it, and in a later frame:
# { before, first, later }.
func latency(_argument: Variant) -> Dictionary:
	var host := _host(SIZE)
	var bokeh: PolygonBokeh = host.get_child(0).bokeh
	await _drawn()
	var found := { before = await _result(bokeh) }
	bokeh.pull_seconds = 0.0
	bokeh.target = null
	bokeh.distance = 2.4
	await RenderingServer.frame_post_draw
	_drawing(bokeh, SubViewport.UPDATE_DISABLED)
	found.first = await _result(bokeh)
	_drawing(bokeh, SubViewport.UPDATE_ALWAYS)
	await _drawn()
	found.later = await _result(bokeh)
	host.queue_free()
	return found


func _result(bokeh: PolygonBokeh) -> String:
	return Marshalls.raw_to_base64(_joined(await _read(_halves(bokeh.textures.result)), 0))


func _drawing(bokeh: PolygonBokeh, mode: SubViewport.UpdateMode) -> void:
	for child in bokeh.get_children(true):
		if child is SubViewport:
			child.render_target_update_mode = mode


# Sets a bokeh_scale of 0. Returns { drawing: how many passes draw, passes: how many there are, coc: the CoC map, whose
# rgb is the scene, shown: the image on the screen, acts: whether the image with the blur differs from it }.
func unblurred(_argument: Variant) -> Dictionary:
	var host := _host(SIZE)
	host.use_hdr_2d = true # not rounded to 8 bits
	var bokeh: PolygonBokeh = host.get_child(0).bokeh
	bokeh.method = "exact"
	await _drawn()
	var read := await _read(_halves(bokeh.textures.coc) + _halves(host.get_texture()))
	bokeh.bokeh_scale = 0.0
	await _drawn()
	var drawing := bokeh._passes.filter(func(drawn): return drawn.render_target_update_mode == SubViewport.UPDATE_ALWAYS)
	var shown := _joined(await _read(_halves(host.get_texture())), 0)
	host.queue_free()
	return {
		drawing = drawing.size(), passes = bokeh._passes.size(), coc = Marshalls.raw_to_base64(_joined(read, 0)),
		shown = Marshalls.raw_to_base64(shown), acts = _joined(read, 2) != shown,
	}


# Returns whether the CoC map has the size of the image in a window that is stretched to three times its base size.
func stretched(_argument: Variant) -> bool:
	var window := get_tree().root
	window.content_scale_size = window.size / 3
	window.content_scale_mode = Window.CONTENT_SCALE_MODE_CANVAS_ITEMS
	var sample := Sample.new()
	add_child(sample)
	await _drawn()
	var same := Vector2i(sample.bokeh.textures.coc.get_size()) == window.get_texture().get_image().get_size()
	sample.queue_free()
	window.content_scale_mode = Window.CONTENT_SCALE_MODE_DISABLED
	return same


# Sends a drag and a click on the box, and a key, and then removes the node. Returns { points: how many there are after
# the drag and after the click, focus, view, hidden: whether the viewport draws no 3D, drawn: whether it draws 3D again
# afterwards, had, left: the number of the camera's children before and afterwards }.
func interaction(_argument: Variant) -> Dictionary:
	var host := _host(SIZE)
	var sample: Sample = host.get_child(0)
	await _drawn()
	var click := InputEventMouseButton.new()
	click.button_index = MOUSE_BUTTON_LEFT
	var place := sample.camera.unproject_position(Vector3(1.3, 0.45, -6.05))
	var points := []
	for moved: float in [6.0, 4.0]: # a drag, a click
		for pressed: bool in [true, false]:
			click.pressed = pressed
			click.position = place + Vector2(moved if pressed else 0.0, 0.0)
			host.push_input(click.duplicate())
		points.append(sample.bokeh.points.size())
	var key := InputEventKey.new()
	key.keycode = KEY_2
	key.pressed = true
	host.push_input(key)
	sample.bokeh.cut()
	await _drawn()
	var focus := _joined(await _read(_halves(sample.bokeh.textures.focus)), 0)
	var said := { focus = _lens(sample.bokeh, focus).focus_distance, view = sample.bokeh.view, hidden = host.disable_3d, points = points }
	var children := sample.camera.get_child_count(true)
	sample.bokeh.queue_free()
	await _drawn()
	said.drawn = not host.disable_3d
	said.left = sample.camera.get_child_count(true)
	said.had = children
	host.queue_free()
	return said


# Returns whether Godot can read the scripts for the other renderers (read), and facts about the effect, such as the
# passes of its frames. There is no RenderingDevice here, so the effect draws nothing, and warns when the first call
# creates it.
func compositor(_nothing: Variant) -> Dictionary:
	var script: GDScript = load("res://addons/polygon_bokeh/polygon_bokeh_effect.gd")
	if _effect == null:
		_effect = script.new()
	var effect := _effect
	var projection := Projection.create_perspective(50.0, 1.5, 0.1, 100.0)
	return {
		read = script.can_instantiate() and load("res://forward_plus.gd").can_instantiate(), base = script.get_instance_base_type(), class_title = script.get_global_name(),
		stage = effect.effect_callback_type, color = effect.access_resolved_color, depth = effect.access_resolved_depth,
		frames = effect.Frames.FRAMES,
		parameters = Array(effect._parameters(projection, Vector2i(64, 48)).to_float32_array()),
	}


# Returns the editor's warnings about a node in the wrong place, and about one in the right place.
func warnings(_nothing: Variant) -> Dictionary:
	var node := PolygonBokeh.new()
	node.method = "paper"
	node.sides = 10
	add_child(node)
	var wrong := node._get_configuration_warnings()
	remove_child(node)
	var camera := Camera3D.new()
	camera.add_child(node)
	node.sides = 6
	var right := node._get_configuration_warnings()
	camera.free()
	return { wrong = wrong, right = right }
