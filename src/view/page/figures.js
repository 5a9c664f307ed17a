// The texts around the view: summary, figures of the report, legend.

const group = value => Math.round(value).toLocaleString('en').replace(/,/g, '\u202f');  // thin spaces

function figure(value) {
  if (value === null || value === undefined) return '–';
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (typeof value !== 'number') return String(value);
  if (Number.isInteger(value)) return Math.abs(value) < 1e9 ? group(value) : value.toExponential(3);
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(4)));
}
const percent = share => Number((100 * share).toPrecision(3)) + ' %';
const bytes = count => count >= 1e9 ? (count / 1e9).toFixed(2) + ' GB' : (count / 1e6).toFixed(0) + ' MB';
function time(seconds) {
  if (seconds < 0.1) return Number((1000 * seconds).toPrecision(2)) + ' ms';
  const whole = Math.round(seconds);
  return whole >= 100 ? Math.floor(whole / 60) + ' min ' + whole % 60 + ' s' : figure(seconds) + ' s';
}

function element(tag, text, className) {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  return node;
}

// rows: [name, text, class?]
function addTable(parent, heading, rows) {
  rows = rows.filter(row => row);
  if (!rows.length) return;
  parent.append(element('h2', heading));
  const list = element('dl');
  for (const [name, text, className] of rows) list.append(element('dt', name), element('dd', text, className));
  parent.append(list);
}

// Residuals over the iterations, logarithmic.
function addResiduals(parent, iterations) {
  const values = iterations.map(step => step.residual).filter(r => r > 0);
  if (values.length < 2) return;
  const low = Math.log10(Math.min(...values)), high = Math.log10(Math.max(...values));
  const span = Math.max(high - low, 1e-9);
  const path = values.map((r, i) => `${i ? 'L' : 'M'}${(100 * i / (values.length - 1)).toFixed(2)} ${(60 - 56 * (Math.log10(r) - low) / span).toFixed(2)}`);
  const name = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(name, 'svg');
  svg.setAttribute('viewBox', '0 0 100 62');
  svg.setAttribute('preserveAspectRatio', 'none');
  const curve = document.createElementNS(name, 'path');
  curve.setAttribute('d', path.join(''));
  svg.append(curve);
  parent.append(element('h2', 'Residual'), svg);
  const caption = element('div', undefined, 'caption');
  caption.append(element('span', values[0].toExponential(1)), element('span', `${values.length} steps`), element('span', values[values.length - 1].toExponential(1)));
  parent.append(caption);
}

function addHistogram(parent, heading, data) {
  const kBins = 20;
  const bins = new Array(kBins).fill(0);
  for (const value of data) ++bins[Math.min(kBins - 1, Math.floor(value * kBins / 256))];
  const highest = Math.max(...bins);
  parent.append(element('h2', heading));
  const bars = element('div', undefined, 'bars');
  bins.forEach((count, i) => {
    const bar = element('i');
    bar.style.height = 100 * count / highest + '%';
    bar.style.background = rampColor('confidence', (i + 0.5) / kBins);
    bar.title = `${(i / kBins).toFixed(2)} to ${((i + 1) / kBins).toFixed(2)}: ${group(count)} points`;
    bars.append(bar);
  });
  const caption = element('div', undefined, 'caption');
  caption.append(element('span', '0'), element('span', 'confidence'), element('span', '1'));
  parent.append(bars, caption);
}

function rampColor(name, value) {
  const stops = kStops[name], t = 4 * Math.min(1, Math.max(0, value)), i = Math.min(3, Math.floor(t)), f = t - i;
  return `rgb(${stops[i].map((c, k) => Math.round(c + f * (stops[i + 1][k] - c))).join(',')})`;
}

