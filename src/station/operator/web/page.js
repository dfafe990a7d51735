// Puts the station's snapshots into the page. Every text and figure comes ready from the station and
// goes in as text, never as markup; what is decided here is only when to ask and what to redraw. What a
// person decides stands in decide.js, which goes before this.

const root = document.documentElement;
const isKiosk = root.dataset.view === "kiosk";
const isLocal = root.dataset.way === "local";
const labels = JSON.parse(document.getElementById("labels").textContent);
const label = (key) => labels[key] ?? key;
const $ = (id) => document.getElementById(id);

// ---- elements

function make(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key === "class") element.className = value ?? "";
    else if (key === "on") element.addEventListener("click", value);
    else if (value !== undefined && value !== false) element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

// A sign for each state, so that no colour says anything alone.
const SIGNS = {
  ready: ["M50 8a42 42 0 1 0 .1 0z"],
  armed: ["M28 10h44M28 90h44M34 10c0 26 32 26 32 40s-32 14-32 40M66 10c0 26-32 26-32 40s32 14 32 40"],
  receiving: ["M50 8a42 42 0 1 1-36 20"],
  done: ["M14 54l26 26 46-58"],
  attention: ["M50 10L94 88H6z", "M50 38v24M50 75v.5"],
  no_export: ["M50 8a42 42 0 1 0 .1 0z", "M34 34l32 32M66 34L34 66"],
  paused: ["M34 16v68", "M66 16v68"],
  good: ["M14 54l26 26 46-58"],
  wait: ["M50 12a38 38 0 1 0 .1 0z", "M50 28v24l16 10"],
  bad: ["M50 10L94 88H6z", "M50 38v24M50 75v.5"],
  away: ["M10 40c24-22 56-22 80 0M28 60c14-12 30-12 44 0M50 80v.5", "M14 90L86 10"],
};

function sign(state) {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("viewBox", "0 0 100 100");
  svg.setAttribute("aria-hidden", "true");
  for (const line of SIGNS[state] ?? SIGNS.bad) {
    const path = document.createElementNS(space, "path");
    path.setAttribute("d", line);
    svg.append(path);
  }
  if (state === "receiving") svg.classList.add("turning");
  return svg;
}

// Redraws a part only when what it shows has changed, and keeps the focus on what had it.
const drawn = new Map();
function redraw(id, value, build) {
  const place = $(id);
  const text = JSON.stringify(value);
  if (!place || drawn.get(id) === text) return;
  drawn.set(id, text);
  const held = place.contains(document.activeElement) ? document.activeElement.dataset.key : undefined;
  place.replaceChildren(...[build(value)].flat().filter(Boolean));
  if (held) place.querySelector(`[data-key="${CSS.escape(held)}"]`)?.focus();
}

// ---- what is shown

function time(at, isLong = false) {
  const date = new Date(at);
  const now = new Date();
  const clock = { hour: "2-digit", minute: "2-digit", hourCycle: "h23" };
  const isToday = date.toDateString() === now.toDateString() && !isLong;
  const year = isLong || date.getFullYear() !== now.getFullYear() ? { year: "numeric" } : {};
  const form = isToday ? clock : { day: "numeric", month: "short", ...year, ...clock };
  return make("time", { datetime: at }, date.toLocaleString(root.lang, form));
}

const HEALTH = {
  delivered: "good", spooled: "wait", unassigned: "wait", left: "wait", withdrawing: "wait", closed: "wait", held: "bad", refused: "bad",
};

function state(word, health) {
  return make("span", { class: `state ${health}` }, sign(health), make("span", {}, word));
}

function cell(figures, name) {
  const kind = name === "girth_cm" ? "girth" : "height";
  const doubt = figures[`is_${kind}_doubted`] ? make("abbr", { title: label("doubted") }, "?") : null;
  const isByHand = figures[`is_${kind}_by_hand`];
  const hand = isByHand ? make("abbr", { title: label("by_hand") }, "*") : null;
  return make("td", { class: kind }, figures[name], doubt, hand);
}

