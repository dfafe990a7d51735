// The 3D view of a record's legs in plain WebGL: one file, no library, no network.
//
// `gaiterViewer.mount(element, record, {language: "en"|"de"})` fills `element` with the view of a
// parsed record.json and returns `{destroy()}`. A record without shapes, a damaged one or a browser
// without WebGL gives a sentence. Downwards: words → reading → geometry → camera → GPU → labels → page.
// Lengths are millimetres in the body frame: +Z up, −Y where the toes point, +X the patient's left.
"use strict";

globalThis.gaiterViewer = (() => {
  const WORDS = {
    en: {
      title: "3D view of the legs", look: "View", show: "Show", point: ".",
      front: "Front", back: "Back", fromLeft: "Patient's left", fromRight: "Patient's right", feet: "From below",
      nearer: "Zoom in", farther: "Zoom out", reset: "Reset",
      left: "left", right: "right", leftLeg: "Left leg", rightLeg: "Right leg",
      scan: "Scan points", skin: "Skin", surface: "Surface", error: "Error of the surface",
      sections: "Sections", landmarks: "Levels with girth", features: "Feature points",
      peak: "peak", valley: "valley", unseen: "not seen",
      legend: "Skin outside (+) or inside (−) the surface, mm",
      help: "Drag or arrow keys turn; wheel, pinch, + and − zoom; shift and drag, two fingers or shift and arrow keys move; double click or 0 resets.",
      noShape: "This record holds no shape of the legs, so there is nothing to show in 3D.",
      unreadable: "The shape of the legs in this record is damaged and cannot be shown.",
      damaged: "Parts of the shape in this record are damaged and are left out.",
      noWebgl: "This browser cannot show the 3D view (no WebGL).",
    },
    de: {
      title: "3D-Ansicht der Beine", look: "Ansicht", show: "Zeigen", point: ",",
      front: "Vorn", back: "Hinten", fromLeft: "Links (Patient)", fromRight: "Rechts (Patient)", feet: "Von unten",
      nearer: "Vergrößern", farther: "Verkleinern", reset: "Zurücksetzen",
      left: "links", right: "rechts", leftLeg: "Linkes Bein", rightLeg: "Rechtes Bein",
      scan: "Scanpunkte", skin: "Haut", surface: "Oberfläche", error: "Fehler der Oberfläche",
      sections: "Schnitte", landmarks: "Messstellen mit Umfang", features: "Merkmalspunkte",
      peak: "Gipfel", valley: "Tal", unseen: "nicht gesehen",
      legend: "Haut außerhalb (+) oder innerhalb (−) der Oberfläche, mm",
      help: "Ziehen oder Pfeiltasten drehen; Mausrad, zwei Finger, + und − vergrößern oder verkleinern; Umschalttaste und Ziehen, zwei Finger oder Umschalttaste und Pfeiltasten verschieben; Doppelklick oder 0 setzt zurück.",
      noShape: "Dieser Datensatz enthält keine Form der Beine; in 3D gibt es nichts zu zeigen.",
      unreadable: "Die Form der Beine in diesem Datensatz ist beschädigt und kann nicht gezeigt werden.",
      damaged: "Teile der Form in diesem Datensatz sind beschädigt und fehlen hier.",
      noWebgl: "Dieser Browser kann die 3D-Ansicht nicht zeigen (kein WebGL).",
    },
  };

  // Colours in the light and the dark theme; a page may set `--gaiter-NAME`. Error colours run
  // blue–white–orange, which colour-blind people tell apart.
  const COLOURS = {
    ground: ["#f6f7f9", "#14181e"], ink: ["#1b2430", "#e8ecf1"], line: ["#747d8a", "#8993a1"],
    left: ["#00695a", "#4fd1b5"], right: ["#ab2a1d", "#ff937f"],
    scan: ["#3a3f4a", "#d5dae2"], skin: ["#d3bba7", "#b79f8c"], surface: ["#86aed0", "#6d97bb"],
    peak: ["#ffb000", "#ffb000"], valley: ["#6a3df0", "#9a7bff"],
    below: ["#1f5fb0", "#2f74cc"], middle: ["#f7f7f4", "#f7f7f4"], above: ["#b85a00", "#d96f0a"],
    unseen: ["#8b8d90", "#77797c"], rim: ["#16181c", "#16181c"], focus: ["#0b57d0", "#8ab4f8"],
  };

  const VIEWS = { front: [0, 0], back: [180, 0], fromLeft: [90, 0], fromRight: [-90, 0], feet: [0, -90] }; // yaw, pitch in degrees
  const START = [0, 12]; // The view at first and after a reset: from the front, a little from above.
  const LAYERS = ["scan", "skin", "surface", "error", "sections", "landmarks", "features"];
  const SHOWN_FIRST = ["skin", "surface", "sections", "landmarks", "features"];

  const MOST_POINTS = 400_000; // Of one grid or cloud: more would not be a record of ours.
  const MOST_ITEMS = 100; // Of sections, levels and feature points of a leg each.
  const FARTHEST_MM = 4000; // No coordinate of a body lies farther out.
  const UNSEEN = -32768; // Stands in error grids where nothing was seen.
  const RING_MM = 1.3; // Half the thickness of a drawn section.
  // How far layers that lie on one another are lifted towards the eye, so that they do not flicker.
  const LIFT_MM = { skin: 0, surface: 1, error: 1.3, scan: 1.8, ring: 2, feature: 4, landmark: 2000 };
  const TURN_DEG_PER_PX = 0.4, KEY_TURN_DEG = 10, KEY_MOVE_PX = 40, KEY_ZOOM = 1.25;
  const ZOOM = [0.5, 40]; // Least and most, 1 fits the legs into the canvas.
  const MARGIN_PX = [130, 46]; // Room for labels beside and over the legs.
  const LEADER_PX = 16; // From the legs to the label of a level.
  const MOST_CANVAS_PX = 4096, MOST_BAR_PX = 120;
  const ZOOM_PER_WHEEL_PX = 0.0015;
  const NEAR_PX_PER_MM = 1.5; // From here on feature points show their labels.
  const HOVER_PX = 14; // A pointer this near to a feature point shows its label.
  const SCROLL_PAUSE_MS = 300; // Wheel turns closer together are one scroll of the page.
  const WHEEL_LINE_PX = 30; // What a wheel's line is worth where a browser counts lines.

  // ---- Reading: a record of any kind → what can be drawn. Nothing is trusted. ----

  const isObject = (value) => typeof value === "object" && value !== null;
  const isPlace = (value) => typeof value === "number" && Math.abs(value) <= FARTHEST_MM;
  const isPoint = (value) => Array.isArray(value) && value.length === 3 && value.every(isPlace);
  const isName = (value) => typeof value === "string" && value.length > 0 && value.length <= 12;
  const isCount = (value, least) => Number.isInteger(value) && value >= least && value <= MOST_POINTS;

  /** Little-endian 16-bit integers out of base64, or null. */
  function readIntegers(text) {
    if (typeof text !== "string" || text.length > MOST_POINTS * 8) return null;
    let bytes;
    try {
      bytes = atob(text);
    } catch {
      return null;
    }
    if (bytes.length === 0 || bytes.length % 2 !== 0) return null;
    return Int16Array.from({ length: bytes.length / 2 }, (_, at) =>
      bytes.charCodeAt(2 * at) | (bytes.charCodeAt(2 * at + 1) << 8));
  }

  /** Points as x, y, z triples in mm, out of base64 in 0.1 mm, or null. */
  function readPoints(text) {
    const integers = readIntegers(text);
    return integers && integers.length % 3 === 0 ? Float32Array.from(integers, (tenths) => tenths / 10) : null;
  }

  /** A grid that is closed around, with pairs of error in mm and 1 where it was seen; or null. */
  function readGrid(source) {
    const { rows, columns } = source;
    if (!isCount(rows, 2) || !isCount(columns, 3) || rows * columns > MOST_POINTS) return null;
    const points = readPoints(source.points);
    if (!points || points.length !== 3 * rows * columns) return null;
    let errors = null;
    if (source.error !== undefined && source.error !== null) {
      const hundredths = readIntegers(source.error);
      if (!hundredths || hundredths.length !== rows * columns) return null;
      errors = new Float32Array(2 * rows * columns);
      hundredths.forEach((value, at) => errors.set(value === UNSEEN ? [0, 0] : [value / 100, 1], 2 * at));
    }
    return { rows, columns, points, errors, normals: normalsOf(rows, columns, points) };
  }

  /** A section as a ring: its points, its centre and a thin tube to draw; or null. */
  function readRing(section, axis) {
    const { centre_mm: centre, radius_mm: radii } = section.outline;
    const axes = isObject(axis) ? [axis.front, axis.lateral, axis.direction] : [];
    if (!isName(section.level) || !isPoint(centre) || axes.length !== 3 || !axes.every(isPoint)) return null;
    if (!Array.isArray(radii) || radii.length < 3 || radii.length > 720 || !radii.every(isPlace)) return null;
    const [front, lateral, up] = axes;
    const at = (index, outMm, upMm) => {
      const angle = (2 * index / radii.length - 1) * Math.PI;
      const [forth, aside] = [Math.cos(angle), Math.sin(angle)].map((part) => part * (radii[index] + outMm));
      return centre.map((c, k) => c + forth * front[k] + aside * lateral[k] + upMm * up[k]);
    };
    const [sides, columns] = [6, radii.length];
    const tube = new Float32Array((sides + 1) * columns * 3);
    for (let cell = 0; cell < (sides + 1) * columns; cell += 1) {
      const around = 2 * Math.PI * Math.floor(cell / columns) / sides;
      tube.set(at(cell % columns, RING_MM * Math.sin(around), RING_MM * Math.cos(around)), 3 * cell);
    }
    const grid = { rows: sides + 1, columns, points: tube, errors: null, normals: normalsOf(sides + 1, columns, tube) };
    return { level: section.level, centre, outline: radii.map((_, index) => at(index, 0, 0)), grid };
  }

  /** The levels that have a ring, a girth or both. */
  function readLevels(source, rings) {
    const levels = new Map(rings.map((ring) => [ring.level, { level: ring.level, ring, place: ring.centre, girthMm: null }]));
    const { foot_mm: foot, direction } = isObject(source.axis) ? source.axis : {};
    const landmarks = isObject(source.landmarks) ? Object.entries(source.landmarks) : [];
    for (const [level, landmark] of landmarks.slice(0, MOST_ITEMS)) {
      if (!isName(level) || !isObject(landmark) || !isPlace(landmark.girth_tape_mm)) continue;
      const along = landmark.along_axis_mm;
      if (!levels.has(level) && isPlace(along) && isPoint(foot) && isPoint(direction)) {
        levels.set(level, { level, ring: null, place: foot.map((f, k) => f + along * direction[k]) });
      }
      if (!levels.has(level)) continue;
      const isDoubted = Array.isArray(landmark.doubts) && landmark.doubts.length > 0;
      Object.assign(levels.get(level), { girthMm: landmark.girth_tape_mm, isDoubted });
    }
    // Where labels compete for room, B, C and D go before B1.
    return [...levels.values()].sort((a, b) => a.level.length - b.level.length);
  }

  /** One leg; `damage` is called for every part that is there and cannot be read. */
  function readLeg(source, damage) {
    const read = (value, reader) => {
      if (value === undefined || value === null) return null;
      const found = isObject(value) ? reader(value) : null;
      if (found === null) damage();
      return found;
    };
    const list = (value, reader) => (Array.isArray(value) ? value.slice(0, MOST_ITEMS) : [])
      .map((item) => read(item, reader)).filter((item) => item !== null);
    const shape = read(source.shape, (value) => value);
    if (!shape) return null;
    const rings = list(source.sections, (section) => section).map((section) =>
      read(section.outline, () => readRing(section, source.axis))).filter((ring) => ring !== null);
    const centres = new Map(rings.map((ring) => [ring.level, ring.centre]));
    const features = list(source.features, (feature) => {
      const { level, label, kind, position_mm: place } = feature;
      if (!isName(level) || !isName(label) || !["peak", "valley"].includes(kind) || !isPoint(place)) return null;
      return { level, label, kind, place, centre: centres.get(level) || null };
    });
    const leg = {
      side: source.side,
      skin: read(shape.skin, readGrid),
      surface: read(shape.surface, readGrid),
      scan: read(shape.scan, (scan) => readPoints(scan.points)),
      levels: readLevels(source, rings),
      features,
    };
    if (!leg.skin && !leg.surface && !leg.scan) return null;
    const clouds = [leg.skin && leg.skin.points, leg.surface && leg.surface.points, leg.scan].filter(Boolean);
    return Object.assign(leg, { box: boxOf(clouds), balls: ballsOf(leg.skin || leg.surface) });
  }

  /** What of a record can be drawn, and the key of a sentence about the rest or null. */
  function readScene(record) {
    const [legs, sources] = [[], isObject(record) && Array.isArray(record.legs) ? record.legs : []];
    let damaged = false;
    for (const source of sources.filter(isObject)) {
      const known = ["left", "right"].includes(source.side) && !legs.some((leg) => leg.side === source.side);
      const leg = known ? readLeg(source, () => { damaged = true; }) : null;
      if (!known) damaged = true;
      if (leg) legs.push(leg);
    }
    if (legs.length === 0) return { legs, note: damaged ? "unreadable" : "noShape" };
    const errors = legs.map((leg) => leg.surface && leg.surface.errors).filter(Boolean);
    return { legs, note: damaged ? "damaged" : null, rangeMm: rangeOf(errors), box: boxOf(legs.map((leg) => leg.box)) };
  }

  // ---- Geometry ----

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const plus = (a, b, times) => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const middleOf = (box) => [0, 1, 2].map((k) => (box[k] + box[k + 3]) / 2);
  const pointAt = (points, index) => points.subarray(3 * index, 3 * index + 3);

  /** Unit normals of a grid that is closed around, turned outwards as a whole. */
  function normalsOf(rows, columns, points) {
    const normals = new Float32Array(points.length);
    let outwards = 0;
    for (let row = 0; row < rows; row += 1) {
      const at = (r, column) => pointAt(points, r * columns + (column + columns) % columns);
      const across = columns >> 1;
      for (let column = 0; column < columns; column += 1) {
        const east = minus(at(row, column + 1), at(row, column - 1));
        const north = minus(at(Math.min(row + 1, rows - 1), column), at(Math.max(row - 1, 0), column));
        const normal = cross(east, north);
        const length = Math.hypot(...normal) || 1;
        normals.set(normal.map((part) => part / length), 3 * (row * columns + column));
        outwards += dot(normal, minus(at(row, column), at(row, column + across)));
      }
    }
    return outwards < 0 ? normals.map((part) => -part) : normals;
  }

  /** Two triangles for each cell of a grid that is closed around. */
  function trianglesOf({ rows, columns }) {
    const triangles = new Uint32Array(6 * (rows - 1) * columns);
    for (let cell = 0; cell < (rows - 1) * columns; cell += 1) {
      const next = cell % columns === columns - 1 ? cell + 1 - columns : cell + 1;
      triangles.set([cell, next, next + columns, cell, next + columns, cell + columns], 6 * cell);
    }
    return triangles;
  }

  /** The lowest and the highest corner around clouds of triples, as six numbers. */
  function boxOf(clouds) {
    const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    for (const cloud of clouds) {
      cloud.forEach((value, at) => {
        const k = at % 3;
        box[k] = Math.min(box[k], value);
        box[k + 3] = Math.max(box[k + 3], value);
      });
    }
    return box;
  }

  /** A ball as wide as the leg for each row of a grid: enough to tell what the leg hides. */
  function ballsOf(grid) {
    const balls = [];
    for (let row = 0; grid && row < grid.rows; row += 1) {
      const box = boxOf([grid.points.subarray(3 * row * grid.columns, 3 * (row + 1) * grid.columns)]);
      balls.push({ centre: middleOf(box), radius: Math.min(box[3] - box[0], box[4] - box[1]) / 2 });
    }
    return balls;
  }

  /** The error at which the colours are full: a round number that 98 % of the errors stay under. */
  function rangeOf(grids) {
    const sizes = Float32Array.from(grids.flatMap((errors) =>
      [...errors].filter((_, at) => at % 2 === 0 && errors[at + 1] === 1).map(Math.abs))).sort();
    const most = Math.max(0.1, sizes.length ? sizes[Math.floor(0.98 * (sizes.length - 1))] : 0);
    return [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500].find((step) => step > most - 0.001);
  }

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
      const room = [this.width - 2 * Math.min(MARGIN_PX[0], this.width / 4), this.height - 2 * MARGIN_PX[1]];
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

  // ---- GPU: the only part that knows WebGL; all of it is made anew after a lost context. ----

  const VERTEX = `
    attribute vec3 position, normal;
    attribute vec2 error;
    uniform mat4 matrix;
    uniform vec3 towards;
    uniform float lift, size;
    varying vec3 across;
    varying vec2 off;
    void main() {
      across = normal;
      off = error;
      gl_Position = matrix * vec4(position + lift * towards, 1.0);
      gl_Position.z = max(gl_Position.z, -1.0);
      gl_PointSize = size;
    }`;

  // A headlight with a little sky; the inside of a leg is darker. Where `range` is 0 there is one colour.
  const MESH = `
    precision highp float;
    varying vec3 across;
    varying vec2 off;
    uniform vec3 towards, colour, below, middle, above, unseen;
    uniform float range;
    void main() {
      vec3 normal = normalize(across + vec3(0.0, 0.0, 1e-6));
      float facing = dot(normal, towards);
      vec3 base = colour;
      if (range > 0.0) {
        float share = clamp(off.x / range, -1.0, 1.0);
        base = off.y < 0.999 ? unseen : mix(middle, share < 0.0 ? below : above, abs(share));
      }
      float light = 0.42 + 0.1 * normal.z * sign(facing) + 0.56 * abs(facing);
      gl_FragColor = vec4(base * light * (facing < 0.0 ? 0.6 : 1.0), 1.0);
    }`;

  // Points as signs with a rim: 0 a dot, 1 a triangle upwards (peak), 2 downwards (valley), 3 a square.
  const SIGN = `
    precision highp float;
    uniform vec3 colour, rim;
    uniform float shape, size;
    void main() {
      vec2 at = gl_PointCoord * 2.0 - 1.0;
      if (shape == 2.0) at.y = -at.y;
      float inner = shape == 0.0 ? 1.0 - length(at)
        : shape == 3.0 ? 0.8 - max(abs(at.x), abs(at.y))
        : min(0.8 - at.y, (at.y + 1.0) * 0.5 - abs(at.x));
      if (inner < 0.0) discard;
      gl_FragColor = vec4(shape > 0.0 && inner < 3.0 / size ? rim : colour, 1.0);
    }`;

  class Gpu {
    constructor(gl, legs) {
      this.gl = gl;
      this.programs = { mesh: this.program(MESH), sign: this.program(SIGN) };
      this.legs = new Map(legs.map((leg) => [leg, {
        skin: this.mesh(leg.skin), surface: this.mesh(leg.surface),
        rings: leg.levels.filter((level) => level.ring).map((level) => this.mesh(level.ring.grid)),
        scan: leg.scan && this.buffer(leg.scan),
        ...Object.fromEntries(["peak", "valley"].map((kind) =>
          [kind, this.buffer(new Float32Array(leg.features.filter((f) => f.kind === kind).flatMap((f) => f.place)))])),
      }]));
      gl.enable(gl.DEPTH_TEST);
    }

    program(fragment) {
      const { gl } = this;
      const program = gl.createProgram();
      for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
      }
      ["position", "normal", "error"].forEach((name, index) => gl.bindAttribLocation(program, index, name));
      gl.linkProgram(program);
      return program;
    }

    buffer(values, kind = this.gl.ARRAY_BUFFER) {
      const { gl } = this;
      const handle = gl.createBuffer();
      gl.bindBuffer(kind, handle);
      gl.bufferData(kind, values, gl.STATIC_DRAW);
      return { handle, count: values.length };
    }

    mesh(grid) {
      return grid && {
        attributes: [grid.points, grid.normals, grid.errors].map((values) => values && this.buffer(values)),
        triangles: this.buffer(trianglesOf(grid), this.gl.ELEMENT_ARRAY_BUFFER),
      };
    }

    /** Chooses a program and sets its numbers, triples and, by its length, the matrix. */
    use(name, values) {
      const { gl } = this;
      gl.useProgram(this.programs[name]);
      for (const [key, value] of Object.entries({ ...this.common, ...values })) {
        const place = gl.getUniformLocation(this.programs[name], key);
        if (value.length === 16) gl.uniformMatrix4fv(place, false, value);
        else if (value.length === 3) gl.uniform3fv(place, value);
        else gl.uniform1f(place, value);
      }
    }

    /** Binds buffers to position, normal and error; what there is not is 0. */
    bind(buffers) {
      const { gl } = this;
      [3, 3, 2].forEach((size, index) => {
        gl.disableVertexAttribArray(index);
        if (!buffers[index]) return;
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers[index].handle);
        gl.enableVertexAttribArray(index);
        gl.vertexAttribPointer(index, size, gl.FLOAT, false, 0, 0);
      });
    }

    drawMesh(mesh, lift, colour, range = 0) {
      if (!mesh) return;
      const { gl } = this;
      this.use("mesh", { lift, colour, range });
      this.bind(mesh.attributes);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles.handle);
      gl.drawElements(gl.TRIANGLES, mesh.triangles.count, gl.UNSIGNED_INT, 0);
    }

    drawSigns(points, shape, sizePx, lift, colour) {
      if (!points || points.count === 0) return;
      this.use("sign", { shape, size: sizePx * this.pixelRatio, lift, colour });
      this.bind([points]);
      this.gl.drawArrays(this.gl.POINTS, 0, points.count / 3);
    }

    /** Draws one picture; `anchors` are the places where the levels' labels point, by leg. */
    draw(camera, colours, shows, rangeMm, anchors, pixelRatio) {
      const { gl } = this;
      const { below, middle, above, unseen } = colours;
      this.pixelRatio = pixelRatio;
      this.common = { matrix: camera.matrix(), towards: camera.towards, below, middle, above, unseen, rim: colours.rim };
      gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
      gl.clearColor(...colours.ground, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      for (const [leg, parts] of this.legs) {
        if (!shows[leg.side]) continue;
        if (shows.skin) this.drawMesh(parts.skin, LIFT_MM.skin, colours.skin);
        if (shows.surface) this.drawMesh(parts.surface, LIFT_MM.surface, colours.surface);
        if (shows.error) this.drawMesh(leg.surface && leg.surface.errors && parts.surface, LIFT_MM.error, colours.unseen, rangeMm);
        if (shows.sections) parts.rings.forEach((ring) => this.drawMesh(ring, LIFT_MM.ring, colours[leg.side]));
        if (shows.scan) this.drawSigns(parts.scan, 0, 2, LIFT_MM.scan, colours.scan);
        if (shows.features) this.drawSigns(parts.peak, 1, 13, LIFT_MM.feature, colours.peak);
        if (shows.features) this.drawSigns(parts.valley, 2, 13, LIFT_MM.feature, colours.valley);
        const squares = this.buffer(new Float32Array(anchors.get(leg).flat()));
        this.drawSigns(squares, 3, 8, LIFT_MM.landmark, colours[leg.side]);
        gl.deleteBuffer(squares.handle);
      }
    }
  }

  /** Girth in cm by the record's one rule: one decimal, half away from zero. */
  const inCm = (mm, words) => (Math.round(mm) / 10).toFixed(1).replace(".", words.point);

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
