// Words that face the viewer and keep a size that can be read. All are one geometry with one picture.

const kLabelVertexShader = `
  attribute vec3 place_m;
  attribute vec4 box;
  attribute float room_m;
  attribute vec2 corner;
  uniform vec2 screen_px;
  uniform float focal_px;
  varying vec2 at;
  void main() {
    vec4 place = projectionMatrix * modelViewMatrix * vec4(place_m, 1.0);
    float room_px = room_m > 0.0 ? room_m * focal_px / place.w : 100.0;
    if (place.w <= 0.0 || room_px < 7.0) {  // too far away to be read
      gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
      return;
    }
    float height_px = clamp(0.6 * room_px, 18.0, 24.0);
    vec2 size_px = vec2(height_px * box.z / box.w, height_px);
    if (room_m == 0.0) {  // what tells lengths and directions stays whole while any of it is in the picture
      vec2 room = vec2(1.0) - size_px / screen_px, middle = place.xy / place.w;
      if (all(lessThan(abs(middle), vec2(2.0) - room))) place.xy = clamp(middle, -room, room) * place.w;
    }
    vec2 shift_px = corner * size_px + vec2(0.0, room_m > 0.0 ? 0.5 * height_px : 0.0);
    place.xy += shift_px * 2.0 / screen_px * place.w;
    place.z -= 1e-3 * place.w;
    gl_Position = place;
    at = (box.xy + (corner * vec2(1.0, -1.0) + 0.5) * box.zw);
  }`;

const kLabelFragmentShader = `
  uniform sampler2D letters;
  uniform vec2 picture_px;
  varying vec2 at;
  void main() {
    vec4 colour = texture2D(letters, at / picture_px);
    if (colour.a < 0.02) discard;
    gl_FragColor = colour;
  }`;

const kLetters_px = 32;

/** Writes all words into one picture; tells where each stands: [x, y, width, height]. */
function letterPicture(labels) {
  const canvas = document.createElement('canvas');
  const pen = canvas.getContext('2d');
  const font = `600 ${kLetters_px}px system-ui, sans-serif`;
  const kHigh = Math.round(1.4 * kLetters_px), kWide = 2048;
  pen.font = font;
  let x = 0, y = 0;
  const boxes = labels.map((label) => {
    const width = Math.min(kWide, Math.ceil(pen.measureText(label.text).width) + 12);
    if (x + width > kWide) [x, y] = [0, y + kHigh];
    x += width;
    return [x - width, y, width, kHigh];
  });
  canvas.width = kWide;
  canvas.height = y + kHigh;
  pen.font = font;
  pen.textBaseline = 'middle';
  pen.lineJoin = 'round';
  pen.lineWidth = 7;
  labels.forEach((label, i) => {
    const [left, top] = boxes[i];
    pen.strokeStyle = pageColour('--paper');
    pen.fillStyle = pageColour(label.colour);
    pen.strokeText(label.text, left + 6, top + kHigh / 2);
    pen.fillText(label.text, left + 6, top + kHigh / 2);
  });
  return { canvas, boxes };
}

/** labels: {text, place: [x, y, z], room_m, colour} each; room_m: of the thing that is named, 0: always shown. */
function facingLabels(labels, screen, focal) {
  const { canvas, boxes } = letterPicture(labels);
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(stripIndices(labels.length));
  geometry.setAttribute('place_m', fourEach(labels, 3, (label) => label.place));
  geometry.setAttribute('room_m', fourEach(labels, 1, (label) => [label.room_m]));
  geometry.setAttribute('box', fourEach(labels, 4, (_, i) => boxes[i]));
  const corners = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]];
  geometry.setAttribute('corner', new THREE.Float32BufferAttribute(labels.flatMap(() => corners.flat()), 2));
  const texture = new THREE.CanvasTexture(canvas);
  texture.flipY = false;
  const material = new THREE.ShaderMaterial({
    vertexShader: kLabelVertexShader,
    fragmentShader: kLabelFragmentShader,
    uniforms: {
      screen_px: screen,
      focal_px: focal,
      letters: { value: texture },
      picture_px: { value: new THREE.Vector2(canvas.width, canvas.height) },
    },
    transparent: true,
    depthWrite: false,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = 3;
  return mesh;
}

/** Writes the same words anew in the page's colours. */
function recolourLabels(mesh, labels) {
  const texture = mesh.material.uniforms.letters.value;
  texture.image = letterPicture(labels).canvas;
  texture.needsUpdate = true;
}
