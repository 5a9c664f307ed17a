"""g3r.show, g3r.View."""

import json
import os
import re

import numpy as np
import pytest

import g3r
from g3r.__main__ import main


def data_of(view):
    return json.loads(re.search(r'id="scene-data">(.*?)</script>', view.html, re.S).group(1))


def test_a_result_shows_points_normals_mesh_and_report(result, sphere):
    data = data_of(g3r.show(result, open=False, title="ball & <co>"))
    assert data["points"]["shown"] == len(sphere) and "normal" in data["points"] and "confidence" in data["points"]
    assert data["mesh"]["given"] == len(result.faces) and data["report"]["schema"] == "g3r.report"
    assert data["title"] == "ball & <co>"


def test_points_with_a_reference_show_errors(sphere):
    data = data_of(g3r.show(sphere, normals=sphere, true_normals=-sphere, open=False, up="z"))
    assert data["truth"]["wrong_side"] == len(sphere) and data["up"] == "z"


def test_thinning_is_told(sphere):
    data = data_of(g3r.show(sphere, max_points=100, open=False))
    assert (data["points"]["given"], data["points"]["shown"]) == (len(sphere), 100)
    for wrong in ({"max_points": -1}, {"max_points": 2.5}, {"height": "high"}):
        with pytest.raises(g3r.InputError, match=next(iter(wrong))):
            g3r.show(sphere, open=False, **wrong)


def test_vertices_with_faces_are_a_mesh():
    data = data_of(g3r.show([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], faces=[[0, 1, 2]], colors=[[1, 2, 3]] * 3, open=False))
    assert data["mesh"]["given"] == 1 and "color" in data["mesh"] and data["points"]["given"] == 0


def test_a_mesh_has_its_confidence():
    data = data_of(g3r.show([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], faces=[[0, 1, 2]], confidence=[0, 0.5, 1], open=False))
    assert "confidence" in data["mesh"]


def test_another_mesh_does_not_have_the_colors_of_the_result(result):
    for factor in (0.5, 2):
        faces = result.faces[:int(len(result.faces) * factor)]
        vertices = np.vstack([result.vertices, result.vertices + 3])
        data = data_of(g3r.show(result, mesh=(vertices, faces), open=False))
        assert "color" not in data["mesh"] and "confidence" not in data["mesh"]


def test_colors_of_the_points_of_a_result_are_shown(sphere):
    assert "color" in data_of(g3r.show(g3r.run(sphere, colors=np.full(sphere.shape, 9), mesh=False), open=False))["points"]


def test_save_writes_a_page_or_a_picture(tmp_path, result):
    view = g3r.show(result, open=False)
    view.save(tmp_path / "look.html")
    view.save(tmp_path / "look.png")
    assert (tmp_path / "look.html").read_bytes().startswith(b"<!doctype html>")
    assert (tmp_path / "look.png").read_bytes().startswith(b"\x89PNG")
    assert view.png(tile=64).startswith(b"\x89PNG")
    with pytest.raises(g3r.InputError, match="tile must be an integer"):
        view.png(tile=64.5)
    with pytest.raises(g3r.InputError, match="tile must be 2147483647 at most"):
        view.png(tile=2**40)
    with pytest.raises(g3r.InputError, match="title must be a text, not None"):
        g3r.show(result, title=None, open=False)


def test_a_notebook_gets_a_frame(result):
    frame = g3r.show(result, open=False)._repr_html_()
    assert frame.startswith("<iframe") and "<script" not in frame
    assert result._repr_html_().startswith("<iframe")


def test_scripts_get_a_browser(monkeypatch, result):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    name = g3r.show(result, open=False).open()
    g3r.show(result)
    assert opened[0] == "file://" + name and len(opened) == 2
    assert "MB" in repr(g3r.show(result, open=False))


def test_points_and_a_mesh_are_shown_together(result, sphere):
    data = data_of(g3r.show(sphere, mesh=(result.vertices, result.faces), open=False))
    assert data["points"]["given"] == len(sphere) and data["mesh"]["given"] == len(result.faces)


