// What tells directions and lengths: a level grid below everything, one of its cells measured, and the frame's axes.

/** Two level directions at right angles to each other, and up. */
function levelAxes(up) {
  const least = up.map(Math.abs).indexOf(Math.min(...up.map(Math.abs)));
  const axis = new THREE.Vector3(...[0, 1, 2].map((i) => (i === least ? 1 : 0)));
  const z = new THREE.Vector3(...up).normalize();
  const x = axis.sub(z.clone().multiplyScalar(axis.dot(z))).normalize();
  return { x, y: z.clone().cross(x), z };
}

/** points: [x, y, z] each. Lines a round number of metres apart, at the lowest of the points. */
function groundGrid(points, up) {
  const { x, y, z } = levelAxes(up);
  const vectors = points.map((point) => new THREE.Vector3(...point));
  const span = (axis) => [Math.min(...vectors.map((v) => v.dot(axis))), Math.max(...vectors.map((v) => v.dot(axis)))];
  const [lowX, highX] = span(x), [lowY, highY] = span(y), [floor] = span(z);
  const step_m = roundNumberBelow(Math.max(highX - lowX, highY - lowY, 0.05) / 6);
  const ends = (low, high) => [Math.floor(low / step_m) - 1, Math.ceil(high / step_m) + 1];
  const [firstX, lastX] = ends(lowX, highX), [firstY, lastY] = ends(lowY, highY);
  const at = (i, j) => [
    ...x.clone().multiplyScalar(i * step_m).addScaledVector(y, j * step_m).addScaledVector(z, floor).toArray(),
  ];
  const segments = [];
  for (let i = firstX; i <= lastX; ++i) segments.push({ from: at(i, firstY), to: at(i, lastY), colour: '--rule' });
  for (let j = firstY; j <= lastY; ++j) segments.push({ from: at(firstX, j), to: at(lastX, j), colour: '--rule' });
  const bar = [{ from: at(firstX, firstY), to: at(firstX + 1, firstY), colour: '--pale' }];
  const label = { text: lengthInWords(step_m), place: at(firstX + 0.5, firstY - 0.35), room_m: 0, colour: '--pale' };
  return { step_m, segments, bar, label };
}

const kAxisColours = ['--vermilion', '--green', '--blue'];

function axisLines(origin, length_m) {
  return kAxisColours.map((colour, axis) => ({
    from: origin, to: origin.map((value, i) => value + (i === axis ? length_m : 0)), colour,
  }));
}

function axisLabels(origin, length_m) {
  return kAxisColours.map((colour, axis) => ({
    text: 'xyz'[axis],
    place: origin.map((value, i) => value + (i === axis ? 1.12 * length_m : 0)),
    room_m: 0,
    colour,
  }));
}
