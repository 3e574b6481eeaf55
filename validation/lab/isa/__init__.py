"""Estimate what passes cost on a GPU that is not present, with its own compiler: `validation/run isa`,
docs/compilers.md.
"""
