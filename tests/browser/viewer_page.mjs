// A page under a strict content security policy, with the 3D view in it, in headless Chromium.
import { readFile, readdir } from "node:fs/promises";
import { createServer } from "node:http";
import { fileURLToPath } from "node:url";
import { inflateSync } from "node:zlib";

import { chromium } from "playwright-core";

import { PATIENCE_MS } from "./station.mjs";

const VIEWER = new URL("../../crates/record/src/report/viewer/", import.meta.url);

/** The parts of the script in the order of their names behind the English words, as the program has them. */
export async function script() {
  const names = (await readdir(VIEWER)).sort();
  const parts = await Promise.all(names.map((name) => readFile(new URL(name, VIEWER), "utf8")));
  return `globalThis.gaiterViewerWords = ${JSON.stringify(await words("en"))};\n${parts.join("")}`;
}

/** The words of the view in a language, from its table of the language's file, with what the program adds. */
export async function words(language) {
  const file = await readFile(new URL(`../../crates/language/src/${language}.toml`, import.meta.url), "utf8");
  const table = file.split("\n[viewer]\n")[1].split("\n[")[0];
  const pairs = [...table.matchAll(/^(\w+) = "(.*)"$/gm)].map(([, key, text]) => [key, text]);
  return { ...Object.fromEntries(pairs), point: language === "de" ? "," : ".", tag: language };
}

/** What the report and the operator's page allow, and nothing else. */
const POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; base-uri 'none'; form-action 'none'";

const PAGE = `<!doctype html><html lang="en"><meta charset="utf-8"><title>View</title>
<script src="/watch.js"></script><script src="/viewer.js"></script><main><h1>View</h1><div id="place"></div></main></html>`;

/** Counts frames and violations of the policy. */
const WATCH = `window.frames_asked = 0; window.violations = [];
const ask = window.requestAnimationFrame;
window.ask_frame = ask.bind(window);
window.requestAnimationFrame = (act) => { window.frames_asked += 1; return ask.call(window, act); };
document.addEventListener("securitypolicyviolation", (event) => window.violations.push(event.violatedDirective + " " + event.blockedURI));`;

/** WebGL in software, and no traffic of the browser's own. */
const FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

/** The server and the browser; `open` gives a fresh page, `close` ends both. */
export async function start() {
  const files = { "/favicon.ico": ["image/x-icon", ""], "/": ["text/html", PAGE], "/watch.js": ["text/javascript", WATCH], "/viewer.js": ["text/javascript", await script()] };
  const server = createServer((request, response) => {
    const [kind, body] = files[request.url] ?? ["text/plain", ""];
    response.writeHead(request.url in files ? 200 : 404, { "content-type": kind, "content-security-policy": POLICY });
    response.end(body);
  });
  await new Promise((ready) => { server.listen(0, "127.0.0.1", ready); });
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
  return {
    open: (options = {}) => openPage(browser, `http://127.0.0.1:${server.address().port}/`, options),
    close: async () => { await browser.close(); server.close(); },
  };
}

async function openPage(browser, address, options) {
  const context = await browser.newContext({ viewport: { width: 900, height: 800 }, colorScheme: "light", ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") faults.push(message.text()); });
  await page.goto(address);
  return { page, faults, violations: () => page.evaluate(() => window.violations), close: () => context.close() };
}

/** Mounts the view of a record. */
export async function mount(page, record, options = {}) {
  const { language = "en", ...others } = options;
  await page.evaluate(([given, how, said]) => {
    globalThis.gaiterViewerWords = said;
    window.view = globalThis.gaiterViewer.mount(document.getElementById("place"), given, how);
  }, [record, others, await words(language)]);
  await settled(page);
}

/** Waits until what was asked to be drawn has been drawn. */
export async function settled(page) {
  await page.evaluate(() => new Promise((done) => {
    requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 0)));
  }));
}

/** Moves one finger from a place up or down the page. */
export async function swipe(page, [x, y], byPx) {
  const session = await page.context().newCDPSession(page);
  const touch = (type, touchPoints) => session.send("Input.dispatchTouchEvent", { type, touchPoints });
  await touch("touchStart", [{ x, y }]);
  for (let step = 1; step <= 20; step += 1) await touch("touchMove", [{ x, y: y + byPx * step / 20 }]);
  await touch("touchEnd", []);
}

/** Waits until the page has been scrolled this far; a strict page allows no predicate as text. */
export async function scrolled(page, leastPx) {
  for (let tries = 0; tries < 2400; tries += 1) {
    if (await page.evaluate(() => window.scrollY) >= leastPx) return settled(page);
    await page.waitForTimeout(50);
  }
  throw new Error(`the page is not scrolled by ${leastPx} px`);
}

/** The layers' names. */
export const LAYERS = ["Tape", "Other leg, mirrored", "Scan points", "Skin", "Surface", "Error of the surface", "Sections", "Levels with girth", "Feature points"];

/** Presses a button by its name. */
export async function press(page, name, times = 1) {
  for (let at = 0; at < times; at += 1) await page.getByRole("button", { name, exact: true }).click();
  await settled(page);
}

/** Shows these layers and no others. */
export async function showOnly(page, names) {
  await page.locator(".gaiter-viewer details").evaluate((details) => { details.open = true; });
  for (const name of LAYERS) {
    const box = page.getByLabel(name, { exact: true });
    if (await box.isEnabled()) await box.setChecked(names.includes(name));
  }
  await settled(page);
}

/** The canvas with its labels, or without them, as it is on the screen. */
export async function picture(page, labels = true) {
  await page.evaluate((shown) => {
    document.querySelector("canvas").nextElementSibling.style.visibility = shown ? "" : "hidden";
  }, labels);
  return decodePng(await page.locator(".gaiter-stage").screenshot());
}

/** PNG of 8 bits a channel → width, height and a function from x, y to [red, green, blue]. */
export function decodePng(png) {
  const parts = [];
  let [width, height, channels] = [0, 0, 0];
  for (let at = 8; at < png.length;) {
    const [length, kind] = [png.readUInt32BE(at), png.toString("latin1", at + 4, at + 8)];
    const body = png.subarray(at + 8, at + 8 + length);
    if (kind === "IHDR") [width, height, channels] = [body.readUInt32BE(0), body.readUInt32BE(4), body[9] === 6 ? 4 : 3];
    if (kind === "IDAT") parts.push(body);
    at += length + 12;
  }
  const [raw, stride] = [inflateSync(Buffer.concat(parts)), width * channels];
  const pixels = Buffer.alloc(height * stride);
  for (let y = 0; y < height; y += 1) {
    const filter = raw[y * (stride + 1)];
    for (let x = 0; x < stride; x += 1) {
      const left = x < channels ? 0 : pixels[y * stride + x - channels];
      const up = y === 0 ? 0 : pixels[(y - 1) * stride + x];
      const corner = x < channels || y === 0 ? 0 : pixels[(y - 1) * stride + x - channels];
      pixels[y * stride + x] = raw[y * (stride + 1) + 1 + x] + [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
    }
  }
  const pixel = (x, y) => [...pixels.subarray((y * width + x) * channels, (y * width + x) * channels + 3)];
  return { width, height, pixels, pixel };
}

function paeth(left, up, corner) {
  const [a, b, c] = [left, up, corner].map((value) => Math.abs(left + up - corner - value));
  if (a <= b && a <= c) return left;
  return b <= c ? up : corner;
}
