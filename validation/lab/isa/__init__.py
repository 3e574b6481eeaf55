"""What the passes cost on a GPU that is not there, by its own compiler: `validation/run isa`, docs/compilers.md."""