function measures(of) {
  const sides = ["right", "left"];
  const head = make("tr", {}, make("td"), sides.map((side) => make("th", { scope: "colgroup", colspan: 2 }, label(side))));
  const units = make("tr", {}, make("th", { scope: "col" }, label("level")), sides.flatMap(() => [
    make("th", { scope: "col" }, `${label("girth")} (${label("cm")})`),
    make("th", { scope: "col" }, `${label("height")} (${label("cm")})`),
  ]));
  const rows = of.levels.map((level) => make("tr", {},
    make("th", { scope: "row" }, level.level),
    sides.flatMap((side) => (level[side]
      ? [cell(level[side], "girth_cm"), level.is_level ? cell(level[side], "height_cm") : make("td")]
      : make("td", { class: "absent", colspan: 2 }, level[`${side}_absent`])))));
  return make("table", {}, make("thead", {}, head, units), make("tbody", {}, rows));
}

// What of the measures can be read from afar.
const atAGlance = (of) => ({ ...of, levels: of.levels.filter(({ level }) => ["D", "C", "B1", "B"].includes(level)) });

function patients(ids) {
  return ids.map((id) => make("p", { class: "word" }, `${label("patient")} `, make("bdi", {}, id)));
}

function about(scan, canAct, ...more) {
  const offered = [...scan.candidates.map((of) => candidate(scan, of)), ...(scan.again ? [scanAgain(scan, scan.again)] : [])];
  const isMain = (key, at) => at === 0 && !["give_up", "unassign", "leave"].includes(key) && offered.length === 0;
  const acts = scan.acts.map((key, at) => act(key, scan, isMain(key, at)));
  const isToComplete = scan.task === "complete";
  const amending = canAmend(scan) ? [amendButton(scan, isToComplete)] : [];
  const buttons = canAct ? [...offered, ...(isToComplete ? [...amending, ...acts] : [...acts, ...amending])] : [];
  return [
    make("h3", {}, time(scan.at), " ", state(scan.word, HEALTH[scan.state])),
    ...patients(scan.patients),
    make("p", { class: "quiet" }, `${label("scan")} ${scan.scan.slice(0, 8)}`),
    scan.advice ? make("p", {}, `${scan.advice.what} ${scan.advice.next}`) : null,
    scan.code ? make("p", { class: "quiet" }, `${label("code")}: ${scan.code}`, scan.detail ? [" – ", make("span", { lang: "en" }, scan.detail)] : null) : null,
    scan.unmeasured ? make("p", { class: "quiet" }, scan.unmeasured) : null,
    ...more,
    buttons.length ? make("p", { class: "buttons" }, buttons) : null,
  ].filter(Boolean);
}

// The files of a record: those with words of their own, the others behind one more click.
const opened = new Set();
const address = (scan, file) => `/scan/${scan.scan}/${file}${scan.of ? `?of=${scan.of}` : ""}`;
const rowKey = (scan) => `${scan.scan}${scan.of}`;
function links(scan, showsIds, canAct) {
  if (!showsIds || !scan.files.length) return null;
  const anchor = (file) =>
    make("a", { href: address(scan, file), target: "_blank", rel: "noopener", "data-key": `${file} ${rowKey(scan)}` }, label(file));
  const anchors = scan.files.filter((file) => file in labels).map(anchor);
  if (scan.files.includes("record.json") && window.gaiterViewer) {
    anchors.unshift(button(label("view"), `view ${rowKey(scan)}`, () => view(scan)));
  }
  // The visits of a patient are compared when they are asked for; a preview is no visit.
  if (scan.owner) anchors.push(anchor("visits.html"), anchor("visits.pdf"), ...(canAct ? [affectedButton(scan)] : []));
  const others = scan.files.filter((file) => !(file in labels)).map(anchor);
  return make("div", { "aria-label": label("files"), role: "group" },
    make("p", { class: "links" }, anchors), others.length ? otherFiles(scan, others) : null);
}

