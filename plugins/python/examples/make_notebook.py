#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes highlights.ipynb from highlights.py, executed: PYTHONPATH=build/ci/python plugins/python/examples/make_notebook.py

Needs Debian's jupyter-nbconvert and python3-ipykernel."""
import pathlib
import re

import nbformat
from nbconvert.preprocessors import ExecutePreprocessor


def cells_of(script):
    """The cells of a script in "percent" form; what precedes the first is not part of the notebook."""
    for kind, body in re.findall(r"^# %%( \[markdown\])?\n(.*?)(?=^# %%|\Z)", script, re.M | re.S):
        if kind:
            yield nbformat.v4.new_markdown_cell(re.sub(r"^# ?", "", body, flags=re.M).strip())
        else:
            yield nbformat.v4.new_code_cell(body.strip())


def main():
    here = pathlib.Path(__file__).resolve().parent
    notebook = nbformat.v4.new_notebook(cells=list(cells_of((here / "highlights.py").read_text(encoding="utf-8"))))
    for number, cell in enumerate(notebook.cells):
        cell["id"] = f"cell-{number}"  # the same in every run
    notebook.metadata["kernelspec"] = {"display_name": "Python 3", "language": "python", "name": "python3"}
    ExecutePreprocessor(timeout=300, kernel_name="python3",
                        record_timing=False).preprocess(notebook, {"metadata": {"path": str(here)}})
    nbformat.write(notebook, here / "highlights.ipynb")


main()
