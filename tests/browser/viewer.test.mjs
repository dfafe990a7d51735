// The 3D view: what is drawn is true, and what a person does with it is answered.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { AXIS_X_MM, LEVELS_MM, TOP_MM, girthMm, leg, record } from "./synthetic_leg.mjs";
import { LAYERS, mount, picture, press, scrolled, settled, showOnly, start } from "./viewer_page.mjs";

/** The ground of the themes, as the viewer has it where a page says nothing. */
const GROUND = { light: [246, 247, 249], dark: [20, 24, 30] };

let browser;
before(async () => { browser = await start(); });
after(() => browser.close());

/** Runs a claim on a fresh page with a mounted record; nothing may fail on the way. */
async function viewing(claim, { given = record(), how = { language: "en" }, ...context } = {}) {
  const opened = await browser.open(context);
  await mount(opened.page, given, how);
  await claim(opened.page);
  assert.deepEqual(opened.faults, []);
  assert.deepEqual(await opened.violations(), []);
  await opened.close();
}

const isGround = (pixel, theme = "light") => pixel.every((part, k) => Math.abs(part - GROUND[theme][k]) <= 2);
const isOrange = ([red, , blue]) => red > blue + 50;
const isPurple = ([red, green, blue]) => blue > green + 30 && red > green + 10;
const isGrey = ([red, green, blue]) => Math.abs(red - green) < 14 && Math.abs(green - blue) < 14;
const same = (a, b) => a.pixels.equals(b.pixels);

/** How many pixels of a picture a predicate holds for. */
function count(image, holds) {
  let found = 0;
  for (let y = 0; y < image.height; y += 1) for (let x = 0; x < image.width; x += 1) found += holds(image.pixel(x, y), x, y) ? 1 : 0;
  return found;
}

/** Pixels per millimetre, from the bar that tells the scale. */
function pxPerMm(page) {
  return page.locator(".gaiter-bar").evaluate((bar) =>
    parseFloat(bar.style.width) / (10 * parseFloat(bar.textContent.replace(",", "."))));
}

/** Texts and boxes of the labels that can be seen. */
function labels(page) {
  return page.locator(".gaiter-stage span").evaluateAll((spans) => spans
    .filter((span) => span.getClientRects().length > 0)
    .map((span) => ({ text: span.textContent, ...JSON.parse(JSON.stringify(span.getBoundingClientRect())) })));
}

async function drag(page, [x, y], by, keys = []) {
  const box = await page.locator("canvas").boundingBox();
  for (const key of keys) await page.keyboard.down(key);
  await page.mouse.move(box.x + x, box.y + y);
  await page.mouse.down();
  await page.mouse.move(box.x + x + by[0], box.y + y + by[1], { steps: 3 });
  await page.mouse.up();
  for (const key of keys) await page.keyboard.up(key);
  await page.mouse.move(1, 1);
  await settled(page);
}

/** Both legs with a surface that lies a millimetre within the left skin and without the right. */
const told_apart = () => record([leg("left", () => 1), leg("right", () => -1)]);

test("the legs are drawn: a good part of the canvas is not ground, and its edge is", () => viewing(async (page) => {
  const image = await picture(page, false);
  assert.ok(count(image, (pixel) => !isGround(pixel)) > 0.05 * image.width * image.height);
  assert.equal(count(image, (pixel, x, y) => (x < 3 || y < 3) && !isGround(pixel)), 0);
}));

test("a section is drawn where its height and its leg's axis say", () => viewing(async (page) => {
  await press(page, "Front");
  await showOnly(page, ["Sections"]);
  const [image, scale] = [await picture(page, false), await pxPerMm(page)];
  for (const [level, height] of Object.entries(LEVELS_MM)) {
    for (const side of [-1, 1]) {
      const x = Math.round(image.width / 2 + side * AXIS_X_MM * scale);
      const drawn = Array.from({ length: image.height }, (_, y) => y).filter((y) => !isGround(image.pixel(x, y)));
      const expected = image.height / 2 + (TOP_MM / 2 - height) * scale;
      assert.ok(drawn.some((y) => Math.abs(y + 0.5 - expected) <= 1), `${level} at ${expected}, drawn at ${drawn}`);
    }
  }
}));

