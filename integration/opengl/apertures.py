"""Other shapes, and the debug view: functions to take in place of exact_hexagon."""

from functools import partial
from math import radians

from depth_of_field import METRES, shader
from renderer import FullScreenPass, texture


class Passes:
    """Collects passes that all read the same depth."""

    def __init__(self, context, color, depth):
        self.context, self.size = context, color.size
        self.full_screen = partial(FullScreenPass, context, shader("FULL_SCREEN"))
        self.metres = texture(context, color.size, "R32F nearest")
        self.passes = [self.full_screen(shader("METRES", METRES), {"BokehDepthSamp": depth}, [self.metres])]
        (self.coc,) = self.add("COC_MAP", color)

    def add(self, name, *colors, targets=1, **parameters):
        """One pass, with parameters of its own. Returns its targets."""
        slots = dict(zip(("BokehColorSamp", "BokehColorSampB", "BokehColorSampC"), colors, strict=False))
        made = [texture(self.context, self.size, "RGBA16F linear") for _ in range(targets)]
        self.passes.append(self.full_screen(shader(name), {"BokehDepthSamp": self.metres, **slots}, made, **parameters))
        return made

    def line(self, degrees, source, other=None):
        """A line of the paper's method; with `other`, the last one, which takes the smaller of the two."""
        if other is None:
            (result,) = self.add("ADAPTIVE", source, BokehAngle=radians(degrees))
        else:
            (result,) = self.add("ADAPTIVE_FINAL", source, other, BokehAngle=radians(degrees))
        return result


def exact_octagon(context, color, depth):
    """Two passes, three targets between them."""
    made = Passes(context, color, depth)
    targets = made.add("OCTAGON_FIRST", made.coc, targets=3)
    (result,) = made.add("OCTAGON_SECOND", *targets)
    return made.passes, result


def paper_hexagon(context, color, depth):
    """Two parallelograms that share the upright line."""
    made = Passes(context, color, depth)
    upright = made.line(90, made.coc)
    return made.passes, made.line(150, upright, made.line(30, upright))


def paper_octagon(context, color, depth):
    """Two squares, the second turned by 45 degrees."""
    made = Passes(context, color, depth)
    square = made.line(90, made.line(0, made.coc))
    return made.passes, made.line(135, made.line(45, made.coc), square)


def debug(context, color, depth):
    """What BokehDebugMode says: 0 colour, 1 depth, 2 CoC, 3 near and far field."""
    made = Passes(context, color, depth)
    (result,) = made.add("DEBUG", made.coc)
    return made.passes, result
