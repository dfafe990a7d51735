// The 3D view of a record's legs in plain WebGL: no library, no network. The parts of this folder are one
// script, in the order of their names.
//
// `gaiterViewer.mount(element, record, {patient})` fills `element` with the view of a parsed record.json and
// returns `{destroy()}`; `patient` is the id as the page shows it, if it does. The words are those of
// `gaiterViewerWords`: the table `viewer` of the language's file.
// A record without shapes, a damaged one or a browser without WebGL gives a sentence. Downwards:
// constants → reading → geometry → tape → camera → GPU → labels → inputs → page.
// Lengths are millimetres in the body frame: +Z up, −Y where the toes point, +X the patient's left.
"use strict";

globalThis.gaiterViewer = (() => {
  // Colours in the light and the dark theme; a page may set `--gaiter-NAME`. Error colours are those of the
  // report's flat figure in both themes: purple–white–orange, which colour-blind people tell apart.
  const COLOURS = {
    ground: ["#f6f7f9", "#14181e"], ink: ["#1b2430", "#e8ecf1"], line: ["#747d8a", "#8993a1"],
    left: ["#00695a", "#4fd1b5"], right: ["#ab2a1d", "#ff937f"],
    scan: ["#3a3f4a", "#d5dae2"], skin: ["#d3bba7", "#b79f8c"], surface: ["#86aed0", "#6d97bb"],
    peak: ["#ffb000", "#ffb000"], valley: ["#6a3df0", "#9a7bff"],
    below: ["#542788", "#542788"], middle: ["#f7f7f7", "#f7f7f7"], above: ["#b35806", "#b35806"],
    unseen: ["#9a9a9a", "#9a9a9a"], rim: ["#16181c", "#16181c"], focus: ["#0b57d0", "#8ab4f8"],
    tape: ["#ffd83d", "#ffd83d"],
  };

  const VIEWS = { front: [0, 0], back: [180, 0], from_left: [90, 0], from_right: [-90, 0], feet: [0, -90] }; // yaw, pitch in degrees
  const START = [0, 8]; // The view at first and after a reset: from the front, a little from above.
  const FIRST_LAYERS = ["tape", "ghost", "landmarks"];
  const MORE_LAYERS = ["skin", "surface", "error", "sections", "features", "scan"];
  const SHOWN_FIRST = ["skin", "tape", "sections", "landmarks"];

  const MOST_POINTS = 400_000; // Of one grid or cloud: more would not be a record of ours.
  const MOST_ITEMS = 100; // Of sections, levels and feature points of a leg each.
  const FARTHEST_MM = 4000; // No coordinate of a body lies farther out.
  const UNSEEN = -32768; // Stands in grids where nothing was seen.
  // Where the error's colours are full; the report's flat figure has the same scale.
  const ERROR_MM = Number((globalThis.gaiterViewerWords || {}).error_mm) || 1;
  const RING_MM = 1.3; // Half the thickness of a drawn section.
  // How far layers that lie on one another are lifted towards the eye, so that they do not flicker. The ghost
  // sinks, so that it shows only where it is clearly thicker.
  const LIFT_MM = { ghost: -1, skin: 0, surface: 1, error: 1.3, scan: 1.8, ring: 2, tape: 5, tapeFace: 5.6, feature: 7, landmark: 2000 };
  const TURN_DEG_PER_PX = 0.4, KEY_TURN_DEG = 10, KEY_MOVE_PX = 40, KEY_ZOOM = 1.25;
  const ZOOM = [0.5, 40]; // Least and most, 1 fits the legs into the canvas.
  const MARGIN_PX = [92, 30]; // Room for labels beside and over the legs.
  const MARGIN_SHARE = 0.21; // Of a narrow canvas' width, each side.
  const NARROW_PX = 480; // Below this the labels are short.
  const LEADER_PX = 12; // From the legs to the label of a level.
  const MOST_CANVAS_PX = 4096, MOST_BAR_PX = 120;
  const ZOOM_PER_WHEEL_PX = 0.0015;
  const NEAR_PX_PER_MM = 1.5; // From here on feature points show their labels.
  const HOVER_PX = 14; // A pointer this near to a feature point shows its label.
  const WHEEL_LINE_PX = 30; // What a wheel's line is worth where a browser counts lines.

  const CURVE_GAP_MM = 12; // Rows of the girth curve are 5 mm apart; nothing is guessed over a wider gap.
  const SKIN_GAP_MM = 25; // Rows of the drawn skin are 10 mm apart.
  const AT_LEVEL_MM = 0.5; // A tape this near to a level is at it: half a step of the slider.
  const DOUBT_REACH_MM = 20; // A doubt of the profile reaches half of its 40 mm.
  const TAPE_PX = 3.5; // Half the width of the drawn tape.
  const GRAB_PX = 12; // A mouse this near to the tape takes it.
  const LEAST_RISE = 0.2; // Seen more steeply than this (cosine), a drag does not say which height is meant.

