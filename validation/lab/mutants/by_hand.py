"""List mistakes in porting that the parity check cannot see; a driver of the language must show them."""

import re
from collections.abc import Iterator

from bokeh_validation.errors import UserError
from bokeh_validation.shaders import calls
from lab.mutants.mutant import Mutant, originals

# Every slot and every way to read a texture, with invalid depth
FRAMES = ("map, lens", "paper star", "naive", "naive, many", "exact decagon", "layered hexagon")
# driver, file, function or '' for the whole file, original text, replacement; '<->' swaps the two
MISTAKES = (
    ("dxc", "bokeh", "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
    ("d3d9", "bokeh", "FetchTexture", "coords, 0.0, 0.0", "coords + 0.01, 0.0, 0.0"),
    ("wgpu", "bokeh", "FetchTexture", "coords, 0.0", "coords + 0.01, 0.0"),
    ("dxc", "bokeh", "FetchTexel", "min(texel,", "min(texel + int2(1, 0),"),
    ("wgpu", "bokeh", "FetchTexel", "min(texel,", "min(texel + vec2i(1, 0),"),
    ("d3d9", "bokeh_paper", "NaiveGather", "float(i) + 0.5", "float(i) + 1.5"),
    ("d3d9", "bokeh_paper", "NaiveGather", "j + BOKEH_LOOP_LIMIT, BOKEH", "j + BOKEH_LOOP_LIMIT - 1, BOKEH"),
    # all languages have this code, but only Direct3D 9 considers NaN farther than every sample
    ("d3d9", "bokeh_paper", "DepthOfField", "PaperDepth(DepthSamp, uv", "FetchDepth(DepthSamp, BokehToTexture(uv)"),
    ("egl", "bokeh_layers", "LayerGrid", "BOKEH_LAYER_SCALE", "4"),
    ("dxc", "bokeh_passes", "", "TEXTURE, BokehColorSampC,", "<->TEXTURE, BokehColorSampD,"),
    ("d3d9", "bokeh_passes", "", "TEXTURE, BokehColorSampB,", "<->TEXTURE, BokehColorSampC,"),
    ("wgpu", "bokeh_passes", "", " var BokehColorSampB:", "<-> var BokehColorSampC:"),
    ("dxc", "bokeh_passes", "FullScreen_VS", "1.0 - result.uv.y * 2.0", "result.uv.y * 2.0 - 1.0"),
    ("d3d9", "bokeh_passes", "FullScreen_VS", "float2(-1.0, 1.0)", "float2(0.0, 0.0)"),
    ("egl", "bokeh_passes", "FullScreen_VS", "vec4(BokehUV * 2.0 - 1.0,", "vec4(1.0 - BokehUV * 2.0,"),
    ("egl", "bokeh_passes", "FullScreen_VS", "== 1 ? 2.0", "== 1 ? 1.0"),
    ("wgpu", "bokeh_passes", "FullScreen_VS", "1.0 - uv.y * 2.0", "uv.y * 2.0 - 1.0"),
)
LANGUAGES = {"egl": "glsl", "dxc": "hlsl", "d3d9": "hlsl", "wgpu": "wgsl"}


def mutants() -> Iterator[Mutant]:
    """Yield each of these mutants. Raises UserError if one does not fit the shaders."""
    for number, (driver, file, function, old, new) in enumerate(MISTAKES, 1):
        key = f"{LANGUAGES[driver]}/{file}.{LANGUAGES[driver]}"
        function_name = f"Bokeh{function}" if function else file
        pairs = {old: new.removeprefix("<->")}
        if new.startswith("<->"):
            pairs |= {after: before for before, after in pairs.items()}
        text = before = originals()[key]
        spans = [match.span("body") for name, match in calls.found_functions(text) if name == function_name]
        # HLSL may have two functions of a name, in branches of an #if
        for start, end in reversed(spans if function else [(0, len(text))]):
            pattern = "|".join(map(re.escape, pairs))
            body = re.sub(pattern, lambda match, pairs=pairs: pairs[match[0]], text[start:end])
            text = text[:start] + body + text[end:]
        if text == before:
            raise UserError(
                f"mutants: {old!r} is not in {function_name} of {key}. Bring mutants/by_hand.py up to date."
            )
        yield Mutant(
            f"porting-{number}", "porting", function_name, f"{old} -> {new}", {key: text}, driver, False, FRAMES
        )
