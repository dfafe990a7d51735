// The operator's page before a real station.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { after, before, test } from "node:test";
import { Station, at, body, browse, light, shoot, tab, until, violations } from "./station.mjs";

const sha256 = (bytes) => createHash("sha256").update(bytes).digest("hex");

let browser;
before(async () => { browser = await browse(); });
after(async () => { await browser.close(); });

/** Notes every signal that the page's light shows from now on. */
async function watchLight(page) {
  await page.evaluate(() => {
    const element = document.getElementById("light");
    window.seen = [element.dataset.signal];
    new MutationObserver(() => window.seen.push(element.dataset.signal))
      .observe(element, { attributes: true, attributeFilter: ["data-signal"] });
  });
}

test("a scan arrives, and the light goes through its states", async () => {
  // As shipped. The light stands for a second at least, and an export that is quiet for less would
  // pass it by.
  await at(await Station.make({ quiet: "2s" }), async (station) => {
    const { page, noted } = await tab(browser, station);
    await page.goto(station.link());
    await light(page, "ready");
    assert.equal(page.url(), `${station.origin}/`, "the token has left the address bar");
    await watchLight(page);
    await page.getByRole("button", { name: "Name the next patient" }).click();
    await page.getByLabel("Patient's id").fill("4711");
    await page.getByRole("button", { name: "Name", exact: true }).click();
    await light(page, "armed");
    await shoot(page, "armed");
    await station.looked();
    const bytes = body(0);
    station.export("x.obj", bytes);
    await light(page, "receiving");
    await shoot(page, "receiving");
    await light(page, "done");
    await page.waitForSelector("td.girth");
    await shoot(page, "done");
    const seen = await page.evaluate(() => window.seen);
    assert.deepEqual(seen.filter((signal, at) => signal !== seen[at - 1]), ["ready", "armed", "receiving", "done"]);
    const shown = await page.locator("tbody tr").first().locator("td").allTextContents();
    const { levels } = (await station.state()).scans[0].measures;
    const figures = [levels[0].right, levels[0].left].flatMap((of) => [of.girth_cm, of.height_cm]);
    assert.deepEqual(shown.map((text) => text.replace("?", "")), figures);
    assert.match(await page.locator("#scans_body").textContent(), /4711/);
    assert.ok(noted.bytes < 300_000, `${noted.bytes} bytes`);
    await page.getByRole("button", { name: "3D view" }).click();
    await page.waitForSelector("#viewer canvas");
    await shoot(page, "viewer");
    await page.getByRole("button", { name: "Close" }).click();
    await page.waitForSelector("#viewer canvas", { state: "detached" });
    assert.deepEqual(noted.elsewhere, []);
    assert.deepEqual(noted.faults, []);
  });
});

