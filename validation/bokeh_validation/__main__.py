"""Start the command line of `validation/run` from `python -m bokeh_validation`."""

from bokeh_validation.cli import main

# A worker process of lab/jobs.py imports this module too and must not start the command line.
if __name__ == "__main__":
    main()
