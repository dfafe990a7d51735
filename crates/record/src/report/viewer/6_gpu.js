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

  // A headlight with a little sky; the inside of a leg is darker. Where `range` is 0 there is one colour;
  // else the light is even, so that colours are those of the legend, and what was not seen is hatched.
  const MESH = `
    precision highp float;
    varying vec3 across;
    varying vec2 off;
    uniform vec3 towards, colour, below, middle, above, unseen;
    uniform float range, ratio;
    void main() {
      vec3 normal = normalize(across + vec3(0.0, 0.0, 1e-6));
      float facing = dot(normal, towards);
      vec3 base = colour;
      if (range > 0.0) {
        float share = clamp(off.x / range, -1.0, 1.0);
        float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / (7.0 * ratio)));
        base = off.y < 0.999 ? unseen * (1.0 - 0.25 * stripe) : mix(middle, share < 0.0 ? below : above, abs(share));
      }
      float light = range > 0.0 ? 0.8 + 0.2 * abs(facing) : 0.42 + 0.1 * normal.z * sign(facing) + 0.56 * abs(facing);
      gl_FragColor = vec4(base * light * (facing < 0.0 ? 0.6 : 1.0), 1.0);
    }`;

  // The mirrored leg is translucent, less so at its rim, so that its outline is clear.
  const GHOST = `
    precision highp float;
    varying vec3 across;
    uniform vec3 towards, colour;
    void main() {
      float facing = abs(dot(normalize(across + vec3(0.0, 0.0, 1e-6)), towards));
      gl_FragColor = vec4(colour, 0.3 + 0.5 * (1.0 - facing));
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
      this.programs = { mesh: this.program(MESH), ghost: this.program(GHOST), sign: this.program(SIGN) };
      this.legs = new Map(legs.map((leg) => [leg, {
        skin: this.mesh(leg.skin), foot: this.mesh(leg.foot), surface: this.mesh(leg.surface),
        rings: leg.levels.filter((level) => level.ring).map((level) => this.mesh(level.ring.grid)),
        scan: leg.scan && this.buffer(leg.scan), footDots: this.buffer(leg.footDots),
        ghost: leg.ghost.map((grid) => this.mesh(grid)),
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
        triangles: this.buffer(grid.triangles, this.gl.ELEMENT_ARRAY_BUFFER),
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

    drawMesh(mesh, lift, colour, range = 0, program = "mesh") {
      if (!mesh) return;
      const { gl } = this;
      this.use(program, { lift, colour, range });
      this.bind(mesh.attributes);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles.handle);
      gl.drawElements(gl.TRIANGLES, mesh.triangles.count, gl.UNSIGNED_INT, 0);
    }

    /** Draws a mesh that is needed for one picture only. */
    drawOnce(grid, lift, colour) {
      const mesh = this.mesh(grid);
      this.drawMesh(mesh, lift, colour);
      for (const part of [...mesh.attributes, mesh.triangles]) if (part) this.gl.deleteBuffer(part.handle);
    }

    /** Draws meshes as one translucent body: its depth first, so that nothing of it shines through itself. */
    drawGhost(meshes, colour) {
      const { gl } = this;
      for (const isColour of [false, true]) {
        gl.colorMask(isColour, isColour, isColour, isColour);
        gl.depthFunc(gl.LEQUAL);
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
        meshes.forEach((mesh) => this.drawMesh(mesh, LIFT_MM.ghost, colour, 0, "ghost"));
      }
      gl.disable(gl.BLEND);
    }

    drawSigns(points, shape, sizePx, lift, colour) {
      if (!points || points.count === 0) return;
      this.use("sign", { shape, size: sizePx * this.pixelRatio, lift, colour });
      this.bind([points]);
      this.gl.drawArrays(this.gl.POINTS, 0, points.count / 3);
    }

    /** Draws one picture; `anchors` are the places where the levels' labels point and `tapes` the bands to
     *  draw, edge and face, by leg. */
    draw(camera, colours, shows, anchors, tapes, pixelRatio) {
      const { gl } = this;
      const { below, middle, above, unseen } = colours;
      this.pixelRatio = pixelRatio;
      this.common = { matrix: camera.matrix(), towards: camera.towards, below, middle, above, unseen, rim: colours.rim, ratio: pixelRatio };
      gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
      gl.clearColor(...colours.ground, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      for (const [leg, parts] of this.legs) {
        if (!shows[leg.side]) continue;
        if (shows.skin) this.drawMesh(parts.skin, LIFT_MM.skin, colours.skin);
        if (shows.skin) this.drawMesh(parts.foot, LIFT_MM.skin, colours.skin);
        if (shows.skin) this.drawSigns(parts.footDots, 0, 4, LIFT_MM.skin, colours.skin);
        if (shows.surface) this.drawMesh(parts.surface, LIFT_MM.surface, colours.surface);
        if (shows.error) this.drawMesh(leg.surface && leg.surface.errors && parts.surface, LIFT_MM.error, colours.unseen, ERROR_MM);
        if (shows.sections) parts.rings.forEach((ring) => this.drawMesh(ring, LIFT_MM.ring, colours[leg.side]));
        if (shows.scan) this.drawSigns(parts.scan, 0, 2, LIFT_MM.scan, colours.scan);
        if (shows.features) this.drawSigns(parts.peak, 1, 13, LIFT_MM.feature, colours.peak);
        if (shows.features) this.drawSigns(parts.valley, 2, 13, LIFT_MM.feature, colours.valley);
        (tapes.get(leg) || []).forEach((band, at) =>
          this.drawOnce(band, at ? LIFT_MM.tapeFace : LIFT_MM.tape, at ? colours.tape : colours.rim));
        const squares = this.buffer(new Float32Array(anchors.get(leg).flat()));
        this.drawSigns(squares, 3, 8, LIFT_MM.landmark, colours[leg.side]);
        gl.deleteBuffer(squares.handle);
      }
      // Last, because it lets shine through what lies behind it.
      for (const [leg, parts] of this.legs) {
        if (shows[leg.side] && shows.ghost) this.drawGhost(parts.ghost, colours[leg.side === "left" ? "right" : "left"]);
      }
    }
  }