test("assign, take back, retry and release work by clicking", async () => {
  await at(await Station.make(), async (station) => {
    const { page, noted } = await tab(browser, station);
    await page.goto(station.link());
    await light(page, "ready");

    station.export("nobody.obj", body(1));
    const nobodys = page.locator("#undecided_body article");
    await nobodys.getByRole("button", { name: "Assign …", exact: true }).click();
    await page.getByLabel("Patient's id").fill("not one");
    await page.getByRole("button", { name: "Assign", exact: true }).click();
    await page.locator("#question_fault").getByText("not a valid patient id").waitFor();
    assert.equal(await page.getByLabel("Patient's id").inputValue(), "not one", "what was typed is lost");
    await page.getByLabel("Patient's id").fill("4711");
    await page.getByLabel("Patient's id").press("Enter");
    const card = page.locator("#scans_body article").filter({ hasText: "4711" });
    await card.getByRole("button", { name: "Take back" }).waitFor();
    const question = page.locator("#question");
    await card.getByRole("button", { name: "Take back" }).click();
    assert.match(await question.textContent(), /Take back from 4711.*leaves 4711's folder/s);
    await question.getByRole("button", { name: "Cancel" }).click();

    // The same bytes for somebody else are held.
    station.export("4712_a.obj", body(1));
    const held = page.locator("#undecided_body article").filter({ hasText: "Held" });
    await held.getByText("for another patient").waitFor();
    await light(page, "attention");
    await shoot(page, "attention");
    await held.getByRole("button", { name: "Release" }).click();
    assert.match(await question.textContent(), /Release to 4712.*to this patient and to no other/s);
    await question.getByRole("button", { name: "Release" }).click();
    await page.getByText("Nothing waits for a decision.").waitFor();
    await until("the second patient's record", async () =>
      page.locator("#scans_body").textContent().then((text) => /4712/.test(text)));

    station.export("4713_a.obj", Buffer.from("v 0 0 0\n"));
    const refused = page.locator("#undecided_body article").filter({ hasText: "Refused" });
    await refused.waitFor();
    await refused.getByRole("button", { name: "Try again" }).click();
    await page.getByText("The scan is tried again.").waitFor();
    assert.deepEqual(noted.elsewhere, []);
    // The browser names the refused decision itself.
    assert.deepEqual(noted.faults.filter((fault) => !/409/.test(fault)), []);
  });
});

test("pause and resume, name and call off", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await light(page, "ready");
    await page.getByRole("button", { name: "Pause" }).click();
    await light(page, "paused");
    assert.match(await page.locator("#sentence").textContent(), /Resume to continue/);
    await shoot(page, "paused");
    await page.getByRole("button", { name: "Resume" }).click();
    await light(page, "ready");
    await page.getByRole("button", { name: "Name the next patient" }).click();
    await page.getByLabel("Patient's id").fill("4711");
    await page.getByRole("button", { name: "Name", exact: true }).click();
    await light(page, "armed");
    await page.getByRole("button", { name: "Call off" }).click();
    await page.locator("#question").getByRole("button", { name: "Call off" }).click();
    await light(page, "ready");
  });
});

test("the stream survives a restart of the station without reload", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await light(page, "ready");
    await page.evaluate(() => { window.isTheSamePage = true; });
    await station.stop();
    await light(page, "away");
    await shoot(page, "away");
    await station.start();
    await light(page, "ready");
    station.export("4711_a.obj", body(2));
    await light(page, "done");
    await page.getByRole("button", { name: "Pause" }).click();
    await light(page, "paused");
    assert.ok(await page.evaluate(() => window.isTheSamePage), "it was loaded anew");
  });
});

test("a page of another version loads itself anew, once", async () => {
  await at(await Station.make(), async (station) => {
    const { page, context } = await tab(browser, station);
    let loads = 0;
    await context.route(`${station.origin}/`, async (route) => {
      loads += 1;
      const answer = await route.fetch();
      const text = await answer.text();
      await route.fulfill({ response: answer, body: text.replace(/data-page="[0-9a-f]+"/, "data-page=\"old\"") });
    });
    await page.goto(`${station.origin}/`);
    await light(page, "ready");
    await until("a second load", () => loads >= 2);
    await light(page, "ready");
    // The page is as it was, and yet is not loaded a third time when the next snapshot comes.
    station.verb("pause");
    await light(page, "paused");
    assert.equal(loads, 2);
  });
});

test("whoever has no token reads, and learns no id", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    station.export("4711_a.obj", body(3));
    await page.goto(`${station.origin}/`);
    await page.waitForSelector("td.girth");
    assert.equal(await page.getByRole("button").count(), 0);
    assert.ok(!(await page.content()).includes("4711"));
    assert.ok((await page.locator("#reading").textContent()).includes("gaiter page"));
    await page.goto(`${station.origin}/#token=${"0".repeat(64)}`);
    await page.waitForSelector("#said[data-bad]");
    assert.match(await page.locator("#said").textContent(), /gaiter page/);
  });
});

