// What the light says when a person is needed, on the page and on a kiosk.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Station, at, body, browse, light, shoot, tab, until, violations } from "./station.mjs";

let browser;
before(async () => { browser = await browse(); });
after(async () => { await browser.close(); });

const VIEWPORTS = [
  { width: 1920, height: 1080 }, { width: 1280, height: 800 }, { width: 1280, height: 720 }, { width: 1080, height: 1920 }, { width: 390, height: 844 },
];

/** What is cut off or wider than the screen. */
async function overflow(page) {
  return page.evaluate(() => {
    const all = document.documentElement;
    const light = document.getElementById("light");
    const cut = [...document.querySelectorAll("section, article, table, .card, .measures")]
      .filter((part) => part.scrollWidth > part.clientWidth + 1 && getComputedStyle(part).overflowX === "visible");
    return {
      wide: all.scrollWidth > innerWidth, cut: cut.map((part) => part.id || part.className || part.tagName),
      light: light.scrollHeight > light.clientHeight + 1,
      covered: ["last", "next"].some((id) => {
        const box = document.getElementById(id);
        return box && document.documentElement.dataset.view === "kiosk"
          && (box.getBoundingClientRect().top < light.getBoundingClientRect().bottom || box.scrollHeight > box.clientHeight + 1);
      }),
    };
  });
}

/** The words of the light, looked at in each viewport of page and kiosk. */
async function said(browser, station, name) {
  let sentence = null;
  for (const viewport of VIEWPORTS) {
    for (const place of ["/", "/kiosk"]) {
      const { page } = await tab(browser, station, { viewport, reducedMotion: "reduce" });
      await page.goto(place === "/" ? station.link() : `${station.origin}${place}`);
      await page.waitForSelector("#light[data-signal]");
      const found = await overflow(page);
      const shown = `${name} ${place} ${viewport.width}`;
      assert.deepEqual(found, { wide: false, cut: [], light: false, covered: false }, shown);
      await shoot(page, `light-${name}-${place === "/" ? "page" : "kiosk"}-${viewport.width}`);
      sentence = await page.locator("#sentence").textContent();
      assert.deepEqual(await violations(page), [], shown);
      await page.context().close();
    }
  }
  return sentence;
}

test("a refused scan says why and what to do at the booth, on the kiosk, too", async () => {
  for (const [language, why] of [["en", /cannot be used.*Scan again/s], ["de", /nicht verwendbar.*canne/s]]) {
    await at(await Station.make({ more: `[report]\nlanguage = "${language}"\n` }), async (station) => {
      station.export("4711_a.obj", Buffer.from("v 0 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\n"));
      await until("the refusal", async () => (await station.state()).light.signal === "attention");
      assert.match(await said(browser, station, `refused-${language}`), why);
    });
  }
});

test("a held scan is told while another export is expected", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await page.getByRole("button", { name: "Name the next patient" }).click();
    await page.getByLabel("Patient's id").fill("4711");
    await page.getByLabel("Patient's id").press("Enter");
    await light(page, "armed");
    await station.looked();
    station.export("0815_a.obj", body(60));
    await light(page, "attention");
    const sentence = await said(browser, station, "held");
    assert.match(sentence, /^The last scan is held\. .*Decide on the page whose it is\. Until then, or for up to \d+ min, other scans are held\.$/s);
  });
});

test("an export that does not come is told, and a station without a button is not told to press one", async () => {
  await at(await Station.make({ patient: 'expires = "10s"', more: '[capture]\nlate = "9m"\n' }), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await page.getByRole("button", { name: "Name the next patient" }).click();
    await page.getByLabel("Patient's id").fill("4711");
    await page.getByLabel("Patient's id").press("Enter");
    await light(page, "armed");
    await light(page, "no_export");
    const sentence = await said(browser, station, "no-export");
    assert.match(sentence, /^No export came\. Name the patient and scan again\. If another patient is next, call off first\. Until then, or for up to \d min, other scans are held\.$/);
  });
});

test("a refused scan is given up after one question, and can be tried again", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    station.export("4711_a.obj", Buffer.from("v 0 0 0\n"));
    const refused = page.locator("#undecided_body article");
    await refused.getByRole("button", { name: "Give up" }).click();
    assert.match(await page.locator("#question").textContent(), /Give up 4711's scan/);
    await page.locator("#question").getByRole("button", { name: "Give up" }).click();
    await page.getByText("Nothing waits for a decision.").waitFor();
    const closed = page.locator("#scans_body article").filter({ hasText: "Given up" });
    await closed.getByRole("button", { name: "Try again" }).click();
    await refused.getByText("Refused").waitFor();
  });
});

test("a pause is shown at once, and after it no attention", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    await light(page, "ready");
    await page.evaluate(() => {
      const element = document.getElementById("light");
      window.seen = [];
      new MutationObserver(() => window.seen.push(element.dataset.signal))
        .observe(element, { attributes: true, attributeFilter: ["data-signal"] });
    });
    await page.getByRole("button", { name: "Pause" }).click();
    await light(page, "paused");
    assert.match(await said(browser, station, "paused"), /Resume/);
    await page.getByRole("button", { name: "Resume" }).click();
    await light(page, "ready");
    assert.deepEqual(await page.evaluate(() => window.seen), ["paused", "ready"]);
  });
});

test("a record without a patient needs a decision, is listed once, and can be left so", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(station.link());
    station.export("nobody.obj", body(61));
    const card = page.locator("#undecided_body article");
    await card.getByText("No patient").waitFor();
    await light(page, "attention");
    assert.match(await page.locator("#sentence").textContent(), /stored, but without a patient\. Say on the page whose it is\./);
    assert.equal(await page.locator("#scans_body article").count(), 0, "it stands in two lists");
    await card.getByRole("button", { name: "Leave unassigned" }).click();
    await page.locator("#question").getByRole("button", { name: "Leave unassigned" }).click();
    await page.getByText("Nothing waits for a decision.").waitFor();
    await light(page, "ready");
    await page.locator("#scans_body article").getByRole("button", { name: "Assign" }).waitFor();
  });
});

test("the kiosk has a way back to the page", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.goto(`${station.origin}/kiosk`);
    await page.getByRole("link", { name: "Leave full screen" }).click();
    await page.waitForSelector("#undecided_title");
  });
});

test("a station that hangs is told within five seconds, and takes no decision until it answers", async () => {
  await at(await Station.make(), async (station) => {
    const { page } = await tab(browser, station);
    await page.clock.install();
    await page.goto(station.link());
    await light(page, "ready");
    const name = page.getByRole("button", { name: "Name the next patient" });
    assert.ok(await name.isEnabled());
    process.kill(station.child.pid, "SIGSTOP");
    try {
      // The page's own clock, however busy the machine is: from here on it shows five seconds more, and stops.
      await page.clock.pauseAt(await page.evaluate(() => Date.now() + 1000));
      await page.clock.runFor(4000);
      const signal = () => page.evaluate(() => document.getElementById("light").dataset.signal);
      await until("the grey light", async () => await signal() === "away");
      await page.clock.resume();
      assert.ok(await name.isDisabled());
      await shoot(page, "light-hangs");
      assert.deepEqual(await violations(page), []);
    } finally {
      process.kill(station.child.pid, "SIGCONT");
    }
    await light(page, "ready");
    assert.ok(await name.isEnabled());
  });
});
