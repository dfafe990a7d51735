  // ---- Page: elements and colours. Styles go in by script, which a strict CSP allows. ----

  const STYLE = `
    .gaiter-viewer { padding: 8px; background: var(--v-ground); color: var(--v-ink); color-scheme: light dark; font: 14px/1.4 system-ui, sans-serif; }
    .gaiter-viewer fieldset { display: inline-flex; flex-wrap: wrap; gap: 4px 12px; margin: 0 12px 6px 0; padding: 0; border: 0; min-width: 0; }
    .gaiter-viewer legend { float: left; padding: 4px 0; font-weight: 600; }
    .gaiter-viewer button { min-width: 32px; padding: 4px 10px; font: inherit; color: inherit; background: none; border: 1px solid var(--v-line); border-radius: 4px; }
    .gaiter-viewer label { display: inline-flex; align-items: center; gap: 4px; min-height: 28px; }
    .gaiter-viewer summary { width: fit-content; padding: 4px 0; }
    .gaiter-viewer :focus-visible { outline: 3px solid var(--v-focus); outline-offset: 1px; }
    .gaiter-viewer p { margin: 6px 0 0; max-width: 70rem; }
    .gaiter-viewer [hidden] { display: none; }
    .gaiter-stage { position: relative; overflow: hidden; height: clamp(320px, 76vh, 860px); }
    .gaiter-stage canvas { display: block; width: 100%; height: 100%; touch-action: pan-y; cursor: grab; }
    .gaiter-stage canvas:focus-visible { outline-offset: -3px; }
    .gaiter-stage span, .gaiter-stage i { position: absolute; left: 0; top: 0; pointer-events: none; }
    .gaiter-stage span { padding: 0 4px; white-space: nowrap; background: var(--v-ground); border-radius: 3px; font-size: 13px; }
    .gaiter-stage .gaiter-side { font-size: 16px; font-weight: 700; }
    .gaiter-stage .gaiter-reading { border: 2px solid currentcolor; font-weight: 700; }
    .gaiter-stage i { height: 1px; background: currentcolor; transform-origin: 0 0; }
    .gaiter-stage .gaiter-grip { width: 44px; height: 44px; margin: -22px 0 0 -22px; background: none; pointer-events: auto; touch-action: none; cursor: ns-resize; }
    .gaiter-grip::before { content: "↕"; position: absolute; inset: 12px; border: 2px solid var(--v-rim); border-radius: 50%; background: var(--v-tape); color: var(--v-rim); font: 700 12px/16px system-ui, sans-serif; text-align: center; }
    .gaiter-swatch { width: 20px; height: 8px; border-radius: 4px; }
    .gaiter-foot { display: flex; flex-wrap: wrap; gap: 4px 8px; align-items: center; min-height: 28px; }
    .gaiter-bar { border: solid var(--v-ink); border-width: 0 1px 1px; text-align: center; }
    .gaiter-tape { display: flex; flex-wrap: wrap; gap: 2px 16px; align-items: center; padding: 4px 0; }
    .gaiter-tape input { flex: 1 1 14rem; min-width: 0; min-height: 28px; margin: 0; accent-color: var(--v-ink); }
    .gaiter-tape output { display: flex; flex-wrap: wrap; gap: 2px 16px; font-size: 18px; font-weight: 600; font-variant-numeric: tabular-nums; }
    @media (max-width: 40rem) {
      .gaiter-viewer { padding: 4px 0; }
      .gaiter-stage { height: clamp(320px, 112vw, 70vh); }
      .gaiter-stage span { padding: 0 2px; font-size: 12px; }
      .gaiter-viewer fieldset { gap: 4px 6px; margin-right: 0; }
      .gaiter-viewer button { padding: 4px 7px; }
    }`;

  /** A patch of a colour or of a blend of colours; of what was not seen, hatched as in the picture. */
  function swatch(...names) {
    const element = make("span", { class: "gaiter-swatch" });
    const colours = names.map((name) => `var(--v-${name})`);
    element.style.background = names.length > 1 ? `linear-gradient(to right, ${colours})` : colours[0];
    if (names[0] === "unseen") element.style.backgroundImage = "repeating-linear-gradient(-45deg, rgb(0 0 0 / 0.25) 0 3px, transparent 3px 6px)";
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

  /** The tape around both legs at one height, with its slider and what it reads. */
  class Tape {
    constructor(scene, words, redraw) {
      Object.assign(this, { scene, words, redraw, readings: new Map(), curves: new Map(), heightMm: 0 });
      if (!scene.tapeMm) return;
      const [low, high] = scene.tapeMm;
      const id = `gaiter-tape-${mounted}`;
      this.slider = make("input", { id, type: "range", min: low, max: high, step: 1 });
      this.output = make("output", { for: id, "aria-live": "off" });
      this.element = make("div", { class: "gaiter-tape" }, make("label", { for: id }, words.tape_height), this.slider, this.output);
      this.slider.addEventListener("input", () => this.set(Number(this.slider.value)));
      this.slider.addEventListener("keydown", (event) => {
        if (event.key !== "PageUp" && event.key !== "PageDown") return;
        event.preventDefault();
        this.toNextLevel(event.key === "PageUp");
      });
      const calf = scene.legs[0].levels.find((level) => level.level === "C" && level.heightMm !== null);
      this.set(calf ? calf.heightMm : (low + high) / 2);
    }

    /** Moves the tape to a height and reads it. */
    set(heightMm) {
      const { scene: { legs, tapeMm }, words } = this;
      if (!tapeMm) return;
      this.heightMm = Math.max(tapeMm[0], Math.min(tapeMm[1], heightMm));
      const said = legs.map((leg) => {
        const reading = tapeReading(leg, this.heightMm);
        this.readings.set(leg, reading);
        this.curves.set(leg, reading && tapeCurve(leg, this.heightMm));
        if (!reading) return `${words[`${leg.side}_leg`]} ${words.not_measured}`;
        const level = reading.level ? ` (${reading.level})` : "";
        return `${words[`${leg.side}_leg`]} ${inCm(reading.girthMm, words)} cm${reading.isDoubted ? " ?" : ""}${level}`;
      });
      const height = `${inCm(this.heightMm, words)} cm`;
      this.slider.value = Math.round(this.heightMm);
      this.slider.setAttribute("aria-valuetext", [height, ...said].join(", "));
      this.output.replaceChildren(make("strong", {}, height), ...said.map((text, at) => {
        const element = make("strong", {}, text);
        element.style.color = `var(--v-${legs[at].side})`;
        return element;
      }));
      this.redraw();
    }

    /** Moves the tape to the next level of any leg, upwards or downwards. */
    toNextLevel(isUp) {
      const heights = levelHeights(this.scene.legs);
      const next = isUp ? heights.find((height) => height > this.heightMm + AT_LEVEL_MM)
        : heights.findLast((height) => height < this.heightMm - AT_LEVEL_MM);
      if (next !== undefined) this.set(next);
    }

    /** The bands to draw by leg, edge and face, as thick as they are to look. */
    bands(pxPerMm) {
      const thick = (curve, px) => bandOf(curve, px / pxPerMm);
      const drawn = [...this.curves].filter(([, curve]) => curve && curve.length > 2);
      return new Map(drawn.map(([leg, curve]) => [leg, [thick(curve, TAPE_PX), thick(curve, TAPE_PX - 1.25)]]));
    }
  }

  class Viewer {
    constructor(root, gl, scene, words, title) {
      Object.assign(this, { root, gl, scene, words, title, canvas: gl.canvas, camera: new Camera(scene.box), gpu: new Gpu(gl, scene.legs) });
      Object.assign(this, { hovered: null, ended: new AbortController(), theme: matchMedia("(prefers-color-scheme: dark)") });
      mounted += 1;
      this.shows = { left: true, right: true };
      this.tape = new Tape(scene, words, () => this.redraw());
      const first = words.first_layers ? words.first_layers.split(" ") : SHOWN_FIRST;
      [...FIRST_LAYERS, ...MORE_LAYERS].forEach((layer) => { this.shows[layer] = first.includes(layer) && this.has(layer); });
      if (!this.has("skin")) this.shows.surface = this.has("surface");
      this.labels = new Labels(this);
      this.build();
      const inputs = new Inputs(this, this.ended.signal);
      this.grips.forEach((grip) => inputs.addGrip(grip));
      inputs.on(this.theme, "change", () => this.recolour());
      this.observer = new ResizeObserver(() => this.redraw());
      this.observer.observe(this.canvas);
      this.recolour();
    }

    /** Whether any leg has something for a layer. */
    has(layer) {
      return this.scene.legs.some((leg) => ({
        ...leg, error: leg.surface && leg.surface.errors, sections: leg.levels.some((level) => level.ring),
        landmarks: leg.levels.some((level) => level.girthMm !== null), features: leg.features.length,
        tape: this.scene.tapeMm, ghost: leg.ghost.length,
      })[layer]);
    }

    build() {
      const { words, camera, scene } = this;
      const button = (key, act, sign) => {
        const element = make("button", { type: "button", ...(sign ? { "aria-label": words[key], title: words[key] } : {}) }, sign || words[key]);
        element.addEventListener("click", () => { act(); this.redraw(); });
        return element;
      };
      const check = (key, text, ...colours) => {
        const box = make("input", { type: "checkbox" });
        Object.assign(box, { checked: this.shows[key], disabled: key in this.shows && !(key in { left: 0, right: 0 }) && !this.has(key) });
        box.addEventListener("change", () => { this.shows[key] = box.checked; this.redraw(); });
        return make("label", {}, box, text, ...colours.map((colour) => swatch(colour)));
      };
      const layers = (keys) => keys.map((layer) => check(layer, words[layer], ...(layer in COLOURS ? [layer] : [])));
      const group = (title, ...children) => make("fieldset", {}, make("legend", {}, title), ...children);
      const help = make("p", { id: `gaiter-viewer-help-${mounted}` }, words.help);
      const named = { tabindex: 0, role: "application", "aria-label": this.title, "aria-describedby": help.id };
      Object.entries(named).forEach(([key, value]) => this.canvas.setAttribute(key, value));
      this.bar = make("div", { class: "gaiter-bar" });
      this.legend = this.makeLegend();
      this.ghostHelp = make("p", {}, words.ghost_help);
      this.grips = scene.legs.map(() => make("i", { class: "gaiter-grip" }));
      this.labels.overlay.append(...this.grips);
      this.root.append(
        group(words.look, ...Object.keys(VIEWS).map((key) => button(key, () => camera.look(VIEWS[key]))),
          button("nearer", () => camera.zoomBy(KEY_ZOOM), "+"), button("farther", () => camera.zoomBy(1 / KEY_ZOOM), "−"),
          button("reset", () => camera.look(START))),
        group(words.show, ...scene.legs.map(({ side }) => check(side, words[`${side}_leg`], side)), ...layers(FIRST_LAYERS)),
        make("div", { class: "gaiter-stage" }, this.canvas, this.labels.overlay),
        ...(this.tape.element ? [this.tape.element] : []),
        make("div", { class: "gaiter-foot" }, this.bar, words.girths, this.legend), this.ghostHelp,
        make("details", {}, make("summary", {}, words.more), make("div", { class: "gaiter-foot" }, ...layers(MORE_LAYERS))),
        help, ...(scene.note ? [make("p", {}, words[scene.note])] : []));
    }

    makeLegend() {
      const { words } = this;
      const colours = swatch("below", "middle", "above");
      colours.style.width = "140px";
      return make("div", { class: "gaiter-foot" }, `${words.legend}: −${ERROR_MM}`, colours, `+${ERROR_MM}`, swatch("unseen"), words.unseen);
    }

    /** A handle on each tape, where it is nearest to the eye. */
    placeGrips() {
      const { camera, shows, tape, scene } = this;
      this.grips.forEach((grip, at) => {
        const curve = shows.tape && shows[scene.legs[at].side] && tape.curves.get(scene.legs[at]);
        grip.hidden = !curve || camera.up[2] < LEAST_RISE;
        if (grip.hidden) return;
        const { middle } = planeOf(curve);
        const front = curve.reduce((most, place) => (dot(place, camera.towards) > dot(most, camera.towards) ? place : most));
        // One handle is enough where a leg stands behind the other.
        grip.hidden = !this.labels.isSeen(scene.legs[at], { place: front, centre: null });
        const [[, y], [x]] = [camera.project(front), camera.project(middle)];
        grip.style.transform = `translate(${x}px, ${y}px)`;
      });
    }

    hover(feature) {
      if (feature === this.hovered) return;
      this.hovered = feature;
      this.redraw();
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
      const anchors = this.labels.place();
      this.placeGrips();
      const tapes = this.shows.tape ? this.tape.bands(camera.pxPerMm) : new Map();
      if (!gl.isContextLost()) this.gpu.draw(camera, this.colours, this.shows, anchors, tapes, ratio);
      const cm = [50, 20, 10, 5, 2, 1, 0.5].find((length) => length * 10 * camera.pxPerMm <= MOST_BAR_PX) || 0.2;
      this.bar.style.width = `${cm * 10 * camera.pxPerMm}px`;
      this.bar.textContent = `${cm} cm`.replace(".", this.words.point);
      this.legend.hidden = !this.shows.error;
      this.ghostHelp.hidden = !this.shows.ghost;
      if (this.tape.element) this.tape.element.hidden = !this.shows.tape;
    }

    /** Makes everything of the GPU anew after a lost context. */
    restore() {
      this.gpu = new Gpu(this.gl, this.scene.legs);
      this.redraw();
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
    const { patient } = options || {};
    const words = globalThis.gaiterViewerWords;
    const title = patient ? `${words.title} – ${patient}` : words.title;
    const scene = readScene(record);
    const root = make("section", { class: "gaiter-viewer", lang: words.tag, "aria-label": title });
    element.replaceChildren(root);
    const gl = scene.legs.length ? openWebgl() : null;
    if (!gl) {
      root.append(make("p", {}, scene.legs.length ? words.no_webgl : words[scene.note]));
      return { destroy: () => root.remove() };
    }
    adoptStyle();
    const viewer = new Viewer(root, gl, scene, words, title);
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
