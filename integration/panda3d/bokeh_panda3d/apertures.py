"""Other lists for DepthOfField, in place of EXACT_HEXAGON."""

from bokeh_panda3d import EXACT_INPUTS

EXACT_OCTAGON = [
    *EXACT_INPUTS,
    ("OCTAGON_FIRST", 0, ["coc"], ["t2", "t3", "t4"]),
    ("OCTAGON_SECOND", 0, ["t2", "t3", "t4"], ["result"]),
]

PAPER_INPUTS = [
    ("LINEAR_DEPTH", 0, [], ["metres"]),
    ("COC_MAP", 0, ["color"], ["coc"]),
]

# Two parallelograms that share the upright line, combined by min
PAPER_HEXAGON = [
    *PAPER_INPUTS,
    ("ADAPTIVE", 90, ["coc"], ["line"]),
    ("ADAPTIVE", 30, ["line"], ["half"]),
    ("ADAPTIVE_FINAL", 150, ["line", "half"], ["result"]),
]

# Two squares, the second rotated by 45 degrees, combined by min
PAPER_OCTAGON = [
    *PAPER_INPUTS,
    ("ADAPTIVE", 0, ["coc"], ["line"]),
    ("ADAPTIVE", 90, ["line"], ["square"]),
    ("ADAPTIVE", 45, ["coc"], ["slanted"]),
    ("ADAPTIVE_FINAL", 135, ["slanted", "square"], ["result"]),
]

# Not an aperture: what BokehDebugMode says, instead of a blur
DEBUG = [*EXACT_INPUTS, ("DEBUG", 0, ["coc"], ["result"])]
