//! The messages of records in German. A record keeps them in English, with their figures; here they
//! are known by their pattern, so that older records are told in German too.

use crate::record::Language;

/// Stands for what changes from message to message: figures, levels, and messages within messages.
const HOLE: &str = "{}";

/// English patterns and the same in German, holes in the same order. The longer of two that begin
/// alike comes first.
const PATTERNS: [(&str, &str); 69] = [
    // Levels and by what they are found.
    ("the level is absent: {}", "Der Messpunkt fehlt: {}"),
    ("the girth curve has no such turning point", "die Umfangskurve hat dort keinen Wendepunkt"),
    (
        "the girth is smaller still {} mm along the leg, where the search begins: its least lies below \
         or was not seen",
        "{} mm entlang des Beins, wo die Suche beginnt, ist der Umfang noch kleiner: der kleinste liegt \
         darunter oder war nicht zu sehen",
    ),
    (
        "the girth does not clearly turn up to {} mm along the leg, where the search ends",
        "bis {} mm entlang des Beins, wo die Suche endet, kehrt der Umfang nicht deutlich um",
    ),
    ("it is measured from {}, which is absent", "er wird von {} aus gemessen, und {0} fehlt"),
    ("it would lie above {}", "er läge über {}"),
    ("turning point of the girth", "Umkehrpunkt des Umfangs"),
    ("largest slope of the girth between B and C", "größte Steigung des Umfangs zwischen B und C"),
    ("{} mm above B", "{} mm über B"),
    ("{} mm below the crotch", "{} mm unter dem Schritt"),
    (
        "tape at 45 degrees from the back edge of the heel",
        "Maßband unter 45° von der Hinterkante der Ferse",
    ),
    ("{} of the crotch's height", "{} der Schritthöhe"),
    ("halfway between {} and {}", "Mitte zwischen {} und {}"),
    ("{} (medial) and {} (lateral) of the foot's length", "{} (innen) und {} (außen) der Fußlänge"),
    (
        "a girth of {} mm is no leg's: the level is left out",
        "Einen Umfang von {} mm hat kein Bein: der Messpunkt ist weggelassen",
    ),
    // Doubts.
    ("the extremum stands out by only {} mm", "Der Umkehrpunkt hebt sich nur um {} mm ab"),
    (
        "the girth is flat there: its height is uncertain by {} mm",
        "Der Umfang bleibt dort gleich: die Höhe ist um {} mm unsicher",
    ),
    (
        "the girth at {} mm is the same within the noise",
        "Der Umfang in {} mm Höhe ist im Rahmen des Rauschens derselbe",
    ),
    (
        "the extremum lies {} mm from the end of what was searched or seen",
        "Der Umkehrpunkt liegt {} mm vom Ende des durchsuchten oder gesehenen Bereichs",
    ),
    ("{} degrees of the skin were not seen there", "{}° der Haut waren dort nicht zu sehen"),
    (
        "the points scatter by {} mm there: cloth, a second layer, or a movement?",
        "Die Punkte streuen dort um {} mm: Stoff, eine zweite Lage oder eine Bewegung?",
    ),
    (
        "the skin is {} % longer than a tape around it: is it folded there?",
        "Die Haut ist um {} % länger als ein Maßband darum: liegt sie dort in Falten?",
    ),
    (
        "the skin there was not seen; the girth is bridged",
        "Die Haut war dort nicht zu sehen; der Umfang ist überbrückt",
    ),
    (
        "by its proportion the knee would lie below D, which is at {} mm",
        "Nach der Proportion läge das Knie unter D, das bei {} mm liegt",
    ),
    (
        "the sole is not seen; the tape is closed along the floor",
        "Die Sohle ist nicht zu sehen; das Maßband ist am Boden entlang geschlossen",
    ),
    // The body and its legs.
    (
        "left and right rest on the declared facing alone: {}",
        "Links und rechts beruhen allein auf der vorgegebenen Blickrichtung: {}",
    ),
    ("a foot has only {} points", "ein Fuß hat nur {} Punkte"),
    (
        "what stands on the floor is {} % of the stature long and {} % wide, which is no foot",
        "was auf dem Boden steht, ist {} % der Körpergröße lang und {} % breit, und das ist kein Fuß",
    ),
    (
        "a foot reaches {} times as far ahead of its ankle as behind it",
        "ein Fuß reicht {}-mal so weit vor den Knöchel wie dahinter",
    ),
    ("the feet point {} degrees apart", "die Füße weichen um {}° voneinander ab"),
    (
        "the toes point {} degrees off the square to the line through the ankles",
        "die Zehen weichen um {}° vom rechten Winkel zur Linie durch die Knöchel ab",
    ),
    (
        "the file holds points but no faces, and was measured by its points: was the export cut short, \
         or the mesh left out?",
        "Die Datei enthält Punkte, aber keine Flächen, und wurde nach ihren Punkten vermessen: brach \
         der Export ab, oder fehlt das Netz?",
    ),
    (
        "the legs are one from {} mm up: do the thighs touch, or is there cloth? they were parted along \
         the fold, and the skin in it was not seen",
        "Ab {} mm Höhe sind die Beine eins: berühren sich die Oberschenkel, oder ist da Stoff? Sie \
         wurden an der Falte getrennt; die Haut darin war nicht zu sehen",
    ),
    (
        "the crotch is at {} % of the stature, where nearly everybody has it at 44 to 53 %: are head \
         and feet whole in the scan?",
        "Der Schritt liegt bei {} % der Körpergröße, bei fast allen Menschen bei 44 bis 53 %: sind Kopf \
         und Füße ganz im Scan?",
    ),
    (
        "the leg is seen up to {} mm only: nothing was measured above",
        "Das Bein ist nur bis {} mm zu sehen: darüber wurde nichts gemessen",
    ),
    ("the leg was not measured: {}", "Das Bein wurde nicht vermessen: {}"),
    (
        "it is not in the scan, or ends below the calf",
        "es ist nicht im Scan oder endet unter der Wade",
    ),
    ("the leg has too few points", "das Bein hat zu wenige Punkte"),
    ("only {} of {} sections close", "nur {} von {} Schnitten schließen sich"),
    (
        "{} sections between ankle and groin, where an axis needs {}",
        "{} Schnitte zwischen Knöchel und Leiste, eine Achse braucht {}",
    ),
    (
        "{} points below the crotch, where an axis needs {}",
        "{} Punkte unter dem Schritt, eine Achse braucht {}",
    ),
    ("the leg's axis leans by {} degrees", "die Achse des Beins neigt sich um {}°"),
    ("no girth at {} mm: {}", "Kein Umfang in {} mm Höhe: {}"),
    ("girths were measured from {} to {} mm", "Umfänge wurden von {} bis {} mm gemessen"),
    ("the skin there was not seen", "die Haut war dort nicht zu sehen"),
    (
        "the left leg's girth is larger by {} mm (standard error {})",
        "Der Umfang des linken Beins ist um {} mm größer (Standardfehler {})",
    ),
    (
        "the right leg's girth is larger by {} mm (standard error {})",
        "Der Umfang des rechten Beins ist um {} mm größer (Standardfehler {})",
    ),
    (
        "the left leg's volume is larger by {} mL, {} % of the smaller one (standard error {} mL)",
        "Das Volumen des linken Beins ist um {} ml größer, {} % des kleineren (Standardfehler {} ml)",
    ),
    (
        "the right leg's volume is larger by {} mL, {} % of the smaller one (standard error {} mL)",
        "Das Volumen des rechten Beins ist um {} ml größer, {} % des kleineren (Standardfehler {} ml)",
    ),
    // Surfaces and their files.
    (
        "no surface: between {} and {} mm only {} sections are seen without a band between them, where \
         it needs {}",
        "Keine Oberfläche: zwischen {} und {} mm sind nur {} Schnitte ohne Unterbrechung zu sehen, \
         nötig sind {}",
    ),
    (
        "no surface: it would fold at {} mm, where too little of the leg was seen",
        "Keine Oberfläche: sie schlüge bei {} mm eine Falte, wo zu wenig vom Bein zu sehen war",
    ),
    ("no surface: none of its skin was seen", "Keine Oberfläche: von der Haut war nichts zu sehen"),
    ("no surface: {}", "Keine Oberfläche: {}"),
    (
        "the surface covers {} to {} mm; {} to {} mm are wanted",
        "Die Oberfläche reicht von {} bis {} mm; gewünscht sind {} bis {} mm",
    ),
    (
        "the surface bridges 1 hole; the largest is {} mm long, {} mm wide, at {} mm and {} degrees \
         from the front",
        "Die Oberfläche überbrückt eine Lücke von {} mm Länge und {} mm Breite, in {} mm Höhe und {}° \
         von vorn",
    ),
    (
        "the surface bridges {} holes; the largest is {} mm long, {} mm wide, at {} mm and {} degrees \
         from the front",
        "Die Oberfläche überbrückt {} Lücken; die größte ist {} mm lang und {} mm breit, in {} mm Höhe \
         und {}° von vorn",
    ),
    ("{} was not made: {}", "{} wurde nicht erzeugt: {}"),
    (
        "the lower end of the surface is not plane: it leaves its plane by {} mm",
        "das untere Ende der Oberfläche ist nicht eben: es weicht um {} mm ab",
    ),
    (
        "the upper end of the surface is not plane: it leaves its plane by {} mm",
        "das obere Ende der Oberfläche ist nicht eben: es weicht um {} mm ab",
    ),
    (
        "a mesh cannot keep to its surface within {} mm",
        "ein Netz kann der Oberfläche nicht auf {} mm folgen",
    ),
    (
        "the surface is no tube at u = {}, v = {}",
        "die Oberfläche ist bei u = {}, v = {} kein Schlauch",
    ),
    (
        "the fonts of report.pdf could not be cut down: {}",
        "Die Schriften für report.pdf ließen sich nicht zuschneiden: {}",
    ),
    // The scanner's own measures.
    (
        "the scanner's own measures (.ord) were not compared: {}",
        "Die Messwertdatei des Scanners (.ord) wurde nicht verglichen: {}",
    ),
    (
        "{} measurement files (.ord) bear this scan's name; none of them was compared",
        "{} Messwertdateien (.ord) tragen den Namen dieses Scans; keine wurde verglichen",
    ),
    (
        "the scanner's stature is {} mm, gaiter's {} mm, a factor of {}: a wrong unit in one of the two \
         files?",
        "Die Körpergröße ist laut Scanner {} mm, laut gaiter {} mm, das {}-fache: eine falsche Einheit \
         in einer der beiden Dateien?",
    ),
    (
        "the scanner's body height is {} mm, gaiter's body height {} mm",
        "Die Körpergröße ist laut Scanner {} mm, laut gaiter {} mm",
    ),
    (
        "the scanner's calf girth is {} mm, gaiter's {} {} mm",
        "Der Wadenumfang ist laut Scanner {} mm, laut gaiter {} {} mm",
    ),
    (
        "the scanner's ankle girth is {} mm, gaiter's {} {} mm",
        "Der Knöchelumfang ist laut Scanner {} mm, laut gaiter {} {} mm",
    ),
    (
        "the scanner's calves, {} mm left and {} mm right, fit the other leg each: are left and right \
         swapped?",
        "Die Waden laut Scanner, links {} mm und rechts {} mm, passen jeweils zum anderen Bein: sind \
         links und rechts vertauscht?",
    ),
];

