// Whose scan it is, on the page before a real station: held scans, and who is next.

import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { Station, at, body, browse, light, shoot, tab, until, violations } from "./station.mjs";

let browser;
before(async () => { browser = await browse(); });
after(async () => { await browser.close(); });

const WORDS = {
  en: {
    name: "Name the next patient …", id: "Patient's id", assign: "Assign …", yes: "Assign", cancel: "Cancel", close: "Close",
    view: "3D view", held: "Held", give: (id) => `Give to ${id}`, given: (id) => `The scan is then ${id}'s, and its record goes to no other patient.`,
    next: (id) => `Next: ${id}.`, replace: "Replace", asks: (a, b) => `${a} is named and was not scanned. Replace by ${b}?`,
    hidden: "The next patient is named.", inBooth: (id) => `${id} is in the booth`, refused: /not a valid patient id/,
    again: "Scan again …", yesAgain: "Scan again", againOf: (id) => `Scan ${id} again`,
  },
  de: {
    name: "Nächsten Patienten eingeben …", id: "Patientennummer", assign: "Zuordnen …", yes: "Zuordnen", cancel: "Abbrechen", close: "Schließen",
    view: "3D-Ansicht", held: "Zurückgehalten", give: (id) => `An ${id} geben`, given: (id) => `Der Scan gehört dann zu ${id}, und die Messakte geht an niemand anderen.`,
    next: (id) => `Als Nächstes: ${id}.`, replace: "Ersetzen", asks: (a, b) => `${a} ist ausgewählt und wurde nicht gescannt. Durch ${b} ersetzen?`,
    hidden: "Der nächste Patient ist ausgewählt.", inBooth: (id) => `${id} ist in der Kabine`, refused: /keine Patientennummer/,
    again: "Neu scannen …", yesAgain: "Neu scannen", againOf: (id) => `${id} neu scannen`,
  },
};

// The port is not there: a name waits for a press that nobody makes.
const BUTTON = "[trigger.serial]\nport = \"/dev/gaiter/none\"\ntokens = [\"PRESS\"]\n";

const make = (language, more = "") => Station.make({ more: `[report]\nlanguage = "${language}"\n${more}` });
const exact = (name) => ({ name, exact: true });
const shown = (id) => ({ id, shown: id });

/** Tells the page something else than the station does. */
async function changeState(context, change) {
  await context.route("**/stream*", (route) => route.fulfill({ status: 503, body: "" }));
  await context.route("**/state*", async (route) => {
    // The last question may come when the station is gone, or stops.
    const answer = await route.fetch().catch(() => null);
    if (!answer?.ok()) return route.abort();
    const state = await answer.json();
    change(state);
    return route.fulfill({ json: state });
  });
}

/** The only record of a patient; none while there is none. */
function record(station, patient) {
  const folder = join(station.dir, "records", patient);
  const [name] = existsSync(folder) ? readdirSync(folder).filter((entry) => !entry.startsWith(".")) : [];
  return name ? JSON.parse(readFileSync(join(folder, name, "record.json"), "utf8")) : null;
}

/** A scan that could be of 4711 or of 0815, on the operator's page. */
async function hold(station, page, words) {
  await page.goto(station.link());
  await page.getByRole("button", { name: words.name }).click();
  await page.getByLabel(words.id).fill("4711");
  await page.getByLabel(words.id).press("Enter");
  await light(page, "armed");
  await station.looked();
  station.export("0815_a.obj", body(40));
  const card = page.locator("#undecided_body article");
  await card.getByText(words.held).waitFor();
  return card;
}

