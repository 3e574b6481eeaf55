"""Skip the tests of the lab until something changes in the lab, the core, the shaders or what they draw."""

import pytest
from support_inputs import OF_LAB, SHADER_TEXT

# Tests of what was recorded of the shaders as they are; the others test the lab's own code
OF_SHADERS = ("test_isa.py", "test_mutants.py", "test_pictures.py")


def pytest_itemcollected(item):
    """Mark every test of this folder with its inputs, except those that have inputs of their own."""
    if not item.get_closest_marker("inputs"):
        leave_out = () if item.path.name in OF_SHADERS else SHADER_TEXT
        item.add_marker(pytest.mark.inputs(*OF_LAB, leave_out=leave_out))
