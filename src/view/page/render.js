// WebGL 2: one program per primitive, drawn on demand.

const kPalette = {
  light: {outside: [0.29, 0.52, 0.87], inside: [0.89, 0.26, 0.21], unknown: [0.85, 0.66, 0.15], near: [0.40, 0.43, 0.48], far: [0.80, 0.83, 0.87],
          mesh: [0.70, 0.77, 0.87], wire: [0.13, 0.18, 0.27], needle: [0.16, 0.33, 0.62], top: [1, 1, 1], bottom: [0.88, 0.90, 0.93]},
  dark: {outside: [0.34, 0.58, 0.95], inside: [0.96, 0.33, 0.27], unknown: [0.92, 0.75, 0.27], near: [0.80, 0.83, 0.88], far: [0.30, 0.33, 0.38],
         mesh: [0.64, 0.71, 0.82], wire: [0.05, 0.07, 0.10], needle: [0.62, 0.80, 1.0], top: [0.15, 0.17, 0.20], bottom: [0.07, 0.08, 0.10]},
};
const kStops = {  // sRGB: viridis, and grey over yellow to dark red
  confidence: [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]],
  error: [[201, 206, 214], [242, 193, 78], [238, 132, 52], [209, 56, 47], [125, 15, 31]],
};

const kCommon = `#version 300 es
precision highp float;
uniform mat4 u_view, u_projection;
uniform vec4 u_section;   // a.p <= d is kept; a = 0: everything
uniform vec3 u_stops[5];
vec3 ramp(float value) {
  float t = 4.0 * clamp(value, 0.0, 1.0);
  int i = min(3, int(t));
  return mix(u_stops[i], u_stops[i + 1], t - float(i));
}
bool cutAway(vec3 p) { return dot(u_section.xyz, p) > u_section.w; }
vec3 octahedral(vec2 e) {   // (-1, -1) stands for no normal
  if (e.x <= -1.0 && e.y <= -1.0) return vec3(0.0);
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return normalize(n);
}
float light(vec3 n) {
  float key = max(0.0, dot(n, normalize(vec3(-0.45, 0.65, 0.75))));
  float fill = max(0.0, dot(n, normalize(vec3(0.8, 0.1, 0.45))));
  return 0.42 + 0.10 * n.y + 0.52 * key + 0.16 * fill;
}
`;

