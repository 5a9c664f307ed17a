"""PLY: well formed but awkward, broken, and odd values."""
import math, struct, zlib

from collection import F, S, W, add
from samples import *


def ply_awkward(sp, sp32, rng):
    """PLY, well formed but awkward"""
    add('ply_ascii_ok.ply', ply_ascii(sp), S, 'valid', 'control', sp)
    add('ply_le_float.ply', ply_bin(sp), S, 'valid', 'control', sp32)
    add('ply_le_double.ply', ply_bin(sp, '<3d', XYZD), S, 'valid', 'control', sp)
    add('ply_be_float.ply', ply_bin(sp, '>3f'), S, 'encoding', 'big-endian', sp32)
    add('ply_be_double.ply', ply_bin(sp, '>3d', XYZD), S, 'encoding', 'big-endian', sp)
    add('ply_ascii_crlf.ply', ply_ascii(sp, nl='\r\n'), S, 'encoding', 'Windows line ends', sp)
    add('ply_ascii_cr_only.ply', ply_ascii(sp, nl='\r'), S, 'encoding',
        'CR line ends: what the 1994 text literally asks for', sp, also=[F], hint=['line', 'end', 'header'])
    add('ply_le_crlf_header.ply', ply_bin(sp, nl='\r\n'), S, 'encoding',
        'CRLF header then binary (aardvark.algodat#57)', sp32)
    # the first byte(s) of the payload look like a line end: a reader that "skips newlines" loses bytes
    first = struct.unpack('<f', b'\x0a\x0d\x0a\x3f')[0]
    nlp = [[first, 0.25, 0.5]] + sp32[1:]
    add('ply_le_payload_starts_with_newline.ply', ply_bin(nlp), S, 'encoding',
        'LF header, payload begins 0A 0D 0A', nlp)
    add('ply_le_crlf_payload_starts_with_newline.ply', ply_bin(nlp, nl='\r\n'), S, 'encoding',
        'CRLF header, payload begins 0A 0D 0A', nlp)
    ex = [[i % 256] + p + [0.25 * i, i % 65536, -i] for i, p in enumerate(sp32)]
    add('ply_extra_props.ply',
        ply_bin(ex, '<B3fdHi', ('uchar red',) + XYZF + ('double curvature', 'ushort k', 'int label')), S, 'valid',
        'unknown properties around x y z', sp32)
    add('ply_props_reordered.ply', ply_bin([[p[2], p[0], p[1]] for p in sp32], '<3f',
                                           ('float z', 'float x', 'float y')), S, 'valid', 'z x y order', sp32)
    add('ply_mixed_types.ply', ply_bin(sp, '<dfd', ('double x', 'float y', 'double z')), S, 'valid',
        'double x, float y, double z', [[p[0], f32(p[1]), p[2]] for p in sp])
    ip = thousandths(sp)
    add('ply_int_coords.ply', ply_bin(ip, '<3i', ('int x', 'int y', 'int z')), S, 'valid', 'integer coordinates', ip)
    sh = [[int(round(30000 * c)) for c in p] for p in sp]
    add('ply_short_coords.ply', ply_bin(sh, '>3h', ('int16 x', 'int16 y', 'int16 z')), S, 'valid',
        'int16, big-endian', sh)
    add('ply_type_aliases.ply', ply_head('binary_little_endian', len(sp), ('float32 x', 'float32 y', 'float64 z', 'uint8 red')) +
        b''.join(struct.pack('<ffdB', p[0], p[1], p[2], 7) for p in sp), S, 'valid', 'float32/uint8 names',
        [[f32(p[0]), f32(p[1]), p[2]] for p in sp])
    cam = b''.join(struct.pack('<B', k) + bytes(range(k)) for k in (0, 3, 255))
    add('ply_list_element_before_vertex.ply',
        ply_head('binary_little_endian', len(sp), XYZF,
                 extra_before=('element camera 3', 'property list uchar uchar blob')) + cam + body(sp, '<3f'),
        S, 'syntax', 'variable-size element precedes vertex: the reader must walk it', sp32)
    add('ply_list_inside_vertex.ply',
        ply_head('binary_little_endian', len(sp), ('float x', 'list uchar int view_indices', 'float y', 'float z')) +
        b''.join(struct.pack('<fB', p[0], i % 4) + struct.pack('<%di' % (i % 4), *range(i % 4)) +
                 struct.pack('<ff', p[1], p[2]) for i, p in enumerate(sp)),
        S, 'syntax', 'list property inside vertex (MeshLab#1624, MVS view lists)', sp32)
    faces = b''.join(struct.pack('<Biii', 3, i, i + 1, i + 2) for i in range(300))
    add('ply_with_faces.ply',
        ply_head('binary_little_endian', len(sp), XYZF,
                 extra_after=('element face 300', 'property list uchar int vertex_indices')) + body(sp, '<3f') + faces,
        S, 'valid', 'a mesh given where points are wanted', sp32)
    add('ply_list_count_uint32.ply',
        ply_head('binary_little_endian', len(sp), XYZF,
                 extra_after=('element face 300', 'property list uint32 uint32 vertex_index')) + body(sp, '<3f') +
        b''.join(struct.pack('<IIII', 3, i, i + 1, i + 2) for i in range(300)),
        S, 'syntax', 'list count of type uint32 (MeshLab#1216, buffer overflow there)', sp32)
    add('ply_long_face.ply',
        ply_head('binary_little_endian', len(sp), XYZF,
                 extra_after=('element face 1', 'property list int int vertex_indices')) + body(sp, '<3f') +
        struct.pack('<i', 600) + struct.pack('<600i', *range(600)), S, 'syntax', 'one face with 600 corners', sp32)
    add('ply_comment_before_format.ply',
        b'ply\ncomment made by\ncomment\nobj_info num_cols 512\n' + ply_ascii(sp)[4:], S, 'syntax',
        'comments and obj_info before format', sp, also=[F], hint=['format'])
    add('ply_comments_everywhere.ply',
        b'ply\nformat ascii 1.0\ncomment\ncomment made by  x \nobj_info num_cols 512\nobj_info\nelement vertex 600\n'
        b'property double x\ncomment end_header\nproperty double y\nproperty double z\ncomment last\nend_header\n' + xyz(sp), S, 'syntax',
        'empty comments, obj_info, a comment that says end_header (LAStools#93, CloudCompare#492)', sp)
    add('ply_ascii_no_final_newline.ply', ply_ascii(sp)[:-1], S, 'syntax', 'last line not ended', sp)
    add('ply_ascii_blank_lines.ply', ply_ascii(sp).replace(b'end_header\n', b'end_header\n\n\n') + b'\n\n  \n', S, 'syntax',
        'blank lines after the header and at the end (happly#45)', sp)
    add('ply_ascii_tabs.ply', ply_head('ascii', len(sp), XYZD) +
        ''.join('\t %s \t  %s\t%s \t\n' % tuple(num(c) for c in p) for p in sp).encode(), S, 'syntax',
        'tabs and runs of blanks (openMVG#571)', sp)
    forms = [['+1.0e+00', '1.', '.5'], ['1E0', '-0', '0.0'], ['-1e-1', '+.25e1', '1e+000'], ['0', '00012', '-.5E-1']]
    fv = [[float(c) for c in r] for r in forms]
    add('ply_ascii_number_forms.ply', ply_head('ascii', len(sp) + 4, XYZD) +
        ('\n'.join(' '.join(r) for r in forms) + '\n').encode() + xyz(sp), S, 'syntax', 'all legal spellings', fv + sp)
    add('ply_comment_256k.ply', ply_head('ascii', len(sp), XYZD, comments=('c' * (1 << 18),)) + xyz(sp), S, 'limits',
        'one 256 KiB comment line', sp, also=[F], hint=['header', 'long', 'line'])
    gs = ['x', 'y', 'z', 'nx', 'ny', 'nz'] + ['f_dc_%d' % i for i in range(3)] + ['f_rest_%d' % i for i in range(45)] + \
         ['opacity', 'scale_0', 'scale_1', 'scale_2', 'rot_0', 'rot_1', 'rot_2', 'rot_3']
    add('ply_gaussian_splat.ply', ply_head('binary_little_endian', 600, ['float ' + g for g in gs]) +
        b''.join(struct.pack('<62f', *(p + [0.0] * 59)) for p in sp), W, 'valid',
        '62 properties, all-zero normals (3DGS export): the zero normals must not be trusted', sp32, read=S, also=[S],
        hint=['normal'])
    nr = with_normals(sp)
    add('ply_with_normals.ply', ply_bin(nr, '<6f', XYZF + ('float nx', 'float ny', 'float nz')), S, 'valid',
        'unit normals present', sp32, normals=True)
    nb = [p + ([0.0, 0.0, 0.0] if i % 10 == 0 else [math.nan] * 3 if i % 10 == 1 else [2.5 * c for c in p])
          for i, p in enumerate(sp)]
    add('ply_bad_normals.ply', ply_bin(nb, '<6f', XYZF + ('float nx', 'float ny', 'float nz')), W, 'values',
        '10 % zero, 10 % NaN, rest not unit length (PoissonRecon#161, #136)', sp32, normals=True, also=[S], hint=['normal'])