for (const [language, words] of Object.entries(WORDS)) {
  test(`${language}: a held scan shows its legs, and one of its candidates gets it by one click and one yes`, async () => {
    await at(await make(language), async (station) => {
      const { page, context, noted } = await tab(browser, station);
      await changeState(context, (state) => state.undecided.forEach((scan) => {
        scan.candidates = [shown("4711"), shown("0815")];
      }));
      const card = await hold(station, page, words);
      const picture = card.locator("img.drawing");
      await picture.waitFor();
      await until("the picture", () => picture.evaluate((image) => image.complete && image.naturalWidth > 0));
      await card.getByRole("button", { name: words.view }).click();
      await page.waitForSelector("#viewer canvas");
      assert.match(await page.locator("#viewer_title").textContent(), new RegExp(words.held));
      await page.getByRole("button", exact(words.close)).click();
      assert.deepEqual(await violations(page), []);
      await shoot(page, `held-${language}`);

      const question = page.locator("#question");
      await card.getByRole("button", exact(words.give("0815"))).click();
      assert.equal(await page.locator("#question_title").textContent(), words.give("0815"));
      assert.equal(await page.locator("#question_hint").textContent(), words.given("0815"));
      assert.deepEqual(await violations(page), []);
      await shoot(page, `give-${language}`);
      await question.getByRole("button", exact(words.cancel)).click();
      assert.equal((await station.state()).undecided.length, 1, "it was given without a yes");
      await card.getByRole("button", exact(words.give("0815"))).click();
      await question.getByRole("button", exact(words.yes)).click();
      const stored = await until("the record", () => record(station, "0815"));
      assert.equal(stored.patient.id, "0815");
      assert.equal(record(station, "4711"), null);
      await card.waitFor({ state: "detached" });
      assert.deepEqual(noted.elsewhere, []);
      // The browser names the streams that it was denied itself.
      assert.deepEqual(noted.faults.filter((fault) => !/503/.test(fault)), []);
    });
  });

  test(`${language}: an id that is refused keeps the dialog and what was typed`, async () => {
    await at(await make(language), async (station) => {
      const { page } = await tab(browser, station);
      const card = await hold(station, page, words);
      await card.getByRole("button", exact(words.assign)).click();
      const field = page.getByLabel(words.id);
      await field.fill("4711 x");
      await field.press("Enter");
      await until("the reason", async () => words.refused.test(await page.locator("#question_fault").textContent()));
      assert.equal(await field.inputValue(), "4711 x");
      assert.ok(await field.evaluate((input) => input === document.activeElement));
      assert.deepEqual(await violations(page), []);
      await shoot(page, `refused-${language}`);
      await field.fill("4711");
      await field.press("Enter");
      await until("the record", () => record(station, "4711"));
      assert.equal(await page.locator("#question").isVisible(), false);
    });
  });

  test(`${language}: who is next is shown, and replaced after one question`, async () => {
    await at(await make(language, BUTTON), async (station) => {
      const { page } = await tab(browser, station);
      await page.goto(station.link());
      const next = page.locator("#next_body .who");
      const question = page.locator("#question");
      const name = async (id) => {
        await page.getByRole("button", { name: words.name }).click();
        await page.getByLabel(words.id).fill(id);
        await page.getByLabel(words.id).press("Enter");
      };
      await name("111");
      await next.getByText(words.next("111")).waitFor();
      assert.deepEqual(await next.locator("bdi").allTextContents(), ["111"]);

      await name("222");
      await page.locator("#question_title").getByText(words.replace).waitFor();
      assert.equal(await page.locator("#question_hint").textContent(), words.asks("111", "222"));
      assert.deepEqual(await violations(page), []);
      await shoot(page, `replace-${language}`);
      await question.getByRole("button", exact(words.cancel)).click();
      assert.ok(station.verb("patient", "show").includes(words.next("111")));

      await page.getByRole("button", { name: words.name }).click();
      assert.match(await page.locator("#question_hint").textContent(), /111/, "the dialog names who is named now");
      await page.getByLabel(words.id).fill("222");
      await page.getByLabel(words.id).press("Enter");
      await question.getByRole("button", exact(words.replace)).click();
      await next.getByText(words.next("222")).waitFor();
      assert.ok(station.verb("patient", "show").includes(words.next("222")));

      await page.goto(`${station.origin}/kiosk`);
      await next.getByText(words.hidden).waitFor();
      assert.ok(!(await page.content()).includes("222"), "everybody sees the kiosk");
    });
  });

  test(`${language}: the patient of a refused scan is named to be scanned again by one click and one yes`, async () => {
    await at(await make(language, BUTTON), async (station) => {
      const { page } = await tab(browser, station);
      await page.goto(station.link());
      station.export("4711_point.obj", Buffer.from("v 0 0 0\n"));
      const card = page.locator("#undecided_body article");
      await card.getByRole("button", exact(words.again)).click();
      assert.equal(await page.locator("#question_title").textContent(), words.againOf("4711"));
      assert.deepEqual(await violations(page), []);
      await shoot(page, `again-${language}`);
      await page.locator("#question").getByRole("button", exact(words.yesAgain)).click();
      await page.locator("#next_body .who").getByText(words.next("4711")).waitFor();
      assert.ok(station.verb("patient", "show").includes(words.next("4711")));
    });
  });

  // Red while it offered nobody: the id had to be typed.
  test(`${language}: a scan that came while the button was away is given to who is named by one click and one yes`, async () => {
    await at(await make(language, BUTTON), async (station) => {
      const { page } = await tab(browser, station);
      await page.goto(station.link());
      await page.getByRole("button", { name: words.name }).click();
      await page.getByLabel(words.id).fill("4711");
      await page.getByLabel(words.id).press("Enter");
      await page.locator("#next_body .who").getByText(words.next("4711")).waitFor();
      await station.looked();
      station.export("a.obj", body(50));
      const card = page.locator("#undecided_body article");
      await card.getByRole("button", exact(words.give("4711"))).click();
      assert.equal(await page.locator("#question_title").textContent(), words.give("4711"));
      assert.deepEqual(await violations(page), []);
      await shoot(page, `give-unpressed-${language}`);
      await page.locator("#question").getByRole("button", exact(words.yes)).click();
      await until("the record", () => record(station, "4711"));
    });
  });

  test(`${language}: of several who may be next one is named by one click`, async () => {
    await at(await make(language, BUTTON), async (station) => {
      const { page, context } = await tab(browser, station);
      await changeState(context, (state) => { state.next.who = [shown("4711"), shown("0815")]; });
      await page.goto(station.link());
      await page.getByRole("button", exact(words.inBooth("0815"))).waitFor();
      assert.deepEqual(await violations(page), []);
      await shoot(page, `who-${language}`);
      await page.getByRole("button", exact(words.inBooth("0815"))).click();
      await until("the name", () => station.verb("patient", "show").includes(words.next("0815")));
    });
  });
}

test("the kiosk names who is next where everybody may know it", async () => {
  await at(await make("en", `${BUTTON}[page]\npatient_ids = "everyone"\n`), async (station) => {
    const { page } = await tab(browser, station, { viewport: { width: 1280, height: 800 } });
    await page.goto(station.link());
    await page.getByRole("button", { name: WORDS.en.name }).click();
    await page.getByLabel(WORDS.en.id).fill("4711");
    await page.getByLabel(WORDS.en.id).press("Enter");
    await page.locator("#next_body").getByText("Next: 4711.").waitFor();
    await page.goto(`${station.origin}/kiosk`);
    await page.locator("#next_body").getByText("Next: 4711.").waitFor();
    assert.deepEqual(await violations(page), []);
    await shoot(page, "kiosk-next");
  });
});
