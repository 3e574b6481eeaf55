"""Hold what describes a method's frame as data: settings, passes, apertures, counts."""
