@tool
extends EditorPlugin
# The editor lists PolygonBokeh and PolygonBokehEffect by their class names, so there is nothing to register.
