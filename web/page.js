// The page: takes a file, has a worker make normals and mesh of it, shows what `g3r view` shows, and saves.

const kMostBytes = 2 ** 31 - 1;  // of a file: what readers of Emscripten's file system can address
const kStages = {read: 'Reading', build: 'Looking at the points', solve: 'Solving for the sides', refine: 'Refining the normals', mesh: 'Meshing',
                 draw: 'Drawing'};

const at = id => document.getElementById(id);
const state = {module: null, worker: null, name: '', mesh: true, page: null, report: ''};

function show(name, failure = '') {
  document.body.dataset.state = name;
  at('failure').textContent = failure;
  at('failure').hidden = !failure;
  at('note').textContent = '';
}

// The compiled library: packed, in base64.
async function compile() {
  const packed = Uint8Array.from(atob(at('library').textContent), c => c.charCodeAt(0));
  const bytes = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return WebAssembly.compile(await new Response(bytes).arrayBuffer());
}

function startWorker() {
  const url = URL.createObjectURL(new Blob([at('worker-code').textContent], {type: 'text/javascript'}));
  state.worker = new Worker(url);
  state.worker.onmessage = event => receive[event.data.kind](event.data);
  state.worker.onerror = event => receive.failed({message: event.message || 'the worker has stopped', broken: true});
  state.worker.postMessage({kind: 'start', module: state.module});
  URL.revokeObjectURL(url);
}

function endWorker() {
  state.worker.terminate();
  startWorker();
}

const receive = {
  ready() {
    if (document.body.dataset.state === 'loading') show('start');
  },
  progress({stage, fraction}) {
    at('step').textContent = kStages[stage] || stage;
    at('progress').value = fraction;
  },
  done({page, report}) {
    state.page = new TextDecoder().decode(page);
    state.report = report;
    at('view').srcdoc = state.page;
    at('mesh-tools').hidden = !state.mesh;
    show('result');
  },
  saved({name, bytes, warnings}) {
    at('note').textContent = warnings;
    download(name, bytes, 'application/octet-stream');
  },
  failed({message, broken}) {
    if (broken) endWorker();
    // A file that could not be written leaves the result as it is, unless the worker that holds it is gone.
    if (document.body.dataset.state === 'result' && !broken) at('note').textContent = message;
    else show('start', message);
  },
};

function download(name, bytes, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([bytes], {type}));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);  // the browser may not have begun yet
}

function solve(name, bytes) {
  Object.assign(state, {name, mesh: at('mesh').checked});
  at('busy-name').textContent = name;
  receive.progress({stage: 'read', fraction: 0});
  show('busy');
  state.worker.postMessage({kind: 'run', name, bytes, mesh: state.mesh, trim: at('trim').checked, zUp: at('z-up').checked}, [bytes]);
}

async function take(files) {
  if (document.body.dataset.state === 'loading' || document.body.dataset.state === 'busy') return;
  const [file] = files;
  if (files.length !== 1) return show('start', 'one file at a time, please');
  if (file.size > kMostBytes) return show('start', `${file.name}: more than 2 GiB; a page cannot hold it. The g3r program can.`);
  try {
    solve(file.name, await file.arrayBuffer());
  } catch (error) {
    show('start', `${file.name}: cannot be read (${error.message}); folders cannot be dropped`);
  }
}

// A tube along a trefoil knot, as text.
function sample() {
  const curve = t => [Math.sin(t) + 2 * Math.sin(2 * t), Math.cos(t) - 2 * Math.cos(2 * t), -Math.sin(3 * t)];
  const slope = t => [Math.cos(t) + 4 * Math.cos(2 * t), -Math.sin(t) + 4 * Math.sin(2 * t), -3 * Math.cos(3 * t)];
  const unit = v => v.map(x => x / Math.hypot(...v));
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const kPoints = 20000, kGolden = 0.6180339887498949, kRadius = 0.5;
  let text = '';
  for (let i = 0; i < kPoints; ++i) {
    const t = 2 * Math.PI * i / kPoints, angle = 2 * Math.PI * (i * kGolden % 1);
    const u = unit(cross(slope(t), [0, 0, 1])), v = cross(u, unit(slope(t)));
    text += curve(t).map((c, k) => (c + kRadius * (Math.cos(angle) * u[k] + Math.sin(angle) * v[k])).toFixed(6)).join(' ') + '\n';
  }
  return new TextEncoder().encode(text).buffer;
}

// Of the cloud's name, without its extension.
const stem = () => state.name.replace(/\.[^.]*$/, '') || 'cloud';
function save(mesh) {
  at('note').textContent = '';
  const name = stem() + (mesh ? '_mesh.' : '_normals.') + at(mesh ? 'mesh-format' : 'cloud-format').value;
  state.worker.postMessage({kind: 'save', name, mesh});
}

at('file').addEventListener('change', event => {
  take([...event.target.files]);
  event.target.value = '';
});
at('sample').addEventListener('click', () => { if (document.body.dataset.state === 'start') solve('trefoil.xyz', sample()); });
at('cancel').addEventListener('click', () => { endWorker(); show('start'); });
at('again').addEventListener('click', () => { at('view').srcdoc = ''; show('start'); });
at('save-cloud').addEventListener('click', () => save(false));
at('save-mesh').addEventListener('click', () => save(true));
at('save-page').addEventListener('click', () => download(stem() + '.html', state.page, 'text/html'));
at('save-report').addEventListener('click', () => download(stem() + '.json', state.report, 'application/json'));
for (const type of ['dragenter', 'dragover']) {
  addEventListener(type, event => { event.preventDefault(); document.body.classList.add('over'); });
}
addEventListener('dragleave', () => document.body.classList.remove('over'));
addEventListener('drop', event => {
  event.preventDefault();
  document.body.classList.remove('over');
  if (event.dataTransfer.files.length) take([...event.dataTransfer.files]);
});

compile().then(module => { state.module = module; startWorker(); }).catch(error => {
  show('loading', `This browser cannot run the page (${error.message}). It needs WebAssembly with vectors and exceptions: ` +
                  'Chrome or Edge 95, Firefox 113, Safari 16.4, or later.');
});
