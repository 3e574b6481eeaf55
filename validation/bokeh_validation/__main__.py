"""`python -m bokeh_validation`: the command line of `validation/run`."""

from bokeh_validation.cli import main

# a process of lab/jobs.py imports this module too
if __name__ == "__main__":
    main()
