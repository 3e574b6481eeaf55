"""The three languages are one text, and this is what checks it.

HLSL and WGSL are rewritten to GLSL, word by word, with all that is porting taken away; then the three are compared
statement by statement and comment by comment. What cannot be rewritten, because it is not written as that language's
other text is, gets a '?' and so is a difference. A statement that has to deviate ends in `// differs: reason`, and the
reason must be found in docs/paper.md.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from functools import lru_cache
from itertools import combinations, zip_longest
from os import PathLike, fspath
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from bokeh_validation.entries import ENTRIES as ALL_ENTRIES
