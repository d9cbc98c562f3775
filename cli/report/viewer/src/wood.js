// SPDX-License-Identifier: GPL-3.0-or-later
// A tree's cylinders as one mesh: colours, growth through the cycles, and which one a ray meets. One mesh of all their
// vertices, not instances: cylinders have so few vertices that an instance costs more than it saves, above all where
// there is no graphics card.
import { BufferAttribute, BufferGeometry, Mesh, MeshLambertMaterial, Vector3 } from 'three';
import { place } from './data.js';

const SIDES = 8;         // of a cylinder; every second one while there is little time
const RING = 2 * SIDES;  // vertices of a cylinder: about its start, then about its end

/// Two triangles a side, every `step`-th corner of the rings.
function faces(count, step) {
  const sides = SIDES / step;
  const index = new Uint32Array(6 * sides * count);
  let at = 0;
  for (let i = 0; i < count; ++i)
    for (let k = 0; k < SIDES; k += step) {
      const a = RING * i + k;
      const b = RING * i + ((k + step) % SIDES);
      index.set([a, b, a + SIDES, b, b + SIDES, a + SIDES], at);
      at += 6;
    }
  return new BufferAttribute(index, 1);
}

export class Wood {
  constructor(data, colours) {
    this.data = data;
    this.colours = colours;
    this.count = data.radius.length;
    this.start = new Float32Array(3 * this.count);
    this.end = new Float32Array(3 * this.count);
    const at = [0, 0, 0];
    for (let i = 0; i < this.count; ++i) {
      this.start.set(place(data.ends, 2 * i, at), 3 * i);
      this.end.set(place(data.ends, 2 * i + 1, at), 3 * i);
    }
    this.radius = Float32Array.from(data.radius);  // as drawn; changes with the growth slider
    this.shown = this.count;
    this.lastCycle = data.birth.reduce((most, b) => Math.max(most, b), -1);
    this.firstCycle = data.birth.reduce((least, b) => (b >= 0 ? Math.min(least, b) : least), this.lastCycle);
    this.mesh = this.build();
    this.applyRadii();
    this.colourBy('order');
  }

