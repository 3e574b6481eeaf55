"""HLSL's registers on the bindings of the WGSL file, all in set 0."""

from bokeh_validation.passes import FIRST_SAMPLER, FIRST_TEXTURE, SLOTS

# Textures are on both sides of the sampler there.
_TEXTURES = [binding for binding in range(FIRST_TEXTURE, FIRST_TEXTURE + len(SLOTS) + 1) if binding != FIRST_SAMPLER]
BINDINGS = {"b0": 0, "s0": FIRST_SAMPLER} | {f"t{register}": _TEXTURES[register] for register in range(len(SLOTS))}
