"""One example; which one, and what is changed to end it earlier, stands in the environment."""
import os

from program import run_example


def test_example():
    run_example(os.environ["VBOND_EXAMPLE"], *filter(None, os.environ["VBOND_EXAMPLE_SETS"].split(",")))
