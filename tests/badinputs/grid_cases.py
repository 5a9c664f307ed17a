"""ASCII grids of Arc/Info."""
import math

from collection import F, S, W, add
from samples import *

COLUMNS, ROWS, SIZE = 30, 20, 0.5
HEAD = b'ncols 30\nnrows 20\nxllcorner 1000\nyllcorner 2000\ncellsize 0.5\n'
NO_DATA = b'NODATA_value -9999\n'


def heights():
    return [round(0.8 * math.sin(0.3 * c) * math.cos(0.4 * r), 6) + 0.0 for r in range(ROWS) for c in range(COLUMNS)]


def points(zs, north=2000 + SIZE * ROWS):  # of the cells from the north-west on
    return [[1000 + SIZE * (i % COLUMNS + 0.5), north - SIZE * (i // COLUMNS + 0.5), z] for i, z in enumerate(zs)]


def rows(zs, per_line=COLUMNS, nl='\n'):
    return ''.join(' '.join(num(z) for z in zs[at:at + per_line]) + nl for at in range(0, len(zs), per_line)).encode()


def grid_files(sp, sp32, rng):
    """Grids"""
    zs = heights()
    pts = points(zs)
    good = HEAD + NO_DATA + rows(zs)
    third = [-9999.0 if i % 3 == 0 else z for i, z in enumerate(zs)]
    tight = 1e-9
    add('grid_ok.asc', good, S, 'valid', 'control', pts, tol=tight)
    add('grid_no_data_key.asc', HEAD + rows(zs), S, 'valid', 'without NODATA_value', pts, tol=tight)
    add('grid_other_order.asc', b'CELLSIZE 0.5\r\nYLLCENTER 2000.25\r\nXLLCENTER 1000.25\r\nNROWS 20\r\nNCOLS 30\r\n' + rows(zs, nl='\r\n'), S, 'syntax', 'other order, capitals, middles, CRLF', pts, tol=tight)
    add('grid_dx_dy.asc', HEAD.replace(b'cellsize 0.5', b'dx 0.5\ndy 0.5') + rows(zs), S, 'syntax', 'dx and dy, as GDAL writes', pts, tol=tight)
    add('grid_value_per_line.asc', HEAD + rows(zs, 1), S, 'syntax', 'one value a line', pts, tol=tight)
    add('grid_one_line.asc', HEAD + rows(zs, 600), S, 'syntax', 'all values in one line', pts, tol=tight)
    add('grid_voids.asc', HEAD + NO_DATA + rows(third), S, 'values', 'a third without a value', [p for i, p in enumerate(pts) if i % 3], tol=tight)
    add('grid_voids_nan.asc', HEAD + b'NODATA_value nan\n' + rows([math.nan if i % 3 == 0 else z for i, z in enumerate(zs)]), S, 'values', 'nan for what has no value', [p for i, p in enumerate(pts) if i % 3], tol=tight)
    add('grid_no_data_wrong.asc', HEAD + b'NODATA_value 0\n' + rows(third), W, 'values', '-9999 although NODATA_value is 0', points(third), also=[S], hint=['nodata_value'])
    add('grid_open_end.asc', good[:-1], W, 'count', 'no line end', pts, tol=tight, also=[S], hint=['line end'])
    add('grid_all_voids.asc', HEAD + NO_DATA + rows([-9999.0] * 600), F, 'values', 'no cell has a value', pts=[], read=W, hint=['no points', 'at least'])
    add('grid_truncated.asc', good[:-900], F, 'count', 'short', hint=['truncated'])
    add('grid_cut_in_header.asc', good[:40], F, 'count', 'ends in the header', hint=['truncated', 'number', 'yllcorner'])
    add('grid_only_header.asc', HEAD + NO_DATA, F, 'count', 'no values', hint=['truncated'])
    add('grid_one_more.asc', good + b'1\n', F, 'count', 'a value more than ncols x nrows', hint=['end of the file'])
    add('grid_one_row_more.asc', good + rows(zs[:COLUMNS]), F, 'count', 'a row more', hint=['end of the file'])
    add('grid_twice.asc', good + good, F, 'count', 'two grids in one file', hint=['end of the file'])
    add('grid_counts_2e31.asc', good.replace(b'ncols 30', b'ncols 2147483648').replace(b'nrows 20', b'nrows 2147483648'), F, 'count', '2^62 values', hint=['large'])
    add('grid_counts_wrap.asc', good.replace(b'ncols 30', b'ncols 4294967296').replace(b'nrows 20', b'nrows 4294967296'), F, 'count', 'ncols * nrows wraps to 0', hint=['large'])
    add('grid_count_2e64.asc', good.replace(b'ncols 30', b'ncols 18446744073709551616'), F, 'count', 'no 64-bit number', hint=['large'])
    add('grid_count_zero.asc', good.replace(b'ncols 30', b'ncols 0'), F, 'count', 'no columns', hint=['at least 1'])
    add('grid_count_negative.asc', good.replace(b'nrows 20', b'nrows -20'), F, 'count', 'a negative count', hint=['negative'])
    add('grid_count_word.asc', good.replace(b'nrows 20', b'nrows many'), F, 'syntax', 'a word for a count', hint=['whole number'])
    for key in (b'ncols', b'nrows', b'xllcorner', b'yllcorner', b'cellsize'):
        add('grid_no_%s.asc' % key.decode(), b''.join(l for l in good.splitlines(True) if not l.startswith(key)), F, 'syntax', 'a key is missing', hint=[key.decode()])
    add('grid_key_twice.asc', b'ncols 30\n' + good, F, 'syntax', 'ncols twice', hint=['once'])
    add('grid_key_unknown.asc', good.replace(b'cellsize', b'cell_size'), F, 'syntax', 'a key that is none', hint=['key'])
    add('grid_size_zero.asc', good.replace(b'cellsize 0.5', b'cellsize 0'), F, 'values', 'cells without a size', hint=['above 0'])
    add('grid_size_negative.asc', good.replace(b'cellsize 0.5', b'cellsize -0.5'), F, 'values', 'a negative size', hint=['above 0'])
    add('grid_corner_nan.asc', good.replace(b'xllcorner 1000', b'xllcorner nan'), F, 'values', 'a corner nowhere', hint=['finite'])
    add('grid_commas.asc', good.replace(b'.', b','), F, 'syntax', 'decimal commas', hint=['decimal comma'])
    add('grid_word.asc', HEAD + NO_DATA + rows(zs[1:]) + b'sea\n', F, 'syntax', 'a word for a value', hint=['number'])
    add('grid_control.asc', HEAD + NO_DATA + rows(zs[1:]) + b'\x1b[2J\n', F, 'security', 'an escape sequence for a value', hint=['number'])
    add('grid_long_key.asc', good.replace(b'cellsize', b'c' * (1 << 20)), F, 'limits', 'a key of a megabyte', hint=['key'])
    add('grid_surfer.grd', b'DSAA\r\n30 20\r\n0 14.5\r\n0 9.5\r\n-1 1\r\n' + rows(zs), F, 'syntax', 'a Surfer grid', hint=['surfer'])
