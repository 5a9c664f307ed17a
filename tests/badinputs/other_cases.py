"""XYZ, OBJ, PCD, OFF, NPY, and names that lie."""
import math, struct

from collection import F, S, W, add
from samples import *


def xyz_files(sp, sp32, rng):
    """XYZ"""
    add('xyz_ok.xyz', xyz(sp), S, 'valid', 'control', sp)
    add('xyz_crlf.xyz', xyz(sp, nl='\r\n'), S, 'encoding', 'CRLF', sp)
    add('xyz_cr_only.xyz', xyz(sp, nl='\r'), S, 'encoding', 'CR', sp, also=[F], hint=['line'])
    add('xyz_no_final_newline.xyz', xyz(sp)[:-1], S, 'syntax', 'last line not ended', sp)
    add('xyz_csv.xyz', xyz(sp, sep=','), S, 'syntax', 'comma separated', sp)
    add('xyz_csv_header.xyz', b'x,y,z\n' + xyz(sp, sep=', '), S, 'syntax', 'comma separated, a header line', sp, also=[W])
    add('xyz_semicolon.xyz', xyz(sp, sep=';'), S, 'syntax', 'semicolons', sp, also=[F], hint=['line', 'number', 'separator'])
    add('xyz_decimal_comma.xyz', xyz(sp).replace(b'.', b','), F, 'encoding', 'decimal commas: "0,5 0,25 0,1"', hint=['comma', 'number', 'line'], also=[W])
    add('xyz_decimal_comma_semicolon.xyz', xyz(sp, sep=';').replace(b'.', b','), F, 'encoding', 'German spreadsheet', hint=['comma', 'number', 'line', 'separator'], also=[W, S])
    add('xyz_hash_comments.xyz', b'# made by hand\n#\n' + xyz(sp[:300]) + b'# half\n' + xyz(sp[300:]), S, 'syntax', '# comments', sp)
    add('xyz_slash_comments.xyz', b'//X Y Z\n' + xyz(sp), S, 'syntax', 'CloudCompare header line', sp, also=[W])
    add('xyz_count_line.xyz', b'600\n' + xyz(sp), S, 'syntax', 'first line is the count (PTS)', sp, also=[F, W], hint=['line', 'column'])
    add('xyz_blank_lines.xyz', b'\n\n' + xyz(sp).replace(b'\n', b'\n\n') + b'   \n', S, 'syntax', 'blank lines', sp)
    add('xyz_leading_blanks.xyz', xyz(sp).replace(b'\n', b' \t\n   '), S, 'syntax', 'blanks around', sp)
    add('xyz_6_columns.xyz', xyz([p + p for p in sp]), S, 'valid', 'normals in columns 4..6', sp, normals=True)
    add('xyz_7_columns.xyz', xyz([p + [0.5, 10, 20, 30] for p in sp]), S, 'valid', 'intensity and colour', sp, also=[W])
    add('xyz_2_columns.xyz', xyz([p[:2] for p in sp]), F, 'syntax', 'two columns', hint=['column', 'line', 'three', '3'])
    add('xyz_ragged.xyz', xyz(sp[:300]) + b'0.5 0.5\n' + xyz(sp[300:]), F, 'syntax', 'one line has two numbers', hint=['line', 'column', '301'], also=[W])
    add('xyz_word.xyz', xyz(sp[:300]) + b'0.5 north 0.5\n' + xyz(sp[300:]), F, 'syntax', 'a word on line 301; silent stop there loses half the cloud', hint=['line', 'number', '301'], also=[W])
    add('xyz_ansi_escape.xyz', xyz(sp[:300]) + b'0.5 \x1b[31mred\x1b[0m 0.5\n' + xyz(sp[300:]), F, 'security',
        'terminal escapes on line 301', hint=['line', 'number', '301'], also=[W])
    add('xyz_truncated_number.xyz', xyz(sp)[:-20], F, 'count', 'cut inside the last line', hint=['line', 'column', '600'], also=[W])
    add('xyz_nan_tokens.xyz', xyz(sp) + b'nan nan nan\nNaN 1 2\n-nan(ind) 0 0\n1.#QNAN 0 0\ninf 0 0\n-Infinity 1 1\n1.#INF 0 0\n', W, 'values', 'seven ways to write no number',
        sp, n_raw=607, hint=['finite', 'nan', 'line'], also=[F])
    add('xyz_fortran_exponent.xyz', b'1.0D+00 2.0d0 3.0D-1\n' + xyz(sp), F, 'syntax', 'Fortran D exponents: never 1.0 alone', hint=['line', 'number', '1'], also=[W])
    add('xyz_utf8_bom.xyz', b'\xef\xbb\xbf' + xyz(sp), S, 'encoding', 'BOM (Notepad): must not lose line 1', sp, also=[W, F], hint=['line', 'bom', 'number'])
    add('xyz_utf16.xyz', xyz(sp).decode().encode('utf-16'), F, 'encoding', 'UTF-16', hint=['line', 'number', 'utf', 'text', 'nul'])
    add('xyz_binary.xyz', bytes(rng.u64() & 255 for _ in range(20000)), F, 'security', 'noise', hint=['line', 'number', 'text', 'binary'])
    add('xyz_empty.xyz', b'', F, 'syntax', 'zero bytes', hint=['empty', 'no points'])
    add('xyz_only_comments.xyz', b'# nothing\n# here\n', F, 'syntax', 'no data', hint=['no points', 'empty'])
    add('xyz_line_1mib.xyz', xyz(sp) + b'0' * (1 << 20) + b' 0 0\n', F, 'limits', 'a number of 2^20 digits', hint=['line', 'long', 'number'], also=[S, W])
    add('xyz_one_line.xyz', xyz(sp).replace(b'\n', b' '), F, 'syntax', 'all 1800 numbers on one line', hint=['line', 'column'], also=[W])
    add('xyz_nul_bytes.xyz', xyz(sp[:300]) + b'\0\0\0\0' + xyz(sp[300:]), F, 'security', 'NUL bytes inside (a crash while writing)', hint=['line', 'nul', 'number', 'character'], also=[W])
    add('xyz_thousands.xyz', b''.join(b'1,234.5 2,345.5 %d\n' % i for i in range(100)), F, 'encoding', 'thousands separators', hint=['comma', 'number', 'line', 'column'], also=[W])


