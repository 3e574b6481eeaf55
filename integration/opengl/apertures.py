"""Other shapes, and the debug view: functions to take in place of exact_hexagon."""

from functools import partial
from math import radians

from depth_of_field import shader
from renderer import FullScreenPass, texture


class Passes:
    """Collects passes. The first two make depth linear and write the CoC map: SIGNED_COC_MAP, or COC_MAP for paper."""

    def __init__(self, context, color, depth, coc_map="SIGNED_COC_MAP"):
        self.context, self.size = context, color.size
        self.full_screen = partial(FullScreenPass, context, shader("FULL_SCREEN"))
        self.metres = texture(context, color.size, "R32F")
        self.passes = [self.full_screen(shader("LINEAR_DEPTH"), {"BokehDepthSamp": depth}, [self.metres])]
        (self.coc,) = self.add(coc_map, color, BokehDepthSamp=self.metres)

    def add(self, name, color, targets=1, parameters=None, **textures):
        """One pass, with parameters of its own. Returns its targets."""
        made = [texture(self.context, self.size, "RGBA16F") for _ in range(targets)]
        textures = {"BokehColorSamp": color, **textures}
        self.passes.append(self.full_screen(shader(name), textures, made, **(parameters or {})))
        return made

    def line(self, degrees, source, **other):
        """A line of the paper's method; with BokehColorSampB, the last one, which takes the smaller of the two."""
        name = "ADAPTIVE_FINAL" if other else "ADAPTIVE"
        parameters = {"BokehAngle": radians(degrees)}
        (result,) = self.add(name, source, parameters=parameters, BokehDepthSamp=self.metres, **other)
        return result


def exact_octagon(context, color, depth):
    """Two passes, three targets between them."""
    made = Passes(context, color, depth)
    t2, t3, t4 = made.add("OCTAGON_FIRST", made.coc, targets=3)
    (result,) = made.add("OCTAGON_SECOND", t2, BokehColorSampB=t3, BokehColorSampC=t4)
    return made.passes, result


def paper_hexagon(context, color, depth):
    """Two parallelograms that share the upright line."""
    made = Passes(context, color, depth, "COC_MAP")
    upright = made.line(90, made.coc)
    return made.passes, made.line(150, upright, BokehColorSampB=made.line(30, upright))


def paper_octagon(context, color, depth):
    """Two squares, the second rotated by 45 degrees."""
    made = Passes(context, color, depth, "COC_MAP")
    square = made.line(90, made.line(0, made.coc))
    return made.passes, made.line(135, made.line(45, made.coc), BokehColorSampB=square)


def debug(context, color, depth):
    """What BokehDebugMode says: 0 colour, 1 depth, 2 CoC, 3 near and far field."""
    made = Passes(context, color, depth)
    (result,) = made.add("DEBUG", made.coc, BokehDepthSamp=made.metres)
    return made.passes, result
