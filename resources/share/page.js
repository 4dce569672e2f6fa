// SPDX-License-Identifier: BSD-3-Clause
// The page around the pictures: frames, photograph, tables, lesson. Texts that come from files are set as text, never as mark-up.
(function () {
  'use strict';
  const data = JSON.parse(document.getElementById('data').textContent);
  const evaluation = data.evaluation;
  const at = (id) => document.getElementById(id);
  const state = { frame: data.view.frame, hiddenModels: new Set(), layers: {}, through: false, zoomed: false, step: 0 };

  function element(parent, name, text, className) {
    const e = document.createElement(name);
    if (text !== undefined) e.textContent = text;
    if (className) e.className = className;
    if (parent) parent.appendChild(e);
    return e;
  }
  function svg(parent, name, attributes) {
    const e = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const key in attributes) e.setAttribute(key, attributes[key]);
    parent.appendChild(e);
    return e;
  }
  const isNumber = (v) => typeof v === 'number' && isFinite(v);
  const fixed = (v, digits) => (isNumber(v) ? v.toFixed(digits) : '–');
  const percent = (v) => (isNumber(v) && v > 0 && v < 0.005 ? '< 0.01' : fixed(v, isNumber(v) && v >= 100 ? 0 : 2));
  const colourOf = (id) => (data.models.find((m) => m.id === id) || { colour: '#ffffff' }).colour;
  function swatch(parent, colour) {
    const e = element(parent, 'span', '', 'swatch');
    e.style.background = colour;
  }
  const shortList = (words) => words.slice(0, 8).join(', ') + (words.length > 8 ? ' and ' + (words.length - 8) + ' more' : '');
  const plural = (n, word) => n + ' ' + word + (n === 1 ? '' : 's');

  // What is known of the whole.
  const reasons = { 'own detection': 'Glint\u2019s own detection', 'given contours': 'the contours of the scene file', truth: 'known contours' };
  const scoredAgainst = reasons[evaluation.scored_against] || evaluation.scored_against;
  const perSurface = evaluation.train_spec === 'per-surface';
  function whatIsScored() {
    return (perSurface ? 'All frames are scored, because each surface has its own model of all its frames' :
        'Held-out frames alone are scored; trained on ' + plural(evaluation.train_ids.length, 'frame') + ' (' + shortList(evaluation.train_ids) + ')') +
        '. Scored against ' + scoredAgainst + '.';
  }
  const answers = (e) => e && e.status !== 'failed' && isNumber(e.summary.contour_error_pct.mean);
  /// A poor one counts only where no other answers.
  function best() {
    let found = null;
    const anyOk = data.models.some((m) => answers(evaluation.models[m.id]) && evaluation.models[m.id].status === 'ok');
    for (const model of data.models) {
      const e = evaluation.models[model.id];
      if (!answers(e) || (anyOk && e.status !== 'ok')) continue;
      if (!found || e.summary.predicted > found.summary.predicted || (e.summary.predicted === found.summary.predicted &&
          e.summary.contour_error_pct.mean < found.summary.contour_error_pct.mean)) found = { id: model.id, poor: e.status === 'poor', summary: e.summary };
    }
    return found;
  }
  function coordinates() {
    const { frame, reason, moves } = data.coordinates;
    if (frame === 'camera')
      return 'Drawn in the camera\u2019s coordinates (x right, y down, z forward): there the camera stands still and the object moves. ' +
          reason.charAt(0).toUpperCase() + reason.slice(1) + '.';
    return moves ? 'Drawn in the world\u2019s coordinates: the object moves from frame to frame.' : '';
  }
  function header() {
    at('title').textContent = data.name || 'Glint';
    document.title = 'Glint: ' + (data.name || 'shared scene');
    const top = best();
    at('summary').textContent = plural(data.frames_in_all, 'frame') +
        (data.frames.length < data.frames_in_all ? ', of which this page shows ' + data.frames.length : '') + '. ' + (top ?
        'Smallest mean contour error: ' + top.id + (top.poor ? ' (poor)' : '') + ', ' + percent(top.summary.contour_error_pct.mean) +
        ' % of the highlight\u2019s diameter over the ' + top.summary.matched + ' of ' + plural(top.summary.matched + top.summary.missed, 'highlight') +
        ' that it found.' : 'No model was scored.');
    at('coordinates').textContent = coordinates();
    at('made').textContent = 'Made by ' + (data.program || 'Glint') + ' from ' + data.input + '. This page loads nothing from a network.';
    if (evaluation.warnings.length) {
      at('warnings').hidden = false;
      for (const text of evaluation.warnings) element(at('warning-list'), 'li', text);
    }
  }

  // Tables.
  function modelsTable() {
    at('models-caption').textContent = whatIsScored() + ' Untick a model to hide it in all pictures.';
    const table = at('models');
    const head = element(element(table, 'thead'), 'tr');
    for (const text of ['model', 'predicted', 'mean %', 'median %', 'p95 %', 'max %', 'mean px', 'IoU', 'matched / missed / spurious'])
      element(head, 'th', text);
    const body = element(table, 'tbody');
    for (const model of data.models) {
      const e = evaluation.models[model.id];
      const row = element(body, 'tr');
      const name = element(row, 'td'), label = element(name, 'label');
      label.title = model.title + ': ' + model.assumption;
      const box = element(label, 'input');
      box.type = 'checkbox';
      box.checked = true;
      box.addEventListener('change', () => {
        if (box.checked) state.hiddenModels.delete(model.id); else state.hiddenModels.add(model.id);
        refresh();
      });
      label.append(' ');
      swatch(label, model.colour);
      label.append(model.id);
      if (e && e.status === 'poor') {
        row.className = 'poor';
        name.append(', poor');
        label.title += '\npoor: ' + e.reason;
      }
      if (!e || e.status === 'failed') {
        const cell = element(row, 'td', e ? e.reason : '', 'words problem');
        cell.colSpan = 8;
        continue;
      }
      const s = e.summary;
      element(row, 'td', s.predicted + '/' + s.frames);
      for (const key of ['mean', 'median', 'p95', 'max']) element(row, 'td', percent(s.contour_error_pct[key])).dataset.value = s.contour_error_pct[key];
      element(row, 'td', fixed(s.contour_error_px.mean, 3));
      element(row, 'td', fixed(s.iou.mean, 4));
      element(row, 'td', s.matched + ' / ' + s.missed + ' / ' + s.spurious);
      if (e.status !== 'poor') continue;
      const why = element(element(body, 'tr', undefined, 'poor'), 'td', 'poor: ' + e.reason, 'words');
      why.colSpan = 9;
    }
  }
  /// One cell of a frame: the mean of its highlights, or what went wrong in words.
  function cellOf(model, frame) {
    const rows = ((evaluation.models[model] || {}).frames || []).filter((r) => r.index === frame.index);
    if (!rows.length) return { text: frame.role === 'training' ? 'trains' : frame.role === 'excluded' ? 'excluded' : '–', quiet: true };
    const measured = rows.filter((r) => isNumber(r.contour_error_pct)).map((r) => r.contour_error_pct);
    const wrong = rows.filter((r) => r.status !== 'ok');
    const words = [];
    for (const status of [...new Set(wrong.map((r) => r.status))]) {
      const count = wrong.filter((r) => r.status === status).length;
      words.push(count > 1 && status !== 'poor' ? status + ' ' + count : status);
    }
    const value = measured.length ? measured.reduce((a, b) => a + b, 0) / measured.length : undefined;
    return { text: (value === undefined ? '' : percent(value)) + (value !== undefined && words.length ? ', ' : '') + words.join(', '),
      value: value, problem: wrong.length > 0, title: wrong.map((r) => r.status + (r.reason ? ': ' + r.reason : '')).join('\n') };
  }
  function errorsTable() {
    at('frames-caption').textContent = 'Percent of the equivalent diameter of the observed highlight. Click a row to see its frame.';
    const table = at('errors');
    const head = element(element(table, 'thead'), 'tr');
    element(head, 'th', 'frame');
    for (const model of data.models) swatchFirst(element(head, 'th'), model);
    const body = element(table, 'tbody');
    data.frames.forEach((frame, place) => {
      const row = element(body, 'tr');
      row.dataset.place = place;
      element(row, 'td', frame.id);
      for (const model of data.models) {
        const cell = cellOf(model.id, frame);
        const td = element(row, 'td', cell.text, cell.quiet ? 'quiet' : cell.problem ? 'problem' : '');
        if (cell.value !== undefined) td.dataset.value = cell.value;
        if (cell.title) td.title = cell.title;
      }
      row.addEventListener('click', () => select(place));
    });
  }
  function swatchFirst(parent, model) {
    swatch(parent, model.colour);
    parent.append(model.id);
  }

  // The photograph with what lies over it.
  function boxOfLines(frame) {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (const line of frame.lines.filter((l) => l.model === ''))
      for (let i = 0; i < line.points.length; i += 2) {
        box[0] = Math.min(box[0], line.points[i]);
        box[1] = Math.min(box[1], line.points[i + 1]);
        box[2] = Math.max(box[2], line.points[i]);
        box[3] = Math.max(box[3], line.points[i + 1]);
      }
    return box[0] <= box[2] ? box : null;
  }
  function photograph() {
    const frame = data.frames[state.frame], camera = frame.camera, picture = at('photo');
    while (picture.firstChild) picture.removeChild(picture.firstChild);
    // Integer coordinates are pixel centres, so the image starts half a pixel earlier.
    let view = [-0.5, -0.5, camera.width, camera.height];
    const box = boxOfLines(frame);
    at('zoom').disabled = !box;
    if (state.zoomed && box) {
      const margin = Math.max(12, 0.5 * Math.max(box[2] - box[0], box[3] - box[1]));
      view = [box[0] - margin, box[1] - margin, box[2] - box[0] + 2 * margin, box[3] - box[1] + 2 * margin];
    }
    picture.setAttribute('viewBox', view.join(' '));
    const url = data.photographs[state.frame];
    if (url) svg(picture, 'image', { href: url, x: -0.5, y: -0.5, width: camera.width, height: camera.height, preserveAspectRatio: 'none' });
    at('no-photo').hidden = url !== '' || frame.lines.length > 0;
    at('no-photo').textContent = 'This frame has no photograph.';
    const shown = (model) => (model === '' ? state.layers['observed-contours'] : state.layers['predicted-contours'] && !state.hiddenModels.has(model));
    for (const line of frame.lines) {
      if (!shown(line.model) || line.points.length < 4) continue;
      const attributes = { points: line.points.join(' '), fill: 'none', 'vector-effect': 'non-scaling-stroke', 'stroke-linejoin': 'round' };
      const name = line.closed ? 'polygon' : 'polyline';
      if (line.model === '') svg(picture, name, { ...attributes, stroke: '#1f2126', 'stroke-width': 4.5 });
      const drawn = svg(picture, name, { ...attributes, stroke: line.colour, 'stroke-width': line.model === '' ? 2.5 : 2 });
      if (line.dash) drawn.setAttribute('stroke-dasharray', line.dash === 1 ? '7 4' : line.dash === 2 ? '2 4' : '8 3 2 3');
      svg(drawn, 'title', {}).textContent = line.label || line.model || 'observed';
    }
    const unit = Math.max(view[2], view[3]) / 160;
    for (const mark of frame.marks) {
      if (!state.layers.peaks || (mark.model !== '' && !shown(mark.model))) continue;
      const [x, y] = mark.at;
      const attributes = { stroke: mark.colour, fill: 'none', 'stroke-width': 1.6, 'vector-effect': 'non-scaling-stroke' };
      const drawn = mark.model === '' ?
          svg(picture, 'path', { ...attributes, d: `M${x - unit},${y}H${x + unit}M${x},${y - unit}V${y + unit}` }) :
          svg(picture, 'circle', { ...attributes, cx: x, cy: y, r: 0.7 * unit });
      svg(drawn, 'title', {}).textContent = mark.label;
    }
  }

  // What is said of the frame.
  function captions() {
    const frame = data.frames[state.frame], list = at('captions');
    list.textContent = '';
    for (const caption of frame.captions) {
      const item = element(list, 'li', '', caption.problem ? 'problem' : '');
      swatch(item, caption.model === '' ? '#ffffff' : colourOf(caption.model));
      item.append(caption.text);
    }
    if (!frame.captions.length) element(list, 'li', 'Nothing was observed or predicted in this frame.');
    const role = { training: perSurface ? 'trains and is scored' : 'trains', 'held out': 'held out', excluded: 'excluded' }[frame.role];
    at('frame-name').textContent = 'Frame ' + frame.id + ' (' + (state.frame + 1) + ' of ' + data.frames.length + '), ' + role;
    at('frame-name').title = at('frame-name').textContent;
    at('slider').value = state.frame;
    at('previous').disabled = state.frame === 0;
    at('next').disabled = state.frame === data.frames.length - 1;
    for (const row of at('errors').tBodies[0].rows) row.classList.toggle('chosen', Number(row.dataset.place) === state.frame);
    const chosen = at('errors').tBodies[0].rows[state.frame], scroll = chosen.closest('.scroll');
    const top = chosen.offsetTop, bottom = top + chosen.offsetHeight;  // within its own box: the page itself stays where it is
    if (top < scroll.scrollTop + 30) scroll.scrollTop = Math.max(0, top - 30);
    if (bottom > scroll.scrollTop + scroll.clientHeight) scroll.scrollTop = bottom - scroll.clientHeight;
  }
  function notes() {
    const list = at('notes'), frame = data.frames[state.frame];
    list.textContent = '';
    const surface = data.surfaces[frame.surface];
    if (!surface) element(list, 'li', 'This frame has no surface.');
    else if (surface.problem) element(list, 'li', 'Surface: ' + surface.problem);
    else if (surface.triangles < surface.of) element(list, 'li', `Surface: ${surface.triangles} triangles that stand for ${surface.of}.`);
    for (const note of scene ? scene.notes() : []) element(list, 'li', note);
    const missing = data.lesson ? data.lesson.steps[state.step].layers.filter((id) => kInspectorAlone[id]) : [];
    if (missing.length) element(list, 'li', 'This step has more in the inspector: ' + missing.map((id) => kInspectorAlone[id]).join(', ') + '.');
  }

  // Layers.
  const layerNames = [['surface', 'Surface'], ['cameras', 'Cameras'], ['photographs', 'Small photographs'], ['virtual-cameras', 'Virtual cameras'],
    ['peaks', 'Brightest points, normals'], ['tangent-planes', 'Tangent planes'], ['canonical-ellipses', 'Canonical ellipses'],
    ['ellipsoids', 'Ellipsoids'], ['observed-contours', 'Observed contours'], ['predicted-contours', 'Predicted contours'],
    ['light', 'Light (estimate)'], ['true-light', 'Light (truth)'], ['rays', 'Reflected rays'], ['all-planes', 'Planes of all training frames'], ['labels', 'Names']];
  const kInspectorAlone = { directions: 'walks in every direction', walk: 'one walk, step by step', cones: 'cones to the ellipsoid' };
  const boxes = {};
  function layerSwitches() {
    for (const [id, title] of layerNames) {
      const label = element(at('layers'), 'label');
      const box = element(label, 'input');
      box.type = 'checkbox';
      box.dataset.layer = id;
      label.append(title);
      boxes[id] = box;
      box.addEventListener('change', () => { state.layers[id] = box.checked; refresh(); });
    }
    showLayers((id) => id !== 'rays' && id !== 'all-planes');
  }
  function showLayers(isShown) {
    for (const [id] of layerNames) boxes[id].checked = state.layers[id] = isShown(id);
  }

  // Equations: of a drawing its outlines and the names of its symbols are taken. The plain form stands beside it, unseen, for who copies or listens.
  const kEm = 20;  // units of a drawing: EM of docs/make_equations.py
  const kLarger = 1.3;  // a serif of the same size as the text beside it looks smaller
  const drawings = new Map(data.lesson ? data.lesson.equations.map((e) => [e.plain, e.svg]) : []);
  function copyOutlines(from, to) {
    for (const node of from.children) {
      if (node.nodeName === 'path') svg(to, 'path', { d: node.getAttribute('d') });
      if (node.nodeName !== 'g') continue;
      const group = svg(to, 'g', {}), symbol = node.id.split('.')[0];  // "normal.2" is the second place of "normal"
      if (symbol) {
        group.dataset.symbol = symbol;
        svg(group, 'title', {}).textContent = data.lesson.symbols[symbol] || '';
      }
      copyOutlines(node, group);
    }
  }
  function equation(parent, plain) {
    if (!drawings.has(plain)) {
      parent.append(plain);
      return;
    }
    const source = new DOMParser().parseFromString(drawings.get(plain), 'image/svg+xml').documentElement;
    const box = source.getAttribute('viewBox'), size = box.split(' ').map((v) => kLarger * v / kEm);
    const frame = element(parent, 'span', '', 'typeset');
    frame.setAttribute('role', 'img');
    frame.setAttribute('aria-label', plain);
    copyOutlines(source, svg(frame, 'svg', { viewBox: box, width: size[2] + 'em', height: size[3] + 'em', 'aria-hidden': 'true' }));
    element(frame, 'span', plain, 'plain-form');
  }
  function copyText(text, to) {
    const plain = [...drawings.keys()].find((form) => text.includes(form));
    if (plain === undefined) {
      to.append(text);
      return;
    }
    const start = text.indexOf(plain);
    copyText(text.slice(0, start), to);
    equation(to, plain);
    copyText(text.slice(start + plain.length), to);
  }

  // A lesson's texts may hold <b>, <i>, <sub>, <sup>; of anything else the words alone are taken.
  function copyWords(from, to) {
    for (const node of from.childNodes) {
      if (node.nodeType === Node.TEXT_NODE) copyText(node.textContent, to);
      else if (['B', 'I', 'SUB', 'SUP'].includes(node.nodeName)) copyWords(node, element(to, node.nodeName.toLowerCase()));
      else copyWords(node, to);
    }
  }
  function words(parent, markup) {
    parent.textContent = '';
    copyWords(new DOMParser().parseFromString(markup, 'text/html').body, parent);
  }
  function showStep(place) {
    const steps = data.lesson.steps, step = steps[place];
    state.step = place;
    at('step-count').textContent = 'Step ' + (place + 1) + ' of ' + steps.length;
    words(at('step-title'), step.title);
    words(at('step-text'), step.text);
    at('step-equation').textContent = '';
    equation(at('step-equation'), step.equation);
    words(at('step-remark'), step.remark);
    at('step-back').disabled = place === 0;
    at('step-next').disabled = place === steps.length - 1;
    showLayers((id) => step.layers.includes(id) || id === 'labels' || id === 'observed-contours' || (id === 'photographs' && step.layers.includes('cameras')));
    refresh();
    if (scene && !state.through) scene.reset();
  }
  function lesson() {
    if (!data.lesson) return;
    at('lesson').hidden = false;
    words(at('lesson-title'), 'Lesson: ' + data.lesson.title);
    words(at('lesson-see'), data.lesson.see);
    for (const question of data.lesson.questions) {
      const item = element(at('questions'), 'li');
      words(element(item, 'span'), question.ask);
      const answer = element(item, 'details');
      element(answer, 'summary', 'Answer');
      words(element(answer, 'p'), question.answer);
    }
    at('step-back').addEventListener('click', () => showStep(state.step - 1));
    at('step-next').addEventListener('click', () => showStep(state.step + 1));
  }

  // The scene in 3D, where the browser can.
  let scene = null;
  function startScene() {
    try {
      scene = glintScene(data, at('canvas'), at('labels'), select);
    } catch (problem) {
      at('no-webgl').hidden = false;
      for (const id of ['reset', 'through', 'opacity']) at(id).disabled = true;
    }
  }
  function refresh() {
    if (scene) scene.show(state);
    photograph();
    captions();
    notes();
  }
  function select(place) {
    state.frame = Math.max(0, Math.min(data.frames.length - 1, place));
    refresh();
  }
  function setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    if (scene) scene.setTheme(theme);
  }

  header();
  modelsTable();
  errorsTable();
  layerSwitches();
  lesson();
  startScene();
  const asked = new URLSearchParams(location.hash.slice(1));
  setTheme(asked.get('theme') || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'));
  at('slider').max = data.frames.length - 1;
  at('slider').addEventListener('input', () => select(Number(at('slider').value)));
  at('previous').addEventListener('click', () => select(state.frame - 1));
  at('next').addEventListener('click', () => select(state.frame + 1));
  at('theme').addEventListener('click', () => setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'));
  function toggle(id, key) {
    at(id).addEventListener('click', () => {
      state[key] = !state[key];
      at(id).setAttribute('aria-pressed', state[key]);
      refresh();
    });
  }
  toggle('through', 'through');
  toggle('zoom', 'zoomed');
  at('reset').addEventListener('click', () => {
    if (state.through) at('through').click();
    scene.reset();
  });
  at('opacity').addEventListener('input', () => scene && scene.setOpacity(at('opacity').value / 100));
  document.addEventListener('keydown', (event) => {
    if (event.target.tagName === 'INPUT' || event.altKey || event.ctrlKey || event.metaKey) return;
    if (event.key === 'Escape' && state.through) at('through').click();
    if (event.target === at('canvas')) return;  // turns the view
    if (event.key === 'ArrowLeft') select(state.frame - 1);
    if (event.key === 'ArrowRight') select(state.frame + 1);
  });
  if (data.lesson) showStep(Math.max(0, Math.min(data.lesson.steps.length - 1, Number(asked.get('step') || 1) - 1)));
  select(asked.has('frame') ? Number(asked.get('frame')) : state.frame);
  /// For scripts: the state, and where a world point is in the window (CSS px).
  window.glintPage = { data: data, state: state, select: select, place: (p) => scene && scene.place(p), drawn: () => scene && scene.drawn() };
})();
