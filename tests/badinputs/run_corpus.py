#!/usr/bin/python3
"""Judge any command-line tool on the corpus of badinputs.py (standard library only).

run_corpus.py [--corpus DIR] [--out-ext ply] [--read] [--only START,START] [--json OUT] [--seconds S] [--any-rss] -- CMD... {in} ... {out}

--seconds, --any-rss   another time limit; no memory limit (sanitizers keep shadow memory)
--read   judge against expect_read (tools that only read/convert) instead of expect
A file passes when
  must_fail                exit 1..125, stderr not empty, names the file and one of the hints, no output left
  must_succeed             exit 0, output exists, is not empty, and (PLY) its counts and floats are finite
  must_succeed_with_warning  the same, and stderr holds one of the hints
and always: no signal, no time-out, peak RSS within the budget, no control byte on stderr, no *.tmp left behind.
"""
import json, os, re, shutil, struct, sys, tempfile, time, math, collections
a = sys.argv[1:]
cut = a.index('--'); opt, cmd = a[:cut], a[cut + 1:]
def get(k, d=None): return opt[opt.index(k) + 1] if k in opt else d
here = os.path.dirname(os.path.abspath(__file__))
corpus = get('--corpus', here + '/badinputs'); ext = get('--out-ext', 'ply'); only = tuple(get('--only', '').split(','))
man = json.load(open(corpus + '/manifest.json')); B = man['budget']
B['seconds'] = float(get('--seconds', B['seconds']))
unmet = [start for start in only if not any(e['file'].startswith(start) for e in man['files'])]
if unmet: sys.exit('run_corpus.py: no file of the corpus starts with %s' % ', '.join(map(repr, unmet)))
key = 'expect_read' if '--read' in opt else 'expect'
S, W, F = 'must_succeed', 'must_succeed_with_warning', 'must_fail_with_clear_error'
def ply_bad(path, e):
    b = open(path, 'rb').read(); h = b.find(b'\nend_header\n') + 1
    if not b.startswith(b'ply') or h < 1: return None
    m = re.search(rb'element vertex (\d+)', b[:h])
    if not m or (int(m.group(1)) == 0 and e['n'] != 0): return 'output has no vertices'
    if '--read' in opt and e['n'] is not None and int(m.group(1)) != e['n']: return 'output has %s points' % m.group(1).decode()
    if re.search(rb'element (\S+) (\d+)', b[:h]).group(1) != b'vertex': return None  # records of unknown size come first
    if b'binary_little_endian' in b[:h]:
        pr, names = [], []
        for l in b[:h].split(b'\n'):
            w = l.split()
            if w[:1] == [b'element']: cur = w[1]
            if w[:1] == [b'property'] and cur == b'vertex':
                if w[1] == b'list': return None
                names.append(w[2])
                pr.append({b'float': 'f', b'float32': 'f', b'double': 'd', b'float64': 'd', b'uchar': 'B', b'uint8': 'B', b'int': 'i', b'uint': 'I', b'short': 'h', b'ushort': 'H', b'char': 'b'}[w[1]])
        st = struct.Struct('<' + ''.join(pr)); o = h + 11; n = int(m.group(1))
        if len(b) < o + n * st.size: return 'output truncated'
        at = [names.index(c) for c in (b'x', b'y', b'z')]; low, high, strays = [math.inf] * 3, [-math.inf] * 3, 0
        for i in range(n):
            r = st.unpack_from(b, o + i * st.size)
            # orient gives every point back, also those that are not finite; nothing else may be
            odd = any(not math.isfinite(r[k]) for k in at)
            if any(not math.isfinite(v) for k, v in enumerate(r) if not (odd and k in at)): return 'non-finite value in output'
            strays += odd
            if strays > (e['n_raw'] or 0) - (e['n'] or 0): return 'non-finite coordinates in output'
            if odd: continue
            low = [min(l, r[k]) for l, k in zip(low, at)]; high = [max(l, r[k]) for l, k in zip(high, at)]
        if '--read' in opt and n and e['bbox'] and any(abs(g - w) > e['tol'] for g, w in zip(low + high, e['bbox'][0] + e['bbox'][1])): return 'wrong coordinates'
    return None
res, tot = [], collections.Counter()
for e in man['files']:
    if not e['file'].startswith(only): continue
    d = tempfile.mkdtemp(prefix='corpus'); inp = os.path.join(d, e['file']); out = os.path.join(d, 'out.' + ext)
    shutil.copy(os.path.join(corpus, e['file']), inp)
    argv = [c.replace('{in}', inp).replace('{out}', out) for c in cmd]
    t0 = time.time(); pid = os.fork()
    if pid == 0:
        for fd, n in ((1, '.stdout'), (2, '.stderr')): os.dup2(os.open(d + '/' + n, os.O_WRONLY | os.O_CREAT, 0o600), fd)
        try: os.execvp(argv[0], argv)
        finally: os._exit(127)
    hang = False
    while True:
        p, st, ru = os.wait4(pid, os.WNOHANG)
        if p: break
        if not hang and time.time() - t0 > B['seconds']: hang = True; os.kill(pid, 9)
        time.sleep(0.003)
    rc = os.waitstatus_to_exitcode(st); err = open(d + '/.stderr', 'rb').read(); rss = ru.ru_maxrss / 1024
    left = [f for f in os.listdir(d) if f not in (e['file'], 'out.' + ext, '.stdout', '.stderr')]
    low = err.decode('utf8', 'replace').lower(); hinted = (not e['hint']) or any(h in low.replace(e['file'].lower(), '') for h in e['hint'])
    has = os.path.exists(out) and os.path.getsize(out) > 0
    prob = []
    if hang: prob.append('hang')
    elif rc < 0 or rc > 128: prob.append('signal %d' % (-rc if rc < 0 else rc - 128))
    if rss > B['rss_mib'] + B['rss_times_size'] * e['bytes'] / 2**20 and '--any-rss' not in opt: prob.append('rss %d MiB' % rss)
    if re.search(rb'[\x00-\x08\x0b-\x1f\x7f]', err): prob.append('control bytes on stderr')
    if left: prob.append('left behind: ' + left[0])
    if open(inp, 'rb').read() != open(os.path.join(corpus, e['file']), 'rb').read(): prob.append('input changed')
    ok = {e[key], *e['also_ok']}
    if not prob:
        if rc == 0:
            if not ok & {S, W}: prob.append('accepted a bad file')
            elif not has: prob.append('exit 0 without output')
            else:
                x = ply_bad(out, e) if ext == 'ply' else None
                if x: prob.append(x)
                elif S not in ok and not (low.strip() and hinted): prob.append('no (clear) warning')
        elif F not in ok: prob.append('refused a good file: ' + low.strip()[-80:])
        else:
            if os.path.exists(out): prob.append('failed but left an output')
            if not low.strip(): prob.append('failed without a word')
            elif e['file'].lower() not in low: prob.append('message does not name the file')
            elif not hinted: prob.append('message not clear: ' + low.strip()[-80:])
    shutil.rmtree(d)
    tot['pass' if not prob else prob[0].split(':')[0]] += 1
    res.append(dict(file=e['file'], expect=e[key], rc=rc, problems=prob, seconds=round(time.time() - t0, 3), rss_mib=round(rss)))
    if prob: print('%-44s %-27s %s' % (e['file'], e[key], '; '.join(prob)))
if get('--json'): json.dump(res, open(get('--json'), 'w'), indent=1)
print(len(res), dict(tot)); sys.exit(0 if res and tot['pass'] == len(res) else 1)
