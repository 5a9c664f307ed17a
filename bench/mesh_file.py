"""Triangle meshes as binary PLY files. Needs NumPy."""

import numpy as np


def write_mesh(path, vertices, faces):
    """`path`: a pathlib.Path; `vertices`: (V, 3) floats, written as float32; `faces`: (F, 3) indices from 0."""
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    rows["n"] = 3
    rows["v"] = faces
    path.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + rows.tobytes())
