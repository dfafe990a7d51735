// A person sets measures on the operator's page, before a real station.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Station, at, body, browse, shoot, tab, unseen, until, violations } from "./station.mjs";

let browser;
before(async () => { browser = await browse(); });
after(async () => { await browser.close(); });

/** The latest revision of the patient's only record. */
function record(station) {
  const patient = join(station.dir, "records/4711");
  const folder = readdirSync(patient).filter((name) => !name.startsWith(".")).sort().at(-1);
  return JSON.parse(readFileSync(join(patient, folder, "record.json"), "utf8"));
}

/** The form of a scan of patient 4711. */
async function open(page) {
  await page.getByRole("button", { name: "Set by hand" }).first().click();
  const form = page.getByRole("dialog", { name: "Set measures of 4711 by hand" });
  await form.waitFor();
  return form;
}

test("a person sets measures, is told what is wrong, and sees them with their mark", async () => {
  await at(await Station.make(), async (station) => {
    const { page, noted } = await tab(browser, station);
    await page.goto(station.link());
    await station.looked();
    station.export("4711_x.obj", body(0));
    await page.waitForSelector("td.girth");
    const scanned = record(station).legs.find((leg) => leg.side === "right").landmarks.C;

    let form = await open(page);
    assert.deepEqual(await violations(page), []);
    await shoot(page, "amend");
    const girth = form.getByLabel("Right C: Girth (cm)");
    assert.equal(await girth.getAttribute("placeholder"), (scanned.girth_tape_mm / 10).toFixed(1));
    const save = form.getByRole("button", { name: "Save" });
    await form.getByLabel("Reason").fill("swollen");
    await form.getByLabel("Your name").fill("Anna Berg");
    await save.click();
    await form.getByText("No value is entered.").waitFor();
    await girth.fill("38,x");
    await save.click();
    await form.getByText("This is not a number: 38,x").waitFor();
    await girth.fill("3,8");
    await save.click();
    await form.getByText("right leg, C: girth 3.8 cm is not between 5.0 and 150.0 cm").waitFor();
    assert.equal(await form.getByLabel("Reason").inputValue(), "swollen", "what was typed stays");
    await girth.fill("13,8");
    await save.click();
    await form.getByText("right leg, C: girth 13.8 cm is far off the scan").waitFor();
    await form.getByRole("button", { name: "Save all the same" }).waitFor();
    // A decimal comma, and a second measure in the same revision.
    await girth.fill("38,55 cm");
    await form.getByRole("combobox", { name: "Left D" }).selectOption({ label: "not measurable" });
    await save.click();
    await form.waitFor({ state: "hidden" });
    const now = record(station);
    assert.equal(now.revision, 2);
    const set = now.amendments.map(({ leg, measure, is, girth_mm: mm }) => [leg, measure, is, mm]);
    assert.deepEqual(set, [["left", "D", "not-measurable", null], ["right", "C", "measured", 385.5]]);
    assert.deepEqual(now.legs.find((leg) => leg.side === "right").landmarks.C, scanned, "the scan's value stays");
    const row = page.locator("#scans_body tbody tr", { has: page.getByRole("rowheader", { name: "C", exact: true }) });
    await until("the new girth", async () => (await row.textContent()).includes("38.6*"));
    await page.getByText("Not measurable: left leg: D.").first().waitFor();
    assert.deepEqual(await page.locator("#scans_body td.absent").allTextContents(), ["not measurable"]);
    await shoot(page, "amended");

    // It can be taken back; the name is remembered.
    form = await open(page);
    assert.equal(await form.getByLabel("Your name").inputValue(), "Anna Berg");
    assert.equal(await form.getByLabel("Right C: Girth (cm)").getAttribute("placeholder"), "38.6");
    await form.getByRole("combobox", { name: "Right C" }).selectOption({ label: "as scanned" });
    await form.getByLabel("Reason").fill("slip");
    await form.getByRole("button", { name: "Save" }).click();
    await form.waitFor({ state: "hidden" });
    await until("the scan's girth", async () => !(await row.textContent()).includes("*"));
    assert.deepEqual(noted.elsewhere, []);
    // The measure that was not possible.
    assert.deepEqual(noted.faults.filter((fault) => !fault.includes("409")), []);
  });
});

