// Tags as they are printed: all faces are one geometry with one picture. Tag frame: x right, y down, z into the tag.

/** Rotates [x, y, z] by a unit quaternion. */
function turned([qx, qy, qz, qw], [x, y, z]) {
  const tx = 2 * (qy * z - qz * y), ty = 2 * (qz * x - qx * z), tz = 2 * (qx * y - qy * x);
  return [x + qw * tx + qy * tz - qz * ty, y + qw * ty + qz * tx - qx * tz, z + qw * tz + qx * ty - qy * tx];
}

/** A point in the tag's frame, in halves of its size, as a point of the scene. */
function onTag(tag, u, v, w = 0) {
  const half_m = 0.5 * tag.size_m;
  const aside = turned(tag.orientation_xyzw, [half_m * u, half_m * v, half_m * w]);
  return aside.map((value, i) => value + tag.place[i]);
}

/** Whether cell number i of a picture is set; cells are written four to a hexadecimal digit, the first highest. */
function isSet(hexadecimal, i) {
  return (parseInt(hexadecimal[i >> 2], 16) >> (3 - (i & 3))) & 1;
}

/** Paints a tag's cells, with one cell of white paper about them. Where nothing is printed there is paper, too. */
function paintCells(pixels, pictureWidth, left, top, tag, family) {
  const width = family.cells;
  for (let row = -1; row <= width; ++row) {
    for (let column = -1; column <= width; ++column) {
      const isInside = row >= 0 && row < width && column >= 0 && column < width;
      const isBlack = isInside && isSet(tag.black, row * width + column);
      const at = 4 * ((top + row + 1) * pictureWidth + left + column + 1);
      pixels.fill(isBlack ? 24 : 255, at, at + 3);
      pixels[at + 3] = 255;
    }
  }
}

/** One picture of all tags, a pixel for each cell; each tag's place in it as [left, top, width] in pixels. */
function tagPicture(scene) {
  const widest = Math.max(...scene.families.map((family) => family.cells)) + 2;
  const columns = Math.ceil(Math.sqrt(scene.tags.length));
  const width = columns * widest, height = Math.ceil(scene.tags.length / columns) * widest;
  const pixels = new Uint8Array(4 * width * height).fill(255);
  const places = scene.tags.map((tag, i) => {
    const family = scene.families[tag.family];
    const left = (i % columns) * widest, top = Math.floor(i / columns) * widest;
    paintCells(pixels, width, left, top, tag, family);
    return [left, top, family.cells + 2];
  });
  const texture = new THREE.DataTexture(pixels, width, height);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.magFilter = THREE.NearestFilter;  // cells have sharp edges
  texture.minFilter = THREE.LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return { texture, places, width, height };
}

/** The printed square, its white margin included, in halves of the tag's size. */
function halfExtent(family) {
  return (family.cells + 2) / family.cells_across_size;
}

/** What the front of all tags shows. */
function tagFaces(scene) {
  const picture = tagPicture(scene);
  const positions = [], places = [], indices = [];
  scene.tags.forEach((tag, i) => {
    const half = halfExtent(scene.families[tag.family]);
    const [left, top, width] = picture.places[i];
    for (const [u, v] of [[-1, -1], [1, -1], [-1, 1], [1, 1]]) {
      positions.push(...onTag(tag, half * u, half * v));
      places.push((left + (u + 1) / 2 * width) / picture.width, (top + (v + 1) / 2 * width) / picture.height);
    }
    // Seen from the front, with x right and y down, this order runs anticlockwise: the side that is drawn.
    indices.push(...[0, 2, 1, 1, 2, 3].map((corner) => 4 * i + corner));
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(indices);
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('uv', new THREE.Float32BufferAttribute(places, 2));
  const front = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map: picture.texture, side: THREE.FrontSide }));
  const back = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: 0x8a8f96, side: THREE.BackSide }));
  front.frustumCulled = back.frustumCulled = false;
  return [front, back];
}

/** Outlines in the colour of the tag's state, a stroke that says which way is up, and one that says where it faces. */
function tagLines(scene) {
  const segments = [];
  for (const tag of scene.tags) {
    const colour = scene.tag_states[tag.state].colour;
    const half = halfExtent(scene.families[tag.family]);
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([u, v]) => onTag(tag, half * u, half * v));
    const add = (from, to) => segments.push({ from, to, colour });
    corners.forEach((corner, i) => add(corner, corners[(i + 1) % 4]));
    const tip = onTag(tag, 0, -half - 0.4);
    add(onTag(tag, -0.25, -half), tip);
    add(onTag(tag, 0.25, -half), tip);
    add(onTag(tag, 0, 0), onTag(tag, 0, 0, -0.8));
  }
  return segments;
}

/** A cross over tags that take no part. */
function tagCrosses(scene) {
  const segments = [];
  for (const tag of scene.tags) {
    const state = scene.tag_states[tag.state];
    if (!state.is_crossed) continue;
    const half = halfExtent(scene.families[tag.family]);
    for (const side of [-1, 1])
      segments.push({ from: onTag(tag, -half, -side * half), to: onTag(tag, half, side * half), colour: state.colour });
  }
  return segments;
}

function tagLabels(scene) {
  return scene.tags.map((tag) => ({
    text: tag.label,
    place: onTag(tag, 0, -halfExtent(scene.families[tag.family]) - 0.4),
    room_m: tag.size_m,
    colour: scene.tag_states[tag.state].colour,
  }));
}

/** The tag that a ray meets first: its place in the list, or -1. Both [x, y, z]. */
function tagOnRay(scene, origin, direction) {
  let nearest = Infinity, found = -1;
  scene.tags.forEach((tag, i) => {
    const [qx, qy, qz, qw] = tag.orientation_xyzw, back = [-qx, -qy, -qz, qw];
    const from = turned(back, origin.map((value, k) => value - tag.place[k])), along = turned(back, direction);
    const distance = -from[2] / along[2];
    const half = 0.5 * tag.size_m * halfExtent(scene.families[tag.family]);
    const isInside = [0, 1].every((k) => Math.abs(from[k] + distance * along[k]) <= half);
    if (distance > 0 && distance < nearest && isInside) [nearest, found] = [distance, i];
  });
  return found;
}
