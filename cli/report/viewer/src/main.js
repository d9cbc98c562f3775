// SPDX-License-Identifier: GPL-3.0-or-later
// The 3-D view of a report: scan, model, regrown tree and leaves with toggles, colours, growth and reading by click.
import {
  Box3, Color, DirectionalLight, Group, HemisphereLight, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { button, checkbox, element, legend, select } from './controls.js';
import { place, readScene } from './data.js';
import { Detail } from './detail.js';
import { listenToKeys } from './keys.js';
import { ground, leafMeshes, scanPoints, shootMesh } from './others.js';
import { read } from './reading.js';
import { Wood } from './wood.js';

function extentOf(set) {
  const box = new Box3();
  const count = set.data.length / 3;
  const at = [0, 0, 0];
  for (let k = 0; k < count; ++k) box.expandByPoint(new Vector3(...place(set, k, at)));
  return box;
}

function start(host) {
  const { colours, layers } = readScene(document);
  const renderer = new WebGLRenderer({ antialias: true });
  const stage = element('div', { class: 'stage' });
  const reading = element('div', { class: 'reading', id: 'reading', role: 'status' });
  reading.hidden = true;
  renderer.domElement.tabIndex = 0;
  renderer.domElement.setAttribute('aria-label', 'Three-dimensional view of the tree: arrows turn, plus and minus zoom, Home shows all, Page Down and Page Up read the cylinders');
  stage.append(renderer.domElement, reading);

  const scene = new Scene();
  scene.background = new Color('#eef0ec');
  scene.add(new HemisphereLight('#ffffff', '#8d8f80', 2.0));
  const sun = new DirectionalLight('#fff6e8', 2.2);
  scene.add(sun, sun.target);
  const camera = new PerspectiveCamera(32, 1, 0.01, 1000);
  camera.up.set(0, 0, 1);
  const orbit = new OrbitControls(camera, renderer.domElement);
  let dragged = false;
  orbit.enableDamping = false;

  // Three places in a row (scan, model, regrown tree), or all on the same foot.
  const parts = {};
  const spots = ['scan', 'model', 'regrown'].map((name) => ({ name, group: new Group(), box: new Box3() }));
  const spot = Object.fromEntries(spots.map((s) => [s.name, s]));
  scene.add(...spots.map((s) => s.group));
  for (const name of ['model', 'regrown']) {
    if (!layers[name]) continue;
    parts[name] = new Wood(layers[name], colours);
    spot[name].group.add(parts[name].mesh);
    spot[name].box.union(extentOf(layers[name].ends));
  }
  if (layers.scan) {
    spot.scan.box.union(extentOf(layers.scan));
    parts.scan = scanPoints(layers.scan, colours.scan, spot.scan.box.max.z);
    spot.scan.group.add(parts.scan);
  }
  if (layers.leaves) {
    parts.leaves = leafMeshes(layers.leaves, colours.leaf);
    const bearer = spot[layers.leaves_on];
    bearer.group.add(parts.leaves);
    bearer.box.union(extentOf(layers.leaves.origins));
    if (layers.shoots) {
      parts.shoots = shootMesh(layers.shoots, colours.bark);
      parts.leaves.add(parts.shoots);
    }
  }
  const present = spots.filter((s) => !s.box.isEmpty());
  const whole = new Box3();
  const arrange = (inRow) => {
    whole.makeEmpty();
    for (const s of present) {
      const left = whole.isEmpty() ? 0 : whole.max.x + 0.08 * (s.box.max.x - s.box.min.x);
      s.group.position.x = inRow ? left - s.box.min.x : 0;
      whole.union(s.box.clone().translate(s.group.position));
    }
  };
  arrange(true);
  const floor = ground(0.6 * Math.max(whole.max.x - whole.min.x, whole.max.y - whole.min.y, 0.2));
  floor.position.set(0.5 * (whole.min.x + whole.max.x), 0.5 * (whole.min.y + whole.max.y), 0);
  scene.add(floor);

  // Drawn only when something changed.
  let due = false;
  const draw = () => {
    if (due) return;
    due = true;
    requestAnimationFrame(() => {
      due = false;
      detail.frame(() => renderer.render(scene, camera));
      if (detail.drawn < 2) draw();
      host.dataset.moving = detail.moving ? 'yes' : 'no';
      host.dataset.detail = String(detail.shown);
      host.dataset.frames = String(Number(host.dataset.frames ?? 0) + 1);
      const { calls, triangles, points, lines } = renderer.info.render;  // what one frame costs
      host.dataset.cost = JSON.stringify({ calls, triangles, points, lines, ms: Math.round(10 * detail.took) / 10 });
    });
  };
  const resize = (factor = 1) => {
    const { clientWidth: width, clientHeight: height } = stage;
    renderer.setPixelRatio(factor * Math.min(window.devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / Math.max(1, height);
    camera.updateProjectionMatrix();
    if (parts.scan) parts.scan.material.uniforms.pixels.value = 0.5 * height * renderer.getPixelRatio();
    for (const wood of [parts.model, parts.regrown]) if (wood) wood.pixel.value = (2 * Math.tan((0.5 * camera.fov * Math.PI) / 180)) / Math.max(1, height);
    draw();
  };
  const detail = new Detail(renderer, Object.values(parts), resize, draw);
  let looking;  // the direction of the last look(), until the user turns or zooms
  const look = (from) => {
    const middle = whole.getCenter(new Vector3());
    const size = whole.getSize(new Vector3());
    const half = Math.tan((0.5 * camera.fov * Math.PI) / 180);
    const flat = Math.hypot(size.x, size.y);
    const tall = from.z > 0.9 ? flat : size.z;
    const across = Math.abs(from.x) > 0.9 ? size.y : size.x;
    const distance = 1.08 * Math.max(0.5 * tall / half, (0.5 * across) / (half * camera.aspect)) + 0.3 * Math.min(size.x, size.y);
    orbit.target.copy(middle);
    camera.position.copy(middle).addScaledVector(from, Math.max(distance, 0.05));
    camera.near = distance / 200;
    camera.far = distance * 20;
    camera.updateProjectionMatrix();
    sun.position.copy(middle).add(new Vector3(-0.6, -0.7, 1).multiplyScalar(distance));
    sun.target.position.copy(middle);
    orbit.update();
    looking = from;
    draw();
  };
  const slanted = new Vector3(0, -0.985, 0.17);
  orbit.addEventListener('start', () => { dragged = true; looking = undefined; });
  orbit.addEventListener('end', () => { dragged = false; });
  orbit.addEventListener('change', () => {
    if (dragged) detail.moved();
    draw();
  });

  const bar = element('div', { class: 'bar', id: 'layers', role: 'group', 'aria-label': 'Layers' });
  const toggle = (key, words, object, checked = true) => {
    if (!object) return;
    object.visible = checked;
    bar.append(checkbox(`layer-${key}`, words, checked, (on) => { object.visible = on; draw(); }));
  };
  toggle('scan', 'Scan', parts.scan);
  toggle('model', 'Cylinders', parts.model?.mesh);
  toggle('regrown', 'Regrown tree', parts.regrown?.mesh);
  toggle('leaves', 'Leaves', parts.leaves);
  toggle('ground', 'Ground', floor);
  if (present.length > 1) bar.append(checkbox('row', 'Side by side', true, (on) => { arrange(on); look(slanted); }));

  const key = element('div', { class: 'bar', id: 'colour-key' });
  const paint = (mode) => {
    for (const wood of [parts.model, parts.regrown]) wood?.colourBy(mode);
    const ramp = (low, high) => [[colours.ramp[0], low], [colours.ramp[5], ''], [colours.ramp.at(-1), high]];
    const highest = [parts.model, parts.regrown].reduce((most, wood) => Math.max(most, wood ? wood.data.order.reduce((m, o) => Math.max(m, o), 0) : 0), 0);
    const last = colours.order.length - 1;
    const rows = {
      order: colours.order.slice(0, highest + 1).map((c, k) => [c, k === 0 ? 'stem' : k === last && highest > last ? `order ${k} and up` : `order ${k}`]),
      quality: colours.quality.map(([word, c]) => [c, `${word} radius`]),
      radius: ramp('thin', 'thick'),
      birth: ramp('old wood', 'young wood'),
      bark: [[colours.bark, 'wood']],
    };
    key.replaceChildren(...legend(rows[mode]));
    draw();
  };
  const grows = parts.regrown && parts.regrown.lastCycle > parts.regrown.firstCycle;
  const modes = [['order', 'branch order'], ['quality', 'radius quality'], ['radius', 'radius'], ['bark', 'bark']];
  if (grows) modes.splice(3, 0, ['birth', 'age of wood']);
  if (parts.model || parts.regrown) bar.append(select('colour', 'Colour by ', modes, paint));
  bar.append(element('span', { class: 'views' },
    button('Whole', () => look(slanted), { id: 'look-whole' }),
    button('Side', () => look(new Vector3(1, 0, 0.001)), { id: 'look-side' }),
    button('Top', () => look(new Vector3(0, -0.001, 1)), { id: 'look-top' })));

  const growth = element('div', { class: 'bar', id: 'growth' });
  if (grows) {
    const { regrown } = parts;
    const said = element('output', { id: 'growth-reading', for: 'cycle' });
    const slider = element('input', { type: 'range', id: 'cycle', min: String(regrown.firstCycle), max: String(regrown.lastCycle), step: '1' });
    const show = () => {
      const cycle = Number(slider.value);
      regrown.showCycle(cycle);
      if (parts.leaves && layers.leaves_on !== 'model') {
        const full = cycle === regrown.lastCycle;
        parts.leaves.visible = full && (document.getElementById('layer-leaves')?.checked ?? true);
      }
      said.textContent = `cycle ${cycle} of ${regrown.lastCycle}: ${regrown.shown.toLocaleString('en')} internodes, ${regrown.heightShown().toFixed(2)} m high`;
      draw();
    };
    slider.addEventListener('input', show);
    let timer;
    const play = button('Grow', () => {
      clearInterval(timer);
      slider.value = slider.min;
      show();
      const pause = Math.max(30, Math.min(400, 6000 / (regrown.lastCycle - regrown.firstCycle)));
      timer = setInterval(() => {
        slider.stepUp();
        show();
        if (slider.value === slider.max) clearInterval(timer);
      }, pause);
    }, { id: 'grow' });
    slider.addEventListener('pointerdown', () => clearInterval(timer));
    slider.value = slider.max;
    growth.append(element('label', { for: 'cycle' }, 'Growth', slider), play, said);
    host.growth = show;
    show();
  }

  const ray = new Raycaster();
  const woods = [['Model', parts.model, spot.model.group], ['Regrown', parts.regrown, spot.regrown.group]].filter(([, wood]) => wood);
  let current;  // the cylinder that is read: { words, wood, index }
  const tell = (next) => {
    for (const [, wood] of woods) wood.mark(undefined);
    current = next;
    reading.hidden = !next;
    if (next) read(reading, next.words, next.wood, next.index, colours);
    draw();
  };
  const pick = (x, y) => {
    const frame = renderer.domElement.getBoundingClientRect();
    ray.setFromCamera(new Vector2((2 * (x - frame.left)) / frame.width - 1, 1 - (2 * (y - frame.top)) / frame.height), camera);
    const slack = (3 * 2 * Math.tan((0.5 * camera.fov * Math.PI) / 180)) / frame.height;  // three pixels
    let best;
    for (const [words, wood, group] of woods) {
      if (!wood.mesh.visible) continue;
      const met = wood.meet(ray.ray.origin.clone().sub(group.position), ray.ray.direction, slack);
      if (met && (!best || met.distance < best.distance)) best = { ...met, words, wood };
    }
    tell(best);
  };
  listenToKeys(renderer.domElement, camera, orbit, {
    whole: () => look(slanted),
    leave: () => tell(undefined),
    moved: () => { looking = undefined; detail.moved(); },
    step: (by) => {
      const [words, wood] = current ? [current.words, current.wood] : woods.find(([, w]) => w.mesh.visible) ?? [];
      if (!wood) return;
      tell({ words, wood, index: current ? (current.index + by + wood.shown) % wood.shown : 0 });
    },
  });
  let pressed;
  renderer.domElement.addEventListener('pointerdown', (e) => { pressed = [e.clientX, e.clientY]; });
  renderer.domElement.addEventListener('pointerup', (e) => {
    if (pressed && Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) < 5 && e.button === 0) pick(e.clientX, e.clientY);
  });

  host.replaceChildren(bar, stage, key, ...(growth.childElementCount ? [growth] : []));
  new ResizeObserver(() => {
    resize(detail.factor);
    if (looking) look(looking);  // another window or a turned phone: the whole again
  }).observe(stage);
  resize();
  if (parts.model || parts.regrown) paint('order');
  look(slanted);
  host.dataset.state = 'ready';
}

const host = document.getElementById('viewer');
try {
  start(host);
} catch (fault) {
  host.dataset.state = 'failed';
  host.replaceChildren(element('p', { class: 'missing' },
    `The 3-D view could not start in this browser (${fault?.message ?? fault}). The picture below shows the same.`));
}
