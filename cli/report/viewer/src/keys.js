// SPDX-License-Identifier: GPL-3.0-or-later
// The view by keyboard, while it has the focus: arrows turn, + and - zoom, Home shows the whole, Page Down and Page Up
// go from cylinder to cylinder, Escape ends reading.
import { Spherical, Vector3 } from 'three';

const TURN = Math.PI / 36;
const CLOSER = 0.85;

/// `acts`: { whole(), step(by), leave(), moved() }.
export function listenToKeys(canvas, camera, orbit, acts) {
  // Spherical counts from y; this world's up is z.
  const offset = new Vector3();
  const around = new Spherical();
  const turn = (left, up, closer = 1) => {
    offset.subVectors(camera.position, orbit.target);
    around.setFromVector3(new Vector3(offset.y, offset.z, offset.x));
    around.theta += left;
    around.phi -= up;
    around.radius = Math.min(camera.far, Math.max(2 * camera.near, around.radius * closer));
    around.makeSafe();
    const turned = new Vector3().setFromSpherical(around);
    camera.position.copy(orbit.target).add(new Vector3(turned.z, turned.x, turned.y));
    acts.moved();
    orbit.update();
  };
  const table = {
    ArrowLeft: () => turn(-TURN, 0),
    ArrowRight: () => turn(TURN, 0),
    ArrowUp: () => turn(0, TURN),
    ArrowDown: () => turn(0, -TURN),
    '+': () => turn(0, 0, CLOSER),
    '=': () => turn(0, 0, CLOSER),
    '-': () => turn(0, 0, 1 / CLOSER),
    Home: acts.whole,
    PageDown: () => acts.step(1),
    PageUp: () => acts.step(-1),
    Escape: acts.leave,
  };
  canvas.addEventListener('keydown', (event) => {
    const act = event.ctrlKey || event.metaKey || event.altKey ? undefined : table[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
