"""Numbers, shapes and writers for the corpus: the same bytes on every machine (standard library only)."""
import math, struct

PI = math.pi


# ---------------------------------------------------------------- deterministic numbers
class Rng:
    """splitmix64"""
    def __init__(self, seed):
        self.s = seed & 0xFFFFFFFFFFFFFFFF

    def u64(self):
        self.s = (self.s + 0x9E3779B97F4A7C15) & 0xFFFFFFFFFFFFFFFF
        z = self.s
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & 0xFFFFFFFFFFFFFFFF
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & 0xFFFFFFFFFFFFFFFF
        return z ^ (z >> 31)

    def f(self):
        return (self.u64() >> 11) * (1.0 / (1 << 53))

    def gauss(self):  # sum of 12 uniforms: no libm, so the same bytes everywhere
        return sum(self.f() for _ in range(12)) - 6.0


def q(v, nd=9):  # rounded, so that libm's last bit never shows
    return [round(c, nd) + 0.0 for c in v]


def sphere(n, r=1.0, c=(0.0, 0.0, 0.0)):
    out = []
    g = PI * (3.0 - math.sqrt(5.0))
    for i in range(n):
        z = 1.0 - 2.0 * (i + 0.5) / n
        s = math.sqrt(max(0.0, 1.0 - z * z))
        t = g * i
        out.append(q((c[0] + r * s * math.cos(t), c[1] + r * s * math.sin(t), c[2] + r * z)))
    return out


def torus(nu, nv, R=1.0, r=0.4):
    return [q(((R + r * math.cos(2 * PI * j / nv)) * math.cos(2 * PI * i / nu),
               (R + r * math.cos(2 * PI * j / nv)) * math.sin(2 * PI * i / nu),
               r * math.sin(2 * PI * j / nv))) for i in range(nu) for j in range(nv)]


def thousandths(pts):  # whole numbers
    return [[int(round(1000 * c)) for c in p] for p in pts]


def with_normals(pts):  # of the unit sphere
    return [p + p for p in pts]


def fin(p):
    return all(math.isfinite(c) for c in p[:3])


def bbox(pts):
    f = [p for p in pts if fin(p)]
    if not f:
        return None
    return [[min(p[k] for p in f) for k in range(3)], [max(p[k] for p in f) for k in range(3)]]


def f32(x):
    try:
        return struct.unpack('<f', struct.pack('<f', x))[0]
    except OverflowError:
        return math.copysign(math.inf, x)


def f32p(pts):
    return [[f32(c) for c in p] for p in pts]


# ---------------------------------------------------------------- writers
def t(*lines, nl='\n'):
    return (nl.join(lines) + nl).encode()


def num(x):
    return repr(float(x)) if math.isfinite(x) else ('nan' if x != x else ('inf' if x > 0 else '-inf'))


def ply_head(fmt, n, props, extra_before=(), extra_after=(), nl='\n', comments=()):
    h = ['ply', 'format %s 1.0' % fmt]
    h += ['comment ' + c for c in comments]
    h += list(extra_before)
    if n is not None:
        h.append('element vertex %s' % n)
        h += ['property ' + p for p in props]
    h += list(extra_after)
    h.append('end_header')
    return (nl.join(h) + nl).encode()


XYZF = ('float x', 'float y', 'float z')
XYZD = ('double x', 'double y', 'double z')


def body(pts, code):
    return b''.join(struct.pack(code, *p) for p in pts)


def ply_ascii(pts, props=XYZD, **k):
    nl = k.get('nl', '\n')
    return ply_head('ascii', len(pts), props, **k) + \
        ''.join(' '.join(num(c) for c in p) + nl for p in pts).encode()


def ply_bin(pts, code='<3f', props=XYZF, n=None, **k):
    e = 'binary_little_endian' if code[0] == '<' else 'binary_big_endian'
    return ply_head(e, len(pts) if n is None else n, props, **k) + body(pts, code)


def xyz(pts, sep=' ', nl='\n'):
    return ''.join(sep.join(num(c) for c in p) + nl for p in pts).encode()


def pcd_head(n, fields='x y z', size='4 4 4', typ='F F F', count='1 1 1', width=None, height=1,
             data='ascii', points=None, extra=()):
    h = ['# .PCD v0.7 - Point Cloud Data file format', 'VERSION 0.7', 'FIELDS ' + fields, 'SIZE ' + size,
         'TYPE ' + typ, 'COUNT ' + count, 'WIDTH %s' % (n if width is None else width),
         'HEIGHT %s' % height, 'VIEWPOINT 0 0 0 1 0 0 0', 'POINTS %s' % (n if points is None else points)]
    return ('\n'.join(list(h) + list(extra) + ['DATA ' + data]) + '\n').encode()


def lzf_literals(b):  # valid LZF stream made of literal runs only
    out = bytearray()
    for i in range(0, len(b), 32):
        c = b[i:i + 32]
        out.append(len(c) - 1)
        out += c
    return bytes(out)


def npy(descr, fortran, shape, data, ver=1, raw_header=None):
    h = raw_header if raw_header is not None else \
        "{'descr': %s, 'fortran_order': %s, 'shape': %s, }" % (descr, fortran, shape)
    hb = h.encode('latin1')
    pre = 10 if ver == 1 else 12
    pad = (64 - (pre + len(hb) + 1) % 64) % 64
    hb += b' ' * pad + b'\n'
    return b'\x93NUMPY' + bytes([ver, 0]) + struct.pack('<H' if ver == 1 else '<I', len(hb)) + hb + data