def test_the_command_shows_files(tmp_path, monkeypatch, capsys, result, sphere):
    cloud, mesh = str(tmp_path / "cloud.ply"), str(tmp_path / "mesh.ply")
    g3r.write(cloud, sphere, normals=sphere)
    g3r.write(mesh, result)
    for inputs in ([cloud], [mesh], [mesh, cloud]):
        assert main(["view", *inputs, "-o", str(tmp_path / "look.html")]) == 0
        page = (tmp_path / "look.html").read_text()
        assert ('"mesh":{' in page.replace(" ", "")) == (mesh in inputs)
    assert main(["view", mesh, "-o", str(tmp_path / "look.html")]) == 0
    page = (tmp_path / "look.html").read_text()
    shown = json.loads(re.search(r'id="scene-data">(.*?)</script>', page, re.S).group(1))["mesh"]
    assert "color" in shown and "confidence" in shown and shown["given"] == len(result.faces)
    assert main(["view", cloud, "-o", str(tmp_path / "look.png")]) == 0
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    assert main(["view", cloud, "--z-up"]) == 0 and len(opened) == 1
    assert main(["view", cloud, cloud, "-o", "look.html"]) == 1 and main(["view", "nowhere.ply", "-o", "look.html"]) == 1
    assert "nowhere.ply" in capsys.readouterr().err


def test_the_command_takes_folders_and_says_what_is_odd(tmp_path, capsys, sphere):
    folder, out = tmp_path / "scans", str(tmp_path / "look.html")
    folder.mkdir()
    g3r.write(folder / "a.ply", sphere[:300])
    g3r.write(folder / "b.ply", sphere[300:])
    (tmp_path / "all.list").write_text("scans/a.ply\nscans/b.ply\n")
    for inputs in (str(folder), str(folder / "*.ply"), str(tmp_path / "all.list")):
        assert main(["view", inputs, "-o", out]) == 0
        assert f'"given":{len(sphere)}' in (tmp_path / "look.html").read_text().replace(" ", "")
    assert capsys.readouterr().err == ""
    odd, damaged = tmp_path / "odd.ply", tmp_path / "damaged.off"
    g3r.write(odd, (0.5 * sphere + 4e6).astype(np.float32))
    assert main(["view", str(odd), "-o", out]) == 0
    assert g3r.read(odd).warnings[0] in capsys.readouterr().err
    damaged.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")
    assert main(["view", str(damaged), "-o", out]) == 0
    assert "shown as points" in capsys.readouterr().err


def test_the_command_replaces_no_input(tmp_path, capsys, sphere):
    cloud, link = tmp_path / "cloud.ply", tmp_path / "cloud.html"
    g3r.write(cloud, sphere)
    before = cloud.read_bytes()
    for out in ("cloud.ply", "look", "look.gif", "look.html.gz"):
        assert main(["view", str(cloud), "-o", str(tmp_path / out)]) == 1
        assert "view writes .html or .png" in capsys.readouterr().err
    os.link(cloud, link)
    assert main(["view", str(cloud), "-o", str(link)]) == 1
    assert "is an input too" in capsys.readouterr().err
    assert cloud.read_bytes() == before and sorted(path.name for path in tmp_path.iterdir()) == ["cloud.html", "cloud.ply"]
    assert main(["view", str(cloud), "-o", str(tmp_path / "LOOK.PNG")]) == 0
    assert (tmp_path / "LOOK.PNG").read_bytes().startswith(b"\x89PNG")


def test_wrong_arguments(sphere):
    with pytest.raises(ValueError, match="up must be"):
        g3r.show(sphere, up="x", open=False)
    with pytest.raises(g3r.InputError):
        g3r.show(np.zeros((0, 3)), open=False)
    with pytest.raises(g3r.InputError):
        g3r.show(sphere, normals=sphere[:3], open=False)
