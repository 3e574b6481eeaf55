"""Other lists for DepthOfField, in place of EXACT_HEXAGON."""

EXACT_OCTAGON = [
    ("OCTAGON_FIRST", 0, ["metres", "coc"], ["t2", "t3", "t4"]),
    ("OCTAGON_SECOND", 0, ["metres", "t2", "t3", "t4"], ["result"]),
]

# Two parallelograms that share the upright line, combined by min
PAPER_HEXAGON = [
    ("ADAPTIVE", 90, ["metres", "coc"], ["line"]),
    ("ADAPTIVE", 30, ["metres", "line"], ["half"]),
    ("ADAPTIVE_FINAL", 150, ["metres", "line", "half"], ["result"]),
]

# Two squares, the second turned by 45 degrees, combined by min
PAPER_OCTAGON = [
    ("ADAPTIVE", 0, ["metres", "coc"], ["line"]),
    ("ADAPTIVE", 90, ["metres", "line"], ["square"]),
    ("ADAPTIVE", 45, ["metres", "coc"], ["slanted"]),
    ("ADAPTIVE_FINAL", 135, ["metres", "slanted", "square"], ["result"]),
]

# Not an aperture: what BokehDebugMode says, instead of a blur
DEBUG = [("DEBUG", 0, ["metres", "coc"], ["result"])]
