//! Findings about scans, legs, surfaces, and the scanner's own measures.

use super::told::Told;

pub(super) const TOLD: [Told; 18] = [
    Told {
        code: "facing-unchecked",
        title: ["Left and right not checked", "Links und rechts nicht geprüft"],
        meaning: [
            "The feet do not show where the body faces: which leg is left and which is right rests on \
             the configured direction alone.",
            "Die Füße zeigen nicht, wohin der Körper blickt: welches Bein links und welches rechts ist, \
             beruht allein auf der eingestellten Richtung.",
        ],
        action: [
            "Make sure which leg is which before anything is ordered.",
            "Vor jeder Bestellung sicherstellen, welches Bein welches ist.",
        ],
    },
    Told {
        code: "no-faces",
        title: ["Points without a mesh", "Punkte ohne Netz"],
        meaning: [
            "The file holds points only; they were measured.",
            "Die Datei enthält nur Punkte; sie wurden vermessen.",
        ],
        action: [
            "See whether the export was cut short; switch the mesh on in the scanner's export.",
            "Prüfen, ob der Export abbrach; im Export des Scanners das Netz einschalten.",
        ],
    },
    Told {
        code: "thighs-touch",
        title: ["Thighs touch", "Oberschenkel berühren sich"],
        meaning: [
            "Below the crotch the legs are one: the thighs touch, or there is cloth. Each leg was \
             measured; where they touch the skin was not seen.",
            "Unter dem Schritt sind die Beine eins: die Oberschenkel berühren sich, oder da ist Stoff. \
             Jedes Bein wurde vermessen; wo sie sich berühren, war die Haut nicht zu sehen.",
        ],
        action: [
            "Look at the levels above that height; scan again with the legs apart if they matter.",
            "Messpunkte über dieser Höhe ansehen; mit gespreizten Beinen erneut scannen, wenn sie \
             gebraucht werden.",
        ],
    },
    Told {
        code: "proportions",
        title: ["Unusual proportions", "Ungewöhnliche Proportionen"],
        meaning: [
            "The position of the crotch is very unusual. Head or feet may be missing in the scan, \
             and heights may be wrong.",
            "Der Schritt liegt, wo ihn kaum jemand hat. Kopf oder Füße fehlen womöglich im Scan, und \
             Höhen können falsch sein.",
        ],
        action: [
            "See whether head and feet are whole in the scan.",
            "Ansehen, ob Kopf und Füße ganz im Scan sind.",
        ],
    },
    Told {
        code: "leg-cut",
        title: ["Leg not seen to its top", "Bein nicht bis oben zu sehen"],
        meaning: [
            "The leg is seen up to some height only; levels above it are absent.",
            "Das Bein ist nur bis zu einer gewissen Höhe zu sehen; Messpunkte darüber fehlen.",
        ],
        action: ["Scan again.", "Erneut scannen."],
    },
    Told {
        code: "leg-not-measured",
        title: ["Leg not measured", "Bein nicht vermessen"],
        meaning: [
            "This leg is not in the scan or could not be measured. The other one was.",
            "Dieses Bein ist nicht im Scan oder war nicht zu vermessen. Das andere wurde vermessen.",
        ],
        action: [
            "Scan again if the patient has this leg, with the whole leg in view.",
            "Erneut scannen, wenn der Patient dieses Bein hat, mit dem ganzen Bein im Bild.",
        ],
    },
    Told {
        code: "no-surface",
        title: ["No surface", "Keine Oberfläche"],
        meaning: [
            "Too little of the leg was seen for a surface. The girths do not depend on it.",
            "Für eine Oberfläche war zu wenig vom Bein zu sehen. Die Umfänge hängen nicht davon ab.",
        ],
        action: [
            "Scan again if the maker needs the surface.",
            "Erneut scannen, wenn der Hersteller die Oberfläche braucht.",
        ],
    },
    Told {
        code: "surface-short",
        title: ["Surface too short", "Oberfläche zu kurz"],
        meaning: [
            "The surface does not reach from 20 mm below B to 20 mm above D.",
            "Die Oberfläche reicht nicht von 20 mm unter B bis 20 mm über D.",
        ],
        action: [
            "Scan again if the maker needs the surface.",
            "Erneut scannen, wenn der Hersteller die Oberfläche braucht.",
        ],
    },
    Told {
        code: "surface-holes",
        title: ["Surface bridges holes", "Oberfläche überbrückt Lücken"],
        meaning: [
            "The scanner did not see all of the skin; the surface bridges the holes smoothly.",
            "Der Scanner sah nicht die ganze Haut; die Oberfläche überbrückt die Lücken glatt.",
        ],
        action: [
            "Look at the largest in the pictures; scan again if the stocking depends on that place.",
            "Die größte in den Bildern ansehen; erneut scannen, wenn es am Strumpf auf diese Stelle \
             ankommt.",
        ],
    },
    Told {
        code: "ends-not-plane",
        title: ["Solid not made", "Körper nicht erzeugt"],
        meaning: [
            "A solid was asked for, and an end of the surface is not plane. The other files were made.",
            "Ein Volumenkörper war gewünscht, und ein Ende der Oberfläche ist nicht eben. Die anderen \
             Dateien wurden erzeugt.",
        ],
        action: ["Close it in the CAD program.", "Im CAD-Programm schließen."],
    },
    Told {
        code: "mesh-not-made",
        title: ["Mesh not made", "Netz nicht erzeugt"],
        meaning: [
            "The surface has no triangles within the tolerance that was asked for.",
            "Die Oberfläche hat in der gewünschten Toleranz keine Dreiecke.",
        ],
        action: ["Choose a coarser tolerance.", "Eine gröbere Toleranz wählen."],
    },
    Told {
        code: "paper-not-made",
        title: ["Report on paper not made", "Bericht als PDF nicht erzeugt"],
        meaning: [
            "report.pdf could not be made; this page holds the same, and prints.",
            "report.pdf war nicht zu erzeugen; diese Seite enthält dasselbe und lässt sich drucken.",
        ],
        action: [
            "Print the page; send us the record.",
            "Die Seite drucken; uns den Datensatz senden.",
        ],
    },
    Told {
        code: "legs-differ",
        title: ["The legs differ", "Die Beine unterscheiden sich"],
        meaning: [
            "They differ by 20 mm of girth or more at a level, or by 10 % of volume or more, and by \
             more than the uncertainty: what clinics call a swelling. Nothing is wrong with the scan.",
            "Sie unterscheiden sich um mindestens 20 mm Umfang an einem Messpunkt oder um mindestens \
             10 % des Volumens, und um mehr als die Unsicherheit: was als Schwellung gilt. Am Scan ist nichts falsch.",
        ],
        action: ["The clinician decides.", "Die Entscheidung liegt bei der Fachkraft."],
    },
    Told {
        code: "ord-disagrees",
        title: ["The scanner's measures differ", "Der Scanner maß anders"],
        meaning: [
            "The scanner's own measure of stature, calf or ankle differs. Nothing was corrected.",
            "Das eigene Maß des Scanners für Körpergröße, Wade oder Knöchel ist ein anderes. Nichts \
             wurde angepasst.",
        ],
        action: ["Look at the scan; measure by hand.", "Den Scan ansehen; von Hand messen."],
    },
    Told {
        code: "ord-sides",
        title: ["Left and right may be swapped", "Links und rechts womöglich vertauscht"],
        meaning: [
            "Each calf in the scanner's own measures fits the other leg better.",
            "Jede Wade in den eigenen Maßen des Scanners passt besser zum anderen Bein.",
        ],
        action: [
            "Make sure which leg is which before anything is ordered.",
            "Vor jeder Bestellung sicherstellen, welches Bein welches ist.",
        ],
    },
    Told {
        code: "ord-unit",
        title: ["Another unit", "Andere Einheit"],
        meaning: [
            "The scanner's stature equals this one in another unit. Girths may be wrong by the \
             same factor.",
            "Die Körpergröße des Scanners ist diese in einer anderen Einheit. Umfänge könnten um \
             denselben Faktor falsch sein.",
        ],
        action: ["Look at the units of both exports.", "Die Einheiten beider Exporte ansehen."],
    },
    Told {
        code: "ord-unreadable",
        title: ["Scanner's measures not readable", "Messwertdatei nicht lesbar"],
        meaning: [
            "The measurement file beside the scan could not be read. The scan was measured all the same.",
            "Die Messwertdatei neben dem Scan war nicht zu lesen. Der Scan wurde trotzdem vermessen.",
        ],
        action: [
            "Look at the line that the message names.",
            "Die Zeile ansehen, die die Meldung nennt.",
        ],
    },
    Told {
        code: "ord-ambiguous",
        title: ["Several files of the scanner's measures", "Mehrere Messwertdateien"],
        meaning: [
            "Several measurement files bear the scan's name; none was used.",
            "Mehrere Messwertdateien tragen den Namen des Scans; keine wurde verwendet.",
        ],
        action: [
            "Remove those that belong to another scan.",
            "Diejenigen entfernen, die zu einem anderen Scan gehören.",
        ],
    },
];
