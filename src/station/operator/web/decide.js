"use strict";
// What a person decides on the page: each decision is asked for with whose it is about and what comes of
// it, and then sent to the station. Goes before page.js, whose elements and labels it uses.

// What this browser keeps. Where its storage is switched off, nothing lasts longer than the page.
function kept(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

function keep(key, value) {
  try {
    if (value === null) localStorage.removeItem(key);
    else localStorage.setItem(key, value);
  } catch {
    // As above.
  }
}

const TOKEN_KEY = "gaiter-token";
let token = kept(TOKEN_KEY);

// The token leaves the address bar before anybody can read it there.
function takeToken() {
  const found = /^#token=([0-9a-f]{64})$/.exec(location.hash);
  if (!found) return false;
  history.replaceState(null, "", location.pathname);
  if (!isLocal) return false;
  token = found[1];
  keep(TOKEN_KEY, token);
  return true;
}

// A decision waits for the journal, and no longer than a person does.
const DECIDE_MS = 15000;

function post(path, body) {
  const headers = { "Authorization": `Bearer ${token}`, "Content-Type": "application/json" };
  return fetchWithin(DECIDE_MS, path, { method: "POST", headers, body: JSON.stringify(body), credentials: "same-origin" });
}

// An answer, its text included, or a failure once this time is over.
async function fetchWithin(ms, path, options = {}) {
  const given = new AbortController();
  const timer = setTimeout(() => given.abort(), ms);
  try {
    const answer = await fetch(path, { ...options, signal: given.signal });
    return new Response(await answer.text(), { status: answer.status, statusText: answer.statusText });
  } finally {
    clearTimeout(timer);
  }
}

// The cookie that lets the browser open reports by itself.
async function enter() {
  if (!token || !isLocal) return;
  try {
    const answer = await post("/enter", {});
    if (answer.status === 401) forget((await answer.json()).sentence);
  } catch {
    // The station is away; the stream says so.
  }
}

function forget(sentence) {
  token = null;
  keep(TOKEN_KEY, token);
  $("question")?.close();
  say(sentence, true);
  drawn.clear();
  if (last) show(last);
}

let saying = 0;
function say(sentence, isBad) {
  const said = $("said");
  if (!said) return;
  said.textContent = sentence;
  said.toggleAttribute("data-bad", isBad);
  clearTimeout(saying);
  if (!isBad) saying = setTimeout(() => { said.textContent = ""; }, 15000);
}

// What the station answers to a decision. A refused one has a code.
async function ask(body) {
  if (!isAnswering) return { isDone: false, code: null, sentence: label("away") };
  try {
    const answer = await post("/ask", body);
    const { code, sentence } = await answer.json();
    if (answer.status === 401) forget(sentence);
    return { isDone: answer.ok, code, sentence };
  } catch {
    return { isDone: false, code: null, sentence: label("away") };
  }
}

async function decide(body) {
  const { isDone, sentence } = await ask(body);
  if (token) say(sentence, !isDone);
}

// Asks before it decides: for a patient's id, or whether it is meant. An id that is refused stays, to be
// corrected. `send` may ask on.
let asked = 0;
function question({ title, hint, wantsId = false, yes, send }) {
  const [dialog, field, fault] = [$("question"), $("question_id"), $("question_fault")];
  const mine = asked += 1;
  $("question_title").replaceChildren(...[title].flat());
  $("question_hint").replaceChildren(...[hint].flat());
  $("question_yes").textContent = yes;
  $("question_yes").disabled = false;
  $("question_field").hidden = !wantsId;
  fault.textContent = "";
  field.required = wantsId;
  field.value = "";
  field.removeAttribute("aria-invalid");
  dialog.querySelector("form").onsubmit = async (event) => {
    event.preventDefault();
    const id = field.value.trim();
    if (wantsId && !id) return;
    $("question_yes").disabled = true;
    const said = await send(id);
    if (mine !== asked) return;
    $("question_yes").disabled = false;
    if (wantsId && !said.isDone && dialog.open) {
      fault.textContent = said.sentence;
      field.setAttribute("aria-invalid", "true");
      field.focus();
      return;
    }
    dialog.close();
    if (token) say(said.sentence, !said.isDone);
  };
  if (!dialog.open) dialog.showModal();
  // Pressing Enter twice, or scanning a barcode, must not answer the question.
  (wantsId ? field : $("question_no")).focus();
}

function button(text, key, on, isMain) {
  return make("button", { type: "button", "data-key": key, class: isMain ? "main" : undefined, on }, text);
}

// Words with ids in the places of their braces; each id is set apart from the words around it.
function phrase(words, ids) {
  return words.split(/\{(\w+)\}/).map((part, at) => (at % 2 ? make("bdi", {}, ids[part] ?? "") : part));
}

const verb = (key) => label(key).replace(/ …$/, "");

// A decision on a scan, which is asked for with whose it is and what comes of it.
function act(key, scan, isMain) {
  const verbs = { leave: "give_up" };
  const send = (patient) => ask({ ask: verbs[key] ?? key, scan: scan.scan, patient: patient || undefined });
  // Of several patients who have the scan, this row's is meant.
  const takeBack = () => send(scan.owner?.id);
  const [patient] = scan.patients.length === 1 ? scan.patients : [];
  const named = (words, plain) => (patient === undefined ? label(plain) : phrase(label(words), { patient }));
  const titled = (words) => (patient === undefined ? verb(key) : phrase(label(words), { patient }));
  const asks = {
    retry: () => decide({ ask: key, scan: scan.scan }),
    assign: () => question({ title: verb(key), hint: label("assign_hint"), wantsId: true, yes: verb(key), send }),
    release: () => question({
      title: titled("release_to"),
      hint: named("release_to_hint", "release_hint"), yes: verb(key), send,
    }),
    unassign: () => question({
      title: titled("unassign_from"),
      hint: named("unassign_from_hint", "unassign_hint"), yes: verb(key), send: takeBack,
    }),
    give_up: () => question({ title: titled("give_up_of"), hint: label("give_up_hint"), yes: verb(key), send }),
    leave: () => question({ title: verb(key), hint: label("leave_hint"), yes: verb(key), send }),
  };
  return button(label(key), `${key} ${rowKey(scan)}`, asks[key], isMain);
}

// A button for each of those whose scan it may be.
function candidate(scan, { id, shown }) {
  const send = () => ask({ ask: "assign", scan: scan.scan, patient: id });
  const on = () => question({
    title: phrase(label("give"), { patient: shown }), hint: phrase(label("give_hint"), { patient: shown }), yes: verb("assign"), send,
  });
  return button(phrase(label("give"), { patient: shown }), `give ${id} ${scan.scan}`, on, true);
}

// The legs of a patient that can be named as affected, with their labels.
const AFFECTED = [
  ["left", "affected_left"], ["right", "affected_right"], ["both", "affected_both"], ["none", "affected_none"],
  ["not-named", "affected_not_named"],
];

// Names the affected leg of a scan's patient: the comparison of visits follows it.
function affectedButton(scan) {
  const on = () => {
    const select = make("select", { "aria-label": verb("affected"), required: true },
      make("option", { value: "" }, "–"), AFFECTED.map(([value, key]) => make("option", { value }, label(key))));
    const send = () => ask({ ask: "name_affected", patient: scan.owner.id, affected: select.value });
    question({
      title: phrase(label("affected_of"), { patient: scan.owner.shown }), hint: [label("affected_hint"), " ", select],
      yes: label("amend_yes"), send,
    });
  };
  return button(label("affected"), `affected ${rowKey(scan)}`, on);
}

// Names the next patient; one who is named and was not scanned is replaced after a question.
async function nameAs(patient) {
  const said = await ask({ ask: "name_next", patient, replace: false });
  if (said.code === "another-is-named") replace(last.next, patient);
  return said;
}

function nameNext(next) {
  const hint = [`${label("name_hint")} `, sentence(next)].flat();
  question({ title: verb("name"), hint, wantsId: true, yes: label("name_yes"), send: nameAs });
}

// The patient of a refused scan is named to be scanned again.
function scanAgain(scan, { id, shown }) {
  const on = () => question({
    title: phrase(label("scan_again_of"), { patient: shown }), hint: phrase(label("scan_again_hint"), { patient: shown }),
    yes: verb("scan_again"), send: () => nameAs(id),
  });
  return button(label("scan_again"), `scan_again ${scan.scan}`, on, true);
}

function replace(next, patient, decision = { ask: "name_next", patient }) {
  const named = next.who.map(({ shown }) => shown).join(", ") || label("another");
  question({
    title: label("replace"), hint: phrase(label("replace_hint"), { named, patient }), yes: label("replace"),
    send: () => ask({ ...decision, replace: true }),
  });
}

