# The scene of the sample: lamps in front of and behind the focus, a checkered floor, and a ring in focus.
extends Node3D

const COLORS = ["ff7a30", "ffe0a0", "60a0ff", "ff3050", "70ffb0"]

var camera := Camera3D.new()
var subject: Node3D


func _ready() -> void:
	var surroundings := WorldEnvironment.new()
	surroundings.environment = Environment.new()
	surroundings.environment.background_mode = Environment.BG_COLOR
	surroundings.environment.background_color = Color("05070c")
	surroundings.environment.ambient_light_source = Environment.AMBIENT_SOURCE_COLOR
	surroundings.environment.ambient_light_color = Color("607090")
	add_child(surroundings)
	var sun := DirectionalLight3D.new()
	sun.light_color = Color("ffe8d0")
	sun.light_energy = 0.8
	add_child(sun)
	sun.rotation_degrees = Vector3(-50.0, -25.0, 0.0)

	var floor_mesh := PlaneMesh.new()
	floor_mesh.size = Vector2(60.0, 60.0)
	_add(floor_mesh, _checkered(), Vector3.ZERO)
	_add(_box(Vector3(60.0, 20.0, 1.0)), _painted("101828"), Vector3(0.0, 10.0, -16.5))
	var box := _add(_box(Vector3(0.9, 0.9, 0.9)), _painted("50809a"), Vector3(1.3, 0.45, -6.5))
	box.rotation_degrees.y = 34.0
	var ring := TorusMesh.new()
	ring.outer_radius = 0.65
	ring.inner_radius = 0.4
	subject = _add(ring, _painted("d8b060"), Vector3(-0.45, 0.8, -5.0))
	subject.rotation_degrees = Vector3(70.0, 0.0, 20.0)

	_lamp("ffa050", 12.0, 0.03, Vector3(0.75, 1.85, -2.4))
	_lamp("70a0ff", 12.0, 0.03, Vector3(-0.8, 1.25, -2.4))
	for i in 24:
		var angle := 2.39996 * i # the golden angle spreads the lamps evenly, without random numbers
		var reach := sqrt((i + 1) / 24.0)
		var place := Vector3(6.5 * reach * cos(angle), 3.8 + 2.4 * reach * sin(angle), i % 4 - 15.8)
		_lamp(COLORS[i % 5], 12.0 + 9.0 * (i % 3), 0.07, place)

	camera.fov = 45.0
	camera.near = 0.1
	camera.far = 100.0
	add_child(camera)
	camera.look_at_from_position(Vector3(0.0, 1.4, 0.0), Vector3(0.0, 1.25, -5.0))


func _add(mesh: Mesh, material: Material, place: Vector3) -> MeshInstance3D:
	var made := MeshInstance3D.new()
	made.mesh = mesh
	made.material_override = material
	made.position = place
	add_child(made)
	return made


func _box(size: Vector3) -> BoxMesh:
	var mesh := BoxMesh.new()
	mesh.size = size
	return mesh


func _painted(color: String) -> StandardMaterial3D:
	var material := StandardMaterial3D.new()
	material.albedo_color = Color(color)
	return material


# Returns a material with a checkerboard of 60 x 60 squares.
func _checkered() -> ShaderMaterial:
	var material := ShaderMaterial.new()
	material.shader = Shader.new()
	material.shader.code = """shader_type spatial;
void fragment()
{
	vec2 square = floor(UV * 60.0);
	ALBEDO = mod(square.x + square.y, 2.0) < 0.5 ? vec3(0.157, 0.173, 0.204) : vec3(0.588, 0.549, 0.51);
}
"""
	return material


# Adds a lamp that is about `light` times as bright as its colour. The Compatibility renderer takes colours for sRGB,
# even above 1, so the brighter colour is encoded as sRGB.
func _lamp(color: String, light: float, radius: float, place: Vector3) -> void:
	var sphere := SphereMesh.new()
	sphere.radius = radius
	sphere.height = 2.0 * radius
	var material := StandardMaterial3D.new()
	material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	var linear := Color(color).srgb_to_linear()
	material.albedo_color = Color(linear * light, 1.0).linear_to_srgb()
	_add(sphere, material, place)
