"""Test the tests: break the shaders on purpose, one mistake at a time; each must be caught."""
