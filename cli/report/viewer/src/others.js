// SPDX-License-Identifier: GPL-3.0-or-later
// The scan's points, the leaves, the ground.
import {
  BufferAttribute, BufferGeometry, Color, CylinderGeometry, GridHelper, Group, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry, Points, Quaternion, ShaderMaterial, Vector3,
} from 'three';
import { place } from './data.js';

const UP = new Vector3(0, 1, 0);

/// Quantised positions go to the graphics card as they are; the object's scale turns steps into metres.
export function scanPoints(set, colour, height) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(set.data, 3));
  const material = new ShaderMaterial({
    uniforms: { tint: { value: new Color(colour) }, size: { value: 0.012 }, pixels: { value: 800 }, top: { value: Math.max(height, 0.1) } },
    vertexShader: `
      uniform float size; uniform float pixels; uniform float top; varying float light;
      void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        vec4 seen = viewMatrix * world;
        gl_Position = projectionMatrix * seen;
        gl_PointSize = clamp(size * pixels * projectionMatrix[1][1] / max(0.01, -seen.z), 1.0, 12.0);
        light = 0.62 + 0.5 * clamp(world.z / top, 0.0, 1.0);
      }`,
    fragmentShader: `
      uniform vec3 tint; varying float light;
      void main() {
        if (length(gl_PointCoord - 0.5) > 0.5) discard;
        gl_FragColor = vec4(tint * light, 1.0);
        #include <colorspace_fragment>
      }`,
  });
  const points = new Points(geometry, material);
  points.position.fromArray(set.lo);
  points.scale.fromArray(set.step);
  points.frustumCulled = false;
  // Points come in random order: the first of them are an even sample. Fewer are drawn larger.
  points.setDetail = (share) => {
    const count = set.data.length / 3;
    const shown = Math.min(count, Math.max(8000, Math.round(share * count)));
    geometry.setDrawRange(0, shown);
    material.uniforms.size.value = 0.012 * Math.min(2.5, Math.sqrt(count / Math.max(1, shown)));
  };
  return points;
}

function leafGeometry(shape) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(shape.vertices), 3));
  geometry.setIndex(shape.triangles);
  geometry.computeVertexNormals();
  return geometry;
}

/// Four corners of the blade: foot, widest left, tip, widest right; three numbers each.
function corners(shape) {
  const corner = (better) => {
    let best = 0;
    for (let k = 1; k < shape.vertices.length / 3; ++k) if (better(k, best)) best = k;
    return new Vector3().fromArray(shape.vertices, 3 * best);
  };
  const x = (k) => shape.vertices[3 * k];
  const y = (k) => shape.vertices[3 * k + 1];
  return [corner((a, b) => y(a) < y(b)), corner((a, b) => x(a) > x(b)), corner((a, b) => y(a) > y(b)), corner((a, b) => x(a) < x(b))];
}

/// Some of the leaves as two triangles each, in one mesh without instances: what is drawn while there is little time.
class QuickLeaves {
  constructor(count, colour) {
    this.positions = new Float32Array(12 * count);
    this.normals = new Int8Array(16 * count);
    this.count = 0;
    this.colour = colour;
  }

  add(matrix, shape) {
    shape.corners ??= corners(shape);
    const at = new Vector3();
    shape.corners.forEach((corner, c) => at.copy(corner).applyMatrix4(matrix).toArray(this.positions, 12 * this.count + 3 * c));
    at.setFromMatrixColumn(matrix, 2).normalize();
    for (let c = 0; c < 4; ++c) this.normals.set([127 * at.x, 127 * at.y, 127 * at.z, 0], 16 * this.count + 4 * c);
    ++this.count;
  }

  mesh() {
    const index = new Uint32Array(6 * this.count);
    for (let k = 0; k < this.count; ++k) index.set([0, 1, 2, 0, 2, 3].map((c) => 4 * k + c), 6 * k);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(this.positions, 3));
    geometry.setAttribute('normal', new BufferAttribute(this.normals, 4, true));
    geometry.setIndex(new BufferAttribute(index, 1));
    const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: this.colour, side: 2 }));
    mesh.frustumCulled = false;
    mesh.visible = false;
    return mesh;
  }
}

const QUICK_LEAVES = 40000;

