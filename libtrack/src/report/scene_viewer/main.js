// Starts every scene of the page. What the address says behind # goes to the first one:
//   #view=x,y,z,tx,ty,tz   seen from (x, y, z), looking at (tx, ty, tz), in metres of the map's frame
//   #full                  as large as the window
//   #bare                  tags alone: no ids, outlines, ellipsoids, path, grid
//   #measure, #measure=N   how many frames a second are drawn, over 60 or N of them, written below the picture
// Several are joined by &.

function addressWords() {
  const words = new Map();
  for (const part of decodeURIComponent(location.hash.slice(1)).split('&')) {
    const [name, value] = part.split('=');
    words.set(name, value ?? '');
  }
  return words;
}

/** Draws while turning about the scene; reading a pixel back waits until all of it is done. */
function framesPerSecond(view, frames) {
  const { center } = view.world.ball();
  const arm = view.camera.position.clone().sub(center), up = new THREE.Vector3(...view.scene.up);
  const context = view.renderer.getContext(), pixel = new Uint8Array(4);
  const drawTurned = (i) => {
    view.camera.position.copy(arm).applyAxisAngle(up, 2 * Math.PI * i / frames).add(center);
    view.camera.lookAt(center);
    view.draw();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
  };
  for (let i = 0; i < 5; ++i) drawTurned(i);  // what is done once is not counted
  const start_ms = performance.now();
  for (let i = 0; i < frames; ++i) drawTurned(i);
  const rate = 1000 * frames / (performance.now() - start_ms);
  view.reset();
  return rate;
}

function obey(view, words) {
  if (words.has('full')) view.figure.classList.add('full');
  if (words.has('bare')) view.world.showBare();
  view.resize();
  if (words.has('view')) {
    const numbers = words.get('view').split(',').map(Number);
    if (numbers.length === 6 && numbers.every(Number.isFinite)) {
      const at = (first) => new THREE.Vector3(...view.world.shift(numbers.slice(first, first + 3)));
      view.lookFrom(at(0), at(3));
    }
  }
  if (words.has('measure')) {
    const { width, height } = view.canvas;
    const told = `${framesPerSecond(view, Number(words.get('measure')) || 60).toFixed(1)} frames a second, ${view.scene.tags.length} tags, ${width} x ${height} pixels`;
    view.figure.append(element('p', 'measured', told));
  }
  view.draw();
}

function start() {
  const words = addressWords();
  document.querySelectorAll('figure.scene').forEach((figure, i) => {
    try {
      figure.dataset.state = 'drawn';  // which gives the picture its size
      const view = new View(figure);
      obey(view, i === 0 ? words : new Map());
    } catch (error) {
      figure.dataset.state = 'not drawn';
      figure.querySelector('.why').textContent =
        `The 3-D view cannot be drawn here (${error.message}). The drawings of the page show the same.`;
    }
  });
}

start();