def obj_files(sp, sp32, rng):
    """OBJ"""
    def obj(pts, tail=b'', nl='\n'):
        return ''.join('v ' + ' '.join(num(c) for c in p) + nl for p in pts).encode() + tail

    tri = b''.join(b'f %d %d %d\n' % (i + 1, i + 2, i + 3) for i in range(300))
    add('obj_points_only.obj', obj(sp), S, 'valid', 'v lines only', sp)
    add('obj_with_faces.obj', b'mtllib a.mtl\no thing\ng part\n' + obj(sp, b'usemtl m\ns off\n' + tri), S, 'valid', 'faces are ignored; the mtllib file does not exist', sp)
    add('obj_vn.obj', obj(sp) + ''.join('vn ' + ' '.join(num(c) for c in p) + '\n' for p in sp).encode() +
        b''.join(b'f %d//%d %d//%d %d//%d\n' % (i + 1, i + 1, i + 2, i + 2, i + 3, i + 3) for i in range(300)), S, 'valid', 'normals', sp, normals=True)
    add('obj_rgb.obj', obj([p + [0.1, 0.2, 0.3] for p in sp]), S, 'valid', 'v x y z r g b', sp)
    add('obj_w.obj', obj([p + [1.0] for p in sp], tri), S, 'valid', 'v x y z w', sp)
    add('obj_crlf.obj', obj(sp, tri.replace(b'\n', b'\r\n'), '\r\n'), S, 'encoding', 'CRLF', sp)
    add('obj_continuation.obj', obj(sp).replace(b' ', b' \\\n', 600), S, 'syntax', 'lines continued with a backslash', sp, also=[F], hint=['line', 'number'])
    add('obj_face_index_huge.obj', obj(sp, b'f 1 2 2147483647\nf 1 2 99999999999999999999\n'), S, 'security', 'face index out of range (tinyobjloader TALOS-2020-1212, assimp#4925): faces are not used', sp, also=[W, F], hint=['face', 'index', 'range'])
    add('obj_face_index_negative.obj', obj(sp, b'f -1 -2 -3\nf -99999 -2 -3\n'), S, 'security', 'relative index before the first vertex (draco#1176, CVE-2020-28589)', sp, also=[W, F], hint=['face', 'index', 'range'])
    add('obj_face_index_zero.obj', obj(sp, b'f 0 1 2\n'), S, 'security', 'index 0', sp, also=[W, F], hint=['face', 'index'])
    add('obj_face_100000_corners.obj', obj(sp, b'f' + b' 1 2 3' * 33334 + b'\n'), S, 'limits', 'one face with 100 002 corners', sp, also=[W, F], hint=['face', 'long'])
    add('obj_vertical_tab.obj', obj(sp, b'f 1\x0b2 3\nf 1/\x0b/2 2 3\n'), S, 'security', 'assimp#6540: heap-buffer-overflow in getFace', sp, also=[W, F], hint=['face', 'line'])
    add('obj_slashes.obj', obj(sp, b'f 1/ 2/ 3/\nf 1// 2// 3//\nf ///// 2 3\nf /\n'), S, 'security', 'assimp#4234: empty index fields', sp, also=[W, F], hint=['face', 'index'])
    add('obj_short_vertex.obj', obj(sp[:300]) + b'v 0.5 0.5\n' + obj(sp[300:]), F, 'syntax', 'v with two numbers', hint=['line', 'vertex', '301', 'number'])
    add('obj_nan_vertex.obj', obj(sp) + b'v nan nan nan\nv inf 0 0\n', W, 'values', 'NaN and inf', sp, n_raw=602, hint=['finite', 'nan'], also=[F])
    add('obj_no_vertices.obj', b'# empty\ng nothing\n', F, 'syntax', 'no v lines', hint=['no points', 'vert', 'empty'])
    add('obj_empty.obj', b'', F, 'syntax', 'zero bytes', hint=['empty', 'no points', 'vert'])
    add('obj_line_1mib.obj', obj(sp) + b'# ' + b'x' * (1 << 20) + b'\n', S, 'limits', 'a comment of 1 MiB', sp, also=[F])
    add('obj_decimal_comma.obj', obj(sp).replace(b'.', b','), F, 'encoding', 'decimal commas (mm3d#159)', hint=['comma', 'number', 'line'])
    add('obj_nul.obj', obj(sp[:300]) + b'v 0 \0 0 0\n' + obj(sp[300:]), F, 'security', 'NUL byte', hint=['line', 'number', 'nul', 'character'], also=[W])


