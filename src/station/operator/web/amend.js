"use strict";
// Measures that a person sets by hand: the whole measuring sheet as a form. Goes between decide.js and
// page.js, whose elements and labels it uses.

const NAME_KEY = "gaiter-name";
const AMEND_SIDES = ["right", "left"];

// Whether a scan has a record of its own, not only the preview of a held one.
function canAmend({ state, files }) {
  return ["delivered", "spooled", "unassigned", "left"].includes(state) && files.includes("record.json");
}

function amendButton(scan, isMain) {
  return button(label("amend"), `amend ${rowKey(scan)}`, () => amend(scan), isMain);
}

const caption = (value) => label({ height: "height", length: "amend_length", girth: "girth" }[value]);

// One box of the form. What counts now stands in it in grey.
function box(line, side, value) {
  const of = caption(value);
  const now = line[side][value === "height" ? "height" : "value"];
  const isAsked = line[side].asked.includes(value);
  return make("input", {
    type: "text", inputmode: "decimal", autocomplete: "off", placeholder: now, "data-value": value, size: 6,
    "aria-label": `${label(side)} ${line.name}: ${of} (${label("cm")})${isAsked ? `, ${label("amend_asked")}` : ""}`,
    class: isAsked ? "asked" : undefined,
  });
}

// The boxes of one leg, and what else a person may say of the measure.
function boxes(line, side) {
  const choices = [["measured", "amend_as_is"], ["not-measurable", "amend_not"]];
  if (line[side].is_by_hand) choices.push(["taken-back", "amend_back"]);
  const select = make("select", { "aria-label": `${label(side)} ${line.name}` },
    choices.map(([value, key]) => make("option", { value }, label(key))));
  const values = line.kind === "level" ? ["girth", "height"] : [line.kind === "length" ? "length" : "girth"];
  const inputs = values.map((value) => box(line, side, value));
  select.addEventListener("change", () => {
    for (const input of inputs) input.disabled = select.value !== "measured";
  });
  const mark = line[side].is_by_hand ? make("abbr", { title: label("by_hand") }, "*") : null;
  const cells = inputs.map((input) => make("td", { colspan: 3 - values.length, "data-caption": caption(input.dataset.value) }, input));
  // Where a leg has a line of its own, its name stands before it.
  const row = [make("td", { class: "side", "aria-hidden": "true" }, label(side)), ...cells, make("td", {}, select, mark)];
  return { row, read: () => read(line, side, select.value, inputs) };
}

// What the boxes say; null if nothing, an Error if it is no number.
function read(line, side, is, inputs) {
  const measure = { leg: side, measure: line.measure, is };
  if (is !== "measured") return measure;
  let hasAny = false;
  for (const input of inputs) {
    const text = input.value.trim();
    if (!text) continue;
    const [, digits] = /^(\d+(?:[.,]\d+)?)(?:\s*cm)?$/i.exec(text) ?? [];
    const cm = digits ? Number(digits.replace(",", ".")) : NaN;
    if (Number.isNaN(cm)) {
      input.focus();
      throw new Error(label("amend_number").replace("{text}", text));
    }
    // To a hundredth of a millimetre, so that no box gains digits.
    measure[`${input.dataset.value}_mm`] = Math.round(cm * 1000) / 100;
    hasAny = true;
  }
  return hasAny ? measure : null;
}

function amendTable(lines) {
  const groups = make("tr", {}, make("td"), AMEND_SIDES.map((side) => make("th", { scope: "colgroup", colspan: 3 }, label(side))));
  const heads = make("tr", {}, make("th", { scope: "col" }, label("level")), AMEND_SIDES.flatMap(() =>
    [label("girth"), label("height"), ""].map((text) => (text ? make("th", { scope: "col" }, text) : make("td")))));
  const readers = [];
  const rows = lines.map((line) => make("tr", {}, make("th", { scope: "row" }, line.name), AMEND_SIDES.flatMap((side) => {
    const { row, read: reader } = boxes(line, side);
    readers.push(reader);
    return row;
  })));
  const table = make("table", {}, make("thead", {}, groups, heads), make("tbody", {}, rows));
  return { table, readers };
}

// What is asked for stands first, and everything else behind one more click.
function amendTables(lines) {
  const isAsked = (line) => AMEND_SIDES.some((side) => line[side].asked.length);
  const asked = amendTable(lines.filter(isAsked));
  const others = amendTable(lines.filter((line) => !isAsked(line)));
  if (!asked.readers.length) return { parts: [others.table], readers: others.readers };
  if (!others.readers.length) return { parts: [asked.table], readers: asked.readers };
  const more = make("details", {}, make("summary", {}, label("amend_more")), others.table);
  return { parts: [asked.table, more], readers: [...asked.readers, ...others.readers] };
}

let amending = 0;
async function amend(scan) {
  const mine = amending += 1;
  let lines = [];
  try {
    const answer = await fetch(address(scan, "measures"));
    if (answer.ok) lines = await answer.json();
  } catch {
    // Told below.
  }
  if (!lines.length) {
    say(label("amend_away"), true);
    return;
  }
  if (mine !== amending) return;
  const [dialog, fault, save] = [$("amend"), $("amend_fault"), $("amend_yes")];
  const [patient] = scan.patients.length === 1 ? scan.patients : [];
  $("amend_title").replaceChildren(...[patient === undefined ? label("amend_plain") : phrase(label("amend_of"), { patient })].flat());
  const { parts, readers } = amendTables(lines);
  $("amend_body").replaceChildren(...parts);
  fault.textContent = "";
  save.disabled = false;
  let isSure = false;
  const askAnew = () => {
    isSure = false;
    save.textContent = label("amend_yes");
  };
  askAnew();
  parts.forEach((part) => part.addEventListener("input", askAnew));
  $("amend_reason").value = "";
  $("amend_by").value = kept(NAME_KEY) ?? "";
  dialog.querySelector("form").onsubmit = async (event) => {
    event.preventDefault();
    let set;
    try {
      set = readers.map((reader) => reader()).filter(Boolean);
    } catch (error) {
      fault.textContent = error.message;
      return;
    }
    if (!set.length) {
      fault.textContent = label("amend_none");
      return;
    }
    save.disabled = true;
    const by = $("amend_by").value.trim();
    keep(NAME_KEY, by);
    const said = await ask({
      ask: "amend", scan: scan.scan, patient: scan.owner?.id, measures: set, reason: $("amend_reason").value.trim(), by, is_sure: isSure,
    });
    if (mine !== amending) return;
    save.disabled = false;
    if (!said.isDone) {
      fault.textContent = said.sentence;
      // A value that is far off the scan is asked about once; any change asks anew.
      isSure = said.code === "measure-far-off";
      save.textContent = label(isSure ? "amend_sure" : "amend_yes");
      return;
    }
    dialog.close();
    if (token) say(said.sentence, false);
  };
  dialog.showModal();
  $("amend_body").querySelector("input.asked, input")?.focus();
}