// A redraw leaves it as open as it was.
function otherFiles(scan, anchors) {
  const key = rowKey(scan);
  const details = make("details", { open: opened.has(key) },
    make("summary", { "data-key": `files ${key}` }, label("all_files")), make("p", { class: "links" }, anchors));
  details.addEventListener("toggle", () => (details.open ? opened.add(key) : opened.delete(key)));
  return details;
}

// A scan below the first, in one line; a redraw leaves it as open as it was.
function folded(scan, card) {
  if (!scan.measures) return card;
  const key = rowKey(scan);
  const line = [time(scan.at), " ", state(scan.word, HEALTH[scan.state]), " ",
    ...scan.patients.map((id) => make("bdi", {}, id)), ...(isSettled(scan.measures) ? [] : verdict(scan.measures))];
  const details = make("details", { class: "folded", open: unfolded.has(key) }, make("summary", { "data-key": `card ${key}` }, line), card);
  details.addEventListener("toggle", () => (details.open ? unfolded.add(key) : unfolded.delete(key)));
  return details;
}

const unfolded = new Set();
function scanCard(scan, canAct, showsIds) {
  if (!scan.measures) return make("article", { class: "card scan plain" }, make("div", { class: "about" }, about(scan, canAct)));
  const drawing = showsIds && scan.files.includes("legs.svg")
    ? make("img", { class: "drawing", src: `${address(scan, "legs.svg")}#front`, alt: label("drawing"), loading: "lazy" })
    : null;
  const { notes } = scan.measures;
  const findings = [
    ...verdict(scan.measures),
    notes ? make("p", { class: "quiet" }, notes) : null,
  ];
  return make("article", { class: drawing ? "card scan" : "card scan without" },
    drawing ? make("div", {}, drawing) : null,
    make("div", { class: "about" }, about(scan, canAct, ...findings, links(scan, showsIds, canAct))),
    make("div", { class: "measures" }, measures(scan.measures)));
}

const isSettled = ({ verdict: kind }) => ["complete", "not-measurable"].includes(kind);

// What is to be done before the patient dresses.
function verdict(of) {
  return of.to_do.map((sentence) => make("p", { class: isSettled(of) ? "quiet" : "bad" }, sentence));
}

let viewed = null;
async function view(row) {
  const { scan, state, word, patients } = row;
  const dialog = $("viewer");
  const place = make("div");
  const whose = patients.length ? `${label("patient")} ${patients.join(", ")}` : word;
  const title = [label("view"), ...(state === "held" && patients.length ? [word] : []), whose, `${label("scan")} ${scan.slice(0, 8)}`];
  $("viewer_title").textContent = title.join(" – ");
  $("viewer_body").replaceChildren(place);
  dialog.showModal();
  try {
    const record = await (await fetch(address(row, "record.json"))).json();
    if (dialog.open) viewed = window.gaiterViewer.mount(place, record, { patient: patients.join(", ") });
  } catch {
    place.textContent = label("away");
  }
}

// Who is next; each id is set apart from the words around it.
function sentence(next) {
  return next.pieces.map((piece, at) => (at % 2 ? make("bdi", {}, piece) : piece));
}

function nextPatient(next, isPaused, canAct) {
  const parts = [make("p", { class: "who" }, sentence(next)), next.doubt ? make("p", { class: "bad" }, next.doubt) : null];
  if (!canAct) return parts;
  // An answer to the question who is in the booth needs no second question.
  const isAnswered = next.is_asked_later || (next.who.length < 2 && !next.is_asked);
  const answers = isAnswered ? [] : next.who.map(({ id, shown }) =>
    button(phrase(label("in_booth"), { patient: shown }), `in_booth ${id}`, () => decide({ ask: "name_next", patient: id, replace: true }), !isPaused));
  const off = () => question({
    title: label("call_off"), hint: label("call_off_hint"), yes: label("call_off"), send: () => ask({ ask: "call_off" }),
  });
  return [...parts, make("p", { class: "buttons" }, answers,
    button(label("name"), "name", () => nameNext(last.next), !isPaused && !answers.length),
    next.can_be_called_off ? button(label("call_off"), "call_off", off) : null,
    isPaused
      ? button(label("resume"), "pause", () => decide({ ask: "resume" }), true)
      : button(label("pause"), "pause", () => decide({ ask: "pause" })))];
}

