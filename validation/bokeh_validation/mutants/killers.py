"""The tests that are run first, by the part of the shaders that they look at; each takes a few seconds."""

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
ADAPTIVE_TRIANGLE = on("egl", EXACT, "test_adaptive_paper_on_noise", "triangle")
DEBUG = on("egl", DRIVERS, "test_debug_views")
TINY = on("egl", DRIVERS, "test_depth_of_a_tenth_of_a_millimetre")
COUNTED = on("d3d9", "test_hostile.py", "test_bad_pixels_count_as_documented")
VIEWPORTS = on("egl", "test_viewport.py", "test_nothing_leaks_in")
DEFAULTS = Selection((SURVIVORS,), "test_defaults")
PRESETS = Selection((SURVIVORS,), "test_presets")
SIGNED = on("egl", SURVIVORS, "test_signed_map")
# runs BokehDefaultFilter in NumPy
STRUCTS = Selection(("test_precision.py",), "test_the_default_filter_is_section_1")
EACH_PASS = on("egl", EXACT, "test_every_frame_and_pass_has_its_own_noise")
DENSE = Selection((EXACT,), "test_jitter_leaves_dense_samples_alone")
# few samples on a wide blur, where the noise counts
JITTER = on("egl", SURVIVORS, "test_jitter_of_the_exact_passes", "hexagon")
OUT_OF_RANGE = Selection(("test_hostile.py",), "test_parameters_out_of_range and egl and (BokehSides or BokehEdge)")
LAYERS = "test_layers.py"
LAYERED_MUTANTS = "test_layers_mutants.py"
# pass by pass within the reference's intervals; where both layers are full, then all settings
LAYERED = on("osmesa", LAYERED_MUTANTS, "(test_both_layers or test_half_a_layer)")
LAYERED_MANY = on("osmesa", LAYERS, "test_settings")
LAYERED_ONE_TARGET = on("osmesa", LAYERS, "test_settings", "targets")
LAYERED_PLACE = on("osmesa", LAYERED_MUTANTS, "test_layers_of_a_viewport")
LAYERED_LEAKS = on("osmesa", LAYERED_MUTANTS, "test_nothing_leaks")
LAYERED_INVERSE = Selection((LAYERED_MUTANTS,), "test_a_size_whose_inverse")
LAYERED_LEVELS = on("osmesa", LAYERED_MUTANTS, "test_black_and_bright")
LAYERED_MADE = Selection((LAYERED_MUTANTS,), "test_layers_without_jitter")
