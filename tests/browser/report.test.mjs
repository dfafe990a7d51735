// report.html in a real browser, opened from its file as a clinician opens it.

import { createHash } from "node:crypto";
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { gunzipSync } from "node:zlib";

import { chromium } from "playwright-core";

import { PATIENCE_MS, until } from "./station.mjs";
import { decodePng, settled, swipe } from "./viewer_page.mjs";

const root = resolve(import.meta.dirname, "../..");
const gaiter = resolve(root, process.env.GAITER_BIN ?? "target/debug/gaiter");
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

// Screenshots for people to look at go here, if anywhere.
const shots = process.env.GAITER_SHOTS;

const FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

const HOSTILE = ["<script>window.hacked = true</script>", "\"'&lt;<!--", "\u202e4711", "שלום 12", "9".repeat(500)];

let browser, folder, record;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "gaiter-report-"));
  const scan = join(folder, "body.obj");
  writeFileSync(scan, gunzipSync(readFileSync(join(root, "fixtures/scans/f_average_tc2.obj.gz"))));
  execFileSync(gaiter, ["extract", scan, "--out", join(folder, "records")]);
  record = JSON.parse(readFileSync(join(folder, "records/body/record.json"), "utf8"));
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

/** The page of a record in a language, as a file. */
function report(name, of, language, ...choices) {
  const place = join(folder, `${name}-${language}`);
  const source = join(place, "record");
  mkdirSync(source, { recursive: true });
  const text = JSON.stringify(of);
  writeFileSync(join(source, "record.json"), text);
  const sum = createHash("sha256").update(text).digest("hex");
  writeFileSync(join(source, "SHA256SUMS"), `${sum}  record.json\n`);
  execFileSync(gaiter, ["report", source, "--language", language, "--out", place, "--force", ...choices]);
  return pathToFileURL(join(place, "report.html")).href;
}

/** Opens a page; whatever goes wrong on it, and whatever it asks for, fails the claim. */
async function onPage(address, options, claim) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, colorScheme: "light", ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") faults.push(message.text()); });
  page.on("request", (request) => { if (request.url() !== address) faults.push(`asks for ${request.url()}`); });
  await page.addInitScript(() => {
    document.addEventListener("securitypolicyviolation", (event) => console.error(`policy: ${event.violatedDirective}`));
  });
  await page.goto(address);
  await claim(page);
  assert.deepEqual(faults, []);
  await context.close();
}

const shoot = (page, name) => (shots ? page.screenshot({ path: join(shots, `${name}.png`), fullPage: true }) : null);

/** How far the page is wider than its window. */
const overhang = (page) => page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);

