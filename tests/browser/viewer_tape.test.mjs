// The tape of the 3D view, its handles, and the mirrored leg: what they tell is what the record holds.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { createContext, runInContext } from "node:vm";

import { AXIS_X_MM, LEVELS_MM, TOP_MM, girthAtMm, leg, record } from "./synthetic_leg.mjs";
import { mount, picture, press, script, scrolled, settled, showOnly, start, swipe } from "./viewer_page.mjs";

let browser;
before(async () => { browser = await start(); });
after(() => browser.close());

/** Runs a claim on a fresh page with a mounted record; nothing may fail on the way. */
async function viewing(claim, { given = record(), language = "en", ...context } = {}) {
  const opened = await browser.open(context);
  await mount(opened.page, given, { language });
  await claim(opened.page);
  assert.deepEqual(opened.faults, []);
  assert.deepEqual(await opened.violations(), []);
  await opened.close();
}

const slider = (page) => page.getByRole("slider", { name: "Tape: height above the floor" });
const told = (page) => page.locator(".gaiter-tape output strong").allTextContents();
const cm = (mm) => (Math.round(mm) / 10).toFixed(1);

/** Moves the slider to a height. */
async function tapeTo(page, mm) {
  await slider(page).fill(String(mm));
  await settled(page);
}

/** What the tape tells of both legs at a height, where no level is. */
const expected = (mm) => [`${cm(mm)} cm`, `Right leg ${cm(girthAtMm("right", mm))} cm`, `Left leg ${cm(girthAtMm("left", mm))} cm`];

test("the tape tells height and girth of both legs, the right one first, to the eye and to a screen reader", () => viewing(async (page) => {
  for (const mm of [101, 250, 363, 688]) {
    await tapeTo(page, mm);
    assert.deepEqual(await told(page), expected(mm));
    assert.equal(await slider(page).getAttribute("aria-valuetext"), expected(mm).join(", "));
  }
}));

test("the tape tells in German as a German writes", () => viewing(async (page) => {
  await page.getByRole("slider", { name: "Maßband: Höhe über dem Boden" }).fill("250");
  const girths = ["right", "left"].map((side) => cm(girthAtMm(side, 250)).replace(".", ","));
  assert.deepEqual(await told(page), ["25,0 cm", `Rechtes Bein ${girths[0]} cm`, `Linkes Bein ${girths[1]} cm`]);
}, { language: "de" }));

test("arrow keys move the tape by a millimetre, page keys from level to level, and levels are named", () => viewing(async (page) => {
  await tapeTo(page, 250);
  await slider(page).focus();
  await page.keyboard.press("ArrowUp");
  assert.deepEqual(await told(page), expected(251));
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowLeft");
  assert.deepEqual(await told(page), expected(249));
  for (const [key, level] of [["PageUp", "C"], ["PageUp", "D"], ["PageUp", "D"], ["PageDown", "C"], ["PageDown", "B1"], ["PageDown", "B"]]) {
    await page.keyboard.press(key);
    const [height, right, left] = expected(LEVELS_MM[level]);
    assert.deepEqual(await told(page), [height, `${right} (${level})`, `${left} (${level})`]);
  }
}));

test("a girth that was not measured is not told, and no tape is drawn there", () => viewing(async (page) => {
  await showOnly(page, ["Tape"]);
  await tapeTo(page, 300);
  assert.deepEqual(await told(page), ["30.0 cm", expected(300)[1], "Left leg not measured"]);
  assert.equal(await page.locator(".gaiter-grip:visible").count(), 1);
  const image = await picture(page, false);
  const drawn = (left) => Array.from({ length: image.height }, (_, y) => image.pixel(Math.round(image.width * (left ? 0.55 : 0.45)), y))
    .some(([red, , blue]) => red > blue + 60);
  assert.ok(drawn(false) && !drawn(true));
}, { given: record([leg("left", () => 0, { openMm: [280, 340] }), leg("right")]) }));

test("a girth near a doubted height has a question mark", () => {
  const doubted = record();
  doubted.legs[1].profile[0].doubts = ["gap"];
  return viewing(async (page) => {
    for (const [mm, mark] of [[139, ""], [150, " ?"], [181, ""]]) {
      await tapeTo(page, mm);
      const [height, right, left] = expected(mm);
      assert.deepEqual(await told(page), [height, `${right}${mark}`, left]);
    }
  }, { given: doubted });
});

