"""Other shapes and methods, and the debug view: tables to take in place of HEXAGON."""

from math import radians

from depth_of_field import HEXAGON

COC_MAP = ("SIGNED_COC_MAP", "color", "coc", 1, {})

# three targets between the passes over a layer; the first nine passes are the hexagon's
OCTAGON = [
    *HEXAGON[:9],
    ("LAYER_FILL", "middle_holes far_holes shares reach", "middle back", 4, {"BokehSides": 8}),
    ("OCTAGON_LAYER_FIRST", "near sizes", "near2 near3 near4", 2, {"BokehLayer": 0}),
    ("OCTAGON_LAYER_SECOND", "near2 near3 near4 - sizes", "near_blurred", 2, {"BokehLayer": 0}),
    ("OCTAGON_LAYER_FIRST", "far sizes", "far2 far3 far4", 2, {"BokehLayer": 1}),
    ("OCTAGON_LAYER_SECOND", "far2 far3 far4 - sizes", "far_blurred", 2, {"BokehLayer": 1}),
    ("LAYERED", "coc reaches near_blurred far_blurred middle back", "result", 1, {"BokehSides": 8}),
]

# one layer: cheaper and sharper, but near things keep their outline
EXACT_HEXAGON = [
    COC_MAP,
    ("HEXAGON_FIRST", "coc", "t2 t3", 1, {}),
    ("HEXAGON_SECOND", "t2 t3", "result", 1, {}),
]
EXACT_OCTAGON = [
    COC_MAP,
    ("OCTAGON_FIRST", "coc", "t2 t3 t4", 1, {}),
    ("OCTAGON_SECOND", "t2 t3 t4", "result", 1, {}),
]

# two parallelograms that share the upright line
PAPER_HEXAGON = [
    ("COC_MAP", "color", "coc", 1, {}),
    ("ADAPTIVE", "coc", "upright", 1, {"BokehAngle": radians(90)}),
    ("ADAPTIVE", "upright", "left", 1, {"BokehAngle": radians(30)}),
    ("ADAPTIVE_FINAL", "upright left", "result", 1, {"BokehAngle": radians(150)}),
]
# two squares, the second rotated by 45 degrees
PAPER_OCTAGON = [
    ("COC_MAP", "color", "coc", 1, {}),
    ("ADAPTIVE", "coc", "across", 1, {"BokehAngle": radians(0)}),
    ("ADAPTIVE", "across", "square", 1, {"BokehAngle": radians(90)}),
    ("ADAPTIVE", "coc", "rising", 1, {"BokehAngle": radians(45)}),
    ("ADAPTIVE_FINAL", "rising square", "result", 1, {"BokehAngle": radians(135)}),
]

# what BokehDebugMode says: 0 colour, 1 depth, 2 CoC, 3 near and far field
DEBUG = [COC_MAP, ("DEBUG", "coc", "result", 1, {})]
