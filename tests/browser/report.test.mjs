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
function report(name, of, language) {
  const place = join(folder, `${name}-${language}`);
  const source = join(place, "record");
  mkdirSync(source, { recursive: true });
  const text = JSON.stringify(of);
  writeFileSync(join(source, "record.json"), text);
  const sum = createHash("sha256").update(text).digest("hex");
  writeFileSync(join(source, "SHA256SUMS"), `${sum}  record.json\n`);
  execFileSync(gaiter, ["report", source, "--language", language, "--out", place, "--force"]);
  return pathToFileURL(join(place, "report.html")).href;
}

/** Opens a page; whatever goes wrong on it, and whatever it asks for, fails the claim. */
async function onPage(address, options, claim) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, colorScheme: "light", ...options });
  const page = await context.newPage();
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

test("a narrow window shows everything without moving the page sideways", async () => {
  for (const language of ["en", "de"]) {
    await onPage(report("plain", record, language), { viewport: { width: 400, height: 800 } }, async (page) => {
      assert.equal(await overhang(page), 0);
      await shoot(page, `report-${language}-narrow`);
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

test("a record without shapes says so and shows no view", async () => {
  const older = structuredClone(record);
  for (const leg of older.legs) {
    delete leg.shape;
    delete leg.axis;
    leg.sections.forEach((section) => delete section.outline);
  }
  await onPage(report("older", older, "en"), {}, async (page) => {
    assert.match(await page.locator("main").textContent(), /does not hold the shape of the legs/);
    assert.equal(await page.locator("canvas").count(), 0);
    assert.match(await page.locator("#view-place").textContent(), /no shape/);
  });
});