test("without the link for decisions no measure can be set", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.origin);
    await station.looked();
    station.export("4711_x.obj", body(0));
    await page.waitForSelector("td.girth");
    assert.equal(await page.getByRole("button", { name: "Set by hand" }).count(), 0);
    const body_ = { ask: "amend", scan: (await station.state()).scans[0].scan, measures: [], reason: "a", by: "b" };
    const status = await page.evaluate(async (body) => (await fetch("/ask", {
      method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body),
    })).status, body_);
    assert.equal(status, 401);
    assert.equal(record(station).revision, 1);
  });
});

test("what is to be measured by hand stands above, and its form begins with what is asked", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await station.looked();
    // Of its right calf the outer side was not seen.
    const outside = ([x, y]) => x < -205 && y > 280 && y < 360;
    station.export("4711_x.obj", unseen(body(0), outside));
    const card = page.locator("#undecided_body article");
    await card.getByText("Measure by hand: right leg: C").waitFor();
    const [first] = await card.locator(".buttons button").all();
    assert.equal(await first.textContent(), "Set by hand …");
    assert.equal(await first.getAttribute("class"), "main");
    const form = await open(page);
    const girth = form.getByLabel("Right C: Girth (cm), to be measured");
    await girth.and(page.locator("input.asked:focus")).waitFor();
    assert.deepEqual(await violations(page), []);
    await shoot(page, "amend-asked");
    assert.equal(await form.getByLabel("Left D: Girth (cm)").isVisible(), false);
    await form.getByText("All other measures").click();
    assert.equal(await form.getByLabel("Left D: Girth (cm)").isVisible(), true);
    await girth.fill("34,0 cm");
    await form.getByLabel("Right C: Height (cm), to be measured").fill("34");
    await form.getByLabel("Reason").fill("not seen");
    await form.getByLabel("Your name").fill("Anna Berg");
    await form.getByRole("button", { name: "Save" }).click();
    await form.waitFor({ state: "hidden" });
    const set = record(station).amendments.map(({ leg, measure, girth_mm: mm }) => [leg, measure, mm]);
    assert.deepEqual(set, [["right", "C", 340]]);
  });
});

test("on a phone the form shows both legs, what is wrong and its buttons, and nothing is beside the screen", async () => {
  for (const [width, language, names] of [
    [390, "en", { form: /by hand/, left: "Left C: Girth (cm)", reason: "Reason", by: "Your name", save: "Save", far: /far off/ }],
    [320, "de", { form: /von Hand/, left: "Links C: Umfang (cm)", reason: "Grund", by: "Ihr Name", save: "Speichern", far: /weit/ }],
  ]) {
    await at(await Station.make({ more: `[report]\nlanguage = "${language}"\n` }), async (station) => {
      const { page } = await tab(browser, station, { viewport: { width, height: 844 } });
      await page.goto(station.link());
      await station.looked();
      station.export("4711_x.obj", body(0));
      await page.waitForSelector("td.girth");
      await page.getByRole("button", { name: /by hand|von Hand/i }).first().click();
      const form = page.getByRole("dialog", { name: names.form });
      await form.waitFor();
      assert.deepEqual(await violations(page), []);
      await form.getByLabel(names.left).fill("13,8");
      await form.getByLabel(names.reason).fill("x");
      await form.getByLabel(names.by).fill("x");
      await form.getByRole("button", { name: names.save }).click();
      await form.getByText(names.far).waitFor();
      await shoot(page, `amend-${width}`);
      const outside = await form.evaluate((dialog, right) => [...dialog.querySelectorAll("input, select, button, p, h2")]
        .filter((part) => part.getBoundingClientRect().width && part.getBoundingClientRect().right > right)
        .map((part) => part.outerHTML), width);
      assert.deepEqual(outside, []);
      assert.ok(await form.evaluate((dialog) => dialog.scrollWidth <= dialog.clientWidth), "nothing to scroll to the side");
    });
  }
});

test("the affected leg of a patient is named, and nothing is sent before one is chosen", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await station.looked();
    station.export("4711_x.obj", body(0));
    await page.waitForSelector("td.girth");
    await page.getByRole("button", { name: "Affected leg" }).first().click();
    const dialog = page.getByRole("dialog", { name: "Affected leg of 4711" });
    await dialog.waitFor();
    assert.deepEqual(await violations(page), []);
    const save = dialog.getByRole("button", { name: "Save" });
    await save.click();
    assert.ok(await dialog.isVisible(), "nothing is chosen yet");
    await dialog.getByRole("combobox", { name: "Affected leg" }).selectOption({ label: "left leg" });
    await save.click();
    await dialog.waitFor({ state: "hidden" });
    await page.getByText("The affected leg is noted.").waitFor();
  });
});
