"""Validation harness of the polygonal bokeh shaders: compiles every variant and runs it on real drivers."""

__version__ = "0.3.0"