const kShaders = {
  point: [kCommon + `
    uniform float u_size, u_pixels, u_depth_low, u_depth_high, u_behind;
    uniform int u_mode;   // 0 before, 1 sides, 2 ramp of a_value, 3 a_color
    uniform vec3 u_outside, u_inside, u_unknown, u_near, u_far;
    layout(location = 0) in vec3 a_position;
    layout(location = 1) in vec2 a_normal;
    layout(location = 2) in float a_value;
    layout(location = 3) in vec3 a_color;
    flat out vec3 v_color;
    flat out vec3 v_normal;
    void main() {
      vec4 p = u_view * vec4(a_position, 1.0);
      vec4 back = vec4(p.xyz + u_behind * normalize(p.xyz), 1.0);
      gl_Position = cutAway(a_position) ? vec4(2.0, 2.0, 2.0, 1.0) : u_projection * back;
      gl_PointSize = clamp(2.0 * u_size * u_pixels / max(1e-6, -p.z), 1.5, 256.0);
      vec3 n = u_mode == 0 ? vec3(0.0) : mat3(u_view) * octahedral(a_normal);
      float facing = dot(n, normalize(-p.xyz));
      float depth = clamp((-p.z - u_depth_low) / (u_depth_high - u_depth_low), 0.0, 1.0);
      if (u_mode == 0) v_color = mix(u_near, u_far, depth);
      else if (u_mode == 1) v_color = n == vec3(0.0) ? u_unknown : (facing > -0.2 ? u_outside : u_inside);
      else if (u_mode == 2) v_color = ramp(a_value);
      else v_color = a_color;
      v_normal = facing < 0.0 ? -n : n;
      if (n != vec3(0.0)) v_color *= light(v_normal);
    }`, kCommon + `
    flat in vec3 v_color;
    flat in vec3 v_normal;
    out vec4 color;
    void main() {
      vec2 d = 2.0 * gl_PointCoord - 1.0;
      d.y = -d.y;
      float dz = v_normal == vec3(0.0) ? 0.0 : dot(v_normal.xy, d) / max(v_normal.z, 0.25);
      float r = sqrt(dot(d, d) + dz * dz);
      float edge = max(fwidth(r), 1e-4);
      float alpha = clamp((1.0 - r) / edge + 0.5, 0.0, 1.0);
      if (alpha <= 0.0) discard;
      color = vec4(v_color, alpha);
    }`],
  mesh: [kCommon + `
    layout(location = 0) in vec3 a_position;
    layout(location = 1) in vec3 a_normal;
    layout(location = 2) in float a_value;
    layout(location = 3) in vec3 a_color;
    out vec3 v_position, v_eye, v_normal, v_color;
    out float v_value;
    void main() {
      vec4 p = u_view * vec4(a_position, 1.0);
      gl_Position = u_projection * p;
      v_position = a_position;
      v_eye = p.xyz;
      v_normal = mat3(u_view) * a_normal;
      v_value = a_value;
      v_color = a_color;
    }`, kCommon + `
    uniform int u_mode;   // 0 plain, 1 lines, 2 ramp of the value, 3 color
    uniform vec3 u_plain, u_inside;
    in vec3 v_position, v_eye, v_normal, v_color;
    in float v_value;
    out vec4 color;
    void main() {
      if (cutAway(v_position)) discard;
      if (u_mode == 1) { color = vec4(u_plain, 0.4); return; }
      vec3 flat_normal = normalize(cross(dFdx(v_eye), dFdy(v_eye)));   // towards the viewer
      vec3 n = gl_FrontFacing ? v_normal : -v_normal;
      n = dot(n, n) > 0.0 ? normalize(n) : flat_normal;
      if (dot(n, flat_normal) < 0.8) n = flat_normal;   // creases stay sharp
      // At the silhouette rounding alone lets the far side through: seen from the edge, the inside is not told.
      bool inside = !gl_FrontFacing && dot(flat_normal, normalize(-v_eye)) > 0.15;
      vec3 base = inside ? u_inside : u_mode == 2 ? ramp(v_value) : u_mode == 3 ? v_color : u_plain;
      vec3 half_way = normalize(normalize(vec3(-0.45, 0.65, 0.75)) + vec3(0.0, 0.0, 1.0));
      color = vec4(base * light(n) + 0.10 * pow(max(0.0, dot(n, half_way)), 30.0), 1.0);
    }`],
  needle: [kCommon + `
    uniform float u_length;
    uniform vec3 u_base, u_tip;
    layout(location = 0) in vec3 a_position;
    layout(location = 1) in vec2 a_normal;
    out vec3 v_color;
    void main() {
      vec3 n = octahedral(a_normal);
      float tip = float(gl_VertexID & 1);
      gl_Position = cutAway(a_position) ? vec4(2.0, 2.0, 2.0, 1.0) : u_projection * u_view * vec4(a_position + tip * u_length * n, 1.0);
      v_color = mix(u_base, u_tip, tip);
    }`, kCommon + `
    in vec3 v_color;
    out vec4 color;
    void main() { color = vec4(v_color, 1.0); }`],
  backdrop: [kCommon + `
    out float v_height;
    void main() {
      vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
      v_height = 0.5 * p.y + 0.5;
      gl_Position = vec4(p, 0.9999, 1.0);
    }`, kCommon + `
    uniform vec3 u_top, u_bottom;
    in float v_height;
    out vec4 color;
    void main() { color = vec4(mix(u_bottom, u_top, clamp(v_height, 0.0, 1.0)), 1.0); }`],
};

class Renderer {
  constructor(canvas, scene) {
    this.canvas = canvas;
    this.scene = scene;
    this.gl = canvas.getContext('webgl2', {antialias: true, alpha: false, preserveDrawingBuffer: false});
    if (!this.gl) throw new Error('This page needs WebGL 2, and this browser does not offer it.');
    this.buildAll();
  }

