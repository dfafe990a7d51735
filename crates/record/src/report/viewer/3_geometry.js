  // ---- Geometry ----

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const plus = (a, b, times) => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unitOf = (vector) => vector.map((part) => part / (Math.hypot(...vector) || 1));
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

  /** Normals of a mesh's points, of triangles weighed by their size. */
  function meshNormalsOf(points, triangles) {
    const sums = new Float32Array(points.length);
    let outwards = 0;
    for (let at = 0; at < triangles.length; at += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => pointAt(points, triangles[at + k]));
      const normal = cross(minus(b, a), minus(c, a));
      outwards += dot(normal, a); // Six times the volume, less what is open.
      for (let k = 0; k < 3; k += 1) normal.forEach((part, axis) => { sums[3 * triangles[at + k] + axis] += part; });
    }
    const sign = outwards < 0 ? -1 : 1;
    return sums.map((part, at) => sign * part / (Math.hypot(...pointAt(sums, (at - at % 3) / 3)) || 1));
  }

  /** Two triangles for each cell of a grid that is closed around, between rows that were seen. */
  function trianglesOf(rows, columns, isSeen = null) {
    const triangles = [];
    for (let cell = 0; cell < (rows - 1) * columns; cell += 1) {
      const row = Math.floor(cell / columns);
      if (isSeen && !(isSeen[row] && isSeen[row + 1])) continue;
      const next = cell % columns === columns - 1 ? cell + 1 - columns : cell + 1;
      triangles.push(cell, next, next + columns, cell, next + columns, cell + columns);
    }
    return Uint32Array.from(triangles);
  }

  /** The seen rows of a grid upwards, each with its points and their mean height. */
  function rowsOf({ rows, columns, points, isSeen }) {
    const of = (row) => Array.from({ length: columns }, (_, column) => [...pointAt(points, row * columns + column)]);
    return Array.from({ length: rows }, (_, row) => row).filter((row) => isSeen[row]).map((row) => {
      const places = of(row);
      return { places, heightMm: places.reduce((sum, place) => sum + place[2], 0) / columns };
    });
  }

  /** The middle of a closed curve and the unit normal of its plane. */
  function planeOf(places) {
    const middle = [0, 1, 2].map((k) => places.reduce((sum, place) => sum + place[k], 0) / places.length);
    const area = places.reduce((sum, place, at) =>
      plus(sum, cross(minus(place, middle), minus(places[(at + 1) % places.length], middle)), 1), [0, 0, 0]);
    return { middle, normal: unitOf(area) };
  }

  /** The convex hull of a closed, nearly plane curve, in its order: the way of a tape, which bridges hollows. */
  function hullOf(places) {
    const { middle, normal } = planeOf(places);
    const u = unitOf(minus(places[0], middle));
    const v = cross(normal, u);
    const flat = places.map((place) => ({ place, at: [dot(minus(place, middle), u), dot(minus(place, middle), v)] }));
    flat.sort((a, b) => a.at[0] - b.at[0] || a.at[1] - b.at[1]);
    const turns = (a, b, c) => (b.at[0] - a.at[0]) * (c.at[1] - a.at[1]) - (b.at[1] - a.at[1]) * (c.at[0] - a.at[0]);
    const half = (points) => {
      const chain = [];
      for (const point of points) {
        while (chain.length > 1 && turns(chain.at(-2), chain.at(-1), point) <= 0) chain.pop();
        chain.push(point);
      }
      return chain.slice(0, -1);
    };
    return [...half(flat), ...half([...flat].reverse())].map(({ place }) => place);
  }

  /** The lowest and the highest corner around clouds of triples, as six numbers. */
  function boxOf(clouds) {
    const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    for (const cloud of clouds) {
      cloud.forEach((value, at) => {
        if (value <= UNSEEN / 10) return;
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
      if (!grid.isSeen[row]) continue;
      const box = boxOf([grid.points.subarray(3 * row * grid.columns, 3 * (row + 1) * grid.columns)]);
      balls.push({ centre: middleOf(box), radius: Math.min(box[3] - box[0], box[4] - box[1]) / 2 });
    }
    return balls;
  }