def pcd_files(sp, sp32, rng):
    """PCD"""
    ip = thousandths(sp)
    nr = with_normals(sp)
    add('pcd_ascii_ok.pcd', pcd_head(600) + xyz(sp), S, 'valid', 'control', sp, tol=2e-7)
    add('pcd_binary_ok.pcd', pcd_head(600, data='binary') + body(sp, '<3f'), S, 'valid', 'control', sp32)
    cmp_raw = b''.join(struct.pack('<600f', *[p[k] for p in sp]) for k in range(3))
    cz = lzf_literals(cmp_raw)
    add('pcd_compressed_ok.pcd', pcd_head(600, data='binary_compressed') + struct.pack('<II', len(cz), len(cmp_raw)) + cz, S, 'valid', 'LZF', sp32)
    add('pcd_double.pcd', pcd_head(600, size='8 8 8', data='binary') + body(sp, '<3d'), S, 'valid', 'F 8', sp)
    add('pcd_int_coords.pcd', pcd_head(600, typ='I I I', data='binary') + body(ip, '<3i'), S, 'valid', 'I 4', ip, also=[F], hint=['type', 'float'])
    add('pcd_padding.pcd', pcd_head(600, 'x y z _ rgb _', '4 4 4 1 4 1', 'F F F U F U', '1 1 1 4 1 12', data='binary') +
        b''.join(struct.pack('<3f4xf12x', p[0], p[1], p[2], 0.0) for p in sp), S, 'valid', 'padding fields "_"', sp32)
    add('pcd_normals.pcd', pcd_head(600, 'x y z normal_x normal_y normal_z', '4 ' * 5 + '4', 'F ' * 5 + 'F', '1 ' * 5 + '1', data='binary') + body(nr, '<6f'), S, 'valid', 'normals', sp32, normals=True)
    org = [[math.nan] * 3 if i % 5 == 0 else p for i, p in enumerate(sp32)]
    add('pcd_organized_nan.pcd', pcd_head(600, width=30, height=20, points=600, data='binary') + body(org, '<3f'), S, 'values', 'organized, 20 % NaN: normal for depth cameras', org, also=[W], hint=['finite', 'nan'])
    add('pcd_no_viewpoint.pcd', pcd_head(600).replace(b'VIEWPOINT 0 0 0 1 0 0 0\n', b'') + xyz(sp), S, 'valid', 'v0.6 style', sp, tol=2e-7)
    add('pcd_crlf.pcd', (pcd_head(600) + xyz(sp)).replace(b'\n', b'\r\n'), S, 'encoding', 'CRLF', sp, tol=2e-7)
    add('pcd_width_height_mismatch.pcd', pcd_head(600, width=25, height=20, data='binary') + body(sp, '<3f'), F, 'count', 'WIDTH*HEIGHT != POINTS', hint=['width', 'points', 'height'], also=[W])
    add('pcd_width_negative.pcd', pcd_head(600, width=-600, data='binary') + body(sp, '<3f'), F, 'count', 'WIDTH -600', hint=['width', 'negative', 'number'])
    add('pcd_width_product_overflow.pcd', pcd_head(600, width=1 << 32, height=1 << 32, points=600, data='binary') + body(sp, '<3f'), F, 'count', 'WIDTH*HEIGHT = 2^64 wraps to 0', hint=['width', 'points', 'large', 'truncated', 'size'])
    add('pcd_points_2e40.pcd', pcd_head(1 << 40, data='binary') + body(sp, '<3f'), F, 'count', '2^40 points, 7 KB (Open3D#7402 crashes even on true big ones)', hint=['points', 'truncated', 'size', 'large'])
    add('pcd_points_1e9_ascii.pcd', pcd_head(10 ** 9) + xyz(sp), F, 'count', '1e9 points in ascii', hint=['points', 'truncated', 'end', 'large'])
    add('pcd_truncated_binary.pcd', (pcd_head(600, data='binary') + body(sp, '<3f'))[:-100], F, 'count', 'short', hint=['truncated', 'size', 'end'])
    add('pcd_truncated_ascii.pcd', (pcd_head(600) + xyz(sp))[:-9000], F, 'count', 'short', hint=['truncated', 'points', 'end', 'line'])
    add('pcd_no_data_line.pcd', pcd_head(600).replace(b'DATA ascii\n', b'') + xyz(sp), F, 'syntax', 'no DATA', hint=['data', 'header'])
    add('pcd_data_unknown.pcd', pcd_head(600, data='quantum') + xyz(sp), F, 'syntax', 'DATA quantum', hint=['data'])
    add('pcd_no_fields.pcd', pcd_head(600).replace(b'FIELDS x y z\n', b'') + xyz(sp), F, 'syntax', 'no FIELDS', hint=['field'])
    add('pcd_no_z.pcd', pcd_head(600, 'x y', '4 4', 'F F', '1 1') + xyz([p[:2] for p in sp]), F, 'syntax', 'no z', hint=['z', 'field'])
    add('pcd_size_count_mismatch.pcd', pcd_head(600, size='4 4', data='binary') + body(sp, '<3f'), F, 'syntax', 'three FIELDS, two SIZEs (PCL#2138 kind)', hint=['size', 'field'])
    add('pcd_size_zero.pcd', pcd_head(600, size='0 0 0', data='binary') + body(sp, '<3f'), F, 'security', 'SIZE 0', hint=['size'])
    add('pcd_size_3.pcd', pcd_head(600, size='3 3 3', data='binary') + body(sp, '<3f'), F, 'security', 'SIZE 3 (PCL#2045: field size tampered)', hint=['size'])
    add('pcd_size_huge.pcd', pcd_head(600, size='4 4 2147483647', data='binary') + body(sp, '<3f'), F, 'security', 'SIZE 2^31-1', hint=['size'])
    add('pcd_type_letter.pcd', pcd_head(600, typ='Q Q Q', data='binary') + body(sp, '<3f'), F, 'security', 'TYPE Q', hint=['type'])
    add('pcd_count_zero.pcd', pcd_head(600, count='0 1 1', data='binary') + body(sp, '<3f'), F, 'security', 'COUNT 0 for x', hint=['count', 'x'])
    add('pcd_count_huge.pcd', pcd_head(600, 'x y z h', '4 4 4 8', 'F F F F', '1 1 1 536870912', data='binary') + body(sp, '<3f'), F, 'security', 'COUNT 2^29 of 8 bytes: the stride wraps to 12', hint=['count', 'size', 'truncated'])
    add('pcd_compressed_size_lies.pcd', pcd_head(600, data='binary_compressed') + struct.pack('<II', 0xFFFFFFF0, len(cmp_raw)) + cz, F, 'security', 'compressed size 2^32-16', hint=['compress', 'size', 'truncated'])
    add('pcd_uncompressed_size_lies.pcd', pcd_head(600, data='binary_compressed') + struct.pack('<II', len(cz), 0xFFFFFFF0) + cz, F, 'security', 'uncompressed size 2^32-16: 4 GiB from 8 KB', hint=['compress', 'size'])
    add('pcd_compressed_small_out.pcd', pcd_head(600, data='binary_compressed') + struct.pack('<II', len(cz), 16) + cz, F, 'security', 'uncompressed size 16 < the stream', hint=['compress', 'size'])
    bad = b'\x00A' + b'\xe0\xff\xff' * 200
    add('pcd_compressed_bad_backref.pcd', pcd_head(600, data='binary_compressed') + struct.pack('<II', len(bad), len(cmp_raw)) + bad, F, 'security', 'back reference before the start', hint=['compress', 'corrupt'])
    add('pcd_ascii_word.pcd', pcd_head(600) + xyz(sp[:300]) + b'a b c\n' + xyz(sp[301:]), F, 'syntax', 'words for numbers', hint=['line', 'number', 'point'], also=[W])
    add('pcd_ascii_nan.pcd', pcd_head(600) + xyz([[math.nan] * 3 if i % 5 == 0 else p for i, p in enumerate(sp)]), S, 'values', 'nan tokens', [[math.nan] * 3 if i % 5 == 0 else p for i, p in enumerate(sp)], also=[W], tol=2e-7, hint=['finite', 'nan'])
    add('pcd_malformed_baidu.pcd', b'#@.PON 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH POINT 0 0 0 0 0\nPOINTS 51\nDAT000001 0\n0.31 -0.01010880423\n', F, 'security', 'shape of PCL#2138', hint=['width', 'header', 'data'])
    add('pcd_empty.pcd', b'', F, 'syntax', 'zero bytes (PCL#5855)', hint=['empty', 'header'])
    add('pcd_header_only.pcd', pcd_head(600, data='binary'), F, 'count', 'no data', hint=['truncated', 'end', 'size', 'data'])
    add('pcd_zero_points.pcd', pcd_head(0), F, 'count', 'no points', pts=[], read=S, hint=['no points', 'empty', 'at least'])