test("hostile ids show as text, and nothing of them runs", async () => {
  const ids = [
    "<script>window.hacked=1<", "<img src=x onerror=window.hacked=1>", "\"'`&lt;{{page}}",
    "\u202e4711\u2066 abc", "7".repeat(64),
  ];
  const station = await Station.make({ pattern: "^[^/.\\n][^/\\n]*$" });
  await at(station, async () => {
    const { page, noted } = await tab(browser, station);
    await page.goto(station.link());
    await light(page, "ready");
    const name = async (id) => {
      await page.getByRole("button", { name: "Name the next patient" }).click();
      await page.getByLabel("Patient's id").fill(id);
      await page.getByRole("button", { name: "Name", exact: true }).click();
    };
    for (const [n, id] of ids.entries()) {
      // What turns the direction of writing could make one id look like another.
      const seen = id.replace("\u202e", "[U+202E]").replace("\u2066", "[U+2066]");
      await name(id);
      await light(page, "armed");
      await station.looked();
      station.export(`x${n}.obj`, body(10 + n));
      await until(`the id ${n}`, async () =>
        (await page.locator("#scans_body bdi").allTextContents()).includes(seen));
      await light(page, "done");
    }
    // The id is sent as it is, and not as it is shown.
    const hidden = page.locator("#scans_body details.folded").filter({ hasText: "[U+202E]" });
    await hidden.locator("summary").first().click();
    await hidden.getByRole("button", { name: "Take back" }).click();
    await page.locator("#question").getByRole("button", { name: "Take back" }).click();
    await page.getByText("The scan is unassigned again.").waitFor();
    await name("7".repeat(500));
    await page.locator("#question_fault").getByText("not a valid patient id").waitFor();
    await shoot(page, "hostile-stored");
    assert.equal(await page.evaluate(() => window.hacked), undefined);
    assert.deepEqual(noted.elsewhere, []);
  });
});

test("whatever the station says, the page shows it as text and stays in its bounds", async () => {
  await at(await Station.make(), async (station) => {
    const { page, context, noted } = await tab(browser, station, { viewport: { width: 1000, height: 800 } });
    const hostile = ["<script>window.hacked=1</script>", "<img src=x onerror=window.hacked=1>", "\"'`&lt;", "\u202e4711\u2066", "W".repeat(500)];
    const scan = (patients) => ({
      scan: sha256(patients[0]), of: "", incomplete: false, at: "2026-11-22T10:00:00Z", state: "held", word: "Held", code: "<b>", patients,
      advice: { what: "<i>", next: "</p>" }, candidates: patients.map((id) => ({ id, shown: id })), acts: ["assign"], measures: null, files: [], unmeasured: null,
    });
    await context.route("**/stream*", (route) => route.fulfill({ status: 503, body: "" }));
    await context.route("**/state*", async (route) => {
      // The last question may come when the station is gone, or stops.
      const answer = await route.fetch().catch(() => null);
      if (!answer?.ok()) return route.abort();
      const state = await answer.json();
      state.next.pieces = ["", hostile[4], ""];
      state.undecided = hostile.map((id) => scan([id]));
      state.scans = state.undecided;
      return route.fulfill({ json: state });
    });
    await page.goto(station.link());
    await page.waitForSelector("#undecided_body article");
    // Each stands at its scan, and on the button that gives it the scan.
    assert.deepEqual(await page.locator("#undecided_body bdi").allTextContents(), hostile.flatMap((id) => [id, id]));
    assert.equal(await page.locator("#next_body bdi").textContent(), hostile[4]);
    const { wide, screen } = await page.evaluate(() => ({ wide: document.documentElement.scrollWidth, screen: innerWidth }));
    assert.ok(wide <= screen, `${wide} of ${screen}`);
    assert.equal(await page.evaluate(() => window.hacked), undefined);
    await shoot(page, "hostile");
    assert.deepEqual(noted.elsewhere, []);
  });
});

