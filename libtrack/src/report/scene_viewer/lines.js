// Lines of a width in pixels, which WebGL has not: each is a strip of four vertices that the shader lays along the
// line on the screen. All lines of one kind are one geometry; not an instanced one, for drawing in software takes
// each instance for a drawing of its own (4 frames a second instead of 40, for 500 tags).

const kLineVertexShader = `
  attribute vec3 from_m;
  attribute vec3 to_m;
  attribute vec3 line_colour;
  attribute vec2 corner;
  uniform vec2 screen_px;
  uniform float width_px;
  uniform float towards_eye;
  varying vec3 colour;
  void main() {
    colour = line_colour;
    vec4 a = projectionMatrix * modelViewMatrix * vec4(from_m, 1.0);
    vec4 b = projectionMatrix * modelViewMatrix * vec4(to_m, 1.0);
    float depth_a = a.z + a.w, depth_b = b.z + b.w;  // before the near plane where < 0
    if (depth_a <= 0.0 && depth_b <= 0.0) {
      gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
      return;
    }
    if (depth_a < 0.0) a = mix(a, b, depth_a / (depth_a - depth_b));
    if (depth_b < 0.0) b = mix(b, a, depth_b / (depth_b - depth_a));
    vec2 along = (b.xy / b.w - a.xy / a.w) * screen_px;
    along = dot(along, along) > 1e-12 ? normalize(along) : vec2(1.0, 0.0);
    vec2 aside = vec2(-along.y, along.x);
    vec4 end = corner.x < 0.5 ? a : b;
    vec2 shift_px = 0.5 * width_px * (aside * corner.y + along * (corner.x - 0.5));
    end.xy += 2.0 * shift_px / screen_px * end.w;
    end.z -= towards_eye * end.w;
    gl_Position = end;
  }`;

const kLineFragmentShader = `
  uniform float opacity;
  varying vec3 colour;
  void main() { gl_FragColor = vec4(colour, opacity); }`;

/** The screen's size, shared by all materials that draw in pixels. */
const screenUniform = () => ({ value: new THREE.Vector2(1, 1) });

/** The same numbers at all four vertices of each thing. */
function fourEach(things, size, of) {
  const numbers = new Float32Array(4 * size * things.length);
  things.forEach((thing, i) => {
    const own = of(thing, i);
    for (let vertex = 0; vertex < 4; ++vertex) numbers.set(own, size * (4 * i + vertex));
  });
  return new THREE.BufferAttribute(numbers, size);
}

/** Two triangles each. */
function stripIndices(count) {
  return Array.from({ length: count }, (_, i) => [0, 1, 2, 2, 1, 3].map((corner) => 4 * i + corner)).flat();
}

/**
 * segments: {from: [x, y, z], to: [x, y, z], colour: "--ink"} each. screen: what screenUniform() made.
 * towardsEye: share of the depth by which they lie before what they are drawn on.
 */
function wideLines(segments, width_px, screen, { opacity = 1, towardsEye = 2e-4 } = {}) {
  const geometry = new THREE.BufferGeometry();
  const add = (name, size, of) => geometry.setAttribute(name, fourEach(segments, size, of));
  geometry.setIndex(stripIndices(segments.length));
  add('from_m', 3, (segment) => segment.from);
  add('to_m', 3, (segment) => segment.to);
  add('line_colour', 3, (segment) => pageColourNumbers(segment.colour));
  const corners = [[0, -1], [1, -1], [0, 1], [1, 1]];
  geometry.setAttribute('corner', new THREE.Float32BufferAttribute(segments.flatMap(() => corners.flat()), 2));
  const material = new THREE.ShaderMaterial({
    vertexShader: kLineVertexShader,
    fragmentShader: kLineFragmentShader,
    uniforms: {
      screen_px: screen,
      width_px: { value: width_px },
      towards_eye: { value: towardsEye },
      opacity: { value: opacity },
    },
    transparent: opacity < 1,
    depthWrite: opacity >= 1,
    side: THREE.DoubleSide,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  return mesh;
}

/** Takes new colours from the page. */
function recolourLines(mesh, segments) {
  const colours = mesh.geometry.getAttribute('line_colour');
  colours.array.set(fourEach(segments, 3, (segment) => pageColourNumbers(segment.colour)).array);
  colours.needsUpdate = true;
}
