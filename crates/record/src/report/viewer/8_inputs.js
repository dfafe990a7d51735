  // ---- Inputs: pointers, wheel and keys on the picture. The page's own scrolling is left alone. ----

  class Inputs {
    constructor(viewer, signal) {
      const { canvas, camera, scene } = viewer;
      Object.assign(this, { viewer, canvas, camera, scene, signal, pointers: new Map(), isOnTape: false });
      this.on(canvas, "wheel", this.wheel, { passive: false });
      this.on(canvas, "touchstart touchmove", this.touch, { passive: false });
      this.on(canvas, "pointerdown", this.press);
      this.on(canvas, "pointermove", this.drag);
      this.on(canvas, "pointerup pointercancel", this.release);
      this.on(canvas, "pointerleave", () => viewer.hover(null));
      this.on(canvas, "keydown", this.key);
      this.on(canvas, "focus blur", () => viewer.redraw());
      this.on(canvas, "dblclick", () => { camera.look(START); viewer.redraw(); });
      this.on(canvas, "webglcontextlost", (event) => event.preventDefault());
      this.on(canvas, "webglcontextrestored", () => viewer.restore());
      this.on(window, "resize", () => viewer.redraw());
    }

    on(target, names, act, options) {
      names.split(" ").forEach((name) =>
        target.addEventListener(name, (event) => act.call(this, event), { signal: this.signal, ...options }));
    }

    /** A handle that takes the tape along, with a finger too: the page does not scroll by it. */
    addGrip(grip) {
      let lastY = null;
      this.on(grip, "pointerdown", (event) => { grip.setPointerCapture(event.pointerId); lastY = event.clientY; });
      this.on(grip, "pointermove", (event) => {
        if (lastY === null) return;
        this.pullTape(event.clientY - lastY);
        lastY = event.clientY;
      });
      this.on(grip, "pointerup pointercancel", () => { lastY = null; });
    }

    /** Moves the tape as far along the legs as the pointer has gone down the picture. */
    pullTape(yPx) {
      const { tape } = this.viewer;
      const rise = this.camera.up[2];
      if (rise >= LEAST_RISE) tape.set(tape.heightMm - yPx / this.camera.pxPerMm / rise);
    }

    press(event) {
      this.canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
      this.isOnTape = event.pointerType === "mouse" && this.isTapeAt([event.offsetX, event.offsetY]);
      this.viewer.hover(null);
    }

    release(event) {
      this.pointers.delete(event.pointerId);
      this.isOnTape = false;
    }

    drag(event) {
      const { camera, pointers, viewer } = this;
      const now = [event.offsetX, event.offsetY];
      const before = pointers.get(event.pointerId);
      if (!before) {
        this.canvas.style.cursor = event.pointerType === "mouse" && this.isTapeAt(now) ? "ns-resize" : "";
        return viewer.hover(this.featureAt(now));
      }
      const [x, y] = [now[0] - before[0], now[1] - before[1]];
      pointers.set(event.pointerId, now);
      const other = [...pointers].find(([id]) => id !== event.pointerId);
      if (other) {
        // Two fingers: the legs turn with the fingers' middle and grow with their distance.
        const [fx, fy] = other[1];
        const apart = (at) => Math.max(1, Math.hypot(at[0] - fx, at[1] - fy));
        camera.turn(-x / 2 * TURN_DEG_PER_PX, y / 2 * TURN_DEG_PER_PX);
        camera.zoomBy(apart(now) / apart(before), (now[0] + fx) / 2, (now[1] + fy) / 2);
      } else if (this.isOnTape) this.pullTape(y);
      else if (event.shiftKey) camera.move(x, y);
      else camera.turn(-x * TURN_DEG_PER_PX, event.pointerType === "touch" ? 0 : y * TURN_DEG_PER_PX);
      return viewer.redraw();
    }

    /** A finger down or up the canvas scrolls the page (`touch-action: pan-y`); two are for the legs. */
    touch(event) {
      if (event.touches.length > 1 && event.cancelable) event.preventDefault();
    }

    /** Whether a place of the canvas is on a shown leg's tape. */
    isTapeAt([x, y]) {
      const { shows, tape } = this.viewer;
      return shows.tape && this.scene.legs.some((leg) => shows[leg.side] && (tape.curves.get(leg) || []).some((place) => {
        const [atX, atY] = this.camera.project(place);
        return Math.hypot(atX - x, atY - y) < GRAB_PX;
      }));
    }

    featureAt([x, y]) {
      const { shows, labels } = this.viewer;
      let [found, least] = [null, HOVER_PX];
      for (const leg of shows.features ? this.scene.legs.filter(({ side }) => shows[side]) : []) {
        for (const feature of leg.features) {
          const [atX, atY] = this.camera.project(feature.place);
          const away = Math.hypot(atX - x, atY - y);
          if (away < least && labels.isSeen(leg, feature)) [found, least] = [feature, away];
        }
      }
      return found;
    }

    /** Zooms with Ctrl or Cmd, which is also how a browser tells of a pinch on a touchpad. Without, the page scrolls. */
    wheel(event) {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      const turned = event.deltaY * (event.deltaMode ? WHEEL_LINE_PX : 1);
      this.camera.zoomBy(Math.exp(-turned * ZOOM_PER_WHEEL_PX), event.offsetX, event.offsetY);
      this.viewer.redraw();
    }

    key(event) {
      const { camera, viewer } = this;
      const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] || [];
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (x !== undefined && event.shiftKey) camera.move(x * KEY_MOVE_PX, y * KEY_MOVE_PX);
      else if (x !== undefined) camera.turn(-x * KEY_TURN_DEG, y * KEY_TURN_DEG);
      else if (event.key === "+" || event.key === "=") camera.zoomBy(KEY_ZOOM);
      else if (event.key === "-") camera.zoomBy(1 / KEY_ZOOM);
      else if (event.key === "0") camera.look(START);
      else if (event.key === "PageUp" || event.key === "PageDown") viewer.tape.toNextLevel(event.key === "PageUp");
      else return;
      event.preventDefault();
      viewer.redraw();
    }
  }

