// Who is expected today, for who decides here. The names are in no snapshot: they are asked for with the token when
// the snapshot tells that there are others. Goes between search.js and page.js.

// How soon entries are asked for again that did not come.
const RELIST_MS = 5000;
let listed = null;
let listing = 0;

async function showWorklist(edition, canAct) {
  const section = $("worklist");
  section.hidden = edition === null || edition === undefined || !canAct;
  if (section.hidden) {
    listed = null;
    listing += 1;
    redraw("worklist_body", "", () => []);
    return;
  }
  if (listed === edition) return;
  // A page that was just opened wants what the server has now.
  const anew = listed === null;
  listed = edition;
  const mine = listing += 1;
  try {
    const answer = await post("/worklist", { anew });
    if (answer.status === 401) forget((await answer.json()).sentence);
    if (!answer.ok) throw new Error(answer.statusText);
    const { entries } = await answer.json();
    if (mine === listing) redraw("worklist_body", entries, expected);
  } catch {
    if (mine !== listing) return;
    // The next snapshot may be long in coming.
    listed = "";
    setTimeout(() => { if (mine === listing) showWorklist(edition, canAct); }, RELIST_MS);
  }
}

function expected(entries) {
  if (!entries?.length) return make("p", { class: "empty" }, label(entries ? "worklist_empty" : "worklist_unknown"));
  return make("ul", { class: "worklist" }, entries.map((entry) => make("li", {},
    chooser(entry),
    make("span", {}, entry.time ?? ""),
    make("bdi", {}, entry.name),
    make("span", {}, entry.born ? birthday(entry.born) : ""),
    make("bdi", { class: "quiet" }, entry.patient),
    make("span", { class: "quiet" }, [entry.procedure, entry.accession_number].filter(Boolean).join(", ")))));
}

// The button of an entry. Whoever hears the page alone learns from its name whom it chooses.
function chooser(entry) {
  const chosen = [entry.name, entry.patient, entry.accession_number].filter(Boolean).join(", ");
  const made = button(label("worklist_choose"), `choose ${entry.key}`, () => choose(entry));
  made.setAttribute("aria-label", label("worklist_choose_of").replace("{patient}", () => chosen));
  return made;
}

// A birth date is of no time zone. Its month is a word: 03/11 is November to some and March to others.
function birthday(born) {
  const date = new Date(`${born}T00:00:00Z`);
  return date.toLocaleDateString(root.lang, { day: "numeric", month: "short", year: "numeric", timeZone: "UTC" });
}

// Names the patient of an entry; one who is named and was not scanned is replaced after a question.
async function choose(entry) {
  const decision = { ask: "name_listed", entry: entry.key };
  const { isDone, code, sentence } = await ask({ ...decision, replace: false });
  if (code === "another-is-named") replace(last.next, entry.patient, decision);
  else if (token) say(sentence, !isDone);
}
