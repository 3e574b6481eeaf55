# The sample for the Forward+ and Mobile renderers: the same scene, with the effect in the camera's compositor.
extends Node3D

const Stage := preload("res://stage.gd")

var stage := Stage.new()
var bokeh: PolygonBokehEffect


func _ready() -> void:
	add_child(stage)
	bokeh = add_bokeh(stage.camera)


# Does the same as the inspector under Camera3D > Compositor
func add_bokeh(to: Camera3D) -> PolygonBokehEffect:
	var made := PolygonBokehEffect.new()
	made.f_stop = 0.7 # bokeh_scale is 10, so the blur is ten times as wide as a real lens's
	to.compositor = Compositor.new()
	to.compositor.compositor_effects = [made]
	return made


func _process(_delta: float) -> void:
	bokeh.focus_on(stage.camera, stage.subject.global_position)