test("seen from the front the patient's right leg is on the left, from the back on the right", () => viewing(async (page) => {
  await showOnly(page, ["Error of the surface"]);
  for (const [view, leftHalf, rightHalf] of [["Front", isPurple, isOrange], ["Back", isOrange, isPurple], ["From below", isPurple, isOrange]]) {
    await press(page, view);
    const image = await picture(page, false);
    const half = image.width / 2;
    assert.ok(count(image, (pixel, x) => x < half && leftHalf(pixel)) > 1000, view);
    assert.equal(count(image, (pixel, x) => x < half && rightHalf(pixel)), 0, view);
    assert.ok(count(image, (pixel, x) => x > half && rightHalf(pixel)) > 1000, view);
  }
}, { given: told_apart() }));

test("from the patient's left the toes point to the left, from the right to the right", () => viewing(async (page) => {
  await showOnly(page, ["Skin"]);
  for (const [view, way] of [["Patient's left", -1], ["Patient's right", 1]]) {
    await press(page, view);
    const [image, scale] = [await picture(page, false), await pxPerMm(page)];
    const ends = (upMm) => {
      const y = Math.round(image.height / 2 - upMm * scale);
      const drawn = Array.from({ length: image.width }, (_, x) => x).filter((x) => !isGround(image.pixel(x, y)));
      return [drawn[0], drawn.at(-1)];
    };
    const [[thighLeft, thighRight], [footLeft, footRight]] = [ends(TOP_MM / 2 - 4), ends(4 - TOP_MM / 2)];
    const axis = (thighLeft + thighRight) / 2;
    const [left, right] = [axis - footLeft, footRight - axis];
    assert.ok(way < 0 ? left > 2 * right : right > 2 * left, `${view}: ${left} and ${right} px`);
  }
}));

test("the legs' names stand over their legs in every view, and no labels overlap", () => viewing(async (page) => {
  for (const view of ["Front", "Back", "Patient's left", "Patient's right", "From below", "Reset"]) {
    await press(page, view);
    const shown = await labels(page);
    const [right, left] = ["R – Right leg", "L – Left leg"].map((text) => shown.find((label) => label.text === text));
    assert.ok(right && left, view);
    if (["Front", "From below", "Reset"].includes(view)) assert.ok(right.right < left.left, view);
    if (view === "Back") assert.ok(left.right < right.left, view);
    for (const [at, a] of shown.entries()) {
      for (const b of shown.slice(at + 1)) {
        const apart = a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
        assert.ok(apart, `${view}: ${a.text} over ${b.text}`);
      }
    }
  }
}));

test("every level's girth is told beside its leg in cm with one decimal, as the language writes it", async () => {
  for (const [language, point] of [["en", "."], ["de", ","]]) {
    await viewing(async (page) => {
      const shown = await labels(page);
      const middle = await page.locator("canvas").evaluate((canvas) => canvas.getBoundingClientRect().left + canvas.clientWidth / 2);
      for (const side of ["left", "right"]) {
        for (const level of Object.keys(LEVELS_MM)) {
          const cm = (Math.round(girthMm(side, level)) / 10).toFixed(1).replace(".", point);
          const found = shown.filter(({ text, left }) => text === `c${level} ${cm}` && (left > middle) === (side === "left"));
          assert.equal(found.length, 1, `${level} ${side} ${cm} in ${shown.map(({ text }) => text)}`);
        }
      }
    }, { how: { language } });
  }
});

test("where the legs stand behind one another, a level says whose it is", () => viewing(async (page) => {
  await press(page, "Patient's left");
  const texts = (await labels(page)).map(({ text }) => text);
  for (const letter of ["R", "L"]) assert.ok(texts.some((text) => text.startsWith(`${letter} cC `)), `${texts}`);
}));

