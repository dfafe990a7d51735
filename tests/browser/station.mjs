// A real station in a folder of its own, and a real browser before it. Whatever is awaited is awaited
// as a condition, never as a time.

import { execFileSync, spawn } from "node:child_process";
import { appendFileSync, mkdirSync, mkdtempSync, openSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { gunzipSync } from "node:zlib";
import { chromium } from "playwright-core";

const root = resolve(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../..");

/** The program under test. */
export const gaiter = resolve(root, process.env.GAITER_BIN ?? "target/debug/gaiter");

/** How long a condition is awaited before a test fails: machines that test are busy. */
export const PATIENCE_MS = 120_000;

const FLAGS = [
  "--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
];

/** A scan that has every measure of a calf stocking; each `n` gives another scan of the same body. */
export function body(n, name = "f_average_clean") {
  const file = join(root, `fixtures/scans/${name}.obj.gz`);
  const text = gunzipSync(readFileSync(file)).toString("latin1");
  return Buffer.from(text.replace(/\nv (\S+)/, (_, x) => `\nv ${x}${String(n).padStart(9, "0")}`), "latin1");
}

/** An export without the faces that have a chosen corner, and without their points: a side that no camera saw. */
export function unseen(bytes, isUnseen) {
  const lines = bytes.toString("latin1").split("\n");
  const points = lines.filter((line) => line.startsWith("v "));
  const is = points.map((line) => isUnseen(line.split(" ").slice(1).map(Number)));
  const corners = (line) => line.trim().split(" ").slice(1).map((corner) => parseInt(corner, 10) - 1);
  const faces = lines.filter((line) => line.startsWith("f ")).map(corners).filter((face) => !face.some((at) => is[at]));
  const used = [...new Set(faces.flat())];
  const numbers = new Map(used.map((at, index) => [at, index + 1]));
  const kept = [...used.map((at) => points[at]), ...faces.map((face) => `f ${face.map((at) => numbers.get(at)).join(" ")}`)];
  return Buffer.from(kept.join("\n") + "\n", "latin1");
}

/** Awaits a condition. */
export async function until(what, holds) {
  const end = Date.now() + PATIENCE_MS;
  for (;;) {
    const found = await holds();
    if (found) return found;
    if (Date.now() > end) throw new Error(`${what} did not come`);
    await new Promise((later) => setTimeout(later, 50));
  }
}

/** A port that is free now. */
function freePort() {
  return new Promise((found) => {
    const server = createServer();
    server.listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => found(port));
    });
  });
}

export class Station {
  /** A station that is not started; `more` is added to its configuration. */
  static async make({ pattern = "^P?[0-9]{1,12}$", fileName = "^(?<patient>P?[0-9]+)_", more = "", quiet = "300ms", patient = "" } = {}) {
    const station = new Station();
    station.dir = mkdtempSync(join(tmpdir(), "gaiter-browser-"));
    station.port = await freePort();
    for (const folder of ["export", "records"]) mkdirSync(join(station.dir, folder));
    writeFileSync(join(station.dir, "station.toml"), `[station]
id = "booth-1"
state_dir = "${station.dir}/state"
[scanner]
export_dirs = ["${station.dir}/export"]
quiet = "${quiet}"
rescan = "500ms"
file_name = '${fileName}'
[patient]
pattern = '${pattern}'
${patient}
[output]
files = []
[store.folder]
path = "${station.dir}/records"
[status]
listen = "127.0.0.1:${station.port}"
${more}`);
    return station;
  }

  get origin() {
    return `http://127.0.0.1:${this.port}`;
  }

  /** Starts it, and awaits its door. */
  async start() {
    const log = openSync(join(this.dir, "log"), "a");
    const config = join(this.dir, "station.toml");
    this.child = spawn(gaiter, ["run", "--config", config], { stdio: ["ignore", log, log] });
    await until("the station", async () => {
      try {
        return (await fetch(`${this.origin}/healthz`)).ok;
      } catch {
        return false;
      }
    });
    return this;
  }

  /** Stops it, and awaits its end. */
  async stop() {
    const { child } = this;
    if (child.exitCode !== null) return;
    const ended = new Promise((end) => child.once("exit", end));
    child.kill("SIGTERM");
    await ended;
  }

  /** Stops it and removes its folder. */
  async end() {
    await this.stop();
    rmSync(this.dir, { recursive: true, force: true });
  }

  configure(more) {
    appendFileSync(join(this.dir, "station.toml"), more);
  }

  export(name, bytes) {
    writeFileSync(join(this.dir, "export", name), bytes);
  }

  verb(...words) {
    return execFileSync(gaiter, [...words, "--config", join(this.dir, "station.toml")], { encoding: "utf8" });
  }

  /**
   * Awaits that the export folder has been looked through since now: a file that is first seen before
   * could have lain there already, and is held.
   */
  async looked() {
    const last = () => Date.parse(JSON.parse(this.verb("status", "--json")).sources[0].last_look);
    const asked = Date.now();
    await until("a look at the export folder", () => last() > asked);
    // It may have begun before.
    const first = last();
    await until("a look that began since", () => last() > first);
  }

  /** The link with which one can decide. */
  link() {
    return this.verb("page").trim();
  }

  /** What the station says of itself to everybody. */
  async state() {
    let answer;
    // On a busy machine it may not be made in time.
    await until("an answer", async () => {
      answer = await fetch(`${this.origin}/state`);
      return answer.status !== 503;
    });
    return answer.json();
  }
}

/** A browser whose every request is noted, and none but the station's is let through. */
export async function browse() {
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
  return browser;
}

/** A tab that notes what leaves for elsewhere, what fails, and how many bytes came. */
export async function tab(browser, station, options = {}) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  const noted = { elsewhere: [], faults: [], bytes: 0 };
  const devtools = await context.newCDPSession(page);
  await devtools.send("Network.enable");
  const isHere = (url) => url.startsWith(`${station.origin}/`) || /^(data|blob|about):/.test(url);
  devtools.on("Network.requestWillBeSent", ({ request }) => {
    if (!isHere(request.url)) noted.elsewhere.push(request.url);
  });
  devtools.on("Network.loadingFinished", ({ encodedDataLength }) => { noted.bytes += encodedDataLength; });
  await context.route("**", (route) => (isHere(route.request().url()) ? route.continue() : route.abort()));
  page.on("pageerror", (error) => noted.faults.push(String(error)));
  page.on("console", (message) => {
    // Requests to a station that is away fail, and the browser says so by itself.
    if (message.type() === "error" && !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY/.test(message.text())) {
      noted.faults.push(message.text());
    }
  });
  return { page, context, noted };
}

/** Runs a test before a station that is ended whatever comes of it. */
export async function at(station, run) {
  try {
    await station.start();
    await run(station);
  } finally {
    await station.end();
  }
}

/** Awaits the light. */
export function light(page, signal) {
  return page.waitForSelector(`#light[data-signal="${signal}"]`, { timeout: PATIENCE_MS });
}

// Screenshots for people to look at go here, if anywhere.
const shots = process.env.GAITER_SHOTS;
export const shoot = (page, name) => (shots ? page.screenshot({ path: join(shots, `${name}.png`), fullPage: true }) : null);

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** What axe-core finds wrong. It is put in by the browser's own tools, which no policy hinders. */
export async function violations(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run(document));
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => `${node.html} ${node.failureSummary}`).join("; ")}`);
}
