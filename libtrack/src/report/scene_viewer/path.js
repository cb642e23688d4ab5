// Where the camera, or the body, was, and which frame is shown.

/** Position number i of a path: [x, y, z], or null where the frame has no pose. */
function positionAt(path, i) {
  return path.position_m[3 * i] === null ? null : path.position_m.slice(3 * i, 3 * i + 3);
}

function orientationAt(path, i) {
  return path.orientation_xyzw.slice(4 * i, 4 * i + 4);
}

/** Lines between frames that follow each other and have a pose; pale where the second of the two is not there. */
function pathLines(path, colourOf, shift) {
  const segments = [];
  let before = null;
  path.time_s.forEach((_, i) => {
    const here = positionAt(path, i);
    if (here !== null) {
      const to = shift(here);
      if (before !== null) segments.push({ from: before.at, to, colour: before.i === i - 1 ? colourOf(i) : '--rule' });
      before = { at: to, i };
    }
  });
  return segments;
}

/** Small crosses of three strokes, which are seen from everywhere, so that single frames show. */
function pathMarks(path, colourOf, shift, half_m) {
  const segments = [];
  path.time_s.forEach((_, i) => {
    const here = positionAt(path, i);
    if (here === null) return;
    const at = shift(here);
    for (let axis = 0; axis < 3; ++axis) {
      const end = (sign) => at.map((value, k) => value + (k === axis ? sign * half_m : 0));
      segments.push({ from: end(-1), to: end(1), colour: colourOf(i) });
    }
  });
  return segments;
}

/** A camera's field of view, `length_m` deep, with a mark on its upper side. Camera frame: x right, y down, z forward. */
function frustumLines([right, down], length_m, colour) {
  const corner = (x, y) => [x * right * length_m, y * down * length_m, length_m];
  const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
  const top = [0, -1.5 * down * length_m, length_m];
  const pairs = [[corner(-0.5, -1), top], [corner(0.5, -1), top]];
  corners.forEach((one, i) => pairs.push([[0, 0, 0], one], [one, corners[(i + 1) % 4]]));
  return pairs.map(([from, to]) => ({ from, to, colour }));
}
