"""Every variable of the passes half alone: which of them ruins the picture."""

from collections.abc import Callable
from dataclasses import dataclass

from bokeh_validation.half import frames, program
from bokeh_validation.half.choice import ALLOWED
from bokeh_validation.half.evaluate import MAIN, Choice
from bokeh_validation.half.numbers import HALF

# A variable by itself: an eighth of a pixel as in choice.LIMITS, and a picture as close as 60 dB
MOST_MOVED, LEAST_PSNR = 0.125, 60.0
# function -> a method of frames.METHODS that calls it
USED_BY = {
    "BokehCoCMap": "paper",
    "BokehDepthOfField": "paper",
    "BokehNoise": "exact",
    "BokehLineMean": "exact",
    "BokehDepthOfFieldAdaptive": "paper, adaptive",
    "BokehNaiveGather": "naive",
    "BokehNaiveGrid": "naive-grid",
    "BokehExactFirst": "exact",
    "BokehExactSecond": "exact",
    "BokehExactEdge": "exact, one target",
}


@dataclass(frozen=True)
class Variable:
    """A variable that alone was half."""

    function: str
    name: str
    outcome: frames.Outcome

    @property
    def harmless(self) -> bool:
        """Within the limits for one variable, on this picture."""
        outcome = self.outcome
        return outcome.lost == 0.0 and outcome.moved <= MOST_MOVED and outcome.psnr >= LEAST_PSNR

    @property
    def allowed(self) -> bool:
        """Whether we say that it may be half."""
        return ALLOWED.of(self.function, self.name) == HALF


def variables() -> list[tuple[str, str]]:
    """(function, name) of all floating variables and parameters of the functions in USED_BY, and uv of main()."""
    found = [(MAIN, "BokehUV")]
    for name in USED_BY:
        function = program.library()[name]
        parameters = [key for key, kind in function.parameters.items() if kind not in ("int", "bool", "sampler2D")]
        found += [(name, variable) for variable in (*parameters, *function.locals)]
    return found


def measured(step: Callable[[str], None] = lambda _: None) -> list[Variable]:
    """Each of variables() half alone."""
    result = []
    for function, name in variables():
        frame = frames.frame(USED_BY.get(function, "exact"), frames.SMALL)
        result.append(Variable(function, name, frame.outcome(Choice({function: frozenset([name])}))))
        step(f"{function} {name}")
    return result
