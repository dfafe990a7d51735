// visits.html in a real browser, on screen and on paper, opened from its file.

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

import { PATIENCE_MS } from "./station.mjs";

const root = resolve(import.meta.dirname, "../..");
const gaiter = resolve(root, process.env.GAITER_BIN ?? "target/debug/gaiter");
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

// Screenshots for people to look at go here, if anywhere.
const shots = process.env.GAITER_SHOTS;

const FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

// Four visits of one patient: the last later in the day, and the one before it sitting, so that there is something
// to warn of.
const VISITS = [
  { at: "2026-01-12T08:10:00Z", posture: "both-legs" },
  { at: "2026-03-09T08:40:00Z", posture: "both-legs" },
  { at: "2026-06-08T07:55:00Z", posture: "sitting" },
  { at: "2026-11-16T15:20:00Z", posture: "both-legs" },
];

let browser, folder;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "gaiter-visits-"));
  const scan = join(folder, "body.obj");
  writeFileSync(scan, gunzipSync(readFileSync(join(root, "fixtures/scans/f_average_tc2.obj.gz"))));
  execFileSync(gaiter, ["extract", scan, "--out", join(folder, "measured")]);
  const record = JSON.parse(readFileSync(join(folder, "measured/body/record.json"), "utf8"));
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
  const records = VISITS.map(({ at, posture }, index) => {
    const place = join(folder, `visit-${index}`);
    mkdirSync(place);
    const method = { ...record.made_by.method, posture };
    const acquired = { at, from: "press", utc_offset_min: 60 };
    const sha256 = String(index + 1).repeat(64);
    const visit = {
      ...record, acquired, patient: { id: "4711", sources: [] },
      scan: { ...record.scan, sha256 }, made_by: { ...record.made_by, method },
    };
    const text = JSON.stringify(visit);
    writeFileSync(join(place, "record.json"), text);
    writeFileSync(join(place, "SHA256SUMS"), `${createHash("sha256").update(text).digest("hex")}  record.json\n`);
    return place;
  });
  for (const language of ["en", "de"]) {
    execFileSync(gaiter, ["compare", ...records, "--language", language, "--out", join(folder, language)]);
  }
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

/** Opens the comparison in a language; whatever goes wrong on it, and whatever it asks for, fails the claim. */
async function onPage(language, options, claim) {
  const address = pathToFileURL(join(folder, language, "visits.html")).href;
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, colorScheme: "light", ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") faults.push(message.text()); });
  page.on("request", (request) => { if (request.url() !== address) faults.push(`asks for ${request.url()}`); });
  await page.goto(address);
  await claim(page);
  assert.deepEqual(faults, []);
  await context.close();
}

const shoot = (page, name) => (shots ? page.screenshot({ path: join(shots, `${name}.png`), fullPage: true }) : null);

for (const language of ["en", "de"]) {
  for (const colorScheme of ["light", "dark"]) {
    test(`axe finds no violation in a comparison of visits: ${language}, ${colorScheme}`, async () => {
      await onPage(language, { colorScheme }, async (page) => {
        await page.evaluate(axe);
        const { violations } = await page.evaluate(() => globalThis.axe.run(document));
        assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(" ")}`), []);
        await shoot(page, `visits-${language}-${colorScheme}`);
      });
    });
  }
}

test("the comparison says larger, smaller or no change shown, and never better, worse or significant", async () => {
  for (const [language, shown, judged] of [
    ["en", /no change shown/i, /\b(better|worse|significant|improve\w*)\b/i],
    ["de", /keine Änderung (des Volumens )?nachgewiesen/i, /\b(besser|schlechter|signifikant\w*|Verbesserung|Verschlechterung)\b/i],
  ]) {
    await onPage(language, {}, async (page) => {
      const text = await page.locator("body").innerText();
      assert.match(text, shown);
      assert.doesNotMatch(text, judged);
    });
  }
});

test("a window of 360 px and one of 1280 px need no scrolling sideways", async () => {
  for (const width of [360, 768, 1280]) {
    await onPage("de", { viewport: { width, height: 800 } }, async (page) => {
      const over = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(over <= 0, `${width} px: ${over} px too wide`);
      await shoot(page, `visits-${width}`);
    });
  }
});

test("on paper every page has the patient, and dark colours are not printed", async () => {
  await onPage("en", { colorScheme: "dark" }, async (page) => {
    await page.emulateMedia({ media: "print" });
    const background = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    assert.ok(["rgb(255, 255, 255)", "rgba(0, 0, 0, 0)"].includes(background), background);
    const path = join(folder, "printed.pdf");
    await page.pdf({ path, preferCSSPageSize: true });
    const text = execFileSync("pdftotext", ["-layout", path, "-"], { encoding: "utf8" });
    const sheets = text.split("\f").filter((sheet) => sheet.trim() !== "");
    assert.ok(sheets.length >= 2 && sheets.length <= 8, `${sheets.length} pages`);
    sheets.forEach((sheet, at) => assert.ok(sheet.includes("4711"), `page ${at + 1} does not say whose it is`));
  });
});

test("the summary is the first page of the PDF, and no page but the last is less than half full", () => {
  for (const [language, changes, all] of [
    ["en", "Change of the girths along the legs", "All visits"],
    ["de", "Änderung der Umfänge entlang der Beine", "Alle Termine"],
  ]) {
    const path = join(folder, language, "visits.pdf");
    const read = (...how) => execFileSync("pdftotext", [...how, path, "-"], { encoding: "utf8" });
    const sheets = read("-layout").split("\f").filter((sheet) => sheet.trim() !== "");
    assert.ok(sheets[0].includes(changes) && !sheets[0].includes(all), sheets[0]);
    assert.ok(sheets[1].includes(all), sheets[1]);
    const pages = read("-bbox").split("<page ").slice(1);
    pages.slice(0, -1).forEach((page, at) => {
      const height = Number(/height="([\d.]+)"/.exec(page)[1]);
      // Without the foot.
      const ends = [...page.matchAll(/yMax="([\d.]+)"/g)].map(([, end]) => Number(end)).filter((end) => end < height - 50);
      assert.ok(Math.max(...ends) > height / 2, `page ${at + 1} of ${language} ends at ${Math.max(...ends)} pt`);
    });
  }
});

test("the page links to its PDF, and its summary is one printed page", async () => {
  for (const [language, all] of [["en", "All visits"], ["de", "Alle Termine"]]) {
    await onPage(language, {}, async (page) => {
      assert.equal(await page.locator('header a[href="visits.pdf"]').count(), 1);
      const path = join(folder, "summary.pdf");
      await page.pdf({ path, preferCSSPageSize: true });
      const text = execFileSync("pdftotext", ["-layout", path, "-"], { encoding: "utf8" });
      const sheets = text.split("\f");
      assert.ok(!sheets[0].includes(all) && sheets[1].includes(all), `${sheets[0]}\n---\n${sheets[1]}`);
    });
  }
});
