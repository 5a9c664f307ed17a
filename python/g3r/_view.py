"""A page that shows a scene."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from . import _g3r
from ._kinds import integer

if TYPE_CHECKING:
    from ._cloud import Path

DEFAULT_POINTS = 1_500_000  # that a page holds at most: more make it too large for browsers
DEFAULT_HEIGHT = 620  # of the frame in a notebook, pixels


class View:
    """A page that shows a scene: `html` is the document; in a notebook it appears by itself."""

    def __init__(self, scene: _g3r.Scene, z_up: bool, max_points: int, height: int) -> None:
        self._scene = scene
        self._z_up = z_up
        self.html: str = _g3r.view_html(scene, z_up, max_points)
        self.height = height

    def save(self, path: Path) -> None:
        """Writes the page, or for a name that ends in .png four views as a picture. Raises OSError."""
        name = os.fsdecode(path)
        data = self.png() if name.lower().endswith(".png") else self.html.encode()
        _g3r.write_file(os.fsencode(path), data)

    def png(self, tile: int = 600) -> bytes:
        """Four views as a PNG file, each `tile` pixels wide and high, 16 to 2048. Raises InputError."""
        return _g3r.view_png(self._scene, self._z_up, integer("tile", tile))

    def open(self) -> str:
        """Opens the page in the browser from a temporary file, whose name is returned."""
        import tempfile
        import webbrowser

        handle, name = tempfile.mkstemp(prefix="g3r_", suffix=".html")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(self.html)
        webbrowser.open("file://" + name)
        return name

    def _repr_html_(self) -> str:
        import html

        return (f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{self.height}" '
                'style="border: 0; border-radius: 8px" sandbox="allow-scripts allow-downloads"></iframe>')

    def __repr__(self) -> str:
        return f"<g3r.View: {len(self.html) / 1e6:.1f} MB of HTML>"