for (const language of ["en", "de"]) {
  for (const colorScheme of ["light", "dark"]) {
    test(`axe finds no violation: ${language}, ${colorScheme}`, async () => {
      await onPage(report("plain", record, language), { colorScheme }, async (page) => {
        await page.waitForSelector("#view-place canvas");
        await page.evaluate(axe);
        const { violations } = await page.evaluate(() => globalThis.axe.run(document));
        assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(" ")}`), []);
        await shoot(page, `report-${language}-${colorScheme}`);
      });
    });
  }
}

test("the legs are drawn to be turned: the canvas is not of one colour", async () => {
  await onPage(report("plain", record, "en"), {}, async (page) => {
    const canvas = page.locator("#view-place canvas");
    await canvas.scrollIntoViewIfNeeded();
    const before = await canvas.screenshot();
    await page.getByRole("button", { name: "Back" }).click();
    assert.notDeepEqual(await canvas.screenshot(), before);
  });
});

test("the view stands right after the verdict and the measuring sheet and says whose legs it shows", async () => {
  const whose = { ...record, patient: { id: "4711", sources: [] } };
  await onPage(report("whose", whose, "en"), {}, async (page) => {
    const headings = await page.locator("h2").allTextContents();
    assert.deepEqual(headings.slice(0, 2), ["Measuring sheet", "The legs in 3D – 4711"]);
    assert.ok(await page.getByRole("application", { name: "4711" }).isVisible());
    assert.equal(await page.locator(".sheet:visible").count(), 0, "the flat drawing is for paper");
    await page.emulateMedia({ media: "print" });
    assert.equal(await page.locator(".sheet:visible").count(), 1);
  });
});

test("the tape tells the sheet's own figures at the levels and the profile's in between, within 1 mm", async () => {
  await onPage(report("plain", record, "en"), {}, async (page) => {
    const slider = page.getByRole("slider");
    const girthCm = async (side) => {
      const text = await page.locator(".gaiter-tape output strong").filter({ hasText: side === "left" ? "Left" : "Right" }).textContent();
      return { text, cm: Number(text.match(/leg ([0-9.]+) cm/)[1]) };
    };
    let compared = 0;
    for (const { side, profile, landmarks } of record.legs) {
      for (const { height_mm: height, girth_tape_mm: girth } of profile.filter((row) => row.girth_tape_mm !== null)) {
        await slider.fill(String(height));
        const { cm } = await girthCm(side);
        assert.ok(Math.abs(10 * cm - girth) <= 1, `${side} ${height}: ${cm} and ${girth}`);
        compared += 1;
      }
      await slider.fill("60");
      await slider.focus();
      const seen = [];
      for (let step = 0; step < 10; step += 1) {
        await page.keyboard.press("PageUp");
        const { text, cm } = await girthCm(side);
        const level = text.match(/[(]([A-G]1?)[)]$/);
        if (!level) continue;
        assert.equal(cm, Math.round(landmarks[level[1]].girth_tape_mm) / 10, text);
        seen.push(level[1]);
      }
      assert.ok(["B", "B1", "C", "D"].every((level) => seen.includes(level)), `${seen}`);
    }
    assert.ok(compared > 20, `${compared}`);
  });
});

test("both feet are shown whole, and the legs fill the view's height or width", async () => {
  for (const [width, height] of [[1280, 900], [390, 844]]) {
    await onPage(report("plain", record, "de"), { viewport: { width, height } }, async (page) => {
      await page.getByRole("button", { name: "Vorn", exact: true }).click();
      for (const name of ["Maßband", "Messpunkte mit Umfang"]) await page.getByLabel(name, { exact: true }).setChecked(false);
      const stage = page.locator(".gaiter-stage");
      await stage.scrollIntoViewIfNeeded();
      await settled(page);
      const image = decodePng(await stage.screenshot());
      const drawn = Array.from({ length: image.height }, (_, y) => Array.from({ length: image.width }, (__, x) => x)
        .filter((x) => { const [red, , blue] = image.pixel(x, y); return red > blue + 15 && red < 230; }));
      const lowest = (holds) => drawn.findLastIndex((row) => row.some(holds));
      const feet = [lowest((x) => x < image.width / 2), lowest((x) => x >= image.width / 2)];
      assert.ok(feet.every((y) => y > image.height / 2 && y < image.height - 4), `${feet} of ${image.height}`);
      // From the highest skin to the sole: the crotch's height and more by the scale of the bar.
      const bar = await page.locator(".gaiter-bar").evaluate((of) => [parseFloat(of.style.width), parseFloat(of.textContent)]);
      const tallMm = (Math.max(...feet) - drawn.findIndex((row) => row.length > 20)) / (bar[0] / (10 * bar[1]));
      assert.ok(Math.abs(tallMm - record.body.crotch_height_mm) < 30, `${tallMm} mm`);
      const across = drawn.flat().reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)], [Infinity, -Infinity]);
      const filled = [(across[1] - across[0]) / image.width, tallMm * bar[0] / (10 * bar[1]) / image.height];
      assert.ok(across[0] > 4 && across[1] < image.width - 4 && (filled[0] > 0.5 || filled[1] > 0.8), `${filled}`);
    });
  }
});

test("on a phone both legs, their levels and the tape are in view, nothing is cut and all can be read", async () => {
  for (const language of ["en", "de"]) {
    await onPage(report("plain", record, language), { viewport: { width: 390, height: 844 }, hasTouch: true }, async (page) => {
      const stage = page.locator(".gaiter-stage");
      await stage.scrollIntoViewIfNeeded();
      await settled(page);
      const frame = await stage.boundingBox();
      assert.ok(frame.height < 844 && frame.x >= 0 && frame.x + frame.width <= 390);
      const labels = await page.locator(".gaiter-stage span:visible").evaluateAll((spans) => spans.map((span) =>
        ({ text: span.textContent, size: parseFloat(getComputedStyle(span).fontSize), ...span.getBoundingClientRect().toJSON() })));
      const texts = labels.map(({ text }) => text);
      const point = language === "de" ? "," : ".";
      for (const { landmarks } of record.legs) {
        for (const level of ["B", "B1", "C", "D"]) {
          const said = `c${level} ${(Math.round(landmarks[level].girth_tape_mm) / 10).toFixed(1).replace(".", point)}`;
          assert.ok(texts.some((text) => text.startsWith(said)), `${said} in ${texts}`);
        }
      }
      assert.ok(texts.includes("R") && texts.includes("L"), `${texts}`);
      for (const { text, size, left, right, top, bottom } of labels) {
        assert.ok(size >= 12, `${text}: ${size} px`);
        assert.ok(left >= frame.x && right <= frame.x + frame.width && top >= frame.y - 1 && bottom <= frame.y + frame.height + 1, text);
      }
      assert.equal(await overhang(page), 0);
      await shoot(page, `report-${language}-phone`);
    });
  }
});

test("the wheel over the view scrolls the page, and so does a finger", async () => {
  await onPage(report("plain", record, "en"), { hasTouch: true }, async (page) => {
    const canvas = page.locator("#view-place canvas");
    await canvas.scrollIntoViewIfNeeded();
    const box = await canvas.boundingBox();
    const at = () => page.evaluate(() => window.scrollY);
    let before = await at();
    await page.mouse.click(box.x + 40, box.y + 300);
    await page.mouse.wheel(0, 200);
    await until("the wheel", async () => await at() >= before + 200);
    before = await at();
    await swipe(page, [box.x + 40, 400], 150);
    await until("the finger", async () => await at() < before - 100);
  });
});

test("a narrow window shows everything without moving the page sideways", async () => {
  for (const language of ["en", "de"]) {
    await onPage(report("plain", record, language), { viewport: { width: 400, height: 800 } }, async (page) => {
      assert.equal(await overhang(page), 0);
      await shoot(page, `report-${language}-narrow`);
    });
  }
});

test("on a phone every leg of every figure is shown, at three quarters of its drawn size or more", async () => {
  await onPage(report("plain", record, "en"), { viewport: { width: 390, height: 844 } }, async (page) => {
    await page.evaluate(() => { document.querySelector(".appendix").open = true; });
    // The measuring sheet's drawing is on paper only: on a screen, the view shows the same.
    const figures = await page.evaluate(() => [...document.querySelectorAll("figure:not(.sheet)")].map((figure) => {
      const seen = [...figure.querySelectorAll("svg")].filter((svg) => svg.getBoundingClientRect().width > 0);
      const boxes = seen.map((svg) => svg.viewBox.baseVal);
      const scales = seen.map((svg, index) => svg.getBoundingClientRect().width / boxes[index].width);
      const whole = figure.querySelector("svg").viewBox.baseVal.width;
      return { name: figure.className, scale: Math.min(...scales), whole, covered: boxes.reduce((sum, box) => sum + box.width, 0) };
    }));
    assert.equal(figures.length, 6);
    for (const { name, scale, whole, covered } of figures) {
      assert.ok(scale >= 0.75, `${name}: ${scale}`);
      assert.ok(Math.abs(covered - whole) < 0.1, `${name}: ${covered} of ${whole}`);
    }
  });
});

test("what a browser prints has the patient and the page's number on every page, on A4 and on letter", async () => {
  const patient = { id: "P4711", sources: [] };
  for (const [paper, size] of [["A4", [595, 842]], ["letter", [612, 792]]]) {
    await onPage(report(`print-${paper}`, { ...record, patient }, "en", "--paper", paper), {}, async (page) => {
      const printed = async (name) => {
        const path = join(folder, `${name}-${paper}.pdf`);
        await page.pdf({ path, preferCSSPageSize: true });
        const text = execFileSync("pdftotext", ["-layout", path, "-"], { encoding: "utf8" });
        const [, ...sides] = /Page size:\s+([\d.]+) x ([\d.]+)/.exec(execFileSync("pdfinfo", [path], { encoding: "utf8" }));
        assert.deepEqual(sides.map((side) => Math.round(Number(side))), size);
        return text.split("\f").filter((words) => words.trim());
      };
      const pages = await printed("all");
      assert.ok(pages.length >= 3 && pages.length <= 5, `${pages.length} pages`);
      pages.forEach((words, at) => {
        assert.match(words.split("\n")[0], /P4711/, `page ${at + 1}`);
        assert.match(words, new RegExp(`Page ${at + 1} of ${pages.length}`));
      });
      assert.ok(pages.every((words) => !words.includes("Engineering figures")), "a closed appendix is not printed");
      await page.getByLabel("First page only").check();
      const first = await printed("first");
      assert.equal(first.length, 1);
      for (const words of ["Measuring sheet", "To be filled in", "Signature"]) assert.match(first[0], new RegExp(words));
    });
  }
});

test("hostile ids are shown as text, run nothing and break no layout", async () => {
  for (const [index, id] of HOSTILE.entries()) {
    const hostile = { ...record, station: id, patient: { id, sources: [] } };
    for (const width of [1280, 400]) {
      await onPage(report(`hostile-${index}`, hostile, "en"), { viewport: { width, height: 800 } }, async (page) => {
        const shown = id.replace("\u202e", "[U+202E]");
        assert.equal(await page.locator("h1").textContent(), shown);
        assert.equal(await page.evaluate(() => window.hacked), undefined);
        assert.equal(await overhang(page), 0, `${width} px wide`);
      });
    }
  }
});
