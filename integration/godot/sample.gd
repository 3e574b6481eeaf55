# The sample: a scene, a camera, and depth of field for it.
extends Node3D

const Stage := preload("res://stage.gd")

var camera: Camera3D
var bokeh: PolygonBokeh
var pressed := Vector2.ZERO


func _ready() -> void:
	var stage := Stage.new()
	add_child(stage)
	camera = stage.camera
	bokeh = add_bokeh(camera, stage.subject)


# Does the same as a scene file that has a PolygonBokeh below its camera
func add_bokeh(to: Camera3D, subject: Node3D) -> PolygonBokeh:
	var made := PolygonBokeh.new()
	made.f_stop = 0.7 # bokeh_scale is 10, so the blur is ten times as wide as a real lens's
	made.target = subject
	to.add_child(made)
	return made


func _unhandled_input(event: InputEvent) -> void:
	# A click focuses on the object that it hits; a drag does not.
	if event is InputEventMouseButton and event.pressed:
		pressed = event.position
	elif event is InputEventMouseButton and event.position.distance_to(pressed) <= 5.0:
		bokeh.points = [event.position / get_viewport().get_visible_rect().size]
	# Keys 1 to 3 show a debug view, and 0 shows the result.
	if event is InputEventKey and event.pressed and event.keycode >= KEY_0 and event.keycode <= KEY_3:
		bokeh.view = event.keycode - KEY_0
