"""The notebook and the lines of the readme do what they say."""

import json
import pathlib
import re

import numpy as np
import pytest
from conftest import is_outward

import g3r

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_the_notebook_runs():
    cells = json.loads((ROOT / "examples" / "quick_start.ipynb").read_text())["cells"]
    names = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            assert not cell["outputs"], "the notebook is kept without outputs"
            exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
    assert names["right"].all()


def test_the_readme_runs(monkeypatch, sphere):
    monkeypatch.setattr("webbrowser.open", lambda url: None)
    block = next(b for b in re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S) if "import g3r" in b)
    names = {"P": sphere, "RGB": np.zeros(sphere.shape, np.uint8), "Q": np.zeros((1, 3))}
    exec(compile(block, "README.md", "exec"), names)
    assert is_outward(names["N"], sphere) and names["inside"].tolist() == [True]


@pytest.mark.parametrize("page", ["python.md", "start.md"])
def test_pages_name_what_there_is(page):
    for name in re.findall(r"\bg3r\.(\w+)\(", (ROOT / "docs" / page).read_text()):
        assert hasattr(g3r, name), name
