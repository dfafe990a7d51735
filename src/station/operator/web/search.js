// All scans: a search by patient, scan, date and state, in parts of fifty. Goes between decide.js and
// page.js. What a scan's record tells is asked for when its row is opened.

let found = [];
let nextPart = null;
let searching = 0;

// The days of the form are days of this browser's place.
function midnight(day, later = 0) {
  if (!day) return null;
  const [year, month, date] = day.split("-").map(Number);
  return new Date(year, month - 1, date + later).toISOString();
}

function searched(offset) {
  const field = (name) => $(`search_${name}`);
  const query = new URLSearchParams({ text: field("text").value.trim(), offset });
  const [from, until] = [midnight(field("from").value), midnight(field("until").value, 1)];
  if (from) query.set("from", from);
  if (until) query.set("until", until);
  if (field("state").value) query.set("state", field("state").value);
  if (field("incomplete").checked) query.set("incomplete", "true");
  return query;
}

async function search(offset = 0) {
  const mine = searching += 1;
  const status = $("search_status");
  let answer = null;
  try {
    const said = await fetch(`/scans?${searched(offset)}`);
    answer = said.ok ? await said.json() : null;
  } catch {
    // Told below.
  }
  if (mine !== searching) return;
  if (!answer) {
    status.textContent = label("away");
    return;
  }
  found = offset ? [...found, ...answer.scans] : answer.scans;
  nextPart = answer.next;
  status.textContent = found.length ? "" : label("none_found");
  $("search_more").hidden = nextPart === null;
  $("search_body").replaceChildren(...found.map(foundRow));
}

// A row in short; its card comes when it is opened.
function foundRow(scan) {
  const whose = scan.patients.length ? [`${label("patient")} `, make("bdi", {}, scan.patients.join(", "))] : [];
  const short = make("summary", {}, time(scan.at, true), " ", state(scan.word, HEALTH[scan.state]), " ",
    make("span", {}, whose), " ", scan.incomplete ? make("span", { class: "bad" }, label("incomplete")) : "",
    make("span", { class: "quiet" }, ` ${label("scan")} ${scan.scan.slice(0, 8)}`));
  const place = make("div");
  const details = make("details", { class: "found" }, short, place);
  details.addEventListener("toggle", () => { if (details.open) openRow(scan, place); });
  return details;
}

async function openRow(scan, place) {
  try {
    const answer = await fetch(`/scan/${scan.scan}`);
    const rows = await answer.json();
    const row = rows.find((row) => row.of === scan.of);
    place.replaceChildren(row ? scanCard(row, isLocal && token !== null, true) : label("none_found"));
  } catch {
    place.replaceChildren(label("away"));
  }
}

// A decision changes rows that are shown.
function searchAgain() {
  if ($("search")?.open) search();
}

function beginSearch() {
  const [whole, form] = [$("search"), $("search_form")];
  if (!whole) return;
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    search();
  });
  $("search_more").addEventListener("click", () => search(nextPart));
  whole.addEventListener("toggle", () => { if (whole.open) search(); });
}
