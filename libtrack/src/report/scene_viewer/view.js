// A scene on the page: the picture, what moves it, and the switches below it.

const kField_deg = 40;  // of view, from the top to the bottom

/** Whether WebGL is drawn by the processor: smooth edges would take most of its time. */
function isSoftware() {
  const context = document.createElement('canvas').getContext('webgl2');
  if (context === null) return false;  // the renderer says why
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(String(name));
}

class View {
  constructor(figure) {
    this.figure = figure;
    this.scene = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
    this.canvas = figure.querySelector('canvas');
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: !isSoftware(), preserveDrawingBuffer: true });
    this.renderer.debug.onShaderError = (context, program, vertex, fragment) => {
      throw new Error(`a shader failed: ${context.getShaderInfoLog(vertex)} ${context.getShaderInfoLog(fragment)}`);
    };
    this.world = new World(this.scene);
    this.camera = new THREE.PerspectiveCamera(kField_deg, 1, 0.01, 100);
    this.camera.up.set(...this.scene.up);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.redraw());
    this.isDue = false;
    this.reset();
    this.listen();
    addSwitches(this);
    this.resize();
  }

  /** Draws in the next frame of the screen, once. */
  redraw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.isDue = false;
    const far = this.camera.position.distanceTo(this.world.ball().center) + 4 * this.world.radius();
    this.camera.far = far;
    this.camera.near = Math.min(far / 2000, 0.2 * this.camera.position.distanceTo(this.controls.target));
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.world.root, this.camera);
  }

  /** From the side and somewhat above, all in view. */
  reset() {
    const { center, radius } = this.world.ball();
    const { x, y, z } = levelAxes(this.scene.up);
    const from = this.scene.view_from ? new THREE.Vector3(...this.scene.view_from)
      : x.multiplyScalar(0.55).addScaledVector(y, -0.75).addScaledVector(z, 0.55);
    const aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
    const upright = 0.5 * kField_deg * Math.PI / 180, across = Math.atan(Math.tan(upright) * Math.min(1, aspect));
    const distance = (aspect > 1.3 ? 0.85 : 1) * radius / Math.sin(across);
    this.lookFrom(from.normalize().multiplyScalar(distance).add(center), center);
  }

  lookFrom(position, target) {
    this.camera.position.copy(position);
    this.controls.target.copy(target);
    this.controls.update();
    this.redraw();
  }

  resize() {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.world.screen.value.set(width, height);
    this.world.focal.value = 0.5 * height / Math.tan(0.5 * kField_deg * Math.PI / 180);
    this.draw();
  }

  listen() {
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const recolour = () => { this.world.recolour(); this.redraw(); };
    dark.addEventListener('change', recolour);
    matchMedia('print').addEventListener('change', () => { this.world.recolour(); this.draw(); });
    // The wheel scrolls the page until somebody takes hold of the picture.
    this.controls.enableZoom = matchMedia('(pointer: coarse)').matches;
    this.canvas.addEventListener('pointerdown', () => { this.controls.enableZoom = true; });
    this.canvas.addEventListener('pointerleave', () => this.showTip(null));
    this.canvas.addEventListener('pointermove', (event) => this.point(event));
    this.canvas.addEventListener('pointerup', (event) => this.point(event));
    document.addEventListener('pointerdown', (event) => {
      if (!this.figure.contains(event.target)) this.controls.enableZoom = false;
    });
  }

  /** Names the tag under the pointer. */
  point(event) {
    if (event.buttons !== 0) return;
    const box = this.canvas.getBoundingClientRect();
    const x = 2 * (event.clientX - box.left) / box.width - 1, y = 1 - 2 * (event.clientY - box.top) / box.height;
    this.showTip(this.world.tagAt(this.camera, x, y), event.clientX - box.left, event.clientY - box.top);
  }

  showTip(tag, x, y) {
    const tip = this.figure.querySelector('.tip');
    tip.hidden = tag === null;
    if (tag === null) return;
    tip.textContent = [tag.name, this.scene.tag_states[tag.state].name, ...tag.notes].join('\n');
    const isRight = x > 0.6 * this.canvas.clientWidth;
    tip.style.left = isRight ? 'auto' : `${x + 14}px`;
    tip.style.right = isRight ? `${this.canvas.clientWidth - x + 14}px` : 'auto';
    tip.style.top = `${Math.max(4, y - 12)}px`;
  }
}
