"""The files of the corpus and what is expected of each (badinputs.py has the words)."""
from samples import bbox, fin

FILES = []
S, W, F = 'must_succeed', 'must_succeed_with_warning', 'must_fail_with_clear_error'


def add(name, data, expect, group, why, pts=None, read=None, n_raw=None, hint=(), also=(), tol=None,
        normals=False):
    fmt = name.rsplit('.', 1)[1]
    assert all(e['file'] != name for e, _ in FILES), name
    read = read or expect
    ok = [p for p in pts if fin(p)] if pts is not None else None
    bb = bbox(pts) if pts is not None else None
    if tol is None and bb:
        m = max(abs(c) for c in bb[0] + bb[1])
        tol = 1e-6 * max(m, 1e-300)
    FILES.append(({'file': name, 'format': fmt, 'group': group, 'expect': expect, 'expect_read': read,
                   'also_ok': list(also), 'n': None if ok is None else len(ok),
                   'n_raw': n_raw if n_raw is not None else (None if pts is None else len(pts)),
                   'bbox': bb, 'tol': tol, 'normals': normals, 'hint': list(hint), 'why': why,
                   'bytes': len(data)}, data))
