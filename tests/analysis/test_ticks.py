"""Ticks of logarithmic axes are few and plain."""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

from barrierbench_analysis.figures import style
from barrierbench_analysis.figures.ticks import places, words


@pytest.mark.parametrize(("low", "high", "expected"), [
    (0.3, 8, ["0.5", "1", "2", "5"]), (33, 62, ["40", "50", "60"]), (0.5, 2000, ["1", "3", "10", "30", "100", "300", "1000"]), (0.2, 0.65, ["0.2", "0.5"]),
    (3e2, 2e9, ["$10^{3}$", "$10^{4}$", "$10^{5}$", "$10^{6}$", "$10^{7}$", "$10^{8}$", "$10^{9}$"]), (30000, 70000, ["30000", "40000", "50000", "60000", "70000"])])
def test_ticks(low, high, expected):
    assert words(places(low, high)) == expected


@pytest.mark.parametrize("high", [1.3, 3, 40, 1e3, 1e7, 1e16])
def test_there_are_two_at_least_and_never_many(high):
    assert 2 <= len(places(0.97, high)) <= 7


def test_a_saved_figure_has_no_products_with_powers_of_ten(tmp_path):
    fig, axes = plt.subplots(1, 2)
    axes[0].loglog([1, 70], [0.2, 0.65])
    axes[1].semilogy([1, 2], [1, 2])
    axes[1].set_yticks([1.5], ["own"])
    own = axes[1].yaxis.get_major_formatter()
    style.save(fig, tmp_path / "f", pd.DataFrame({"a": [1]}), "shown")
    fig.canvas.draw()
    texts = [label.get_text() for label in (*axes[0].get_yticklabels(which="both"), *axes[0].get_xticklabels(which="both"))]
    assert {"0.2", "0.5", "1", "10", "50"} <= set(texts) and not any("times" in text for text in texts)
    assert axes[1].yaxis.get_major_formatter() is own and np.array_equal(axes[1].get_yticks(), [1.5])
