"""Mesa's Vulkan on the processor, which the samples of Bevy and Vulkan run on."""

from pathlib import Path

from bokeh_validation import needs
from bokeh_validation.errors import Unavailable


def description() -> Path:
    """The description of lavapipe, Mesa's Vulkan on the processor. Raises Unavailable."""
    drivers = sorted(Path("/usr/share/vulkan/icd.d").glob("lvp_icd*.json"))
    if not drivers:
        raise Unavailable(f"no Vulkan driver; {needs.install('vulkan')}")
    return drivers[0]
