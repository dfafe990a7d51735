  // ---- Page: elements, colours, pointers, keys. Styles go in by script, which a strict CSP allows. ----

  const STYLE = `
    .gaiter-viewer { padding: 8px; background: var(--v-ground); color: var(--v-ink); color-scheme: light dark; font: 14px/1.4 system-ui, sans-serif; }
    .gaiter-viewer fieldset { display: inline-flex; flex-wrap: wrap; gap: 4px 12px; margin: 0 12px 6px 0; padding: 0; border: 0; min-width: 0; }
    .gaiter-viewer legend { float: left; padding: 4px 0; font-weight: 600; }
    .gaiter-viewer button { padding: 4px 10px; font: inherit; color: inherit; background: none; border: 1px solid var(--v-line); border-radius: 4px; }
    .gaiter-viewer label { display: inline-flex; align-items: center; gap: 4px; min-height: 28px; }
    .gaiter-viewer :focus-visible { outline: 3px solid var(--v-focus); outline-offset: 1px; }
    .gaiter-viewer p { margin: 6px 0 0; }
    .gaiter-viewer [hidden] { display: none; }
    .gaiter-stage { position: relative; overflow: hidden; height: clamp(320px, 70vh, 760px); }
    .gaiter-stage canvas { display: block; width: 100%; height: 100%; touch-action: none; cursor: grab; }
    .gaiter-stage canvas:focus-visible { outline-offset: -3px; }
    .gaiter-stage span, .gaiter-stage i { position: absolute; left: 0; top: 0; pointer-events: none; }
    .gaiter-stage span { padding: 0 4px; white-space: nowrap; background: var(--v-ground); border-radius: 3px; font-size: 13px; }
    .gaiter-stage i { height: 1px; background: currentcolor; transform-origin: 0 0; }
    .gaiter-swatch { width: 20px; height: 8px; border-radius: 4px; }
    .gaiter-foot { display: flex; flex-wrap: wrap; gap: 4px 8px; align-items: center; min-height: 28px; }
    .gaiter-bar { border: solid var(--v-ink); border-width: 0 1px 1px; text-align: center; }`;

  /** An element; all text goes in as text. */
  function make(name, attributes, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
  }

  /** A patch of a colour or of a blend of colours. */
  function swatch(...names) {
    const element = make("span", { class: "gaiter-swatch" });
    const colours = names.map((name) => `var(--v-${name})`);
    element.style.background = names.length > 1 ? `linear-gradient(to right, ${colours})` : colours[0];
    return element;
  }

  let sheet = null;

  function adoptStyle() {
    if (sheet) return;
    sheet = new CSSStyleSheet();
    sheet.replaceSync(STYLE);
    document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
  }

  let mounted = 0;

  class Viewer {
    constructor(root, gl, scene, words) {
      Object.assign(this, { root, gl, scene, words, canvas: gl.canvas, camera: new Camera(scene.box), gpu: new Gpu(gl, scene.legs) });
      Object.assign(this, { pointers: new Map(), hovered: null, scrolledAt: -Infinity, ended: new AbortController() });
      this.shows = { left: true, right: true };
      LAYERS.forEach((layer) => { this.shows[layer] = SHOWN_FIRST.includes(layer) && this.has(layer); });
      this.build();
      this.listen();
      this.recolour();
    }

    /** Whether any leg has something for a layer. */
    has(layer) {
      return this.scene.legs.some((leg) => ({
        ...leg, error: leg.surface && leg.surface.errors, sections: leg.levels.some((level) => level.ring),
        landmarks: leg.levels.some((level) => level.girthMm !== null), features: leg.features.length,
      })[layer]);
    }

    build() {
      const { words, camera, scene } = this;
      const button = (key, act) => {
        const element = make("button", { type: "button" }, words[key]);
        element.addEventListener("click", () => { act(); this.redraw(); });
        return element;
      };
      const check = (key, text, ...colours) => {
        const box = make("input", { type: "checkbox" });
        Object.assign(box, { checked: this.shows[key], disabled: LAYERS.includes(key) && !this.has(key) });
        box.addEventListener("change", () => { this.shows[key] = box.checked; this.redraw(); });
        return make("label", {}, box, text, ...colours.map((colour) => swatch(colour)));
      };
      const group = (title, ...children) => make("fieldset", {}, make("legend", {}, title), ...children);
      const help = make("p", { id: `gaiter-viewer-help-${mounted += 1}` }, words.help);
      const named = { tabindex: 0, role: "application", "aria-label": words.title, "aria-describedby": help.id };
      Object.entries(named).forEach(([key, value]) => this.canvas.setAttribute(key, value));
      this.overlay = make("div", { "aria-hidden": "true" });
      this.bar = make("div", { class: "gaiter-bar" });
      this.legend = this.makeLegend();
      this.root.append(
        group(words.look, ...Object.keys(VIEWS).map((key) => button(key, () => camera.look(VIEWS[key]))),
          button("nearer", () => camera.zoomBy(KEY_ZOOM)), button("farther", () => camera.zoomBy(1 / KEY_ZOOM)),
          button("reset", () => camera.look(START))),
        group(words.show, ...scene.legs.map(({ side }) => check(side, words[`${side}Leg`], side)).reverse(),
          ...LAYERS.map((layer) => check(layer, words[layer], ...(layer in COLOURS ? [layer] : [])))),
        make("div", { class: "gaiter-stage" }, this.canvas, this.overlay),
        make("div", { class: "gaiter-foot" }, this.bar, this.legend),
        help, ...(scene.note ? [make("p", {}, words[scene.note])] : []));
      this.tags = this.makeTags();
    }

    makeLegend() {
      const { scene: { rangeMm }, words } = this;
      const range = String(rangeMm).replace(".", words.point);
      const colours = swatch("below", "middle", "above");
      colours.style.width = "140px";
      return make("div", { class: "gaiter-foot" }, `${words.legend}: −${range}`, colours, `+${range}`, swatch("unseen"), words.unseen);
    }

    /** The labels, most important first: sides, the feature point under the pointer, levels, others. */
    makeTags() {
      const { words, scene } = this;
      const tag = (rank, leg, places, say) => {
        const made = { rank, leg, places, say, text: make("span", {}), line: make("i", {}) };
        for (const { style } of [made.text, made.line]) style.color = `var(--v-${leg.side})`;
        this.overlay.append(made.line, made.text);
        return made;
      };
      return scene.legs.flatMap((leg) => [
        tag(() => 0, leg, (size) => this.besideLeg(leg, size), () => words[`${leg.side}Leg`]),
        ...leg.levels.map((level) => tag(() => 2, leg, (size, anchors) => this.besideLevel(leg, level, size, anchors), () =>
          [level.level, words[leg.side], ...(this.shows.landmarks && level.girthMm ? [inCm(level.girthMm, words), level.isDoubted ? "cm ?" : "cm"] : [])].join(" "))),
        ...leg.features.map((feature) => tag(() => (feature === this.hovered ? 1 : 3), leg, (size) => this.besideFeature(leg, feature, size), () =>
          (feature === this.hovered ? [feature.label, feature.level, words[leg.side], words[feature.kind]].join(" · ") : feature.label))),
      ]);
    }

    /** Over the leg, or a line farther where the other leg's name is; always on the canvas. */
    besideLeg({ box }, [width, height]) {
      const { camera } = this;
      const corners = Array.from({ length: 8 }, (_, bits) => camera.project([0, 1, 2].map((k) => box[k + 3 * (bits >> k & 1)])));
      const into = (value, room) => Math.max(0, Math.min(room, value));
      const left = into(corners.reduce((sum, [x]) => sum + x / 8, -width / 2), camera.width - width);
      const top = into(Math.min(...corners.map(([, y]) => y)) - height, camera.height - height);
      return [0, -1, 1, 2].map((lines) => [left, top + lines * height]);
    }

    /** Beside the legs, on the side away from the other leg, with a line from the section. */
    besideLevel(leg, level, [width, height], anchors) {
      const { camera, shows } = this;
      if (!(shows.sections && level.ring) && !(shows.landmarks && level.girthMm !== null)) return [];
      const x = ({ box }) => camera.project(middleOf(box))[0];
      const other = this.scene.legs.find((one) => one !== leg);
      // Seen from the side the legs stand behind one another; then the left one's labels are on the right.
      const away = other ? x(leg) - x(other) : 1;
      const way = Math.sign(Math.abs(away) > 1 ? away : (leg.side === "left") - 0.5);
      const outline = level.ring ? level.ring.outline.map((point) => [point, ...camera.project(point)]) : [[level.place, ...camera.project(level.place)]];
      const [place, fromX, fromY] = outline.reduce((most, one) => (way * one[1] > way * most[1] ? one : most));
      if (fromX < 0 || fromX > camera.width || fromY < 0 || fromY > camera.height) return [];
      if (shows.landmarks && level.girthMm !== null) anchors.push(place);
      let edge = fromX;
      for (const { centre, radius } of this.scene.legs.filter(({ side }) => shows[side]).flatMap(({ balls }) => balls)) {
        const [ballX, ballY] = camera.project(centre);
        if (Math.abs(ballY - fromY) < height) edge = way * Math.max(way * edge, way * ballX + radius * camera.pxPerMm);
      }
      const left = Math.max(0, Math.min(camera.width - width, edge + way * LEADER_PX - (way < 0 ? width : 0)));
      return [0, -1, 1, -2, 2].map((lines) =>
        [left, fromY + (lines - 0.5) * height, fromX, fromY, way < 0 ? width : 0, height / 2]);
    }

    /** Around a feature point, where it is asked for: by the pointer, by coming near, by the keyboard. */
    besideFeature(leg, feature, [width, height]) {
      const { camera, shows } = this;
      const asked = feature === this.hovered || camera.pxPerMm > NEAR_PX_PER_MM || this.canvas.matches(":focus-visible");
      if (!asked || !shows.features || !this.isSeen(leg, feature)) return [];
      const [x, y] = camera.project(feature.place);
      return [[x + 8, y - height], [x - 8 - width, y - height], [x + 8, y], [x - 8 - width, y]];
    }

    /** Whether a feature point faces the eye and no shown leg stands before it. */
    isSeen(leg, { place, centre }) {
      const { towards } = this.camera;
      if (centre && dot(minus(place, centre), towards) <= 0) return false;
      return !this.scene.legs.some((other) => other !== leg && this.shows[other.side] && other.balls.some((ball) => {
        const away = minus(ball.centre, place);
        const ahead = dot(away, towards);
        return ahead > 0 && Math.hypot(...plus(away, towards, -ahead)) < ball.radius;
      }));
    }

    /** Puts every label at its first place that is free; returns where the levels' lines start. */
    placeTags() {
      const { width, height } = this.camera;
      const [taken, anchors] = [[], new Map(this.scene.legs.map((leg) => [leg, []]))];
      for (const tag of [...this.tags].sort((a, b) => a.rank() - b.rank())) {
        const said = tag.say();
        if (tag.said !== said || tag.size[0] === 0) {
          tag.text.hidden = false;
          tag.text.textContent = tag.said = said;
          const box = tag.text.getBoundingClientRect();
          tag.size = [box.width, box.height].map(Math.ceil);
        }
        const [w, h] = tag.size;
        const places = this.shows[tag.leg.side] ? tag.places(tag.size, anchors.get(tag.leg)) : [];
        const place = places.find(([x, y]) => x >= 0 && y >= 0 && x + w <= width && y + h <= height
          && taken.every((box) => x + w <= box[0] || box[0] + box[2] <= x || y + h <= box[1] || box[1] + box[3] <= y));
        tag.text.hidden = tag.line.hidden = !place;
        if (!place) continue;
        taken.push([place[0], place[1], w, h]);
        tag.text.style.transform = `translate(${place[0]}px, ${place[1]}px)`;
        this.drawLine(tag.line, place);
      }
      return anchors;
    }

    /** A line from a level's section to its label; other labels have none. */
    drawLine(line, [left, top, fromX, fromY, atX, atY]) {
      if (fromX === undefined) return;
      const [x, y] = [left + atX - fromX, top + atY - fromY];
      line.style.width = `${Math.hypot(x, y)}px`;
      line.style.transform = `translate(${fromX}px, ${fromY}px) rotate(${Math.atan2(y, x)}rad)`;
    }

    // -- Drawing, only when something has changed.

    redraw() {
      if (!this.frame) this.frame = requestAnimationFrame(() => this.draw());
    }

    draw() {
      this.frame = 0;
      const { canvas, camera, gl } = this;
      const [width, height] = [canvas.clientWidth, canvas.clientHeight];
      if (!width || !height) return;
      const ratio = Math.min(devicePixelRatio || 1, MOST_CANVAS_PX / Math.max(width, height));
      const size = [Math.round(width * ratio), Math.round(height * ratio)];
      if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
      Object.assign(camera, { width, height });
      const anchors = this.placeTags();
      if (!gl.isContextLost()) this.gpu.draw(camera, this.colours, this.shows, this.scene.rangeMm, anchors, ratio);
      const cm = [50, 20, 10, 5, 2, 1, 0.5].find((length) => length * 10 * camera.pxPerMm <= MOST_BAR_PX) || 0.2;
      this.bar.style.width = `${cm * 10 * camera.pxPerMm}px`;
      this.bar.textContent = `${cm} cm`.replace(".", this.words.point);
      this.legend.hidden = !this.shows.error;
    }

    /** Takes the theme's colours, as the page set them or ours: as they are for CSS, 0 to 1 for WebGL. */
    recolour() {
      const [style, pen] = [getComputedStyle(this.root), make("canvas", {}).getContext("2d")];
      this.colours = {};
      for (const [name, themes] of Object.entries(COLOURS)) {
        const ours = themes[this.theme.matches ? 1 : 0];
        // The pen knows every colour of CSS, passes over what is none, and tells it as six digits.
        pen.fillStyle = ours;
        pen.fillStyle = style.getPropertyValue(`--gaiter-${name}`).trim();
        const digits = /^#[0-9a-f]{6}$/.test(pen.fillStyle) ? pen.fillStyle : ours;
        this.root.style.setProperty(`--v-${name}`, digits);
        this.colours[name] = [1, 3, 5].map((at) => parseInt(digits.slice(at, at + 2), 16) / 255);
      }
      this.redraw();
    }

    // -- Pointers, wheel, keys.

    listen() {
      const { canvas, camera } = this;
      const { signal } = this.ended;
      const on = (target, names, act, options) => names.split(" ").forEach((name) =>
        target.addEventListener(name, (event) => act.call(this, event), { signal, ...options }));
      this.theme = matchMedia("(prefers-color-scheme: dark)");
      on(this.theme, "change", this.recolour);
      on(window, "resize", this.redraw);
      on(window, "wheel", this.noteScroll, { capture: true, passive: true });
      on(canvas, "wheel", this.wheel, { passive: false });
      on(canvas, "pointerdown", this.press);
      on(canvas, "pointermove", this.drag);
      on(canvas, "pointerup pointercancel", (event) => this.pointers.delete(event.pointerId));
      on(canvas, "pointerleave", () => this.hover(null));
      on(canvas, "keydown", this.key);
      on(canvas, "focus blur", this.redraw);
      on(canvas, "dblclick", () => { camera.look(START); this.redraw(); });
      on(canvas, "webglcontextlost", (event) => event.preventDefault());
      on(canvas, "webglcontextrestored", () => { this.gpu = new Gpu(this.gl, this.scene.legs); this.redraw(); });
      this.observer = new ResizeObserver(() => this.redraw());
      this.observer.observe(canvas);
    }

    press(event) {
      this.canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
      this.hover(null);
    }

    drag(event) {
      const { camera, pointers } = this;
      const now = [event.offsetX, event.offsetY];
      const before = pointers.get(event.pointerId);
      if (!before) return this.hover(this.featureAt(now));
      const [x, y] = [now[0] - before[0], now[1] - before[1]];
      pointers.set(event.pointerId, now);
      const other = [...pointers].find(([id]) => id !== event.pointerId);
      if (other) {
        // Two fingers: the legs follow the fingers' middle and their distance.
        const [fx, fy] = other[1];
        const apart = (at) => Math.max(1, Math.hypot(at[0] - fx, at[1] - fy));
        camera.move(x / 2, y / 2);
        camera.zoomBy(apart(now) / apart(before), (now[0] + fx) / 2, (now[1] + fy) / 2);
      } else if (event.shiftKey) camera.move(x, y);
      else camera.turn(-x * TURN_DEG_PER_PX, y * TURN_DEG_PER_PX);
      return this.redraw();
    }

    featureAt([x, y]) {
      let [found, least] = [null, HOVER_PX];
      for (const leg of this.shows.features ? this.scene.legs.filter(({ side }) => this.shows[side]) : []) {
        for (const feature of leg.features) {
          const [atX, atY] = this.camera.project(feature.place);
          const away = Math.hypot(atX - x, atY - y);
          if (away < least && this.isSeen(leg, feature)) [found, least] = [feature, away];
        }
      }
      return found;
    }

    hover(feature) {
      if (feature === this.hovered) return;
      this.hovered = feature;
      this.redraw();
    }

    /** A page that is being scrolled scrolls on when the canvas comes under the pointer. */
    noteScroll(event) {
      const scrolling = event.target !== this.canvas || event.timeStamp - this.scrolledAt < SCROLL_PAUSE_MS;
      if (scrolling) this.scrolledAt = event.timeStamp;
    }

    wheel(event) {
      if (event.timeStamp === this.scrolledAt) return;
      event.preventDefault();
      const turned = event.deltaY * (event.deltaMode ? WHEEL_LINE_PX : 1);
      this.camera.zoomBy(Math.exp(-turned * ZOOM_PER_WHEEL_PX), event.offsetX, event.offsetY);
      this.redraw();
    }

    key(event) {
      const { camera } = this;
      const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] || [];
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (x !== undefined && event.shiftKey) camera.move(x * KEY_MOVE_PX, y * KEY_MOVE_PX);
      else if (x !== undefined) camera.turn(-x * KEY_TURN_DEG, y * KEY_TURN_DEG);
      else if (event.key === "+" || event.key === "=") camera.zoomBy(KEY_ZOOM);
      else if (event.key === "-") camera.zoomBy(1 / KEY_ZOOM);
      else if (event.key === "0") camera.look(START);
      else return;
      event.preventDefault();
      this.redraw();
    }

    destroy() {
      this.ended.abort();
      this.observer.disconnect();
      cancelAnimationFrame(this.frame);
      // Browsers keep only some sixteen contexts; this one is free now.
      const ending = this.gl.getExtension("WEBGL_lose_context");
      if (ending) ending.loseContext();
      this.root.remove();
    }
  }

  /** Fills `element` with the view of a record; see the top of this file. */
  function mount(element, record, options) {
    const language = options && options.language === "de" ? "de" : "en";
    const words = WORDS[language];
    const scene = readScene(record);
    const root = make("section", { class: "gaiter-viewer", lang: language, "aria-label": words.title });
    element.replaceChildren(root);
    const gl = scene.legs.length ? openWebgl() : null;
    if (!gl) {
      root.append(make("p", {}, scene.legs.length ? words.noWebgl : words[scene.note]));
      return { destroy: () => root.remove() };
    }
    adoptStyle();
    const viewer = new Viewer(root, gl, scene, words);
    return { destroy: () => viewer.destroy() };
  }

  /** A canvas' WebGL, or null where there is none that counts a grid's corners in 32 bits. */
  function openWebgl() {
    const canvas = make("canvas", {});
    const gl = canvas.getContext("webgl2", { alpha: false }) || canvas.getContext("webgl", { alpha: false });
    return gl && (gl.drawBuffers || gl.getExtension("OES_element_index_uint")) ? gl : null;
  }

  return { mount };
})();
