"""HLSL's registers on the bindings of the WGSL file, all in set 0."""

from bokeh_validation import passes

BINDINGS = {"b0": 0, "s0": passes.FIRST_SAMPLER} | {
    f"t{register}": binding for register, binding in enumerate(passes.BINDINGS.values())
}
