"""The package is fully typed, and the stub of the extension module says what the module holds."""

import importlib.util
import inspect
import pathlib
import subprocess
import sys

import pytest

import g3r
from g3r import _g3r

needs_mypy = pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
PACKAGE = pathlib.Path(g3r.__file__).parent


def run(folder, *arguments):
    done = subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr


@needs_mypy
def test_mypy_accepts_the_package(tmp_path):
    run(tmp_path, "mypy", "--strict", "-p", "g3r")


@needs_mypy
def test_mypy_knows_what_calls_return(tmp_path):
    (tmp_path / "use.py").write_text(
        "import g3r\nimport numpy as np\n"
        "v, f = g3r.reconstruct([[0.0, 0.0, 0.0]])\n"
        "v, f, c = g3r.reconstruct([[0.0, 0.0, 0.0]], colors=[[0, 0, 0]])\n"
        "total: float = float(g3r.run([[0.0, 0.0, 0.0]]).field([[0.0, 0.0, 0.0]]).sum())\n"
        "cloud: g3r.Cloud = g3r.read('a.ply')\n")
    run(tmp_path, "mypy", "--strict", "use.py")


def test_the_stub_names_what_the_module_holds():
    stub = (PACKAGE / "_g3r.pyi").read_text()
    for name in dir(_g3r):
        if not name.startswith("_"):
            assert f"def {name}(" in stub or f"class {name}:" in stub, name


def test_everything_public_is_documented():
    for name in g3r.__all__:
        thing = getattr(g3r, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
                    assert (value.fget if isinstance(value, property) else value).__doc__, f"{name}.{member}"


def test_import_loads_no_other_package():
    code = (f"import sys\nsys.path = {sys.path!r}\nimport g3r\n"
            "files = {m: str(getattr(sys.modules[m], '__file__', '')) for m in sys.modules}\n"
            "print(sorted({m.split('.')[0] for m in files if 'site-packages' in files[m]} - {'g3r'}))")
    done = subprocess.run([sys.executable, "-S", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]", "NumPy is for the first call, all others are for those who have them"