test("a girth in doubt has a question mark, and no other", () => {
  const doubted = record();
  doubted.legs[0].landmarks.C.doubts = ["gap"];
  return viewing(async (page) => {
    await page.getByLabel("Tape", { exact: true }).setChecked(false);
    await settled(page);
    const asked = (await labels(page)).map(({ text }) => text).filter((text) => text.endsWith("?"));
    assert.equal(asked.length, 1, `${asked}`);
    assert.equal(asked[0], `cC ${(Math.round(girthMm("left", "C")) / 10).toFixed(1)} ?`);
  }, { given: doubted });
});

test("every layer draws something of its own", () => viewing(async (page) => {
  await showOnly(page, []);
  const pictures = [await picture(page, false)];
  for (const layer of LAYERS) {
    await showOnly(page, [layer]);
    pictures.push(await picture(page, false));
  }
  for (const [at, one] of pictures.entries()) {
    for (const other of pictures.slice(at + 1)) assert.ok(!same(one, other), `layer ${at}`);
  }
}));

test("a leg that is switched off is gone, its labels too", () => viewing(async (page) => {
  await page.getByLabel("Left leg").setChecked(false);
  await press(page, "Front");
  const image = await picture(page, false);
  assert.equal(count(image, (pixel, x) => x > image.width / 2 && !isGround(pixel)), 0);
  assert.ok((await labels(page)).every(({ text }) => !text.startsWith("L") && !text.endsWith((girthMm("left", "C") / 10).toFixed(1))));
}));

test("errors are orange outside, purple inside, white where there are none and grey where nothing was seen", async () => {
  const colour = async (errorMm) => {
    let found;
    await viewing(async (page) => {
      await showOnly(page, ["Error of the surface"]);
      await press(page, "Front");
      const [image, scale] = [await picture(page, false), await pxPerMm(page)];
      found = image.pixel(Math.round(image.width / 2), Math.round(image.height / 2 + scale * 10));
    }, { given: record([leg("left", errorMm)]) });
    return found;
  };
  const [outside, inside, none, unseen] = [await colour(() => 0.7), await colour(() => -0.7), await colour(() => 0), await colour(() => null)];
  assert.ok(isOrange(outside), outside);
  assert.ok(isPurple(inside), inside);
  assert.ok(isGrey(none) && none[0] > 220, none);
  assert.ok(isGrey(unseen) && unseen[0] > 90 && unseen[0] < 170, unseen);
});

test("the colours are full at 1 mm, whatever the errors are, and are those of the flat figure", async () => {
  for (const [errorMm, expected] of [[1, [0xb3, 0x58, 0x06]], [5, [0xb3, 0x58, 0x06]], [-1, [0x54, 0x27, 0x88]], [0, [0xf7, 0xf7, 0xf7]]]) {
    await viewing(async (page) => {
      await showOnly(page, ["Error of the surface"]);
      await press(page, "Front");
      const image = await picture(page, false);
      const found = image.pixel(Math.round(image.width / 2), Math.round(image.height / 2));
      // Light takes a little from it where the skin turns away.
      assert.ok(found.every((part, k) => Math.abs(part - expected[k]) < 12), `${errorMm} mm: ${found}`);
    }, { given: record([leg("left", () => errorMm)]) });
  }
});

test("the legend tells the error at which the colours are full", () => viewing(async (page) => {
  await showOnly(page, ["Error of the surface"]);
  const text = await page.getByText("Skin outside (+) or inside (−)").textContent();
  assert.ok(text.includes("−1") && text.includes("+1"), text);
}, { given: told_apart() }));

