"""Mutation test of the harness: shaders broken on purpose, each of which the tests must catch."""
