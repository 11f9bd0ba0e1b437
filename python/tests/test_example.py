"""The example's comparison with VQF and Madgwick's filter, on the recording with a magnet on the sensor."""

import runpy

from conftest import ROOT


def test_other_filters_are_better_with_corrected_samples():
    example = runpy.run_path(str(ROOT / "python/examples/compare.py"))
    found = example["compare"](example["RECORDING"])
    error = {name: value for name, (value, _) in found.items()}
    assert 2.0 < error["VQF, raw"] < 3.5 and 0.5 < error["VQF, corrected by magcomp"] < 0.5 * error["VQF, raw"], found
    assert 3.0 < error["Madgwick, raw"] < 4.5 and 1.0 < error["Madgwick, corrected by magcomp"] < 0.7 * error["Madgwick, raw"], found
    assert 0.8 < error["magcomp"] < 0.6 * error["VQF, raw"], found
    assert min(count for _, count in found.values()) > 3000