def off_files(sp, sp32, rng):
    """OFF"""
    def off(pts, nf=0, tail=b'', head=b'OFF\n', n=None):
        return head + b'%d %d 0\n' % (len(pts) if n is None else n, nf) + xyz(pts) + tail

    of = b''.join(b'3 %d %d %d\n' % (i, i + 1, i + 2) for i in range(300))
    add('off_points_only.off', off(sp), S, 'valid', 'no faces', sp)
    add('off_with_faces.off', off(sp, 300, of), S, 'valid', 'faces ignored', sp)
    add('off_comments.off', b'OFF # magic\n# c\n\n600 300 0 # counts\n# c\n' + xyz(sp).replace(b'\n', b' # p\n', 5) + of, S, 'syntax', 'comments everywhere (libigl CVE-2024-24684..24686 live here)', sp)
    add('off_counts_on_magic_line.off', b'OFF 600 300 0\n' + xyz(sp) + of, S, 'syntax', '"OFF 600 300 0" (ModelNet40)', sp)
    add('off_counts_glued.off', b'OFF600 300 0\n' + xyz(sp) + of, S, 'syntax', '"OFF600 300 0" (ModelNet40, really)', sp, also=[F], hint=['magic', 'off', 'header'])
    add('off_noff.off', off([p + p for p in sp], head=b'NOFF\n'), S, 'valid', 'normals', sp, normals=True)
    add('off_coff.off', off([p + [10, 20, 30, 255] for p in sp], 300, of, head=b'COFF\n'), S, 'valid', 'colours', sp)
    add('off_token_64k.off', b'O' * 65536 + b'\n600 0 0\n' + xyz(sp), F, 'security', 'a 64 KiB first token (bullet3 CVE-2025-8854: fscanf %s)', hint=['magic', 'off'])
    add('off_comment_64k.off', b'OFF\n#' + b'c' * 65536 + b'\n600 0 0\n' + xyz(sp), S, 'security', 'a 64 KiB comment (libigl TALOS-2024-1929)', sp, also=[F], hint=['line', 'long'])
    add('off_count_negative.off', off(sp, n=-600), F, 'count', 'count -600', hint=['count', 'negative', 'number'])
    add('off_count_2e31.off', off(sp, n=1 << 31), F, 'count', '2^31 vertices', hint=['count', 'truncated', 'large', 'end'])
    add('off_count_2e62.off', off(sp, n=1 << 62), F, 'count', '2^62 vertices', hint=['count', 'truncated', 'large', 'end', 'range'])
    add('off_face_count_2e31.off', off(sp, 1 << 31, of), F, 'count', '2^31 faces declared, 300 there', hint=['face', 'count', 'truncated', 'large'], also=[S, W])
    add('off_truncated.off', off(sp)[:-9000], F, 'count', 'short', hint=['truncated', 'end', 'vert'])
    add('off_face_index_range.off', off(sp, 2, b'3 0 1 600\n3 0 1 2147483647\n'), S, 'security', 'index out of range', sp, also=[W, F], hint=['face', 'index', 'range'])
    add('off_face_negative_corners.off', off(sp, 1, b'-3 0 1 2\n'), S, 'security', 'a face with -3 corners (libigl CVE-2023-35949..53 kind)', sp, also=[W, F], hint=['face', 'count'])
    add('off_face_2e31_corners.off', off(sp, 1, b'2147483647 0 1 2\n'), S, 'security', 'a face with 2^31-1 corners', sp, also=[W, F], hint=['face', 'count', 'truncated'])
    add('off_7gon.off', b'OFF\n8 1 0\n\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\n7  4 6 0 2 3 1 5\n', F, 'geometry', 'MeshLab#1163 (crash there); 8 points are few', [[float(i & 1), float(i >> 1 & 1), float(i >> 2)] for i in range(8)], read=S, also=[S, W], hint=['at least', 'few', 'points'])
    add('off_binary_magic.off', b'OFF BINARY\n' + struct.pack('>iii', 600, 0, 0) + body(sp, '>3f'), S, 'valid', 'geomview binary', sp32, also=[F], hint=['binary'])
    add('off_empty.off', b'', F, 'syntax', 'zero bytes', hint=['empty', 'magic', 'off'])


