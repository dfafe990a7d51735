//! The texts around the pictures.

use super::{Caption, PictureWords, Report};

impl Report<'_> {
    pub(super) fn picture_words(&self) -> PictureWords {
        let missing = self.record.legs.iter().any(|leg| leg.shape.is_none()).then(|| {
            self.say(
                "This record was made by an earlier version and does not hold the shape of the legs: \
                 pictures of it cannot be drawn. Measuring the scan again gives them.",
                "Dieser Datensatz stammt von einer früheren Version und enthält die Form der Beine \
                 nicht: Bilder davon lassen sich nicht zeichnen. Ein erneutes Vermessen des Scans \
                 liefert sie.",
            )
        });
        PictureWords {
            title: self.say("Pictures", "Bilder"),
            captions: self.captions(),
            missing,
            view: self.say("The legs to turn", "Die Beine zum Drehen"),
            no_script: self.say(
                "This view needs the page's script, which does not run here.",
                "Diese Ansicht braucht das Skript der Seite, das hier nicht läuft.",
            ),
        }
    }

    fn captions(&self) -> Vec<Caption> {
        let caption = |name, title: String, text: String| Caption { name, title, text };
        vec![
            caption(
                "views",
                self.say("The legs from front, side and back", "Die Beine von vorn, seitlich und hinten"),
                self.say(
                    "Sections at the levels with their girths, and feature points: peaks and valleys \
                     of the curvature. From the front the patient's right leg is on the left.",
                    "Schnitte an den Messpunkten mit ihren Umfängen, und Merkmalspunkte: Maxima und \
                     Minima der Krümmung. Von vorn gesehen steht das rechte Bein links.",
                ),
            ),
            caption(
                "girths",
                self.say("Girth over height", "Umfang über der Höhe"),
                self.say(
                    "The girth by tape at every height with the levels found on it, and how fast it \
                     grows upwards. B and D are minima, C is a maximum, B1 lies where the girth grows \
                     fastest.",
                    "Der Umfang mit Maßband in jeder Höhe mit den gefundenen Messpunkten, und wie \
                     schnell er nach oben zunimmt. B und D sind Minima, C ist ein Maximum, B1 liegt, wo \
                     der Umfang am schnellsten zunimmt.",
                ),
            ),
            caption(
                "sections",
                self.say("Sections at B, B1, C and D", "Schnitte bei B, B1, C und D"),
                self.say(
                    "Each section to scale, seen from the feet with the front up, with its curvature \
                     and the feature points P1, P2, …",
                    "Jeder Schnitt maßstäblich, von den Füßen gesehen, vorn oben, mit seiner Krümmung \
                     und den Merkmalspunkten P1, P2, …",
                ),
            ),
            caption(
                "fit",
                self.say("The scan's points and the fitted curve", "Punkte des Scans und angepasste Kurve"),
                self.say(
                    "How closely the curve that is measured follows what the scanner saw.",
                    "Wie eng die vermessene Kurve dem folgt, was der Scanner sah.",
                ),
            ),
            caption(
                "error",
                self.say("How far the scan lies off the surface", "Wie weit der Scan neben der Oberfläche liegt"),
                self.say(
                    "The skin unrolled: red lies outside the surface, blue inside, grey was not seen.",
                    "Die Haut abgerollt: Rot liegt außerhalb der Oberfläche, Blau innerhalb, Grau war nicht \
                     zu sehen.",
                ),
            ),
        ]
    }
}
