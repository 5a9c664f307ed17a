// State, camera, input.

function matrixProduct(a, b) {  // column-major
  const out = new Float32Array(16);
  for (let c = 0; c < 4; ++c) {
    for (let r = 0; r < 4; ++r) {
      for (let k = 0; k < 4; ++k) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    }
  }
  return out;
}

class Viewer {
  constructor() {
    this.scene = loadScene();
    this.canvas = document.getElementById('view');
    this.renderer = new Renderer(this.canvas, this.scene);
    this.scene.needleStep = this.renderer.needles ? this.renderer.needles.step : 0;
    const {points, mesh} = this.scene;
    this.modes = [
      points && ['before', 'Before'], points && points.normal && ['sides', 'Outside / inside'],
      points && points.confidence && ['confidence', 'Confidence'], points && points.error && ['error', 'Error'],
      points && points.color && ['colors', 'Colours'], mesh && ['mesh', 'Mesh'],
    ].filter(Boolean);
    const dark = window.matchMedia && matchMedia('(prefers-color-scheme: dark)').matches;
    const [mode] = this.modes[mesh ? this.modes.length - 1 : Math.min(1, this.modes.length - 1)] || ['none'];  // none: a mesh too large, alone
    this.state = {mode, meshMode: mesh && mesh.color ? 'colors' : 'plain',
                  compare: false, divider: 0.5, needles: false, wireframe: false, overlay: false, spin: false, size: 1, needleLength: 1,
                  axis: -1, cut: 0.5, flip: false, theme: dark ? 'dark' : 'light', up: this.scene.up};
    this.pose = {};
    this.reset();
    showFigures(this.scene);
    this.bindControls();
    this.bindPointers();
    this.bindKeys();
    this.canvas.addEventListener('webglcontextlost', event => event.preventDefault());
    this.canvas.addEventListener('webglcontextrestored', () => { this.renderer.buildAll(); this.changed(); });
    new ResizeObserver(() => this.changed()).observe(document.body);
    this.changed();
  }

  // --- camera: turntable about a target -------------------------------------------------------------------------------------------
  reset(azimuth = 0.6, elevation = 0.35) {
    const aspect = Math.min(1, innerWidth / innerHeight);
    Object.assign(this.pose, {azimuth, elevation, target: [...this.scene.centre], distance: 1.08 * this.scene.radius / Math.sin(0.3) / aspect});
    this.changed();
  }

