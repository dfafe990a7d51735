//! German texts of records: a text for each key of a [`Statement`](crate::record::statement), with the
//! names of its figures in braces. A number after a colon sets the decimals: none without it, and as
//! many as needed with `*`.

/// Keys and their texts.
pub(super) const WORDS: &[(&str, &str)] = &[
    // Levels and the rules by which they are found.
    ("level-absent", "Der Messpunkt fehlt: {why}"),
    ("no-turn", "die Umfangskurve hat dort keinen Wendepunkt"),
    (
        "below-search",
        "{along_mm} mm entlang des Beins, wo die Suche beginnt, ist der Umfang noch kleiner: der \
         kleinste liegt darunter oder war nicht zu sehen",
    ),
    (
        "above-search",
        "bis {along_mm} mm entlang des Beins, wo die Suche endet, kehrt der Umfang nicht deutlich \
         um",
    ),
    ("needs-level", "er wird von {level} aus gemessen, und {level} fehlt"),
    ("beyond-level", "er läge über {level}"),
    ("turning-point", "Umkehrpunkt des Umfangs"),
    ("largest-slope", "größte Steigung des Umfangs zwischen B und C"),
    ("above-b", "{distance_mm:*} mm über B"),
    ("below-crotch", "{distance_mm:*} mm unter dem Schritt"),
    ("heel-tape", "Maßband unter 45° von der Hinterkante der Ferse"),
    ("crotch-share", "{share:*} der Schritthöhe"),
    ("halfway", "Mitte zwischen {low} und {high}"),
    ("foot-shares", "{medial:*} (innen) und {lateral:*} (außen) der Fußlänge"),
    (
        "level-implausible",
        "Einen Umfang von {girth_mm} mm hat kein Bein: der Messpunkt ist weggelassen",
    ),
    // Doubts.
    ("shallow", "Der Umkehrpunkt hebt sich nur um {prominence_mm:1} mm ab"),
    ("flat", "Der Umfang bleibt dort gleich: die Höhe ist um {height_sd_mm} mm unsicher"),
    ("double", "Der Umfang in {other_height_mm} mm Höhe ist im Rahmen des Rauschens derselbe"),
    ("edge", "Der Umkehrpunkt liegt {end_mm} mm vom Ende des durchsuchten oder gesehenen Bereichs"),
    ("gap", "{gap_deg}° der Haut waren dort nicht zu sehen"),
    (
        "scatter",
        "Die Punkte streuen dort um {rms_mm:1} mm: Stoff, eine zweite Lage oder eine Bewegung?",
    ),
    (
        "folds",
        "Die Haut ist um {percent:1} % länger als ein Maßband darum: liegt sie dort in Falten?",
    ),
    ("not-seen", "Die Haut war dort nicht zu sehen; der Umfang ist überbrückt"),
    ("below-d", "Nach der Proportion läge das Knie unter D, das bei {d_height_mm} mm liegt"),
    ("sole-not-seen", "Die Sohle ist nicht zu sehen; das Maßband ist am Boden entlang geschlossen"),
    // The body and its legs.
    (
        "facing-unchecked",
        "Links und rechts beruhen allein auf der vorgegebenen Blickrichtung: {why}",
    ),
    ("foot-not-seen", "ein Fuß hat nur {points} Punkte"),
    (
        "no-foot",
        "was auf dem Boden steht, ist {length_percent} % der Körpergröße lang und {width_percent} \
         % breit, und das ist kein Fuß",
    ),
    ("no-toes", "ein Fuß reicht {ratio:2}-mal so weit vor den Knöchel wie dahinter"),
    ("feet-apart", "die Füße weichen um {spread_deg}° voneinander ab"),
    (
        "toes-not-square",
        "die Zehen weichen um {off_deg}° vom rechten Winkel zur Linie durch die Knöchel ab",
    ),
    (
        "no-faces",
        "Die Datei enthält Punkte, aber keine Flächen, und wurde nach ihren Punkten vermessen: \
         brach der Export ab, oder fehlt das Netz?",
    ),
    (
        "thighs-touch",
        "Ab {from_mm} mm Höhe sind die Beine eins: berühren sich die Oberschenkel, oder ist da \
         Stoff? Sie wurden an der Falte getrennt; die Haut darin war nicht zu sehen",
    ),
    (
        "proportions",
        "Der Schritt liegt bei {percent} % der Körpergröße, bei fast allen Menschen bei 44 bis 53 \
         %: sind Kopf und Füße ganz im Scan?",
    ),
    ("leg-cut", "Das Bein ist nur bis {end_mm} mm zu sehen: darüber wurde nichts gemessen"),
    ("leg-not-measured", "Das Bein wurde nicht vermessen: {why}"),
    ("leg-not-there", "es ist nicht im Scan oder endet unter der Wade"),
    ("leg-too-few-points", "das Bein hat zu wenige Punkte"),
    ("leg-too-few-sections", "nur {measured} von {planes} Schnitten schließen sich"),
    (
        "axis-too-few-sections",
        "{found} Schnitte zwischen Knöchel und Leiste, eine Achse braucht {needed}",
    ),
    ("axis-too-few-points", "{found} Punkte unter dem Schritt, eine Achse braucht {needed}"),
    ("axis-leans", "die Achse des Beins neigt sich um {tilt_deg}°"),
    ("height-not-measured", "Kein Umfang in {height_mm} mm Höhe: {why}"),
    ("outside-girths", "Umfänge wurden von {from_mm} bis {to_mm} mm gemessen"),
    ("skin-not-seen", "die Haut war dort nicht zu sehen"),
    (
        "left-girth-larger",
        "Der Umfang des linken Beins ist um {by_mm} mm größer (Standardfehler {sd_mm:1})",
    ),
    (
        "right-girth-larger",
        "Der Umfang des rechten Beins ist um {by_mm} mm größer (Standardfehler {sd_mm:1})",
    ),
    (
        "left-volume-larger",
        "Das Volumen des linken Beins ist um {by_ml} ml größer, {percent:1} % des kleineren \
         (Standardfehler {sd_ml} ml)",
    ),
    (
        "right-volume-larger",
        "Das Volumen des rechten Beins ist um {by_ml} ml größer, {percent:1} % des kleineren \
         (Standardfehler {sd_ml} ml)",
    ),
    // Surfaces and their files.
    (
        "no-surface-too-few-sections",
        "Keine Oberfläche: zwischen {from_mm} und {to_mm} mm sind nur {rows} Schnitte ohne \
         Unterbrechung zu sehen, nötig sind {needed}",
    ),
    (
        "no-surface-folded",
        "Keine Oberfläche: sie schlüge bei {height_mm} mm eine Falte, wo zu wenig vom Bein zu \
         sehen war",
    ),
    ("no-surface-nothing-seen", "Keine Oberfläche: von der Haut war nichts zu sehen"),
    (
        "surface-short",
        "Die Oberfläche reicht von {from_mm} bis {to_mm} mm; gewünscht sind {wanted_from_mm} bis \
         {wanted_to_mm} mm",
    ),
    (
        "surface-hole",
        "Die Oberfläche überbrückt eine Lücke von {length_mm} mm Länge und {width_mm} mm Breite, \
         in {height_mm} mm Höhe und {angle_deg}° von vorn",
    ),
    (
        "surface-holes",
        "Die Oberfläche überbrückt {count} Lücken; die größte ist {length_mm} mm lang und \
         {width_mm} mm breit, in {height_mm} mm Höhe und {angle_deg}° von vorn",
    ),
    ("file-not-made", "{file} wurde nicht erzeugt: {why}"),
    (
        "lower-end-not-plane",
        "das untere Ende der Oberfläche ist nicht eben: es weicht um {off_mm:6} mm ab",
    ),
    (
        "upper-end-not-plane",
        "das obere Ende der Oberfläche ist nicht eben: es weicht um {off_mm:6} mm ab",
    ),
    ("mesh-no-tolerance", "ein Netz kann der Oberfläche nicht auf {tolerance_mm:*} mm folgen"),
    (
        "mesh-too-fine",
        "ein Netz auf {tolerance_mm:*} mm braucht {triangles} Dreiecke, mehr als zulässig",
    ),
    ("surface-no-tube", "die Oberfläche ist bei u = {u:*}, v = {v:*} kein Schlauch"),
    // The scanner's own measures.
    (
        "ord-ambiguous",
        "{files} Messwertdateien (.ord) tragen den Namen dieses Scans; keine wurde verglichen",
    ),
    (
        "ord-unit",
        "Die Körpergröße ist laut Scanner {theirs_mm} mm, laut gaiter {ours_mm} mm, das \
         {factor:*}-fache: eine falsche Einheit in einer der beiden Dateien?",
    ),
    (
        "ord-stature-disagrees",
        "Die Körpergröße ist laut Scanner {theirs_mm} mm, laut gaiter {ours_mm} mm",
    ),
    (
        "ord-calf-disagrees",
        "Der Wadenumfang ist laut Scanner {theirs_mm} mm, laut gaiter C {ours_mm} mm",
    ),
    (
        "ord-ankle-disagrees",
        "Der Knöchelumfang ist laut Scanner {theirs_mm} mm, laut gaiter B {ours_mm} mm",
    ),
    (
        "ord-sides",
        "Die Waden laut Scanner, links {left_mm} mm und rechts {right_mm} mm, passen jeweils zum \
         anderen Bein: sind links und rechts vertauscht?",
    ),
];
