// The scene as typed arrays. Positions are in [0, 1] of the longest side of the box, measured from its low corner.

function decode64(text, Type) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return new Type(bytes.buffer);
}

// Smooth normals of a mesh as three int8 and a pad byte per vertex, weighted by area.
function vertexNormals(position, triangle) {
  const sum = new Float32Array(position.length);
  for (let t = 0; t < triangle.length; t += 3) {
    const a = 3 * triangle[t], b = 3 * triangle[t + 1], c = 3 * triangle[t + 2];
    const ux = position[b] - position[a], uy = position[b + 1] - position[a + 1], uz = position[b + 2] - position[a + 2];
    const vx = position[c] - position[a], vy = position[c + 1] - position[a + 1], vz = position[c + 2] - position[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      sum[v] += nx;
      sum[v + 1] += ny;
      sum[v + 2] += nz;
    }
  }
  const packed = new Int8Array(position.length / 3 * 4);
  for (let v = 0; v < position.length / 3; ++v) {
    const x = sum[3 * v], y = sum[3 * v + 1], z = sum[3 * v + 2];
    const length = Math.hypot(x, y, z) || 1;
    packed[4 * v] = Math.round(127 * x / length);
    packed[4 * v + 1] = Math.round(127 * y / length);
    packed[4 * v + 2] = Math.round(127 * z / length);
  }
  return packed;
}

function loadScene() {
  const element = document.getElementById('scene-data');
  const json = JSON.parse(element.textContent);
  element.textContent = '';  // the text is several times the size of the arrays
  const scene = {title: json.title, version: json.version, up: json.up, low: json.low, high: json.high, side: json.side,
                 truth: json.truth, report: json.report, points: null, mesh: null, given: json.points, meshGiven: json.mesh};
  const side = json.side || 1;
  scene.extent = json.high.map((h, k) => (h - json.low[k]) / side);
  scene.centre = scene.extent.map(e => e / 2);
  scene.radius = Math.max(Math.hypot(...scene.extent) / 2, 1e-3);
  if (json.points.shown > 0) {
    scene.points = {count: json.points.shown, position: decode64(json.points.position, Uint16Array)};
    for (const name of ['confidence', 'color', 'error']) {
      if (json.points[name]) scene.points[name] = decode64(json.points[name], Uint8Array);
    }
    if (json.points.normal) scene.points.normal = decode64(json.points.normal, Int8Array);
    scene.spacing = json.points.spacing / side || 0.02 * scene.radius;
    for (const name of ['position', 'normal', 'confidence', 'color', 'error']) delete json.points[name];
  }
  if (json.mesh && json.mesh.shown > 0) {
    const position = decode64(json.mesh.position, Uint16Array);
    const triangle = decode64(json.mesh.triangle, Uint32Array);
    scene.mesh = {vertices: position.length / 3, position, triangle, normal: vertexNormals(position, triangle)};
    for (const name of ['color', 'confidence']) {
      if (json.mesh[name]) scene.mesh[name] = decode64(json.mesh[name], Uint8Array);
    }
    for (const name of ['position', 'triangle', 'color', 'confidence']) delete json.mesh[name];
  }
  return scene;
}
