"""The tests that are asked first, by the function that a mutant changes: the quickest that notice.

A test is FILE::TEST, or FILE::TEST[WORDS] for those of its parameters whose id holds every word. The run checks that
each is there.
"""

PARITY = "test_parity.py::test_the_checkout_passes"
HOSTILE = "test_drivers.py::test_first_pass_makes_hostile_pixels_safe[egl]"
LIMITS = "test_inputs.py::test_camera_at_its_limits[egl]"
TINY = "test_drivers.py::test_depth_of_a_tenth_of_a_millimetre[egl]"
DEPTHS = "test_inputs.py::test_same_coc_from_every_convention[egl 32]"
BAD_DEPTHS = "test_inputs.py::test_bad_depth_of_every_convention[egl]"
DEPTH_ENDS = "test_inputs.py::test_ends_of_the_range[egl]"
SIGNED = "test_survivors.py::test_signed_map[egl]"
PAPER = "test_drivers.py::test_settings[egl paper]"
STAR = "test_drivers.py::test_settings[egl paper star]"
REJECTED = "test_drivers.py::test_every_sample_rejected[egl]"
NEARLY_REJECTED = "test_drivers.py::test_nearly_rejected_samples_still_count[egl]"
NAIVE = "test_drivers.py::test_settings[egl naive-{]"
GRID = "test_drivers.py::test_settings[egl naive-grid]"
# on Direct3D 9 alone is every sample nearer than NaN
COUNTED = "test_hostile.py::test_bad_pixels_count_as_documented[d3d9]"
EXACT = "test_drivers.py::test_settings[egl exact]"
TARGETS = "test_drivers.py::test_several_targets[egl]"
HEXAGON = "test_exact.py::test_exact_on_noise[egl hexagon]"
DECAGON = "test_exact.py::test_exact_on_noise[egl decagon]"
ADAPTIVE = "test_exact.py::test_adaptive_paper_on_noise[egl hexagon]"
TRIANGLE = "test_exact.py::test_adaptive_paper_on_noise[egl triangle]"
DENSE = "test_exact.py::test_jitter_leaves_dense_samples_alone"
# few samples on a wide blur, where the noise counts
JITTER = "test_survivors.py::test_jitter_of_the_exact_passes[egl hexagon]"
EACH_PASS = "test_exact.py::test_every_frame_and_pass_has_its_own_noise[egl]"
LEAKS = "test_viewport.py::test_nothing_leaks_in[egl]"
COLUMN = "test_viewport.py::test_a_column[egl]"
DEBUG = "test_drivers.py::test_debug_views[egl]"
OUT_OF_RANGE = (
    "test_hostile.py::test_parameters_out_of_range[egl BokehSides]",
    "test_hostile.py::test_parameters_out_of_range[egl BokehEdge]",
)
# pass by pass within the reference's intervals; where both layers are full, then all settings
LAYERED = (
    "test_expected.py::test_every_pass",
    "test_layers_mutants.py::test_within[egl half]",
    "test_layers_mutants.py::test_within[egl both]",
    "test_layers.py::test_settings[osmesa]",
)
CUT = (
    "test_character.py::test_exact_on_noise[egl {} hexagon]",
    "test_character.py::test_exact_on_noise[egl rotation decagon]",
    "test_character.py::test_exact_on_noise[egl targets decagon]",
    "test_character.py::test_exact_on_noise[egl 5.0 decagon]",
)
CUT_MADE = "test_character.py::test_made_for_a_cut"
ROUND = (
    "test_character.py::test_curved_blades[egl 0.5]",
    "test_character.py::test_curved_blades[egl -1.0]",
)
LATERAL = (
    "test_chromatic.py::test_lateral_on_noise[egl 5.0]",
    "test_chromatic.py::test_lateral_in_a_viewport[egl]",
)
AXIAL = (
    "test_chromatic.py::test_axial_on_noise[egl {} hexagon]",
    "test_chromatic.py::test_axial_on_noise[egl targets decagon]",
)
CUT_LAYERS = (
    "test_character.py::test_layered_on_noise[egl 0.9]",
    "test_character.py::test_layered_on_noise[egl 17.0]",
    "test_character.py::test_layered_on_noise[egl octagon]",
    "test_character.py::test_layered_on_noise[egl decagon jitter]",
    "test_character.py::test_layered_on_noise[egl decagon targets]",
)
LAYERED_TARGET = "test_layers.py::test_settings[osmesa targets]"
LAYERED_PLACE = "test_layers_mutants.py::test_layers_of_a_viewport[egl]"
LAYERED_LEAKS = "test_layers.py::test_viewport[egl]"
LAYERED_INVERSE = "test_layers_mutants.py::test_within[inverse]"
LAYERED_LEVELS = "test_layers_mutants.py::test_within[egl bright]"
LAYERED_MADE = "test_layers_mutants.py::test_layers_without_jitter"


