"""A method's frame as data: what `validation/run plan` prints, and what docs/passes.md is made from.

It is made from the passes that the drivers run (methods.plan), and holds all that an engine needs to draw them.
"""

import re
from collections.abc import Iterator
from typing import Annotated

from bokeh_validation.entries import COLORS, COPYING_ENTRIES