def npy_files(sp, sp32, rng):
    """NPY"""
    ip = thousandths(sp)
    nr = with_normals(sp)
    fl = body(sp, '<3f')
    add('npy_f4.npy', npy("'<f4'", 'False', '(600, 3)', fl), S, 'valid', 'control', sp32)
    add('npy_f8.npy', npy("'<f8'", 'False', '(600, 3)', body(sp, '<3d')), S, 'valid', 'control', sp)
    add('npy_be_f8.npy', npy("'>f8'", 'False', '(600, 3)', body(sp, '>3d')), S, 'encoding', 'big-endian', sp)
    add('npy_fortran.npy', npy("'<f8'", 'True', '(600, 3)', b''.join(struct.pack('<600d', *[p[k] for p in sp]) for k in range(3))), S, 'encoding', 'column major', sp)
    add('npy_6_columns.npy', npy("'<f4'", 'False', '(600, 6)', body(nr, '<6f')), S, 'valid', 'normals in columns 4..6', sp32, normals=True)
    add('npy_v2.npy', npy("'<f4'", 'False', '(600, 3)', fl, ver=2), S, 'valid', 'header version 2', sp32)
    add('npy_v3.npy', npy("'<f4'", 'False', '(600, 3)', fl, ver=3), S, 'valid', 'header version 3', sp32)
    add('npy_i4.npy', npy("'<i4'", 'False', '(600, 3)', body(ip, '<3i')), S, 'valid', 'int32', ip, also=[F], hint=['type', 'dtype'])
    add('npy_f2.npy', npy("'<f2'", 'False', '(600, 3)', b''.join(struct.pack('<3e', *p) for p in sp)), S, 'valid', 'float16', [[struct.unpack('<e', struct.pack('<e', c))[0] for c in p] for p in sp], also=[F], hint=['type', 'dtype'])
    add('npy_transposed.npy', npy("'<f4'", 'False', '(3, 600)', b''.join(struct.pack('<600f', *[p[k] for p in sp]) for k in range(3))), F, 'syntax', 'shape (3, n): say so, do not take 3 points', hint=['shape', 'transpos', 'column'], also=[W])
    add('npy_1d.npy', npy("'<f4'", 'False', '(1800,)', fl), F, 'syntax', 'one dimension', hint=['shape', 'dimension'])
    add('npy_3d.npy', npy("'<f4'", 'False', '(20, 30, 3)', fl), F, 'syntax', 'three dimensions', hint=['shape', 'dimension'], also=[W, S])
    add('npy_object_pickle.npy', npy("'|O'", 'False', '(600, 3)', b'\x80\x04cos\nsystem\n(S"touch PWNED"\ntR.'), F, 'security', 'object array: a pickle that runs code; never unpickle', hint=['object', 'dtype', 'type', 'pickle'])
    add('npy_header_code.npy', npy('', '', '', fl, raw_header="{'descr': __import__('os').system('touch PWNED'), 'fortran_order': False, 'shape': (600, 3), }"), F, 'security', 'an expression in the header; never eval', hint=['header'])
    add('npy_structured.npy', npy("[('x', '<f4'), ('y', '<f4'), ('z', '<f4')]", 'False', '(600,)', fl), S, 'valid', 'structured dtype', sp32, also=[F], hint=['dtype', 'type', 'structured'])
    add('npy_shape_2e40.npy', npy("'<f4'", 'False', '(1099511627776, 3)', fl), F, 'count', '2^40 rows, 7 KB', hint=['truncated', 'size', 'shape', 'large'])
    add('npy_shape_overflow.npy', npy("'<f8'", 'False', '(3074457345618258603, 3)', fl), F, 'count', 'rows*3*8 wraps to 24', hint=['shape', 'large', 'overflow', 'size', 'truncated'])
    add('npy_shape_negative.npy', npy("'<f4'", 'False', '(-600, 3)', fl), F, 'count', 'negative', hint=['shape', 'negative'])
    add('npy_shape_zero.npy', npy("'<f4'", 'False', '(0, 3)', b''), F, 'count', 'no rows', pts=[], read=S, hint=['no points', 'empty', 'at least'])
    add('npy_truncated.npy', npy("'<f4'", 'False', '(600, 3)', fl)[:-1000], F, 'count', 'short', hint=['truncated', 'size', 'end'])
    add('npy_trailing.npy', npy("'<f4'", 'False', '(600, 3)', fl) + b'more', W, 'count', 'goes on', sp32, hint=['trailing', 'extra'], also=[S])
    add('npy_header_len_lies.npy', b'\x93NUMPY\x02\x00' + struct.pack('<I', 0xFFFFFFFF) + b"{'descr': '<f4'", F, 'security', 'header length 2^32-1', hint=['header', 'truncated', 'size'])
    add('npy_header_no_dict.npy', npy('', '', '', fl, raw_header="hello"), F, 'syntax', 'header is not a dict', hint=['header'])
    add('npy_bad_magic.npy', b'\x93NUMPX' + npy("'<f4'", 'False', '(600, 3)', fl)[6:], F, 'syntax', 'magic wrong', hint=['magic', 'npy'])
    add('npy_empty.npy', b'', F, 'syntax', 'zero bytes', hint=['empty', 'magic'])


def name_tricks(sp, sp32, rng):
    """Name tricks"""
    add('wrong_ext_ply_as_xyz.xyz', ply_ascii(sp), F, 'encoding', 'a PLY called .xyz: must not read the numbers of the header', hint=['ply', 'line', 'number'], also=[S, W])
    add('wrong_ext_xyz_as_ply.ply', xyz(sp), F, 'encoding', 'an XYZ called .ply', hint=['magic', 'ply'], also=[S, W])