  // Rows right, up, back in scene coordinates.
  axes() {
    const {azimuth: a, elevation: e} = this.pose;
    const rows = [[Math.cos(a), 0, -Math.sin(a)], [-Math.sin(a) * Math.sin(e), Math.cos(e), -Math.cos(a) * Math.sin(e)],
                  [Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e)]];
    return this.state.up === 'y' ? rows : rows.map(([x, y, z]) => [x, -z, y]);
  }

  camera() {
    const [right, up, back] = this.axes();
    const {target, distance} = this.pose;
    const rows = [right, up, back];
    const view = new Float32Array(16);
    rows.forEach((row, r) => {
      for (let k = 0; k < 3; ++k) view[4 * k + r] = row[k];
      view[12 + r] = -(row[0] * target[0] + row[1] * target[1] + row[2] * target[2]);
    });
    view[14] -= distance;
    view[15] = 1;
    const reach = this.scene.radius + Math.hypot(...target.map((t, k) => t - this.scene.centre[k]));
    const far = distance + 1.2 * reach, near = Math.max(distance - 1.2 * reach, 0.002 * this.scene.radius, far / 5000);
    const f = 1 / Math.tan(0.3), aspect = this.canvas.width / Math.max(1, this.canvas.height);
    const projection = new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]);
    return {view, projection, distance};
  }

  turn(dx, dy) {
    this.pose.azimuth -= dx;
    this.pose.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pose.elevation + dy));
    this.changed();
  }

  move(dx, dy) {  // in pixels
    const [right, up] = this.axes();
    const scale = 2 * Math.tan(0.3) * this.pose.distance / this.canvas.clientHeight;
    this.pose.target = this.pose.target.map((t, k) => t - scale * (dx * right[k] - dy * up[k]));
    this.changed();
  }

  zoom(factor) {
    this.pose.distance = Math.max(0.01, Math.min(40, this.pose.distance / this.scene.radius * factor)) * this.scene.radius;
    this.changed();
  }

  // Makes the point nearest to the viewer within a few pixels of (x, y) the target.
  focus(x, y) {
    const source = this.scene.points && !(this.state.mode === 'mesh' && this.scene.mesh) ? this.scene.points : this.scene.mesh;
    if (!source) return;
    const camera = this.camera();
    const m = matrixProduct(camera.projection, camera.view);
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const plane = sectionPlane(this.state, this.scene);
    let best = null, bestScore = Infinity;
    for (let i = 0; i < source.position.length; i += 3) {
      const px = source.position[i] / 65535, py = source.position[i + 1] / 65535, pz = source.position[i + 2] / 65535;
      if (plane[0] * px + plane[1] * py + plane[2] * pz > plane[3]) continue;
      const w = m[3] * px + m[7] * py + m[11] * pz + m[15];
      if (w <= 0) continue;
      const sx = (0.5 + 0.5 * (m[0] * px + m[4] * py + m[8] * pz + m[12]) / w) * width;
      const sy = (0.5 - 0.5 * (m[1] * px + m[5] * py + m[9] * pz + m[13]) / w) * height;
      const off = Math.hypot(sx - x, sy - y);
      if (off > 12) continue;
      const score = w + off / 12 * 0.02 * this.scene.radius;
      if (score < bestScore) [bestScore, best] = [score, [px, py, pz]];
    }
    if (best) this.pose.target = best;
    this.changed();
  }

  // --- drawing ----------------------------------------------------------------------------------------------------------------------
  changed() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(time => this.frame(time));
  }

  frame(time) {
    this.pending = false;
    const ratio = Math.min(2, devicePixelRatio || 1);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio)), height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, {width, height});
    if (this.state.spin) {
      this.pose.azimuth += Math.min(0.1, (time - (this.last || time)) / 1000) * 0.6;
      this.changed();
    }
    this.last = time;
    this.renderer.draw(this.camera(), this.state);
    this.drawGizmo();
  }

  drawGizmo() {
    const rows = this.axes();
    const tips = ['x', 'y', 'z'].map((name, k) => ({name, x: rows[0][k], y: -rows[1][k], z: rows[2][k], color: ['#d9483b', '#3a9d4c', '#3d74d6'][k]}));
    tips.sort((a, b) => a.z - b.z);
    document.getElementById('gizmo').innerHTML = tips.map(t => `<line x2="${t.x.toFixed(3)}" y2="${t.y.toFixed(3)}" stroke="${t.color}" stroke-width=".07" stroke-linecap="round"/>` +
      `<text x="${(1.18 * t.x).toFixed(3)}" y="${(1.18 * t.y + 0.11).toFixed(3)}" text-anchor="middle" fill="${t.color}">${t.name}</text>`).join('');
  }

  // --- state ------------------------------------------------------------------------------------------------------------------------
  set(change) {
    Object.assign(this.state, change);
    this.refresh();
    this.changed();
  }

  // Brings buttons, legend and theme into line with the state.
  refresh() {
    const {state, scene} = this;
    document.documentElement.dataset.theme = state.theme;
    for (const button of document.querySelectorAll('#modes button')) button.setAttribute('aria-pressed', String(button.dataset.mode === state.mode));
    for (const button of document.querySelectorAll('#axis button')) button.setAttribute('aria-pressed', String(Number(button.dataset.axis) === state.axis));
    for (const name of ['compare', 'needles', 'wireframe', 'overlay', 'spin', 'flip']) document.getElementById(name).checked = state[name];
    document.getElementById('size').value = state.size;
    document.getElementById('needle-length').value = state.needleLength;
    document.getElementById('cut').value = state.cut;
    document.getElementById('up').textContent = 'Up: ' + state.up;
    const enable = (id, on) => document.getElementById(id).closest('label').classList.toggle('disabled', !on);
    enable('compare', scene.points && this.modes.length > 1);
    enable('needles', scene.points && scene.points.normal);
    enable('needle-length', state.needles);
    enable('wireframe', scene.mesh);
    enable('overlay', scene.points && scene.mesh);
    enable('cut', state.axis >= 0);
    enable('flip', state.axis >= 0);
    const divider = document.getElementById('divider');
    divider.hidden = !state.compare;
    divider.style.left = 100 * state.divider + '%';
    document.getElementById('divider-right').textContent = (this.modes.find(m => m[0] === state.mode) || ['', ''])[1].toLowerCase();
    showLegend(scene, state, kPalette[state.theme]);
  }

  bindControls() {
    const nav = document.getElementById('modes');
    this.modes.forEach(([mode, label], i) => {
      const button = element('button', label);
      button.dataset.mode = mode;
      button.append(element('kbd', String(i + 1)));
      button.addEventListener('click', () => this.set({mode}));
      nav.append(button);
    });
    const on = (id, type, action) => document.getElementById(id).addEventListener(type, action);
    for (const name of ['compare', 'needles', 'wireframe', 'overlay', 'spin', 'flip']) on(name, 'change', e => this.set({[name]: e.target.checked}));
    for (const [id, name] of [['size', 'size'], ['needle-length', 'needleLength'], ['cut', 'cut']]) on(id, 'input', e => this.set({[name]: Number(e.target.value)}));
    for (const button of document.querySelectorAll('#axis button')) button.addEventListener('click', () => this.cutAlong(Number(button.dataset.axis)));
    on('front', 'click', () => this.reset(0, 0));
    on('right', 'click', () => this.reset(Math.PI / 2, 0));
    on('top', 'click', () => this.reset(0, Math.PI / 2));
    on('reset', 'click', () => this.reset());
    on('up', 'click', () => this.press('u'));
    on('theme', 'click', () => this.press('d'));
    on('help-button', 'click', () => document.getElementById('help').showModal());
    on('save', 'click', () => this.save());
    on('panel-toggle', 'click', () => this.togglePanel());
    if (innerWidth < 760) this.togglePanel();
    this.refresh();
  }

  // Chooses the axis of the section (-1: none) and keeps the half that leaves the cut in sight.
  cutAlong(axis) {
    this.set({axis, flip: axis >= 0 && this.axes()[2][axis] < 0});
  }

  togglePanel() {
    const closed = document.getElementById('panel').classList.toggle('closed');
    document.getElementById('panel-toggle').setAttribute('aria-expanded', String(!closed));
    document.body.classList.toggle('show-figures', !closed && innerWidth < 760);
  }

  save() {
    this.renderer.draw(this.camera(), this.state);  // the buffer is valid only until the browser shows it
    const link = element('a');
    link.href = this.canvas.toDataURL('image/png');
    link.download = (this.scene.title.replace(/[^\w.-]+/g, '_') || 'g3r') + '.png';
    link.click();
  }

  // --- pointers ---------------------------------------------------------------------------------------------------------------------
  bindPointers() {
    const down = new Map();
    const canvas = this.canvas;
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('pointerdown', event => {
      down.set(event.pointerId, [event.clientX, event.clientY]);
      try { canvas.setPointerCapture(event.pointerId); } catch { /* a made-up pointer */ }
      canvas.classList.add('moving');
      canvas.focus({preventScroll: true});
    });
    canvas.addEventListener('pointermove', event => {
      const last = down.get(event.pointerId);
      if (!last) return;
      const others = [...down.entries()].filter(([id]) => id !== event.pointerId).map(entry => entry[1]);
      const dx = event.clientX - last[0], dy = event.clientY - last[1];
      if (others.length) {  // two fingers: move by half of each finger's way, zoom by the change of their distance
        const [ox, oy] = others[0];
        const before = Math.hypot(last[0] - ox, last[1] - oy), after = Math.hypot(event.clientX - ox, event.clientY - oy);
        if (before > 0 && after > 0) this.zoom(before / after);
        this.move(dx / 2, dy / 2);
      } else if (event.buttons & 6 || event.shiftKey || event.ctrlKey) {
        this.move(dx, dy);
      } else {
        this.turn(0.006 * dx, 0.006 * dy);
      }
      down.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const type of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(type, event => {
        down.delete(event.pointerId);
        if (!down.size) canvas.classList.remove('moving');
      });
    }
    canvas.addEventListener('wheel', event => {
      event.preventDefault();
      this.zoom(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY * (event.deltaMode ? 0.05 : 0.0012)))));
    }, {passive: false});
    canvas.addEventListener('dblclick', event => this.focus(event.clientX, event.clientY));

    const grip = document.getElementById('divider-grip');
    grip.addEventListener('pointerdown', event => { try { grip.setPointerCapture(event.pointerId); } catch { /* a made-up pointer */ } grip.held = true; });
    grip.addEventListener('pointermove', event => { if (grip.held) this.set({divider: Math.max(0.02, Math.min(0.98, event.clientX / innerWidth))}); });
    for (const type of ['pointerup', 'pointercancel']) grip.addEventListener(type, () => { grip.held = false; });
  }

  // --- keys -------------------------------------------------------------------------------------------------------------------------
  bindKeys() {
    window.addEventListener('keydown', event => {
      if (event.ctrlKey || event.metaKey || event.altKey || document.getElementById('help').open) return;
      const {target, key} = event;
      // What a focused control does with these keys comes first.
      const own = target instanceof HTMLInputElement || target instanceof HTMLButtonElement;
      if (own && (key === ' ' || key === 'Enter' || (target.type === 'range' && key.startsWith('Arrow')))) return;
      if (this.press(key, event.shiftKey)) event.preventDefault();
    });
  }

  // What a key does; false if nothing.
  press(key, shift = false) {
    const {state, scene} = this;
    const index = Number(key) - 1;
    if (index >= 0 && index < this.modes.length) { this.set({mode: this.modes[index][0]}); return true; }
    const step = (dx, dy) => shift ? this.move(40 * dx, 40 * dy) : this.turn(0.12 * dx, 0.12 * dy);
    const toggle = (name, allowed = true) => allowed && this.set({[name]: !state[name]});
    const actions = {
      b: () => toggle('compare', scene.points && this.modes.length > 1),
      n: () => toggle('needles', scene.points && scene.points.normal),
      w: () => toggle('wireframe', scene.mesh),
      p: () => toggle('overlay', scene.points && scene.mesh),
      ' ': () => toggle('spin'),
      x: () => this.cutAlong((state.axis + 2) % 4 - 1),
      '<': () => this.set({cut: Math.max(0, state.cut - 0.02)}), ',': () => this.press('<'),
      '>': () => this.set({cut: Math.min(1, state.cut + 0.02)}), '.': () => this.press('>'),
      f: () => this.reset(0, 0), s: () => this.reset(Math.PI / 2, 0), t: () => this.reset(0, Math.PI / 2), r: () => this.reset(),
      c: () => this.togglePanel(),
      u: () => this.set({up: state.up === 'y' ? 'z' : 'y'}),
      d: () => this.set({theme: state.theme === 'dark' ? 'light' : 'dark'}),
      '[': () => this.set({size: Math.max(0.2, state.size / 1.15)}), ']': () => this.set({size: Math.min(3, state.size * 1.15)}),
      '+': () => this.zoom(1 / 1.15), '=': () => this.zoom(1 / 1.15), '-': () => this.zoom(1.15),
      ArrowLeft: () => step(-1, 0), ArrowRight: () => step(1, 0), ArrowUp: () => step(0, -1), ArrowDown: () => step(0, 1),
      h: () => document.getElementById('help').showModal(), '?': () => document.getElementById('help').showModal(),
    };
    const action = actions[key] || actions[key.toLowerCase()];
    if (!action) return false;
    action();
    return true;
  }
}

try {
  window.g3rViewer = new Viewer();
} catch (error) {
  const failure = document.getElementById('failure');
  failure.textContent = error.message;
  failure.hidden = false;
  throw error;
}
