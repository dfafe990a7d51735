// The worklist on the operator's page, before a real station and a server that a test drives.

import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Station, at, body, browse, light, shoot, tab, until, violations } from "./station.mjs";
import { WorklistServer } from "./worklist_server.mjs";

const FIRST = { patient: "4711", name: "Quastenflosser^Hanna", born: "19470311", number: "A1", time: "0930" };
const SECOND = { patient: "4712", name: "Hammerhai^Karl<b>fett</b>", born: "", number: "A2", time: "1000" };

let browser;
before(async () => { browser = await browse(); });
after(async () => { await browser.close(); });

/** Runs a test before a station with a worklist that has these entries, and more of a configuration. */
async function listing(entries, run, more = "") {
  const server = await WorklistServer.make(entries);
  try {
    await at(await Station.make({ more: `${server.section}${more}` }), (station) => run(station, server));
  } finally {
    server.end();
  }
}

/** The record of a patient; null if there is none. */
function record(station, patient) {
  const folder = join(station.dir, "records", patient);
  const found = existsSync(folder) ? readdirSync(folder).filter((name) => !name.startsWith(".")) : [];
  return found.length ? JSON.parse(readFileSync(join(folder, found[0], "record.json"), "utf8")) : null;
}

const rows = (page) => page.locator("#worklist_body li");
const choose = (page, at) => rows(page).nth(at).getByRole("button", { name: /^Choose / }).click();
const next = (page, patient) => page.locator("#next_body .who").filter({ hasText: patient }).waitFor();
const unknown = (page) => page.locator("#worklist_body").getByText("has not answered today").waitFor();

/** Awaits how the station says that its worklist is. */
const part = (station, word) => until(`a worklist that ${word}`, async () =>
  (await station.state()).parts.some((of) => of.name === "Worklist" && of.word === word));

test("the day's entries are listed, and the one that is chosen is the patient of the next scan", async () => {
  await listing([SECOND, FIRST], async (station) => {
    const { page, noted } = await tab(browser, station);
    await page.goto(station.link());
    await light(page, "ready");
    await rows(page).nth(1).waitFor();
    const first = await rows(page).first().locator("span, bdi").allTextContents();
    assert.deepEqual(first, ["09:30", "Quastenflosser, Hanna", "Mar 11, 1947", "4711", "Beinvermessung, A1"]);
    const second = await rows(page).nth(1).locator("span, bdi").allTextContents();
    assert.deepEqual(second.slice(0, 3), ["10:00", "Hammerhai, Karl<b>fett</b>", ""]);
    for (const name of ["Choose Quastenflosser, Hanna, 4711, A1", "Choose Hammerhai, Karl<b>fett</b>, 4712, A2"]) {
      assert.equal(await page.getByRole("button", { name, exact: true }).count(), 1, name);
    }
    assert.deepEqual(await violations(page), []);
    await shoot(page, "worklist");
    assert.match(await page.locator("#next_body").textContent(), /No patient is named/, "a list names nobody");

    await choose(page, 0);
    await light(page, "armed");
    await next(page, "4711");
    // Somebody else is chosen: the page asks, and without a yes nothing changes.
    const question = page.locator("#question");
    await choose(page, 1);
    await question.getByText("4711 is named and was not scanned. Replace by 4712?").waitFor();
    assert.deepEqual(await violations(page), []);
    await question.getByRole("button", { name: "Cancel" }).click();
    assert.match(await page.locator("#next_body").textContent(), /4711/);
    await choose(page, 1);
    await question.getByRole("button", { name: "Replace", exact: true }).click();
    await next(page, "4712");

    await station.looked();
    station.export("x.obj", body(50));
    const { patient } = await until("the record", () => record(station, "4712"));
    assert.deepEqual(patient.sources, [{
      kind: "operator", confidence: "high", request: { study_instance_uid: "1.2.276.4712", accession_number: "A2" },
    }]);
    assert.equal(record(station, "4711"), null);
    assert.deepEqual(noted.elsewhere, []);
    // The browser names the refused decision itself.
    assert.deepEqual(noted.faults.filter((fault) => !/409/.test(fault)), []);
  });
});

test("an entry that has gone since the page was drawn names nobody", async () => {
  await listing([FIRST, SECOND], async (station, server) => {
    const { page, context } = await tab(browser, station);
    await page.goto(station.link());
    await rows(page).nth(1).waitFor();
    // The page keeps what it has.
    await context.route("**/worklist", (route) => route.abort());
    server.entries = [FIRST];
    await until("a list of one", () => JSON.parse(station.verb("status", "--json")).worklist.entries === 1);
    await choose(page, 1);
    await page.locator("#said").getByText("no longer on the worklist").waitFor();
    assert.match(await page.locator("#next_body").textContent(), /No patient is named/);
    await context.unroute("**/worklist");
    await rows(page).nth(1).waitFor({ state: "detached" });
    assert.equal(await rows(page).count(), 1);
  });
});

test("while the server is away the page says so, the last list holds, and it goes with the station", async () => {
  await listing([], async (station, server) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await page.locator("#worklist_body").getByText("Nobody is planned for today.").waitFor();
    server.entries = [FIRST];
    await rows(page).first().waitFor();
    server.isAway = true;
    await part(station, "does not answer");
    assert.match(await rows(page).first().textContent(), /Quastenflosser, Hanna/);
    // The patient is named all the same, by the last list or by the id.
    await choose(page, 0);
    await light(page, "armed");
    await page.getByRole("button", { name: "Call off" }).click();
    await page.locator("#question").getByRole("button", { name: "Call off" }).click();
    await light(page, "ready");
    await station.stop();
    await light(page, "away");
    assert.doesNotMatch(await page.content(), /Quastenflosser/, "names outlive their station");
    await station.start();
    await part(station, "does not answer");
    await unknown(page);
    await shoot(page, "worklist-away");
    assert.deepEqual(await violations(page), []);
    await page.getByRole("button", { name: "Name the next patient" }).click();
    await page.getByLabel("Patient's id").fill("4712");
    await page.getByRole("button", { name: "Name", exact: true }).click();
    await light(page, "armed");
    // It comes back by itself.
    server.isAway = false;
    await rows(page).first().waitFor();
    await part(station, "answers");
  });
});

test("in German, too, each button names whom it chooses", async () => {
  await listing([FIRST], async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    const name = "Auswählen: Quastenflosser, Hanna, 4711, A1";
    await page.getByRole("button", { name, exact: true }).waitFor();
  }, "[report]\nlanguage = \"de\"\n");
});

test("whoever has no token sees no worklist, and a kiosk none at all", async () => {
  await listing([FIRST], async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(`${station.origin}/`);
    await light(page, "ready");
    await part(station, "answers");
    assert.ok(await page.locator("#worklist").isHidden());
    await page.goto(station.link());
    await rows(page).first().waitFor();
    await page.goto(`${station.origin}/kiosk`);
    await light(page, "ready");
    assert.doesNotMatch(await page.content(), /Quastenflosser/);
  });
});
