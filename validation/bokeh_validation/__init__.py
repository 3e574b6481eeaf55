"""Validate the polygonal bokeh shaders: compile every variant and run it on real drivers."""

__version__ = "0.3.0"
