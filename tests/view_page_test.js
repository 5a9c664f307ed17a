// Runs inside the page, in a real browser: every mode is drawn and its pixels are counted, every kind of input is exercised.
// The result is left as JSON in <pre id="selftest">.
(() => {
  const viewer = window.g3rViewer;
  const result = {modes: {}, input: {}};

  // Shares of the pixels in the middle of the view: not background, clearly blue, clearly red.
  const measure = () => {
    viewer.frame(0);
    const {gl} = viewer.renderer, {width, height} = viewer.canvas;
    const size = Math.floor(Math.min(width, height) / 2), left = (width - size) >> 1, bottom = (height - size) >> 1;
    const read = (x, y, w, h) => {
      const data = new Uint8Array(4 * w * h);
      gl.readPixels(x, y, w, h, gl.RGBA, gl.UNSIGNED_BYTE, data);
      return data;
    };
    viewer.renderer.draw(viewer.camera(), viewer.state);
    const data = read(left, bottom, size, size), edge = read(0, bottom, 1, size);
    let drawn = 0, blue = 0, red = 0;
    for (let y = 0; y < size; ++y) {
      for (let x = 0; x < size; ++x) {
        const i = 4 * (y * size + x);
        const [r, g, b] = [data[i], data[i + 1], data[i + 2]];
        if (Math.abs(r - edge[4 * y]) + Math.abs(g - edge[4 * y + 1]) + Math.abs(b - edge[4 * y + 2]) > 20) ++drawn;
        if (b > r + 60) ++blue;
        if (r > b + 60) ++red;
      }
    }
    return {drawn: drawn / size / size, blue: blue / size / size, red: red / size / size, error: gl.getError()};
  };

  for (const theme of ['light', 'dark']) {
    viewer.set({theme});
    for (const [mode] of viewer.modes) {
      viewer.set({mode});
      result.modes[`${mode} ${theme}`] = measure();
    }
  }
  viewer.set({mode: 'mesh', axis: 2, cut: 0.5, theme: 'light'});
  result.modes.section = measure();
  viewer.set({axis: -1, wireframe: true, overlay: true, needles: true});
  result.modes.everything = measure();
  viewer.set({wireframe: false, overlay: false, needles: false, mode: 'sides', compare: true, divider: 0.5});
  result.modes.compare = measure();
  viewer.set({compare: false});

  const snapshot = () => JSON.stringify([viewer.pose, viewer.state]);
  const changes = action => {
    const before = snapshot();
    action();
    return snapshot() !== before;
  };
  const key = (name, more = {}) => window.dispatchEvent(new KeyboardEvent('keydown', {key: name, cancelable: true, ...more}));
  for (const name of ['1', '2', 'b', 'b', 'n', 'n', 'w', 'w', 'p', 'p', 'x', '<', '>', 'f', 's', 't', 'r', 'u', 'u', 'd', 'd', '[', ']', '+', '-',
                      'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', ' ', ' ']) {
    result.input[`key ${name}`] = changes(() => key(name)) || Boolean(result.input[`key ${name}`]);
  }
  result.input['unknown key does nothing'] = !changes(() => key('q'));
  result.input['shortcut of the browser does nothing'] = !changes(() => key('r', {ctrlKey: true}));

  const pointer = (type, x, y, more = {}) => viewer.canvas.dispatchEvent(
      new PointerEvent(type, {clientX: x, clientY: y, pointerId: 1, buttons: 1, bubbles: true, cancelable: true, ...more}));
  const drag = more => {
    pointer('pointerdown', 300, 300, more);
    pointer('pointermove', 340, 320, more);
    pointer('pointerup', 340, 320, more);
  };
  result.input.turn = changes(() => drag({}));
  result.input.move = changes(() => drag({buttons: 2}));
  result.input['shift drag moves'] = changes(() => drag({shiftKey: true}));
  result.input['moving without a button does nothing'] = !changes(() => pointer('pointermove', 10, 10, {buttons: 0}));
  const distance = viewer.pose.distance;
  pointer('pointerdown', 300, 300, {pointerType: 'touch'});
  pointer('pointerdown', 400, 300, {pointerId: 2, pointerType: 'touch'});
  pointer('pointermove', 500, 300, {pointerId: 2, pointerType: 'touch'});
  pointer('pointerup', 500, 300, {pointerId: 2, pointerType: 'touch'});
  pointer('pointerup', 300, 300, {pointerType: 'touch'});
  result.input['spreading two fingers zooms in'] = viewer.pose.distance < distance;
  result.input.wheel = changes(() => viewer.canvas.dispatchEvent(new WheelEvent('wheel', {deltaY: 120, cancelable: true})));
  viewer.reset(0, 0);
  const {clientWidth, clientHeight} = viewer.canvas;
  result.input['double click focuses'] = changes(() => viewer.focus(0.42 * clientWidth, 0.5 * clientHeight));
  for (const id of ['compare', 'needles', 'wireframe', 'overlay', 'flip']) {
    result.input[`box ${id}`] = changes(() => document.getElementById(id).click());
  }
  for (const id of ['front', 'right', 'top', 'reset', 'up', 'theme']) result.input[`button ${id}`] = changes(() => document.getElementById(id).click());
  result.input['axis button'] = changes(() => document.querySelector('#axis button[data-axis="1"]').click());
  for (const id of ['size', 'needle-length', 'cut']) {
    result.input[`slider ${id}`] = changes(() => {
      const slider = document.getElementById(id);
      slider.value = 0.3;
      slider.dispatchEvent(new Event('input'));
    });
  }
  const grip = document.getElementById('divider-grip');
  result.input['dragging the divider'] = changes(() => {
    grip.dispatchEvent(new PointerEvent('pointerdown', {pointerId: 3}));
    grip.dispatchEvent(new PointerEvent('pointermove', {pointerId: 3, clientX: 200}));
    grip.dispatchEvent(new PointerEvent('pointerup', {pointerId: 3}));
  });
  key('h');
  result.input['help opens'] = document.getElementById('help').open;
  result.input['keys rest while help is open'] = !changes(() => key('n'));
  document.getElementById('help').close();

  result.texts = {
    title: document.title, heading: document.querySelector('h1').textContent, note: document.getElementById('thinned').textContent,
    figures: document.getElementById('figures').textContent, legend: document.getElementById('legend').textContent,
  };
  result.formats = {
    percent: [1, 0.5, 0.1, 0.999, 0.01234, 0].map(percent), time: [0.0012345, 0.05, 0.0999, 2.5, 99.4, 119.6, 3599.7, 7200].map(time),
  };
  result.requests = performance.getEntriesByType('resource').length;
  const out = document.createElement('pre');
  out.id = 'selftest';
  out.textContent = JSON.stringify(result);
  document.body.append(out);
})();