test("peaks are yellow and point up, valleys are violet and point down", () => viewing(async (page) => {
  await showOnly(page, ["Feature points"]);
  await press(page, "Front");
  await press(page, "Zoom in", 6);
  const image = await picture(page, false);
  const widths = (holds) => {
    const rows = Array.from({ length: image.height }, (_, y) =>
      Array.from({ length: image.width }, (__, x) => x).filter((x) => holds(image.pixel(x, y))).length);
    const first = rows.findIndex((row) => row > 0);
    const sign = rows.slice(first, rows.findIndex((row, y) => y > first && row === 0));
    return [sign.slice(0, 3), sign.slice(-3)].map((ends) => ends.reduce((sum, row) => sum + row, 0));
  };
  const [peakTop, peakFoot] = widths(([red, green, blue]) => red > 200 && green > 120 && blue < 90);
  const [valleyTop, valleyFoot] = widths(([red, green, blue]) => blue > 180 && red < 160 && green < 120);
  assert.ok(peakTop < peakFoot, `${peakTop} ${peakFoot}`);
  assert.ok(valleyTop > valleyFoot, `${valleyTop} ${valleyFoot}`);
}));

test("a feature point is named in full under the pointer, and briefly for the keyboard", () => viewing(async (page) => {
  await showOnly(page, ["Skin", "Feature points"]);
  await press(page, "Front");
  const scale = await pxPerMm(page);
  const box = await page.locator("canvas").boundingBox();
  await page.mouse.move(box.x + box.width / 2 + AXIS_X_MM * scale, box.y + box.height / 2 + (TOP_MM / 2 - LEVELS_MM.B) * scale);
  await settled(page);
  const named = (await labels(page)).find(({ text }) => text === "P1 · B · left · peak");
  assert.ok(named && Math.abs(named.left - (box.x + box.width / 2 + AXIS_X_MM * scale)) < 12, JSON.stringify(named));
  assert.ok(Math.abs(named.bottom - (box.y + box.height / 2 + (TOP_MM / 2 - LEVELS_MM.B) * scale)) < 6, JSON.stringify(named));
  await page.mouse.move(1, 1);
  await settled(page);
  assert.ok((await labels(page)).every(({ text }) => !text.startsWith("P")));
  await page.getByRole("button", { name: "Reset" }).focus();
  for (let at = 0; at < 20 && !(await page.locator("canvas").evaluate((canvas) => canvas === document.activeElement)); at += 1) await page.keyboard.press("Tab");
  await settled(page);
  assert.ok((await labels(page)).some(({ text }) => text === "P1"));
}));

test("a feature point behind the other leg or on the far side is not named", () => viewing(async (page) => {
  await showOnly(page, ["Skin", "Feature points"]);
  const named = async (at) => {
    const [scale, box] = [await pxPerMm(page), await page.locator("canvas").boundingBox()];
    await page.mouse.move(box.x + box.width / 2 + at * scale, box.y + box.height / 2 + (TOP_MM / 2 - LEVELS_MM.C) * scale);
    await settled(page);
    return (await labels(page)).map(({ text }) => text).filter((text) => text.includes("·"));
  };
  await press(page, "Back");
  assert.deepEqual(await named(-AXIS_X_MM), ["P4 · C · left · valley"]); // P1 lies right before it, in front.
  await press(page, "Patient's left");
  // The picture's middle lies between toes and thighs, 45 mm before the axes; P3 is 10 mm behind its axis.
  // P5 of the far leg, on its axis, would be nearer to the pointer and faces it, but the near leg is before it.
  assert.deepEqual(await named(45 + 2), ["P3 · C · left · peak"]);
  await press(page, "Patient's right");
  assert.deepEqual(await named(-45 - 2), ["P3 · C · right · peak"]);
}));

test("dragging turns, and a reset by button, double click or key restores every pixel", () => viewing(async (page) => {
  const first = await picture(page);
  for (const reset of ["button", "double click", "key"]) {
    await drag(page, [300, 200], [120, 40]);
    assert.ok(!same(first, await picture(page)), reset);
    if (reset === "button") await press(page, "Reset");
    if (reset === "double click") await page.locator("canvas").dblclick({ position: { x: 10, y: 10 } });
    if (reset === "key") { await page.locator("canvas").focus(); await page.keyboard.press("0"); await page.locator("canvas").blur(); }
    await page.mouse.move(1, 1);
    await settled(page);
    assert.ok(same(first, await picture(page)), reset);
  }
}));

