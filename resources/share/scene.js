// SPDX-License-Identifier: BSD-3-Clause
// The scene in 3D, drawn with three.js. Lines are ribbons of constant width on the screen; what lies on the surface is moved along the rays of
// sight, so that it covers its own pixels from everywhere. Throws where the browser has no WebGL.
function glintScene(data, canvas, labelBox, select) {
  'use strict';
  const V = (a, i) => new THREE.Vector3(a[i || 0], a[(i || 0) + 1], a[(i || 0) + 2]);
  const renderer = new THREE.WebGLRenderer({ canvas: canvas, antialias: true });
  const scene = new THREE.Scene(), eye = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
  eye.matrixAutoUpdate = false;
  scene.autoUpdate = true;
  let state = null, theme = 'light', opacity = 0.75, asked = false, labels = [], remarks = [];
  const kInk = { light: '#1a1a1a', dark: '#ebebeb' }, kGround = { light: '#f7f7f7', dark: '#1a1c21' };
  const kVirtual = { light: '#6a52c9', dark: '#b39ef2' }, kTruth = { light: '#b8008a', dark: '#e05cc0' }, kLight = { light: '#8a7a00', dark: '#f0e442' };
  const kTraining = { light: '#0072b2', dark: '#4aa8e0' }, kOther = { light: '#7c7c7c', dark: '#8c8c8c' };

  // Sizes, so that millimetres and kilometres look alike.
  const poses = data.frames.map((frame) => poseOf(frame.camera));
  function poseOf(camera) {
    const m = camera.camera_from_world;
    const camFromWorld = new THREE.Matrix4().set(...m[0], ...m[1], ...m[2], 0, 0, 0, 1);
    const worldFromCam = new THREE.Matrix4().getInverse(camFromWorld);
    return { worldFromCam: worldFromCam, centre: new THREE.Vector3().setFromMatrixPosition(worldFromCam),
      up: new THREE.Vector3(-m[1][0], -m[1][1], -m[1][2]), key: JSON.stringify(m) };
  }
  const surfaces = data.surfaces.map(surfaceOf);
  const surfaceBox = new THREE.Box3();
  for (const surface of surfaces) if (surface.geometry) surfaceBox.union(surface.geometry.boundingBox);
  const { surface: surfaceSize, scene: sceneSize, point, depth } = data.sizes, centre = V(data.sizes.centre);
  if (surfaceBox.isEmpty()) surfaceBox.setFromCenterAndSize(centre, new THREE.Vector3().setScalar(surfaceSize / Math.sqrt(3)));

  // Geometry from the page's data.
  function bytesOf(text) {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
    return bytes;
  }
  function surfaceOf(packed) {
    if (packed.problem) return {};
    const codes = new Uint16Array(bytesOf(packed.positions).buffer), positions = new Float32Array(codes.length);
    for (let i = 0; i < codes.length; ++i) positions[i] = packed.origin[i % 3] + packed.step[i % 3] * codes[i];
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytesOf(packed.indices).buffer), 1));
    if (packed.normals) geometry.setAttribute('normal', new THREE.BufferAttribute(new Int8Array(bytesOf(packed.normals).buffer), 3, true));
    else geometry.computeVertexNormals();
    geometry.computeBoundingBox();
    return { geometry: geometry };
  }
  // Lit from beside the eye, on whichever side is looked at: a mesh may be wound either way.
  function surfaceMaterial(settings) {
    return new THREE.ShaderMaterial({ side: THREE.DoubleSide, transparent: true, ...settings, uniforms: { opacity: { value: opacity }, colour: { value: new THREE.Color('#7b828b') } },
      vertexShader: 'varying vec3 n; varying vec3 at; void main() { n = normalMatrix * normal; vec4 v = modelViewMatrix * vec4(position, 1.0); at = v.xyz; gl_Position = projectionMatrix * v; }',
      fragmentShader: 'uniform float opacity; uniform vec3 colour; varying vec3 n; varying vec3 at; void main() { vec3 m = normalize(n); if (dot(m, at) > 0.0) m = -m;' +
        ' vec3 l = normalize(vec3(0.35, 0.5, 1.0)); float d = max(dot(m, l), 0.0); vec3 h = normalize(l + normalize(-at));' +
        ' gl_FragColor = vec4(colour * (0.34 + 0.86 * d) + 0.10 * pow(max(dot(m, h), 0.0), 30.0), opacity); }' });
  }
  const depthOnly = surfaceMaterial({ colorWrite: false }), surfaceLook = surfaceMaterial({ depthFunc: THREE.LessEqualDepth });

  const kLines = { uniforms: {}, vertexShader:
    'attribute vec3 other; attribute float side; uniform vec2 resolution; uniform float width; uniform float nearer; void main() {' +
    ' vec4 v = modelViewMatrix * vec4(position, 1.0), w = modelViewMatrix * vec4(other, 1.0); v.xyz *= 1.0 - nearer; w.xyz *= 1.0 - nearer;' +
    ' vec4 a = projectionMatrix * v, b = projectionMatrix * w; float da = a.z + a.w, db = b.z + b.w;' +
    ' if (da < 0.0 && db > 0.0) a = mix(a, b, da / (da - db)); else if (db < 0.0 && da > 0.0) b = mix(b, a, db / (db - da));' +
    ' vec2 along = (b.xy / b.w - a.xy / a.w) * resolution; float l = length(along); along = l > 1e-6 ? along / l : vec2(1.0, 0.0);' +
    ' vec2 off = vec2(-along.y, along.x) * side - 0.35 * along; a.xy += off * width / resolution * a.w; gl_Position = a; }',
    fragmentShader: 'uniform vec3 colour; void main() { gl_FragColor = vec4(colour, 1.0); }' };
  const lineMaterials = [];
  /// Chains of points as one mesh. @param nearer  share of the distance by which it moves towards the eye
  function lines(group, chains, colour, width, settings) {
    const s = settings || {}, positions = [], others = [], sides = [], indices = [];
    for (const chain of chains)
      for (let i = 0; i + 1 < chain.length; ++i) {
        const a = chain[i], b = chain[i + 1], first = sides.length;
        positions.push(a.x, a.y, a.z, a.x, a.y, a.z, b.x, b.y, b.z, b.x, b.y, b.z);
        others.push(b.x, b.y, b.z, b.x, b.y, b.z, a.x, a.y, a.z, a.x, a.y, a.z);
        sides.push(1, -1, -1, 1);  // seen from the other end, left is right
        indices.push(first, first + 1, first + 2, first + 2, first + 1, first + 3);
      }
    if (!sides.length) return;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
    geometry.setAttribute('other', new THREE.Float32BufferAttribute(others, 3));
    geometry.setAttribute('side', new THREE.Float32BufferAttribute(sides, 1));
    geometry.setIndex(indices);
    const material = new THREE.ShaderMaterial({ ...kLines, transparent: true, side: THREE.DoubleSide, depthTest: s.depthTest !== false,
      uniforms: { colour: { value: new THREE.Color(colour) }, width: { value: width }, nearer: { value: s.nearer || 0 }, resolution: { value: new THREE.Vector2() } } });
    material.userData = { width: width };
    lineMaterials.push(material);
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = s.order || 0;
    group.add(mesh);
  }
  const flat = (numbers) => { const chain = []; for (let i = 0; i + 2 < numbers.length; i += 3) chain.push(V(numbers, i)); return chain; };
  function ball(group, place, radius, colour) {
    const mesh = new THREE.Mesh(ballGeometry, new THREE.MeshBasicMaterial({ color: colour }));
    mesh.position.copy(place);
    mesh.scale.setScalar(radius);
    group.add(mesh);
  }
  const ballGeometry = new THREE.SphereBufferGeometry(1, 24, 16);
  function dashes(a, b, length) {
    const n = Math.min(100, Math.max(3, Math.round(a.distanceTo(b) / (2 * length)))), all = [];
    for (let i = 0; i < n; ++i) all.push([a.clone().lerp(b, i / n), a.clone().lerp(b, (i + 0.5) / n)]);
    return all;
  }
  function arrow(group, from, to, colour, width) {
    const along = to.clone().sub(from), length = along.length(), side = perpendicular(along).multiplyScalar(0.12 * length);
    const neck = from.clone().addScaledVector(along, 0.75);
    lines(group, [[from, to], [neck.clone().add(side), to, neck.clone().sub(side)]], colour, width);
  }
  function perpendicular(v) {
    const n = v.clone().normalize(), other = Math.abs(n.z) < 0.9 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(1, 0, 0);
    return other.cross(n).normalize();
  }
  function label(place, text, colour) {
    if (state.layers.labels) labels.push({ place: place, text: text, colour: colour });
  }

  // Cameras and photographs.
  /// Of a frame: the image plane's edge from top left, the edges from the centre, the tick.
  const cameraLines = (place) => data.frames[place].things.find((t) => t.role === 'camera').chains.map(flat);
  const corners = (place) => cameraLines(place)[0].slice(0, 4);
  /// One camera for each pose: the selected one, else one that sees the surface that is shown.
  function camerasToDraw() {
    const surface = data.frames[state.frame].surface, chosen = new Map();
    poses.forEach((pose, place) => {
      const fitness = (i) => (i === state.frame ? 2 : data.frames[i].surface === surface ? 1 : 0);
      if (!chosen.has(pose.key) || fitness(place) > fitness(chosen.get(pose.key))) chosen.set(pose.key, place);
    });
    return [...chosen.values()];
  }
  const textures = new Map();
  /// Small for all, whole for the camera that is looked through. Null until the picture is decoded.
  function textureOf(place, width) {
    const key = place + '/' + width;
    if (textures.has(key)) return textures.get(key);
    textures.set(key, null);
    if (!data.photographs[place]) return null;
    const image = new Image();
    image.onload = () => {
      const small = document.createElement('canvas');
      small.width = Math.min(width, image.width);
      small.height = Math.max(1, Math.round(image.height * small.width / image.width));
      small.getContext('2d').drawImage(image, 0, 0, small.width, small.height);
      const texture = new THREE.CanvasTexture(small);
      texture.minFilter = THREE.LinearFilter;
      textures.set(key, texture);
      stale = true;
      request();
    };
    image.src = data.photographs[place];
    return null;
  }
  function photographAt(group, place, width, settings) {
    const texture = textureOf(place, width);
    if (!texture) return;
    const c = corners(place), geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute([].concat(...c.map((p) => [p.x, p.y, p.z])), 3));
    geometry.setAttribute('uv', new THREE.Float32BufferAttribute([0, 1, 1, 1, 1, 0, 0, 0], 2));
    geometry.setIndex([0, 2, 1, 0, 3, 2]);
    const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map: texture, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1,
      polygonOffsetUnits: 1, ...settings }));
    mesh.frustumCulled = false;
    if (settings) mesh.renderOrder = 4;
    group.add(mesh);
  }
  const kMostPhotographs = 24;
  function addCameras(group) {
    const drawn = camerasToDraw(), others = { training: [], rest: [] };
    const step = Math.max(1, Math.ceil(drawn.length / kMostPhotographs));
    drawn.forEach((place, order) => {
      const chosen = place === state.frame;
      if (chosen && state.through) return;
      if (state.layers.photographs && !state.through && (chosen || order % step === 0)) photographAt(group, place, 192);
      if (!state.layers.cameras) return;
      const chains = cameraLines(place);
      if (chosen) {
        lines(group, chains, kInk[theme], 2.6);
        label(chains[5][1], 'frame ' + data.frames[place].id, kInk[theme]);
      } else {
        (data.frames[place].role === 'training' ? others.training : others.rest).push(...chains);
      }
    });
    lines(group, others.training, kTraining[theme], 1.7);
    lines(group, others.rest, kOther[theme], 1.1);
  }

  // Everything else: each thing of the drawing (core/draw/scene_drawing.h) by its role.
  const kLayers = { 'virtual-camera': 'virtual-cameras', 'brightest-point': 'peaks', 'tangent-plane': 'tangent-planes', 'canonical-ellipse': 'canonical-ellipses',
    'view-ray': 'rays', 'reflected-ray': 'rays', 'observed-contour': 'observed-contours', 'predicted-contour': 'predicted-contours', ellipsoid: 'ellipsoids',
    light: 'light', 'fitted-lamp': 'light', 'true-lamp': 'true-light' };
  const kContours = ['observed-contour', 'predicted-contour'], kRays = ['view-ray', 'reflected-ray'];
  const kOfOneFrame = [...kContours, 'light', 'fitted-lamp', 'true-lamp', 'ellipsoid'];  // lamps among them stand elsewhere in each frame
  const perSurface = data.evaluation.train_spec === 'per-surface';
  const ofTheme = () => ({ 'virtual-camera': kVirtual, 'view-ray': kLight, 'reflected-ray': kLight, light: kLight, 'true-lamp': kTruth });
  const colourOf = (thing) => (thing.role === 'tangent-plane' ? data.canonical_colour : ofTheme()[thing.role] ? ofTheme()[thing.role][theme] : thing.colour);
  /// Pale where a ray starts on a surface that is not shown, or not there.
  function rayColour(thing, place) {
    if (data.frames[place].surface === data.frames[state.frame].surface) return colourOf(thing);
    return new THREE.Color(colourOf(thing)).lerp(new THREE.Color(kGround[theme]), 0.5);
  }
  const placeOfThing = (thing) => V(thing.place).divideScalar(thing.place[3]);
  /// Pieces of chains: `on` of every `of` segments.
  const pieces = (chains, on, of) => [].concat(...chains.map((c) => c.slice(1).map((p, i) => [c[i], p]).filter((s, i) => i % of < on)));
  /// With its frame: those of the selected frame, those of frames that train on the surface that is shown, rays of all that share a light with it, and
  /// those of the whole scene.
  function thingsToDraw() {
    const shown = data.frames[state.frame].surface, key = data.surfaces[shown] && data.surfaces[shown].key, all = [];
    data.frames.forEach((frame, place) => {
      const trains = frame.role === 'training' && !state.through, drawn = (thing) => place === state.frame ||
          (trains && (frame.surface === shown ? !kOfOneFrame.includes(thing.role) : !perSurface && kRays.includes(thing.role)));
      for (const thing of frame.things) if (drawn(thing)) all.push([place, thing]);
    });
    for (const thing of data.things) if (thing.surface === undefined || thing.surface === key) all.push([-1, thing]);
    return all.filter(([, thing]) => state.layers[kLayers[thing.role]] && !state.hiddenModels.has(thing.model));
  }
  function addDisc(group, thing, chosen) {
    const mesh = new THREE.Mesh(new THREE.CircleBufferGeometry(thing.radius, 64), new THREE.MeshBasicMaterial({ color: colourOf(thing), transparent: true,
      opacity: chosen ? 0.34 : 0.16, side: THREE.DoubleSide, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -8 }));
    mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), V(thing.normal));
    mesh.position.copy(placeOfThing(thing));
    mesh.renderOrder = 3;
    group.add(mesh);
  }
  function addStar(group, thing, size, colour) {
    const place = placeOfThing(thing), star = [];
    ball(group, place, size, colour);
    for (let i = 0; i < 27; ++i) {
      const d = new THREE.Vector3(i % 3 - 1, Math.floor(i / 3) % 3 - 1, Math.floor(i / 9) - 1).normalize();
      if (i !== 13) star.push([place.clone().addScaledVector(d, 1.4 * size), place.clone().addScaledVector(d, 2.4 * size)]);
    }
    lines(group, star, colour, 1.4);
    label(place, thing.label, colour);
    extent.push(place);
  }
  function addOutline(group, chains, colour, width) {
    const closed = (c) => c[0].equals(c[c.length - 1]);
    lines(group, chains.filter((c) => !closed(c)), colour, 4);
    lines(group, chains.filter(closed), colour, width);
  }
  function addBody(group, thing, chains) {
    const m = thing.ball, matrix = new THREE.Matrix4().set(...m[0], ...m[1], ...m[2], 0, 0, 0, 1), middle = placeOfThing(thing);
    for (const order of [0, 5]) {  // behind the surface, and before it
      const mesh = new THREE.Mesh(ballGeometry, new THREE.MeshBasicMaterial({ color: thing.colour, transparent: true, opacity: thing.poor ? 0.07 : 0.13, depthWrite: false }));
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(matrix);
      mesh.renderOrder = order;
      group.add(mesh);
    }
    lines(group, thing.poor ? pieces(chains, 2, 4) : chains, thing.colour, 1.6);
    const axes = [0, 1, 2].map((i) => new THREE.Vector3().setFromMatrixColumn(matrix, i));
    if (2 * Math.max(...axes.map((a) => a.length())) <= sceneSize) for (const axis of axes) extent.push(middle.clone().add(axis), middle.clone().sub(axis));
    label(middle.clone().add(axes[0]), thing.label, thing.colour);
  }
  const kPaint = {
    'virtual-camera'(group, thing, chains, chosen, place) {
      lines(group, chains, colourOf(thing), chosen ? 2.4 : 1.1);
      if (!chosen) return;
      if (!state.through) lines(group, dashes(poses[place].centre, placeOfThing(thing), 0.012 * sceneSize), colourOf(thing), 1.1);
      label(placeOfThing(thing), thing.label, colourOf(thing));
    },
    'tangent-plane'(group, thing, chains, chosen) {
      if (!thing.radius || !(chosen || state.layers['all-planes'])) return;
      addDisc(group, thing, chosen);
      lines(group, chains, colourOf(thing), chosen ? 1.4 : 0.8, { nearer: 0.002, order: 3 });
    },
    'canonical-ellipse'(group, thing, chains, chosen) {
      if (chosen || state.layers['all-planes']) lines(group, chains, thing.colour, chosen ? 2.6 : 1.4, { nearer: 0.004, order: 5 });
    },
    'brightest-point'(group, thing, chains, chosen) {
      const at = placeOfThing(thing);
      ball(group, at, (chosen ? 1.2 : 0.7) * point, theme === 'dark' ? '#ffffff' : '#303030');
      if (chosen) arrow(group, at, at.clone().addScaledVector(V(thing.normal), 0.16 * surfaceSize), kInk[theme], 2);
    },
    'view-ray'(group, thing, chains, chosen, place) { lines(group, chains, rayColour(thing, place), chosen ? 2 : 1); },
    'reflected-ray'(group, thing, chains, chosen, place) {
      lines(group, chains, rayColour(thing, place), chosen ? 2 : 1);
      extent.push(chains[0][1]);
    },
    'observed-contour'(group, thing, chains) {
      lines(group, chains, '#1f2126', 4.6, { nearer: 0.0050, order: 6 });
      lines(group, chains, thing.colour, 2.8, { nearer: 0.0052, order: 6 });
    },
    'predicted-contour'(group, thing, chains) {
      lines(group, thing.gap ? pieces(chains, 1, 3) : thing.poor ? pieces(chains, 2, 4) : chains, thing.colour, 2.2, { nearer: 0.0053 + 0.0001 * data.models.findIndex((m) => m.id === thing.model), order: 6 });
    },
    ellipsoid(group, thing, chains) { addBody(group, thing, chains); },
    light(group, thing) { addStar(group, thing, 1.7 * point, colourOf(thing)); },
    'fitted-lamp'(group, thing, chains) {
      addOutline(group, chains, thing.colour, 1.4);
      addStar(group, thing, 1.2 * point, thing.colour);
    },
    'true-lamp'(group, thing, chains) {
      addOutline(group, chains, colourOf(thing), 2);
      label(chains[chains.length - 1][0], thing.label, colourOf(thing));
      extent.push(placeOfThing(thing));
    },
  };
  function addThings(group) {
    for (const [place, thing] of thingsToDraw()) {
      if (thing.shared) continue;  // the estimate is drawn there
      if (thing.problem) {
        remarks.push(thing.model + ': ' + thing.problem + '.');
      } else if (thing.arrow) {
        const [from, to] = flat(thing.arrow);
        arrow(group, from, to, colourOf(thing), 2.4);
        label(to, thing.label, colourOf(thing));
        extent.push(to);
      } else {
        kPaint[thing.role](group, thing, (thing.chains || []).map(flat), place === state.frame, place);
      }
    }
  }

  // The picture.
  let content = null, extent = [], stale = false;
  function release(group) {
    group.traverse((object) => {
      if (object.geometry && object.geometry !== ballGeometry && !surfaces.some((s) => s.geometry === object.geometry)) object.geometry.dispose();
      if (object.material && object.material !== depthOnly && object.material !== surfaceLook) object.material.dispose();
    });
    scene.remove(group);
  }
  function rebuild() {
    if (!state) return;
    if (content) release(content);
    content = new THREE.Group();
    lineMaterials.length = labels.length = remarks.length = extent.length = 0;
    const surface = surfaces[data.frames[state.frame].surface];
    if (state.layers.surface && surface && surface.geometry)
      [depthOnly, surfaceLook].forEach((material, order) => {
        const mesh = new THREE.Mesh(surface.geometry, material);
        mesh.renderOrder = 1 + order;
        content.add(mesh);
      });
    if (state.through) photographAt(content, state.frame, 2048, { transparent: true, opacity: 0.5, depthTest: false, depthWrite: false });
    addCameras(content);
    addThings(content);
    scene.add(content);
    stale = false;
    request();
  }

  // Where the eye is.
  const up = upOfScene(), look = { target: new THREE.Vector3(), distance: 1, azimuth: 0, height: 0 };
  const east = perpendicular(up), north = up.clone().cross(east);
  /// Photographers keep the camera level: the mean of their upward directions, and the axis of the world where one is near.
  function upOfScene() {
    if (data.view.up) return V(data.view.up).normalize();
    const mean = new THREE.Vector3();
    for (const pose of poses) mean.add(pose.up);
    if (mean.length() < 1e-6) return new THREE.Vector3(0, 0, 1);
    mean.normalize();
    const axes = [0, 1, 2].map((i) => new THREE.Vector3().setComponent(i, Math.sign(mean.getComponent(i)) || 1));
    const nearest = axes.reduce((a, b) => (b.dot(mean) > a.dot(mean) ? b : a));
    return nearest.dot(mean) > Math.cos(Math.PI * 50 / 180) ? nearest : mean;
  }
  const backOf = () => east.clone().multiplyScalar(Math.cos(look.height) * Math.cos(look.azimuth))
    .addScaledVector(north, Math.cos(look.height) * Math.sin(look.azimuth)).addScaledVector(up, Math.sin(look.height));
  function setBack(back) {
    const b = back.clone().normalize();
    look.height = Math.asin(Math.max(-1, Math.min(1, b.dot(up))));
    look.azimuth = Math.atan2(b.dot(north), b.dot(east));
  }
  /// The whole scene, from beside the cameras: they look at the surface, and one looks at both.
  function reset() {
    if (data.view.position) {
      look.target.copy(V(data.view.focal_point));
      const back = V(data.view.position).sub(look.target);
      look.distance = back.length();
      setBack(back);
    } else {
      const mean = new THREE.Vector3();
      for (const pose of poses) mean.add(pose.centre);
      mean.divideScalar(poses.length).sub(centre);
      const level = mean.clone().addScaledVector(up, -mean.dot(up));
      if (level.length() < 0.05 * sceneSize) level.copy(east);
      level.normalize().applyAxisAngle(up, -0.9);
      setBack(level.addScaledVector(up, 0.36));
    }
    frame();
    request();
  }
  function frame() {
    const back = backOf(), right = up.clone().cross(back).normalize(), above = back.clone().cross(right);
    const points = [...extent];
    for (const box of [surfaceBox]) for (let i = 0; i < 8; ++i) points.push(new THREE.Vector3(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z));
    if (state.layers.cameras || state.layers.rays) for (const place of camerasToDraw()) points.push(poses[place].centre, ...corners(place));
    const mirrored = data.coordinates.moves && state.layers['virtual-cameras'] ? data.frames.flatMap((f) => f.things) : thingsToDraw().map(([, thing]) => thing);
    for (const thing of mirrored) if (thing.role === 'virtual-camera') points.push(placeOfThing(thing), ...flat(thing.chains[0]));
    const high = Math.tan(eye.fov * Math.PI / 360), wide = high * aspect(), kMargin = 1.1;
    // The middle of what is seen, found by a few steps, because far points count less.
    const middle = new THREE.Box3().setFromPoints(points).getCenter(new THREE.Vector3());
    for (let round = 0; round < 8; ++round) {
      let distance = 0;
      for (const p of points) {
        const d = p.clone().sub(middle);
        distance = Math.max(distance, d.dot(back) + kMargin * Math.max(Math.abs(d.dot(right)) / wide, Math.abs(d.dot(above)) / high));
      }
      look.distance = Math.max(distance, 1e-9);
      const seen = [Infinity, -Infinity, Infinity, -Infinity];
      for (const p of points) {
        const d = p.clone().sub(middle), z = Math.max(look.distance - d.dot(back), 1e-9), x = d.dot(right) / z, y = d.dot(above) / z;
        seen[0] = Math.min(seen[0], x); seen[1] = Math.max(seen[1], x); seen[2] = Math.min(seen[2], y); seen[3] = Math.max(seen[3], y);
      }
      middle.addScaledVector(right, 0.5 * (seen[0] + seen[1]) * look.distance).addScaledVector(above, 0.5 * (seen[2] + seen[3]) * look.distance);
    }
    look.target.copy(middle);
  }
  const aspect = () => Math.max(canvas.clientWidth, 1) / Math.max(canvas.clientHeight, 1);
  function poseEye() {
    const near = 0.02 * (state.through ? depth : look.distance), far = 40 * sceneSize + 4 * look.distance;
    if (state.through) {
      const c = data.frames[state.frame].camera, scale = Math.min(canvas.clientWidth / c.width, canvas.clientHeight / c.height);
      const w = canvas.clientWidth / scale, h = canvas.clientHeight / scale, left = (c.width - 1 - w) / 2, top = (c.height - 1 - h) / 2;
      eye.matrix.copy(poses[state.frame].worldFromCam).multiply(new THREE.Matrix4().makeScale(1, -1, -1));
      eye.projectionMatrix.set(2 * c.fx / w, -2 * c.skew / w, 1 - 2 * (c.cx - left) / w, 0, 0, 2 * c.fy / h, 2 * (c.cy - top) / h - 1, 0,
        0, 0, -(far + near) / (far - near), -2 * far * near / (far - near), 0, 0, -1, 0);
    } else {
      const back = backOf(), right = up.clone().cross(back).normalize(), above = back.clone().cross(right);
      eye.matrix.makeBasis(right, above, back).setPosition(look.target.clone().addScaledVector(back, look.distance));
      eye.near = near;
      eye.far = far;
      eye.aspect = aspect();
      eye.updateProjectionMatrix();
    }
    eye.projectionMatrixInverse.getInverse(eye.projectionMatrix);
    eye.matrixWorldNeedsUpdate = true;
    eye.updateMatrixWorld(true);
  }
  /// CSS px from the canvas' corner; null behind the eye.
  function placeOf(p) {
    const v = p.clone().applyMatrix4(eye.matrixWorldInverse);
    if (v.z >= 0) return null;
    v.applyMatrix4(eye.projectionMatrix);
    return [(v.x + 1) / 2 * canvas.clientWidth, (1 - v.y) / 2 * canvas.clientHeight];
  }

  // Names: beside their places, off each other and inside the picture.
  function showLabels() {
    labelBox.textContent = '';
    const taken = [], width = canvas.clientWidth, height = canvas.clientHeight;
    for (const l of labels) {
      const at = placeOf(l.place);
      if (!at || at[0] < 0 || at[1] < 0 || at[0] > width || at[1] > height) continue;
      const tag = document.createElement('span');
      tag.className = 'label';
      tag.textContent = l.text;
      tag.style.borderLeftColor = l.colour;
      labelBox.appendChild(tag);
      const w = tag.offsetWidth, h = tag.offsetHeight;
      const inside = ([x, y]) => [Math.max(2, Math.min(width - w - 2, x)), Math.max(2, Math.min(height - h - 2, y))];
      const offers = [];
      for (const away of [14, 30, 50, 74]) offers.push([at[0] + away, at[1] - h / 2], [at[0] - away - w, at[1] - h / 2], [at[0] - w / 2, at[1] - away - h / 2], [at[0] - w / 2, at[1] + away - h / 2],
        [at[0] + away, at[1] - away], [at[0] + away, at[1] + away - h / 2]);
      const free = offers.map(inside).find(([x, y]) => taken.every((t) => x + w + 3 < t[0] || x > t[0] + t[2] + 3 || y + h + 1 < t[1] || y > t[1] + t[3] + 1));
      if (!free) { labelBox.removeChild(tag); continue; }
      taken.push([...free, w, h]);
      tag.style.transform = `translate(${free[0]}px, ${free[1]}px)`;
    }
  }
  function draw() {
    asked = false;
    if (!state || !canvas.clientWidth) return;
    if (stale) rebuild();
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    renderer.setPixelRatio(ratio);
    renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
    renderer.setClearColor(kGround[theme]);
    for (const m of lineMaterials) {
      m.uniforms.resolution.value.set(canvas.clientWidth, canvas.clientHeight);
      m.uniforms.width.value = m.userData.width;
    }
    depthOnly.uniforms.opacity.value = surfaceLook.uniforms.opacity.value = opacity;
    poseEye();
    renderer.render(scene, eye);
    showLabels();
    ++drawn;
  }
  let drawn = 0;
  function request() {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  }

  // Mouse, fingers, keys.
  const fingers = new Map();
  let moved = 0;
  function turn(dx, dy) {
    look.azimuth -= 0.008 * dx;
    look.height = Math.max(-1.5, Math.min(1.5, look.height + 0.008 * dy));
  }
  function pan(dx, dy) {
    const back = backOf(), right = up.clone().cross(back).normalize(), above = back.clone().cross(right);
    const unit = 2 * look.distance * Math.tan(eye.fov * Math.PI / 360) / canvas.clientHeight;
    look.target.addScaledVector(right, -dx * unit).addScaledVector(above, dy * unit);
  }
  const zoom = (factor) => { look.distance = Math.max(1e-3 * surfaceSize, Math.min(100 * sceneSize, look.distance * factor)); };
  canvas.addEventListener('pointerdown', (e) => {
    canvas.setPointerCapture(e.pointerId);
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    moved = 0;
  });
  canvas.addEventListener('pointermove', (e) => {
    const last = fingers.get(e.pointerId);
    if (!last) return;
    const dx = e.clientX - last[0], dy = e.clientY - last[1], others = [...fingers].filter(([id]) => id !== e.pointerId).map(([, p]) => p);
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    moved += Math.abs(dx) + Math.abs(dy);
    if (state.through) return;
    if (others.length) {
      const gap = (p) => Math.hypot(p[0] - others[0][0], p[1] - others[0][1]);
      zoom(Math.max(gap(last), 1) / Math.max(gap([e.clientX, e.clientY]), 1));
      pan(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons === 2 || e.buttons === 4) pan(dx, dy);
    else turn(dx, dy);
    request();
  });
  const kClick = 4, kReach = 16;  // px
  canvas.addEventListener('pointerup', (e) => {
    if (fingers.delete(e.pointerId) && moved < kClick && !state.through) {
      const box = canvas.getBoundingClientRect();
      let best = null, least = kReach;
      for (const place of camerasToDraw())
        for (const p of [poses[place].centre, ...corners(place)]) {
          const at = placeOf(p), d = at ? Math.hypot(at[0] - e.clientX + box.left, at[1] - e.clientY + box.top) : Infinity;
          if (d < least) { least = d; best = place; }
        }
      if (best !== null) select(best);
    }
  });
  canvas.addEventListener('pointercancel', (e) => fingers.delete(e.pointerId));
  canvas.addEventListener('contextmenu', (e) => e.preventDefault());
  canvas.addEventListener('wheel', (e) => {
    e.preventDefault();
    if (!state.through) zoom(Math.exp(Math.max(-1, Math.min(1, e.deltaY * 0.0015))));
    request();
  }, { passive: false });
  canvas.addEventListener('keydown', (e) => {
    const steps = { ArrowLeft: [12, 0], ArrowRight: [-12, 0], ArrowUp: [0, 12], ArrowDown: [0, -12] }[e.key];
    if (steps && !state.through) turn(...steps);
    else if (e.key === '+' || e.key === '-') zoom(e.key === '+' ? 0.9 : 1.1);
    else return;
    e.preventDefault();
    request();
  });
  if (window.ResizeObserver) new ResizeObserver(request).observe(canvas);
  else window.addEventListener('resize', request);

  let placed = false;
  return {
    show(next) {
      state = next;
      rebuild();
      if (!placed) reset();
      placed = true;
    },
    reset: reset,
    setTheme(name) { theme = name; rebuild(); },
    setOpacity(value) { opacity = value; rebuild(); },
    notes: () => remarks,
    place(p) { const at = placeOf(V(p)), box = canvas.getBoundingClientRect(); return at ? [at[0] + box.left, at[1] + box.top] : null; },
    drawn: () => drawn,
  };
}