function part(of) {
  return make("li", {}, make("p", {}, of.name), state(of.word, of.health),
    of.why ? make("p", { class: "why" }, of.why) : null);
}

function showLight(light) {
  if (drawn.get("light") === JSON.stringify(light)) return;
  drawn.set("light", JSON.stringify(light));
  $("light").dataset.signal = light.signal;
  $("word").textContent = light.word;
  $("sentence").replaceChildren(...sentence(light));
  $("sign").replaceChildren(sign(light.signal));
  if (isKiosk) fit();
}

// On a kiosk nothing can be scrolled: a long sentence is written smaller, down to a third.
const FIT_LEAST = 0.33;
const FIT_STEP = 0.04;
function fit() {
  for (const box of ["light", "last", "next"].map($)) {
    const { paddingTop, paddingBottom } = getComputedStyle(box);
    const room = () => box.clientHeight - parseFloat(paddingTop) - parseFloat(paddingBottom);
    const tall = () => Math.max(...[...box.children].map((part) => part.offsetHeight));
    const overflows = () => tall() > room() || box.scrollHeight > box.clientHeight || box.scrollWidth > box.clientWidth;
    for (let scale = 1; scale >= FIT_LEAST; scale -= FIT_STEP) {
      box.style.setProperty("--fit", scale);
      if (!overflows()) break;
    }
  }
}

// A station that does not answer is not ready, whatever it said last, and is sent no decision. One that was sent
// before may still be carried out.
function away() {
  showLight({ signal: "away", word: label("away_word"), pieces: [label("away")] });
  setAnswering(false);
  // Names of the worklist are gone with the station.
  if (!isKiosk) showWorklist(null, false);
}

let isAnswering = true;
function setAnswering(is) {
  if (isAnswering === is) return;
  isAnswering = is;
  root.toggleAttribute("data-away", !is);
  for (const button of document.querySelectorAll("main button")) button.disabled = !is;
}

let last = null;
function show(station) {
  last = station;
  setAnswering(true);
  const canAct = isLocal && token !== null;
  $("station").textContent = station.station;
  document.title = `${station.light.word} – ${station.station}`;
  const { light, ids } = station;
  showLight(light);
  const whole = { next: station.next, paused: station.paused, canAct };
  redraw("next_body", whole, () => nextPatient(station.next, station.paused, canAct && !isKiosk));
  if (isKiosk) {
    const [newest] = [...station.undecided, ...station.scans].sort((a, b) => Date.parse(b.at) - Date.parse(a.at));
    // As long as the light says what to do, it is not said twice.
    const isSaid = newest?.measures?.to_do.every((sentence) => light.sentence.includes(sentence));
    redraw("last_body", newest ? { ...newest, isSaid } : null, (scan) => scan
      ? [
          make("p", { class: "when" }, time(scan.at), " ", state(scan.word, HEALTH[scan.state])),
          ...(scan.measures ? [...(isSaid || isSettled(scan.measures) ? [] : verdict(scan.measures)), measures(atAGlance(scan.measures))] : []),
        ]
      : make("p", { class: "quiet" }, label("no_scans")));
    fit();
    return;
  }
  const reading = $("reading");
  reading.hidden = canAct;
  reading.textContent = label(isLocal ? "read_only_token" : "read_only_network");
  redraw("undecided_body", { scans: station.undecided, more: station.more_undecided, canAct, ids }, ({ scans, more }) => [
    ...scans.map((scan) => scan.measures
      ? scanCard(scan, canAct, ids)
      : make("article", { class: "card" }, about(scan, canAct))),
    scans.length ? null : make("p", { class: "empty" }, label("none_undecided")),
    more ? make("p", { class: "more" }, `${more} ${label("more")}`) : null,
  ]);
  redraw("scans_body", { scans: station.scans, canAct, ids }, ({ scans }) => scans.length
    ? scans.map((scan, at) => (at ? folded(scan, scanCard(scan, canAct, ids)) : scanCard(scan, canAct, ids)))
    : make("p", { class: "empty" }, label("no_scans")));
  showWorklist(station.worklist, canAct);
  showDecided(station);
  redraw("complaints", station.complaints, (complaints) => complaints.map((complaint) =>
    make("li", { class: complaint.severity }, make("strong", { class: complaint.severity === "fault" ? "bad" : "wait" }, complaint.what), ` ${complaint.next} `,
      make("span", { class: "quiet" }, `${label("code")}: ${complaint.code}`))));
  redraw("parts", station.parts, (parts) => parts.map(part));
}

