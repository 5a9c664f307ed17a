"""The lines of docs/integrations.md do what they say."""

import json
import pathlib
import re

import numpy as np
import pytest
from conftest import is_outward

import g3r

PAGE = (pathlib.Path(__file__).resolve().parents[2] / "docs" / "integrations.md").read_text()
PLACE = np.array([500000.0, 5400000.0, 100.0])  # as of a survey


def block(language, word):
    """The only block of code in this language that has the word."""
    (found,) = (code for code in re.findall(rf"```{language}\n(.*?)```", PAGE, re.S) if word in code)
    return found


def run(code):
    names = {}
    exec(compile(code, "integrations.md", "exec"), names)
    return names


@pytest.fixture
def in_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("in_folder")
def test_laspy(sphere):
    laspy = pytest.importorskip("laspy")
    scan = laspy.create(point_format=3, file_version="1.4")
    scan.header.offsets, scan.header.scales = PLACE, [1e-4] * 3
    scan.xyz, scan.intensity = sphere + PLACE, np.arange(len(sphere))
    scan.write("scan.laz")
    run(block("python", "laspy"))
    las = laspy.read("oriented.las")
    np.testing.assert_array_equal(las.intensity, np.arange(len(sphere)))
    assert is_outward(np.stack([las.NormalX, las.NormalY, las.NormalZ], axis=1), sphere) and las.confidence.min() > 0.5
    cloud = g3r.read("oriented.las")
    assert is_outward(cloud.normals, sphere)
    np.testing.assert_array_equal(cloud.confidence, las.confidence)


def test_the_function_for_pdal(sphere):
    ins = dict(zip("XYZ", (sphere + PLACE).T.copy()), Intensity=np.zeros(len(sphere), np.uint16))
    outs = {}
    assert run(block("python", "outs"))["orient"](ins, outs) is True
    _, stage, writer = json.loads(block("json", "filters.python"))
    assert stage["function"] == "orient" and stage["add_dimension"] == list(outs) and writer["extra_dims"] == "all"
    for values in outs.values():  # PDAL looks at the size of the type and at the first byte, not at strides
        assert values.dtype == np.float64 and values.shape == (len(sphere),) and values.flags.c_contiguous
    assert is_outward(np.stack([outs["NormalX"], outs["NormalY"], outs["NormalZ"]], axis=1), sphere) and outs["confidence"].min() > 0.5


@pytest.mark.usefixtures("in_folder")
def test_the_console_of_qgis(sphere, monkeypatch):
    core = pytest.importorskip("qgis.core", reason="QGIS is not installed: apt-get install python3-qgis")
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    application = core.QgsApplication([], False)
    application.initQgis()
    g3r.write("scan.las", sphere + PLACE)
    names = run(block("python", "qgis.core").replace("scan.laz", "scan.las"))
    (mesh,) = (layer for layer in core.QgsProject.instance().mapLayers().values() if layer.name() == "surface")
    assert mesh.isValid() and mesh.dataProvider().faceCount() == len(names["result"].faces)
    assert mesh.extent().center().distance(*PLACE[:2]) < 0.1
    data = mesh.dataProvider()
    assert "confidence" in [data.datasetGroupMetadata(i).name() for i in range(data.datasetGroupCount())]
    if "pdal" in core.QgsProviderRegistry.instance().providerList():
        assert core.QgsProject.instance().mapLayersByName("oriented")[0].isValid()
    core.QgsProject.instance().clear()
    application.exitQgis()
