// All that is drawn of a scene, as objects of three.js.

/** Numbers of the graphics card are short: places are reckoned from the middle of the scene. */
function middleOf(scene) {
  if (scene.moving === 'tags') return [0, 0, 0];
  const points = scene.tags.map((tag) => tag.position_m);
  return [0, 1, 2].map((i) => points.reduce((sum, point) => sum + point[i], 0) / Math.max(1, points.length));
}

class World {
  constructor(scene) {
    this.scene = scene;
    this.middle = middleOf(scene);
    this.shift = (point) => point.map((value, i) => value - this.middle[i]);
    this.screen = screenUniform();
    this.focal = { value: 1 };
    this.root = new THREE.Scene();
    this.tagGroup = new THREE.Group();  // which moves, where the tags do
    this.root.add(this.tagGroup);
    this.coloured = [];  // what takes new colours: functions
    for (const tag of scene.tags) tag.place = this.shift(tag.position_m);
    this.addTags();
    this.addPath();
    this.addGround();
    this.addMarker();
    this.recolour();
  }

  addLines(parent, segments, width_px, options) {
    const mesh = wideLines(segments, width_px, this.screen, options);
    parent.add(mesh);
    this.coloured.push(() => recolourLines(mesh, segments));
    return mesh;
  }

  addLabels(parent, labels) {
    const mesh = facingLabels(labels, this.screen, this.focal);
    parent.add(mesh);
    this.coloured.push(() => recolourLabels(mesh, labels));
    return mesh;
  }

  addTags() {
    if (this.scene.tags.length === 0) return;
    this.faces = tagFaces(this.scene);
    this.tagGroup.add(...this.faces);
    this.addLines(this.tagGroup, tagLines(this.scene), 2);
    this.addLines(this.tagGroup, tagCrosses(this.scene), 2.5, { towardsEye: 4e-4 });
    this.ids = this.addLabels(this.tagGroup, tagLabels(this.scene));
    this.ellipsoids = ellipsoids(this.scene);
    if (!this.ellipsoids) return;
    this.tagGroup.add(this.ellipsoids.mesh);
    this.coloured.push(this.ellipsoids.recolour);
    this.ellipsoids.setScale(this.scene.ellipsoid_scale);
  }

  addPath() {
    const { path, true_path: truePath } = this.scene;
    if (truePath) this.truth = this.addLines(this.root, pathLines(truePath, () => '--ink', this.shift), 1.5);
    if (!path) return;
    this.path = new THREE.Group();
    this.root.add(this.path);
    const colourOf = (i) => this.scene.path_states[path.state[i]].colour;
    this.addLines(this.path, pathLines(path, colourOf, this.shift), 2.5);
    this.addLines(this.path, pathMarks(path, colourOf, this.shift, 0.004 * this.radius()), 2);
  }

  addGround() {
    const points = this.points();
    const ground = groundGrid(points.length > 0 ? points : [[0, 0, 0]], this.scene.up);
    const origin = this.shift([0, 0, 0]);
    this.ground = new THREE.Group();
    this.root.add(this.ground);
    this.addLines(this.ground, ground.segments, 1);
    this.addLines(this.ground, ground.bar, 4);
    this.addLabels(this.ground, [ground.label]);
    const axes = this.scene.moving === 'tags' ? this.tagGroup : this.ground;
    this.addLines(axes, axisLines(origin, ground.step_m), 2.5, { towardsEye: 1e-3 });
    this.addLabels(axes, axisLabels(origin, ground.step_m));
  }

  addMarker() {
    if (!this.scene.path) return;
    this.marker = new THREE.Group();
    this.root.add(this.marker);
    const length_m = 0.07 * this.radius();
    this.addLines(this.marker, frustumLines(this.scene.view_tangents, length_m, '--ink'), 2.5, { towardsEye: 1e-3 });
  }

  /** Leaves the tags alone. */
  showBare() {
    for (const child of [...this.tagGroup.children, ...this.root.children]) child.visible = false;
    this.tagGroup.visible = true;
    this.faces.forEach((face) => { face.visible = true; });
  }

  /** Everything that must be in view, [x, y, z] from the middle. */
  points() {
    const of = (path) => (path ? path.time_s.map((_, i) => positionAt(path, i)).filter(Boolean).map(this.shift) : []);
    const points = [...of(this.scene.path), ...of(this.scene.true_path)];
    if (this.scene.moving === 'tags') return [[0, 0, 0], ...points];
    return [...points, ...this.scene.tags.flatMap((tag) => [onTag(tag, -1, -1), onTag(tag, 1, 1)])];
  }

  /** Of a ball about the points, and its middle. */
  ball() {
    if (this.ball_) return this.ball_;
    const box = new THREE.Box3();
    for (const point of this.points()) box.expandByPoint(new THREE.Vector3(...point));
    const center = box.getCenter(new THREE.Vector3());
    this.ball_ = { center, radius: Math.max(0.1, 0.5 * box.getSize(new THREE.Vector3()).length()) };
    return this.ball_;
  }

  radius() {
    return this.ball().radius;
  }

  /** Puts the marker, or the tags, where they are in frame i; hides what has no pose there. */
  showFrame(i) {
    const { path } = this.scene;
    const position = positionAt(path, i);
    const moved = this.scene.moving === 'tags' ? this.tagGroup : this.marker;
    moved.visible = position !== null;
    if (position === null) return;
    moved.position.set(...(this.scene.moving === 'tags' ? position : this.shift(position)));
    moved.quaternion.set(...orientationAt(path, i));
    moved.updateMatrixWorld();
  }

  recolour() {
    this.root.background = new THREE.Color(pageColour('--tint'));
    for (const recolour of this.coloured) recolour();
  }

  /** The tag at a place of the picture, x and y in [-1, 1]; null where there is none. */
  tagAt(camera, x, y) {
    if (!this.tagGroup.visible) return null;
    const inverse = this.tagGroup.matrixWorld.clone().invert();
    const origin = camera.position.clone(), end = new THREE.Vector3(x, y, 0.5).unproject(camera);
    origin.applyMatrix4(inverse);
    const direction = end.applyMatrix4(inverse).sub(origin);
    const i = tagOnRay(this.scene, origin.toArray(), direction.toArray());
    return i < 0 ? null : this.scene.tags[i];
  }
}
