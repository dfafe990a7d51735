// The 3D view over its life: themes, sizes, lost contexts, rest, strict pages, damaged records.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";

import { base64, leg, record } from "./synthetic_leg.mjs";
import { LAYERS, mount, picture, press, settled, showOnly, start } from "./viewer_page.mjs";

const AXE = createRequire(import.meta.url).resolve("axe-core/axe.min.js");

let browser;
before(async () => { browser = await start(); });
after(() => browser.close());

/** Runs a claim on a fresh page; nothing may fail on the way. */
async function onPage(claim, context = {}) {
  const opened = await browser.open(context);
  await claim(opened.page);
  assert.deepEqual(opened.faults, []);
  assert.deepEqual(await opened.violations(), []);
  await opened.close();
}

test("the theme follows the system while the page is open, and a page may set colours", () => onPage(async (page) => {
  await mount(page, record());
  const corner = async () => (await picture(page)).pixel(2, 300);
  assert.deepEqual(await corner(), [246, 247, 249]);
  await page.emulateMedia({ colorScheme: "dark" });
  await settled(page);
  assert.deepEqual(await corner(), [20, 24, 30]);
  await page.evaluate(() => document.documentElement.style.setProperty("--gaiter-ground", "rebeccapurple"));
  await page.emulateMedia({ colorScheme: "light" });
  await settled(page);
  assert.deepEqual(await corner(), [0x66, 0x33, 0x99]);
  await page.evaluate(() => document.documentElement.style.setProperty("--gaiter-ground", "no colour"));
  await page.emulateMedia({ colorScheme: "dark" });
  await settled(page);
  assert.deepEqual(await corner(), [20, 24, 30]);
}));

test("the picture is as fine as the screen and follows its size", () => onPage(async (page) => {
  await mount(page, record());
  const sizes = () => page.locator("canvas").evaluate((canvas) => [canvas.width / canvas.clientWidth, canvas.height / canvas.clientHeight]);
  assert.deepEqual(await sizes(), [2, 2]);
  await page.setViewportSize({ width: 500, height: 600 });
  await settled(page);
  assert.deepEqual(await sizes(), [2, 2]);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false);
}, { deviceScaleFactor: 2 }));

test("a lost context is survived: the same picture comes back", () => onPage(async (page) => {
  await mount(page, record());
  const first = await picture(page);
  await page.evaluate(async () => {
    const canvas = document.querySelector("canvas");
    const happens = (name) => new Promise((done) => { canvas.addEventListener(name, done, { once: true }); });
    const context = canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
    const lost = happens("webglcontextlost");
    context.loseContext();
    await lost;
    window.dispatchEvent(new Event("resize"));
    await new Promise((done) => { requestAnimationFrame(() => setTimeout(done, 0)); });
    const restored = happens("webglcontextrestored");
    context.restoreContext();
    await restored;
  });
  await settled(page);
  assert.ok(first.pixels.equals((await picture(page)).pixels));
}));

test("nothing is drawn while nothing changes", () => onPage(async (page) => {
  await mount(page, record());
  const asked = await page.evaluate(async () => {
    const before = window.frames_asked;
    for (let frame = 0; frame < 20; frame += 1) await new Promise((done) => { window.ask_frame(done); });
    return window.frames_asked - before;
  });
  assert.equal(asked, 0);
}));

