  // ---- Tape: what it reads at a height, and the curve along which it lies. ----
  //
  // The girth is read off the record's girth curve, which was cut from the scan every 5 mm, and not off the
  // drawn skin, which has a row every 10 mm and 48 points a row. A cubic through the curve's rows met the
  // record's own sections between them to 0.1 mm on bodies that stand straight and to 0.6 mm on sick legs and
  // bent knees; the length of the drawn curve was off by up to 0.9 mm, and by 8 mm at a fold. At a level the
  // tape tells the level's own girth, so that its digits are those of the measuring sheet. The curve is drawn
  // through the skin's rows, which lie in the planes of the tape.

  /** The pieces of a girth curve without a gap: pairs of height and girth, mm, ascending. */
  function readRuns({ height_mm: heights, tape_mm: girths }) {
    if (!Array.isArray(heights) || !Array.isArray(girths) || heights.length !== girths.length) return null;
    const runs = [[]];
    heights.slice(0, MOST_POINTS).forEach((height, at) => {
      if (!isPlace(height) || !isPlace(girths[at])) {
        runs.push([]);
        return;
      }
      const last = runs.at(-1).at(-1);
      if (last && height <= last[0]) return;
      if (last && height - last[0] > CURVE_GAP_MM) runs.push([]);
      runs.at(-1).push([height, girths[at]]);
    });
    return runs.filter((run) => run.length > 1);
  }

  /** The girth between rows of the curve: Hermite's cubic with the slopes between each row's neighbours. */
  function curveGirthMm(runs, heightMm) {
    const run = runs.find((one) => one[0][0] <= heightMm && heightMm <= one.at(-1)[0]);
    if (!run) return null;
    const at = Math.min(run.length - 2, run.findLastIndex(([height]) => height <= heightMm));
    const slope = (index) => {
      const [before, behind] = [run[Math.max(0, index - 1)], run[Math.min(run.length - 1, index + 1)]];
      return (behind[1] - before[1]) / (behind[0] - before[0]);
    };
    const [[low, lowMm], [high, highMm]] = [run[at], run[at + 1]];
    const [span, t] = [high - low, (heightMm - low) / (high - low)];
    return lowMm + t * t * (3 - 2 * t) * (highMm - lowMm)
      + span * t * (1 - t) * ((1 - t) * slope(at) - t * slope(at + 1));
  }

  /** What a tape reads on a leg at a height: girth, whether there is a doubt, the level if there is one; or null. */
  function tapeReading(leg, heightMm) {
    const level = leg.levels.find((one) => one.ring && one.girthMm !== null && one.heightMm !== null
      && Math.abs(one.heightMm - heightMm) <= AT_LEVEL_MM);
    if (level) return { girthMm: level.girthMm, isDoubted: level.isDoubted, level: level.level };
    const girthMm = curveGirthMm(leg.runs, heightMm);
    const isDoubted = leg.doubtedMm.some((doubtedMm) => Math.abs(doubtedMm - heightMm) <= DOUBT_REACH_MM);
    return girthMm === null ? null : { girthMm, isDoubted, level: null };
  }

  /** The closed curve of the tape on the drawn skin, in its order; or null where the skin is open. */
  function tapeCurve({ rows }, heightMm) {
    const above = rows.findIndex((row) => row.heightMm >= heightMm);
    const [low, high] = [rows[Math.max(0, above - 1)], rows[above]];
    if (above < 0 || (above === 0 && high.heightMm > heightMm)) return null;
    const spanMm = high.heightMm - low.heightMm;
    if (spanMm > SKIN_GAP_MM) return null;
    const share = spanMm > 0 ? (heightMm - low.heightMm) / spanMm : 0;
    return hullOf(low.places.map((place, at) => plus(place, minus(high.places[at], place), share)));
  }

  /** The heights that a tape can take on any of the legs, mm; or null. */
  function tapeRange(legs) {
    const ends = legs.flatMap(({ runs, rows }) => {
      const [low, high] = rows.length ? [rows[0].heightMm, rows.at(-1).heightMm] : [-Infinity, Infinity];
      return runs.flatMap((run) => [Math.max(low, run[0][0]), Math.min(high, run.at(-1)[0])]);
    });
    const range = [Math.ceil(Math.min(...ends)), Math.floor(Math.max(...ends))];
    return range[0] < range[1] && range.every(Number.isFinite) ? range : null;
  }

  /** The heights of the levels of these legs, ascending, mm. */
  function levelHeights(legs) {
    const heights = legs.flatMap(({ levels }) => levels.filter((level) => level.ring).map((level) => level.heightMm));
    return heights.filter((height) => height !== null).sort((a, b) => a - b);
  }

  /** A band around a curve, this far up and down from it, as a mesh. */
  function bandOf(curve, halfMm) {
    const { normal } = planeOf(curve);
    const up = normal.map((part) => part * Math.sign(normal[2]));
    const points = Float32Array.from([-halfMm, halfMm].flatMap((upMm) => curve.flatMap((place) => plus(place, up, upMm))));
    return { points, errors: null, normals: normalsOf(2, curve.length, points), triangles: trianglesOf(2, curve.length) };
  }

  /** A leg's skin and foot laid over another leg, mirrored: the same place in front of, beside and along the
   *  shank's axis. Lateral is outwards on either leg, so that this mirrors. */
  function mirroredOnto(grid, from, onto) {
    const linear = (vector) => onto.arms.reduce((sum, arm, k) => plus(sum, arm, dot(vector, from.arms[k])), [0, 0, 0]);
    const [points, normals] = [new Float32Array(grid.points.length), new Float32Array(grid.points.length)];
    for (let at = 0; at < points.length; at += 3) {
      points.set(plus(linear(minus(pointAt(grid.points, at / 3), from.foot)), onto.foot, 1), at);
      normals.set(linear(pointAt(grid.normals, at / 3)), at);
    }
    return { points, normals, errors: null, triangles: grid.triangles };
  }

