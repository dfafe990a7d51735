  // ---- Camera: a turntable without perspective, so that both legs are to one scale. ----

  class Camera {
    constructor(box) {
      this.box = box;
      this.look(START);
    }

    /** Turns to a view and fits the legs into the canvas. */
    look([yawDeg, pitchDeg]) {
      Object.assign(this, { yawDeg, pitchDeg, zoom: 1, centre: middleOf(this.box) });
      this.turn(0, 0);
      const reach = (axis) => axis.reduce((sum, part, k) => sum + Math.abs(part) * (this.box[k + 3] - this.box[k]), 1);
      this.sizeMm = [reach(this.right), reach(this.up)];
    }

    turn(yawDeg, pitchDeg) {
      this.yawDeg += yawDeg;
      // Never past the vertical, or a leg would stand upside down and left would look like right.
      this.pitchDeg = Math.max(-90, Math.min(90, this.pitchDeg + pitchDeg));
      const [yaw, pitch] = [this.yawDeg, this.pitchDeg].map((degrees) => degrees * Math.PI / 180);
      const level = [Math.sin(yaw), -Math.cos(yaw), 0];
      this.right = [Math.cos(yaw), Math.sin(yaw), 0];
      this.towards = plus([0, 0, Math.sin(pitch)], level, Math.cos(pitch));
      this.up = plus([0, 0, Math.cos(pitch)], level, -Math.sin(pitch));
    }

    get pxPerMm() {
      const room = [this.width - 2 * Math.min(MARGIN_PX[0], this.width * MARGIN_SHARE), this.height - 2 * MARGIN_PX[1]];
      return this.zoom * Math.max(0.02, Math.min(room[0] / this.sizeMm[0], room[1] / this.sizeMm[1]));
    }

    /** Moves the legs over the canvas, never out of reach. */
    move(xPx, yPx) {
      const moved = plus(plus(this.centre, this.right, -xPx / this.pxPerMm), this.up, yPx / this.pxPerMm);
      this.centre = moved.map((part, k) => Math.max(this.box[k], Math.min(this.box[k + 3], part)));
    }

    /** Zooms so that what is under a place of the canvas stays there. */
    zoomBy(factor, x = this.width / 2, y = this.height / 2) {
      const zoom = Math.max(ZOOM[0], Math.min(ZOOM[1], this.zoom * factor));
      const away = 1 - this.zoom / zoom;
      this.move((this.width / 2 - x) * away, (this.height / 2 - y) * away);
      this.zoom = zoom;
    }

    /** Where a point is on the canvas, px from its upper left corner. */
    project(point) {
      const from = minus(point, this.centre);
      return [this.width / 2 + dot(from, this.right) * this.pxPerMm, this.height / 2 - dot(from, this.up) * this.pxPerMm];
    }

    /** The same as a matrix to WebGL's cube, column by column. */
    matrix() {
      const middle = middleOf(this.box);
      const depthMm = Math.hypot(...minus(this.box.slice(3), middle)) + 10;
      const rows = [[this.right, 2 * this.pxPerMm / this.width, this.centre],
        [this.up, 2 * this.pxPerMm / this.height, this.centre], [this.towards, -1 / depthMm, middle]];
      const columns = [0, 1, 2].map((k) => [...rows.map(([axis, scale]) => axis[k] * scale), 0]);
      return [...columns.flat(), ...rows.map(([axis, scale, origin]) => -dot(axis, origin) * scale), 1];
    }
  }