test("the tape is drawn at its height around both legs, and follows the mouse along them", () => viewing(async (page) => {
  await press(page, "Front");
  await showOnly(page, ["Tape"]);
  await tapeTo(page, 240);
  const scale = await page.locator(".gaiter-bar").evaluate((bar) => parseFloat(bar.style.width) / (10 * parseFloat(bar.textContent)));
  const rows = (image, side) => Array.from({ length: image.height }, (_, y) => y).filter((y) => {
    const [red, , blue] = image.pixel(Math.round(image.width / 2 + side * AXIS_X_MM * scale), y);
    return red > blue + 60;
  });
  const height = (image) => image.height / 2 + (TOP_MM / 2 - 240) * scale;
  const at = async (mm) => {
    const image = await picture(page, false);
    for (const side of [-1, 1]) {
      const [first, last] = [rows(image, side)[0], rows(image, side).at(-1)];
      const middle = (first + last + 1) / 2;
      assert.ok(Math.abs(middle - (height(image) - (mm - 240) * scale)) < 2, `${middle} for ${mm} mm`);
    }
  };
  await at(240);
  const box = await page.locator("canvas").boundingBox();
  const grab = [box.x + box.width / 2 + (AXIS_X_MM + 30) * scale, box.y + box.height / 2 + (TOP_MM / 2 - 240) * scale];
  await page.mouse.move(...grab);
  await page.mouse.down();
  await page.mouse.move(grab[0], grab[1] - 80 * scale, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  await at(320);
  assert.ok(Math.abs(Number(await slider(page).inputValue()) - 320) <= 1);
}));

test("a finger takes the tape along by its handle and the page stays", () => viewing(async (page) => {
  await page.evaluate(() => { document.body.style.minHeight = "3000px"; });
  await tapeTo(page, 240);
  const box = await page.locator(".gaiter-grip").first().boundingBox();
  await swipe(page, [box.x + box.width / 2, box.y + box.height / 2], -60);
  await settled(page);
  const scale = await page.locator(".gaiter-bar").evaluate((bar) => parseFloat(bar.style.width) / (10 * parseFloat(bar.textContent)));
  const moved = Number(await slider(page).inputValue()) - 240;
  assert.ok(Math.abs(moved * scale - 60) < 3, `${moved} mm for 60 px`);
  assert.equal(await page.evaluate(() => window.scrollY), 0);
}, { hasTouch: true }));

test("one finger down the view scrolls the page and does not turn the legs", () => viewing(async (page) => {
  await page.evaluate(() => { document.body.style.minHeight = "3000px"; });
  await page.getByLabel("Tape", { exact: true }).setChecked(false);
  await settled(page);
  const first = await picture(page);
  const box = await page.locator("canvas").boundingBox();
  await swipe(page, [box.x + 200, box.y + 300], -200);
  await scrolled(page, 100);
  await page.evaluate(() => window.scrollTo(0, 0));
  await settled(page);
  assert.ok(first.pixels.equals((await picture(page)).pixels));
}, { hasTouch: true }));

test("the mirrored leg stands out where the other leg is thicker, in the other leg's colour, and not where it is thinner", () => viewing(async (page) => {
  await press(page, "Front");
  await showOnly(page, ["Skin"]);
  const plain = await picture(page, false);
  await showOnly(page, ["Skin", "Other leg, mirrored"]);
  const image = await picture(page, false);
  const changed = (isRightHalf, holds) => {
    let found = 0;
    for (let y = 0; y < image.height; y += 1) {
      for (let x = isRightHalf ? Math.ceil(image.width / 2) : 0; x < (isRightHalf ? image.width : image.width / 2); x += 1) {
        const [now, before] = [image.pixel(x, y), plain.pixel(x, y)];
        found += now.some((part, k) => Math.abs(part - before[k]) > 6) && holds(now, before) ? 1 : 0;
      }
    }
    return found;
  };
  // The patient's right leg stands in the left half; the left leg is 8 mm thicker all around.
  const isGreener = (now, before) => now[1] - now[0] > before[1] - before[0];
  assert.ok(changed(false, isGreener) > 5000, `${changed(false, isGreener)}`);
  // But for the rim of the open upper end, into which one sees.
  assert.ok(changed(true, () => true) < 100, `${changed(true, () => true)}`);
  assert.ok(await page.getByText("The other leg is mirrored").isVisible());
}, { given: record([leg("left", () => 0, { widerMm: 8 }), leg("right")]) }));

test("a leg alone has no mirrored leg to show", () => viewing(async (page) => {
  assert.ok(await page.getByLabel("Other leg, mirrored").isDisabled());
}, { given: record([leg("left")]) }));

test("the view says whose legs it shows", async () => {
  const opened = await browser.open();
  await mount(opened.page, record(), { language: "en", patient: "<b>4711" });
  assert.equal(await opened.page.getByRole("application", { name: "3D view of the legs – <b>4711" }).count(), 1);
  await opened.close();
});

test("between the rows of the curve the tape's girth is right to a tenth of a millimetre", async () => {
  // A leg whose girth is known between the rows: waves as short as those of a calf, and much steeper.
  const girth = (mm) => 300 + 60 * Math.sin(mm / 35);
  const heights = Array.from({ length: 100 }, (_, at) => 100 + 5 * at);
  const { readRuns, curveGirthMm } = await inside();
  const runs = readRuns({ height_mm: heights, tape_mm: heights.map(girth) });
  for (let mm = 106; mm < 590; mm += 0.7) {
    assert.ok(Math.abs(curveGirthMm(runs, mm) - girth(mm)) < 0.1, `${mm}`);
  }
});

/** The functions inside the script, which a page does not see. */
async function inside() {
  const parts = (await script()).split("  // ---- Camera")[0];
  const box = createContext({ atob });
  runInContext(`${parts} return { readScene, readRuns, curveGirthMm, tapeReading, tapeCurve }; })();`, box);
  return box.gaiterViewer;
}
