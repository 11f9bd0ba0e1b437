"""The examples, on the recording with a magnet on the sensor: the comparison with VQF and Madgwick's filter, the notebook."""

import re
import runpy

import nbclient
import nbformat

from conftest import ROOT


def test_other_filters_are_better_with_corrected_samples():
    example = runpy.run_path(str(ROOT / "python/examples/compare.py"))
    found = example["compare"](example["RECORDING"])
    error = {name: value for name, (value, _) in found.items()}
    assert 2.0 < error["VQF, raw"] < 3.5 and 0.5 < error["VQF, corrected by magcomp"] < 0.5 * error["VQF, raw"], found
    assert 3.0 < error["Madgwick, raw"] < 4.5 and 1.0 < error["Madgwick, corrected by magcomp"] < 0.7 * error["Madgwick, raw"], found
    assert 0.8 < error["magcomp"] < 0.6 * error["VQF, raw"], found
    assert min(count for _, count in found.values()) > 3000


def test_the_notebook_runs_and_shows_a_heading_within_its_sigmas():
    path = ROOT / "python/examples/heading.ipynb"
    notebook = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "it is kept without what it printed"
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": path.parent}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    text = "".join(output.get("text", "") for output in outputs)
    rms, within = re.search(r"rms ([0-9.]+) deg; within two sigmas (\d+)%", text).groups()
    assert 0.3 < float(rms) < 3 and 80 <= int(within) <= 100, text
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 1
