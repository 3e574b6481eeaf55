"""Skip the tests of the lab until something changes in the lab, the core, the shaders or what they draw."""

import pytest
from support_inputs import OF_LAB


def pytest_itemcollected(item):
    """Mark every test of this folder with its inputs, except those that have inputs of their own."""
    if not item.get_closest_marker("inputs"):
        item.add_marker(pytest.mark.inputs(*OF_LAB))
