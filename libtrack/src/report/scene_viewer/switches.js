// What is below the picture: the frame's slider, what is drawn, how large ellipsoids are, and the legend.

function addCheckbox(bar, view, name, thing) {
  if (!thing) return;
  const label = element('label', '', '');
  const box = element('input');
  box.type = 'checkbox';
  box.checked = thing.visible;
  box.addEventListener('change', () => {
    thing.visible = box.checked;
    view.redraw();
  });
  label.append(box, ` ${name}`);
  bar.append(label);
}

function addButton(bar, name, act) {
  const button = element('button', '', name);
  button.type = 'button';
  button.addEventListener('click', act);
  bar.append(button);
  return button;
}

/** Ellipsoids grow by a slider of powers of ten. */
function addEllipsoidScale(bar, view) {
  const { ellipsoids: shown } = view.world;
  if (!shown) return;
  const label = element('label', 'scale', '');
  const words = element('span', '', ''), slider = element('input');
  Object.assign(slider, { type: 'range', min: 0, max: 4, step: 0.05, value: Math.log10(view.scene.ellipsoid_scale) });
  const factor = () => Number((10 ** Number(slider.value)).toPrecision(2));
  const tell = (value) => { words.textContent = `One sigma, drawn ${value} times too large `; };
  slider.addEventListener('input', () => {
    shown.setScale(factor());
    tell(factor());
    view.redraw();
  });
  tell(view.scene.ellipsoid_scale);
  label.append(words, slider);
  bar.append(label);
}

/** Steps through the frames as fast as they were taken, from the shown one, or the first if it is the last. */
class Player {
  constructor(slider, times_s, button) {
    Object.assign(this, { slider, times_s, button, start: null });
    button.addEventListener('click', () => (this.start === null ? this.play() : this.stop()));
  }

  play() {
    if (Number(this.slider.value) >= this.times_s.length - 1) this.slider.value = 0;
    this.start = performance.now() - 1000 * this.times_s[Number(this.slider.value)];
    this.button.textContent = 'Stop';
    this.step();
  }

  stop() {
    this.start = null;
    this.button.textContent = 'Play';
  }

  step() {
    if (this.start === null) return;
    const now_s = (performance.now() - this.start) / 1000;
    let i = Number(this.slider.value);
    while (i + 1 < this.times_s.length && this.times_s[i + 1] <= now_s) ++i;
    this.slider.value = i;
    this.slider.dispatchEvent(new Event('input'));
    if (i + 1 < this.times_s.length) requestAnimationFrame(() => this.step());
    else this.stop();
  }
}

function addTimeSlider(controls, view) {
  const { path } = view.scene;
  if (!path) return;
  const bar = element('div', 'bar time'), words = element('output', '', ''), slider = element('input');
  Object.assign(slider, { type: 'range', min: 0, max: path.time_s.length - 1, step: 1, value: 0 });
  slider.setAttribute('aria-label', 'frame');
  const show = () => {
    const i = Number(slider.value), state = view.scene.path_states[path.state[i]];
    words.textContent = `${path.time_s[i].toFixed(3)} s: ${state.name}`;
    words.style.borderColor = `var(${state.colour})`;
    view.world.showFrame(i);
    view.redraw();
  };
  slider.addEventListener('input', show);
  const player = addButton(bar, 'Play', () => {});
  view.player = new Player(slider, path.time_s, player);
  view.frameSlider = slider;
  bar.append(slider, words);
  controls.append(bar);
  slider.value = Math.max(0, path.time_s.findIndex((_, i) => positionAt(path, i) !== null));
  show();
}

/** Only what is in the scene. */
function addLegend(controls, view) {
  const { scene } = view;
  const legend = element('div', 'bar legend');
  const add = (name, colour) => {
    const entry = element('span', '', name);
    entry.style.setProperty('--mark', `var(${colour})`);
    legend.append(entry);
  };
  scene.tag_states.forEach((state, i) => {
    const count = scene.tags.filter((tag) => tag.state === i).length;
    if (count > 0) add(`${count} ${count === 1 ? 'tag' : 'tags'} ${state.name}`, state.colour);
  });
  if (scene.path) scene.path_states.forEach((state, i) => {
    const count = scene.path.state.filter((one) => one === i).length;
    if (count > 0) add(`${scene.path.name} ${state.name}`, state.colour);
  });
  if (scene.true_path) add(scene.true_path.name, '--ink');
  controls.append(legend);
}

function addSwitches(view) {
  const controls = view.figure.querySelector('.controls');
  addTimeSlider(controls, view);
  const bar = element('div', 'bar');
  addButton(bar, 'Reset the view', () => view.reset());
  addButton(bar, 'Full window', () => {
    view.figure.classList.toggle('full');
    view.resize();
  });
  addCheckbox(bar, view, 'ids', view.world.ids);
  addCheckbox(bar, view, 'ellipsoids', view.world.ellipsoids?.mesh);
  addCheckbox(bar, view, 'path', view.world.path);
  addCheckbox(bar, view, 'truth', view.world.truth);
  addCheckbox(bar, view, 'grid and axes', view.world.ground);
  addEllipsoidScale(bar, view);
  controls.append(bar);
  addLegend(controls, view);
}