def ply_broken(sp, sp32, rng):
    """PLY, broken"""
    add('ply_empty_file.ply', b'', F, 'syntax', 'zero bytes', hint=['empty', 'magic', 'ply'])
    add('ply_only_magic.ply', b'ply\n', F, 'syntax', 'cut after the magic', hint=['header', 'end', 'format'])
    add('ply_format_line_empty.ply', b'ply\n\n', F, 'security', 'opencv#29865, crash 1', hint=['header', 'format'])
    add('ply_format_no_space.ply', b'ply\nformat\r\r\r\r\r\r\r\r', F, 'security', 'opencv#29865, crash 2', hint=['header', 'format'])
    add('ply_wrong_magic.ply', b'PLYX\n' + ply_ascii(sp)[4:], F, 'syntax', 'magic wrong', hint=['magic', 'not a ply', 'ply'])
    add('ply_no_end_header.ply', ply_ascii(sp).replace(b'end_header\n', b''), F, 'syntax', 'header never ends',
        hint=['header', 'end_header', 'keyword'])
    add('ply_no_format.ply', b'\n'.join(l for l in ply_ascii(sp).split(b'\n') if not l.startswith(b'format')), F, 'syntax',
        'no format line', hint=['format'])
    add('ply_format_unknown.ply', ply_ascii(sp).replace(b'format ascii', b'format binary_middle_endian'), F, 'syntax',
        'unknown format', hint=['format'])
    add('ply_version_9.ply', ply_ascii(sp).replace(b'ascii 1.0', b'ascii 9.7'), F, 'syntax', 'unknown version',
        hint=['version', 'format'], also=[W, S])
    for nm, cnt, why in (('negative', '-1', 'count -1 (python-plyfile#89)'), ('word', 'abc', 'count not a number'),
                         ('float', '6e2', 'count 6e2'), ('hex', '0x258', 'count in hex'), ('missing', '', 'no count')):
        add('ply_count_%s.ply' % nm, ply_bin(sp, n=cnt), F, 'count', why, hint=['count', 'element', 'number', 'negative'])
    for nm, cnt in (('2e31', 1 << 31), ('2e32_plus_600', (1 << 32) + 600), ('2e61', 1 << 61), ('2e63m1', (1 << 63) - 1),
                    ('2e64_plus_600', (1 << 64) + 600), ('1e40', 10 ** 40)):
        add('ply_count_%s_binary.ply' % nm, ply_bin(sp, n=cnt), F, 'count',
            'declares %s points, holds 600 (python-plyfile#90, tinyply#52): no allocation from the header' % cnt,
            hint=['truncated', 'count', 'size', 'end of file', 'large', 'range'])
    add('ply_count_2e31_ascii.ply', ply_ascii(sp).replace(b'vertex 600', b'vertex 2147483648'), F, 'count',
        'the same in ascii', hint=['truncated', 'count', 'end of file', 'large'])
    add('ply_count_1e9_ascii.ply', ply_ascii(sp).replace(b'vertex 600', b'vertex 1000000000'), F, 'count',
        'the same in ascii, plausible number', hint=['truncated', 'count', 'end of file', 'large'])
    add('ply_huge_unused_element.ply',
        ply_head('binary_little_endian', 600, XYZF, extra_before=('element pad 9223372036854775807',)) + body(sp, '<3f'),
        S, 'limits', 'an element with 2^63-1 records of zero bytes: must not loop over them', sp32, also=[F],
        hint=['count', 'element', 'large', 'propert'])
    add('ply_count_zero.ply', ply_bin([], n=0), F, 'count', 'no points', pts=[], read=S, hint=['no points', 'empty', '0 points', 'at least'])
    add('ply_count_too_small.ply', ply_bin(sp, n=500), W, 'count', 'file goes on after the last element',
        sp32[:500], hint=['trailing', 'extra', 'bytes', 'after'], also=[S])
    add('ply_count_too_small_ascii.ply', ply_ascii(sp).replace(b'vertex 600', b'vertex 500'), W, 'count',
        'file goes on after the last element', sp[:500], hint=['trailing', 'extra', 'after'], also=[S])
    add('ply_truncated_ascii.ply', ply_ascii(sp)[:-9000], F, 'count', 'cut in the middle of a number', hint=['truncated', 'end of file', 'unexpected'])
    add('ply_truncated_le.ply', ply_bin(sp)[:-3001], F, 'count', 'cut in the middle of a point (assimp#6784)', hint=['truncated', 'end of file', 'unexpected', 'size'])
    add('ply_truncated_one_byte.ply', ply_bin(sp)[:-1], F, 'count', 'one byte short', hint=['truncated', 'end of file', 'unexpected', 'size'])
    add('ply_truncated_header.ply', ply_bin(sp)[:70], F, 'count', 'cut in the header', hint=['header', 'end'])
    add('ply_no_z.ply', ply_bin([p[:2] for p in sp], '<2f', XYZF[:2]), F, 'syntax', 'no z property', hint=['z', 'propert'])
    add('ply_duplicate_x.ply', ply_bin([[p[0]] + p for p in sp], '<4f', ('float x',) + XYZF), F, 'syntax', 'x twice', hint=['twice', 'duplicate'])
    add('ply_two_vertex_elements.ply', ply_head('binary_little_endian', 300, XYZF, extra_after=('element vertex 300',) +
        tuple('property ' + p for p in XYZF)) + body(sp, '<3f'), F, 'syntax', 'two vertex elements', hint=['twice', 'duplicate', 'vertex'])
    add('ply_unknown_type.ply', ply_bin(sp, props=('quad x', 'float y', 'float z')), F, 'syntax', 'unknown type', hint=['type', 'quad'])
    add('ply_property_before_element.ply', b'ply\nformat ascii 1.0\nproperty float x\nelement vertex 1\nend_header\n0\n', F, 'syntax',
        'property without an element', hint=['property', 'element'])
    add('ply_no_vertex_element.ply', b'ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nend_header\n3 0 1 2\n',
        F, 'syntax', 'faces only', hint=['vertex', 'no points'])
    add('ply_xyz_are_lists.ply', ply_head('binary_little_endian', 600, ('list uchar float x', 'float y', 'float z')) +
        b''.join(struct.pack('<Bfff', 1, *p) for p in sp), F, 'syntax', 'x is a list', hint=['list', 'x'])
    add('ply_list_count_ffffffff.ply',
        ply_head('binary_little_endian', None, ()).replace(b'end_header\n', b'') +
        b'element face 1\nproperty list uint32 double vertex_indices\nelement vertex 600\nproperty float x\nproperty float y\nproperty float z\nend_header\n'
        + b'\xff\xff\xff\xff' + body(sp, '<3f'), F, 'security', 'list of 2^32-1 doubles, 7 KB of data (draco#1166, #1205)',
        hint=['list', 'truncated', 'end of file'])
    add('ply_list_count_negative.ply',
        ply_head('binary_little_endian', 600, XYZF, extra_before=('element face 1', 'property list char int vertex_indices')) +
        b'\xff' + body(sp, '<3f'), F, 'security', 'list count -1 (python-plyfile#89)', hint=['list', 'negative', 'count'])
    add('ply_list_count_float.ply',
        ply_head('binary_little_endian', 600, XYZF, extra_before=('element face 1', 'property list float int vertex_indices')) +
        struct.pack('<fiii', 3.0, 0, 1, 2) + body(sp, '<3f'), F, 'syntax', 'list count of type float', hint=['list', 'count', 'type'])
    add('ply_ascii_word.ply', ply_ascii(sp).replace(num(sp[300][0]).encode(), b'hello'), F, 'syntax', 'a word among the numbers', hint=['line', 'number', 'hello', 'vertex'])
    add('ply_ascii_decimal_comma.ply', ply_head('ascii', 600, XYZD) + xyz(sp).replace(b'.', b','), F, 'encoding',
        'decimal commas (assimp#750, PCL#1069): never the integer part alone', hint=['comma', 'number', 'line'])
    add('ply_ascii_short_line.ply', ply_ascii(sp[:300]).replace(b'vertex 300', b'vertex 600') + b'0.5 0.5\n' + xyz(sp[301:]), F, 'syntax',
        'one line has two numbers: everything after it shifts', hint=['line', 'values', 'column', 'vertex', 'truncated'])
    add('ply_ascii_long_line.ply', ply_ascii(sp[:300]).replace(b'vertex 300', b'vertex 600') + b'0.5 0.5 0.5 0.5\n' + xyz(sp[301:]), F, 'syntax',
        'one line has four numbers (tinyply#19)', hint=['line', 'values', 'column', 'vertex'], also=[W])
    add('ply_ascii_hexfloat.ply', ply_ascii(sp).replace(num(sp[5][0]).encode(), b'0x1.8p0'), F, 'syntax', 'hexadecimal number', hint=['line', 'number', 'vertex'], also=[S, W])
    add('ply_ascii_overflow_number.ply', ply_ascii(sp).replace(num(sp[5][0]).encode(), b'1e999'), W, 'values', 'number beyond double',
        [p for i, p in enumerate(sp) if i != 5], n_raw=600, hint=['finite', 'range', 'inf'], also=[F])
    add('ply_ascii_as_binary.ply', ply_ascii(sp).replace(b'format ascii', b'format binary_little_endian'), F, 'encoding',
        'text declared as binary: sizes cannot agree', hint=['trailing', 'size', 'truncated', 'end of file'], also=[W])
    add('ply_binary_as_ascii.ply', ply_bin(sp).replace(b'binary_little_endian', b'ascii'), F, 'encoding', 'binary declared as text', hint=['number', 'line', 'vertex', 'truncated'])
    add('ply_nul_in_header.ply', ply_ascii(sp).replace(b'property double y', b'property double y\0y'), F, 'security', 'NUL byte in the header', hint=['header', 'nul', 'character', 'y', 'propert'])
    add('ply_name_64k.ply', ply_head('ascii', 600, XYZD[:2] + ('double ' + 'z' * 65536,)) + xyz(sp), F, 'security', 'a property name of 64 KiB', hint=['header', 'long', 'z', 'propert'])
    add('ply_20000_elements.ply', ply_head('ascii', 600, XYZD, extra_after=tuple('element e%d 0' % i for i in range(20000))) + xyz(sp), S, 'limits',
        '20 000 empty elements', sp, also=[F], hint=['header', 'element', 'many', 'long'])
    add('ply_10000_properties.ply', ply_head('binary_little_endian', 3, XYZF + tuple('uchar p%d' % i for i in range(10000))) +
        b''.join(struct.pack('<3f', *p) + bytes(10000) for p in sp[:3]), F, 'limits', '10 000 properties, 3 points', sp32[:3], read=S,
        hint=['points', 'at least', 'few'], also=[])
    add('ply_gzip.ply', zlib.compress(ply_ascii(sp), 9), F, 'encoding', 'compressed file with the wrong name', hint=['magic', 'ply', 'compress'])
    add('ply_utf16.ply', ply_ascii(sp).decode().encode('utf-16'), F, 'encoding', 'UTF-16', hint=['magic', 'ply', 'utf'])
    add('ply_utf8_bom.ply', b'\xef\xbb\xbf' + ply_ascii(sp), F, 'encoding', 'BOM before the magic', hint=['magic', 'ply', 'bom'], also=[S, W])
    add('ply_html.ply', b'<!DOCTYPE html>\n<html><head><title>404 Not Found</title></head></html>\n', F, 'encoding', 'a download that failed', hint=['magic', 'ply', 'html'])
    add('ply_git_lfs_pointer.ply', b'version https://git-lfs.github.com/spec/v1\noid sha256:' + b'0' * 64 + b'\nsize 73482910\n', F, 'encoding',
        'git-lfs pointer', hint=['magic', 'ply', 'lfs'])
    add('ply_ansi_escape.ply', ply_ascii(sp).replace(b'property double y', b'property \x1b]0;owned\x07\x1b[2Jdouble y'), F, 'security',
        'terminal escapes in the header: must not reach the terminal through the message', hint=['type', 'header', 'propert'])
    add('ply_random_after_header.ply', ply_head('ascii', 600, XYZD) + bytes(rng.u64() & 255 for _ in range(20000)), F, 'security', 'noise where text is due', hint=['number', 'line', 'vertex'])