  // Also called when a lost context comes back.
  buildAll() {
    this.programs = {};
    for (const name of Object.keys(kShaders)) this.programs[name] = this.program(...kShaders[name]);
    this.buildPoints();
    this.buildMesh();
    this.empty = this.gl.createVertexArray();
  }

  program(vertex, fragment) {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
    const at = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const name = gl.getActiveUniform(program, i).name.replace('[0]', '');
      at[name] = gl.getUniformLocation(program, name);
    }
    return {program, at};
  }

  // Binds `data` to an attribute; integers are read as fractions of their range.
  attribute(index, data, size, stride, divisor = 0) {
    const gl = this.gl;
    const type = {Uint16Array: gl.UNSIGNED_SHORT, Uint8Array: gl.UNSIGNED_BYTE, Int8Array: gl.BYTE}[data.constructor.name];
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, size, type, true, stride, 0);
    gl.vertexAttribDivisor(index, divisor);
  }

  buildPoints() {
    const {gl, scene: {points}} = this;
    if (!points) return;
    this.pointArrays = {};
    for (const value of ['confidence', 'error']) {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      this.attribute(0, points.position, 3, 6);
      if (points.normal) this.attribute(1, points.normal, 2, 2);
      if (points[value]) this.attribute(2, points[value], 1, 1);
      if (points.color) this.attribute(3, points.color, 3, 3);
      this.pointArrays[value] = array;
      if (!points.error) { this.pointArrays.error = array; break; }
    }
    if (!points.normal) return;
    const kMost = 40000;  // more needles hide each other
    const step = Math.ceil(points.count / kMost), count = Math.floor(points.count / step);
    const position = new Uint16Array(3 * count), normal = new Int8Array(2 * count);
    for (let i = 0; i < count; ++i) {
      position.set(points.position.subarray(3 * i * step, 3 * i * step + 3), 3 * i);
      normal.set(points.normal.subarray(2 * i * step, 2 * i * step + 2), 2 * i);
    }
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute(0, position, 3, 6, 1);
    this.attribute(1, normal, 2, 2, 1);
    this.needles = {array, count, step};
  }

  buildMesh() {
    const {gl, scene: {mesh}} = this;
    if (!mesh) return;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute(0, mesh.position, 3, 6);
    this.attribute(1, mesh.normal, 3, 4);
    if (mesh.confidence) this.attribute(2, mesh.confidence, 1, 1);
    if (mesh.color) this.attribute(3, mesh.color, 3, 3);
    this.triangles = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.triangle, gl.STATIC_DRAW);
    this.meshArray = array;
    this.lines = null;
  }

  lineIndices() {
    const {gl, scene: {mesh}} = this;
    const count = mesh.triangle.length;
    const index = new Uint32Array(2 * count);
    for (let i = 0; i < count; ++i) {
      index[2 * i] = mesh.triangle[i];
      index[2 * i + 1] = mesh.triangle[i % 3 === 2 ? i - 2 : i + 1];
    }
    this.lines = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.lines);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
  }

  use(name, camera, state, ramp) {
    const gl = this.gl;
    const {program, at} = this.programs[name];
    gl.useProgram(program);
    if (at.u_view) gl.uniformMatrix4fv(at.u_view, false, camera.view);
    if (at.u_projection) gl.uniformMatrix4fv(at.u_projection, false, camera.projection);
    if (at.u_section) gl.uniform4fv(at.u_section, sectionPlane(state, this.scene));
    if (at.u_stops) gl.uniform3fv(at.u_stops, (kStops[ramp] || kStops.confidence).flat().map(c => c / 255));
    return at;
  }

  drawPoints(camera, state, palette, mode) {
    const {gl, scene} = this;
    const codes = {before: 0, sides: 1, confidence: 2, error: 2, colors: 3};
    const at = this.use('point', camera, state, mode);
    const surface = mode !== 'before' && scene.points.normal;
    gl.uniform1i(at.u_mode, codes[mode]);
    gl.uniform1f(at.u_pixels, camera.projection[5] * this.canvas.height / 2);
    gl.uniform1f(at.u_depth_low, camera.distance - scene.radius);
    gl.uniform1f(at.u_depth_high, camera.distance + scene.radius);
    for (const name of ['outside', 'inside', 'unknown', 'near', 'far']) gl.uniform3fv(at['u_' + name], palette[name]);
    gl.bindVertexArray(this.pointArrays[mode === 'error' ? 'error' : 'confidence']);
    gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    const draw = (size, behind) => {
      gl.uniform1f(at.u_size, size * scene.spacing * state.size);
      gl.uniform1f(at.u_behind, behind * scene.spacing);
      gl.drawArrays(gl.POINTS, 0, scene.points.count);
    };
    draw(surface ? 0.85 : 0.42, 0);
    // Random points leave holes through which the far side would be seen, from its inside: behind every disc lies a larger one.
    if (surface && state.size >= 0.7) draw(1.9, 1.5);
    gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  }

  drawNeedles(camera, state, palette) {
    const gl = this.gl;
    const at = this.use('needle', camera, state);
    gl.uniform1f(at.u_length, Math.max(2.5 * this.scene.spacing, 0.015 * this.scene.radius) * state.needleLength);
    gl.uniform3fv(at.u_base, palette.wire);
    gl.uniform3fv(at.u_tip, palette.needle);
    gl.bindVertexArray(this.needles.array);
    gl.drawArraysInstanced(gl.LINES, 0, 2, this.needles.count);
  }

  drawMesh(camera, state, palette, mode) {
    const {gl, scene: {mesh}} = this;
    const at = this.use('mesh', camera, state, 'confidence');
    gl.bindVertexArray(this.meshArray);
    gl.uniform1i(at.u_mode, mode === 'confidence' && mesh.confidence ? 2 : mode === 'colors' && mesh.color ? 3 : 0);
    gl.uniform3fv(at.u_plain, palette.mesh);
    gl.uniform3fv(at.u_inside, palette.inside);
    if (state.wireframe) gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.drawElements(gl.TRIANGLES, mesh.triangle.length, gl.UNSIGNED_INT, 0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (!state.wireframe) return;
    if (!this.lines) this.lineIndices();
    gl.uniform1i(at.u_mode, 1);
    gl.uniform3fv(at.u_plain, palette.wire);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.lines);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthFunc(gl.LEQUAL);
    gl.drawElements(gl.LINES, 2 * mesh.triangle.length, gl.UNSIGNED_INT, 0);
    gl.depthFunc(gl.LESS);
    gl.disable(gl.BLEND);
  }

  // Draws the part of the canvas from pixel column x0 to x1.
  drawPart(camera, state, palette, mode, x0, x1) {
    const gl = this.gl;
    if (x1 <= x0) return;
    gl.scissor(x0, 0, x1 - x0, this.canvas.height);
    const at = this.use('backdrop', camera, state);
    gl.uniform3fv(at.u_top, palette.top);
    gl.uniform3fv(at.u_bottom, palette.bottom);
    gl.depthMask(false);
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.depthMask(true);
    const {points, mesh} = this.scene;
    const solid = mesh && (mode === 'mesh' || !points);
    if (solid) this.drawMesh(camera, state, palette, state.meshMode);
    if (points && (!solid || state.overlay)) {
      this.drawPoints(camera, state, palette, solid ? (points.normal ? 'sides' : 'before') : mode);
    }
    if (state.needles && this.needles && mode !== 'before') this.drawNeedles(camera, state, palette);
  }

  draw(camera, state) {
    const gl = this.gl;
    const {width, height} = this.canvas;
    const palette = kPalette[state.theme];
    gl.viewport(0, 0, width, height);
    gl.enable(gl.SCISSOR_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.scissor(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const split = state.compare ? Math.round(width * state.divider) : 0;
    this.drawPart(camera, state, palette, 'before', 0, split);
    this.drawPart(camera, state, palette, state.mode, split, width);
  }
}

// (a, d): what is kept has a.p <= d.
function sectionPlane(state, scene) {
  if (state.axis < 0) return [0, 0, 0, 1];
  const sign = state.flip ? -1 : 1;
  const plane = [0, 0, 0, sign * state.cut * scene.extent[state.axis]];
  plane[state.axis] = sign;
  return plane;
}
