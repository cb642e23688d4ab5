// Where each tag may be: the surface x' covariance^-1 x = 1, one sigma, drawn too large by a factor.

/** Columns of the lower triangle L with L L' = covariance: L takes the unit sphere to the ellipsoid. */
function choleskyColumns([xx, xy, xz, yy, yz, zz]) {
  const root = (value) => Math.sqrt(Math.max(0, value));
  const over = (value, by) => (by > 0 ? value / by : 0);
  const a = root(xx), b = over(xy, a), c = over(xz, a);
  const d = root(yy - b * b), e = over(yz - b * c, d);
  return [[a, b, c], [0, d, e], [0, 0, root(zz - c * c - e * e)]];
}

/** A unit sphere of as many rings and twice as many sectors. */
function unitSphere(rings) {
  const sectors = 2 * rings, points = [], indices = [];
  for (let ring = 0; ring <= rings; ++ring) {
    for (let sector = 0; sector < sectors; ++sector) {
      const down = Math.PI * ring / rings, around = Math.PI * sector / rings;
      points.push([Math.sin(down) * Math.cos(around), Math.sin(down) * Math.sin(around), Math.cos(down)]);
      if (ring === rings) continue;
      const here = ring * sectors + sector, next = ring * sectors + (sector + 1) % sectors;
      if (ring > 0) indices.push(here, here + sectors, next);  // at the poles one of the two is none
      if (ring < rings - 1) indices.push(next, here + sectors, next + sectors);
    }
  }
  return { points, indices };
}

const kEllipsoidVertexShader = `
  attribute vec3 aside_m;
  uniform float scale;
  void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position + scale * aside_m, 1.0); }`;

const kEllipsoidFragmentShader = `
  uniform vec3 colour;
  void main() { gl_FragColor = vec4(colour, 0.3); }`;

/** One mesh of all; null where no tag has a covariance. `setScale` of it takes the factor. */
function ellipsoids(scene) {
  const tags = scene.tags.filter((tag) => tag.covariance_m2 && tag.covariance_m2.some((value) => value !== 0));
  if (tags.length === 0) return null;
  const sphere = unitSphere(tags.length > 100 ? 4 : 12);  // most of the time to draw, in software
  const centers = [], asides = [], indices = [];
  tags.forEach((tag, i) => {
    const [a, b, c] = choleskyColumns(tag.covariance_m2);
    for (const [x, y, z] of sphere.points) {
      centers.push(...tag.place);
      asides.push(...[0, 1, 2].map((k) => x * a[k] + y * b[k] + z * c[k]));
    }
    for (const index of sphere.indices) indices.push(i * sphere.points.length + index);
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(indices);
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(centers, 3));
  geometry.setAttribute('aside_m', new THREE.Float32BufferAttribute(asides, 3));
  const material = new THREE.ShaderMaterial({
    vertexShader: kEllipsoidVertexShader,
    fragmentShader: kEllipsoidFragmentShader,
    uniforms: { scale: { value: 1 }, colour: { value: new THREE.Vector3() } },
    transparent: true,
    depthWrite: false,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = 2;
  return {
    mesh,
    setScale: (scale) => { material.uniforms.scale.value = scale; },
    recolour: () => material.uniforms.colour.value.set(...pageColourNumbers('--accent')),
  };
}
