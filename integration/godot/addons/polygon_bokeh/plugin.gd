@tool
extends EditorPlugin

const FOLDER := "res://addons/polygon_bokeh/"


func _enter_tree() -> void:
	add_custom_type("PolygonBokeh", "Node", preload(FOLDER + "polygon_bokeh.gd"), null)


func _exit_tree() -> void:
	remove_custom_type("PolygonBokeh")
