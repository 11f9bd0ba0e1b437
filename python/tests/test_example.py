"""The example's comparison with VQF, on the recording with a magnet on the sensor."""

import runpy

from conftest import ROOT


def test_vqf_halves_its_error_with_corrected_samples():
    example = runpy.run_path(str(ROOT / "python/examples/compare.py"))
    found = example["compare"](example["RECORDING"])
    raw, corrected, own = (found[name][0] for name in ("VQF, raw", "VQF, corrected by magcomp", "magcomp"))
    assert 2.0 < raw < 3.5 and 0.5 < corrected < 0.5 * raw and 0.8 < own < 0.6 * raw, found
    assert min(count for _, count in found.values()) > 3000
