"""PTX, SPZ, and texts with words or numbers of points in their columns."""
import struct, zlib

from collection import F, S, W, add
from samples import *

POSE = b'0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n'


def ptx(pts, columns=None, rows=1, pose=POSE, tail=' 0.5'):
    head = b'%d\n%d\n' % (len(pts) if columns is None else columns, rows)
    return head + pose + ''.join(' '.join(num(c) for c in p) + tail + '\n' for p in pts).encode()


def ptx_files(sp, sp32, rng):
    """PTX"""
    shifted = POSE.replace(b'0 0 0 1', b'10 20 30 1')
    moved = [q((p[0] + 10, p[1] + 20, p[2] + 30)) for p in sp]
    add('ptx_ok.ptx', ptx(sp, 30, 20), S, 'valid', 'control', sp)
    add('ptx_two_scans.ptx', ptx(sp) + ptx(sp, pose=shifted), S, 'valid', 'two scans, each in its pose', sp + moved)
    add('ptx_crlf.ptx', ptx(sp).replace(b'\n', b'\r\n'), S, 'encoding', 'CRLF', sp)
    add('ptx_colour.ptx', ptx(sp, tail=' 0.5 10 20 30'), S, 'valid', 'intensity and colour', sp)
    add('ptx_no_returns.ptx', ptx([[0.0] * 3 if i % 3 == 0 else p for i, p in enumerate(sp)]), S, 'values', 'a third of the beams met nothing', [p for i, p in enumerate(sp) if i % 3])
    add('ptx_truncated.ptx', ptx(sp)[:-9000], F, 'count', 'short', hint=['truncated'])
    add('ptx_cut_in_header.ptx', ptx(sp)[:30], F, 'count', 'ends in the pose', hint=['truncated', 'ten lines'])
    add('ptx_counts_2e31.ptx', ptx(sp, 1 << 31, 1 << 31), F, 'count', '2^62 points', hint=['truncated', 'large'])
    add('ptx_counts_wrap.ptx', ptx(sp, 1 << 32, 1 << 32), F, 'count', 'columns * rows wraps to 0', hint=['truncated', 'large'])
    add('ptx_fewer_declared.ptx', ptx(sp, 500), F, 'count', '600 points, 500 declared', hint=['more points'])
    add('ptx_pose_nan.ptx', ptx(sp, pose=POSE.replace(b'1 0 0 0', b'nan 0 0 0')), F, 'values', 'a pose that is no pose', hint=['pose', 'finite'])
    add('ptx_pose_transposed.ptx', ptx(sp, pose=POSE.replace(b'1 0 0 0', b'1 0 0 9')), F, 'syntax', 'the shift in the last column', hint=['matrix', 'column'])
    add('ptx_word.ptx', ptx(sp[:300] + sp[301:]).replace(b'600\n', b'599\n', 1).replace(b' 0.5\n', b' north\n', 3), F, 'syntax', 'a word for an intensity', hint=['number', 'line'])
    add('ptx_ragged.ptx', ptx(sp).replace(b' 0.5\n', b'\n', 7), F, 'syntax', 'columns change within a scan', hint=['columns', 'line'])
    add('ptx_empty_scans.ptx', (b'1\n0\n' + POSE) * 500, F, 'count', '500 scans without points', pts=[], read=S, hint=['no points', 'at least'])


def spz_bytes(pts, version=2, points=None, degree=0, fraction=20, flags=0, magic=b'NGSP'):
    n = len(pts)
    head = magic + struct.pack('<IIBBBB', version, n if points is None else points, degree, fraction, flags, 0)
    fixed = b''.join(struct.pack('<i', int(round(c * (1 << fraction))))[:3] for p in pts for c in p)
    return head + fixed + b'\xff' * n + b'\x80' * (6 * n) + b'\x80' * ((3 if version == 2 else 4) * n) + \
        b'\x80' * (3 * ((degree + 1) ** 2 - 1) * n)


def gzip(data, level=6):
    packer = zlib.compressobj(level, zlib.DEFLATED, 31)
    return packer.compress(data) + packer.flush()


def spz(*args, **k):
    return gzip(spz_bytes(*args, **k))


