// A small orbit camera: where a point in metres falls on the screen. World: y up, +z forward.

const FIELD_OF_VIEW = (30 * Math.PI) / 180;
const NEAR = 0.15; // metres

class OrbitCamera {
  constructor() {
    Object.assign(this, { yaw: 0.6, pitch: 0.2, distance: 5, target: [0, 0.9, 0], orthographic: false });
    this.shift = [0, 0, 0]; // added to the target while following the pelvis
    this.resize(600, 400);
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    this.focal = height / 2 / Math.tan(FIELD_OF_VIEW / 2);
    this.aim();
  }

  /** Recompute the axes of the view; call after changing an angle. At yaw 0 we face the body. */
  aim() {
    const { yaw, pitch } = this;
    const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
    this.right = [cy, 0, -sy];
    this.up = [-sy * sp, cp, -cy * sp];
    this.back = [sy * cp, sp, cy * cp];
  }

  /** Camera coordinates: to the right, up, and the distance in front of the eye, in metres. */
  see(x, y, z) {
    const dx = x - this.target[0] - this.shift[0];
    const dy = y - this.target[1] - this.shift[1];
    const dz = z - this.target[2] - this.shift[2];
    const { right, up, back } = this;
    return [
      dx * right[0] + dz * right[2],
      dx * up[0] + dy * up[1] + dz * up[2],
      this.distance - (dx * back[0] + dy * back[1] + dz * back[2]),
    ];
  }

  /** Pixels per metre at a distance from the eye. */
  scale(depth) {
    return this.focal / (this.orthographic ? this.distance : Math.max(depth, NEAR));
  }

  /** Screen position of camera coordinates, in CSS pixels. */
  screen([x, y, depth]) {
    const scale = this.scale(depth);
    return [this.width / 2 + x * scale, this.height / 2 - y * scale, depth, scale];
  }

  project(x, y, z) {
    return this.screen(this.see(x, y, z));
  }

  /** Both ends of a segment on the screen, cut where it passes behind the eye; null if all is. */
  segment(from, to) {
    const a = this.see(...from);
    const b = this.see(...to);
    if (a[2] < NEAR && b[2] < NEAR) return null;
    const cut = (inside, outside) => {
      const share = (inside[2] - NEAR) / (inside[2] - outside[2]);
      return inside.map((value, i) => value + (outside[i] - value) * share);
    };
    return [this.screen(a[2] < NEAR ? cut(b, a) : a), this.screen(b[2] < NEAR ? cut(a, b) : b)];
  }

  orbit(dx, dy) {
    this.yaw -= dx * 0.008;
    this.pitch = Math.min(1.55, Math.max(-0.35, this.pitch + dy * 0.006));
    this.aim();
  }

  pan(dx, dy) {
    const metres = 1 / this.scale(this.distance);
    for (let i = 0; i < 3; i++) {
      this.target[i] += (-dx * this.right[i] + dy * this.up[i]) * metres;
    }
  }

  zoom(factor) {
    this.distance = Math.min(60, Math.max(0.8, this.distance * factor));
  }

  /** Move so that all points are in the picture, in its middle, as large as they can be. */
  fit(points) {
    const slopeY = Math.tan(FIELD_OF_VIEW / 2) * 0.8;
    const slopeX = (slopeY * this.width) / this.height;
    this.target = [0, 1, 2].map((i) => points.reduce((sum, point) => sum + point[i], 0) / points.length);
    for (let round = 0; round < 4; round++) {
      let needed = 3;
      const seen = points.map((point) => this.see(...point));
      for (const [x, y, depth] of seen) {
        const ahead = this.distance - depth;
        needed = Math.max(needed, Math.abs(x) / slopeX + ahead, Math.abs(y) / slopeY + ahead);
      }
      this.distance = needed;
      const flat = points.map((point) => this.project(...point));
      const middle = (axis, size) =>
        size / 2 - (Math.min(...flat.map((p) => p[axis])) + Math.max(...flat.map((p) => p[axis]))) / 2;
      this.pan(middle(0, this.width), middle(1, this.height) + 6);
    }
  }

  state() {
    const { yaw, pitch, distance, target, orthographic } = this;
    return { yaw, pitch, distance, target: [...target], orthographic };
  }
}