def survivor(name: str) -> str:
    """A test of test_survivors.py."""
    return f"test_survivors.py::{name}[egl]"


def on_device(driver: str) -> tuple[str, ...]:
    """Tests that show what a device makes of a language's porting, bindings and vertex shader."""
    return (
        f"test_drivers.py::test_first_pass_makes_hostile_pixels_safe[{driver}]",
        f"test_drivers.py::test_sizes[{driver} (61, 37)]",
        f"test_drivers.py::test_several_targets[{driver}]",
    )


# functions without 'Bokeh' -> killers; a name ends in * where more follow it
FIRST = {
    "CoC": (LIMITS, survivor("test_a_sensor_of_no_height")),
    "SafeChannel SafeDepth PackCoC CoCMap": (HOSTILE, LIMITS, survivor("test_every_channel_is_made_safe")),
    "LinearDepth DepthFrom*": (DEPTHS, BAD_DEPTHS, DEPTH_ENDS),
    "SignedCoC*": (SIGNED,),
    "LineEnd LeakageWeight DepthOfField Combine DepthOfFieldFinal": (PAPER,),
    "MakeOffsets": ("test_survivors.py::test_a_line_of_one_sample", PAPER),
    "DefaultFilter": (survivor("test_default_settings"),),
    "FilterCoC": (survivor("test_half_a_pixel_is_in_focus"), ADAPTIVE, HEXAGON),
    "Cells": (survivor("test_a_line_of_no_length"), JITTER, ADAPTIVE, HEXAGON),
    "Noise": (survivor("test_noise_comes_again"), JITTER, ADAPTIVE, HEXAGON),
    "Segment DepthOfFieldAdaptive AdaptiveLine": (ADAPTIVE, TRIANGLE, EACH_PASS),
    "Resolve": (REJECTED, NEARLY_REJECTED, PAPER),
    "NaiveGather": (NAIVE,),
    "NaiveGrid": (GRID,),
    "SignedLeakageWeight MakePolygon Rotated PolygonEdge ExactWeight": (EXACT, HEXAGON),
    "ExactTarget ExactFirst ExactSecond ChannelFirst ChannelSecond": (TARGETS, EXACT, HEXAGON, DECAGON),
    "LineSum": (JITTER, HEXAGON, EXACT, DENSE, survivor("test_squeezed_lines_have_means")),
    "ExactEdge ChannelEdge": (DECAGON, *OUT_OF_RANGE, JITTER),
    "Begin First Second Aperture": (JITTER, EXACT, HEXAGON, LEAKS),
    "OctagonFirst DecagonFirst": (TARGETS,),
    "UseViewport ToTexture SetViewport": (LEAKS, COLUMN),
    "LateralColor": LATERAL,
    "ChannelMask ChannelCoC": AXIAL,
    "Debug*": (DEBUG, survivor("test_debug_views_of_a_pinhole"), survivor("test_debug_views_of_the_near_field")),
}


def first(within: str | None) -> tuple[str, ...]:
    """For a function."""
    for names, killers in FIRST.items():
        if any(within == name or (name[-1] == "*" and within.startswith(name[:-1])) for name in names.split()):
            return killers
    return LAYERED
