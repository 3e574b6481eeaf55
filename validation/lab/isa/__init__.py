"""What the passes cost on real GPUs, by these GPUs' own compilers: `validation/run isa`, docs/cost.md."""
