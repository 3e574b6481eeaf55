@tool
extends EditorPlugin
# PolygonBokeh and PolygonBokehEffect are in the editor's lists by their class names: there is nothing to register.