test("dragging to the right turns the near side to the right", () => viewing(async (page) => {
  await press(page, "Front");
  await drag(page, [300, 200], [225, 0]); // 90° at 0.4° a pixel: the front has gone to the right.
  const dragged = await picture(page);
  await press(page, "Patient's right");
  assert.ok(same(dragged, await picture(page)));
}));

test("a leg cannot be turned upside down", () => viewing(async (page) => {
  for (const way of [1, -1]) {
    for (let at = 0; at < 3; at += 1) await drag(page, [300, 200], [0, way * 180]);
    await drag(page, [300, 200], [0, way * 180]);
    const far = await picture(page);
    await drag(page, [300, 200], [0, way * 60]);
    assert.ok(same(far, await picture(page)));
    await press(page, "Front");
  }
}));

test("every key has its answer: arrows turn, with shift they move, plus and minus undo each other", () => viewing(async (page) => {
  await page.locator("canvas").focus();
  const key = async (name) => { await page.keyboard.press(name); await settled(page); return picture(page, false); };
  await key("+");
  let before = await key("0");
  for (const [there, back] of [["ArrowLeft", "ArrowRight"], ["ArrowUp", "ArrowDown"], ["+", "-"], ["Shift+ArrowLeft", "Shift+ArrowRight"], ["Shift+ArrowUp", "Shift+ArrowDown"]]) {
    assert.ok(!same(before, await key(there)), there);
    const after = await key(back);
    const changed = count(after, (pixel, x, y) => pixel.some((part, k) => Math.abs(part - before.pixel(x, y)[k]) > 8));
    assert.ok(changed < 200, `${back}: ${changed} pixels are not back`);
    before = await key("0");
  }
}));

test("shift and dragging moves the legs with the pointer", () => viewing(async (page) => {
  const before = await picture(page, false);
  await drag(page, [300, 200], [40, 30], ["Shift"]);
  const after = await picture(page, false);
  const differing = count(after, (pixel, x, y) => x >= 40 && y >= 30
    && pixel.some((part, k) => Math.abs(part - before.pixel(x - 40, y - 30)[k]) > 8));
  assert.ok(differing < 200, `${differing}`);
}));

test("the wheel scrolls the page, also after a click into the view; with Ctrl it zooms about the pointer", () => viewing(async (page) => {
  await page.evaluate(() => { document.body.style.minHeight = "3000px"; });
  const [before, box] = [await pxPerMm(page), await page.locator("canvas").boundingBox()];
  await page.mouse.click(box.x + 200, box.y + 200);
  await page.mouse.wheel(0, 150);
  await scrolled(page, 150);
  assert.equal(await pxPerMm(page), before);
  const top = await page.evaluate(() => window.scrollY);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -300);
  await page.keyboard.up("Control");
  await settled(page);
  const near = await pxPerMm(page);
  assert.ok(near > 1.3 * before, `${near}`);
  assert.equal(await page.evaluate(() => window.scrollY), top);
}));

test("two fingers zoom", () => viewing(async (page) => {
  const [before, box] = [await pxPerMm(page), await page.locator("canvas").boundingBox()];
  const session = await page.context().newCDPSession(page);
  const touch = (type, away) => session.send("Input.dispatchTouchEvent", { type, touchPoints: away === null ? [] :
    [-away, away].map((x, id) => ({ x: box.x + box.width / 2 + x, y: box.y + 200, id })) });
  await touch("touchStart", 40);
  await touch("touchMove", 60);
  await touch("touchMove", 80);
  await touch("touchEnd", null);
  await settled(page);
  const ratio = (await pxPerMm(page)) / before;
  assert.ok(Math.abs(ratio - 2) < 0.05, `${ratio}`);
}, { hasTouch: true }));
