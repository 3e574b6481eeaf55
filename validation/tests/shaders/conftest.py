"""Skip the tests of the shaders until something changes that they draw, draw with or compare with."""

import pytest
from support_inputs import DRAWN


def pytest_itemcollected(item):
    """Mark every test of this folder with its inputs."""
    item.add_marker(pytest.mark.inputs(*DRAWN))
