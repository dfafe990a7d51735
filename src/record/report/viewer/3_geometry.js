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