/// A message of a record in this language, and whether it could be told in it; else it stays as it
/// is.
pub(in crate::record::report) fn told(message: &str, language: Language) -> (String, bool) {
    match language {
        Language::En => (message.to_owned(), true),
        Language::De => match german(message) {
            Some(german) => (german, true),
            None => (message.to_owned(), message.is_empty()),
        },
    }
}

/// A message in German; none where it, or one within it, has no known pattern.
fn german(message: &str) -> Option<String> {
    PATTERNS.iter().find_map(|(english, german)| {
        let inside = fitted(english, message)?;
        let told = inside.into_iter().map(part).collect::<Option<Vec<String>>>()?;
        let first = told.first().cloned().unwrap_or_default();
        let mut told = told.into_iter();
        let mut pieces = german.split(HOLE);
        let begin = pieces.next().unwrap_or_default().to_owned();
        let whole =
            pieces.fold(begin, |text, piece| text + &told.next().unwrap_or_default() + piece);
        Some(whole.replace("{0}", &first))
    })
}

/// What stands in a pattern's holes; none where the message is another.
fn fitted<'a>(pattern: &str, message: &'a str) -> Option<Vec<&'a str>> {
    let mut pieces = pattern.split(HOLE);
    let mut rest = message.strip_prefix(pieces.next()?)?;
    let mut inside = Vec::new();
    for piece in pieces {
        let end = if piece.is_empty() { rest.len() } else { rest.find(piece)? };
        inside.push(&rest[..end]);
        rest = &rest[end + piece.len()..];
    }
    rest.is_empty().then_some(inside)
}

/// What stands in a hole: a figure with its comma, a name as it is, or a message.
fn part(inside: &str) -> Option<String> {
    let is_figure = inside.parse::<f64>().is_ok();
    // Levels and files: one word with a capital, a digit or a point in it.
    let is_name = !inside.contains(' ') && inside.contains(|c: char| !c.is_ascii_lowercase());
    match (is_figure, is_name) {
        (true, _) => Some(inside.replace('.', ",")),
        (false, true) => Some(inside.to_owned()),
        (false, false) => german(inside),
    }
}