test("axe-core finds nothing wrong, in both themes and languages, on page and kiosk", async () => {
  for (const language of ["en", "de"]) {
    const station = await Station.make({ more: `[report]\nlanguage = "${language}"\n` });
    await at(station, async () => {
      station.export("4711_a.obj", body(4));
      station.export("4712_a.obj", Buffer.from("v 0 0 0\n"));
      station.export("nobody.obj", body(5));
      await until("the scans", async () => {
        const { scans, undecided } = await station.state();
        return undecided.length === 2 && [...undecided, ...scans].filter((scan) => scan.measures).length === 2;
      });
      for (const colorScheme of ["light", "dark"]) {
        const { page } = await tab(browser, station, { colorScheme, viewport: { width: 1280, height: 800 }, locale: language });
        await page.goto(station.link());
        await page.waitForSelector("#undecided_body article");
        await page.waitForSelector("td.girth");
        await shoot(page, `page-${language}-${colorScheme}`);
        assert.deepEqual(await violations(page), [], `page ${language} ${colorScheme}`);
        await page.locator("#search > summary").click();
        await page.locator("#search_body details").nth(2).waitFor();
        assert.deepEqual(await violations(page), [], `search ${language} ${colorScheme}`);
        await page.locator("#next_body button").first().click();
        assert.deepEqual(await violations(page), [], `question ${language} ${colorScheme}`);
        await shoot(page, `question-${language}-${colorScheme}`);
        await page.goto(`${station.origin}/kiosk`);
        await page.waitForSelector("td.girth");
        await shoot(page, `kiosk-${language}-${colorScheme}`);
        assert.deepEqual(await violations(page), [], `kiosk ${language} ${colorScheme}`);
        await page.context().close();
      }
    });
  }
});

test("what the kiosk says of the light can be read from 3 m, and fits its screen", async () => {
  await at(await Station.make(), async (station) => {
    station.export("4711_a.obj", body(6));
    for (const viewport of [{ width: 1920, height: 1080 }, { width: 1280, height: 800 }, { width: 1080, height: 1920 }]) {
      // A sign that turns is at times wider than it lies.
      const { page } = await tab(browser, station, { viewport, reducedMotion: "reduce" });
      await page.goto(`${station.origin}/kiosk`);
      await page.waitForSelector("td.girth");
      const sizes = await page.evaluate(() => {
        const size = (id) => parseFloat(getComputedStyle(document.getElementById(id)).fontSize);
        const all = document.documentElement;
        const cut = [...document.querySelectorAll("section")].filter((part) => part.scrollHeight > part.clientHeight + 2);
        return { word: size("word"), sentence: size("sentence"), table: size("last_body"), cut: cut.map((part) => part.id), tall: all.scrollHeight, wide: all.scrollWidth };
      });
      // On a screen of 30 cm height, an angle of 0.3° at 3 m is 16 mm: a nineteenth of it.
      const short = Math.min(viewport.width, viewport.height);
      assert.ok(sizes.sentence > short / 25 && sizes.word > short / 14, JSON.stringify(sizes));
      assert.deepEqual(sizes.cut, [], JSON.stringify({ ...sizes, said: await page.textContent("#light") }));
      assert.ok(sizes.tall <= viewport.height && sizes.wide <= viewport.width, JSON.stringify(sizes));
      await shoot(page, `kiosk-${viewport.width}`);
      await page.context().close();
    }
  });
});

test("nothing is cut off: German on the narrowest phone, both legs of a report on a phone, the toes on a laptop", async () => {
  await at(await Station.make({ more: `[report]\nlanguage = "de"\n` }), async (station) => {
    station.export("4711_a.obj", body(7, "f_average_tc2"));
    const on = async (width, height) => {
      const { page } = await tab(browser, station, { viewport: { width, height }, locale: "de" });
      await page.goto(station.link());
      await page.waitForSelector("td.girth");
      return page;
    };
    const narrow = await on(320, 640);
    assert.ok(await narrow.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "320 px");
    await shoot(narrow, "page-320");
    const phone = await on(390, 844);
    const report = await phone.getByRole("link", { name: "Bericht", exact: true }).getAttribute("href");
    await phone.goto(station.origin + report);
    const right = await phone.locator("table.levels").evaluate((table) => table.getBoundingClientRect().right);
    assert.ok(right <= 390, `the left leg ends at ${right} px of 390`);
    await shoot(phone, "report-390");
    const laptop = await on(1280, 800);
    await laptop.getByRole("button", { name: "3D-Ansicht" }).click();
    const stage = await laptop.locator("#viewer .gaiter-stage").evaluate((stage) => {
      const dialog = document.getElementById("viewer_body").getBoundingClientRect();
      return { bottom: stage.getBoundingClientRect().bottom, end: dialog.bottom };
    });
    assert.ok(stage.bottom <= stage.end, JSON.stringify(stage));
  });
});
