"""`python -m bokeh_validation`: the command line of `validation/run`."""

from bokeh_validation.cli import main

main()