test("axe finds no violation, in both themes and with all layers on", () => onPage(async (page) => {
  await mount(page, record([leg("left", () => 0.2), leg("right", () => null)]));
  assert.equal(await page.getByRole("application", { name: "3D view of the legs" }).count(), 1);
  await page.evaluate(await readFile(AXE, "utf8"));
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    await showOnly(page, LAYERS);
    const { violations } = await page.evaluate(() => globalThis.axe.run());
    assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(" ")}`), []);
  }
}));

test("every control is reached by the tab key and shows where the focus is", () => onPage(async (page) => {
  await mount(page, record());
  await page.locator(".gaiter-viewer details").evaluate((details) => { details.open = true; });
  const controls = await page.locator(".gaiter-viewer :is(button, input:enabled, canvas, summary)").count();
  const seen = new Set();
  for (let at = 0; at < controls; at += 1) {
    await page.keyboard.press("Tab");
    const [name, outline] = await page.evaluate(() => {
      const { activeElement: at } = document;
      return [at.textContent || at.closest("label")?.textContent || at.localName, getComputedStyle(at).outlineStyle];
    });
    assert.notEqual(outline, "none", name);
    seen.add(name);
  }
  assert.equal(seen.size, controls);
}));

test("a view that is taken down leaves nothing, and thirty in a row do no harm", () => onPage(async (page) => {
  for (let at = 0; at < 30; at += 1) {
    await mount(page, record([leg("left")]));
    const freed = await page.evaluate(() => {
      const gl = document.querySelector("canvas").getContext("webgl2");
      window.view.destroy();
      window.view.destroy();
      return gl.isContextLost();
    });
    assert.ok(freed, "the browser keeps the context");
    assert.equal(await page.locator("#place *").count(), 0);
  }
  await page.evaluate(() => window.dispatchEvent(new Event("resize")));
  await settled(page);
}));

test("a record without shapes and one that is no record give a sentence in the reader's language", () => onPage(async (page) => {
  const bare = leg("left");
  delete bare.shape;
  for (const given of [record([bare]), record([]), {}, null, 7, "x", [], { legs: 5 }, { legs: [null, 3] }]) {
    await mount(page, given);
    assert.equal(await page.locator("#place").innerText(), "This record holds no shape of the legs, so there is nothing to show in 3D.");
    await mount(page, given, { language: "de" });
    assert.match(await page.locator("#place").innerText(), /keine Form der Beine/);
  }
}));

test("without WebGL there is a sentence", () => onPage(async (page) => {
  await page.evaluate(() => { HTMLCanvasElement.prototype.getContext = () => null; });
  await mount(page, record());
  assert.match(await page.locator("#place").innerText(), /no WebGL/);
}));

test("a leg of which nothing is whole is left out with a sentence, the other is shown", () => onPage(async (page) => {
  const { skin } = leg("right", () => 0, { rows: 4, columns: 6 }).shape;
  const skins = [{ ...skin, rows: 1e9, columns: 1e9 }, { ...skin, rows: skin.rows + 1 }, { ...skin, columns: 2 }, { ...skin, rows: 2.5 },
    { ...skin, points: `${skin.points}AAAA` }, { ...skin, points: "AAAA" }, { ...skin, points: "%%%%" }, { ...skin, points: [1, 2, 3] },
    { ...skin, error: skin.points }];
  for (const damaged of skins) {
    const broken = { ...leg("right"), shape: { skin: damaged } };
    await mount(page, record([leg("left"), broken]));
    assert.equal(await page.locator("canvas").count(), 1);
    assert.match(await page.locator("#place").innerText(), /damaged/);
    await page.evaluate(() => window.view.destroy());
    await mount(page, record([broken]));
    assert.equal(await page.locator("canvas").count(), 0);
    assert.match(await page.locator("#place").innerText(), /damaged/);
  }
}));

test("a side that is unknown or comes twice is not drawn", () => onPage(async (page) => {
  for (const side of ["middle", "left", null]) {
    await mount(page, record([leg("left"), { ...leg("right"), side }]));
    assert.equal(await page.getByLabel(/leg$/).count(), 1);
    assert.match(await page.locator("#place").innerText(), /damaged/);
  }
}));

test("text of a record stays text", () => onPage(async (page) => {
  const hostile = leg("left");
  hostile.sections[0].level = "<b>x</b>";
  hostile.landmarks["<i>y</i>"] = { ...hostile.landmarks.B };
  await mount(page, record([hostile]));
  assert.equal(await page.locator("#place b").count(), 0);
  assert.match(await page.locator(".gaiter-stage").innerText(), /<b>x<\/b>/);
}));

/** Every path of a value, to the first two entries of lists. */
function paths(value, path = []) {
  if (typeof value !== "object" || value === null) return [path];
  const keys = Array.isArray(value) ? Object.keys(value).slice(0, 2) : Object.keys(value);
  return [...(path.length ? [path] : []), ...keys.flatMap((key) => paths(value[key], [...path, key]))];
}

test("whatever stands at any place of a record, there is a picture or a sentence, never an exception", () => onPage(async (page) => {
  const small = record([leg("left", () => 0.1, { rows: 4, columns: 6 })]);
  small.legs[0].landmarks = { B: small.legs[0].landmarks.B };
  small.legs[0].sections.length = 1;
  small.legs[0].features.length = 1;
  small.legs[0].girth_curve = { height_mm: [10, 15, 20], tape_mm: [300, 301, 302] };
  small.legs[0].shape.foot = { points: base64([0, 0, 0, 100, 0, 0, 0, 100, 0]), triangles: base64([0, 1, 2]) };
  const outcomes = await page.evaluate(([given, places]) => {
    const values = [null, NaN, 1e300, "%%%", "AAAA", [NaN, null, "x"], {}];
    // Draws at once instead of with the next frame: there are many records to go through.
    window.requestAnimationFrame = (act) => { act(); return 0; };
    const bad = [];
    for (const path of places) {
      for (const value of values) {
        const copy = structuredClone(given);
        path.slice(0, -1).reduce((at, key) => at[key], copy)[path.at(-1)] = value;
        try {
          const view = globalThis.gaiterViewer.mount(document.getElementById("place"), copy, {});
          if (!document.querySelector("#place :is(canvas, p)")) bad.push([path, String(value), "nothing"]);
          view.destroy();
        } catch (error) {
          bad.push([path, String(value), String(error)]);
        }
      }
    }
    return bad;
  }, [small, paths(small)]);
  assert.deepEqual(outcomes, []);
}, { viewport: { width: 200, height: 200 } }));
