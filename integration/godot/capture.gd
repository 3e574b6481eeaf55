# For the validation suite only: every method and shape, and what went into it, as raw pixels.
extends Node

const Sample := preload("res://sample.gd")

const SIZE := Vector2i(320, 240)
# of the shots: small, since the reference runs every pass of each
const SHOT := Vector2i(160, 120)
# one that 2, 4 and 8 do not divide, where there are smaller targets
const ODD := Vector2i(157, 117)
const SHAPES := {
	layered = { hexagon = 6, decagon = 10 }, # the default first
	exact = { square = 4, hexagon = 6, octagon = 8, decagon = 10 },
	paper = { hexagon = 6, octagon = 8 },
}
# once more as the sample's user rotates them
const ROTATED := { exact = "square", paper = "hexagon" }
const CLOCKWISE := 10.0
# and once with a weaker and a limited blur
const FOCUS := { near_scale = 0.5, far_scale = 0.75, near_max_coc = 0.02, far_max_coc = 0.03 }
# so that Godot's preprocessor meets every preset; all others have MEDIUM
const PRESETS := { square = "LOW", octagon = "HIGH", decagon = "ULTRA" }
# Godot's image of a viewport has 8 bits a channel, so floats go out as their bytes.
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
# expression of _read's jobs -> the shader that reads it
var _shaders := {}
var _effect: Resource


func _ready() -> void:
	JavaScriptBridge.get_interface("window").ask = _asked


# The page asks for a function below, by its name.
func _answer(arguments: Array) -> void:
	var said: Variant = await call(arguments[0], JSON.parse_string(arguments[1]))
	JavaScriptBridge.get_interface("window").answer(JSON.stringify(said))


# { data: what capture.json holds, files: name -> base64 }; of `shapes`, or of all
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


# clockwise: degrees; controls: property of the node -> value, all of FOCUS or none
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
		shot.merge({ samples = 9, spacing = 1.5 }) # what the preset stands for
	var textures := bokeh.textures
	var jobs := _halves(textures.coc) + _halves(textures.result) + _halves(textures.focus)
	if "metres" in textures:
		jobs.append([textures.metres, "floatBitsToUint(texel.r)"])
	else:
		jobs.append([textures.coc, "floatBitsToUint(SceneDepth(UV))", bokeh])
	if method == "layered":
		for row in bokeh.frame:
			jobs += _halves(textures[row[0]])
	var read := await _read(jobs)
	var found := { color = _joined(read, 0), result = _joined(read, 2), depth = read[6] }
	if method == "layered":
		found.written = PackedByteArray()
		for i in range(7, read.size(), 2):
			found.written.append_array(_joined(read, i))
	shot.camera = _lens(bokeh, _joined(read, 4))
	for what: String in found:
		shot[what] = "%s.%s" % [shot.name, what]
		files[shot[what]] = Marshalls.raw_to_base64(found[what])
	host.queue_free()
	return shot


# The sample in a viewport of its own
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


# What the shaders got, which is float32
func _lens(bokeh: PolygonBokeh, focus: PackedByteArray) -> Dictionary:
	var lens := { focus_distance = focus.decode_half(4) + focus.decode_half(6) }
	for key: String in ["aperture_diameter", "focal_length", "sensor_height", "max_coc"]:
		lens[key] = PackedFloat32Array([bokeh._values[key]])[0]
	return lens


# What to read of a texture of half floats, in two parts
func _halves(texture: Texture2D) -> Array:
	return [[texture, "packHalf2x16(texel.rg)"], [texture, "packHalf2x16(texel.ba)"]]


# Parts i and i + 1 of what was read: four half floats a texel, rows from v = 0 on
func _joined(read: Array[PackedByteArray], i: int) -> PackedByteArray:
	var all := PackedByteArray()
	all.resize(2 * read[i].size())
	for at in range(0, read[i].size(), 4):
		all.encode_u32(2 * at, read[i].decode_u32(at))
		all.encode_u32(2 * at + 4, read[i + 1].decode_u32(at))
	return all


# 32 bits a texel, for each [texture, expression of the bits, PolygonBokeh whose scene it needs]
func _read(jobs: Array) -> Array[PackedByteArray]:
	var readers: Array[SubViewport] = []
	for job: Array in jobs:
		var reader := SubViewport.new()
		reader.size = job[0].get_size()
		reader.disable_3d = true
		reader.transparent_bg = true
		reader.render_target_update_mode = SubViewport.UPDATE_ALWAYS
		if job[1] not in _shaders: # each is compiled once
			_shaders[job[1]] = Shader.new()
			_shaders[job[1]].code = READ % job[1]
		var material := ShaderMaterial.new()
		material.shader = _shaders[job[1]] # with its code: without, it is taken for one of 3D
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


# The rest is for test_godot.py. Pixels are halves of four channels in base64, rows from v = 0 on.

# What the scene's viewport holds, what the passes made of it, and where rays meet floor and wall:
# { name: { scene, coc, depth, met: [metres of each pixel of the first columns] } }
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


# The debug views as the screen has them: { focus, max_coc, depth, coc, views: { 1: rgba, 2: rgba, 3: rgba } }
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


# Autofocus: { frame, seconds, places: [[u, v], ...], depth, before, distances: [metres after each frame] }
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
		bokeh._process(0.0) # reading takes more frames
		distances.append(_lens(bokeh, _joined(await _read(_halves(textures.focus)), 0)).focus_distance)
	host.queue_free()
	return {
		frame = 1.0 / 30.0, seconds = 0.2, places = [[0.1, 0.2], [0.7, 0.65], [0.9, 0.1]],
		depth = Marshalls.raw_to_base64(depth[0]), before = 2.0, distances = distances,
	}


# The result of the first frame after a change, and of a later one: { first, later, before }
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


# With a bokeh_scale of 0: { drawing: passes that draw, passes: all, coc: the map, whose colour is the scene's, shown: the
# picture, acts: whether it is another one with the blur }
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


# A drag and a click on the box, and a key: { points: how many after each, focus, box, view }; then the node is gone: { drawn: 3D is drawn again, left }
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


# Whether the effect for the other renderers is a script that this Godot can read, and the passes of its frames. It has
# no RenderingDevice here, so nothing of it is drawn. The first call makes it, which warns of that.
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


# What the editor tells of a node in the wrong place, and of one in its place
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