  build() {
    const axis = new Float32Array(3 * RING * this.count);  // each vertex on the axis, its radius from there
    const around = new Int8Array(4 * RING * this.count);
    this.own = new BufferAttribute(new Float32Array(RING * this.count), 1);
    this.colour = new BufferAttribute(new Uint8Array(4 * RING * this.count), 4, true);
    const a = new Vector3();
    const b = new Vector3();
    const along = new Vector3();
    const u = new Vector3();
    const v = new Vector3();
    for (let i = 0; i < this.count; ++i) {
      a.fromArray(this.start, 3 * i);
      b.fromArray(this.end, 3 * i);
      along.subVectors(b, a);
      const length = Math.max(along.length(), 1e-6);
      along.divideScalar(length);
      // A little overlap hides the gaps where neighbours bend; branches are sunk into their parent.
      const over = Math.min(0.35 * this.data.radius[i], 0.5 * length);
      const sunk = this.data.continues[i] || this.data.parent[i] < 0 ? 0 : this.data.radius[i];
      a.addScaledVector(along, -sunk);
      b.addScaledVector(along, over);
      u.set(0, 0, 0).setComponent(Math.abs(along.x) < 0.7 ? 0 : 1, 1).cross(along).normalize();
      v.crossVectors(along, u);
      for (let k = 0; k < RING; ++k) {
        const at = RING * i + k;
        (k < SIDES ? a : b).toArray(axis, 3 * at);
        const turn = (2 * Math.PI * k) / SIDES;
        for (let c = 0; c < 3; ++c)
          around[4 * at + c] = Math.round(127 * (u.getComponent(c) * Math.cos(turn) + v.getComponent(c) * Math.sin(turn)));
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(axis, 3));
    geometry.setAttribute('normal', new BufferAttribute(around, 4, true));
    geometry.setAttribute('own', this.own);
    geometry.setAttribute('shade', this.colour);
    this.fine = faces(this.count, 1);
    this.coarse = faces(this.count, 2);
    const material = new MeshLambertMaterial({ side: 2 });
    this.pixel = { value: 0.001 };  // metres a pixel at one metre's distance
    // A vertex stands off the axis by the cylinder's radius there, or by most of a pixel where that is more: thin twigs
    // stay whole. Colours are sRGB, as written.
    material.onBeforeCompile = (shader) => {
      shader.uniforms.pixel = this.pixel;
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nattribute float own; attribute vec4 shade; uniform float pixel; varying vec3 tint;')
        .replace('#include <begin_vertex>',
          `float away = -(modelViewMatrix * vec4(position, 1.0)).z;
          vec3 transformed = position + normal * max(own, 0.4 * pixel * away);
          tint = mix(shade.rgb / 12.92, pow((shade.rgb + 0.055) / 1.055, vec3(2.4)), step(0.04045, shade.rgb));`);
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', '#include <common>\nvarying vec3 tint;')
        .replace('#include <color_fragment>', 'diffuseColor.rgb *= tint;');
    };
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    this.use(mesh, this.fine);
    return mesh;
  }

  use(mesh, index) {
    mesh.geometry.setIndex(index);
    mesh.geometry.setDrawRange(0, (index.count / Math.max(1, this.count)) * this.shown);
  }

  /// Fewer sides while there is little time; never fewer cylinders.
  setDetail(share) {
    this.use(this.mesh, share < 0.5 ? this.coarse : this.fine);
  }

  applyRadii() {
    for (let i = 0; i < this.count; ++i) {
      const parent = this.data.parent[i];
      const joined = this.data.continues[i] && parent >= 0;
      const from = RING * i;
      this.own.array.fill(joined ? 0.5 * (this.radius[i] + this.radius[parent]) : this.radius[i], from, from + SIDES);
      this.own.array.fill(this.radius[i], from + SIDES, from + RING);
    }
    this.own.needsUpdate = true;
  }

  setColour(i, words) {
    const value = Number.parseInt(words.slice(1), 16);
    const rgba = [value >> 16, (value >> 8) & 255, value & 255, 255];
    for (let k = 0; k < RING; ++k) this.colour.array.set(rgba, 4 * (RING * i + k));
  }

  /// Wood born up to `cycle`. Radii follow the pipe rule: a cylinder's cross-section is to its final one as the ends
  /// it carries then are to those it carries at last.
  showCycle(cycle) {
    const { birth, parent } = this.data;
    this.shown = 0;
    while (this.shown < this.count && birth[this.shown] <= cycle) ++this.shown;
    const ends = (upTo) => {
      const carried = new Float32Array(this.count);
      const bears = new Uint8Array(this.count);
      for (let i = 0; i < upTo; ++i) if (parent[i] >= 0) bears[parent[i]] = 1;
      for (const i of this.childrenFirst()) {
        if (i >= upTo) continue;
        if (!bears[i]) carried[i] = 1;
        if (parent[i] >= 0) carried[parent[i]] += carried[i];
      }
      return carried;
    };
    this.finalEnds ??= ends(this.count);
    const now = ends(this.shown);
    for (let i = 0; i < this.count; ++i) {
      const share = Math.min(1, now[i] / Math.max(1, this.finalEnds[i]));
      this.radius[i] = this.data.radius[i] * Math.sqrt(i < this.shown ? Math.max(share, 1e-4) : 1);
    }
    this.applyRadii();
    this.use(this.mesh, this.mesh.geometry.index);
  }

  /// Indices so that every child comes before its parent (the arrays are sorted by birth, not by descent).
  childrenFirst() {
    if (this.upward) return this.upward;
    const depth = new Int32Array(this.count).fill(-1);
    const trail = [];
    for (let i = 0; i < this.count; ++i) {
      for (let k = i; k >= 0 && depth[k] < 0; k = this.data.parent[k]) trail.push(k);
      while (trail.length) {
        const k = trail.pop();
        depth[k] = this.data.parent[k] < 0 ? 0 : depth[this.data.parent[k]] + 1;
      }
    }
    this.upward = Array.from(depth.keys()).sort((a, b) => depth[b] - depth[a]);
    return this.upward;
  }

  heightShown() {
    let top = 0;
    for (let i = 0; i < this.shown; ++i) top = Math.max(top, this.end[3 * i + 2], this.start[3 * i + 2]);
    return top;
  }

  colourOf(i, mode) {
    const { order, quality, radius, birth } = this.data;
    const { colours } = this;
    const ramp = (share) => colours.ramp[Math.round(Math.min(1, Math.max(0, share)) * (colours.ramp.length - 1))];
    if (mode === 'order') return colours.order[Math.min(order[i], colours.order.length - 1)];
    if (mode === 'quality') return colours.quality[quality[i]][1];
    if (mode === 'radius') return ramp((Math.log(radius[i]) - this.logLo) / Math.max(1e-9, this.logHi - this.logLo));
    if (mode === 'birth' && birth[i] >= 0) return ramp((birth[i] - this.firstCycle) / Math.max(1, this.lastCycle - this.firstCycle));
    return colours.bark;
  }

  colourBy(mode) {
    const sorted = Float32Array.from(this.data.radius).sort();
    this.logLo = Math.log(sorted[Math.floor(0.02 * (this.count - 1))]);
    this.logHi = Math.log(sorted[Math.floor(0.98 * (this.count - 1))]);
    for (let i = 0; i < this.count; ++i) this.setColour(i, this.colourOf(i, mode));
    this.colour.needsUpdate = true;
    this.mode = mode;
  }

  mark(i) {
    if (this.marked !== undefined) this.setColour(this.marked, this.colourOf(this.marked, this.mode));
    this.marked = i;
    if (i !== undefined) this.setColour(i, '#ffe100');
    this.colour.needsUpdate = true;
  }

  /// The nearest cylinder within its radius (or `slack` metres a metre of distance, for thin twigs) of the ray, in
  /// this tree's frame: {index, distance}; undefined for none.
  meet(origin, direction, slack) {
    const u = new Vector3();
    const w = new Vector3();
    const a = new Vector3();
    let best;
    for (let i = 0; i < this.shown; ++i) {
      a.fromArray(this.start, 3 * i);
      u.fromArray(this.end, 3 * i).sub(a);
      w.subVectors(origin, a);
      // Closest approach of the ray and the cylinder's axis.
      const uu = u.dot(u);
      const ud = u.dot(direction);
      const uw = u.dot(w);
      const dw = direction.dot(w);
      const denominator = uu - ud * ud;
      let t = denominator > 1e-12 ? (uw - ud * dw) / denominator : 0;
      t = Math.min(1, Math.max(0, t));
      const along = Math.max(0, t * ud - dw);
      const gap = w.addScaledVector(direction, along).addScaledVector(u, -t).length();
      const reach = Math.max(this.radius[i], slack * along);
      if (gap > reach) continue;
      const distance = along - Math.sqrt(Math.max(0, this.radius[i] ** 2 - gap ** 2));
      if (!best || distance < best.distance) best = { index: i, distance };
    }
    return best;
  }
}