// The search follows decisions: what it lists may have changed.
let decided = "";
function showDecided({ undecided, scans, ids }) {
  $("search").hidden = !ids;
  const states = JSON.stringify([...undecided, ...scans].map(({ scan, of, state }) => [scan, of, state]));
  if (decided && states !== decided) searchAgain();
  decided = states;
}

// A page of another version loads itself anew, once for each version.
function take(text) {
  heard = Date.now();
  const station = JSON.parse(text);
  if (station.page !== root.dataset.page) {
    let before = null;
    try {
      before = sessionStorage.getItem("gaiter-version");
      sessionStorage.setItem("gaiter-version", station.page);
    } catch {
      before = station.page;
    }
    if (before !== station.page) {
      location.reload();
      return;
    }
  }
  show(station);
}

// ---- the stream, and what to do without one

const query = isKiosk ? "?kiosk" : "";
// A station that hangs is told within five seconds: two beats, a look at the clock, and no answer.
const SILENT_MS = 2000;
const LOOK_MS = 1000;
const ANSWER_MS = 1500;
const ANEW_MS = 30000;
let source = null;
let heard = 0;
let connected = 0;
let looking = false;

function connect() {
  source?.close();
  connected = Date.now();
  source = new EventSource(`/stream${query}`);
  source.onmessage = (event) => take(event.data);
  source.addEventListener("beat", () => {
    heard = Date.now();
    // It hung, and goes on: nothing need have changed meanwhile.
    if (!isAnswering && last) show(last);
  });
  source.onerror = () => {
    if (source.readyState === EventSource.CLOSED) look();
    else away();
  };
}

async function look() {
  if (looking) return;
  looking = true;
  try {
    const answer = await fetchWithin(ANSWER_MS, `/state${query}`);
    if (!answer.ok) throw new Error(answer.statusText);
    take(await answer.text());
  } catch {
    away();
  }
  looking = false;
}

// Too many streams, or one that has fallen silent: the page asks by itself, and tries a stream again.
setInterval(() => {
  if (Date.now() - heard < SILENT_MS) return;
  // One that is being connected again has told that it was gone.
  if (source?.readyState !== EventSource.CONNECTING) look();
  if (Date.now() - connected >= ANEW_MS) connect();
}, LOOK_MS);

async function begin() {
  takeToken();
  await enter();
  connect();
}

if (isKiosk) window.addEventListener("resize", fit);
window.addEventListener("hashchange", () => { if (takeToken()) begin(); });
if (!isKiosk) {
  beginSearch();
  $("amend_no").addEventListener("click", () => $("amend").close());
  $("question_no").addEventListener("click", () => $("question").close());
  $("viewer_no").addEventListener("click", () => $("viewer").close());
  $("viewer").addEventListener("close", () => {
    viewed?.destroy();
    viewed = null;
    $("viewer_body").replaceChildren();
  });
}
begin();