function addReport(parent, report) {
  const {input = {}, scales = {}, method = {}, mesh, seconds = {}, confidence = {}} = report;
  addTable(parent, 'Normals', [
    input.used !== undefined && ['points used', figure(input.used)],
    input.dropped_non_finite > 0 && ['not finite', figure(input.dropped_non_finite), 'bad'],
    input.merged_duplicates > 0 && ['duplicates', figure(input.merged_duplicates)],
    method.solver && confidence.mean !== undefined && ['mean confidence', figure(confidence.mean)],
    method.solver && confidence.below_half !== undefined && ['unsure of the side', percent(confidence.below_half || 0)],
    method.solver && ['solver', method.solver],
    report.converged !== undefined && ['converged', figure(report.converged), report.converged ? 'good' : 'bad'],
    scales.spacing > 0 && ['point spacing', figure(scales.spacing)],
    scales.epsilon > 0 && ['epsilon', figure(scales.epsilon)],
  ]);
  addTable(parent, 'Mesh', mesh ? [
    ['triangles', figure(mesh.faces)],
    ['closed', figure(mesh.closed), mesh.closed ? 'good' : 'bad'],
    ['manifold', figure(mesh.manifold), mesh.manifold ? 'good' : 'bad'],
    ['components', figure(mesh.components)],
    mesh.genus !== null && mesh.genus !== undefined && ['genus', figure(mesh.genus)],
    ['area', figure(mesh.area)],
    ['volume', figure(mesh.volume)],
  ] : []);
  addResiduals(parent, report.iterations || []);
  addTable(parent, 'Time and memory', [
    ...Object.entries(seconds).filter(([, s]) => s > 0).map(([stage, s]) => [stage, time(s)]),
    report.peak_memory_bytes > 0 && ['peak memory', bytes(report.peak_memory_bytes)],
    report.threads > 0 && ['threads', figure(report.threads)],
  ]);
  if ((report.warnings || []).length) {
    parent.append(element('h2', 'Warnings'));
    const list = element('ul');
    for (const line of report.warnings) list.append(element('li', line));
    parent.append(list);
  }
}

function showFigures(scene) {
  const {given, meshGiven} = scene;
  const parts = [];
  if (given.given) parts.push(`${group(given.given)} points`);
  if (meshGiven) parts.push(`${group(meshGiven.vertices)} vertices, ${group(meshGiven.given)} triangles`);
  const box = scene.high.map((h, k) => figure(h - scene.low[k])).join(' × ');
  document.getElementById('summary').textContent = `${parts.join(' · ')} · ${box}`;

  const notes = [];
  if (given.shown < given.finite) notes.push(`showing ${group(given.shown)} of ${group(given.finite)} points`);
  if (given.finite < given.given) notes.push(`${group(given.given - given.finite)} points are not finite and not shown`);
  if (meshGiven && meshGiven.shown < meshGiven.given) notes.push(`the mesh is too large for this page: ${group(meshGiven.given)} triangles not shown`);
  const thinned = document.getElementById('thinned');
  thinned.textContent = notes.join('; ');
  thinned.hidden = !notes.length;

  const panel = document.getElementById('figures');
  if (scene.truth) {
    const {compared, wrong_side: wrong, mean_error: mean} = scene.truth;
    addTable(panel, 'Against the reference', [
      ['points compared', group(compared)],
      ['on the wrong side', `${group(wrong)} (${percent(wrong / Math.max(1, compared))})`, wrong ? 'bad' : 'good'],
      ['mean error', figure(mean)],
    ]);
  }
  if (scene.report) addReport(panel, scene.report);
  if (scene.points && scene.points.confidence) addHistogram(panel, 'Confidence', scene.points.confidence);
}

function showLegend(scene, state, palette) {
  const legend = document.getElementById('legend');
  const color = c => `rgb(${c.map(v => Math.round(255 * v)).join(',')})`;
  const dot = (c, text) => {
    const item = element('span');
    const mark = element('i');
    mark.style.background = color(c);
    item.append(mark, text);
    return item;
  };
  const ramp = (name, low, high) => {
    const item = element('span');
    const bar = element('i', undefined, 'ramp');
    bar.style.background = `linear-gradient(90deg, ${[0, 1, 2, 3, 4].map(i => rampColor(name, i / 4)).join(',')})`;
    item.append(low, bar, high);
    return item;
  };
  const items = {
    before: () => [element('span', 'the points as given')],
    sides: () => [dot(palette.outside, 'outside'), dot(palette.inside, 'inside faces you')],
    confidence: () => [ramp('confidence', 'unsure of the side', 'sure')],
    error: () => [ramp('error', 'right', 'opposite')],
    colors: () => [element('span', 'colours of the points')],
    mesh: () => [dot(palette.mesh, 'outside'), dot(palette.inside, 'inside')],
    none: () => [],
  }[state.mode]();
  if (state.needles && scene.points && scene.points.normal && state.mode !== 'before' && scene.needleStep > 1) {
    items.push(element('span', `needles: 1 point in ${group(scene.needleStep)}`));
  }
  legend.replaceChildren(...items);
}
