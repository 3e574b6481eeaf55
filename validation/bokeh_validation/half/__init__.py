"""What half precision does to the shaders: their own GLSL text, run in NumPy with any mix of half and float."""