export function leafMeshes(data, colour) {
  const group = new Group();
  const blades = [];
  const quickLeaves = new QuickLeaves(Math.min(QUICK_LEAVES, data.shape.length), colour);
  const at = [0, 0, 0];
  const direction = new Vector3();
  const normal = new Vector3();
  const across = new Vector3();
  const matrix = new Matrix4();
  const tints = [0.88, 1.0, 1.12].map((f) => new Color(colour).multiplyScalar(f));
  data.shapes.forEach((shape, kind) => {
    const members = [];
    for (let k = 0; k < data.shape.length; ++k) if (data.shape[k] === kind) members.push(k);
    if (!members.length) return;
    const mesh = new InstancedMesh(leafGeometry(shape), new MeshLambertMaterial({ side: 2 }), members.length);
    members.forEach((k, i) => {
      direction.fromArray(data.frame, 6 * k).normalize();
      normal.fromArray(data.frame, 6 * k + 3);
      across.crossVectors(direction, normal).normalize();
      normal.crossVectors(across, direction);
      const length = data.length[k];
      place(data.origins, k, at);
      matrix.makeBasis(across, direction, normal).scale(new Vector3(length, length, length)).setPosition(at[0], at[1], at[2]);
      mesh.setMatrixAt(i, matrix);
      if (k < QUICK_LEAVES) quickLeaves.add(matrix, shape);
      mesh.setColorAt(i, tints[(k * 7) % 3]);
    });
    mesh.frustumCulled = false;
    group.add(mesh);
    blades.push([mesh, members.length]);
  });
  // Leaves come in random order, as the points do.
  group.setDetail = (share) => {
    const few = share < 0.5;
    for (const [mesh, count] of blades) {
      mesh.visible = !few;
      mesh.count = Math.round(share * count);
    }
    quick.visible = few;
    quick.geometry.setDrawRange(0, 6 * Math.min(quickLeaves.count, Math.max(2000, Math.round(share * data.shape.length))));
    stalks.visible = share > 0.5;
  };
  const stalks = petioles(data, colour);
  const quick = quickLeaves.mesh();
  group.add(stalks, quick);
  return group;
}

/// What leaves stand on where the model ends coarser than twigs. Never thicker than it is: it would hide the leaves.
export function shootMesh(data, colour) {
  const geometry = new CylinderGeometry(1, 1, 1, 4, 1, true);
  geometry.translate(0, 0.5, 0);
  const count = data.radius.length;
  const mesh = new InstancedMesh(geometry, new MeshLambertMaterial({ color: colour, side: 2 }), count);
  const a = new Vector3();
  const along = new Vector3();
  const at = [0, 0, 0];
  const matrix = new Matrix4();
  const turn = new Quaternion();
  for (let i = 0; i < count; ++i) {
    a.fromArray(place(data.ends, 2 * i, at));
    along.fromArray(place(data.ends, 2 * i + 1, at)).sub(a);
    const length = Math.max(along.length(), 1e-6);
    turn.setFromUnitVectors(UP, along.divideScalar(length));
    mesh.setMatrixAt(i, matrix.compose(a, turn, new Vector3(data.radius[i], length, data.radius[i])));
  }
  mesh.frustumCulled = false;
  mesh.setDetail = (share) => { mesh.visible = share > 0.5; };
  return mesh;
}

function petioles(data, colour) {
  const ends = new Float32Array(6 * data.shape.length);
  const at = [0, 0, 0];
  for (let k = 0; k < data.shape.length; ++k) {
    ends.set(place(data.feet, k, at), 6 * k);
    ends.set(place(data.origins, k, at), 6 * k + 3);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(ends, 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ color: new Color(colour).multiplyScalar(0.75) }));
  lines.frustumCulled = false;
  return lines;
}

/// A pale floor with a grid whose cells are a metre (or a round part or multiple of it).
export function ground(reach) {
  const group = new Group();
  const cell = 10 ** Math.round(Math.log10(reach / 6));
  const lines = 2 * Math.max(1, Math.ceil(reach / cell));
  const plane = new Mesh(new PlaneGeometry(lines * cell, lines * cell), new MeshBasicMaterial({ color: '#e2e3d8' }));
  const grid = new GridHelper(lines * cell, lines, '#b4b7a8', '#cfd1c5');
  grid.rotation.x = Math.PI / 2;
  grid.position.z = 0.0005 * reach;
  plane.position.z = -0.0005 * reach;
  group.add(plane, grid);
  return group;
}
