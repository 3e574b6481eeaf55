"""The engine samples of integration/, run with their own colour and depth and compared with the reference."""

from bokeh_validation.engines.capture import Broken, Capture, Shot, read
from bokeh_validation.engines.catalog import ENGINES, Engine, run

__all__ = ["ENGINES", "Broken", "Capture", "Engine", "Shot", "read", "run"]
