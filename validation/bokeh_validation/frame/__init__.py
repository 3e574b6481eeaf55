"""A method's frame as data: settings, passes, apertures, counts."""
