"""The tests that are asked first, by the part of the shaders that they look at; each takes a few seconds."""

from bokeh_validation.mutants.model import Selection

DRIVERS, INPUTS, EXACT, SURVIVORS = "test_drivers.py", "test_inputs.py", "test_exact.py", "test_survivors.py"


def on(driver: str, file: str, *names: str) -> Selection:
    """Tests of a file on a driver whose id holds all of `names`."""
    return Selection((file,), " and ".join((*names, driver)))


PARITY = Selection(("test_parity.py",), "test_the_checkout_passes")
LIMITS = on("egl", INPUTS, "test_camera_at_its_limits")
DEPTHS = on("egl", INPUTS, "test_same_coc_from_every_convention", "32")
BAD_DEPTHS = on("egl", INPUTS, "test_bad_depth_of_every_convention")
DEPTH_ENDS = on("egl", INPUTS, "test_ends_of_the_range")
HOSTILE = on("egl", DRIVERS, "test_first_pass_makes_hostile_pixels_safe")
REJECTED = on("egl", DRIVERS, "rejected")
PAPER = on("egl", DRIVERS, "test_settings", "paper")
STAR = on("egl", DRIVERS, "test_settings", "paper", "star")
NAIVE = Selection((DRIVERS,), "egl and test_settings and naive and not grid")
GRID = on("egl", DRIVERS, "test_settings", "grid")
EXACT_FIXED = on("egl", DRIVERS, "test_settings", "exact")
EXACT_TARGETS = on("egl", DRIVERS, "test_several_targets")
EXACT_HEXAGON = on("egl", EXACT, "test_exact_on_noise", "hexagon")
EXACT_DECAGON = on("egl", EXACT, "test_exact_on_noise", "decagon")
ADAPTIVE_HEXAGON = on("egl", EXACT, "test_adaptive_paper_on_noise", "hexagon")
ADAPTIVE_STAR = on("egl", EXACT, "test_adaptive_paper_on_noise", "star")
ADAPTIVE_TRIANGLE = on("egl", EXACT, "test_adaptive_paper_on_noise", "triangle")
DEBUG = on("egl", DRIVERS, "test_debug_views")
TINY = on("egl", DRIVERS, "test_depth_of_a_tenth_of_a_millimetre")
COUNTED = on("d3d9", "test_hostile.py", "test_bad_pixels_count_as_documented")
# where half floats are rounded to nearest: Mesa cuts off, and its sums never get there
CLIPPED = on("webgpu", "test_hostile.py", "test_clipped_highlights_do_not_overflow")
VIEWPORTS = on("egl", "test_viewport.py", "test_nothing_leaks_in")
DEFAULTS = Selection((SURVIVORS,), "test_defaults")
