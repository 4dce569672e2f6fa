# SPDX-License-Identifier: BSD-3-Clause
"""The lines of docs/python.md and the example run as they stand, and the notebook is that example, executed without an error."""
import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "plugins/python/examples"


def test_the_lines_of_the_page(monkeypatch, capsys):
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs/python.md").read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) >= 8
    monkeypatch.chdir(ROOT)
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)  # one after the other, as a reader types them
    said = capsys.readouterr().out
    assert "limit-angle" in said and "too few views" in said and "--set predict.directions" in said and "stopped" in said


def test_the_example(tmp_path):
    pytest.importorskip("matplotlib")
    done = subprocess.run([sys.executable, "-B", EXAMPLES / "highlights.py", "--pictures", tmp_path], capture_output=True, text=True, check=False,
                          env={**os.environ, "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(tmp_path)})
    assert done.returncode == 0, done.stderr
    assert {"python-frame.png", "python-errors.png"} <= {f.name for f in tmp_path.iterdir()}
    off = float(re.search(r"off by +([0-9.]+) mm", done.stdout)[1])
    assert off < 1, done.stdout  # the lamp of the scene is known; it is 2.6 m away


def test_the_notebook_is_the_example():
    script = (EXAMPLES / "highlights.py").read_text(encoding="utf-8")
    cells = re.findall(r"^# %%( \[markdown\])?\n(.*?)(?=^# %%|\Z)", script, re.M | re.S)
    notebook = json.loads((EXAMPLES / "highlights.ipynb").read_text(encoding="utf-8"))["cells"]
    assert len(cells) == len(notebook)
    for (kind, body), cell in zip(cells, notebook):
        text = re.sub(r"^# ?", "", body, flags=re.M).strip() if kind else body.strip()
        assert "".join(cell["source"]) == text, "run plugins/python/examples/make_notebook.py"
        assert cell["cell_type"] == ("markdown" if kind else "code")
        assert not any(o["output_type"] == "error" for o in cell.get("outputs", []))
    code = [c for c in notebook if c["cell_type"] == "code"]
    assert all(c["execution_count"] for c in code) and sum(bool(c["outputs"]) for c in code) >= 6
