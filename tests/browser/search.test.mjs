// All scans: the search, and what a scan of two patients shows of each.

import assert from "node:assert/strict";
import { existsSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Station, at, body, browse, shoot, tab, until, violations } from "./station.mjs";

let browser;
before(async () => { browser = await browse(); });
after(async () => { await browser.close(); });

/** The folders of a patient's records. */
function records(station, patient) {
  const folder = join(station.dir, "records", patient);
  return existsSync(folder) ? readdirSync(folder).filter((entry) => !entry.startsWith(".")) : [];
}

test("scans are found by patient, by id, by state and by what they lack", async () => {
  await at(await Station.make(), async (station) => {
    const { page, noted } = await tab(browser, station, { viewport: { width: 390, height: 844 } });
    station.export("4711_a.obj", body(70));
    station.export("0815_a.obj", body(71));
    station.export("nobody.obj", body(72));
    station.export("4712_a.obj", Buffer.from("v 0 0 0\n"));
    await until("the scans", async () => {
      const { scans, undecided } = await station.state();
      return undecided.length === 2 && scans.filter((scan) => scan.measures).length === 2;
    });
    await page.goto(station.link());
    await page.locator("#search > summary").click();
    const rows = page.locator("#search_body details.found");
    await rows.nth(3).waitFor();
    const find = async (count) => {
      await page.getByRole("button", { name: "Search", exact: true }).click();
      await until(`${count} scans`, async () => (await rows.count()) === count);
    };
    await page.getByLabel("Patient or scan").fill("471");
    await find(2);
    await page.getByLabel("State").selectOption("delivered");
    await find(1);
    assert.match(await rows.first().textContent(), /4711/);
    await rows.first().locator("summary").first().click();
    await rows.first().getByRole("link", { name: "Report", exact: true }).waitFor();
    assert.deepEqual(await violations(page), []);
    await shoot(page, "search-phone");
    const { wide, screen } = await page.evaluate(() => ({ wide: document.documentElement.scrollWidth, screen: innerWidth }));
    assert.ok(wide <= screen, `${wide} of ${screen}`);
    await page.getByLabel("Patient or scan").fill("");
    await page.getByLabel("State").selectOption("undecided");
    await find(2);
    await page.getByLabel("State").selectOption("");
    await page.getByLabel("Measures missing").check();
    await find(0);
    await page.getByText("No scan found.").waitFor();
    await page.getByLabel("Measures missing").uncheck();
    await page.getByLabel("Until").fill("2020-01-01");
    await find(0);
    assert.deepEqual(noted.faults, []);
  });
});

test("a scan released to a second patient keeps report, picture and take-back for both", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    station.export("4711_a.obj", body(73));
    const cards = page.locator("#scans_body article");
    const of = (id) => cards.filter({ hasText: `Patient ${id}` });
    await of("4711").getByRole("link", { name: "Report", exact: true }).waitFor();
    station.export("0815_a.obj", body(73));
    const held = page.locator("#undecided_body article");
    await held.getByText("for another patient").waitFor();
    await of("4711").getByRole("link", { name: "Report", exact: true }).waitFor();
    await held.getByRole("button", { name: "Release" }).click();
    await page.locator("#question").getByRole("button", { name: "Release" }).click();
    // The newest stands open.
    await page.locator("#scans_body details.folded > summary").click();
    for (const id of ["4711", "0815"]) {
      const card = of(id);
      const link = card.getByRole("link", { name: "Data (JSON)" });
      const address = await link.getAttribute("href");
      const record = await page.evaluate(async (address) => (await fetch(address)).json(), address);
      assert.equal(record.patient.id, id, "one patient's name opens another's record");
      await card.locator("img.drawing").waitFor();
      await card.getByRole("button", { name: "Take back" }).waitFor();
    }
    await shoot(page, "two-patients");
    await of("0815").getByRole("button", { name: "Take back" }).click();
    assert.match(await page.locator("#question").textContent(), /Take back from 0815/);
    await page.locator("#question").getByRole("button", { name: "Take back" }).click();
    await until("the record to go", () => records(station, "0815").length === 0);
    assert.equal(records(station, "4711").length, 1);
    await until("one card", async () => (await cards.count()) === 1);
    assert.match(await cards.textContent(), /4711/);
  });
});
