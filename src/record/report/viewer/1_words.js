// The 3D view of a record's legs in plain WebGL: no library, no network. The parts of this folder are one
// script, in the order of their names.
//
// `gaiterViewer.mount(element, record, {language: "en"|"de"})` fills `element` with the view of a
// parsed record.json and returns `{destroy()}`. A record without shapes, a damaged one or a browser
// without WebGL gives a sentence. Downwards: words → reading → geometry → camera → GPU → labels → page.
// Lengths are millimetres in the body frame: +Z up, −Y where the toes point, +X the patient's left.
"use strict";

globalThis.gaiterViewer = (() => {
  const WORDS = {
    en: {
      title: "3D view of the legs", look: "View", show: "Show", point: ".",
      front: "Front", back: "Back", fromLeft: "Patient's left", fromRight: "Patient's right", feet: "From below",
      nearer: "Zoom in", farther: "Zoom out", reset: "Reset",
      left: "left", right: "right", leftLeg: "Left leg", rightLeg: "Right leg",
      scan: "Scan points", skin: "Skin", surface: "Surface", error: "Error of the surface",
      sections: "Sections", landmarks: "Levels with girth", features: "Feature points",
      peak: "peak", valley: "valley", unseen: "not seen",
      legend: "Skin outside (+) or inside (−) the surface, mm",
      help: "Drag or arrow keys turn; wheel, pinch, + and − zoom; shift and drag, two fingers or shift and arrow keys move; double click or 0 resets.",
      noShape: "This record holds no shape of the legs, so there is nothing to show in 3D.",
      unreadable: "The shape of the legs in this record is damaged and cannot be shown.",
      damaged: "Parts of the shape in this record are damaged and are left out.",
      noWebgl: "This browser cannot show the 3D view (no WebGL).",
    },
    de: {
      title: "3D-Ansicht der Beine", look: "Ansicht", show: "Zeigen", point: ",",
      front: "Vorn", back: "Hinten", fromLeft: "Links (Patient)", fromRight: "Rechts (Patient)", feet: "Von unten",
      nearer: "Vergrößern", farther: "Verkleinern", reset: "Zurücksetzen",
      left: "links", right: "rechts", leftLeg: "Linkes Bein", rightLeg: "Rechtes Bein",
      scan: "Scanpunkte", skin: "Haut", surface: "Oberfläche", error: "Fehler der Oberfläche",
      sections: "Schnitte", landmarks: "Messpunkte mit Umfang", features: "Merkmalspunkte",
      peak: "Gipfel", valley: "Tal", unseen: "nicht gesehen",
      legend: "Haut außerhalb (+) oder innerhalb (−) der Oberfläche, mm",
      help: "Ziehen oder Pfeiltasten drehen; Mausrad, zwei Finger, + und − vergrößern oder verkleinern; Umschalttaste und Ziehen, zwei Finger oder Umschalttaste und Pfeiltasten verschieben; Doppelklick oder 0 setzt zurück.",
      noShape: "Dieser Datensatz enthält keine Form der Beine; in 3D gibt es nichts zu zeigen.",
      unreadable: "Die Form der Beine in diesem Datensatz ist beschädigt und kann nicht gezeigt werden.",
      damaged: "Teile der Form in diesem Datensatz sind beschädigt und fehlen hier.",
      noWebgl: "Dieser Browser kann die 3D-Ansicht nicht zeigen (kein WebGL).",
    },
  };

  // Colours in the light and the dark theme; a page may set `--gaiter-NAME`. Error colours run
  // blue–white–orange, which colour-blind people tell apart.
  const COLOURS = {
    ground: ["#f6f7f9", "#14181e"], ink: ["#1b2430", "#e8ecf1"], line: ["#747d8a", "#8993a1"],
    left: ["#00695a", "#4fd1b5"], right: ["#ab2a1d", "#ff937f"],
    scan: ["#3a3f4a", "#d5dae2"], skin: ["#d3bba7", "#b79f8c"], surface: ["#86aed0", "#6d97bb"],
    peak: ["#ffb000", "#ffb000"], valley: ["#6a3df0", "#9a7bff"],
    below: ["#1f5fb0", "#2f74cc"], middle: ["#f7f7f4", "#f7f7f4"], above: ["#b85a00", "#d96f0a"],
    unseen: ["#8b8d90", "#77797c"], rim: ["#16181c", "#16181c"], focus: ["#0b57d0", "#8ab4f8"],
  };

  const VIEWS = { front: [0, 0], back: [180, 0], fromLeft: [90, 0], fromRight: [-90, 0], feet: [0, -90] }; // yaw, pitch in degrees
  const START = [0, 12]; // The view at first and after a reset: from the front, a little from above.
  const LAYERS = ["scan", "skin", "surface", "error", "sections", "landmarks", "features"];
  const SHOWN_FIRST = ["skin", "surface", "sections", "landmarks", "features"];

  const MOST_POINTS = 400_000; // Of one grid or cloud: more would not be a record of ours.
  const MOST_ITEMS = 100; // Of sections, levels and feature points of a leg each.
  const FARTHEST_MM = 4000; // No coordinate of a body lies farther out.
  const UNSEEN = -32768; // Stands in error grids where nothing was seen.
  const RING_MM = 1.3; // Half the thickness of a drawn section.
  // How far layers that lie on one another are lifted towards the eye, so that they do not flicker.
  const LIFT_MM = { skin: 0, surface: 1, error: 1.3, scan: 1.8, ring: 2, feature: 4, landmark: 2000 };
  const TURN_DEG_PER_PX = 0.4, KEY_TURN_DEG = 10, KEY_MOVE_PX = 40, KEY_ZOOM = 1.25;
  const ZOOM = [0.5, 40]; // Least and most, 1 fits the legs into the canvas.
  const MARGIN_PX = [130, 46]; // Room for labels beside and over the legs.
  const LEADER_PX = 16; // From the legs to the label of a level.
  const MOST_CANVAS_PX = 4096, MOST_BAR_PX = 120;
  const ZOOM_PER_WHEEL_PX = 0.0015;
  const NEAR_PX_PER_MM = 1.5; // From here on feature points show their labels.
  const HOVER_PX = 14; // A pointer this near to a feature point shows its label.
  const SCROLL_PAUSE_MS = 300; // Wheel turns closer together are one scroll of the page.
  const WHEEL_LINE_PX = 30; // What a wheel's line is worth where a browser counts lines.

