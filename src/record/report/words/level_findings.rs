//! Findings and doubts about levels.

use super::told::Told;

pub(super) const TOLD: [Told; 13] = [
    Told {
        code: "level-absent",
        title: ["Level absent", "Messpunkt fehlt"],
        meaning: [
            "This level was not found on this leg. Nothing is guessed in its place.",
            "Dieser Messpunkt wurde an diesem Bein nicht gefunden. An seiner Stelle ist nichts geraten.",
        ],
        action: [
            "Measure it by hand if the stocking needs it.",
            "Von Hand messen, wenn der Strumpf ihn braucht.",
        ],
    },
    Told {
        code: "level-implausible",
        title: ["Girth not plausible", "Umfang nicht plausibel"],
        meaning: [
            "The girth found there is below 9 or above 120 cm. The level is left out.",
            "Der dort gefundene Umfang liegt unter 9 oder über 120 cm. Der Messpunkt ist weggelassen.",
        ],
        action: ["Scan again.", "Erneut scannen."],
    },
    Told {
        code: "shallow",
        title: ["Hardly stands out", "Hebt sich kaum ab"],
        meaning: [
            "The girth hardly turns there: the height of the level is uncertain, its girth less so.",
            "Der Umfang kehrt dort kaum um: die Höhe des Messpunkts ist unsicher, sein Umfang weniger.",
        ],
        action: ["Check the height by hand.", "Die Höhe von Hand prüfen."],
    },
    Told {
        code: "flat",
        title: ["Height uncertain", "Höhe unsicher"],
        meaning: [
            "The girth stays nearly the same over a long stretch, so the height of the level is \
             uncertain by more than 15 mm; at B1 its girth too.",
            "Der Umfang bleibt über eine lange Strecke fast gleich; die Höhe des Messpunkts ist daher \
             um mehr als 15 mm unsicher, bei B1 auch sein Umfang.",
        ],
        action: ["Check the height by hand.", "Die Höhe von Hand prüfen."],
    },
    Told {
        code: "double",
        title: ["A second place", "Eine zweite Stelle"],
        meaning: [
            "Another place, more than 20 mm away, has the same girth within the noise. The girth holds \
             for both.",
            "Eine zweite Stelle, mehr als 20 mm entfernt, hat im Rahmen des Rauschens denselben Umfang. \
             Der Umfang gilt für beide.",
        ],
        action: [
            "Decide by hand which of the two is meant.",
            "Von Hand entscheiden, welche der beiden gemeint ist.",
        ],
    },
    Told {
        code: "edge",
        title: ["At the edge of the visible range", "Am Rand des Gesehenen"],
        meaning: [
            "The level lies within 12 mm of the end of what was searched or seen.",
            "Der Messpunkt liegt weniger als 12 mm vom Ende des durchsuchten oder gesehenen Bereichs.",
        ],
        action: [
            "Check the level by hand; see whether the leg is whole in the scan.",
            "Den Messpunkt von Hand prüfen; ansehen, ob das Bein ganz im Scan ist.",
        ],
    },
    Told {
        code: "gap",
        title: ["Skin partly not seen", "Haut teilweise nicht zu sehen"],
        meaning: [
            "More than 30° of the skin around the leg was not seen at this level; the girth bridges it.",
            "An diesem Messpunkt waren mehr als 30° der Haut ringsum nicht zu sehen; der Umfang \
             überbrückt sie.",
        ],
        action: [
            "Check the girth by hand, or scan again.",
            "Den Umfang von Hand prüfen oder erneut scannen.",
        ],
    },
    Told {
        code: "scatter",
        title: ["Points scatter", "Punkte streuen"],
        meaning: [
            "The points there are not one skin: cloth, a second layer, or a movement during the scan.",
            "Die Punkte dort sind nicht eine Haut: Stoff, eine zweite Lage oder eine Bewegung während \
             des Scans.",
        ],
        action: ["Look at the scan; scan again.", "Den Scan ansehen; erneut scannen."],
    },
    Told {
        code: "folds",
        title: ["Skin folded", "Haut in Falten"],
        meaning: [
            "The skin is more than 1 % longer than a tape around it: folded skin, or no skin.",
            "Die Haut ist um mehr als 1 % länger als ein Maßband darum: Hautfalten, oder keine Haut.",
        ],
        action: [
            "Use the girth by tape, as in the table of measures; look at the scan.",
            "Den Umfang mit Maßband verwenden, wie er bei den Maßen steht; den Scan ansehen.",
        ],
    },
    Told {
        code: "not-seen",
        title: ["Skin not seen", "Haut nicht zu sehen"],
        meaning: [
            "The skin at this level could not be measured; its girth is bridged from above and below.",
            "Die Haut an diesem Messpunkt war nicht zu messen; sein Umfang ist von oben und unten her \
             überbrückt.",
        ],
        action: ["Scan again.", "Erneut scannen."],
    },
    Told {
        code: "below-d",
        title: ["Knee below D", "Knie unter D"],
        meaning: [
            "By the body's proportion the knee (E, and with it F) would lie below the D that was found.",
            "Nach der Proportion des Körpers läge das Knie (E und damit F) unter dem gefundenen D.",
        ],
        action: ["Measure E and F by hand; look at D.", "E und F von Hand messen; D ansehen."],
    },
    Told {
        code: "sole-not-seen",
        title: ["Sole not seen", "Sohle nicht zu sehen"],
        meaning: [
            "No scanner sees the sole of a standing foot: the tape around A is closed along the floor.",
            "Kein Scanner sieht die Sohle eines stehenden Fußes: das Maßband um A ist am Boden entlang \
             geschlossen.",
        ],
        action: ["Measure A by hand.", "A von Hand messen."],
    },
    Told {
        code: "height-not-measured",
        title: ["Height not measured", "Höhe nicht gemessen"],
        meaning: [
            "A height that was asked for was not seen, or lies off the measured leg.",
            "Eine gewünschte Höhe war nicht zu sehen oder liegt außerhalb des gemessenen Beins.",
        ],
        action: [
            "Measure there by hand, or scan again.",
            "Dort von Hand messen oder erneut scannen.",
        ],
    },
];
