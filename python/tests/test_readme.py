"""The first page's code prints what the page says."""

import re

from conftest import ROOT


def test_the_first_pages_code_prints_its_line(capsys, monkeypatch):
    readme = (ROOT / "README.md").read_text()
    code, shown = re.search(r"```python\n(.*?)```\n\nprints `(.*?)`", readme, re.S).groups()
    monkeypatch.chdir(ROOT)
    exec(code, {})
    assert capsys.readouterr().out == shown + "\n"