def values(sp, sp32, rng):
    """Values (binary PLY double unless said otherwise)"""
    def pd(name, pts, expect, why, **k):
        add(name, ply_bin(pts, '<3d', XYZD), expect, k.pop('group', 'values'), why, pts, **k)

    nanp = [[math.nan, p[1], p[2]] if i % 97 == 5 else p for i, p in enumerate(sp)]
    pd('val_nan_some.ply', nanp, W, '1 % NaN (OpenVDB#352: endless memory; meshoptimizer#1078)', hint=['finite', 'nan'], read=W)
    pd('val_inf_some.ply', [[p[0], math.inf if i % 2 else -math.inf, p[2]] if i % 97 == 5 else p for i, p in enumerate(sp)], W, '1 % infinite', hint=['finite', 'inf'], read=W)
    pd('val_nan_all.ply', [[math.nan] * 3] * 600, F, 'nothing but NaN', hint=['finite', 'nan', 'no points'], read=W)
    snan = struct.pack('<Q', 0x7FF0000000000001)
    add('val_signalling_nan.ply', ply_head('binary_little_endian', 600, XYZD) + snan * 3 + body(sp[1:], '<3d'), W, 'values', 'signalling NaN',
        [[math.nan] * 3] + sp[1:], hint=['finite', 'nan'])
    pd('val_scale_1e30.ply', [[c * 1e30 for c in p] for p in sp], S, 'radius 1e30: squares overflow float32', also=[])
    pd('val_scale_1e-30.ply', [[c * 1e-30 for c in p] for p in sp], S, 'radius 1e-30: squares underflow float32')
    pd('val_scale_1e300.ply', [[c * 1e300 for c in p] for p in sp], S, 'radius 1e300: squares overflow double', also=[F], hint=['range', 'extent', 'large', 'scale'])
    pd('val_denormal.ply', [[c * 1e-310 for c in p] for p in sp], S, 'denormal doubles', also=[F, W], hint=['range', 'extent', 'small', 'identical'], tol=1e-315)
    pd('val_max_double_corner.ply', sp + [[1.7e308, 0.0, 0.0], [-1.7e308, 0.0, 0.0]], F, 'the extent is not a double', hint=['range', 'extent', 'large', 'outlier'], also=[W], read=S)
    utm = [[p[0] * 5.0 + 497233.125, p[1] * 5.0 + 5412345.5, p[2] * 5.0 + 311.0] for p in sphere(1500)]
    pd('val_utm_double.ply', utm, S, 'a 5 m ball in UTM metres, double: must keep 0.1 mm', tol=1e-6)
    u32 = f32p(utm)
    add('val_utm_float.ply', ply_bin(utm), W, 'values', 'the same in float32: 0.5 m steps in y; say so (CloudCompare#638, openMVS#244, ODM#522)',
        u32, hint=['precision', 'duplicate', 'quanti'], read=S)
    add('val_utm.xyz', xyz(utm), S, 'values', 'the same in text', utm, tol=1e-6)
    mm = [[p[0] * 0.05 + 497233.125, p[1] * 0.05 + 5412345.5, p[2] * 0.05 + 311.0] for p in sphere(1500)]
    pd('val_utm_mm_detail_double.ply', mm, S, 'a 5 cm ball in UTM metres, double', tol=1e-6)
    pd('val_ecef_double.ply', [[p[0] + 4201576.0, p[1] + 172460.0, p[2] + 4780102.0] for p in sp], S, 'earth-centred', tol=1e-6)
    pd('geo_duplicates_10x.ply', [p for p in sp for _ in range(10)], W, 'each point ten times (Open3D#6727)', hint=['duplicate', 'identical'], group='geometry', also=[S], read=S)
    pd('geo_all_identical.ply', [[0.25, 0.5, 0.75]] * 600, F, 'one place', hint=['identical', 'extent', 'duplicate', 'distinct'], group='geometry', read=S)
    pd('geo_two_places.ply', [[0.25, 0.5, 0.75]] * 300 + [[0.5, 0.5, 0.5]] * 300, F, 'two places', hint=['identical', 'duplicate', 'distinct', 'collinear', 'at least'], group='geometry', read=S)
    pd('geo_one_ulp.ply', [[1.0 + i * 2.220446049250313e-16, 1.0, 1.0] for i in range(600)], F, 'neighbours one ulp apart, collinear', hint=['collinear', 'line', 'identical', 'extent'], group='geometry', tol=1e-18, read=S)
    for n in (1, 2, 3):
        pd('geo_%d_point%s.ply' % (n, 's' if n > 1 else ''), sp[:1] if n == 1 else [sp[0], sp[300], sp[599]][:n], F, '%d point(s)' % n,
           hint=['at least', 'few', 'points'], group='geometry', read=S)
    pd('geo_4_points.ply', [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]], F, 'a tetrahedron', hint=['at least', 'few', 'points'], also=[W, S], group='geometry', read=S)
    pd('geo_8_cube_corners.ply', [[float(i & 1), float(i >> 1 & 1), float(i >> 2)] for i in range(8)], S, 'corners of a cube', also=[F, W], group='geometry', hint=['at least', 'few'], read=S)
    pd('geo_collinear.ply', [[i / 600.0] * 3 for i in range(600)], F, 'on one line', hint=['collinear', 'line', 'degenerate'], group='geometry', read=S)
    pd('geo_coplanar_grid.ply', [[i / 25.0, j / 24.0, 0.0] for i in range(25) for j in range(24)], W, 'a plane grid (Open3D#6482 slow, #880, #2911, CGAL#5362)', hint=['plan', 'open', 'flat'], group='geometry', also=[F], read=S)
    pd('geo_coplanar_tilted.ply', [q((i / 25.0, j / 24.0, i / 50.0 + j / 36.0)) for i in range(25) for j in range(24)], W, 'a tilted plane', hint=['plan', 'open', 'flat'], group='geometry', also=[F], read=S)
    pd('geo_nearly_flat.ply', [[p[0], p[1], p[2] * 1e-6] for p in sp], W, 'a ball flattened to 1e-6', hint=['flat', 'thin', 'plan', 'aniso'], group='geometry', also=[S, F], read=S)
    pd('geo_cube_grid_surface.ply', [[i / 11.0, j / 11.0, k / 11.0] for i in range(12) for j in range(12) for k in range(12) if {i, j, k} & {0, 11}], S, 'exactly cospherical, gridded cube', group='geometry')
    pd('geo_voxel_sphere.ply', sorted({(round(p[0] * 8) / 8.0 + 0.0, round(p[1] * 8) / 8.0 + 0.0, round(p[2] * 8) / 8.0 + 0.0) for p in sphere(4000)}), S, 'a ball on a voxel grid', group='geometry')
    pd('geo_two_spheres.ply', sphere(400) + sphere(400, 1.0, (3.0, 0.0, 0.0)), S, 'two components', group='geometry')
    pd('geo_far_components.ply', sphere(400) + sphere(400, 1.0, (1e4, 0.0, 0.0)), S, 'two components 1e4 radii apart', group='geometry', also=[W], hint=['apart', 'component', 'extent'])
    pd('geo_nested_spheres.ply', sphere(900) + sphere(300, 0.5), S, 'a shell inside a shell', group='geometry')
    pd('geo_touching_spheres.ply', sphere(500) + sphere(500, 1.0, (2.0, 0.0, 0.0)), S, 'tangent balls', group='geometry')
    pd('geo_many_components.ply', [p for a in range(4) for b in range(4) for c in range(4) for p in sphere(40, 0.3, (a, b, c))], S, '64 small balls, 40 points each', group='geometry', also=[W], hint=['component', 'sparse'])
    pd('geo_thin_layers.ply', [[i / 40.0, j / 40.0, s * 1e-3] for s in (0, 1) for i in range(40) for j in range(40)], S, 'two layers 1e-3 apart, spacing 25e-3', group='geometry', also=[W], hint=['thin', 'open'])
    pd('geo_hemisphere.ply', [p for p in sphere(1200) if p[2] > 0], S, 'an open half', group='geometry', also=[W], hint=['open', 'hole'])
    pd('geo_density_1e4.ply', sphere(300) + [q((math.sqrt(max(0.0, 1 - (a * a + b * b))), a, b)) for a, b in
        (((rng.f() - .5) * 2e-2, (rng.f() - .5) * 2e-2) for _ in range(3000))], S, 'one cap 1e4..1e5 times denser', group='geometry', also=[W], hint=['densit'])
    out = sp + [[(rng.f() - .5) * 4, (rng.f() - .5) * 4, (rng.f() - .5) * 4] for _ in range(60)]
    pd('geo_outliers_10pct.ply', out, S, '10 % stray points', group='geometry', also=[W], hint=['outlier', 'isolated'])
    pd('geo_one_far_outlier.ply', sp + [[1e6, 1e6, 1e6]], W, 'one point 1e6 radii away eats the octree', hint=['outlier', 'extent', 'isolated'], group='geometry', read=S, also=[S])
    pd('geo_noise_in_box.ply', [[rng.f(), rng.f(), rng.f()] for _ in range(1000)], W, 'no surface at all', hint=['surface', 'noise', 'confiden', 'consisten', 'converge'], group='geometry', also=[S], read=S)
    pd('geo_noisy_sphere.ply', [[c * (1 + 0.05 * rng.gauss()) for c in p] for p in sphere(1500)], S, '5 % noise', group='geometry')
    mob = []
    for i in range(120):
        for j in range(-4, 5):
            u, v = 2 * PI * i / 120, j / 12.0
            mob.append(q(((1 + v * math.cos(u / 2)) * math.cos(u), (1 + v * math.cos(u / 2)) * math.sin(u), v * math.sin(u / 2))))
    pd('geo_moebius.ply', mob, W, 'cannot be oriented', hint=['orient', 'consisten', 'open'], group='geometry', also=[S], read=S)
    pd('geo_torus.ply', torus(60, 24), S, 'genus 1', group='geometry')
    pd('geo_long_needle.ply', [[p[0] * 1e4, p[1], p[2]] for p in sphere(3000)], S, 'aspect 1e4', group='geometry', also=[W], hint=['aniso', 'thin'])
    mix = [p + ([-c for c in p] if (rng.u64() & 1) else list(p)) for p in sp]
    add('geo_mixed_orientation_normals.ply', ply_bin(mix, '<6f', XYZF + ('float nx', 'float ny', 'float nz')), S, 'geometry',
        'normals with random signs: must be re-oriented or ignored, never trusted', sp32, normals=True, also=[W], hint=['normal', 'orient'])
    inv = [p + [-c for c in p] for p in sp]
    add('geo_inverted_normals.ply', ply_bin(inv, '<6f', XYZF + ('float nx', 'float ny', 'float nz')), S, 'geometry',
        'consistent but inward normals: output must point outward', sp32, normals=True, also=[W], hint=['normal', 'orient', 'inward'])
