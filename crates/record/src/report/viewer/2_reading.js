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

  /** A grid that is closed around, with pairs of error in mm and 1 where it was seen; or null. Rows of which
   *  a point was not seen have no triangles. */
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
    const isSeen = Array.from({ length: rows }, (_, row) =>
      points.subarray(3 * row * columns, 3 * (row + 1) * columns).every((part) => part > UNSEEN / 10));
    return { rows, columns, points, errors, isSeen, normals: normalsOf(rows, columns, points), triangles: trianglesOf(rows, columns, isSeen) };
  }

  /** A mesh of points and triangles; or null. */
  function readMesh(source) {
    const [points, triangles] = [readPoints(source.points), readIntegers(source.triangles)];
    if (!points || !triangles || triangles.length % 3 !== 0) return null;
    if (triangles.some((index) => index < 0 || 3 * index >= points.length)) return null;
    return { points, triangles: Uint32Array.from(triangles), errors: null, normals: meshNormalsOf(points, triangles) };
  }

  /** The frame of a leg: where its shank's axis meets the floor, and unit vectors; or null. */
  function readFrame(axis) {
    if (!isObject(axis)) return null;
    const frame = { foot: axis.foot_mm, arms: [axis.front, axis.lateral, axis.direction] };
    return isPoint(frame.foot) && frame.arms.every((arm) => isPoint(arm) && Math.abs(Math.hypot(...arm) - 1) < 0.01) ? frame : null;
  }

  /** A section as a ring: its points, its centre and a thin tube to draw; or null. */
  function readRing(section) {
    const { centre_mm: centre, front, lateral, radius_mm: radii } = section.outline;
    if (!isName(section.level) || ![centre, front, lateral].every(isPoint)) return null;
    if (!Array.isArray(radii) || radii.length < 3 || radii.length > 720 || !radii.every(isPlace)) return null;
    const across = [0, 1, 2].map((k) => front[(k + 1) % 3] * lateral[(k + 2) % 3] - front[(k + 2) % 3] * lateral[(k + 1) % 3]);
    const up = across.map((part) => part * Math.sign(across[2]));
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
    const normals = normalsOf(sides + 1, columns, tube);
    const grid = { points: tube, errors: null, normals, triangles: trianglesOf(sides + 1, columns) };
    return { level: section.level, centre, outline: radii.map((_, index) => at(index, 0, 0)), grid };
  }

  const hasDoubts = ({ doubts }) => Array.isArray(doubts) && doubts.length > 0;

  /** The levels that have a ring, a girth or both. */
  function readLevels(source, rings) {
    const levels = new Map(rings.map((ring) => [ring.level, { level: ring.level, ring, place: ring.centre, girthMm: null, heightMm: null }]));
    const { foot_mm: foot, direction } = isObject(source.axis) ? source.axis : {};
    const landmarks = isObject(source.landmarks) ? Object.entries(source.landmarks) : [];
    for (const [level, landmark] of landmarks.slice(0, MOST_ITEMS)) {
      if (!isName(level) || !isObject(landmark) || !isPlace(landmark.girth_tape_mm)) continue;
      const [along, centre] = [landmark.along_axis_mm, landmark.centre_mm];
      if (!levels.has(level) && isPoint(centre)) {
        levels.set(level, { level, ring: null, place: centre });
      } else if (!levels.has(level) && isPlace(along) && isPoint(foot) && isPoint(direction)) {
        levels.set(level, { level, ring: null, place: foot.map((f, k) => f + along * direction[k]) });
      }
      if (!levels.has(level)) continue;
      const heightMm = isPlace(landmark.height_mm) ? landmark.height_mm : null;
      Object.assign(levels.get(level), { girthMm: landmark.girth_tape_mm, heightMm, isDoubted: hasDoubts(landmark) });
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
      read(section.outline, () => readRing(section))).filter((ring) => ring !== null);
    const centres = new Map(rings.map((ring) => [ring.level, ring.centre]));
    const features = list(source.features, (feature) => {
      const { level, label, kind, position_mm: place } = feature;
      if (!isName(level) || !isName(label) || !["peak", "valley"].includes(kind) || !isPoint(place)) return null;
      return { level, label, kind, place, centre: centres.get(level) || null };
    });
    const leg = {
      side: source.side,
      frame: readFrame(source.axis),
      skin: read(shape.skin, readGrid),
      foot: read(shape.foot, readMesh),
      surface: read(shape.surface, readGrid),
      scan: read(shape.scan, (scan) => readPoints(scan.points)),
      levels: readLevels(source, rings),
      features,
      runs: read(source.girth_curve, readRuns) || [],
      doubtedMm: list(source.profile, (row) => row).filter((row) => isPlace(row.height_mm) && hasDoubts(row)).map((row) => row.height_mm),
    };
    if (!leg.skin && !leg.surface && !leg.scan) return null;
    const tube = leg.skin || leg.surface;
    // Scans without triangles have no mesh of the foot; its points stand for it.
    const rows = leg.skin ? rowsOf(leg.skin) : [];
    const lowestMm = rows.length ? rows[0].heightMm : Infinity;
    const dots = leg.foot || !leg.scan ? [] : [...leg.scan].filter((_, at) => leg.scan[at - at % 3 + 2] < lowestMm);
    Object.assign(leg, { rows, footDots: Float32Array.from(dots) });
    const clouds = [leg.skin, leg.surface, leg.foot].filter(Boolean).map((grid) => grid.points);
    return Object.assign(leg, { box: boxOf([...clouds, leg.footDots]), balls: ballsOf(tube) });
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
    if (legs.length === 0) return { legs, note: damaged ? "unreadable" : "no_shape" };
    for (const leg of legs) {
      const other = legs.find((one) => one !== leg && one.frame && leg.frame);
      leg.ghost = other ? [other.skin, other.foot].filter(Boolean).map((grid) => mirroredOnto(grid, other.frame, leg.frame)) : [];
    }
    // The patient's right leg first, as everywhere in the report.
    legs.sort((a, b) => (a.side < b.side ? 1 : -1));
    return { legs, note: damaged ? "damaged" : null, box: boxOf(legs.map((leg) => leg.box)), tapeMm: tapeRange(legs) };
  }

