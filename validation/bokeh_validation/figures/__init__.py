"""Figures 1 to 13 of the paper, made with the package's shaders: `validation/run figures`, docs/reproduction.md."""
