"""A few cases of campaign.py, which takes any number of them."""

import pytest

from campaign import campaign


@pytest.mark.filterwarnings("ignore::vbond.RunWarning")
def test_random_cases_are_as_the_program_computes_them():
    counts = campaign(cases=8, seed=7)
    assert counts["wrong"] == 0
    assert counts["same"] >= 6
