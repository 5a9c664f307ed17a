import numpy as np
import pytest


def sphere_points(count: int = 600) -> np.ndarray:
    """Points on the unit sphere, almost evenly (a golden spiral): the outward normal of each is the point itself."""
    i = np.arange(count) + 0.5
    z, turn = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)


@pytest.fixture(scope="session")
def sphere() -> np.ndarray:
    return sphere_points()


@pytest.fixture(scope="session")
def result(sphere):
    import g3r

    return g3r.run(sphere, colors=np.where(sphere[:, :1] > 0, [[255, 0, 0]], [[0, 0, 255]]))


def is_outward(normals: np.ndarray, sphere: np.ndarray) -> bool:
    return normals.shape == sphere.shape and bool(((normals * sphere).sum(axis=1) > 0.8).all())
