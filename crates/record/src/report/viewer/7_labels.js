  // ---- Labels: what is named in the picture, and where each name finds room. ----

  /** Girth in cm by the record's one rule: one decimal, half away from zero. */
  const inCm = (mm, words) => (Math.round(mm) / 10).toFixed(1).replace(".", words.point);

  /** An element; all text goes in as text. */
  function make(name, attributes, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
  }

  class Labels {
    constructor(viewer) {
      const { camera, scene, words, shows } = viewer;
      Object.assign(this, { viewer, camera, scene, words, shows, overlay: make("div", { "aria-hidden": "true" }) });
      this.tags = this.makeTags();
    }

    /** The labels, most important first: sides, the tape's girths, the feature point under the pointer, levels, others. */
    makeTags() {
      const { words, scene, shows } = this;
      const tag = (kind, rank, leg, places, say) => {
        const made = { rank, leg, places, say, size: [0, 0], text: make("span", { class: `gaiter-${kind}` }), line: make("i", {}) };
        for (const { style } of [made.text, made.line]) style.color = `var(--v-${leg.side})`;
        this.overlay.append(made.line, made.text);
        return made;
      };
      const doubt = (isDoubted) => (isDoubted ? " ?" : "");
      return scene.legs.flatMap((leg) => [
        tag("side", () => 0, leg, (size) => this.besideLeg(leg, size), () =>
          (this.isNarrow() ? words[`${leg.side}_letter`] : `${words[`${leg.side}_letter`]} – ${words[`${leg.side}_leg`]}`)),
        tag("reading", () => 1, leg, (size) => this.besideTape(leg, size), () => {
          const reading = this.viewer.tape.readings.get(leg);
          const letter = this.isNarrow() ? "" : `${words[`${leg.side}_letter`]} `;
          return reading ? `${letter}${inCm(reading.girthMm, words)}${doubt(reading.isDoubted)}` : "";
        }),
        ...leg.levels.map((level) => tag("level", () => 3, leg, (size, anchors) => this.besideLevel(leg, level, size, anchors), () =>
          (shows.landmarks && level.girthMm !== null
            ? `${this.prefix(leg)}c${level.level} ${inCm(level.girthMm, words)}${doubt(level.isDoubted)}` : `${this.prefix(leg)}${level.level}`))),
        ...leg.features.map((feature) => tag("feature", () => (feature === this.viewer.hovered ? 2 : 4), leg, (size) => this.besideFeature(leg, feature, size), () =>
          (feature === this.viewer.hovered ? [feature.label, feature.level, words[leg.side], words[feature.kind]].join(" · ") : feature.label))),
      ]);
    }

    isNarrow() {
      return this.camera.width < NARROW_PX;
    }

    /** How far a leg is to the right of the other one on the canvas, px; 1 where it is alone. */
    awayPx(leg) {
      const x = ({ box }) => this.camera.project(middleOf(box))[0];
      const other = this.scene.legs.find((one) => one !== leg);
      return other ? x(leg) - x(other) : 1;
    }

    /** Where the legs stand behind one another, colour alone does not say whose a level is. */
    prefix(leg) {
      const widthPx = (leg.box[3] - leg.box[0]) * this.camera.pxPerMm;
      const isAlone = this.scene.legs.filter(({ side }) => this.shows[side]).length < 2;
      return isAlone || Math.abs(this.awayPx(leg)) > widthPx / 2 ? "" : `${this.words[`${leg.side}_letter`]} `;
    }

    /** The way to the side away from the other leg: −1 or 1. Seen from the side the legs stand behind one
     *  another; then the left one's labels are on the right. */
    outward(leg) {
      const away = this.awayPx(leg);
      return Math.sign(Math.abs(away) > 1 ? away : (leg.side === "left") - 0.5);
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

    /** At the tape, where there is room: between the legs, outside, over and under it. */
    besideTape(leg, [width, height]) {
      const { camera, viewer } = this;
      const curve = viewer.tape.curves.get(leg);
      if (!this.shows.tape || !curve || !viewer.tape.readings.get(leg)) return [];
      const places = curve.map((place) => camera.project(place));
      const [low, high] = [Math.min(...places.map(([x]) => x)), Math.max(...places.map(([x]) => x))];
      const way = -this.outward(leg);
      const beside = (side) => places.reduce((most, one) => (side * one[0] > side * most[0] ? one : most));
      const leader = this.isNarrow() ? LEADER_PX / 2 : LEADER_PX;
      const at = (side, lines = 0) => [beside(side)[0] + (side < 0 ? -width - leader : leader),
        beside(side)[1] + (lines - 0.5) * height, ...beside(side), side < 0 ? width : 0, height / 2];
      const [middle, top, foot] = [(low + high - width) / 2, Math.min(...places.map(([, y]) => y)), Math.max(...places.map(([, y]) => y))];
      const clear = 2 * GRAB_PX;
      return [at(way), at(way, 1), at(way, -1), [middle, top - height - clear], [middle, foot + clear], at(-way)];
    }

    /** Beside the legs, on the side away from the other leg, with a line from the section. */
    besideLevel(leg, level, [width, height], anchors) {
      const { camera, shows } = this;
      if (!(shows.sections && level.ring) && !(shows.landmarks && level.girthMm !== null)) return [];
      const way = this.outward(leg);
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
      const { camera, shows, viewer } = this;
      const asked = feature === viewer.hovered || camera.pxPerMm > NEAR_PX_PER_MM || viewer.canvas.matches(":focus-visible");
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
    place() {
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

    /** A line from a level's section or the tape to its label; other labels have none. */
    drawLine(line, [left, top, fromX, fromY, atX, atY]) {
      line.hidden = fromX === undefined;
      if (line.hidden) return;
      const [x, y] = [left + atX - fromX, top + atY - fromY];
      line.style.width = `${Math.hypot(x, y)}px`;
      line.style.transform = `translate(${fromX}px, ${fromY}px) rotate(${Math.atan2(y, x)}rad)`;
    }
  }