def spz_files(sp, sp32, rng):
    """SPZ"""
    add('spz_v2.spz', spz(sp), S, 'valid', 'control', sp, tol=2e-6)
    add('spz_v3.spz', spz(sp, version=3, degree=3), S, 'valid', 'control', sp, tol=2e-6)
    add('spz_v1.spz', spz(sp, version=1), F, 'syntax', 'version 1', hint=['version'])
    add('spz_v4.spz', b'NGSP' + struct.pack('<I', 4) + bytes(100), F, 'syntax', 'version 4 (zstd)', hint=['version'])
    add('spz_points_2e32.spz', spz(sp, points=(1 << 32) - 1), F, 'count', '2^32 - 1 splats in some KB', hint=['count', 'large'])
    add('spz_one_more.spz', spz(sp, points=601), F, 'count', '601 declared', hint=['truncated'])
    add('spz_one_less.spz', spz(sp, points=599), F, 'count', '599 declared: the blocks are taken from the wrong places', hint=['trailing'], also=[W])
    add('spz_truncated.spz', spz(sp)[:-2000], F, 'count', 'short', hint=['truncated'])
    add('spz_checksum.spz', spz(sp)[:-8] + b'\0\0\0\0' + spz(sp)[-4:], F, 'security', 'checksum of gzip wrong', hint=['checksum', 'damaged'])
    add('spz_degree_255.spz', gzip(spz_bytes(sp)[:12] + b'\xff' + spz_bytes(sp)[13:]), F, 'syntax', 'harmonics of degree 255', hint=['degree'])
    add('spz_bomb.spz', gzip(b'NGSP' + struct.pack('<IIBBBB', 2, 2000000, 0, 12, 0, 0) + bytes(2000000 * 19), 9), F, 'security', '38 MB from 37 KB', hint=['times its size'])
    add('spz_only_gzip.spz', gzip(xyz(sp)), F, 'encoding', 'a text in gzip', hint=['gzip'])


def column_files(sp, sp32, rng):
    """Texts"""
    add('text_label.csv', b'x,y,z,label\n' + xyz(sp, sep=',').replace(b'\n', b',a wall\n'), W, 'syntax', 'a column of words', sp, hint=['text', 'label'])
    add('text_label_first.csv', b'label,x,y,z\n' + b''.join(b'wall,' + l + b'\n' for l in xyz(sp, sep=',').split()), W, 'syntax', 'words first', sp, hint=['text', 'label'])
    add('text_quoted.csv', b'"x","y","z","note"\n' + xyz(sp, sep=',').replace(b'\n', b',"a, ""b"""\n'), W, 'syntax', 'quotes with commas inside', sp, hint=['text', 'note'])
    add('text_quote_open.csv', b'x,y,z,note\n' + xyz(sp, sep=',').replace(b'\n', b',"a\n'), W, 'syntax', 'quotes that do not close', sp, hint=['text', 'note'])
    add('text_pnezd.csv', b''.join(b'%d,%s,%s,%s,GND\n' % (k, *(num(c).encode() for c in (p[1], p[0], p[2]))) for k, p in enumerate(sp)), W, 'syntax', 'point, northing, easting, elevation, description', sp, hint=['pnezd'])
    add('text_numbered.xyz', b''.join(b'%d %s\n' % (k, l.strip()) for k, l in enumerate(xyz(sp).splitlines())), W, 'syntax', 'numbers of points before x y z', sp, hint=['first column'])
    add('text_hash_names.txt', b'# ID LONGITUDE LATITUDE ELEVATION\n' + b''.join(b'7 ' + l + b'\n' for l in xyz(sp).splitlines()), W, 'syntax', 'named columns after #', sp, hint=['longitude'])
    add('text_word_in_intensity.xyz', xyz([p + [1.0] for p in sp[:300]]) + b'0 0 0 l.5\n' + xyz([p + [1.0] for p in sp[300:]]), F, 'syntax', 'one l for a 1: damage, not a column of words', hint=['301'])
    add('text_1000_columns_of_words.csv', (b'1,2,3' + b',a' * 900 + b'\n') * 20, F, 'limits', '900 columns of words', read=W, also=[S], hint=['text', 'same place'], n_raw=20, pts=[[1.0, 2.0, 3.0]] * 20)
    add('text_quotes_only.csv', b'1,2,3,' + b'"' * (1 << 20) + b'\n', F, 'limits', 'a million quotes', read=W, also=[S], hint=['text', 'few'], pts=[[1.0, 2.0, 3.0]])
    add('pts_one_more.pts', b'599\n' + xyz(sp), W, 'count', 'a line more than the count', sp, hint=['more points'])
    add('pcd_commas.pcd', pcd_head(600) + xyz(sp, sep=','), S, 'syntax', 'commas between the numbers', sp, tol=2e-7)
    raw = b''.join(struct.pack('<600f', *[p[k] for p in sp]) for k in range(3))
    packed = lzf_literals(raw)
    add('pcd_padded.pcd', pcd_head(600, data='binary_compressed') + struct.pack('<II', len(packed), len(raw)) + packed + bytes(512), S, 'valid', 'zeros after the data, as PCL writes them', sp32)
    add('ply_capitals.ply', ply_bin(sp32, props=('float X', 'float Y', 'float Z')), S, 'valid', 'X Y Z', sp32)
